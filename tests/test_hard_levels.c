/* Hard cases of geometry, through the whole pipeline in small. */
#define _POSIX_C_SOURCE 200809L

#include "hard_level.h"
#include "hard_raw.h"
#include "scenes/levels.h"

#include <float.h>

#include <lambent/environment.h>
#include <lambent/surface.h>

#define PI 3.14159265358979323846
#define WHITE_SKY "#ffffff"

static lmb_error error;

static const hard_settings few = {1.0f, 1.0f, 64};

static void empty_scene(void)
{
    const char *path = hard_path("empty", "gltf");
    FILE *const file = fopen(path, "wb");
    CHECK(file && fputs("{\"asset\":{\"version\":\"2.0\"}}", file) >= 0 && fclose(file) == 0, "%s", path);
    hard_level level = {0};
    if (!level_fixture_load(&level.traced, path, WHITE_SKY, 1)) {
        return;
    }
    const lmb_placement_settings settings = lmb_placement_settings_default();
    const lmb_result result =
        lmb_placement_make(level.traced.tracer, &settings, level.traced.pool, &level.probes, &level.placement, &error);
    CHECK(result == LMB_ERROR_UNSUPPORTED && !level.probes, "%s", lmb_result_text(result));
    CHECK(strstr(error.message, "hard_empty.gltf") && strstr(error.message, "no static triangles"), "%s",
          error.message);
    const lmb_lightmap_settings fallback = lmb_lightmap_settings_default(level.traced.scene);
    CHECK(fallback.texels_per_m > 0.0f && isfinite(fallback.texels_per_m), "%g", (double)fallback.texels_per_m);
    CHECK(hard_bake_lightmap(&level, &few) && level.lit.elements == 0, "a lightmap of nothing");
    const lmb_rgb sky = traced_irradiance(&level.traced, (lmb_vec3){1, 2, 3}, hard_up, 1024);
    CHECK_NEAR(sky.c[0], 1.0, 0.01, "nothing but sky");
    hard_close(&level);
}

static bool gathered_is_dark(const level_fixture *level, lmb_vec3 position)
{
    const lmb_gather_point point = {.position = scene_position(level, position)};
    lmb_gathered gathered;
    lmb_gather_sh3(&level->transport, &point, 512, &gathered);
    return gathered.squared_length == 0.0;
}

/* Whether the lightmap of every triangle that lies wholly at x < limit is black. */
static void check_dark_texels(const hard_level *level, const char *name, float limit)
{
    const lmb_scene *scene = level->traced.scene;
    const uint32_t instance = hard_instance(scene, name);
    uint32_t seen = 0;
    for (uint32_t t = 0; t < scene->meshes[scene->instances[instance].mesh].triangle_count; ++t) {
        lmb_vec3 corner[3];
        lmb_trace_corners(level->traced.tracer, instance, t, corner);
        if (corner[0].x < limit && corner[1].x < limit && corner[2].x < limit) {
            const lmb_rgb texel = sample_irradz(level->lightmap, instance, t, 0.3f, 0.3f).irradiance_z;
            CHECK(texel.c[0] == 0.0f && texel.c[1] == 0.0f, "triangle %u: %g %g", t, (double)texel.c[0],
                  (double)texel.c[1]);
            ++seen;
        }
    }
    CHECK(seen > 0, "%s has no triangle there", name);
}

/* 1 mm of wall between a dark room and a bright one; lattice points lie on walls, in the wall, and in corners. */
static void sealed_dark_room(void)
{
    lmb_two_rooms rooms = lmb_two_rooms_default();
    rooms.wall_m = 0.001f;
    rooms.red_radiance = 0.0f;
    rooms.green_radiance = 1000.0f;
    hard_level level;
    const char *path = hard_path("rooms", "glb");
    CHECK(lmb_level_two_rooms(path, &rooms, &error) == LMB_OK, "%s", error.message);
    if (!hard_bake(&level, path, NULL, &(hard_settings){0.5f, 2.0f, 16})) {
        return;
    }
    static const float gaps[] = {1e-5f, 1e-4f, 0.01f, 0.1f, 2.0f};
    for (size_t i = 0; i < sizeof gaps / sizeof gaps[0]; ++i) {
        for (int k = 0; k < 9; ++k) {
            const lmb_vec3 position = {-0.0005f - gaps[i], 1.5f + 1.499f * (float)(k / 3 - 1),
                                       1.9999f * (float)(k % 3 - 1)};
            CHECK(gathered_is_dark(&level.traced, position), "%g %g %g", (double)position.x, (double)position.y,
                  (double)position.z);
        }
    }
    for (int32_t i = 0; i < level.probes->count; ++i) {
        const lmb_vec3 position = lmb_probes_position(level.probes, i);
        const bool valid = level.probes->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        const float light = level.probes->radiance[0][i].channel[1].c[0];
        CHECK(!valid || position.x >= 0.0f || light == 0.0f, "%g %g %g: %g", (double)position.x, (double)position.y,
              (double)position.z, (double)light);
        const bool in_wall = position.x == 0.0f && position.y > 0.0f && position.y < 3.0f && fabsf(position.z) < 2.0f;
        CHECK(!valid || !in_wall, "in the wall: %g %g", (double)position.y, (double)position.z);
    }
    check_dark_texels(&level, "hull", -0.0001f);
    const lmb_rgb bright = hard_sample(&level, (lmb_vec3){2, 1, 0}, hard_up);
    CHECK(bright.c[1] > 1.0f && bright.c[0] == 0.0f, "%g", (double)bright.c[1]);
    hard_close(&level);
}

