/* Light solved on surfaces, against answers known by analysis and against the path tracer. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/surface.h>
#include <lambent/surface_solve.h>

#include "harness.h"
#include "scenes/level_builder.h"
#include "scenes/levels.h"
#include "level_fixture.h"

#define PI 3.14159265358979323846

typedef struct solved_level {
    level_fixture traced;
    lmb_surface_light *light;
    lmb_surface_light_stats stats;
} solved_level;

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/surface_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

static void solved_level_close(solved_level *level)
{
    lmb_surface_light_destroy(level->light);
    level_fixture_close(&level->traced);
}

static bool level_solve(solved_level *level, const lmb_surface_light_settings *settings)
{
    lmb_error error = {{0}};
    const lmb_result result = lmb_surface_light_solve(&level->traced.transport, settings, level->traced.pool,
                                                      &level->light, &level->stats, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    level->traced.transport.surface = level->light;
    return result == LMB_OK;
}

/* Opens, and solves with `bounces` reflections. On failure there is nothing to close. */
static bool solved_level_open(solved_level *level, const char *path, const char *environment, int threads, int bounces,
                              const lmb_surface_light_settings *settings)
{
    *level = (solved_level){0};
    if (!level_fixture_load(&level->traced, path, environment, threads)) {
        return false;
    }
    level->traced.transport.bounces = bounces;
    if (!level_solve(level, settings)) {
        solved_level_close(level);
        return false;
    }
    return true;
}

/* The light stored for what is seen from `origin` along `direction`, and whether that is a front. */
static lmb_rgb light_and_side_seen(const solved_level *level, lmb_vec3 origin, lmb_vec3 direction, bool *front)
{
    lmb_hit hit = {0};
    const bool found = lmb_trace_nearest(level->traced.tracer, origin, direction, 0.0f, FLT_MAX, &hit);
    CHECK(found, "nothing at %g %g %g", (double)direction.x, (double)direction.y, (double)direction.z);
    *front = hit.front;
    lmb_rgb stored = {{NAN, NAN, NAN}};
    CHECK(lmb_surface_light_at(level->light, level->traced.tracer, &hit, *front, &stored), "nothing stored");
    return stored;
}

static lmb_rgb light_seen(const solved_level *level, lmb_vec3 origin, lmb_vec3 direction)
{
    bool front;
    return light_and_side_seen(level, origin, direction, &front);
}

static const lmb_surface_light_settings small = {.max_cells = 600, .samples = 32};

/* In a furnace of albedo a and emission 1 every cell receives 1 / (1 - a), and so does every probe. */
static void furnace_is_uniform(void)
{
    static const float albedos[] = {0.0f, 0.5f, 0.8f, 0.99f};
    for (size_t i = 0; i < sizeof albedos / sizeof albedos[0]; ++i) {
        lmb_error error;
        solved_level level;
        const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
        CHECK(lmb_level_furnace(output_path("furnace"), 2.0f, albedos[i], one, false, &error) == LMB_OK, "%s",
              error.message);
        if (!solved_level_open(&level, output_path("furnace"), NULL, 1, -1, &small)) {
            return;
        }
        const double expected = 1.0 / (1.0 - (double)albedos[i]);
        const lmb_rgb stored = light_seen(&level, (lmb_vec3){0, 0, 0}, (lmb_vec3){0.36f, 0.48f, 0.8f});
        CHECK_NEAR(stored.c[1], expected, 0.04 * expected, "stored, albedo %g", (double)albedos[i]);
        const lmb_rgb gathered =
            traced_irradiance(&level.traced, (lmb_vec3){0.3f, -0.2f, 0.5f}, (lmb_vec3){0, 1, 0}, 2048);
        CHECK_NEAR(gathered.c[1], expected, 0.02 * expected, "gathered, albedo %g", (double)albedos[i]);
        /* The outside sees nothing and nobody sees it. */
        bool front;
        const lmb_rgb outside = light_and_side_seen(&level, (lmb_vec3){0.1f, 0.2f, 5.0f}, (lmb_vec3){0, 0, -1}, &front);
        CHECK(!front && !(outside.c[1] > 0.0f), "outside: %g", (double)outside.c[1]);
        solved_level_close(&level);
    }
}

