/* Lightmaps: light that is known, lookups, padding, places of instances, and the files. */
#define _POSIX_C_SOURCE 200809L
#include <lambent/lightmap.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/file.h>

#include "level_fixture.h"
#include "level_builder.h"
#include "levels.h"

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/" name

typedef struct baked {
    level_fixture level;
    lmb_lightmap *lightmap;
    lmb_lightmap_stats stats;
} baked;

static void baked_close(baked *bake)
{
    lmb_lightmap_destroy(bake->lightmap);
    level_fixture_close(&bake->level);
}

static bool lightmap_make(baked *bake, float texels_per_m, int32_t max_image_size)
{
    lmb_error error = {""};
    const lmb_lightmap_settings settings = {texels_per_m, max_image_size};
    bake->lightmap = NULL;
    const lmb_result result = lmb_lightmap_create(bake->level.scene, &settings, &bake->lightmap, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static bool lightmap_bake(baked *bake, uint32_t samples)
{
    const lmb_result result =
        lmb_lightmap_bake(bake->lightmap, &bake->level.transport, samples, bake->level.pool, NULL, &bake->stats);
    CHECK(result == LMB_OK, "%s", lmb_result_text(result));
    return result == LMB_OK;
}

/* A level that was written to `path`, with its lightmap baked. */
static bool baked_open(baked *bake, const char *path, lmb_result written, lmb_error *error, float texels_per_m,
                       uint32_t samples, int threads)
{
    if (!level_fixture_open(&bake->level, path, written, error, threads)) {
        return false;
    }
    if (lightmap_make(bake, texels_per_m, 1024) && lightmap_bake(bake, samples)) {
        return true;
    }
    baked_close(bake);
    return false;
}

static bool irradz_is_sane(const lmb_irradz *texel)
{
    bool good = isfinite(texel->ambient_weight) && isfinite(texel->direction.x) && isfinite(texel->direction.y) &&
                isfinite(texel->direction.z) && texel->ambient_weight >= 0.0f && texel->ambient_weight <= 1.0f;
    for (int c = 0; c < 3; ++c) {
        good = good && isfinite(texel->irradiance_z.c[c]) && texel->irradiance_z.c[c] >= 0.0f;
    }
    return good;
}

/* Texels in the given state over all images; checks that every texel is sane. */
static uint64_t count_state(const lmb_lightmap *lightmap, lmb_texel_state state)
{
    uint64_t count = 0;
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        size_t broken = 0;
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            count += image->state[k] == (uint8_t)state;
            broken += !irradz_is_sane(&image->texel[k]);
        }
        CHECK(broken == 0, "%zu texels of image %d", broken, (int)i);
    }
    return count;
}

/* A repeatable number in [0, 1). */
static float number_next(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(*seed >> 8) / 16777216.0f;
}

static lmb_vec2 uv_at(const lmb_lightmap *lightmap, uint32_t instance, uint32_t triangle, float u, float v)
{
    const uint32_t number = lightmap->scene->instances[instance].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[number];
    lmb_vec2 sum = {0.0f, 0.0f};
    const float weight[3] = {1.0f - u - v, u, v};
    for (int k = 0; k < 3; ++k) {
        const lmb_vec2 corner = lightmap->corner_uv[number] ? lightmap->corner_uv[number][3 * triangle + (uint32_t)k]
                                                            : mesh->uv[1][mesh->triangle[triangle][k]];
        sum.x += weight[k] * corner.x;
        sum.y += weight[k] * corner.y;
    }
    return sum;
}

/* Where a point of a triangle lies in its image, in texels: by the documented offset and scale. */
static lmb_vec2 texels_at(const lmb_lightmap *lightmap, uint32_t instance, uint32_t triangle, float u, float v)
{
    const lmb_lightmap_region *region = &lightmap->region[instance];
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    const lmb_vec2 uv = uv_at(lightmap, instance, triangle, u, v);
    return (lmb_vec2){(uv.x * region->scale.x + region->offset.x) * (float)image->width,
                      (uv.y * region->scale.y + region->offset.y) * (float)image->height};
}

/* Points all over the surfaces: the texel under each was gathered, and the four that bilinear filtering reads hold
 * light. A point within a thousandth of a texel of the border may belong to the neighbour. */
