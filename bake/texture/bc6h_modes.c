#include "texture/bc6h_modes.h"

#include <string.h>

/* Channels of the four ends, and runs of their bits. */
#define R(end, low, count)                                                                                             \
    {                                                                                                                  \
        3 * (end), low, count                                                                                          \
    }
#define G(end, low, count)                                                                                             \
    {                                                                                                                  \
        3 * (end) + 1, low, count                                                                                      \
    }
#define B(end, low, count)                                                                                             \
    {                                                                                                                  \
        3 * (end) + 2, low, count                                                                                      \
    }

const bc6h_mode lmb_bc6h_modes[BC6H_MODES] = {
    {0x00,
     2,
     2,
     true,
     10,
     {5, 5, 5},
     {G(2, 4, 1), B(2, 4, 1), B(3, 4, 1), R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 5), G(3, 4, 1), G(2, 0, 4),
      G(1, 0, 5), B(3, 0, 1), G(3, 0, 4), B(1, 0, 5), B(3, 1, 1), B(2, 0, 4), R(2, 0, 5), B(3, 2, 1), R(3, 0, 5),
      B(3, 3, 1)}},
    {0x01, 2, 2, true, 7, {6, 6, 6}, {G(2, 5, 1), G(3, 4, 1), G(3, 5, 1), R(0, 0, 7), B(3, 0, 1), B(3, 1, 1),
                                      B(2, 4, 1), G(0, 0, 7), B(2, 5, 1), B(3, 2, 1), G(2, 4, 1), B(0, 0, 7),
                                      B(3, 3, 1), B(3, 5, 1), B(3, 4, 1), R(1, 0, 6), G(2, 0, 4), G(1, 0, 6),
                                      G(3, 0, 4), B(1, 0, 6), B(2, 0, 4), R(2, 0, 6), R(3, 0, 6)}},
    {0x02,
     5,
     2,
     true,
     11,
     {5, 4, 4},
     {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 5), R(0, 10, 1), G(2, 0, 4), G(1, 0, 4), G(0, 10, 1), B(3, 0, 1),
      G(3, 0, 4), B(1, 0, 4), B(0, 10, 1), B(3, 1, 1), B(2, 0, 4), R(2, 0, 5), B(3, 2, 1), R(3, 0, 5), B(3, 3, 1)}},
    {0x06, 5, 2, true, 11, {4, 5, 4}, {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 4),  R(0, 10, 1),
                                       G(3, 4, 1),  G(2, 0, 4),  G(1, 0, 5),  G(0, 10, 1), G(3, 0, 4),
                                       B(1, 0, 4),  B(0, 10, 1), B(3, 1, 1),  B(2, 0, 4),  R(2, 0, 4),
                                       B(3, 0, 1),  B(3, 2, 1),  R(3, 0, 4),  G(2, 4, 1),  B(3, 3, 1)}},
    {0x0A, 5, 2, true, 11, {4, 4, 5}, {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 4),  R(0, 10, 1),
                                       B(2, 4, 1),  G(2, 0, 4),  G(1, 0, 4),  G(0, 10, 1), B(3, 0, 1),
                                       G(3, 0, 4),  B(1, 0, 5),  B(0, 10, 1), B(2, 0, 4),  R(2, 0, 4),
                                       B(3, 1, 1),  B(3, 2, 1),  R(3, 0, 4),  B(3, 4, 1),  B(3, 3, 1)}},
    {0x0E,
     5,
     2,
     true,
     9,
     {5, 5, 5},
     {R(0, 0, 9), B(2, 4, 1), G(0, 0, 9), G(2, 4, 1), B(0, 0, 9), B(3, 4, 1), R(1, 0, 5), G(3, 4, 1), G(2, 0, 4),
      G(1, 0, 5), B(3, 0, 1), G(3, 0, 4), B(1, 0, 5), B(3, 1, 1), B(2, 0, 4), R(2, 0, 5), B(3, 2, 1), R(3, 0, 5),
      B(3, 3, 1)}},
    {0x12,
     5,
     2,
     true,
     8,
     {6, 5, 5},
     {R(0, 0, 8), G(3, 4, 1), B(2, 4, 1), G(0, 0, 8), B(3, 2, 1), G(2, 4, 1), B(0, 0, 8), B(3, 3, 1), B(3, 4, 1),
      R(1, 0, 6), G(2, 0, 4), G(1, 0, 5), B(3, 0, 1), G(3, 0, 4), B(1, 0, 5), B(3, 1, 1), B(2, 0, 4), R(2, 0, 6),
      R(3, 0, 6)}},
    {0x16, 5, 2, true, 8, {5, 6, 5}, {R(0, 0, 8), B(3, 0, 1), B(2, 4, 1), G(0, 0, 8), G(2, 5, 1), G(2, 4, 1),
                                      B(0, 0, 8), G(3, 5, 1), B(3, 4, 1), R(1, 0, 5), G(3, 4, 1), G(2, 0, 4),
                                      G(1, 0, 6), G(3, 0, 4), B(1, 0, 5), B(3, 1, 1), B(2, 0, 4), R(2, 0, 5),
                                      B(3, 2, 1), R(3, 0, 5), B(3, 3, 1)}},
    {0x1A, 5, 2, true, 8, {5, 5, 6}, {R(0, 0, 8), B(3, 1, 1), B(2, 4, 1), G(0, 0, 8), B(2, 5, 1), G(2, 4, 1),
                                      B(0, 0, 8), B(3, 5, 1), B(3, 4, 1), R(1, 0, 5), G(3, 4, 1), G(2, 0, 4),
                                      G(1, 0, 5), B(3, 0, 1), G(3, 0, 4), B(1, 0, 6), B(2, 0, 4), R(2, 0, 5),
                                      B(3, 2, 1), R(3, 0, 5), B(3, 3, 1)}},
    {0x1E, 5, 2, false, 6, {6, 6, 6}, {R(0, 0, 6), G(3, 4, 1), B(3, 0, 1), B(3, 1, 1), B(2, 4, 1), G(0, 0, 6),
                                       G(2, 5, 1), B(2, 5, 1), B(3, 2, 1), G(2, 4, 1), B(0, 0, 6), G(3, 5, 1),
                                       B(3, 3, 1), B(3, 5, 1), B(3, 4, 1), R(1, 0, 6), G(2, 0, 4), G(1, 0, 6),
                                       G(3, 0, 4), B(1, 0, 6), B(2, 0, 4), R(2, 0, 6), R(3, 0, 6)}},
    {0x03,
     5,
     1,
     false,
     10,
     {10, 10, 10},
     {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 10), G(1, 0, 10), B(1, 0, 10)}},
    {0x07,
     5,
     1,
     true,
     11,
     {9, 9, 9},
     {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 9), R(0, 10, 1), G(1, 0, 9), G(0, 10, 1), B(1, 0, 9),
      B(0, 10, 1)}},
    {0x0B,
     5,
     1,
     true,
     12,
     {8, 8, 8},
     {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 8), R(0, 11, 1), R(0, 10, 1), G(1, 0, 8), G(0, 11, 1), G(0, 10, 1),
      B(1, 0, 8), B(0, 11, 1), B(0, 10, 1)}},
    {0x0F, 5, 1, true, 16, {4, 4, 4}, {R(0, 0, 10), G(0, 0, 10), B(0, 0, 10), R(1, 0, 4),  R(0, 15, 1), R(0, 14, 1),
                                       R(0, 13, 1), R(0, 12, 1), R(0, 11, 1), R(0, 10, 1), G(1, 0, 4),  G(0, 15, 1),
                                       G(0, 14, 1), G(0, 13, 1), G(0, 12, 1), G(0, 11, 1), G(0, 10, 1), B(1, 0, 4),
                                       B(0, 15, 1), B(0, 14, 1), B(0, 13, 1), B(0, 12, 1), B(0, 11, 1), B(0, 10, 1)}},
};