/* After k bounces a furnace has (1 - a^(k+1))/(1 - a). */
static void bounces_are_counted(void)
{
    lmb_error error;
    const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
    CHECK(lmb_level_furnace(output_path("bounces"), 2.0f, 0.8f, one, true, &error) == LMB_OK, "%s", error.message);
    for (int bounces = 0; bounces < 6; ++bounces) {
        solved_level level;
        if (!solved_level_open(&level, output_path("bounces"), NULL, 1, bounces, &small)) {
            return;
        }
        const lmb_rgb irradiance = traced_irradiance(&level.traced, (lmb_vec3){0, 0, 0}, (lmb_vec3){0, 1, 0}, 4096);
        CHECK_NEAR(irradiance.c[1], (1.0 - pow(0.8, bounces + 1)) / 0.2, 0.03, "bounces %d", bounces);
        solved_level_close(&level);
    }
}

/* I / R^2 / (1 - a) / pi on every wall, as for the path tracer. */
static void point_light_in_sphere(void)
{
    lmb_error error;
    solved_level level;
    const double radius = 2.0, albedo = 0.6, intensity = 10.0;
    CHECK(lmb_level_sphere_room(output_path("sphere"), (float)radius, 24, (float)albedo, (float)intensity, &error) ==
              LMB_OK,
          "%s", error.message);
    if (!solved_level_open(&level, output_path("sphere"), NULL, 1, -1, &small)) {
        return;
    }
    const double expected = intensity / (radius * radius) / (1.0 - albedo) / PI;
    static const lmb_vec3 directions[] = {{0.0f, 1.0f, 0.0f}, {0.6f, 0.0f, 0.8f}, {-0.48f, -0.64f, 0.6f}};
    for (size_t i = 0; i < sizeof directions / sizeof directions[0]; ++i) {
        const lmb_vec3 d = directions[i];
        const lmb_rgb stored = light_seen(&level, (lmb_vec3){0, 0, 0}, d);
        CHECK_NEAR(stored.c[0], expected, 0.02 * expected, "stored at %g %g %g", (double)d.x, (double)d.y, (double)d.z);
        const float distance = (float)radius * 0.995f;
        const lmb_rgb gathered =
            traced_irradiance(&level.traced, (lmb_vec3){d.x * distance, d.y * distance, d.z * distance},
                              (lmb_vec3){-d.x, -d.y, -d.z}, 2048);
        CHECK_NEAR(gathered.c[2], expected, 0.02 * expected, "gathered at %g %g %g", (double)d.x, (double)d.y,
                   (double)d.z);
    }
    solved_level_close(&level);
}

/* A wall of 1 mm between cells of half a metre keeps red and green apart to the last bit. */
static void walls_do_not_leak(void)
{
    lmb_error error;
    solved_level level;
    lmb_two_rooms rooms = lmb_two_rooms_default();
    rooms.wall_m = 0.001f;
    CHECK(lmb_level_two_rooms(output_path("rooms"), &rooms, &error) == LMB_OK, "%s", error.message);
    const lmb_surface_light_settings coarse = {.cell_size = 0.5f, .max_cells = 10000, .samples = 32};
    if (!solved_level_open(&level, output_path("rooms"), NULL, 1, -1, &coarse)) {
        return;
    }
    static const float distances[] = {0.0015f, 0.01f, 0.1f, 1.0f, 3.9f};
    for (size_t i = 0; i < sizeof distances / sizeof distances[0]; ++i) {
        for (int side = 0; side < 2; ++side) {
            const lmb_gather_point point = {.position = {side == 0 ? -distances[i] : distances[i], 1.3f, 0.7f}};
            lmb_transport reference = level.traced.transport;
            reference.surface = NULL;
            lmb_gathered cached, traced;
            lmb_gather_sh3(&level.traced.transport, &point, 8192, &cached);
            lmb_gather_sh3(&reference, &point, 32768, &traced);
            const float *foreign = cached.moments.channel[side == 0 ? 1 : 0].c;
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                CHECK(!(fabsf(foreign[k]) > 0.0f), "%g m: foreign coefficient %d is %g", (double)point.position.x, k,
                      (double)foreign[k]);
            }
            const double home = (double)traced.moments.channel[side].c[0];
            CHECK_NEAR(cached.moments.channel[side].c[0], home, 0.04 * home, "%g m", (double)point.position.x);
        }
    }
    solved_level_close(&level);
}

