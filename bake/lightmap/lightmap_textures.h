/* A lightmap in compressed textures: a file for each part of a model, and one of what is seen of key lights. */
#ifndef LMB_LIGHTMAP_TEXTURES_H
#define LMB_LIGHTMAP_TEXTURES_H

#include <lambent/block_texture.h>

#include "lightmap/lightmap_files.h"

/* Channels that go into one texture. */
typedef struct lmb_texture_part {
    const char *name; /* NULL: key lights */
    int first, count; /* of an image's planes */
    bool light;       /* divided by a scale; else low to high are stored as 0 to 1 */
    float low[LMB_MODEL_MOST_CHANNELS], high[LMB_MODEL_MOST_CHANNELS];
    lmb_block_format format;
    int layers;
} lmb_texture_part;

/* Whether this build can make and read them. */
bool lmb_lightmap_textures_are_here(lmb_lightmap_format format);

/* Whether every part of a model fits a texture. */
bool lmb_lightmap_textures_hold(const lmb_model *model);

/* The parts of a model that fits; returns how many. Of ASTC, whose textures have three channels, all that is not light
 * is one part. */
enum { LMB_TEXTURE_MOST_PARTS = 8 };
int lmb_lightmap_textures_parts(const lmb_model *model, lmb_lightmap_format format,
                                lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS]);

/* What is seen of key lights, of a lightmap that has some: a layer for each. */
lmb_texture_part lmb_lightmap_textures_keys(const lmb_lightmap *lightmap);

/* lightmap_N.EXTENSION of the first part of a model whose irradiance comes first, lightmap_N_KIND_PART.EXTENSION of the
 * others, lightmap_N_keys.EXTENSION. */
void lmb_lightmap_textures_name(const lmb_lightmap *lightmap, const lmb_model *model, const lmb_texture_part *part,
                                int32_t image, char name[LMB_LIGHTMAP_FILE_NAME]);

/* What `file` and `key_lights` of lightmap.json are, in any format. */
void lmb_lightmap_textures_picture(const lmb_lightmap *lightmap, int32_t image, char name[LMB_LIGHTMAP_FILE_NAME]);
void lmb_lightmap_textures_keys_name(const lmb_lightmap *lightmap, int32_t image, char name[LMB_LIGHTMAP_FILE_NAME]);

/* Levels that the padding keeps apart: 1, 2, 3, 4 of paddings of 1, 3, 6, 12, where sides are divided evenly. */
int32_t lmb_lightmap_textures_levels(const lmb_lightmap *lightmap, int32_t image);

/* The power of two that a part's light is divided by; 1 for the others. `plane` is of all channels. */
float lmb_lightmap_textures_scale(const lmb_lightmap_image *image, const float *plane, const lmb_texture_part *part);

/* Encodes a part of an image and writes it. @return LMB_ERROR_WRITE, _MEMORY */
lmb_result lmb_lightmap_textures_write(const lmb_lightmap *lightmap, int32_t image, const float *plane,
                                       const lmb_texture_part *part, const char *path, lmb_error *error);

/* Reads the first level into the part's planes. @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_lightmap_textures_read(const lmb_lightmap_image *image, float scale, const lmb_texture_part *part,
                                      const char *path, float *plane, lmb_error *error);

#endif