static void check_filled(const lmb_lightmap *lightmap, uint32_t points_per_triangle)
{
    uint32_t seed = 1;
    uint64_t empty = 0, ungathered = 0, outside = 0;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        const lmb_lightmap_region *region = &lightmap->region[i];
        if (region->image < 0) {
            continue;
        }
        const lmb_lightmap_image *image = &lightmap->image[region->image];
        const uint32_t triangles = lightmap->scene->meshes[lightmap->scene->instances[i].mesh].triangle_count;
        for (uint32_t k = 0; k < triangles * points_per_triangle; ++k) {
            const uint32_t t = k / points_per_triangle;
            /* Corners and edges first. */
            const uint32_t turn = k % points_per_triangle;
            float u = turn == 1 ? 1.0f : turn == 0 || turn == 2 || turn == 4 ? 0.0f : number_next(&seed);
            float v = turn == 2 ? 1.0f : turn == 0 || turn == 1 || turn == 3 ? 0.0f : number_next(&seed);
            if (u + v > 1.0f) {
                u = 1.0f - u;
                v = 1.0f - v;
            }
            const lmb_vec2 at = texels_at(lightmap, i, t, u, v);
            const float fx = at.x - floorf(at.x), fy = at.y - floorf(at.y);
            if (fx > 2e-3f && fx < 0.998f && fy > 2e-3f && fy < 0.998f) {
                const size_t pixel = (size_t)at.y * (size_t)image->width + (size_t)at.x;
                ungathered += image->state[pixel] != LMB_TEXEL_GATHERED;
            }
            const int32_t x = (int32_t)floorf(at.x - 0.5f), y = (int32_t)floorf(at.y - 0.5f);
            for (int32_t n = 0; n < 4; ++n) {
                const int32_t nx = x + (n & 1), ny = y + (n >> 1);
                if (nx < 0 || ny < 0 || nx >= image->width || ny >= image->height) {
                    ++outside;
                } else {
                    empty += image->state[(size_t)ny * (size_t)image->width + (size_t)nx] == LMB_TEXEL_EMPTY;
                }
            }
        }
    }
    CHECK(empty == 0 && ungathered == 0 && outside == 0, "%llu empty, %llu not gathered, %llu outside the image",
          (unsigned long long)empty, (unsigned long long)ungathered, (unsigned long long)outside);
}

static void furnace(void)
{
    static const float ALBEDO[] = {0.0f, 0.5f, 0.8f};
    for (size_t i = 0; i < sizeof ALBEDO / sizeof ALBEDO[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("lightmap_furnace.glb");
        const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
        const lmb_result written = lmb_level_furnace(path, 2.0f, ALBEDO[i], one, false, &error);
        baked bake;
        if (!baked_open(&bake, path, written, &error, 4.0f, 256, 2)) {
            return;
        }
        const float truth = 1.0f / (1.0f - ALBEDO[i]);
        float worst = 0.0f;
        double sum = 0.0;
        const lmb_lightmap_image *image = &bake.lightmap->image[0];
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            if (image->state[k] == LMB_TEXEL_GATHERED) {
                worst = fmaxf(worst, fabsf(image->texel[k].irradiance_z.c[1] - truth));
                sum += (double)image->texel[k].irradiance_z.c[1];
            }
        }
        CHECK(worst < 0.25f * truth, "albedo %g: off by %g of %g", (double)ALBEDO[i], (double)worst, (double)truth);
        CHECK_NEAR(sum / (double)bake.stats.texels, truth, 0.005f * truth, "albedo %g", (double)ALBEDO[i]);
        CHECK(bake.stats.texels == bake.lightmap->covered_texel_count &&
                  bake.stats.texels == count_state(bake.lightmap, LMB_TEXEL_GATHERED),
              "%llu texels", (unsigned long long)bake.stats.texels);
        CHECK(bake.stats.pushed_out == 0, "%llu pushed out", (unsigned long long)bake.stats.pushed_out);
        CHECK(bake.stats.rays >= 256 * bake.stats.texels, "%llu rays", (unsigned long long)bake.stats.rays);
        baked_close(&bake);
    }
}

static void sun_on_plane(void)
{
    static const struct {
        lmb_vec3 direction;
        float lux;
    } CASES[] = {{{0.0f, -1.0f, 0.0f}, 3.0f}, {{0.6f, -0.8f, 0.0f}, 10.0f}, {{0.1f, -0.3f, 0.9f}, 1.0f}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("lightmap_sun.glb");
        const lmb_vec3 d = CASES[i].direction;
        const lmb_result written = lmb_level_sun_plane(path, 0.5f, d, CASES[i].lux, &error);
        baked bake;
        if (!baked_open(&bake, path, written, &error, 1.0f, 8, 1)) {
            return;
        }
        const double length = sqrt((double)(d.x * d.x + d.y * d.y + d.z * d.z));
        const double truth = (double)CASES[i].lux * (double)-d.y / length / 3.14159265358979;
        const lmb_lightmap_image *image = &bake.lightmap->image[0];
        double worst = 0.0;
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            if (image->state[k] != LMB_TEXEL_EMPTY) {
                worst = fmax(worst, fabs((double)image->texel[k].irradiance_z.c[0] - truth));
            }
        }
        CHECK(worst <= 1e-4 * truth, "case %zu: off by %g of %g", i, worst, truth);
        baked_close(&bake);
    }
}

/* Texels that are a linear function of their place read back as that function, wherever bilinear filtering reads. */
static void bilinear_lookup(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_lookup.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    if (lightmap_make(&bake, 8.0f, 1024)) {
        for (int32_t i = 0; i < bake.lightmap->image_count; ++i) {
            lmb_lightmap_image *image = &bake.lightmap->image[i];
            for (int32_t k = 0; k < image->width * image->height; ++k) {
                const float x = (float)(k % image->width) + 0.5f, y = (float)(k / image->width) + 0.5f;
                image->texel[k] = (lmb_irradz){{{x, y, x + y}}, 0.5f, {x, -y, 1.0f}};
            }
        }
        uint32_t seed = 7;
        for (uint32_t i = 0; i < bake.level.scene->instance_count; ++i) {
            const uint32_t triangles = bake.level.scene->meshes[bake.level.scene->instances[i].mesh].triangle_count;
            for (uint32_t k = 0; k < 8 * triangles; ++k) {
                const uint32_t turn = k % 8;
                const float along = number_next(&seed);
                const float u = turn == 1   ? 1.0f
                                : turn == 3 ? along
                                : turn == 5 ? 1.0f - along
                                : turn > 5  ? 0.3f
                                            : 0.0f;
                const float v = turn == 2 ? 1.0f : turn == 4 || turn == 5 ? along : turn > 5 ? 0.2f : 0.0f;
                const lmb_vec2 at = texels_at(bake.lightmap, i, k / 8, u, v);
                const lmb_irradz found = lmb_lightmap_sample(bake.lightmap, i, k / 8, u, v);
                CHECK_NEAR(found.irradiance_z.c[0], at.x, 1e-3, "instance %u triangle %u (%g, %g)", i, k / 8, (double)u,
                           (double)v);
                CHECK_NEAR(found.irradiance_z.c[1], at.y, 1e-3, "instance %u triangle %u", i, k / 8);
                CHECK_NEAR(found.direction.y, -at.y, 1e-3, "instance %u triangle %u", i, k / 8);
                CHECK_NEAR(found.ambient_weight, 0.5, 1e-6, "instance %u", i);
            }
        }
    }
    baked_close(&bake);
}