/* A sheet that the sun lights from above, under a grey sky all around. */
static void sides_stay_apart(void)
{
    lmb_error error;
    solved_level level;
    CHECK(lmb_level_sun_plane(output_path("sheet"), 0.5f, (lmb_vec3){0.0f, -1.0f, 0.0f}, 100.0f, &error) == LMB_OK,
          "%s", error.message);
    if (!solved_level_open(&level, output_path("sheet"), "#ffffff", 1, -1, &small)) {
        return;
    }
    for (int i = 0; i < 8; ++i) {
        const lmb_vec3 above = {(float)i - 3.7f, 1.0f, 0.3f * (float)i};
        const lmb_vec3 below = {above.x, -1.0f, above.z};
        const lmb_rgb top = light_seen(&level, above, (lmb_vec3){0, -1, 0});
        const lmb_rgb bottom = light_seen(&level, below, (lmb_vec3){0, 1, 0});
        CHECK_NEAR(top.c[0], 1.0 + 100.0 / PI, 1e-3, "top %d", i);
        CHECK_NEAR(bottom.c[0], 1.0, 1e-5, "bottom %d", i);
    }
    solved_level_close(&level);
}

/* One tile, placed under a lamp, to its side, and mirrored so that its front looks down. */
static void instances_have_their_own_light(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int tile = lmb_level_builder_add_mesh(builder, "tile");
    lmb_level_builder_add_quad(builder, tile, material, (lmb_vec3){-0.1f, 0, 0.1f}, (lmb_vec3){0.2f, 0, 0},
                               (lmb_vec3){0, 0, -0.2f});
    static const lmb_vec3 positions[] = {{0, 0, 0}, {3, 0, 0}, {8, 0, 0}};
    lmb_level_builder_place(builder, "near", tile, positions[0]);
    lmb_level_builder_place(builder, "far", tile, positions[1]);
    lmb_level_node flipped = lmb_level_node_default("flipped");
    flipped.mesh = tile;
    flipped.translation = positions[2];
    flipped.scale = (lmb_vec3){1, -1, 1};
    lmb_level_builder_add_node(builder, &flipped);
    const lmb_level_light lamp = {
        .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1, 1, 1}}, .intensity = 100.0f};
    lmb_level_node node = lmb_level_node_default("lamp");
    node.light = lmb_level_builder_add_light(builder, &lamp);
    node.translation = (lmb_vec3){0, 4, 0};
    lmb_level_builder_add_node(builder, &node);
    lmb_error error;
    CHECK(lmb_level_builder_write(builder, output_path("instances"), &error) == LMB_OK, "%s", error.message);
    lmb_level_builder_destroy(builder);
    solved_level level;
    if (!solved_level_open(&level, output_path("instances"), NULL, 1, -1, &small)) {
        return;
    }
    for (int i = 0; i < 3; ++i) {
        const double x = (double)positions[i].x;
        const double expected = 100.0 * 4.0 / pow(x * x + 16.0, 1.5) / PI;
        const lmb_vec3 over = {positions[i].x + 0.01f, 1.0f, 0.02f};
        const lmb_vec3 under = {over.x, -1.0f, over.z};
        bool front;
        CHECK_NEAR(light_and_side_seen(&level, over, (lmb_vec3){0, -1, 0}, &front).c[0], expected, 0.03 * expected,
                   "x %g", x);
        CHECK(front == (i < 2), "x %g: which side is the front", x);
        CHECK(!(light_seen(&level, under, (lmb_vec3){0, 1, 0}).c[0] > 0.0f), "x %g: lit from below", x);
    }
    solved_level_close(&level);
}

