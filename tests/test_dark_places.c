/* Dark places beside bright ones: light stored on surfaces must not pass what stands on them. */
#include <math.h>
#include <stdio.h>

#include <lambent/surface_solve.h>

#include "harness.h"
#include "scenes/level_builder.h"
#include "level_fixture.h"

#define PI 3.14159265358979323846
#define SUN_LUX 100000.0f

typedef struct hut_shape {
    float wall_m;    /* thickness */
    float sink_m;    /* how far the walls reach into the ground */
    float turn_rad;  /* about the upright axis */
    float slit_m;    /* width of a gap in the wall at +X, over all its height; 0: closed */
    float tile_m;    /* of the ground; 0: two triangles */
    bool room_in_it; /* a smaller hut within */
} hut_shape;

static const lmb_vec3 up = {0.0f, 1.0f, 0.0f};

static void wall_add(lmb_level_builder *builder, int mesh, int material, lmb_vec3 min, lmb_vec3 max)
{
    const lmb_level_box box = lmb_level_box_of(min, max, material);
    lmb_level_builder_add_box(builder, mesh, &box);
}

/* Four walls and a roof around x, z in [-half, half], inside. */
static void hut_add(lmb_level_builder *builder, int material, const char *name, float half, float height,
                    const hut_shape *shape)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    const float low = -shape->sink_m, outer = half + shape->wall_m, slit = 0.5f * shape->slit_m;
    wall_add(builder, mesh, material, (lmb_vec3){-outer, low, -outer}, (lmb_vec3){-half, height, outer});
    wall_add(builder, mesh, material, (lmb_vec3){-half, low, -outer}, (lmb_vec3){half, height, -half});
    wall_add(builder, mesh, material, (lmb_vec3){-half, low, half}, (lmb_vec3){half, height, outer});
    if (slit > 0.0f) {
        wall_add(builder, mesh, material, (lmb_vec3){half, low, -outer}, (lmb_vec3){outer, height, -slit});
        wall_add(builder, mesh, material, (lmb_vec3){half, low, slit}, (lmb_vec3){outer, height, outer});
    } else {
        wall_add(builder, mesh, material, (lmb_vec3){half, low, -outer}, (lmb_vec3){outer, height, outer});
    }
    wall_add(builder, mesh, material, (lmb_vec3){-outer, height, -outer},
             (lmb_vec3){outer, height + shape->wall_m, outer});
    lmb_level_node node = lmb_level_node_default(name);
    node.mesh = mesh;
    lmb_level_turn(shape->turn_rad, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

static void ground_add(lmb_level_builder *builder, int material, float tile_m)
{
    const float half = 10.0f;
    const int tiles = tile_m > 0.0f ? (int)(2.0f * half / tile_m + 0.5f) : 1;
    const float size = 2.0f * half / (float)tiles;
    const int mesh = lmb_level_builder_add_mesh(builder, "ground");
    for (int i = 0; i < tiles * tiles; ++i) {
        const lmb_vec3 origin = {(float)(i % tiles) * size - half, 0.0f, (float)(i / tiles) * size - half + size};
        lmb_level_builder_add_quad(builder, mesh, material, origin, (lmb_vec3){size, 0.0f, 0.0f},
                                   (lmb_vec3){0.0f, 0.0f, -size});
    }
    lmb_level_builder_place(builder, "ground", mesh, (lmb_vec3){0.0f, 0.0f, 0.0f});
}

static bool hut_open(level_fixture *level, const char *path, const hut_shape *shape)
{
    lmb_error error = {{0}};
    lmb_level_builder *builder = lmb_level_builder_create(0.2f);
    lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    ground_add(builder, material, shape->tile_m);
    hut_add(builder, material, "hut", 2.0f, 2.5f, shape);
    if (shape->room_in_it) {
        hut_add(builder, material, "room", 0.6f, 1.2f, shape);
    }
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1.0f, 1.0f, 1.0f}}, .intensity = SUN_LUX};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    lmb_level_look_along((lmb_vec3){-0.6f, -1.0f, -0.3f}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 1);
}