const uint16_t lmb_bc6h_partitions[BC6H_PARTITIONS] = {0xCCCC, 0x8888, 0xEEEE, 0xECC8, 0xC880, 0xFEEC, 0xFEC8, 0xEC80,
                                                       0xC800, 0xFFEC, 0xFE80, 0xE800, 0xFFE8, 0xFF00, 0xFFF0, 0xF000,
                                                       0xF710, 0x008E, 0x7100, 0x08CE, 0x008C, 0x7310, 0x3100, 0x8CCE,
                                                       0x088C, 0x3110, 0x6666, 0x366C, 0x17E8, 0x0FF0, 0x718E, 0x399C};

const uint8_t lmb_bc6h_anchors[BC6H_PARTITIONS] = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                                   15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2};

/* Bits of a block, the lowest of byte 0 first. */
typedef struct bit_run {
    uint8_t *bytes;
    int at;
} bit_run;

static void bits_put(bit_run *run, uint32_t value, int count)
{
    for (int i = 0; i < count; ++i, ++run->at) {
        run->bytes[run->at >> 3] |= (uint8_t)((value >> i & 1u) << (run->at & 7));
    }
}

static uint32_t bits_get(const uint8_t *bytes, int *at, int count)
{
    uint32_t value = 0;
    for (int i = 0; i < count; ++i, ++*at) {
        value |= (uint32_t)(bytes[*at >> 3] >> (*at & 7) & 1) << i;
    }
    return value;
}

