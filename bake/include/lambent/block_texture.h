/* Textures that graphics hardware samples compressed, 4x4 texels a block, with mip levels and layers, and their files:
 * KTX 2.0 and DDS. */
#ifndef LAMBENT_BLOCK_TEXTURE_H
#define LAMBENT_BLOCK_TEXTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>
#include <lambent/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lmb_block_format {
    LMB_BLOCK_BC4,        /* one channel in [0, 1], half a byte a texel */
    LMB_BLOCK_BC5,        /* two of them, one byte */
    LMB_BLOCK_BC6H,       /* three channels of light, 0 to 65504, one byte */
    LMB_BLOCK_ASTC,       /* three channels in [0, 1], one byte; in KTX2 alone */
    LMB_BLOCK_ASTC_LIGHT, /* three of light, likewise */
    LMB_BLOCK_FORMATS
} lmb_block_format;

typedef enum lmb_block_container { LMB_BLOCK_KTX2, LMB_BLOCK_DDS } lmb_block_container;

/* Whether this build has its encoder and decoder: ASTC's are astcenc's. */
bool lmb_block_format_is_here(lmb_block_format format);

/* As graphics interfaces call it: "BC6H_UFLOAT", ... */
const char *lmb_block_format_name(lmb_block_format format);
int lmb_block_format_channels(lmb_block_format format);

/* "ktx2" or "dds": what file names end in. */
const char *lmb_block_container_name(lmb_block_container container);

/* A level is half as wide and high as the one before, rounded down, at least 1. */
typedef struct lmb_block_texture {
    lmb_block_format format;
    int32_t width, height; /* texels of level 0 */
    int32_t layers, levels;
    unsigned char *data; /* level by level, largest first; in each, layer by layer; in those, rows of blocks */
    size_t size;
} lmb_block_texture;

enum { LMB_BLOCK_MOST_SIDE = 16384, LMB_BLOCK_MOST_LAYERS = 2048, LMB_BLOCK_MOST_LEVELS = 15 };

/* All 0. Sides, layers and levels (no more than halving allows) from 1 to those limits.
 * @return LMB_ERROR_MEMORY, _ARGUMENT */
lmb_result lmb_block_texture_create(lmb_block_format format, int32_t width, int32_t height, int32_t layers,
                                    int32_t levels, lmb_block_texture *texture);

/* Frees the data; the struct may then be used again. */
void lmb_block_texture_free(lmb_block_texture *texture);

static inline int32_t lmb_block_texture_side(int32_t side, int32_t level)
{
    return side >> level > 0 ? side >> level : 1;
}

/* Bytes of all layers of a level, and where they begin. */
size_t lmb_block_texture_level_size(const lmb_block_texture *texture, int32_t level);
size_t lmb_block_texture_level_start(const lmb_block_texture *texture, int32_t level);

/* Texels of a level. */
typedef struct lmb_block_pixels {
    const float *const *plane; /* [channel of layer 0, ..., of layer 1, ...][x + width of the level * y] */
    const float *weight;       /* [x + width y] how much each counts, >= 0; NULL: all alike. Those of 0 may become
                                  anything */
    float floor;               /* of LMB_BLOCK_BC6H: errors are relative to a texel's largest channel plus this, > 0 */
} lmb_block_pixels;

/* Encodes one level. Blocks are independent, so the same texels give the same bytes with any pool (NULL: the caller's
 * thread), and, but for ASTC, on every machine. Values outside the format's range, and NaN, are clamped into it.
 * @return LMB_ERROR_MEMORY of ASTC, _UNSUPPORTED where it is not here */
lmb_result lmb_block_texture_encode(lmb_block_texture *texture, int32_t level, const lmb_block_pixels *pixels,
                                    lmb_pool *pool);

/* Decodes one layer of a level into a plane for each channel, [x + width of the level * y]. @return likewise */
lmb_result lmb_block_texture_decode(const lmb_block_texture *texture, int32_t level, int32_t layer,
                                    float *const *plane);

/* Writes beside, then renames; equal textures are equal files. @return LMB_ERROR_WRITE, _MEMORY, _UNSUPPORTED
 * (ASTC in DDS) */
lmb_result lmb_block_texture_write(const lmb_block_texture *texture, lmb_block_container container, const char *path,
                                   lmb_error *error);

/* Reads a KTX2 or DDS file of these formats, whoever wrote it, two-dimensional, not supercompressed. Told apart by
 * content. @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_block_texture_read(const char *path, lmb_block_texture *texture, lmb_block_container *container,
                                  lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