/* Squares on top of each other: one of them is seen, whichever, and neither shades the other. */
static void coincident_faces(void)
{
    for (int flip = 0; flip < 2; ++flip) {
        float low[6][3], high[6][3];
        raw_floor(low, 0.0f, 4.0f);
        raw_floor(high, 0.0f, 4.0f);
        for (int k = 0; flip && k < 6; k += 3) {
            const float kept[3] = {high[k][0], high[k][1], high[k][2]};
            memcpy(high[k], high[k + 1], sizeof kept);
            memcpy(high[k + 1], kept, sizeof kept);
        }
        const raw_part parts[2] = {
            {low, NULL, 2, "{'pbrMetallicRoughness':{'baseColorFactor':[0.2,0.2,0.2,1]}}"},
            {high, NULL, 2, "{'pbrMetallicRoughness':{'baseColorFactor':[0.8,0.8,0.8,1]}}"},
        };
        hard_level level;
        if (!raw_write("twins", parts, 2, 0.0f) ||
            !hard_bake(&level, hard_path("twins", "gltf"), WHITE_SKY, &(hard_settings){1.0f, 2.0f, 64})) {
            return;
        }
        const lmb_rgb below =
            traced_irradiance(&level.traced, (lmb_vec3){0.1f, 0.01f, 0.3f}, (lmb_vec3){0, -1, 0}, 1024);
        CHECK(below.c[0] >= 0.19f && below.c[0] <= 0.81f, "%g", (double)below.c[0]);
        for (uint32_t t = 0; t < 4; ++t) {
            const float texel = hard_texel(&level, "raw", t).c[0];
            CHECK_NEAR(texel, 1.0, 0.15, "triangle %u, flipped %d", t, flip);
        }
        hard_close(&level);
    }
}

static void degenerate_triangles(void)
{
    float corner[6 + 18][3];
    raw_floor(corner, 0.0f, 4.0f);
    const float bad[6][3][3] = {
        {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},           /* a point */
        {{0, 1, 0}, {1, 1, 0}, {2, 1, 0}},           /* a line */
        {{0, 1, 0}, {1, 1, 0}, {0, 1, 0}},           /* an edge there and back */
        {{NAN, 1, 0}, {1, 1, 0}, {0, 1, 1}},         /* nowhere */
        {{0, 1, 0}, {INFINITY, 1, 0}, {0, 1, 1}},    /* endless */
        {{0, 1, 0}, {1e-30f, 1, 0}, {0, 1, 1e-30f}}, /* all but a point */
    };
    memcpy(corner[6], bad, sizeof bad);
    const raw_part part = {(const float(*)[3])corner, NULL, 8,
                           "{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1]}}"};
    hard_level level;
    if (!raw_write("degenerate", &part, 1, 0.0f) ||
        !hard_bake(&level, hard_path("degenerate", "gltf"), WHITE_SKY, &few)) {
        return;
    }
    CHECK(level.traced.scene->dropped_triangle_count == 5, "%u dropped", level.traced.scene->dropped_triangle_count);
    CHECK(level.traced.scene->bounds_max.x == 2.0f, "%g", (double)level.traced.scene->bounds_max.x);
    CHECK_NEAR(hard_texel(&level, "raw", 0).c[0], 1.0, 0.1, "the floor");
    hard_close(&level);
    corner[6][1] = 1.0f;
    corner[7][0] = corner[8][2] = 3e38f;
    corner[7][1] = corner[8][1] = 1.0f;
    lmb_scene *scene = NULL;
    if (raw_write("endless", &part, 1, 0.0f)) {
        const lmb_result result = lmb_gltf_load(hard_path("endless", "gltf"), NULL, &scene, &error);
        CHECK(result == LMB_ERROR_FORMAT && strstr(error.message, "nodes[0]: a vertex is too far away"), "%s",
              error.message);
        lmb_scene_destroy(scene);
    }
}