static bool regions_overlap(const lmb_lightmap_region *a, const lmb_lightmap_region *b)
{
    return a->image == b->image && a->x - 1 < b->x + b->width + 1 && b->x - 1 < a->x + a->width + 1 &&
           a->y - 1 < b->y + b->height + 1 && b->y - 1 < a->y + a->height + 1;
}

static void check_regions_apart(const lmb_lightmap *lightmap)
{
    const uint32_t count = lightmap->scene->instance_count;
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_lightmap_region *a = &lightmap->region[i];
        if (a->image < 0) {
            continue;
        }
        const lmb_lightmap_image *image = &lightmap->image[a->image];
        CHECK(a->x >= 1 && a->y >= 1 && a->x + a->width + 1 <= image->width && a->y + a->height + 1 <= image->height,
              "region %u leaves its image", i);
        for (uint32_t k = 0; k < i; ++k) {
            CHECK(lightmap->region[k].image < 0 || !regions_overlap(a, &lightmap->region[k]), "%u and %u overlap", i,
                  k);
        }
    }
}

static int plain_material(lmb_level_builder *builder, float albedo)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = "plain";
    material.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    return lmb_level_builder_add_material(builder, &material);
}

static void add_sun(lmb_level_builder *builder, float lux)
{
    const lmb_level_light sun = {"sun", LMB_LEVEL_LIGHT_DIRECTIONAL, {{1.0f, 1.0f, 1.0f}}, lux, 0.0f, 0.0f, 0.0f};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    lmb_level_look_along((lmb_vec3){0.0f, -1.0f, 0.0f}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

/* Three tiles of one mesh, the second under a roof, the third turned over, scaled and dynamic parts beside. */
static lmb_result write_tiles(const char *path, float lux, lmb_error *error)
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

static const lmb_instance *instance_named(const lmb_scene *scene, const char *name, uint32_t *number)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (strcmp(scene->instances[i].name, name) == 0) {
            *number = i;
            return &scene->instances[i];
        }
    }
    CHECK(false, "no node %s", name);
    *number = 0;
    return NULL;
}

static void instances_have_own_places(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_tiles.glb");
    baked bake;
    if (!baked_open(&bake, path, write_tiles(path, 3.0f, &error), &error, 4.0f, 8, 2)) {
        return;
    }
    const lmb_lightmap *lightmap = bake.lightmap;
    check_regions_apart(lightmap);
    uint32_t open, covered, large, moving;
    instance_named(bake.level.scene, "open", &open);
    instance_named(bake.level.scene, "covered", &covered);
    instance_named(bake.level.scene, "large", &large);
    instance_named(bake.level.scene, "moving", &moving);
    CHECK(lightmap->region[moving].image == -1, "the dynamic tile has a region");
    const double lit = 3.0 / 3.14159265358979;
    CHECK_NEAR(lmb_lightmap_sample(lightmap, open, 0, 0.3f, 0.3f).irradiance_z.c[0], lit, 1e-3, "open");
    CHECK_NEAR(lmb_lightmap_sample(lightmap, covered, 0, 0.3f, 0.3f).irradiance_z.c[0], 0.0, 0.0, "covered");
    CHECK_NEAR(lmb_lightmap_sample(lightmap, moving, 0, 0.3f, 0.3f).irradiance_z.c[0], 0.0, 0.0, "moving");
    CHECK_NEAR(lightmap->region[large].width, 3 * lightmap->region[open].width, 3, "three times the size");
    CHECK_NEAR(lmb_lightmap_texel_size(lightmap, open), 0.25, 0.03, "metres a texel");
    CHECK_NEAR(lmb_lightmap_texel_size(lightmap, large), 0.25, 0.03, "metres a texel");
    check_filled(lightmap, 200);
    baked_close(&bake);
}

static uint32_t corner_apart(const uint32_t triangle[3], const uint32_t other[3])
{
    for (int k = 0; k < 3; ++k) {
        if (triangle[k] != other[0] && triangle[k] != other[1] && triangle[k] != other[2]) {
            return triangle[k];
        }
    }
    return triangle[0];
}

/* Lays the second triangle of a quad on the first. */
static void quad_fold(lmb_mesh *mesh, const uint32_t first[3], const uint32_t second[3])
{
    mesh->uv[1][corner_apart(second, first)] = mesh->uv[1][corner_apart(first, second)];
}

