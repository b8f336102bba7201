/* Lightmaps: light that is known, lookups, padding, places of instances. */
#include "lightmap_fixture.h"
#include "variates.h"

#include <lambent/surface.h>

static lmb_vec2 uv_at(const lmb_lightmap *lightmap, uint32_t instance, uint32_t triangle, float u, float v)
{
    const uint32_t mesh_index = lightmap->scene->instances[instance].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[mesh_index];
    lmb_vec2 sum = {0.0f, 0.0f};
    const float weight[3] = {1.0f - u - v, u, v};
    for (int k = 0; k < 3; ++k) {
        const lmb_vec2 corner = lightmap->corner_uv[mesh_index]
                                    ? lightmap->corner_uv[mesh_index][3 * triangle + (uint32_t)k]
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
    uint64_t state = 1;
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
            float u = turn == 1 ? 1.0f : turn == 0 || turn == 2 || turn == 4 ? 0.0f : (float)variate_next(&state);
            float v = turn == 2 ? 1.0f : turn == 0 || turn == 1 || turn == 3 ? 0.0f : (float)variate_next(&state);
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
        if (!baked_open(&bake, path, written, &error,
                        (baked_settings){.texels_per_m = 4.0f, .samples = 256, .threads = 2})) {
            return;
        }
        const float truth = 1.0f / (1.0f - ALBEDO[i]);
        float worst = 0.0f;
        double sum = 0.0;
        const lmb_lightmap_image *image = &bake.lightmap->image[0];
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            if (image->state[k] == LMB_TEXEL_GATHERED) {
                worst = fmaxf(worst, fabsf(lmb_lightmap_plane(image, 1)[k] - truth));
                sum += (double)lmb_lightmap_plane(image, 1)[k];
            }
        }
        CHECK(worst < 0.25f * truth, "albedo %g: off by %g of %g", (double)ALBEDO[i], (double)worst, (double)truth);
        CHECK_NEAR(sum / (double)bake.stats.elements, truth, 0.005f * truth, "albedo %g", (double)ALBEDO[i]);
        CHECK(bake.stats.elements == bake.lightmap->covered_texel_count &&
                  bake.stats.elements == count_state(bake.lightmap, LMB_TEXEL_GATHERED),
              "%llu texels", (unsigned long long)bake.stats.elements);
        CHECK(bake.stats.moved == 0, "%llu pushed out", (unsigned long long)bake.stats.moved);
        CHECK(bake.stats.rays >= 256 * bake.stats.elements, "%llu rays", (unsigned long long)bake.stats.rays);
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
        if (!baked_open(&bake, path, written, &error,
                        (baked_settings){.texels_per_m = 1.0f, .samples = 8, .threads = 1})) {
            return;
        }
        const double length = sqrt((double)(d.x * d.x + d.y * d.y + d.z * d.z));
        const double truth = (double)CASES[i].lux * (double)-d.y / length / 3.14159265358979;
        const lmb_lightmap_image *image = &bake.lightmap->image[0];
        double worst = 0.0;
        for (size_t k = 0; k < (size_t)image->width * (size_t)image->height; ++k) {
            if (image->state[k] != LMB_TEXEL_EMPTY) {
                worst = fmax(worst, fabs((double)lmb_lightmap_plane(image, 0)[k] - truth));
            }
        }
        CHECK(worst <= 1e-4 * truth, "case %zu: off by %g of %g", i, worst, truth);
        baked_close(&bake);
    }
}

/* Texels that are a linear function of their position read back as that function, wherever bilinear filtering reads. */
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
                const lmb_irradz texel = {{{x, y, x + y}}, 0.5f, {x, -y, 1.0f}};
                image_set_irradz(image, (size_t)k, &texel);
            }
        }
        uint64_t state = 7;
        for (uint32_t i = 0; i < bake.level.scene->instance_count; ++i) {
            const uint32_t triangles = bake.level.scene->meshes[bake.level.scene->instances[i].mesh].triangle_count;
            for (uint32_t k = 0; k < 8 * triangles; ++k) {
                const uint32_t turn = k % 8;
                const float along = (float)variate_next(&state);
                const float u = turn == 1   ? 1.0f
                                : turn == 3 ? along
                                : turn == 5 ? 1.0f - along
                                : turn > 5  ? 0.3f
                                            : 0.0f;
                const float v = turn == 2 ? 1.0f : turn == 4 || turn == 5 ? along : turn > 5 ? 0.2f : 0.0f;
                const lmb_vec2 at = texels_at(bake.lightmap, i, k / 8, u, v);
                const lmb_irradz found = sample_irradz(bake.lightmap, i, k / 8, u, v);
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

static const lmb_instance *instance_named(const lmb_scene *scene, const char *name, uint32_t *index)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (strcmp(scene->instances[i].name, name) == 0) {
            *index = i;
            return &scene->instances[i];
        }
    }
    CHECK(false, "no node %s", name);
    *index = 0;
    return NULL;
}

