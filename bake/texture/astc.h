/* ASTC in blocks of 4x4, by ARM's astcenc, where the build has found it. */
#ifndef LMB_ASTC_H
#define LMB_ASTC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Four floats a texel, of which the fourth is not stored: light (`high_range`), or numbers in [0, 1]. */
typedef struct astc_image {
    int32_t width, height;
    bool high_range;
    float *rgba; /* [4 * (x + width y) + channel] */
} astc_image;

/* Whether the build has it. */
bool lmb_astc_is_here(void);

/* Into 16 bytes for each block, rows of blocks. The same bytes for any pool (NULL: the caller's thread). False: out of
 * memory, or it is not here. */
bool lmb_astc_encode(const astc_image *image, lmb_pool *pool, unsigned char *bytes);

/* Fills `rgba`. False likewise. */
bool lmb_astc_decode(const unsigned char *bytes, astc_image *image);

#ifdef __cplusplus
}
#endif

#endif
