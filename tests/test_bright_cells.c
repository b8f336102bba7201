/* Aiming at bright cells changes no answer, only its noise. */
#include <math.h>
#include <stdlib.h>

#include <lambent/surface_solve.h>

#include "harness.h"
#include "surface/surface_light_internal.h"
#include "scenes/level_builder.h"
#include "scenes/levels.h"
#include "level_fixture.h"

typedef struct lit_level {
    level_fixture traced;
    lmb_surface_light *light;
} lit_level;

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/bright_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

/* A room of 6 x 3 x 6 m, grey, with a torch 15 cm off a wall, and a second one in a corner behind a pillar. `side` -1
 * puts the pillar to the other side, by mirroring the room. */
static lmb_result torches_write(const char *path, float side, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.2f);
    lmb_level_material grey = lmb_level_material_default();
    grey.base_color = (lmb_rgb){{0.6f, 0.5f, 0.4f}};
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int room = lmb_level_builder_add_mesh(builder, "room");
    lmb_level_box walls = lmb_level_box_of((lmb_vec3){-3, 0, -3}, (lmb_vec3){3, 3, 3}, material);
    walls.inward = true;
    lmb_level_builder_add_box(builder, room, &walls);
    const lmb_level_box pillar = lmb_level_box_of((lmb_vec3){1, 0, 1}, (lmb_vec3){1.5f, 3, 1.5f}, material);
    lmb_level_builder_add_box(builder, room, &pillar);
    lmb_level_node walled = lmb_level_node_default("room");
    walled.mesh = room;
    walled.scale = (lmb_vec3){side, 1, 1};
    lmb_level_builder_add_node(builder, &walled);
    const lmb_level_light torch = {
        .name = "torch", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.6f, 0.3f}}, .intensity = 10.0f};
    lmb_level_node node = lmb_level_node_default("torch");
    node.light = lmb_level_builder_add_light(builder, &torch);
    node.translation = (lmb_vec3){-2.85f, 1.8f, 0.3f};
    lmb_level_builder_add_node(builder, &node);
    node.translation = (lmb_vec3){2.8f, 1.5f, 2.8f};
    lmb_level_builder_add_node(builder, &node);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static bool lit_level_open(lit_level *level, const char *path, lmb_result written, lmb_error *error,
                           const char *environment)
{
    *level = (lit_level){0};
    CHECK(written == LMB_OK, "%s", error->message);
    if (written != LMB_OK || !level_fixture_load(&level->traced, path, environment, 2)) {
        return false;
    }
    const lmb_surface_light_settings settings = {.max_cells = 8000, .samples = 16};
    lmb_surface_light_stats stats;
    const lmb_result result =
        lmb_surface_light_solve(&level->traced.transport, &settings, level->traced.pool, &level->light, &stats, error);
    CHECK(result == LMB_OK, "%s", error->message);
    level->traced.transport.surface = level->light;
    return result == LMB_OK;
}

static void lit_level_close(lit_level *level)
{
    lmb_surface_light_destroy(level->light);
    level_fixture_close(&level->traced);
}

/* The same light, found by chance only. */
static lmb_transport by_chance(const lit_level *level, struct lmb_surface_light *unaimed)
{
    *unaimed = *level->light;
    unaimed->bright = NULL;
    lmb_transport transport = level->traced.transport;
    transport.surface = unaimed;
    return transport;
}

typedef struct element {
    lmb_gather_point point[3];
    uint32_t count;
} element;

static const element elements[] = {
    {{{.position = {0, 1.5f, 0}}}, 1},
    {{{.position = {-2.5f, 1.5f, 0.3f}}}, 1}, /* within the bright patch's own cell sizes */
    {{{.position = {2.2f, 0.5f, 2.9f}}}, 1},
    {{{.position = {0, 0.001f, 0}, .hemisphere = true, .normal = {0, 1, 0}},
      {.position = {0.1f, 0.001f, 0}, .hemisphere = true, .normal = {0, 1, 0}},
      {.position = {0, 0.001f, 0.1f}, .hemisphere = true, .normal = {0, 1, 0}}},
     3},
};
enum { ELEMENTS = sizeof elements / sizeof elements[0] };

static double squared_distance(const lmb_gathered *a, const lmb_gathered *b)
{
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            sum += pow((double)a->moments.channel[c].c[k] - (double)b->moments.channel[c].c[k], 2.0);
        }
    }
    return sum;
}

