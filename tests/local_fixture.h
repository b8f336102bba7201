/* Local sets of turned boxes, with light that is nowhere negative. */
#ifndef LMB_TESTS_LOCAL_FIXTURE_H
#define LMB_TESTS_LOCAL_FIXTURE_H

#include <lambent/probe_local.h>

#include <math.h>
#include <stdlib.h>

#include "probes_fixture.h"

enum { LOCAL_FIXTURE_SETS = 3 };
static const char *const local_fixture_name[LOCAL_FIXTURE_SETS] = {"statue", "plant in a pot", "statue"};
static const uint32_t local_fixture_size[LOCAL_FIXTURE_SETS][3] = {{2, 2, 2}, {4, 1, 3}, {8, 8, 8}};

/* Boxes at several places, each turned about +Y; not quite the same along all axes. */
static inline lmb_local_frame local_fixture_frame(int set)
{
    const float angle = 0.4f + 0.9f * (float)set, c = cosf(angle), s = sinf(angle);
    const lmb_vec3 half[3] = {{0.5f * c, 0.0f, -0.5f * s}, {0.0f, 0.75f, 0.0f}, {0.25f * s, 0.0f, 0.25f * c}};
    return lmb_local_frame_of_box((lmb_vec3d){1.1 * set, 0.3, -0.7 * set}, half, local_fixture_size[set]);
}

/* Gives all sets that there are light, and what is seen of the key lights. */
static inline void local_fixture_fill(lmb_probes *probes, uint64_t *state)
{
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        const lmb_probe_local *const local = &probes->local[i];
        for (uint32_t k = 0; k < lmb_local_frame_count(&local->frame); ++k) {
            local->validity[k] = (float)fixture_random(state);
            for (int c = 0; c < 27; ++c) {
                local->radiance[k].channel[c / 9].c[c % 9] =
                    (float)(c % 9 == 0 ? 1.0 + fixture_random(state) : fixture_random(state) - 0.5);
            }
            for (uint32_t key = 0; key < probes->key_light_count; ++key) {
                local->key_visibility[k][key] = (float)fixture_random(state);
            }
        }
    }
}

/* Adds the sets: set i is of node 10 + i, at its place i. Aborts when out of memory. */
static inline void local_fixture_add(lmb_probes *probes, uint64_t *state)
{
    for (int set = 0; set < LOCAL_FIXTURE_SETS; ++set) {
        const lmb_local_frame frame = local_fixture_frame(set);
        if (lmb_probes_add_local(probes, local_fixture_name[set], 10 + set, set, &frame) != LMB_OK) {
            abort();
        }
    }
    local_fixture_fill(probes, state);
}

#endif