static lmb_surface_light *solve(level_fixture *level, uint64_t seed)
{
    lmb_error error = {{0}};
    lmb_surface_light *light = NULL;
    lmb_surface_light_stats stats;
    const lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    level->transport.seed = seed;
    const lmb_result result =
        lmb_surface_light_solve(&level->transport, &settings, level->pool, &light, &stats, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    level->transport.surface = light;
    return light;
}

static lmb_vec3 turned(const hut_shape *shape, lmb_vec3 p)
{
    const float c = cosf(shape->turn_rad), s = sinf(shape->turn_rad);
    return (lmb_vec3){c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

/* Nothing of the light outside comes in, in the middle or in a corner, for any thickness of the walls. */
static void closed_huts_are_dark(void)
{
    static const hut_shape shapes[] = {
        {.wall_m = 0.1f, .sink_m = 0.01f},
        {.wall_m = 0.001f, .sink_m = 0.01f},
        {.wall_m = 0.3f},
        {.wall_m = 0.02f},
        {.wall_m = 0.1f, .sink_m = 0.01f, .turn_rad = 0.6f},
        {.wall_m = 0.001f, .turn_rad = 0.3f},
        {.wall_m = 0.1f, .sink_m = 0.2f, .tile_m = 1.0f},
        {.wall_m = 0.1f, .sink_m = 0.01f, .tile_m = 0.11f},
        {.wall_m = 0.05f, .sink_m = 0.05f, .turn_rad = 1.2f, .room_in_it = true},
    };
    static const lmb_vec3 points[] = {{0.0f, 1.2f, 0.0f},   {0.0f, 0.002f, 0.0f},    {1.995f, 0.002f, 0.3f},
                                      {1.9f, 0.01f, -1.9f}, {-1.99f, 0.01f, -1.99f}, {-1.0f, 2.49f, 1.95f}};
    const double outside = (double)SUN_LUX / sqrt(1.0 + 0.36 + 0.09) / PI;
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; ++i) {
        char path[512];
        snprintf(path, sizeof path, "%s/hut_%zu.glb", LMB_TEST_OUTPUT_DIR, i);
        level_fixture level;
        if (!hut_open(&level, path, &shapes[i])) {
            continue;
        }
        lmb_surface_light *light = solve(&level, 0);
        for (size_t k = 0; k < sizeof points / sizeof points[0]; ++k) {
            const lmb_vec3 at = turned(&shapes[i], points[k]);
            const lmb_rgb found = traced_irradiance(&level, at, up, 4096);
            CHECK((double)found.c[1] <= 1e-5 * outside, "hut %zu, point %zu: %g of %g outside", i, k,
                  (double)found.c[1], outside);
            const lmb_gather_point probe = {.position = at};
            lmb_gathered gathered;
            lmb_gather_sh3(&level.transport, &probe, 2048, &gathered);
            CHECK((double)gathered.moments.channel[1].c[0] <= 1e-5 * outside, "hut %zu, probe %zu: %g", i, k,
                  (double)gathered.moments.channel[1].c[0]);
        }
        /* In the sun it is bright. */
        const lmb_rgb sunny = traced_irradiance(&level, (lmb_vec3){6.0f, 0.002f, 6.0f}, up, 256);
        CHECK_NEAR(sunny.c[1], outside, 0.02 * outside, "hut %zu, outside", i);
        lmb_surface_light_destroy(light);
        level_fixture_close(&level);
    }
}

/* A slit of 15 cm lets in two thousandths of the light outside: what reaches the corners is what the path tracer finds
 * there. Whole solves are compared, by their mean over seeds: one alone is as noisy as a few paths through the slit. */
static void slits_let_in_what_they_should(void)
{
    enum { SEEDS = 6, POINTS = 5 };
    const hut_shape shape = {.wall_m = 0.1f, .sink_m = 0.01f, .slit_m = 0.15f};
    static const lmb_vec3 points[POINTS] = {
        {-1.0f, 0.01f, 1.0f}, {0.5f, 0.01f, -1.5f}, {0.0f, 0.01f, 1.2f}, {1.5f, 0.01f, 1.6f}, {-1.5f, 1.0f, -1.0f}};
    level_fixture level;
    char path[512];
    snprintf(path, sizeof path, "%s/slit.glb", LMB_TEST_OUTPUT_DIR);
    if (!hut_open(&level, path, &shape)) {
        return;
    }
    double reference[POINTS], cached[POINTS] = {0.0}, squared[POINTS] = {0.0};
    for (int k = 0; k < POINTS; ++k) {
        reference[k] = (double)traced_irradiance(&level, points[k], up, 1u << 19).c[1];
    }
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        lmb_surface_light *light = solve(&level, seed);
        for (int k = 0; k < POINTS; ++k) {
            const double found = (double)traced_irradiance(&level, points[k], up, 4096).c[1];
            cached[k] += found / SEEDS;
            squared[k] += found * found / SEEDS;
        }
        lmb_surface_light_destroy(light);
        level.transport.surface = NULL;
    }
    for (int k = 0; k < POINTS; ++k) {
        const double spread = sqrt(fmax(squared[k] - cached[k] * cached[k], 0.0) / (SEEDS - 1));
        CHECK(reference[k] > 0.0 && reference[k] < 0.003 * (double)SUN_LUX / PI, "point %d: %g", k, reference[k]);
        CHECK_NEAR(cached[k], reference[k], 0.03 * reference[k] + 3.0 * spread, "point %d, spread %g", k, spread);
    }
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"closed_huts_are_dark", closed_huts_are_dark},
    {"slits_let_in_what_they_should", slits_let_in_what_they_should},
};

TEST_MAIN(cases)
