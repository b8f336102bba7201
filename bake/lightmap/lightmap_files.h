/* What writing and reading a lightmap's files share: their names, and which of a model's channels are in which. */
#ifndef LMB_LIGHTMAP_FILES_H
#define LMB_LIGHTMAP_FILES_H

#include "lightmap/lightmap_internal.h"

/* Who reads version 2 alone would lose the key lights of version 3. */
enum {
    LMB_LIGHTMAP_FORMAT_VERSION = 2,
    LMB_LIGHTMAP_FORMAT_VERSION_WITH_KEYS = 3,
    LMB_LIGHTMAP_FILE_NAME = 64,
    LMB_PICTURE_CHANNELS = 3
};

#define LMB_LIGHTMAP_FORMAT_NAME "lambent lightmap"
#define LMB_LIGHTMAP_JSON_NAME "lightmap.json"
#define LMB_LIGHTMAP_KEYS_KIND "keys"

/* Of a lightmap's files. */
int lmb_lightmap_format_version(const lmb_lightmap *lightmap);

/* lightmap_N.exr, or lightmap_N_KIND.exr where `kind` is not NULL. */
void lmb_lightmap_file_name(int32_t image, const char *kind, char name[LMB_LIGHTMAP_FILE_NAME]);

/* The channels of one file: those of a model's picture of irradiance, all others of it, or those of key lights. */
typedef struct lmb_lightmap_channels {
    int first; /* of the image's planes */
    int count;
    int stored;      /* in the file: those beyond `count` are 0, and make it a picture */
    int light_count; /* the first of them, which scale with the light */
    const char *const *name;
} lmb_lightmap_channels;

/* What a model's own file is called after. */
const char *lmb_lightmap_kind(const lmb_model *model);

/* R, G and B, of a model that has irradiance first. */
lmb_lightmap_channels lmb_lightmap_picture_channels(void);

/* What is seen of key lights, as R, G, B and A: planes that follow a model's. */
lmb_lightmap_channels lmb_lightmap_key_channels(const lmb_lightmap *lightmap);

/* What is left of a model, as R, G, B and A where that is enough for it, so that every program opens the file. */
lmb_lightmap_channels lmb_lightmap_model_channels(const lmb_model *model);

#endif
