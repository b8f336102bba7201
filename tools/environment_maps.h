/* The files that `lambent cube` writes, and what of them a surface reflects. */
#ifndef LMB_TOOLS_ENVIRONMENT_MAPS_H
#define LMB_TOOLS_ENVIRONMENT_MAPS_H

#include <lambent/error.h>

#include <lambent/specular.h>

#include "cube_map.h"

/* Width and height of the picture of one map: levels below each other, six faces beside each other. */
enum { CUBE_PICTURE_WIDTH = CUBE_FACES * CUBE_SIDE };
int cube_picture_height(void);

/* Where a value of a level, an index into cube_map.rgb[level], lies in the picture's plane of its channel. */
size_t cube_picture_pixel(int level, int index);

typedef struct environment_map {
    lmb_vec3d position;  /* in the world */
    lmb_vec3d low, high; /* a box for what is around, in the world */
    cube_map map;
} environment_map;

typedef struct environment_maps {
    environment_map *map;
    int count;
} environment_maps;

/* Reads FOLDER/cube_map.json and its pictures. On failure nothing is to be freed.
 * @return LMB_ERROR_IO, _FORMAT (no such list, other levels, no map), _MEMORY */
lmb_result environment_maps_read(const char *folder, environment_maps *read, lmb_error *error);
void environment_maps_free(environment_maps *freed);

/* The map that a surface takes, and its box in the surface's scene. */
typedef struct map_here {
    const cube_map *map;
    lmb_specular_proxy proxy;
} map_here;

/* That of a surface at `position` of the tracer's scene: the nearest of those in sight, or of all where none is. */
map_here environment_maps_find(const environment_maps *maps, const lmb_tracer *tracer, lmb_vec3 position);

#endif