/* A mesh's TEXCOORD_1, broken in the named way. */
static void uv_break(lmb_mesh *mesh, lmb_uv_fault fault)
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

static void faults_get_charts(void)
{
    static const lmb_uv_fault FAULTS[] = {LMB_UV_GOOD, LMB_UV_MISSING, LMB_UV_OUT_OF_RANGE, LMB_UV_DEGENERATE,
                                          LMB_UV_OVERLAPPING};
    for (size_t i = 0; i < sizeof FAULTS / sizeof FAULTS[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("lightmap_faults.glb");
        baked bake;
        if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 2)) {
            return;
        }
        for (uint32_t m = 0; m < bake.level.scene->mesh_count; ++m) {
            uv_break(&bake.level.scene->meshes[m], FAULTS[i]);
        }
        if (lightmap_make(&bake, 8.0f, 1024)) {
            for (uint32_t m = 0; m < bake.level.scene->mesh_count; ++m) {
                CHECK(bake.lightmap->fault[m] == FAULTS[i], "mesh %u: %s, not %s", m,
                      lmb_uv_fault_text(bake.lightmap->fault[m]), lmb_uv_fault_text(FAULTS[i]));
                CHECK((bake.lightmap->corner_uv[m] != NULL) == (FAULTS[i] != LMB_UV_GOOD), "mesh %u", m);
            }
            check_regions_apart(bake.lightmap);
            if (lightmap_bake(&bake, 8)) {
                check_filled(bake.lightmap, 100);
                CHECK(count_state(bake.lightmap, LMB_TEXEL_DILATED) > 0, "no padding");
            }
        }
        baked_close(&bake);
    }
}

static lmb_vec3 triangle_normal(const lmb_mesh *mesh, uint32_t triangle)
{
    const lmb_vec3 *p = mesh->position;
    const uint32_t *corner = mesh->triangle[triangle];
    const lmb_vec3 a = p[corner[0]], b = p[corner[1]], c = p[corner[2]];
    const float ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    const float x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    const float length = sqrtf(x * x + y * y + z * z);
    return (lmb_vec3){x / length, y / length, z / length};
}

/* Which way the surface under each covered texel faces, from points all over it; then no filtered lookup may read a
 * covered texel that faces another way. Boxes have nothing but charts that face along an axis. */
static uint64_t count_bleeding(const lmb_lightmap *lightmap, uint32_t instance, int8_t *facing)
{
    const lmb_lightmap_image *image = &lightmap->image[lightmap->region[instance].image];
    const lmb_mesh *mesh = &lightmap->scene->meshes[lightmap->scene->instances[instance].mesh];
    uint64_t wrong = 0;
    for (int pass = 0; pass < 2; ++pass) {
        uint32_t seed = 11;
        for (uint32_t k = 0; k < 20000; ++k) {
            const uint32_t t = k % mesh->triangle_count;
            float u = number_next(&seed), v = number_next(&seed);
            if (u + v > 1.0f) {
                u = 1.0f - u;
                v = 1.0f - v;
            }
            const lmb_vec3 n = triangle_normal(mesh, t);
            const int8_t way = (int8_t)lroundf(n.x + 3.0f * n.y + 9.0f * n.z);
            const lmb_vec2 at = texels_at(lightmap, instance, t, u, v);
            if (pass == 0) {
                facing[(size_t)at.y * (size_t)image->width + (size_t)at.x] = way;
                continue;
            }
            const int32_t x = (int32_t)floorf(at.x - 0.5f), y = (int32_t)floorf(at.y - 0.5f);
            for (int32_t i = 0; i < 4; ++i) {
                const int8_t found = facing[(y + (i >> 1)) * image->width + x + (i & 1)];
                wrong += found != 0 && found != way;
            }
        }
    }
    return wrong;
}

static void charts_do_not_bleed(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_bleeding.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    for (uint32_t m = 0; m < bake.level.scene->mesh_count; ++m) {
        uv_break(&bake.level.scene->meshes[m], LMB_UV_MISSING);
    }
    static const float DENSITY[] = {2.0f, 7.3f, 20.0f};
    for (size_t i = 0; i < sizeof DENSITY / sizeof DENSITY[0]; ++i) {
        if (lightmap_make(&bake, DENSITY[i], 1024)) {
            const lmb_lightmap_image *image = &bake.lightmap->image[0];
            int8_t *facing = calloc((size_t)image->width * (size_t)image->height, 1);
            for (uint32_t k = 0; facing && k < bake.level.scene->instance_count; ++k) {
                const uint64_t wrong = count_bleeding(bake.lightmap, k, facing);
                CHECK(wrong == 0, "%g texels/m, instance %u: %llu lookups", (double)DENSITY[i], k,
                      (unsigned long long)wrong);
            }
            free(facing);
            lmb_lightmap_destroy(bake.lightmap);
        }
    }
    bake.lightmap = NULL;
    baked_close(&bake);
}

static void empty_level(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_empty.glb");
    const char *directory = OUTPUT("lightmap_empty");
    mkdir(directory, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    add_sun(builder, 1.0f);
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    baked bake;
    if (!baked_open(&bake, path, written, &error, 1.0f, 8, 2)) {
        return;
    }
    CHECK(bake.lightmap->image_count == 0 && bake.stats.texels == 0, "%d images", (int)bake.lightmap->image_count);
    CHECK(lmb_lightmap_settings_default(bake.level.scene).texels_per_m > 0.0f, "no default");
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK && bytes > 0, "%s",
          error.message);
    CHECK(lmb_lightmap_read(bake.lightmap, directory, &error) == LMB_OK, "%s", error.message);
    baked_close(&bake);
}

