/* The whole way of a level in small, for the hard cases: load, trace, place, bake, pack, open, sample, lightmap. Every
 * step is checked for what no level may cause: failure, NaN, infinity, negative light. */
#ifndef LMB_TESTS_HARD_LEVEL_H
#define LMB_TESTS_HARD_LEVEL_H

#include <stdint.h>
#include <stdlib.h>

#include <lambent/probes_bake.h>
#include <lambent/lightmap.h>
#include <lambent/pack.h>
#include <lambent/placement.h>
#include <lambent/volume.h>

#include "probes_fixture.h"
#include "scenes/level_builder.h"
#include "irradz_fixture.h"
#include "level_fixture.h"

static const lmb_vec3 hard_up = {0.0f, 1.0f, 0.0f};

typedef struct hard_level {
    level_fixture traced;
    lmb_probes *probes;
    lmb_placement_stats placement;
    lmb_gather_stats baked;
    unsigned char *file;
    lmb_pack_stats packed;
    lmb_volume *volume;
    lmb_lightmap *lightmap;
    lmb_gather_stats lit;
} hard_level;

typedef struct hard_settings {
    float spacing;
    float texels_per_m;
    uint32_t samples;
} hard_settings;

/* One static path: a level is written, opened, and done with before the next is. */
static inline const char *hard_path(const char *name, const char *suffix)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/hard_%s.%s", LMB_TEST_OUTPUT_DIR, name, suffix);
    return path;
}

static inline void hard_close(hard_level *level)
{
    lmb_volume_close(level->volume);
    free(level->file);
    lmb_probes_destroy(level->probes);
    lmb_lightmap_destroy(level->lightmap);
    level_fixture_close(&level->traced);
}

static inline bool sh_is_finite(const lmb_sh3_rgb *radiance)
{
    bool finite = true;
    for (int i = 0; i < 27; ++i) {
        finite = finite && isfinite(radiance->channel[i / 9].c[i % 9]);
    }
    return finite;
}

static inline bool rgb_is_light(lmb_rgb light)
{
    bool good = true;
    for (int c = 0; c < 3; ++c) {
        good = good && isfinite(light.c[c]) && light.c[c] >= 0.0f;
    }
    return good;
}

static inline void hard_check_probes(const lmb_probes *probes)
{
    lmb_error error = {{0}};
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    int32_t broken = 0;
    for (int32_t i = 0; i < probes->count; ++i) {
        bool good = sh_is_finite(&probes->radiance[0][i]);
        for (int c = 0; c < 3; ++c) {
            good = good && probes->radiance[0][i].channel[c].c[0] >= 0.0f;
        }
        broken += !good;
    }
    CHECK(broken == 0, "%d of %d probes", (int)broken, (int)probes->count);
}

/* Anywhere in the bounds, around them, and where no position is. */
static inline void hard_check_volume(const lmb_volume *volume)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const float low[3] = {(float)info.bounds_min.x, (float)info.bounds_min.y, (float)info.bounds_min.z};
    const float high[3] = {(float)info.bounds_max.x, (float)info.bounds_max.y, (float)info.bounds_max.z};
    uint64_t state = 1;
    int broken = 0;
    for (int i = 0; i < 500; ++i) {
        float at[3];
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = low[axis] + (high[axis] - low[axis]) * (float)(1.2 * fixture_random(&state) - 0.1);
        }
        const lmb_vec3 position = {i == 0 ? NAN : at[0], i == 1 ? INFINITY : at[1], at[2]};
        lmb_sh3_rgb radiance;
        lmb_volume_sample(volume, position, &radiance);
        bool good = sh_is_finite(&radiance);
        for (int k = 0; k < 6; ++k) {
            const float sign = k % 2 ? 1.0f : -1.0f;
            const lmb_vec3 normal = {k / 2 == 0 ? sign : 0.0f, k / 2 == 1 ? sign : 0.0f, k / 2 == 2 ? sign : 0.0f};
            good = good && rgb_is_light(lmb_sh3_rgb_irradiance(&radiance, normal));
        }
        broken += !good;
    }
    CHECK(broken == 0, "%d of 500 points", broken);
}

static inline void hard_check_lightmap(const lmb_lightmap *lightmap)
{
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        size_t broken = 0;
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            const lmb_irradz texel = image_irradz(image, k);
            broken +=
                !(rgb_is_light(texel.irradiance_z) && texel.ambient_weight >= 0.0f && texel.ambient_weight <= 1.0f &&
                  isfinite(texel.direction.x) && isfinite(texel.direction.y) && isfinite(texel.direction.z));
        }
        CHECK(broken == 0, "%zu texels of image %d", broken, (int)i);
    }
}

