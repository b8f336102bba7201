/* BC6H of unsigned halfs: 16 texels of light in 16 bytes. */
#ifndef LMB_BC6H_H
#define LMB_BC6H_H

#include "texture/bc6h_modes.h"

/* What is to be encoded. Texels are in rows of four. */
typedef struct bc6h_texels {
    float colour[BC6H_TEXELS][3]; /* 0 to 65504 */
    float weight[BC6H_TEXELS];    /* how much each counts, >= 0 */
    float floor;                  /* errors are relative to a texel's largest channel plus this, > 0 */
} bc6h_texels;

/* Writes the block whose relative error, squared, weighted and summed over texels and channels, is the least that was
 * found, and returns that sum. Texels of weight 0 may become anything. The same input gives the same bytes on every
 * machine. */
float lmb_bc6h_encode(const bc6h_texels *texels, uint8_t bytes[BC6H_BYTES]);

/* Any 16 bytes: reserved modes are black. */
void lmb_bc6h_decode(const uint8_t bytes[BC6H_BYTES], float colour[BC6H_TEXELS][3]);

#endif
