/* Mip levels of texels that count by how much of them a surface covers: what nothing covers is mixed into nothing. */
#ifndef LMB_MIP_LEVEL_H
#define LMB_MIP_LEVEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct mip_level {
    int32_t width, height;
    int planes;
    float *value;    /* [plane][x + width y], malloc'ed */
    float *coverage; /* [x + width y], 0 to 1, malloc'ed */
} mip_level;

static inline size_t mip_level_texels(const mip_level *level)
{
    return (size_t)level->width * (size_t)level->height;
}

/* All 0. False: out of memory; then nothing is to be freed. */
bool lmb_mip_level_create(int32_t width, int32_t height, int planes, mip_level *level);

/* Level `number` of an image, its sides halved so often and rounded down. A texel is the mean of what it covers of the
 * image's texels, by area and coverage, or 0 where none of that is covered; sides that do not halve evenly are divided
 * evenly all the same. Made of the image itself: of the level before, a texel would take in what lies beside it.
 * False: out of memory. */
bool lmb_mip_level_reduce(const mip_level *image, int32_t number, mip_level *level);

void lmb_mip_level_free(mip_level *level);

#endif