static inline bool hard_bake_volume(hard_level *level, const hard_settings *settings)
{
    lmb_error error = {{0}};
    lmb_placement_settings placement = lmb_placement_settings_default();
    placement.spacing = settings->spacing;
    lmb_result result = lmb_placement_make(level->traced.tracer, &placement, level->traced.pool, &level->probes,
                                           &level->placement, &error);
    if (result == LMB_OK) {
        result =
            lmb_probes_bake(level->probes, &level->traced.transport, &(lmb_gather_effort){.samples = settings->samples},
                            level->traced.pool, NULL, &level->baked);
    }
    size_t size = 0;
    if (result == LMB_OK) {
        hard_check_probes(level->probes);
        result = lmb_pack(level->probes, &level->file, &size, &level->packed);
    }
    if (result == LMB_OK) {
        result = lmb_volume_open_memory(level->file, size, &level->volume);
    }
    CHECK(result == LMB_OK, "volume: %s: %s", lmb_result_text(result), error.message);
    if (result == LMB_OK) {
        hard_check_volume(level->volume);
    }
    return result == LMB_OK;
}

static inline bool hard_bake_lightmap(hard_level *level, const hard_settings *settings)
{
    lmb_error error = {{0}};
    const lmb_lightmap_settings layout = {.texels_per_m = settings->texels_per_m, .max_image_size = 256};
    lmb_result result = lmb_lightmap_create(level->traced.scene, &layout, &level->lightmap, &error);
    if (result == LMB_OK) {
        result = lmb_lightmap_bake(level->lightmap, &level->traced.transport,
                                   &(lmb_gather_effort){.samples = settings->samples}, level->traced.pool, NULL,
                                   &level->lit);
    }
    CHECK(result == LMB_OK, "lightmap: %s: %s", lmb_result_text(result), error.message);
    if (result == LMB_OK) {
        hard_check_lightmap(level->lightmap);
    }
    return result == LMB_OK;
}

/* Takes the level at `path` all the way. False when a step failed, which is a failed check; then all is closed. */
static inline bool hard_bake(hard_level *level, const char *path, const char *environment,
                             const hard_settings *settings)
{
    memset(level, 0, sizeof *level);
    if (!level_fixture_load(&level->traced, path, environment, 2)) {
        return false;
    }
    if (hard_bake_volume(level, settings) && hard_bake_lightmap(level, settings)) {
        return true;
    }
    hard_close(level);
    return false;
}

/* Normalised irradiance that the packed volume gives. */
static inline lmb_rgb hard_sample(const hard_level *level, lmb_vec3 position, lmb_vec3 normal)
{
    lmb_sh3_rgb radiance;
    lmb_volume_sample(level->volume, position, &radiance);
    return lmb_sh3_rgb_irradiance(&radiance, normal);
}

/* Number of the instance with this name; 0, and a failed check, when there is none. */
static inline uint32_t hard_instance(const lmb_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (strcmp(scene->instances[i].name, name) == 0) {
            return i;
        }
    }
    CHECK(false, "no instance '%s'", name);
    return 0;
}

/* Normalised irradiance that the lightmap stores at the middle of a triangle. */
static inline lmb_rgb hard_texel(const hard_level *level, const char *instance, uint32_t triangle)
{
    const uint32_t index = hard_instance(level->traced.scene, instance);
    return sample_irradz(level->lightmap, index, triangle, 0.3f, 0.3f).irradiance_z;
}

/* --- levels ---------------------------------------------------------------------------------------------------- */

static inline int hard_material(lmb_level_builder *builder, float albedo, float emission)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = "plain";
    material.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    material.emission = (lmb_rgb){{emission, emission, emission}};
    return lmb_level_builder_add_material(builder, &material);
}

static inline void hard_add_light(lmb_level_builder *builder, lmb_level_light_type type, float intensity,
                                  lmb_vec3 position)
{
    const lmb_level_light light = {"light", type, {{1.0f, 1.0f, 1.0f}}, intensity, 0.0f, 0.0f, 0.0f};
    lmb_level_node node = lmb_level_node_default("light");
    node.light = lmb_level_builder_add_light(builder, &light);
    node.translation = position;
    lmb_level_look_along((lmb_vec3){0.0f, -1.0f, 0.0f}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

/* A mesh of its own for one box, in place. */
static inline void hard_add_box(lmb_level_builder *builder, const char *name, int material, lmb_vec3 min, lmb_vec3 max,
                                bool inward)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    lmb_level_box box = lmb_level_box_of(min, max, material);
    box.inward = inward;
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_builder_place(builder, name, mesh, (lmb_vec3){0.0f, 0.0f, 0.0f});
}

/* The same for a level square that looks up. */
static inline void hard_add_floor(lmb_level_builder *builder, const char *name, int material, lmb_vec3 centre,
                                  float size)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-size / 2, 0, size / 2}, (lmb_vec3){size, 0, 0},
                               (lmb_vec3){0, 0, -size});
    lmb_level_builder_place(builder, name, mesh, centre);
}

/* Writes the level to `path` and frees the builder. */
static inline bool hard_write(lmb_level_builder *builder, const char *path)
{
    lmb_error error = {{0}};
    const lmb_result result = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

#endif