static void instances_have_own_places(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_tiles.glb");
    baked bake;
    if (!baked_open(&bake, path, write_tiles(path, 3.0f, &error), &error,
                    (baked_settings){.texels_per_m = 4.0f, .samples = 8, .threads = 2})) {
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
    CHECK_NEAR(sample_irradz(lightmap, open, 0, 0.3f, 0.3f).irradiance_z.c[0], lit, 1e-3, "open");
    CHECK_NEAR(sample_irradz(lightmap, covered, 0, 0.3f, 0.3f).irradiance_z.c[0], 0.0, 0.0, "covered");
    CHECK_NEAR(sample_irradz(lightmap, moving, 0, 0.3f, 0.3f).irradiance_z.c[0], 0.0, 0.0, "moving");
    CHECK_NEAR(lightmap->region[large].width, 3 * lightmap->region[open].width, 3, "three times the size");
    CHECK_NEAR(lightmap->region[open].texel_size, 0.25, 0.03, "metres a texel");
    CHECK_NEAR(lightmap->region[large].texel_size, 0.25, 0.03, "metres a texel");
    check_filled(lightmap, 200);
    baked_close(&bake);
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
        uint64_t state = 11;
        for (uint32_t k = 0; k < 20000; ++k) {
            const uint32_t t = k % mesh->triangle_count;
            float u = (float)variate_next(&state), v = (float)variate_next(&state);
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

/* A floor with a solid block that stands in it, a wall without thickness, and a sheet just above the floor. */
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
    const int sheet = lmb_level_builder_add_mesh(builder, "sheet");
    lmb_level_builder_add_quad(builder, sheet, material, (lmb_vec3){-3.5f, 0.02f, 1}, (lmb_vec3){1, 0, 0},
                               (lmb_vec3){0, 0, -2});
    lmb_level_builder_place(builder, "sheet", sheet, (lmb_vec3){0, 0, 0});
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
        /* Just inside the block, on two sides. */
        {0.95f, 0.0f, true, 1.0f},
        {-0.9f, 0.3f, true, -1.0f},
        /* Deep inside, where nothing shows it, and outside beside its front. */
        {0.0f, 0.0f, false, 0.0f},
        {1.05f, 0.0f, false, 1.05f},
        /* Either side of the wall. */
        {3.05f, 0.0f, false, 3.05f},
        {2.95f, 0.0f, false, 2.95f},
        /* Under the sheet. */
        {-3.0f, 0.0f, false, -3.0f},
        {-3.45f, 0.9f, false, -3.45f},
    };
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_solids.glb");
    level_fixture level;
    if (!level_fixture_open(&level, path, write_block_on_floor(path, &error), &error, 1)) {
        return;
    }
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; ++i) {
        const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
        const lmb_vec3 position = {CASES[i].x, 0.0f, CASES[i].z};
        const lmb_place place = {position, up, up, lmb_trace_epsilon(position)};
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
    if (!baked_open(&bake, path, write_block_on_floor(path, &error), &error,
                    (baked_settings){.texels_per_m = 3.7f, .samples = 8, .threads = 2})) {
        return;
    }
    uint32_t floor;
    instance_named(bake.level.scene, "floor", &floor);
    CHECK(bake.stats.moved > 0, "no texel was pushed out");
    uint64_t state = 3;
    for (int i = 0; i < 2000; ++i) {
        float u = (float)variate_next(&state), v = (float)variate_next(&state);
        if (u + v > 1.0f) {
            u = 1.0f - u;
            v = 1.0f - v;
        }
        const lmb_place place =
            lmb_trace_place(bake.level.tracer, &(lmb_hit){.instance = floor, .triangle = 0, .u = u, .v = v});
        const float rim = fmaxf(fabsf(place.position.x), fabsf(place.position.z));
        if (rim > 1.0f && rim < 1.5f) {
            const lmb_irradz found = sample_irradz(bake.lightmap, floor, 0, u, v);
            CHECK(found.irradiance_z.c[0] > 0.99f / 3.1415927f, "%g at (%g, %g)", (double)found.irradiance_z.c[0],
                  (double)place.position.x, (double)place.position.z);
        }
    }
    baked_close(&bake);
}

/* A sheet at height 1 over a floor whose edge is x = 0.3 + slope z, under a sun that falls towards +x at 45 degrees. */
static lmb_result write_sheet_over_floor(const char *path, float slope, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material black = lmb_level_material_default();
    black.base_color = (lmb_rgb){{0, 0, 0}};
    const int material = lmb_level_builder_add_material(builder, &black);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-4, 0, 4}, (lmb_vec3){8, 0, 0},
                               (lmb_vec3){0, 0, -8});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    const int sheet = lmb_level_builder_add_mesh(builder, "sheet");
    lmb_level_builder_add_quad(builder, sheet, material, (lmb_vec3){0.3f + 10.0f * slope, 1, 10},
                               (lmb_vec3){-20.0f * slope, 0, -20}, (lmb_vec3){-15, 0, 0});
    lmb_level_builder_place(builder, "sheet", sheet, (lmb_vec3){0, 0, 0});
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1, 1, 1}}, .intensity = 3.0f};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    lmb_level_look_along((lmb_vec3){1, -1, 0}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    const lmb_result written = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return written;
}