/* Under an even sky what a floor reflects is its texture, pixel by pixel, however large its cells. */
static void albedo_is_exact_at_hits(void)
{
    static const uint8_t checker[2 * 2 * 4] = {255, 255, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255, 255};
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material tiled = lmb_level_material_default();
    tiled.base_color = (lmb_rgb){{0.8f, 0.4f, 0.2f}};
    tiled.base_color_texture = lmb_level_builder_add_image(builder, "checker", 2, 2, checker);
    tiled.texture_size_m = 4.0f;
    const int material = lmb_level_builder_add_material(builder, &tiled);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){0, 0, 0}, (lmb_vec3){8, 0, 0},
                               (lmb_vec3){0, 0, -8});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    lmb_error error;
    CHECK(lmb_level_builder_write(builder, output_path("checker"), &error) == LMB_OK, "%s", error.message);
    lmb_level_builder_destroy(builder);
    solved_level level;
    const lmb_surface_light_settings whole = {.cell_size = 100.0f, .max_cells = 10, .samples = 16};
    if (!solved_level_open(&level, output_path("checker"), "#ffffff", 1, 1, &whole)) {
        return;
    }
    CHECK(level.stats.cells == 2, "%u cells", level.stats.cells);
    for (int i = 0; i < 4; ++i) {
        /* A texel is 2 m wide, and is its own colour at its middle. */
        const float x = (float)(2 * (i % 2)) + 1.0f;
        const float z = -(float)(2 * (i / 2)) - 1.0f;
        const lmb_vec3 above = {x, 0.01f, z};
        const lmb_rgb down = traced_irradiance(&level.traced, above, (lmb_vec3){0, -1, 0}, 256);
        const bool white = down.c[0] > 0.4f;
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(down.c[c], white ? (double)tiled.base_color.c[c] : 0.0, 0.02, "texel %d, channel %d", i, c);
        }
        CHECK(white == ((i % 2 == 0) != (i / 2 == 0)), "texel %d is %s", i, white ? "white" : "black");
    }
    solved_level_close(&level);
}

/* Half of the light goes through a pane of alpha 0.5, to a floor that reflects. */
static void panes_let_light_through(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material ground = lmb_level_material_default();
    const int floor_material = lmb_level_builder_add_material(builder, &ground);
    lmb_level_material glass = lmb_level_material_default();
    glass.name = "glass";
    glass.base_color = (lmb_rgb){{0, 0, 0}};
    glass.alpha = 0.5f;
    glass.alpha_mode = LMB_LEVEL_BLEND;
    const int glass_material = lmb_level_builder_add_material(builder, &glass);
    const int mesh = lmb_level_builder_add_mesh(builder, "both");
    const lmb_vec3 along = {200, 0, 0}, back = {0, 0, -200};
    lmb_level_builder_add_quad(builder, mesh, floor_material, (lmb_vec3){-100, 0, 100}, along, back);
    lmb_level_builder_add_quad(builder, mesh, glass_material, (lmb_vec3){-100, 1, 100}, along, back);
    lmb_level_builder_place(builder, "both", mesh, (lmb_vec3){0, 0, 0});
    lmb_error error;
    CHECK(lmb_level_builder_write(builder, output_path("pane"), &error) == LMB_OK, "%s", error.message);
    lmb_level_builder_destroy(builder);
    solved_level level;
    const lmb_surface_light_settings cells = {.cell_size = 5.0f, .max_cells = 10000, .samples = 256};
    if (!solved_level_open(&level, output_path("pane"), "#ffffff", 1, -1, &cells)) {
        return;
    }
    const lmb_rgb under = traced_irradiance(&level.traced, (lmb_vec3){2, 0.5f, 1}, (lmb_vec3){0, -1, 0}, 4096);
    CHECK_NEAR(under.c[0], 0.5 * 0.5, 0.01, "reflected under the pane");
    const lmb_rgb over = traced_irradiance(&level.traced, (lmb_vec3){2, 2, 1}, (lmb_vec3){0, -1, 0}, 4096);
    CHECK_NEAR(over.c[0], 0.5 * 0.5 * 0.5, 0.01, "reflected and back through it");
    solved_level_close(&level);
}

static bool same_light(const solved_level *a, const solved_level *b)
{
    const lmb_scene *scene = a->traced.scene;
    bool same = true;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        for (uint32_t t = 0; t < scene->meshes[scene->instances[i].mesh].triangle_count; ++t) {
            for (int k = 0; k < 200; ++k) {
                const float u = (float)(k % 10) * 0.1f + 0.003f;
                const lmb_hit hit = {.instance = i, .triangle = t, .u = u, .v = (1.0f - u) * (float)(k / 20) * 0.1f};
                lmb_rgb light[2] = {{{0.0f, 0.0f, 0.0f}}, {{0.0f, 0.0f, 0.0f}}};
                const bool front = k / 10 % 2 == 0;
                const bool stored = lmb_surface_light_at(a->light, a->traced.tracer, &hit, front, &light[0]);
                same = same && stored == lmb_surface_light_at(b->light, b->traced.tracer, &hit, front, &light[1]) &&
                       memcmp(&light[0], &light[1], sizeof light[0]) == 0;
            }
        }
    }
    return same;
}

