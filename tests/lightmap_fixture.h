/* A level with its lightmap, for the tests of lightmaps and of their files. */
#ifndef LMB_TESTS_LIGHTMAP_FIXTURE_H
#define LMB_TESTS_LIGHTMAP_FIXTURE_H

#include <lambent/lightmap.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "irradz_fixture.h"
#include "level_builder.h"
#include "level_fixture.h"
#include "levels.h"

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/" name

typedef struct baked {
    level_fixture level;
    lmb_lightmap *lightmap;
    lmb_gather_stats stats;
} baked;

static inline void baked_close(baked *bake)
{
    lmb_lightmap_destroy(bake->lightmap);
    level_fixture_close(&bake->level);
}

static inline bool lightmap_make(baked *bake, float texels_per_m, int32_t max_image_size)
{
    lmb_error error = {""};
    const lmb_lightmap_settings settings = {.texels_per_m = texels_per_m, .max_image_size = max_image_size};
    bake->lightmap = NULL;
    const lmb_result result = lmb_lightmap_create(bake->level.scene, &settings, &bake->lightmap, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static inline bool lightmap_bake(baked *bake, uint32_t samples)
{
    const lmb_result result =
        lmb_lightmap_bake(bake->lightmap, &bake->level.transport, &(lmb_gather_effort){.samples = samples},
                          bake->level.pool, NULL, &bake->stats);
    CHECK(result == LMB_OK, "%s", lmb_result_text(result));
    return result == LMB_OK;
}

typedef struct baked_settings {
    float texels_per_m;
    uint32_t samples;
    int threads;
} baked_settings;

/* A level that was written to `path`, with its lightmap baked. */
static inline bool baked_open(baked *bake, const char *path, lmb_result written, lmb_error *error,
                              baked_settings settings)
{
    if (!level_fixture_open(&bake->level, path, written, error, settings.threads)) {
        return false;
    }
    if (lightmap_make(bake, settings.texels_per_m, 1024) && lightmap_bake(bake, settings.samples)) {
        return true;
    }
    baked_close(bake);
    return false;
}

static inline bool irradz_is_sane(const lmb_irradz *texel)
{
    bool good = isfinite(texel->ambient_weight) && isfinite(texel->direction.x) && isfinite(texel->direction.y) &&
                isfinite(texel->direction.z) && texel->ambient_weight >= 0.0f && texel->ambient_weight <= 1.0f;
    for (int c = 0; c < 3; ++c) {
        good = good && isfinite(texel->irradiance_z.c[c]) && texel->irradiance_z.c[c] >= 0.0f;
    }
    return good;
}

/* Texels in the given state over all images; checks that every texel is sane. */
static inline uint64_t count_state(const lmb_lightmap *lightmap, lmb_texel_state state)
{
    uint64_t count = 0;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        size_t broken = 0;
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            count += image->state[k] == (uint8_t)state;
            const lmb_irradz texel = image_irradz(image, k);
            broken += !irradz_is_sane(&texel);
        }
        CHECK(broken == 0, "%zu texels of image %d", broken, (int)i);
    }
    return count;
}

static inline int plain_material(lmb_level_builder *builder, float albedo)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = "plain";
    material.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    return lmb_level_builder_add_material(builder, &material);
}

static inline void add_sun(lmb_level_builder *builder, float lux)
{
    const lmb_level_light sun = {"sun", LMB_LEVEL_LIGHT_DIRECTIONAL, {{1.0f, 1.0f, 1.0f}}, lux, 0.0f, 0.0f, 0.0f};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    lmb_level_look_along((lmb_vec3){0.0f, -1.0f, 0.0f}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

/* Tiles of one mesh: in the sun, under a roof, three times as large, and dynamic. */
static inline lmb_result write_tiles(const char *path, float lux, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.0f);
    const int tile = lmb_level_builder_add_mesh(builder, "tile");
    lmb_level_builder_add_quad(builder, tile, material, (lmb_vec3){-1, 0, 1}, (lmb_vec3){2, 0, 0},
                               (lmb_vec3){0, 0, -2});
    lmb_level_builder_place(builder, "open", tile, (lmb_vec3){0, 0, 0});
    lmb_level_builder_place(builder, "covered", tile, (lmb_vec3){10, 0, 0});
    lmb_level_node scaled = lmb_level_node_default("large");
    scaled.mesh = tile;
    scaled.translation = (lmb_vec3){-20, 0, 0};
    scaled.scale = (lmb_vec3){3, 3, 3};
    lmb_level_builder_add_node(builder, &scaled);
    lmb_level_node moving = lmb_level_node_default("moving");
    moving.mesh = tile;
    moving.translation = (lmb_vec3){0, 5, 0};
    moving.dynamic = true;
    lmb_level_builder_add_node(builder, &moving);
    const int roof = lmb_level_builder_add_mesh(builder, "roof");
    lmb_level_builder_add_quad(builder, roof, material, (lmb_vec3){6, 2, 4}, (lmb_vec3){8, 0, 0}, (lmb_vec3){0, 0, -8});
    lmb_level_builder_place(builder, "roof", roof, (lmb_vec3){0, 0, 0});
    add_sun(builder, lux);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static inline uint32_t corner_apart(const uint32_t triangle[3], const uint32_t other[3])
{
    for (int k = 0; k < 3; ++k) {
        if (triangle[k] != other[0] && triangle[k] != other[1] && triangle[k] != other[2]) {
            return triangle[k];
        }
    }
    return triangle[0];
}

/* Lays the second triangle of a quad on the first. */
static inline void quad_fold(lmb_mesh *mesh, const uint32_t first[3], const uint32_t second[3])
{
    mesh->uv[1][corner_apart(second, first)] = mesh->uv[1][corner_apart(first, second)];
}

/* A mesh's TEXCOORD_1, broken in the named way. */
static inline void uv_break(lmb_mesh *mesh, lmb_uv_fault fault)
{
    switch (fault) {
    case LMB_UV_MISSING:
        free(mesh->uv[1]);
        mesh->uv[1] = NULL;
        break;
    case LMB_UV_OUT_OF_RANGE:
        for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
            mesh->uv[1][i].x *= 3.0f;
        }
        break;
    case LMB_UV_DEGENERATE:
        for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
            mesh->uv[1][i] = (lmb_vec2){0.5f, 0.5f};
        }
        break;
    case LMB_UV_OVERLAPPING:
        for (uint32_t t = 0; t + 1 < mesh->triangle_count; t += 2) {
            quad_fold(mesh, mesh->triangle[t], mesh->triangle[t + 1]);
        }
        break;
    default:
        break;
    }
}

#endif