/* Texels hold the share of their area that the sun reaches: along a line across the shadow's edge the map adds up to
 * the lit length, to a small part of its texels of half a metre. */
static void texels_are_means(void)
{
    static const float slopes[] = {0.0f, 0.07f, -0.3f};
    for (size_t k = 0; k < sizeof slopes / sizeof slopes[0]; ++k) {
        lmb_error error = {""};
        const char *path = OUTPUT("lightmap_sheet.glb");
        baked bake;
        if (!baked_open(&bake, path, write_sheet_over_floor(path, slopes[k], &error), &error,
                        (baked_settings){.texels_per_m = 2.0f, .samples = 512, .threads = 2})) {
            return;
        }
        uint32_t floor;
        instance_named(bake.level.scene, "floor", &floor);
        const double full = 3.0 * sqrt(0.5) / 3.14159265358979323846;
        for (int line = 0; line < 6; ++line) {
            /* Off the quad's diagonal, whose texels are the mean over one of its triangles. */
            const float z = (float)(line < 3 ? -2.9 + 0.3 * line : 2.1 + 0.3 * line - 0.9);
            double lit = 0.0;
            const double step = 0.01;
            const double from = 0.0, to = 2.6;
            for (double x = from + 0.5 * step; x < to; x += step) {
                const lmb_vec3 above = {(float)x, 0.5f, z};
                lmb_hit hit;
                CHECK(lmb_trace_nearest(bake.level.tracer, above, (lmb_vec3){0, -1, 0}, 0.0f, 1.0f, &hit), "floor");
                const lmb_irradz found = sample_irradz(bake.lightmap, floor, hit.triangle, hit.u, hit.v);
                lit += step * (double)found.irradiance_z.c[0] / full;
            }
            const double edge = 1.3 + (double)slopes[k] * (double)z;
            CHECK_NEAR(lit, to - edge, 0.03, "slope %g, z %g", (double)slopes[k], (double)z);
        }
        baked_close(&bake);
    }
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
            lmb_lightmap_bake(bake.lightmap, &bake.level.transport, &(lmb_gather_effort){.samples = 64},
                              bake.level.pool, &progress, &bake.stats);
        CHECK(result == LMB_ERROR_INTERRUPTED && calls > 0, "%s", lmb_result_text(result));
        CHECK(count_state(bake.lightmap, LMB_TEXEL_GATHERED) == 0, "a stopped bake left light");
    }
    baked_close(&bake);
}

static void settings_are_checked(void)
{
    static const struct {
        float texels_per_m;
        int32_t max_image_size;
    } BAD[] = {{0.0f, 1024}, {-1.0f, 1024}, {NAN, 1024},   {INFINITY, 1024},
               {1.0f, 1000}, {1.0f, 0},     {1.0f, -1024}, {1.0f, 1 << 20}};
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_settings.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; ++i) {
        bake.lightmap = NULL;
        const lmb_lightmap_settings settings = {.texels_per_m = BAD[i].texels_per_m,
                                                .max_image_size = BAD[i].max_image_size};
        CHECK(lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error) == LMB_ERROR_ARGUMENT,
              "case %zu", i);
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
        printf("     %llu texels in %d images, %llu pushed out\n", (unsigned long long)bake.stats.elements,
               (int)bake.lightmap->image_count, (unsigned long long)bake.stats.moved);
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
    {"texels leave solids", texels_leave_solids},
    {"a block has no dark rim", block_has_no_dark_rim},
    {"texels are means over their area", texels_are_means},
    {"a bake can be stopped", bake_can_be_stopped},
    {"settings are checked", settings_are_checked},
    {"a real level with UVs", real_level_with_uvs},
    {"a real level with instances", real_level_with_instances},
};

TEST_MAIN(CASES)