static void charts_go_into_a_level(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_charts.glb");
    const char *directory = OUTPUT("lightmap_charts");
    mkdir(directory, 0777);
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    for (uint32_t m = 0; m < bake.level.scene->mesh_count; ++m) {
        uv_break(&bake.level.scene->meshes[m], LMB_UV_MISSING);
    }
    uint64_t bytes = 0;
    lmb_scene *again = NULL;
    if (lightmap_make(&bake, 8.0f, 1024) &&
        lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK &&
        lmb_gltf_load(OUTPUT("lightmap_charts/level_uv2.glb"), NULL, &again, &error) == LMB_OK) {
        CHECK(again->mesh_count == bake.level.scene->mesh_count, "%u meshes", again->mesh_count);
        for (uint32_t m = 0; m < again->mesh_count && m < bake.level.scene->mesh_count; ++m) {
            const lmb_mesh *mesh = &again->meshes[m];
            CHECK(mesh->triangle_count == bake.level.scene->meshes[m].triangle_count && mesh->uv[1], "mesh %u", m);
            for (uint32_t k = 0; mesh->uv[1] && k < 3 * mesh->triangle_count; ++k) {
                const lmb_vec2 found = mesh->uv[1][mesh->triangle[k / 3][k % 3]];
                CHECK_NEAR(found.x, bake.lightmap->corner_uv[m][k].x, 0.0, "mesh %u corner %u", m, k);
                CHECK_NEAR(found.y, bake.lightmap->corner_uv[m][k].y, 0.0, "mesh %u corner %u", m, k);
            }
        }
    } else {
        CHECK(false, "%s", error.message);
    }
    lmb_scene_destroy(again);
    baked_close(&bake);
}

/* fp16 keeps 11 bits; below 2^-14 it steps by 2^-24. */
static bool half_near(float stored, float value, float scale)
{
    return fabsf(stored - value) <= fmaxf(fabsf(value) * 0x1p-11f, scale * 0x1p-25f) * 1.001f;
}

static void check_read_back(const lmb_lightmap *written, const char *directory)
{
    lmb_error error = {""};
    lmb_lightmap *read = NULL;
    if (lmb_lightmap_create(written->scene, &written->settings, &read, &error) != LMB_OK ||
        lmb_lightmap_read(read, directory, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        lmb_lightmap_destroy(read);
        return;
    }
    for (int32_t i = 0; i < written->image_count; ++i) {
        const lmb_lightmap_image *a = &written->image[i];
        const lmb_lightmap_image *b = &read->image[i];
        float brightest = 0.0f;
        const size_t texels = (size_t)a->width * (size_t)a->height;
        for (size_t k = 0; k < 3 * texels; ++k) {
            brightest = fmaxf(brightest, a->texel[k / 3].irradiance_z.c[k % 3]);
        }
        const float scale = fmaxf(brightest / 16384.0f, 1.0f);
        size_t wrong = 0;
        for (size_t k = 0; k < texels; ++k) {
            const lmb_irradz *x = &a->texel[k];
            const lmb_irradz *y = &b->texel[k];
            bool good = half_near(y->ambient_weight, x->ambient_weight, 1.0f) &&
                        half_near(y->direction.x, x->direction.x, 1.0f) &&
                        half_near(y->direction.y, x->direction.y, 1.0f) &&
                        half_near(y->direction.z, x->direction.z, 1.0f) && a->state[k] == b->state[k];
            for (int c = 0; c < 3; ++c) {
                good = good && half_near(y->irradiance_z.c[c], x->irradiance_z.c[c], scale);
            }
            wrong += !good;
        }
        CHECK(wrong == 0, "%zu texels of image %d", wrong, (int)i);
    }
    lmb_lightmap_destroy(read);
}

static void files_read_back(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_files.glb");
    const char *directory = OUTPUT("lightmap files \xc3\xa9");
    mkdir(directory, 0777);
    baked bake;
    if (!baked_open(&bake, path, lmb_level_cornell(path, &error), &error, 8.0f, 16, 2)) {
        return;
    }
    uint64_t bytes = 0;
    const lmb_result written = lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error);
    CHECK(written == LMB_OK && bytes > 0, "%s", error.message);
    check_read_back(bake.lightmap, directory);

    /* Another density is another layout, and nothing of the lightmap changes. */
    const lmb_lightmap_settings other = {9.0f, 1024};
    lmb_lightmap *lightmap = NULL;
    if (lmb_lightmap_create(bake.level.scene, &other, &lightmap, &error) == LMB_OK) {
        CHECK(lmb_lightmap_read(lightmap, directory, &error) == LMB_ERROR_FORMAT, "another layout was read");
        CHECK(strstr(error.message, "lightmap.json"), "%s", error.message);
        CHECK(lmb_lightmap_read(lightmap, OUTPUT("nowhere"), &error) == LMB_ERROR_IO, "%s", error.message);
        CHECK(count_state(lightmap, LMB_TEXEL_EMPTY) ==
                  (uint64_t)lightmap->image[0].width * (uint64_t)lightmap->image[0].height,
              "a failed read left texels");
        CHECK(lmb_lightmap_write(lightmap, OUTPUT("nowhere"), NULL, &bytes, &error) == LMB_ERROR_IO, "%s",
              error.message);
        lmb_lightmap_destroy(lightmap);
    }
    baked_close(&bake);
}