static void threads_do_not_matter(void)
{
    static const int threads[] = {1, 2, 7};
    lmb_error error;
    CHECK(lmb_level_cornell(output_path("threads"), &error) == LMB_OK, "%s", error.message);
    const lmb_surface_light_settings settings = {.max_cells = 5000, .samples = 8};
    solved_level levels[3];
    for (int i = 0; i < 3; ++i) {
        if (!solved_level_open(&levels[i], output_path("threads"), NULL, threads[i], -1, &settings)) {
            return;
        }
        CHECK(i == 0 || same_light(&levels[0], &levels[i]), "%d threads differ from 1", threads[i]);
        CHECK(levels[i].stats.rays == levels[0].stats.rays && levels[i].stats.passes == levels[0].stats.passes,
              "%d threads: other work", threads[i]);
    }
    for (int i = 0; i < 3; ++i) {
        solved_level_close(&levels[i]);
    }
}

enum { POINTS = 60 };

/* Root mean square over random surface points of what is stored there less what the path tracer finds, relative. */
static double stored_error(const solved_level *level, const lmb_hit *hits, const lmb_rgb *expected)
{
    double off = 0.0, length = 0.0;
    for (int i = 0; i < POINTS; ++i) {
        lmb_rgb stored = {{0.0f, 0.0f, 0.0f}};
        CHECK(lmb_surface_light_at(level->light, level->traced.tracer, &hits[i], true, &stored), "point %d", i);
        for (int c = 0; c < 3; ++c) {
            off += pow((double)stored.c[c] - (double)expected[i].c[c], 2.0);
            length += pow((double)expected[i].c[c], 2.0);
        }
    }
    return sqrt(off / length);
}

/* Smaller cells come closer to the irradiance at each point. */
static void bias_falls_with_cell_size(void)
{
    lmb_error error;
    level_fixture traced;
    CHECK(lmb_level_cornell(output_path("bias"), &error) == LMB_OK, "%s", error.message);
    if (!level_fixture_load(&traced, output_path("bias"), NULL, 1)) {
        return;
    }
    lmb_hit hits[POINTS];
    lmb_rgb expected[POINTS];
    int found = 0;
    for (uint32_t index = 0; found < POINTS; ++index) {
        /* What is seen from the middle of the box, but for the ceiling, where the lamp's back makes a narrow peak. */
        const double z = 1.0 - 2.0 * ((index * 0.6180339887) - floor(index * 0.6180339887));
        const double azimuth = 2.0 * PI * ((index * 0.7548776662) - floor(index * 0.7548776662));
        const double r = sqrt(1.0 - z * z);
        const lmb_vec3 direction = {(float)(r * cos(azimuth)), (float)z, (float)(r * sin(azimuth))};
        lmb_hit hit;
        if (!lmb_trace_nearest(traced.tracer, (lmb_vec3){0, 1.3f, 0}, direction, 0.0f, FLT_MAX, &hit) || !hit.front) {
            continue;
        }
        const lmb_place place = lmb_trace_place(traced.tracer, &hit);
        if (place.position.y > 1.9f) {
            continue;
        }
        const lmb_vec3 off =
            lmb_trace_offset(place.position, place.geometric_normal, place.rounding, place.geometric_normal);
        expected[found] = traced_irradiance(&traced, off, place.shading_normal, 4096);
        hits[found++] = hit;
    }
    level_fixture_close(&traced);
    static const float sizes[] = {4.0f, 0.6f, 0.15f};
    double errors[3];
    for (int i = 0; i < 3; ++i) {
        solved_level level;
        const lmb_surface_light_settings settings = {.cell_size = sizes[i], .max_cells = 100000, .samples = 128};
        if (!solved_level_open(&level, output_path("bias"), NULL, 1, -1, &settings)) {
            return;
        }
        errors[i] = stored_error(&level, hits, expected);
        printf("     cells of %g m: %u, %.3f off\n", (double)sizes[i], level.stats.cells, errors[i]);
        solved_level_close(&level);
    }
    CHECK(errors[1] < 0.7 * errors[0], "%g after %g", errors[1], errors[0]);
    CHECK(errors[2] < 0.7 * errors[1], "%g after %g", errors[2], errors[1]);
}

