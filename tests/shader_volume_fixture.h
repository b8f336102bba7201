/* Volumes and positions for shaders that sample them, and whether what they give is what the library does. */
#ifndef LMB_TESTS_SHADER_VOLUME_FIXTURE_H
#define LMB_TESTS_SHADER_VOLUME_FIXTURE_H

#include "levels_fixture.h"

#include <lambent/pack.h>
#include <lambent/volume.h>

/* What is done with a volume. @return false: there is no Vulkan here */
typedef bool shader_volume_check(const lmb_volume *volume, const void *context, const char *name);

/* Does it with volumes of several levels, with cut cells and wedges, in both forms, and with one of version 3; skips
 * the test where there is no Vulkan. */
static inline void shader_volumes_check(shader_volume_check *check, const void *context)
{
    bool has_device = true;
    for (int k = 0; k < 2 * LEVELS_RECIPES && has_device; ++k) {
        const lmb_volume_form form = k % 2 ? LMB_VOLUME_COMPACT : LMB_VOLUME_HALFS;
        lmb_probes *const probes = levels_make(&levels_recipes[k / 2]);
        unsigned char *data = NULL;
        size_t size = 0;
        lmb_volume *volume = NULL;
        char name[64];
        snprintf(name, sizeof name, "recipe %d, form %d", k / 2, (int)form);
        CHECK(lmb_pack_as(form, probes, &data, &size, NULL) == LMB_OK &&
                  lmb_volume_open_memory(data, size, &volume) == LMB_OK,
              "%s", name);
        if (volume) {
            has_device = check(volume, context, name);
        }
        lmb_volume_close(volume);
        free(data);
        lmb_probes_destroy(probes);
    }
    lmb_volume *old = NULL;
    CHECK(lmb_volume_open_file(LMB_GOLDEN_DIR "/levels_3.lmb", &old) == LMB_OK, "levels_3.lmb");
    if (old && has_device) {
        check(old, context, "version 3");
    }
    lmb_volume_close(old);
    if (!has_device) {
        test_skip("no Vulkan device (Debian: mesa-vulkan-drivers)");
    }
}

/* A position in the volume's box or a little beside it, counted from an origin. */
static inline void shader_position_put(const lmb_volume *volume, lmb_vec3d world_origin, uint64_t *state, float *to)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const lmb_vec3d low = info.bounds_min, high = info.bounds_max;
    const double x = 1.1 * fixture_random(state) - 0.05, y = 1.1 * fixture_random(state) - 0.05,
                 z = 1.1 * fixture_random(state) - 0.05;
    to[0] = (float)(low.x + x * (high.x - low.x) - world_origin.x);
    to[1] = (float)(low.y + y * (high.y - low.y) - world_origin.y);
    to[2] = (float)(low.z + z * (high.z - low.z) - world_origin.z);
}

/* How far a shader may be off. */
typedef struct shader_tolerance {
    double step; /* metres, of positions */
    double light, visibility;
} shader_tolerance;

/* Whether a shader's 32 numbers (inside, 27 coefficients, visibility of 4 key lights) are the library's. Floats round
 * where a plane or a cell's side is near: there the library at places around says what may be. */
static inline bool shader_agrees(const lmb_volume *volume, lmb_vec3d at, const shader_tolerance *tolerance,
                                 const float *got)
{
    const double step = tolerance->step;
    for (int side = 0; side < 9; ++side) {
        const lmb_vec3d near = {at.x + (side == 8  ? 0.0
                                        : side & 1 ? step
                                                   : -step),
                                at.y + (side == 8  ? 0.0
                                        : side & 2 ? step
                                                   : -step),
                                at.z + (side == 8  ? 0.0
                                        : side & 4 ? step
                                                   : -step)};
        lmb_sh3_rgb light;
        float seen[LMB_KEY_LIGHTS_MOST];
        const bool inside = lmb_volume_sample_with_keys(volume, near, &light, seen);
        bool same = (got[0] != 0.0f) == inside;
        for (int k = 0; k < 27; ++k) {
            same = same && fabs((double)got[1 + k] - (double)light.channel[k / 9].c[k % 9]) <= tolerance->light;
        }
        for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            same = same && fabs((double)got[28 + key] - (double)seen[key]) <= tolerance->visibility;
        }
        if (same) {
            return true;
        }
    }
    return false;
}

#endif
