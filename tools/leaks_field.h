/* A scene of tests/scenes/leak_scenes.h as the library bakes it: what every way of interpolating starts from. */
#ifndef LMB_TOOLS_LEAKS_FIELD_H
#define LMB_TOOLS_LEAKS_FIELD_H

#include <stdint.h>

#include <lambent/bake_phases.h>
#include <lambent/volume.h>

#include "leak_scenes.h"

/* A scene opened, the light on its surfaces solved. Scenes are near the world's origin, so that positions in the scene
 * and in the world are the same. */
typedef struct leaks_level {
    const lmb_leak_scene *scene;
    lmb_level level;
} leaks_level;

/* Writes the scene to `path`, and loads it from there. `threads` 0: one for each processor.
 * @return what lmb_leak_scene_write, lmb_level_open and lmb_level_solve return; then there is nothing to close */
lmb_result leaks_level_open(const lmb_leak_scene *scene, const char *path, int threads, leaks_level *level,
                            lmb_error *error);
void leaks_level_close(leaks_level *level);

/* Its probes at one spacing. */
typedef struct leaks_field {
    const lmb_level *level;
    lmb_bake bake;            /* its cells are cut */
    lmb_probes *probes;       /* the same without: what was not baked is dilated */
    lmb_vec3 *place;          /* [probe] where its light was gathered */
    lmb_gather_effort effort; /* that probes took */
    lmb_volume *volume;       /* the same, packed */
    unsigned char *packed;
    size_t packed_bytes;
} leaks_field;

/* Places probes `spacing` metres apart and gathers at them with `samples` samples.
 * @return what the phases of a bake return; then there is nothing to free */
lmb_result leaks_field_bake(leaks_level *level, float spacing, uint32_t samples, leaks_field *field, lmb_error *error);
void leaks_field_free(leaks_field *field);

/* A cell of the lattice and the place of a position in it. Corner i is at +x for i & 1, +y for i & 2, +z for i & 4. */
typedef struct leaks_cell {
    int32_t at[3];    /* from the lattice's first point */
    float t[3];       /* 0 to 1; positions outside are clamped */
    int32_t probe[8]; /* -1: none there */
} leaks_cell;

leaks_cell leaks_cell_of(const leaks_field *field, lmb_vec3 position);

/* The cell `at` itself, with its probes; t is 0. */
leaks_cell leaks_cell_at(const leaks_field *field, const int32_t at[3]);

/* Cells along each axis. */
void leaks_cells_along(const leaks_field *field, int32_t along[3]);

/* A point of a cell, from coordinates in it. */
lmb_vec3 leaks_cell_point(const leaks_field *field, const int32_t at[3], float x, float y, float z);

/* Trilinear weights of the corners. */
void leaks_weights(const float t[3], float weight[8]);

/* Whether a corner has a probe that was gathered, not dilated. */
bool leaks_probe_is_valid(const leaks_field *field, int32_t probe);

/* The sum of probes' light by weights, made to sum up to 1; false, and nothing is written, where all are 0. Corners
 * without a probe are to have weight 0. */
bool leaks_blend(const leaks_field *field, const int32_t probe[8], const float weight[8], lmb_sh3_rgb *radiance);

/* Whether nothing is in between. */
bool leaks_sees(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to);

#endif
