#include "leaks_methods.h"

#include <string.h>

static lmb_result trilinear_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    *state = field->volume;
    *bytes = field->packed_bytes;
    return LMB_OK;
}

static void trilinear_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    lmb_volume_sample(state, position, radiance);
}

const leaks_method leaks_trilinear = {
    .name = "trilinear",
    .about = "eight probes, whatever is between",
    .prepare = trilinear_prepare,
    .sample = trilinear_sample,
};

/* A probe as a file holds it: 27 halfs. */
enum { PROBE_BYTES = 54, CELL_REGION_BYTES = 8 * sizeof(uint16_t), CELL_OFFSET_BYTES = sizeof(uint16_t) };

static lmb_result regions_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    const lmb_probes *const probes = field->bake.probes;
    *state = field->bake.probes;
    *bytes = field->packed_bytes + (size_t)probes->ghost_count * PROBE_BYTES + probes->cut.count * CELL_OFFSET_BYTES +
             probes->cut.region_count * CELL_REGION_BYTES + probes->cut.plane_count * sizeof(lmb_cell_plane);
    return LMB_OK;
}

static void regions_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    const lmb_vec3d at = {(double)position.x, (double)position.y, (double)position.z};
    *radiance = lmb_probes_light(state, 0, at);
}

const leaks_method leaks_regions = {
    .name = "regions",
    .about = "cells cut into regions, eight values each: probes, or ghosts fitted to light inside",
    .prepare = regions_prepare,
    .sample = regions_sample,
};

static const leaks_method *const methods[] = {
    &leaks_trilinear, &leaks_masked, &leaks_masked_exact, &leaks_chebyshev, &leaks_regions,
};

const leaks_method *const *leaks_methods(size_t *count)
{
    *count = sizeof methods / sizeof methods[0];
    return methods;
}

const leaks_method *leaks_method_find(const char *name)
{
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; ++i) {
        if (strcmp(methods[i]->name, name) == 0) {
            return methods[i];
        }
    }
    return NULL;
}