/* A room of 4 x 3 x 4 units without a ceiling, with a lamp and a solid block in it, `unit_m` metres to a unit. */
static bool yard_write(const char *path, float unit_m, lmb_vec3 position)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f * unit_m);
    const int grey = hard_material(builder, 0.5f, 0.0f);
    const int lamp = hard_material(builder, 0.0f, 10.0f);
    const float u = unit_m;
    const int mesh = lmb_level_builder_add_mesh(builder, "yard");
    lmb_level_box walls = lmb_level_box_of((lmb_vec3){-2 * u, 0, -2 * u}, (lmb_vec3){2 * u, 3 * u, 2 * u}, grey);
    walls.inward = true;
    walls.material[3] = LMB_LEVEL_NONE;
    lmb_level_builder_add_box(builder, mesh, &walls);
    const lmb_level_box hull =
        lmb_level_box_of((lmb_vec3){-2.05f * u, -0.05f * u, -2.05f * u}, (lmb_vec3){2.05f * u, 3 * u, 2.05f * u}, grey);
    lmb_level_builder_add_box(builder, mesh, &hull);
    const lmb_level_box block = lmb_level_box_of((lmb_vec3){0.3f * u, 0, 0.3f * u}, (lmb_vec3){u, u, u}, grey);
    lmb_level_builder_add_box(builder, mesh, &block);
    lmb_level_builder_add_quad(builder, mesh, lamp, (lmb_vec3){-u, 2 * u, -u}, (lmb_vec3){0.6f * u, 0, 0},
                               (lmb_vec3){0, 0, 0.6f * u});
    lmb_level_builder_place(builder, "yard", mesh, position);
    return hard_write(builder, path);
}

enum { YARD_POINTS = 4 };

/* What the yard gets at fixed points, the last against the lamp's side wall, right above the floor. */
static bool yard_measure(float unit_m, lmb_vec3 position, double traced[YARD_POINTS], double stored[YARD_POINTS])
{
    static const lmb_vec3 points[YARD_POINTS] = {
        {0.0f, 0.5f, 0.0f}, {1.4f, 0.05f, -1.2f}, {-0.7f, 1.1f, -0.6f}, {-1.9f, 0.02f, -0.7f}};
    const char *path = hard_path("yard", "glb");
    hard_level level;
    if (!yard_write(path, unit_m, position) ||
        !hard_bake(&level, path, WHITE_SKY, &(hard_settings){0.7f * unit_m, 1.0f / unit_m, 128})) {
        return false;
    }
    for (int i = 0; i < YARD_POINTS; ++i) {
        const lmb_vec3 point = {position.x + points[i].x * unit_m, position.y + points[i].y * unit_m,
                                position.z + points[i].z * unit_m};
        traced[i] = (double)traced_irradiance(&level.traced, point, hard_up, 8192).c[1];
        stored[i] = (double)hard_sample(&level, point, hard_up).c[1];
    }
    hard_close(&level);
    return true;
}

/* A level is the same picture whatever its unit is, and wherever it stands. */
static void any_size_and_place(void)
{
    static const struct {
        float unit_m;
        lmb_vec3 position;
        bool same_lattice;
    } yards[] = {
        {2500.0f, {0, 0, 0}, true},             /* 10 km */
        {0.0025f, {0, 0, 0}, true},             /* 10 mm */
        {1.0f, {10000.0f, 0, -7000.0f}, false}, /* 12 km away */
        {0.0025f, {10.0f, 0, 0}, false},        /* 10 mm, 10 m away */
        {2.5e-7f, {0, 0, 0}, true},             /* 1 micrometre */
        {2.5e5f, {0, 0, 0}, true},              /* 1000 km */
    };
    double traced[YARD_POINTS], stored[YARD_POINTS];
    if (!yard_measure(1.0f, (lmb_vec3){0, 0, 0}, traced, stored)) {
        return;
    }
    for (size_t y = 0; y < sizeof yards / sizeof yards[0]; ++y) {
        double other[YARD_POINTS], other_stored[YARD_POINTS];
        if (!yard_measure(yards[y].unit_m, yards[y].position, other, other_stored)) {
            continue;
        }
        for (int i = 0; i < YARD_POINTS; ++i) {
            CHECK_NEAR(other[i], traced[i], 0.03 * traced[i], "unit %g m at %g, point %d", (double)yards[y].unit_m,
                       (double)yards[y].position.x, i);
            if (yards[y].same_lattice) {
                CHECK_NEAR(other_stored[i], stored[i], 0.15 * stored[i], "unit %g m at %g, point %d",
                           (double)yards[y].unit_m, (double)yards[y].position.x, i);
            }
        }
    }
}

