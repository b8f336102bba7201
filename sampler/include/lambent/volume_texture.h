/* A volume as 3D textures, which a GPU filters, for shader/lambent_volume_texture.glsl. docs/formats.md describes what
 * is in them.
 *
 * Every brick of 4 x 4 x 4 cells is a block of 5 x 5 x 5 texels, and every region of a cut cell that has ghosts one of
 * 2 x 2 x 2. Blocks hold their own borders, so that filtering within one needs no neighbour: it is the same function of
 * the position as lmb_volume_sample, and as continuous across bricks and levels. Words of 32 bits say which block and
 * which part of it a position is in.
 *
 *     lmb_volume_texture_layout layout;
 *     const lmb_volume_texture_def def = lmb_volume_texture_default();
 *     lmb_volume_texture_size(volume, &def, &layout);        how much memory, which textures
 *     lmb_volume_texture_fill(volume, &layout, texels, words);
 *     lmb_volume_texture_get_constants(volume, &layout, world_origin);
 *
 * Nothing is allocated, and nothing of the volume is needed any more once that is uploaded. */
#ifndef LAMBENT_VOLUME_TEXTURE_H
#define LAMBENT_VOLUME_TEXTURE_H

#include <stdint.h>

#include <lambent/api.h>
#include <lambent/result.h>
#include <lambent/types.h>
#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_volume_texture_def {
    uint32_t bands;     /* of the harmonics: 3, all nine; 2, the first four of each colour in half of the memory */
    uint32_t side_most; /* texels that a 3D texture may have along an axis, LMB_VOLUME_TEXTURE_SIDE_LEAST to _MOST */
} lmb_volume_texture_def;

enum {
    LMB_VOLUME_TEXTURE_SIDE_LEAST = 16,
    LMB_VOLUME_TEXTURE_SIDE_MOST = 2048, /* Direct3D 11 and 12; Vulkan has at least 256 */
    LMB_VOLUME_TEXTURE_PARTS_MOST = 8
};

/* 3 bands, sides of up to 2048. */
LMB_API lmb_volume_texture_def lmb_volume_texture_default(void);

/* Textures of one size, the parts: part p has numbers 4 p to 4 p + 3 of a probe in its red, green, blue and alpha. They
 * may be textures of their own or, where parts * depth is a side that textures may have, as it is for all but the
 * largest volumes, lie above each other along z in one. */
typedef struct lmb_volume_texture_layout {
    uint32_t width, height, depth; /* texels of a part */
    uint32_t parts;                /* 7 of 3 bands, 3 of 2; one more where there are more key lights than room */
    uint64_t part_bytes;           /* 8 a texel: RGBA, half floats */
    uint64_t texture_bytes;        /* of all parts, one behind the other */
    uint32_t word_count;           /* 4 bytes each */
    uint32_t bands;
    uint32_t tiles[3]; /* bricks along each axis */
    uint32_t cells;    /* where bricks' cells begin among the words: behind the directory */
    uint32_t records;  /* where those of cut cells do */
    uint32_t regions;  /* of cut cells that have blocks of their own */
} lmb_volume_texture_layout;

/* The textures' size and that of the words, which are 4 bytes each.
 * @return LMB_ERROR_ARGUMENT (a def out of its range, NULL), LMB_ERROR_UNSUPPORTED (it does not fit in textures of that
 *         side) */
LMB_API lmb_result lmb_volume_texture_size(const lmb_volume *volume, const lmb_volume_texture_def *def,
                                           lmb_volume_texture_layout *layout);

/* Writes layout->texture_bytes of texels, part by part, each with x fastest and z slowest, and layout->word_count
 * words. Texels are the file's own half floats (of a compact volume, the nearest ones), to be multiplied by the scale;
 * finite. Texels that are in no cell are 0. `texels` is 2-byte aligned. */
LMB_API void lmb_volume_texture_fill(const lmb_volume *volume, const lmb_volume_texture_layout *layout, void *texels,
                                     uint32_t *words);

/* For a uniform buffer: LmbVolumeTexture in the shader, in std140 and std430 without gaps. */
typedef struct lmb_volume_texture_constants {
    float origin[3]; /* in spacings of the finest level, from the shader's origin */
    float inverse_spacing;
    float first[3]; /* of the box, from there */
    float scale;
    float last[3];
    float slack; /* spacings that a position may be off the box and count as inside, as floats round */
    uint32_t last_cell[3];
    uint32_t key_lights;
    uint32_t entries[3]; /* of the directory: along y and z to the next block, and before the first */
    uint32_t bands;
    uint32_t texels[3]; /* width, height and depth of a part */
    uint32_t parts;
    uint32_t tiles[2]; /* bricks along x; along x and y */
    uint32_t cells;    /* where bricks' cells begin among the words */
    uint32_t region_z; /* texels below the first region's */
} lmb_volume_texture_constants;

/* `world_origin` is where the shader counts its positions from, as in lmb_volume_get_gpu. */
LMB_API lmb_volume_texture_constants lmb_volume_texture_get_constants(const lmb_volume *volume,
                                                                      const lmb_volume_texture_layout *layout,
                                                                      lmb_vec3d world_origin);

#ifdef __cplusplus
}
#endif

#endif
