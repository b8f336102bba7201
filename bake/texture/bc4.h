/* BC4: 16 numbers in [0, 1] in 8 bytes. BC5 is two of them, one after the other. */
#ifndef LMB_BC4_H
#define LMB_BC4_H

#include <stdint.h>

enum { BC4_TEXELS = 16, BC4_BYTES = 8 };

/* Writes the block whose weighted squared error is the least that was found, and returns that. Values outside [0, 1]
 * are clamped; those of weight 0 may become anything. The same input gives the same bytes on every machine. */
float lmb_bc4_encode(const float value[BC4_TEXELS], const float weight[BC4_TEXELS], uint8_t bytes[BC4_BYTES]);

/* Any 8 bytes. */
void lmb_bc4_decode(const uint8_t bytes[BC4_BYTES], float value[BC4_TEXELS]);

#endif