/* A sealed room with walls of 5 cm, 10 km away, in the brightest daylight. */
static void thin_walls_far_away(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int grey = hard_material(builder, 0.5f, 0.0f);
    const float away = 10000.0f;
    const int mesh = lmb_level_builder_add_mesh(builder, "hut");
    lmb_level_box inside = lmb_level_box_of((lmb_vec3){-1, 0, -1}, (lmb_vec3){1, 2, 1}, grey);
    inside.inward = true;
    lmb_level_builder_add_box(builder, mesh, &inside);
    const lmb_level_box outside =
        lmb_level_box_of((lmb_vec3){-1.05f, -0.05f, -1.05f}, (lmb_vec3){1.05f, 2.05f, 1.05f}, grey);
    lmb_level_builder_add_box(builder, mesh, &outside);
    lmb_level_builder_place(builder, "hut", mesh, (lmb_vec3){away, 0, -away});
    hard_add_light(builder, LMB_LEVEL_LIGHT_DIRECTIONAL, 1e5f, (lmb_vec3){0, 0, 0});
    hard_level level;
    const char *path = hard_path("hut", "glb");
    if (!hard_write(builder, path) || !hard_bake(&level, path, WHITE_SKY, &(hard_settings){0.5f, 4.0f, 16})) {
        return;
    }
    static const float gaps[] = {0.005f, 0.01f, 0.02f, 0.1f, 0.5f};
    for (size_t i = 0; i < sizeof gaps / sizeof gaps[0]; ++i) {
        for (int k = 0; k < 8; ++k) {
            const float off = 1.0f - gaps[i];
            const lmb_vec3 position = {away + (k & 1 ? off : -off), 1.0f + (k & 2 ? off : -off),
                                       -away + (k & 4 ? off : -off)};
            CHECK(gathered_is_dark(&level.traced, position), "%g m from the walls, corner %d", (double)gaps[i], k);
        }
    }
    const uint32_t hut = hard_instance(level.traced.scene, "hut");
    for (uint32_t t = 0; t < 12; ++t) {
        for (int k = 0; k < 16; ++k) {
            const float u = 0.02f + 0.31f * (float)(k % 4);
            const float v = (0.98f - u) * (float)(k / 4) / 3.0f;
            const float light = sample_irradz(level.lightmap, hut, t, u, v).irradiance_z.c[0];
            CHECK(light == 0.0f, "triangle %u at %g %g: %g", t, (double)u, (double)v, (double)light);
        }
    }
    hard_close(&level);
}

static double mean_surface_light(const hard_level *level, const char *name, const float (*weights)[2], int count)
{
    double sum = 0.0;
    const uint32_t instance = hard_instance(level->traced.scene, name);
    for (int i = 0; i < count; ++i) {
        const lmb_place place = lmb_trace_place(
            level->traced.tracer,
            &(lmb_hit){.instance = instance, .triangle = (uint32_t)i & 1u, .u = weights[i][0], .v = weights[i][1]});
        bool moved;
        const lmb_gather_point point = lmb_surface_gather_point(level->traced.tracer, &place, 1.0f, &moved);
        lmb_rgb light;
        uint64_t rays = 0;
        const lmb_gather_samples samples = {.points = &point, .point_count = 1, .count = 64};
        lmb_gather_irradiance(&level->traced.transport, &samples, &place.geometric_normal, 1, &light, &rays);
        sum += (double)light.c[0] / count;
        CHECK(!moved, "point %d", i);
    }
    return sum;
}

/* Two triangles of 10 km on a slope, black, under a sky of 1: every point receives 1, nearest to the origin, where
 * the corners' rounding is far larger than the point's, too. */
static void large_triangles(void)
{
    float corner[6][3];
    raw_quad(corner, (lmb_vec3){-5011.3f, -1733.9f, 5003.7f}, (lmb_vec3){10007.1f, 1203.3f, 17.7f},
             (lmb_vec3){31.3f, 2257.9f, -10001.9f});
    const raw_part part = {(const float(*)[3])corner, NULL, 2,
                           "{'pbrMetallicRoughness':{'baseColorFactor':[0,0,0,1]}}"};
    hard_level level = {0};
    if (!raw_write("slope", &part, 1, 0.0f) ||
        !level_fixture_load(&level.traced, hard_path("slope", "gltf"), WHITE_SKY, 1)) {
        return;
    }
    /* The parallelogram's middle is on the edge between the two triangles, near the origin. */
    enum { POINTS = 256 };
    float near_origin[POINTS][2], anywhere[POINTS][2];
    uint64_t state = 7;
    for (int i = 0; i < POINTS; ++i) {
        const float a = (float)fixture_random(&state);
        const float b = (float)fixture_random(&state);
        near_origin[i][0] = i & 1 ? 0.5f + 1e-4f * a : 1e-4f * a;
        near_origin[i][1] = i & 1 ? 1e-4f * b : 0.5f + 1e-4f * b;
        anywhere[i][0] = a * (1.0f - b);
        anywhere[i][1] = a * b;
    }
    CHECK_NEAR(mean_surface_light(&level, "raw", (const float(*)[2])near_origin, POINTS), 1.0, 0.01, "near");
    CHECK_NEAR(mean_surface_light(&level, "raw", (const float(*)[2])anywhere, POINTS), 1.0, 0.01, "anywhere");
    hard_close(&level);
}