static void files_broken_are_refused(void)
{
    static const char *const TEXTS[] = {
        "",
        "{",
        "[]",
        "{\"format\": \"lambent lightmap\"}",
        "{\"format\": \"lambent lightmap\", \"version\": 2, \"encoding\": \"irradz-hhd\"}",
        "{\"format\": \"lambent lightmap\", \"version\": 1, \"encoding\": \"irradz-hhd\", "
        "\"images\": [3, null], \"nodes\": {}}",
        "{\"format\": \"lambent lightmap\", \"version\": 1, \"encoding\": \"irradz-hhd\", "
        "\"images\": [], \"nodes\": [{\"offset\": [1]}]}"};
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_broken.glb");
    const char *directory = OUTPUT("lightmap_broken");
    mkdir(directory, 0777);
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    if (lightmap_make(&bake, 4.0f, 1024)) {
        for (size_t i = 0; i < sizeof TEXTS / sizeof TEXTS[0]; ++i) {
            CHECK(lmb_file_write(OUTPUT("lightmap_broken/lightmap.json"), TEXTS[i], strlen(TEXTS[i]), &error) == LMB_OK,
                  "%s", error.message);
            CHECK(lmb_lightmap_read(bake.lightmap, directory, &error) == LMB_ERROR_FORMAT, "text %zu", i);
        }
    }
    baked_close(&bake);
}

static void sunlight_fits(void)
{
    static const float LUX[] = {1e6f, 1e-6f, 2e5f};
    for (size_t i = 0; i < sizeof LUX / sizeof LUX[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("lightmap_bright.glb");
        const char *directory = OUTPUT("lightmap_bright");
        mkdir(directory, 0777);
        baked bake;
        if (!baked_open(&bake, path, write_tiles(path, LUX[i], &error), &error, 2.0f, 8, 1)) {
            return;
        }
        uint64_t bytes = 0;
        CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK, "%s", error.message);
        check_read_back(bake.lightmap, directory);
        CHECK_NEAR(lmb_lightmap_sample(bake.lightmap, 0, 0, 0.3f, 0.3f).irradiance_z.c[0],
                   (double)LUX[i] / 3.14159265358979, 1e-3 * (double)LUX[i], "%g lux", (double)LUX[i]);
        baked_close(&bake);
    }
}

static void check_files_equal(const char *a, const char *b)
{
    unsigned char *data_a = NULL, *data_b = NULL;
    size_t size_a = 0, size_b = 0;
    lmb_error error = {""};
    const bool read =
        lmb_file_read(a, &data_a, &size_a, &error) == LMB_OK && lmb_file_read(b, &data_b, &size_b, &error) == LMB_OK;
    CHECK(read, "%s", error.message);
    CHECK(read && size_a == size_b && memcmp(data_a, data_b, size_a) == 0, "%s and %s differ", a, b);
    free(data_a);
    free(data_b);
}

static void threads_make_no_difference(void)
{
    static const int THREADS[] = {1, 2, 7};
    static const char *const DIRECTORIES[] = {OUTPUT("lightmap_t1"), OUTPUT("lightmap_t2"), OUTPUT("lightmap_t7")};
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_threads.glb");
    uint64_t pushed_out = 0;
    uint64_t rays = 0;
    for (size_t i = 0; i < 3; ++i) {
        mkdir(DIRECTORIES[i], 0777);
        baked bake;
        if (!baked_open(&bake, path, lmb_level_cornell(path, &error), &error, 8.0f, 16, THREADS[i])) {
            return;
        }
        uint64_t bytes = 0;
        CHECK(lmb_lightmap_write(bake.lightmap, DIRECTORIES[i], NULL, &bytes, &error) == LMB_OK, "%s", error.message);
        CHECK(i == 0 || (bake.stats.rays == rays && bake.stats.pushed_out == pushed_out), "%d threads", THREADS[i]);
        rays = bake.stats.rays;
        pushed_out = bake.stats.pushed_out;
        baked_close(&bake);
    }
    check_files_equal(OUTPUT("lightmap_t1/lightmap_0.exr"), OUTPUT("lightmap_t2/lightmap_0.exr"));
    check_files_equal(OUTPUT("lightmap_t1/lightmap_0.exr"), OUTPUT("lightmap_t7/lightmap_0.exr"));
    check_files_equal(OUTPUT("lightmap_t1/lightmap.json"), OUTPUT("lightmap_t2/lightmap.json"));
    check_files_equal(OUTPUT("lightmap_t1/lightmap.json"), OUTPUT("lightmap_t7/lightmap.json"));
}