static int index_bits(const bc6h_block *block, int texel)
{
    const int subsets = lmb_bc6h_modes[block->mode].subsets;
    const bool anchor = texel == 0 || (subsets == 2 && texel == lmb_bc6h_anchors[block->partition]);
    return (subsets == 1 ? 4 : 3) - anchor;
}

void lmb_bc6h_modes_pack(const bc6h_block *block, uint8_t bytes[BC6H_BYTES])
{
    const bc6h_mode *mode = &lmb_bc6h_modes[block->mode];
    uint32_t value[3 * BC6H_ENDS];
    for (int i = 0; i < 3 * BC6H_ENDS; ++i) {
        const int end = i / 3, channel = i % 3;
        const int32_t base = mode->differences && end > 0 ? block->end[0][channel] : 0;
        value[i] = (uint32_t)(block->end[end][channel] - base);
    }
    memset(bytes, 0, BC6H_BYTES);
    bit_run run = {bytes, 0};
    bits_put(&run, mode->code, mode->code_bits);
    for (const bc6h_piece *piece = mode->piece; piece < mode->piece + BC6H_MOST_PIECES && piece->count > 0; ++piece) {
        bits_put(&run, value[piece->value] >> piece->low, piece->count);
    }
    if (mode->subsets == 2) {
        bits_put(&run, (uint32_t)block->partition, 5);
    }
    for (int texel = 0; texel < BC6H_TEXELS; ++texel) {
        bits_put(&run, block->index[texel], index_bits(block, texel));
    }
}

/* The mode of that code; -1: reserved. */
static int mode_find(uint32_t code)
{
    for (int i = 0; i < BC6H_MODES; ++i) {
        const bc6h_mode *mode = &lmb_bc6h_modes[i];
        if (mode->code == (code & ((1u << mode->code_bits) - 1u))) {
            return i;
        }
    }
    return -1;
}

/* Adds differences to the first end, modulo its bits. */
static void ends_resolve(bc6h_block *block)
{
    const bc6h_mode *mode = &lmb_bc6h_modes[block->mode];
    for (int end = 1; mode->differences && end < 2 * mode->subsets; ++end) {
        for (int channel = 0; channel < 3; ++channel) {
            const int32_t sign = 1 << (mode->other_bits[channel] - 1);
            const int32_t difference = (block->end[end][channel] ^ sign) - sign;
            block->end[end][channel] = (block->end[0][channel] + difference) & ((1 << mode->bits) - 1);
        }
    }
}

bool lmb_bc6h_modes_unpack(const uint8_t bytes[BC6H_BYTES], bc6h_block *block)
{
    memset(block, 0, sizeof *block);
    block->mode = mode_find(bytes[0] & 0x1Fu);
    if (block->mode < 0) {
        return false;
    }
    const bc6h_mode *mode = &lmb_bc6h_modes[block->mode];
    int at = mode->code_bits;
    for (const bc6h_piece *piece = mode->piece; piece < mode->piece + BC6H_MOST_PIECES && piece->count > 0; ++piece) {
        const uint32_t bits = bits_get(bytes, &at, piece->count) << piece->low;
        block->end[piece->value / 3][piece->value % 3] |= (int32_t)bits;
    }
    ends_resolve(block);
    block->partition = mode->subsets == 2 ? (int)bits_get(bytes, &at, 5) : 0;
    for (int texel = 0; texel < BC6H_TEXELS; ++texel) {
        block->index[texel] = (uint8_t)bits_get(bytes, &at, index_bits(block, texel));
    }
    return true;
}