static lmb_level_point hills(const void *context, double u, double v)
{
    (void)context;
    const double x = 200.0 * (u - 0.5), z = 200.0 * (0.5 - v);
    const double slope_x = 0.4 * cos(0.1 * x), slope_z = 0.3 * sin(0.1 * z);
    const double n = sqrt(1.0 + slope_x * slope_x + slope_z * slope_z);
    const double t = sqrt(1.0 + slope_x * slope_x);
    return (lmb_level_point){{(float)x, (float)(4.0 * sin(0.1 * x) - 3.0 * cos(0.1 * z)), (float)z},
                             {(float)(-slope_x / n), (float)(1.0 / n), (float)(-slope_z / n)},
                             {(float)(1.0 / t), (float)(slope_x / t), 0.0f}};
}

/* Hills of 200 m under a sky of 1: the peaks' open sky gives 1, nothing gets more, and what is under the ground is not
 * baked. */
static void open_terrain(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(2.0f);
    const lmb_level_patch patch = {40, 40, 210.0f, 210.0f, hills, NULL};
    const int mesh = lmb_level_builder_add_mesh(builder, "hills");
    lmb_level_builder_add_patch(builder, mesh, hard_material(builder, 0.5f, 0.0f), &patch);
    lmb_level_builder_place(builder, "hills", mesh, (lmb_vec3){0, 0, 0});
    hard_level level;
    const char *path = hard_path("hills", "glb");
    if (!hard_write(builder, path) || !hard_bake(&level, path, WHITE_SKY, &(hard_settings){10.0f, 0.2f, 64})) {
        return;
    }
    const lmb_rgb open = traced_irradiance(&level.traced, (lmb_vec3){0, 20, 0}, hard_up, 1024);
    CHECK_NEAR(open.c[0], 1.0, 0.01, "above the hills");
    int under = 0;
    for (int32_t i = 0; i < level.probes->count; ++i) {
        const lmb_vec3 p = lmb_probes_position(level.probes, i);
        const double ground = 4.0 * sin(0.1 * (double)p.x) - 3.0 * cos(0.1 * (double)p.z);
        const bool inside = fabsf(p.x) < 99.0f && fabsf(p.z) < 99.0f;
        under += inside && (double)p.y < ground - 1.0 && level.probes->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        CHECK(!inside || (double)p.y < ground + 1.0 || level.probes->validity[i] >= LMB_PROBES_MIN_VALIDITY,
              "%g %g %g is free", (double)p.x, (double)p.y, (double)p.z);
        CHECK(level.probes->radiance[0][i].channel[0].c[0] < 3.6f, "%g",
              (double)level.probes->radiance[0][i].channel[0].c[0]);
    }
    CHECK(under == 0, "%d valid probes under the ground", under);
    hard_close(&level);
}

static int leaf_material(lmb_level_builder *builder)
{
    /* 16 x 16 texels, of which 96 are leaf. */
    uint8_t rgba[16 * 16 * 4];
    for (int i = 0; i < 16 * 16; ++i) {
        const bool leaf = i / 16 < 6;
        rgba[4 * i] = rgba[4 * i + 2] = 20;
        rgba[4 * i + 1] = 90;
        rgba[4 * i + 3] = leaf ? 255 : 0;
    }
    lmb_level_material material = lmb_level_material_default();
    material.name = "leaf";
    material.base_color_texture = lmb_level_builder_add_image(builder, "leaf", 16, 16, rgba);
    material.alpha_mode = LMB_LEVEL_MASK;
    material.alpha_cutoff = 0.5f;
    material.double_sided = true;
    return lmb_level_builder_add_material(builder, &material);
}