/* OpenEXR's own tool reads the header. */
static void exrheader_shows_channels(void)
{
    static const char *const WANTED[] = {"R, 16-bit",     "w, 16-bit",        "d.X, 16-bit", "d.Z, 16-bit",
                                         "lambent:scale", "lambent:encoding", "irradz-hhd"};
    if (system("exrheader >/dev/null 2>&1 </dev/null") == 127 << 8) {
        test_skip("exrheader is not installed");
        return;
    }
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_header.glb");
    const char *directory = OUTPUT("lightmap_header");
    mkdir(directory, 0777);
    baked bake;
    if (!baked_open(&bake, path, write_tiles(path, 1.0f, &error), &error, 1.0f, 8, 1)) {
        return;
    }
    uint64_t bytes = 0;
    CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK, "%s", error.message);
    char shown[8192] = "";
    FILE *pipe = popen("exrheader '" OUTPUT("lightmap_header/lightmap_0.exr") "'", "r");
    if (pipe) {
        shown[fread(shown, 1, sizeof shown - 1, pipe)] = '\0';
        CHECK(pclose(pipe) == 0, "exrheader failed");
    }
    for (size_t i = 0; i < sizeof WANTED / sizeof WANTED[0]; ++i) {
        CHECK(strstr(shown, WANTED[i]), "no '%s' in:\n%s", WANTED[i], shown);
    }
    baked_close(&bake);
}

/* A floor with a solid block that stands in it, and a wall without thickness. */
static lmb_result write_block_on_floor(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.5f);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-4, 0, 4}, (lmb_vec3){8, 0, 0},
                               (lmb_vec3){0, 0, -8});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    const int block = lmb_level_builder_add_mesh(builder, "block");
    const lmb_level_box box = lmb_level_box_of((lmb_vec3){-1, -0.5f, -1}, (lmb_vec3){1, 1, 1}, material);
    lmb_level_builder_add_box(builder, block, &box);
    lmb_level_builder_place(builder, "block", block, (lmb_vec3){0, 0, 0});
    const int wall = lmb_level_builder_add_mesh(builder, "wall");
    lmb_level_builder_add_quad(builder, wall, material, (lmb_vec3){3, 0, 4}, (lmb_vec3){0, 0, -8}, (lmb_vec3){0, 3, 0});
    lmb_level_builder_place(builder, "wall", wall, (lmb_vec3){0, 0, 0});
    add_sun(builder, 1.0f);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void texels_leave_solids(void)
{
    static const struct {
        float x, z;
        bool pushed;
        float expected_x;
    } CASES[] = {
        {0.95f, 0.0f, true, 1.0f},   /* just inside the block */
        {-0.9f, 0.3f, true, -1.0f},  /* the same on the other side */
        {0.0f, 0.0f, false, 0.0f},   /* deep inside: nothing shows it */
        {1.05f, 0.0f, false, 1.05f}, /* outside, beside its front */
        {3.05f, 0.0f, false, 3.05f}, /* either side of the wall */
        {2.95f, 0.0f, false, 2.95f},
    };
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_solids.glb");
    level_fixture level;
    if (!level_fixture_open(&level, path, write_block_on_floor(path, &error), &error, 1)) {
        return;
    }
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; ++i) {
        const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
        const lmb_place place = {{CASES[i].x, 0.0f, CASES[i].z}, up, up};
        bool pushed = false;
        const lmb_gather_point point = lmb_surface_gather_point(level.tracer, &place, 0.2f, &pushed);
        CHECK(pushed == CASES[i].pushed, "case %zu", i);
        CHECK_NEAR(point.position.x, CASES[i].expected_x, 1e-4, "case %zu", i);
        CHECK(fabsf(point.position.x) > 1.0f || !pushed, "case %zu: still inside", i);
        CHECK(point.position.y > 0.0f && point.position.y < 1e-3f && point.hemisphere, "case %zu", i);
    }
    level_fixture_close(&level);
}

/* No texel that shows beside the block is dark: the sun stands above. */
static void block_has_no_dark_rim(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_solids.glb");
    baked bake;
    if (!baked_open(&bake, path, write_block_on_floor(path, &error), &error, 3.7f, 8, 2)) {
        return;
    }
    uint32_t floor;
    instance_named(bake.level.scene, "floor", &floor);
    CHECK(bake.stats.pushed_out > 0, "no texel was pushed out");
    uint32_t seed = 3;
    for (int i = 0; i < 2000; ++i) {
        float u = number_next(&seed), v = number_next(&seed);
        if (u + v > 1.0f) {
            u = 1.0f - u;
            v = 1.0f - v;
        }
        const lmb_place place = lmb_trace_place(bake.level.tracer, floor, 0, u, v);
        const float rim = fmaxf(fabsf(place.position.x), fabsf(place.position.z));
        if (rim > 1.0f && rim < 1.5f) {
            const lmb_irradz found = lmb_lightmap_sample(bake.lightmap, floor, 0, u, v);
            CHECK(found.irradiance_z.c[0] > 0.99f / 3.1415927f, "%g at (%g, %g)", (double)found.irradiance_z.c[0],
                  (double)place.position.x, (double)place.position.z);
        }
    }
    baked_close(&bake);
}

static bool stop_at_once(void *context, const char *phase, double done)
{
    (void)phase;
    (void)done;
    ++*(int *)context;
    return false;
}

static void bake_can_be_stopped(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_stop.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    int calls = 0;
    const lmb_progress progress = {stop_at_once, &calls};
    if (lightmap_make(&bake, 16.0f, 1024)) {
        const lmb_result result =
            lmb_lightmap_bake(bake.lightmap, &bake.level.transport, 64, bake.level.pool, &progress, &bake.stats);
        CHECK(result == LMB_ERROR_INTERRUPTED && calls > 0, "%s", lmb_result_text(result));
        CHECK(count_state(bake.lightmap, LMB_TEXEL_GATHERED) == 0, "a stopped bake left light");
    }
    baked_close(&bake);
}

