/* A volume whose light is known: for tests of what reads volumes. */
#ifndef LMB_TESTS_CONSTANT_VOLUME_H
#define LMB_TESTS_CONSTANT_VOLUME_H

#include <stdlib.h>

#include <lambent/pack.h>
#include <lambent/scene.h>
#include <lambent/volume.h>

#include "harness.h"
#include "probes_fixture.h"

/* A volume of one constant radiance all over the bounds of a level. */
typedef struct constant_volume {
    unsigned char *data;
    lmb_volume *volume;
} constant_volume;

static inline void constant_volume_close(constant_volume *made)
{
    lmb_volume_close(made->volume);
    free(made->data);
}

static inline bool constant_volume_make(const lmb_scene *scene, lmb_rgb radiance, constant_volume *made)
{
    *made = (constant_volume){0};
    const float low[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float high[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    lmb_lattice lattice = {.spacing = 1.0f};
    for (int i = 0; i < 3; ++i) {
        lattice.min[i] = (int32_t)floorf(low[i]) - 1;
        lattice.size[i] = (int32_t)ceilf(high[i]) + 2 - lattice.min[i];
    }
    lmb_probes *probes = fixture_probes(&lattice, NULL);
    bool good = probes != NULL;
    for (int32_t i = 0; good && i < probes->count; ++i) {
        probes->validity[i] = 1.0f;
        for (int c = 0; c < 3; ++c) {
            probes->radiance[0][i].channel[c].c[0] = radiance.c[c] * 3.54490770f; /* 2 sqrt(pi) */
        }
    }
    size_t bytes = 0;
    good = good && lmb_pack(probes, &made->data, &bytes, NULL) == LMB_OK &&
           lmb_volume_open_memory(made->data, bytes, &made->volume) == LMB_OK;
    lmb_probes_destroy(probes);
    CHECK(good, "volume");
    if (!good) {
        constant_volume_close(made);
    }
    return good;
}

#endif