/* The cached gather finds what the path tracer finds, in the open and beside walls, within noise and 2 %. */
static void gather_agrees_with_reference(void)
{
    lmb_error error;
    solved_level level;
    CHECK(lmb_level_cornell(output_path("gather"), &error) == LMB_OK, "%s", error.message);
    const lmb_surface_light_settings settings = {.max_cells = 20000, .samples = 32};
    if (!solved_level_open(&level, output_path("gather"), NULL, 1, -1, &settings)) {
        return;
    }
    lmb_transport reference = level.traced.transport;
    reference.surface = NULL;
    static const lmb_vec3 positions[] = {{0, 1, 0}, {-0.6f, 0.7f, 0.2f}, {0.97f, 1.2f, 0.5f}, {0.6f, 0.4f, 0.9f}};
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
        const lmb_gather_point point = {.position = positions[i]};
        lmb_gathered cached, traced;
        lmb_gather_sh3(&level.traced.transport, &point, 8192, &cached);
        lmb_gather_sh3(&reference, &point, 32768, &traced);
        double off = 0.0;
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                off += pow((double)cached.moments.channel[c].c[k] - (double)traced.moments.channel[c].c[k], 2.0);
            }
        }
        const double noise = sqrt((cached.squared_error + traced.squared_error) / traced.squared_length);
        CHECK(noise < 0.04, "noise %g at point %zu", noise, i);
        CHECK_NEAR(sqrt(off / traced.squared_length), 0.0, 0.02 + 2.0 * noise, "at %g %g %g", (double)positions[i].x,
                   (double)positions[i].y, (double)positions[i].z);
    }
    solved_level_close(&level);
}

