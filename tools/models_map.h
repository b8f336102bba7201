/* Environments that lighting models are measured with: small latitude-longitude pictures of what surrounds a point. */
#ifndef LMB_TOOLS_MODELS_MAP_H
#define LMB_TOOLS_MODELS_MAP_H

#include <lambent/error.h>
#include <lambent/model.h>

enum { MODELS_MAP_WIDTH = 128, MODELS_MAP_HEIGHT = 64, MODELS_MAP_PIXELS = MODELS_MAP_WIDTH * MODELS_MAP_HEIGHT };

/* Each pixel as light from its centre: mean radiance of what it covers times its solid angle. */
typedef struct models_map {
    const char *name; /* as given */
    lmb_directed_light light[MODELS_MAP_PIXELS];
} models_map;

/* Reads a latitude-longitude .hdr or .exr twice as wide as high and averages it, by area, over the pixels of `map`.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY; LMB_ERROR_FORMAT too for one without any light */
lmb_result models_map_read(const char *path, models_map *map, lmb_error *error);

#endif
