/* One turn of an environment above a surface whose normal is +z: what a model is given of it, and the truth. */
#ifndef LMB_TOOLS_MODELS_TURN_H
#define LMB_TOOLS_MODELS_TURN_H

#include <stdint.h>

#include "models_map.h"

/* What a model is made of. The walls replace what is below the horizon, as a surface that belongs to something sees
 * its probe; I_z is the true irradiance at the surface's normal. */
typedef enum models_input {
    MODELS_LIGHTMAP,     /* SH3 that fits the radiance of the upper hemisphere by least squares there */
    MODELS_PROBE,        /* SH3 of the whole sphere */
    MODELS_PROBE_WALL,   /* the same over a wall of radiance 0.5 I_z */
    MODELS_PROBE_WALL31, /* over one of 0.75 I_z where x > 0, 0.25 I_z where x < 0 */
    MODELS_INPUT_COUNT
} models_input;

const char *models_input_name(models_input input);

enum { MODELS_NORMAL_COUNT = 1024 };

/* Shading normals, uniform over the upper hemisphere. */
void models_normals(lmb_vec3 normal[MODELS_NORMAL_COUNT]);

typedef struct models_turn {
    size_t light_count; /* above the horizon */
    lmb_directed_light light[MODELS_MAP_PIXELS];
    lmb_sh3_rgb sh3[MODELS_INPUT_COUNT];
    lmb_rgb reference[MODELS_NORMAL_COUNT]; /* normalised irradiance of the light above the horizon */
} models_turn;

/* Fills `turn` with `map` turned by the `index`-th rotation: Shoemake's map of the generalised golden ratio's sequence
 * in three dimensions, moved by `seed` where it is not 0. `normal`: models_normals; NULL: no reference is wanted. */
void models_turn_fill(models_turn *turn, const models_map *map, const lmb_vec3 *normal, uint32_t index, uint64_t seed);

/* The same light without its colour. */
void models_turn_make_grey(models_turn *turn);

/* Normalised irradiance of the light that is above the horizon and in a cone. */
void models_turn_reference(const models_turn *turn, lmb_vec3 axis, float cone_cos,
                           const lmb_vec3 normal[MODELS_NORMAL_COUNT], lmb_rgb irradiance[MODELS_NORMAL_COUNT]);

#endif