/* Stacks of thin white boards beside each other, a lamp of 1 m^2 above them, nothing behind. */
static lmb_result white_boards_write(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material white = lmb_level_material_default();
    white.base_color = (lmb_rgb){{1, 1, 1}};
    const int board = lmb_level_builder_add_material(builder, &white);
    lmb_level_material lamp = lmb_level_material_default();
    lamp.name = "lamp";
    lamp.base_color = (lmb_rgb){{0, 0, 0}};
    lamp.emission = (lmb_rgb){{10, 10, 10}};
    const int lamp_material = lmb_level_builder_add_material(builder, &lamp);
    const int mesh = lmb_level_builder_add_mesh(builder, "boards");
    for (int i = 0; i < 8 * 8 * 4; ++i) {
        const lmb_vec3 low = {(float)(i % 8), 0.1f * (float)(i / 64), (float)(i / 8 % 8)};
        const lmb_level_box box = lmb_level_box_of(low, (lmb_vec3){low.x + 0.9f, low.y + 0.05f, low.z + 0.9f}, board);
        lmb_level_builder_add_box(builder, mesh, &box);
    }
    lmb_level_builder_add_quad(builder, mesh, lamp_material, (lmb_vec3){3.5f, 3, 3.5f}, (lmb_vec3){1, 0, 0},
                               (lmb_vec3){0, 0, 1});
    lmb_level_builder_place(builder, "boards", mesh, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Light that gets between surfaces that absorb nothing finds its way out by the few samples that cells have: it does
 * not pile up. */
static void white_gaps_let_go_of_light(void)
{
    enum { SEEDS = 12, CRACKS = 24 };
    lmb_error error;
    CHECK(white_boards_write(output_path("boards"), &error) == LMB_OK, "%s", error.message);
    level_fixture traced;
    if (!level_fixture_load(&traced, output_path("boards"), NULL, 2)) {
        return;
    }
    lmb_gather_point point[CRACKS];
    double brightest = 0.0;
    for (int i = 0; i < CRACKS; ++i) {
        /* In the cracks between the boards, beside each layer. */
        point[i] = (lmb_gather_point){
            .position = {(float)(i % 6 + 1) - 0.05f, 0.1f * (float)(i / 6) + 0.02f, (float)(i % 5) + 1.45f}};
        lmb_gathered gathered;
        lmb_gather_sh3(&traced.transport, &point[i], 8192, &gathered);
        brightest = fmax(brightest, (double)gathered.moments.channel[0].c[0]);
    }
    const lmb_surface_light_settings settings = {.cell_size = 1.0f, .max_cells = 10000};
    for (uint64_t seed = 0; seed < SEEDS; ++seed) {
        solved_level level = {.traced = traced};
        level.traced.transport.seed = seed;
        if (!level_solve(&level, &settings)) {
            break;
        }
        for (int i = 0; i < CRACKS; ++i) {
            lmb_gathered gathered;
            lmb_gather_sh3(&level.traced.transport, &point[i], 1024, &gathered);
            const double found = (double)gathered.moments.channel[0].c[0];
            CHECK(found < 1.3 * brightest, "seed %d, crack %d: %g, brightest is %g", (int)seed, i, found, brightest);
        }
        lmb_surface_light_destroy(level.light);
    }
    level_fixture_close(&traced);
}

/* Cells are no longer than asked for, and no more than allowed. */
static void settings_bound_the_cells(void)
{
    lmb_error error;
    solved_level level;
    CHECK(lmb_level_open_ground(output_path("bound"), 16.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    lmb_surface_light_settings settings = {.cell_size = 2.0f, .max_cells = 10000, .samples = 4};
    if (solved_level_open(&level, output_path("bound"), "#ffffff", 1, -1, &settings)) {
        /* Legs of 16 m, 22.6 m across: 12 strips of 8 columns in each triangle. */
        CHECK(level.stats.cells == 2 * 12 * 8, "%u cells", level.stats.cells);
        CHECK_NEAR(lmb_surface_light_cell_size(level.light), 2.0, 0.0, "cell size");
        solved_level_close(&level);
    }
    settings.max_cells = 50;
    if (solved_level_open(&level, output_path("bound"), "#ffffff", 1, -1, &settings)) {
        CHECK(level.stats.cells <= 52 && level.stats.cells > 30, "%u cells", level.stats.cells);
        CHECK(lmb_surface_light_cell_size(level.light) > 2.0f, "cell size");
        CHECK(lmb_surface_light_bytes(level.light) < 52 * 100, "bytes");
        solved_level_close(&level);
    }
}

/* No light, and nothing at all. */
static void dark_levels_are_dark(void)
{
    lmb_error error;
    solved_level level;
    CHECK(lmb_level_open_ground(output_path("dark"), 16.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    if (solved_level_open(&level, output_path("dark"), NULL, 1, -1, &small)) {
        CHECK(level.stats.lit_sides == 0, "%u sides are lit", level.stats.lit_sides);
        const lmb_rgb down = traced_irradiance(&level.traced, (lmb_vec3){0, 1, 0}, (lmb_vec3){0, -1, 0}, 64);
        CHECK(!(down.c[0] > 0.0f), "%g", (double)down.c[0]);
        solved_level_close(&level);
    }
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    CHECK(lmb_level_builder_write(builder, output_path("empty"), &error) == LMB_OK, "%s", error.message);
    lmb_level_builder_destroy(builder);
    if (solved_level_open(&level, output_path("empty"), "#ffffff", 1, -1, &small)) {
        CHECK(level.stats.cells == 0, "%u cells", level.stats.cells);
        const lmb_rgb sky = traced_irradiance(&level.traced, (lmb_vec3){0, 1, 0}, (lmb_vec3){0, 1, 0}, 64);
        CHECK_NEAR(sky.c[0], 1.0, 0.01, "sky");
        solved_level_close(&level);
    }
}

static const test_case cases[] = {
    {"furnace_is_uniform", furnace_is_uniform},
    {"bounces_are_counted", bounces_are_counted},
    {"point_light_in_sphere", point_light_in_sphere},
    {"walls_do_not_leak", walls_do_not_leak},
    {"sides_stay_apart", sides_stay_apart},
    {"instances_have_their_own_light", instances_have_their_own_light},
    {"albedo_is_exact_at_hits", albedo_is_exact_at_hits},
    {"panes_let_light_through", panes_let_light_through},
    {"threads_do_not_matter", threads_do_not_matter},
    {"bias_falls_with_cell_size", bias_falls_with_cell_size},
    {"gather_agrees_with_reference", gather_agrees_with_reference},
    {"white_gaps_let_go_of_light", white_gaps_let_go_of_light},
    {"settings_bound_the_cells", settings_bound_the_cells},
    {"dark_levels_are_dark", dark_levels_are_dark},
};

TEST_MAIN(cases)