static void settings_are_checked(void)
{
    static const lmb_lightmap_settings BAD[] = {{0.0f, 1024}, {-1.0f, 1024}, {NAN, 1024},   {INFINITY, 1024},
                                                {1.0f, 1000}, {1.0f, 0},     {1.0f, -1024}, {1.0f, 1 << 20}};
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_settings.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; ++i) {
        bake.lightmap = NULL;
        CHECK(lmb_lightmap_create(bake.level.scene, &BAD[i], &bake.lightmap, &error) == LMB_ERROR_ARGUMENT, "case %zu",
              i);
        CHECK(bake.lightmap == NULL, "case %zu", i);
    }
    const lmb_lightmap_settings chosen = lmb_lightmap_settings_default(bake.level.scene);
    if (lightmap_make(&bake, chosen.texels_per_m, chosen.max_image_size)) {
        CHECK(bake.lightmap->covered_texel_count > 10000 && bake.lightmap->covered_texel_count < 1500000,
              "%llu texels by default", (unsigned long long)bake.lightmap->covered_texel_count);
        lmb_lightmap_destroy(bake.lightmap);
    }
    /* Far more than an image holds: the density goes down until it fits; and several small images. */
    static const struct {
        float texels_per_m;
        int32_t size;
        lmb_uv_fault fault;
    } TIGHT[] = {{1e6f, 64, LMB_UV_GOOD}, {50.0f, 256, LMB_UV_GOOD}, {1e6f, 256, LMB_UV_MISSING}};
    for (size_t i = 0; i < sizeof TIGHT / sizeof TIGHT[0]; ++i) {
        for (uint32_t m = 0; TIGHT[i].fault != LMB_UV_GOOD && m < bake.level.scene->mesh_count; ++m) {
            uv_break(&bake.level.scene->meshes[m], TIGHT[i].fault);
        }
        if (lightmap_make(&bake, TIGHT[i].texels_per_m, TIGHT[i].size)) {
            check_regions_apart(bake.lightmap);
            for (int32_t k = 0; k < bake.lightmap->image_count; ++k) {
                CHECK(bake.lightmap->image[k].width <= TIGHT[i].size && bake.lightmap->image[k].height <= TIGHT[i].size,
                      "case %zu: image of %d x %d", i, (int)bake.lightmap->image[k].width,
                      (int)bake.lightmap->image[k].height);
            }
            CHECK(bake.lightmap->image_count > 1, "case %zu: one image", i);
            lmb_lightmap_destroy(bake.lightmap);
        }
    }
    bake.lightmap = NULL;
    baked_close(&bake);
}

static void real_level(const char *path, float texels_per_m)
{
    lmb_error error = {""};
    FILE *file = fopen(path, "rb");
    if (!file) {
        test_skip("no " LMB_DATA_DIR);
        return;
    }
    fclose(file);
    baked bake;
    if (!level_fixture_open(&bake.level, path, LMB_OK, &error, 2)) {
        return;
    }
    bake.level.scene->environment =
        (lmb_environment){.present = true, .constant = {{1.0f, 1.0f, 1.0f}}, .strength = 1.0f};
    lmb_emitters_destroy(bake.level.emitters);
    bake.level.emitters = NULL;
    CHECK(lmb_emitters_create(bake.level.tracer, &bake.level.emitters) == LMB_OK, "emitters");
    bake.level.transport.emitters = bake.level.emitters;
    bake.level.transport.bounces = 2;
    if (lightmap_make(&bake, texels_per_m, 2048)) {
        check_regions_apart(bake.lightmap);
        if (lightmap_bake(&bake, 8)) {
            check_filled(bake.lightmap, 8);
            CHECK(count_state(bake.lightmap, LMB_TEXEL_GATHERED) == bake.lightmap->covered_texel_count, "covered");
        }
        printf("     %llu texels in %d images, %llu pushed out\n", (unsigned long long)bake.stats.texels,
               (int)bake.lightmap->image_count, (unsigned long long)bake.stats.pushed_out);
    }
    baked_close(&bake);
}

static void real_level_with_uvs(void)
{
    real_level(LMB_DATA_DIR "/scenes/cornell_bevy/CornellBox.glb", 0.1f);
}

static void real_level_with_instances(void)
{
    real_level(LMB_DATA_DIR "/scenes/kaykit_dungeon/kaykit_dungeon.gltf", 1.0f);
}

static const test_case CASES[] = {
    {"furnace", furnace},
    {"sun on a plane", sun_on_plane},
    {"bilinear lookup", bilinear_lookup},
    {"instances have their own places", instances_have_own_places},
    {"faults get charts", faults_get_charts},
    {"charts do not bleed", charts_do_not_bleed},
    {"an empty level", empty_level},
    {"charts go into a level", charts_go_into_a_level},
    {"files read back", files_read_back},
    {"broken files are refused", files_broken_are_refused},
    {"sunlight fits", sunlight_fits},
    {"threads make no difference", threads_make_no_difference},
    {"exrheader shows the channels", exrheader_shows_channels},
    {"texels leave solids", texels_leave_solids},
    {"a block has no dark rim", block_has_no_dark_rim},
    {"a bake can be stopped", bake_can_be_stopped},
    {"settings are checked", settings_are_checked},
    {"a real level with UVs", real_level_with_uvs},
    {"a real level with instances", real_level_with_instances},
};

TEST_MAIN(CASES)