/* Mean over seeds of gathers by `samples`, and of their squared distances from `truth`. */
static lmb_gathered seeds_mean(lmb_transport transport, const element *where, uint32_t samples, int seeds,
                               const lmb_gathered *truth, double *squared)
{
    lmb_gathered mean = {.samples = 0};
    *squared = 0.0;
    for (int seed = 0; seed < seeds; ++seed) {
        lmb_gathered one;
        transport.seed = 100 + (uint64_t)seed;
        lmb_gather_sh3_area(&transport, where->point, where->count, samples, &one);
        *squared += squared_distance(&one, truth) / seeds;
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                mean.moments.channel[c].c[k] += one.moments.channel[c].c[k] / (float)seeds;
            }
        }
    }
    return mean;
}

/* Whatever the number of samples, whole blocks or not: the mean of many gathers is that of one by chance only. */
static void aiming_is_unbiased(void)
{
    static const uint32_t samples[] = {2, 10, 18, 64, 134};
    enum { SEEDS = 2000 };
    lmb_error error = {{0}};
    lit_level level;
    if (!lit_level_open(&level, output_path("torches"), torches_write(output_path("torches"), 1, &error), &error,
                        NULL)) {
        return;
    }
    CHECK(level.light->bright != NULL, "no cell is bright beside a torch");
    lmb_surface_light unaimed;
    const lmb_transport plain = by_chance(&level, &unaimed);
    for (int i = 0; i < ELEMENTS && level.light->bright; ++i) {
        lmb_gathered truth;
        lmb_gather_sh3_area(&plain, elements[i].point, elements[i].count, 1 << 18, &truth);
        for (size_t k = 0; k < sizeof samples / sizeof samples[0]; ++k) {
            double squared;
            const lmb_gathered mean =
                seeds_mean(level.traced.transport, &elements[i], samples[k], SEEDS, &truth, &squared);
            const double off = sqrt(squared_distance(&mean, &truth) / truth.squared_length);
            const double noise = sqrt((squared / SEEDS + truth.squared_error) / truth.squared_length);
            CHECK(noise < 0.04, "element %d, %u samples: noise %g", i, samples[k], noise);
            CHECK_NEAR(off, 0.0, 2.5 * noise, "element %d, %u samples", i, samples[k]);
        }
    }
    lit_level_close(&level);
}

static void noise_check(float side)
{
    enum { SEEDS = 64, SAMPLES = 128 };
    lmb_error error = {{0}};
    lit_level level;
    if (!lit_level_open(&level, output_path("noise"), torches_write(output_path("noise"), side, &error), &error,
                        NULL)) {
        return;
    }
    lmb_surface_light unaimed;
    const lmb_transport plain = by_chance(&level, &unaimed);
    double with = 0.0, without = 0.0;
    for (int i = 0; i < ELEMENTS; ++i) {
        lmb_gathered truth;
        double squared;
        lmb_gather_sh3_area(&level.traced.transport, elements[i].point, elements[i].count, 1 << 18, &truth);
        seeds_mean(level.traced.transport, &elements[i], SAMPLES, SEEDS, &truth, &squared);
        with += squared / truth.squared_length;
        seeds_mean(plain, &elements[i], SAMPLES, SEEDS, &truth, &squared);
        without += squared / truth.squared_length;
    }
    printf("     %.2f %% with, %.2f %% without\n", 100.0 * sqrt(with / ELEMENTS), 100.0 * sqrt(without / ELEMENTS));
    CHECK(with < 0.25 * without, "side %g: %g with, %g without", (double)side, sqrt(with), sqrt(without));
    lit_level_close(&level);
}

/* That is what it is for, in mirrored rooms too. */
static void aiming_takes_noise_away(void)
{
    noise_check(1.0f);
    noise_check(-1.0f);
}

/* Under an even sky no place is brighter than all others. */
static void even_light_has_no_bright_cells(void)
{
    lmb_error error = {{0}};
    lit_level level;
    if (lit_level_open(&level, output_path("even"), lmb_level_open_ground(output_path("even"), 16.0f, 0.5f, &error),
                       &error, "#ffffff")) {
        CHECK(level.light->bright == NULL, "bright cells on open ground");
        lit_level_close(&level);
    }
}

static const test_case cases[] = {
    {"aiming_is_unbiased", aiming_is_unbiased},
    {"aiming_takes_noise_away", aiming_takes_noise_away},
    {"even_light_has_no_bright_cells", even_light_has_no_bright_cells},
};

TEST_MAIN(cases)