/* A canopy that covers 6 rows in 16 lets 10/16 of the sun through; grass on the ground makes nothing solid. */
static void foliage(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int leaf = leaf_material(builder);
    hard_add_floor(builder, "ground", hard_material(builder, 0.3f, 0.0f), (lmb_vec3){0, 0, 0}, 6.0f);
    hard_add_floor(builder, "canopy", leaf, (lmb_vec3){0, 3, 0}, 6.0f);
    const int blade = lmb_level_builder_add_mesh(builder, "blade");
    lmb_level_builder_add_quad(builder, blade, leaf, (lmb_vec3){-0.3f, 0, 0}, (lmb_vec3){0.6f, 0, 0},
                               (lmb_vec3){0, 0.8f, 0});
    uint64_t state = 3;
    for (int i = 0; i < 300; ++i) {
        lmb_level_node node = lmb_level_node_default("blade");
        node.mesh = blade;
        node.translation.x = (float)(5.5 * fixture_random(&state) - 2.75);
        node.translation.z = (float)(5.5 * fixture_random(&state) - 2.75);
        lmb_level_turn((float)(2.0 * PI * fixture_random(&state)), node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
    hard_level level;
    const char *path = hard_path("foliage", "glb");
    if (!hard_write(builder, path) || !hard_bake(&level, path, WHITE_SKY, &(hard_settings){0.5f, 2.0f, 16})) {
        return;
    }
    int through = 0;
    uint64_t rays = 0;
    for (int i = 0; i < 4096; ++i) {
        const lmb_vec3 from = {(float)(5.0 * fixture_random(&state) - 2.5), 1.0f,
                               (float)(5.0 * fixture_random(&state) - 2.5)};
        const lmb_rgb share = lmb_trace_transmittance_along(level.traced.tracer, from, hard_up, FLT_MAX, &rays);
        CHECK(share.c[0] == 0.0f || share.c[0] == 1.0f, "%g", (double)share.c[0]);
        through += share.c[0] > 0.0f;
    }
    CHECK_NEAR(through / 4096.0, 10.0 / 16.0, 0.025, "canopy");
    int solid = 0, all = 0;
    for (int32_t i = 0; i < level.probes->count; ++i) {
        const lmb_vec3 p = lmb_probes_position(level.probes, i);
        if (p.y > 0.1f && p.y < 2.9f && fabsf(p.x) < 2.9f && fabsf(p.z) < 2.9f) {
            ++all;
            solid += level.probes->validity[i] < LMB_PROBES_MIN_VALIDITY;
        }
    }
    CHECK(solid == 0, "%d of %d probes between grass and leaves count as solid", solid, all);
    hard_close(&level);
}

/* Two panes of glass, half of the light each, over black ground: a quarter of sun and sky. */
static void glass(void)
{
    float ground[6][3], panes[12][3];
    raw_floor(ground, 0.0f, 4.0f);
    raw_floor(panes, 1.0f, 400.0f);
    raw_floor(panes + 6, 1.5f, 400.0f);
    const raw_part parts[2] = {
        {(const float(*)[3])ground, NULL, 2, "{'pbrMetallicRoughness':{'baseColorFactor':[0,0,0,1]}}"},
        {(const float(*)[3])panes, NULL, 4,
         "{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[0,0,0,0.5]}}"},
    };
    level_fixture level;
    const lmb_vec3 at = {0.3f, 0.001f, -0.2f};
    if (!raw_write("glass", parts, 2, 100.0f) || !level_fixture_load(&level, hard_path("glass", "gltf"), NULL, 1)) {
        return;
    }
    CHECK_NEAR(traced_irradiance(&level, at, hard_up, 64).c[0], 0.25 * 100.0 / PI, 1e-4, "sun");
    CHECK(lmb_scene_set_environment(level.scene, WHITE_SKY, &error) == LMB_OK, "%s", error.message);
    level_fixture_close(&level);
    if (raw_write("glass", parts, 2, 0.0f) && level_fixture_load(&level, hard_path("glass", "gltf"), WHITE_SKY, 1)) {
        CHECK_NEAR(traced_irradiance(&level, at, hard_up, 4096).c[0], 0.25, 0.01, "sky");
        level_fixture_close(&level);
    }
}

/* A transmitting pane tints what goes through, and covers by its alpha. */
static void transmission(void)
{
    static const struct {
        const char *material;
        double expected[3];
    } panes[] = {
        {"{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1}},"
         "'pbrMetallicRoughness':{'baseColorFactor':[1,0.5,0.25,1]}}",
         {1.0, 0.5, 0.25}},
        {"{'extensions':{'KHR_materials_transmission':{'transmissionFactor':0.5}},"
         "'pbrMetallicRoughness':{'baseColorFactor':[0.8,0,0.4,1]}}",
         {0.4, 0.0, 0.2}},
        {"{'extensions':{'KHR_materials_transmission':{'transmissionFactor':1}},'alphaMode':'BLEND',"
         "'pbrMetallicRoughness':{'baseColorFactor':[0,0.5,1,0.5]}}",
         {0.5, 0.75, 1.0}},
    };
    for (size_t i = 0; i < sizeof panes / sizeof panes[0]; ++i) {
        float ground[6][3], pane[6][3];
        raw_floor(ground, 0.0f, 4.0f);
        raw_floor(pane, 1.0f, 4.0f);
        const raw_part parts[2] = {
            {(const float(*)[3])ground, NULL, 2, "{'pbrMetallicRoughness':{'baseColorFactor':[0,0,0,1]}}"},
            {(const float(*)[3])pane, NULL, 2, panes[i].material},
        };
        hard_level level;
        if (!raw_write("tint", parts, 2, 100.0f) || !hard_bake(&level, hard_path("tint", "gltf"), NULL, &few)) {
            return;
        }
        level.traced.transport.bounces = 0;
        const lmb_rgb light = traced_irradiance(&level.traced, (lmb_vec3){0.3f, 0.001f, -0.2f}, hard_up, 16);
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(light.c[c], panes[i].expected[c] * 100.0 / PI, 1e-4, "pane %zu, channel %d", i, c);
        }
        hard_close(&level);
    }
}

/* Probes in a block get their neighbours' light: neither none, nor what shines in the block. */
static void probes_in_solids(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int wall = hard_material(builder, 0.5f, 1.0f);
    hard_add_box(builder, "room", wall, (lmb_vec3){-3.1f, -0.1f, -3.1f}, (lmb_vec3){3.1f, 3.1f, 3.1f}, true);
    hard_add_box(builder, "block", hard_material(builder, 0.5f, 0.0f), (lmb_vec3){-1.1f, -0.1f, -1.1f},
                 (lmb_vec3){1.1f, 2.1f, 1.1f}, false);
    hard_level level;
    const char *path = hard_path("block", "glb");
    if (!hard_write(builder, path) || !hard_bake(&level, path, NULL, &(hard_settings){0.5f, 1.0f, 64})) {
        return;
    }
    float least = INFINITY, most = 0.0f;
    for (int32_t i = 0; i < level.probes->count; ++i) {
        if (level.probes->validity[i] >= LMB_PROBES_MIN_VALIDITY) {
            least = fminf(least, level.probes->radiance[0][i].channel[0].c[0]);
            most = fmaxf(most, level.probes->radiance[0][i].channel[0].c[0]);
        }
    }
    int inside_count = 0;
    for (int32_t i = 0; i < level.probes->count; ++i) {
        const lmb_vec3 p = lmb_probes_position(level.probes, i);
        const bool inside = fabsf(p.x) < 1.05f && fabsf(p.z) < 1.05f && p.y < 2.05f && p.y > -0.05f;
        const float light = level.probes->radiance[0][i].channel[0].c[0];
        inside_count += inside;
        CHECK(inside == (level.probes->validity[i] < LMB_PROBES_MIN_VALIDITY) || fabsf(p.x) > 3.0f || p.y < -0.05f ||
                  p.y > 3.05f || fabsf(p.z) > 3.0f,
              "%g %g %g: %g", (double)p.x, (double)p.y, (double)p.z, (double)level.probes->validity[i]);
        CHECK(!inside || (light >= least && light <= most), "%g %g %g: %g", (double)p.x, (double)p.y, (double)p.z,
              (double)light);
    }
    CHECK(inside_count > 20, "%d", inside_count);
    hard_close(&level);
}

/* A sealed chest whose lid is one square beside two that meet it at a T, with a fin on the edge that they share, in
 * full daylight: no light gets in. */
static void non_manifold(void)
{
    enum { QUADS = 9 };
    float corner[6 * QUADS][3];
    /* Sums of these are exact: no corner is off by an ulp. */
    const float x0 = -1.375f, x1 = 1.625f, y0 = -0.21875f, y1 = 0.9375f, z0 = -1.125f, z1 = 1.40625f;
    const float xm = 0.171875f, zm = 0.296875f;
    raw_quad(corner, (lmb_vec3){x0, y1, z1}, (lmb_vec3){xm - x0, 0, 0}, (lmb_vec3){0, 0, z0 - z1});
    raw_quad(corner + 6, (lmb_vec3){xm, y1, z1}, (lmb_vec3){x1 - xm, 0, 0}, (lmb_vec3){0, 0, zm - z1});
    raw_quad(corner + 12, (lmb_vec3){xm, y1, zm}, (lmb_vec3){x1 - xm, 0, 0}, (lmb_vec3){0, 0, z0 - zm});
    raw_quad(corner + 18, (lmb_vec3){xm, y1, z1}, (lmb_vec3){0, 0, z0 - z1}, (lmb_vec3){0, 0.5f, 0});
    raw_quad(corner + 24, (lmb_vec3){x0, y0, z0}, (lmb_vec3){x1 - x0, 0, 0}, (lmb_vec3){0, 0, z1 - z0});
    raw_quad(corner + 30, (lmb_vec3){x0, y0, z1}, (lmb_vec3){x1 - x0, 0, 0}, (lmb_vec3){0, y1 - y0, 0});
    raw_quad(corner + 36, (lmb_vec3){x1, y0, z0}, (lmb_vec3){x0 - x1, 0, 0}, (lmb_vec3){0, y1 - y0, 0});
    raw_quad(corner + 42, (lmb_vec3){x1, y0, z1}, (lmb_vec3){0, 0, z0 - z1}, (lmb_vec3){0, y1 - y0, 0});
    raw_quad(corner + 48, (lmb_vec3){x0, y0, z0}, (lmb_vec3){0, 0, z1 - z0}, (lmb_vec3){0, y1 - y0, 0});
    const raw_part part = {(const float(*)[3])corner, NULL, 2 * QUADS,
                           "{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1]}}"};
    hard_level level;
    if (!raw_write("chest", &part, 1, 1000.0f) ||
        !hard_bake(&level, hard_path("chest", "gltf"), WHITE_SKY, &(hard_settings){0.4f, 4.0f, 64})) {
        return;
    }
    for (int i = 0; i < 8; ++i) {
        const lmb_vec3 position = {xm + 0.001f * (float)(i - 4), 0.9f - 0.1f * (float)i, zm};
        const lmb_rgb light = traced_irradiance(&level.traced, position, hard_up, 16384);
        CHECK(light.c[0] == 0.0f, "%g at point %d", (double)light.c[0], i);
    }
    const lmb_rgb above = traced_irradiance(&level.traced, (lmb_vec3){1.0f, 2.0f, 0.5f}, hard_up, 1024);
    CHECK_NEAR(above.c[0], 1000.0 / PI + 1.0, 1.0, "outside");
    hard_close(&level);
}

/* Lightmap UVs that cannot be used are told from good ones, and charts hold the same light. */
static void lightmap_uvs(void)
{
    static const float good[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    for (int kind = 0; kind < 6; ++kind) {
        static const lmb_uv_fault expected[] = {LMB_UV_GOOD,         LMB_UV_MISSING,    LMB_UV_OVERLAPPING,
                                                LMB_UV_OUT_OF_RANGE, LMB_UV_DEGENERATE, LMB_UV_OUT_OF_RANGE};
        float corner[6][3], uv[6][2];
        raw_floor(corner, 0.0f, 8.0f);
        memcpy(uv, good, sizeof uv);
        for (int k = 0; k < 6; ++k) {
            if (kind == 2 && k >= 3) {
                memcpy(uv[k], good[k - 3], sizeof uv[k]);
            } else if (kind == 3) {
                uv[k][0] = 1e30f * (good[k][0] - 0.5f);
            } else if (kind == 4) {
                uv[k][0] = 0.5f;
            } else if (kind == 5) {
                uv[k][k % 2] = k % 3 ? NAN : INFINITY;
            }
        }
        const raw_part part = {(const float(*)[3])corner, kind == 1 ? NULL : (const float(*)[2])uv, 2, "{}"};
        hard_level level;
        if (!raw_write("uvs", &part, 1, 100.0f) || !hard_bake(&level, hard_path("uvs", "gltf"), NULL, &few)) {
            CHECK(false, "kind %d", kind);
            continue;
        }
        CHECK(level.lightmap->fault[0] == expected[kind] || (kind == 5 && level.lightmap->fault[0] != LMB_UV_GOOD),
              "kind %d: %s", kind, lmb_uv_fault_text(level.lightmap->fault[0]));
        for (uint32_t t = 0; t < 2; ++t) {
            CHECK_NEAR(hard_texel(&level, "raw", t).c[0], 100.0 / PI, 1.0, "kind %d, triangle %u", kind, t);
        }
        hard_close(&level);
    }
}

static const test_case cases[] = {
    {"empty_scene", empty_scene},
    {"sealed_dark_room", sealed_dark_room},
    {"coincident_faces", coincident_faces},
    {"degenerate_triangles", degenerate_triangles},
    {"any_size_and_place", any_size_and_place},
    {"thin_walls_far_away", thin_walls_far_away},
    {"large_triangles", large_triangles},
    {"open_terrain", open_terrain},
    {"foliage", foliage},
    {"glass", glass},
    {"transmission", transmission},
    {"probes_in_solids", probes_in_solids},
    {"non_manifold", non_manifold},
    {"lightmap_uvs", lightmap_uvs},
};

TEST_MAIN(cases)
