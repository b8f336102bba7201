#include "texture/bc6h.h"

#include <string.h>

#include "texture/half_codes.h"

void lmb_bc6h_decode(const uint8_t bytes[BC6H_BYTES], float colour[BC6H_TEXELS][3])
{
    bc6h_block block;
    if (!lmb_bc6h_modes_unpack(bytes, &block)) {
        memset(colour, 0, BC6H_TEXELS * sizeof *colour);
        return;
    }
    const bc6h_mode *mode = &lmb_bc6h_modes[block.mode];
    for (int texel = 0; texel < BC6H_TEXELS; ++texel) {
        const int first = 2 * bc6h_subset(&block, texel);
        const int32_t weight = bc6h_weight(mode->subsets, block.index[texel]);
        for (int channel = 0; channel < 3; ++channel) {
            const int32_t a = bc6h_widen(block.end[first][channel], mode->bits);
            const int32_t b = bc6h_widen(block.end[first + 1][channel], mode->bits);
            colour[texel][channel] = half_code_value(bc6h_half(a, b, weight));
        }
    }
}
