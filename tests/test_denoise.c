/* Denoising of made-up points: their light and their noise are known. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/denoise.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "level_builder.h"
#include "level_fixture.h"

enum { SIDE = 48, COUNT = SIDE * SIDE };
#define SPACING 0.1f

/* Points with light `truth` times a pattern of coefficients, and noise of its own for each replicate. */
typedef struct points {
    size_t count;
    lmb_denoise_point *point;
    double *truth;
    lmb_gathered *gathered;
} points;

static points points_make(size_t count)
{
    return (points){count, calloc(count + 1, sizeof(lmb_denoise_point)), calloc(count + 1, sizeof(double)),
                    calloc(count + 1, sizeof(lmb_gathered))};
}

static void points_free(points *p)
{
    free(p->point);
    free(p->truth);
    free(p->gathered);
}

/* A square of them, from `corner` on along x and z. */
static points floor_make(lmb_vec3 corner)
{
    points p = points_make(COUNT);
    for (size_t i = 0; i < COUNT; ++i) {
        const lmb_vec3 step = {SPACING * (float)(i % SIDE), 0.0f, SPACING * (float)(i / SIDE)};
        p.point[i] = (lmb_denoise_point){lmb_vec3_add(corner, step), {0.0f, 1.0f, 0.0f}, SPACING};
    }
    return p;
}

static double pattern(int coefficient)
{
    return coefficient == 0 ? 1.0 : 0.3 / coefficient;
}

static double pattern_length(void)
{
    double sum = 0.0;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        sum += 3.0 * pattern(i) * pattern(i);
    }
    return sqrt(sum);
}

/* A number with mean 0 and variance 1. */
static double normal_number(uint64_t stream, uint32_t index, uint32_t dimension)
{
    double sum = -6.0;
    for (uint32_t k = 0; k < 12; ++k) {
        sum += (double)lmb_random(stream, index, dimension, k);
    }
    return sum;
}

/* Sets what was gathered: each replicate has noise of `share` of the light in its length, so that the mean of both has
 * share / sqrt(2). */
static void points_gather(points *p, double share, uint64_t stream)
{
    for (size_t i = 0; i < p->count; ++i) {
        lmb_gathered *const g = &p->gathered[i];
        *g = (lmb_gathered){.samples = 2};
        for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
            const double size = share * p->truth[i] * pattern_length() / sqrt(3.0 * LMB_SH3_COUNT);
            const double noise[] = {size * normal_number(stream, (uint32_t)i, 2 * (uint32_t)k),
                                    size * normal_number(stream, (uint32_t)i, 2 * (uint32_t)k + 1)};
            const double whole = p->truth[i] * pattern(k % LMB_SH3_COUNT) + 0.5 * (noise[0] + noise[1]);
            const double off = 0.5 * (noise[0] - noise[1]);
            g->moments.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] = (float)whole;
            g->difference.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] = (float)off;
            g->squared_error += off * off;
            g->squared_length += whole * whole;
        }
    }
}

static double squared_error(const points *p, size_t i)
{
    double sum = 0.0;
    for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
        const double off = (double)p->gathered[i].moments.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] -
                           p->truth[i] * pattern(k % LMB_SH3_COUNT);
        sum += off * off;
    }
    return sum;
}

/* Root mean square of the error over that of the light, as it is and as it is said to be. */
static double error_true(const points *p)
{
    double error = 0.0, light = 0.0;
    for (size_t i = 0; i < p->count; ++i) {
        error += squared_error(p, i);
        light += p->truth[i] * p->truth[i];
    }
    return sqrt(error / light) / pattern_length();
}

static double error_said(const points *p)
{
    double error = 0.0, light = 0.0;
    for (size_t i = 0; i < p->count; ++i) {
        error += p->gathered[i].squared_error;
        light += p->truth[i] * p->truth[i];
    }
    return sqrt(error / light) / pattern_length();
}

/* The mean of the first coefficients over that of the truth. */
static double mean_ratio(const points *p)
{
    double sum = 0.0, truth = 0.0;
    for (size_t i = 0; i < p->count; ++i) {
        sum += (double)p->gathered[i].moments.channel[1].c[0];
        truth += p->truth[i];
    }
    return sum / truth;
}

static void denoise(points *p)
{
    lmb_pool *pool;
    CHECK(lmb_pool_create(2, &pool) == LMB_OK, "pool");
    CHECK(lmb_denoise(p->point, p->count, NULL, pool, NULL, p->gathered) == LMB_OK, "denoise");
    lmb_pool_destroy(pool);
}

static void slopes_lose_their_noise(void)
{
    points p = floor_make((lmb_vec3){3.0f, 0.0f, -2.0f});
    for (size_t i = 0; i < COUNT; ++i) {
        p.truth[i] = 0.2 + 0.8 * (double)(i % SIDE) / SIDE + 0.5 * (double)(i / SIDE) / SIDE;
    }
    points_gather(&p, 0.1, 1);
    const double before = error_true(&p);
    denoise(&p);
    CHECK(error_true(&p) < 0.2 * before, "error %g, before %g", error_true(&p), before);
    CHECK(fabs(log(error_said(&p) / error_true(&p))) < log(1.5), "said %g, true %g", error_said(&p), error_true(&p));
    CHECK_NEAR(mean_ratio(&p), 1.0, 1e-3, "mean");
    points_free(&p);
}

/* The light on both sides of a shadow's edge stays as it is, right beside it too. */
static void edges_stay(void)
{
    static const double dark[] = {0.0, 0.3, 0.7};
    for (size_t k = 0; k < sizeof dark / sizeof dark[0]; ++k) {
        points p = floor_make((lmb_vec3){0.0f, 0.0f, 0.0f});
        for (size_t i = 0; i < COUNT; ++i) {
            p.truth[i] = i % SIDE < SIDE / 2 ? 1.0 : dark[k];
        }
        points_gather(&p, 0.1, 2);
        const double before = error_true(&p);
        denoise(&p);
        double beside = 0.0;
        for (size_t i = 0; i < COUNT; ++i) {
            if (i % SIDE == SIDE / 2 - 1 || i % SIDE == SIDE / 2) {
                beside += squared_error(&p, i) / (2.0 * SIDE);
            }
        }
        beside = sqrt(beside) / pattern_length();
        CHECK(beside < 0.08, "dark %g: error %g beside the edge", dark[k], beside);
        CHECK(error_true(&p) < 0.35 * before, "dark %g: error %g, before %g", dark[k], error_true(&p), before);
        for (size_t i = 0; dark[k] == 0.0 && i < COUNT; ++i) {
            CHECK(p.truth[i] > 0.0 || squared_error(&p, i) == 0.0, "point %zu got light", i);
        }
        points_free(&p);
    }
}

static void clean_light_is_untouched(void)
{
    points p = floor_make((lmb_vec3){0.0f, 0.0f, 0.0f});
    for (size_t i = 0; i < COUNT; ++i) {
        p.truth[i] = 1.5 + sin(0.9 * (double)(i % SIDE)) * cos(0.7 * (double)(i / SIDE));
    }
    points_gather(&p, 0.0, 3);
    lmb_gathered *const before = malloc(COUNT * sizeof *before);
    memcpy(before, p.gathered, COUNT * sizeof *before);
    denoise(&p);
    for (size_t i = 0; i < COUNT; ++i) {
        CHECK(memcmp(&before[i].moments, &p.gathered[i].moments, sizeof before[i].moments) == 0, "point %zu", i);
    }
    free(before);
    points_free(&p);
}

/* Two surfaces that meet, or lie above each other, keep their own light: 1 and 0.2, with twice the noise that would
 * hide the difference. */
static void surfaces_are_kept_apart(void)
{
    static const struct {
        const char *name;
        lmb_vec3 shift, normal;
        bool upright;
    } others[] = {{"a wall in the corner", {0, 0, 0}, {1, 0, 0}, true},
                  {"the other side of a thin floor", {0, -0.02f, 0}, {0, -1, 0}, false},
                  {"a shelf above", {0, 0.15f, 0}, {0, 1, 0}, false},
                  {"a lamp close under a ceiling", {0, 0.02f, 0}, {0, 1, 0}, false}};
    for (size_t k = 0; k < sizeof others / sizeof others[0]; ++k) {
        points one = floor_make((lmb_vec3){0, 0, 0});
        points p = points_make(2 * COUNT);
        for (size_t i = 0; i < COUNT; ++i) {
            const lmb_vec3 at = one.point[i].position;
            p.point[i] = one.point[i];
            p.truth[i] = 1.0;
            p.point[COUNT + i] = one.point[i];
            p.point[COUNT + i].position =
                lmb_vec3_add(others[k].shift, others[k].upright ? lmb_vec3_of(0, at.x + 0.5f * SPACING, at.z) : at);
            p.point[COUNT + i].normal = others[k].normal;
            p.truth[COUNT + i] = 0.2;
        }
        points_gather(&p, 0.5, 4);
        const double before = error_true(&p);
        denoise(&p);
        CHECK(error_true(&p) < 0.2 * before, "%s: error %g, before %g", others[k].name, error_true(&p), before);
        points_free(&one);
        points_free(&p);
    }
}

/* Light that few samples find: nine replicates in ten are dark, the tenth has 5 to 15 times the light. */
static void rare_light_is_spread_not_lost(void)
{
    points p = floor_make((lmb_vec3){0, 0, 0});
    for (size_t i = 0; i < COUNT; ++i) {
        p.truth[i] = 1.0;
        lmb_gathered *const g = &p.gathered[i];
        for (int k = 0; k < 3 * LMB_SH3_COUNT; ++k) {
            double replicate[2];
            for (uint32_t r = 0; r < 2; ++r) {
                const bool lit = lmb_random(5, (uint32_t)i, r, 0) < 0.1f;
                const double light = 5.0 + 10.0 * (double)lmb_random(5, (uint32_t)i, r, 1);
                replicate[r] = lit ? light * pattern(k % LMB_SH3_COUNT) : 0.0;
            }
            g->moments.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] = (float)(0.5 * (replicate[0] + replicate[1]));
            g->difference.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] =
                (float)(0.5 * (replicate[0] - replicate[1]));
            g->squared_error += 0.25 * (replicate[0] - replicate[1]) * (replicate[0] - replicate[1]);
        }
    }
    const double before = error_true(&p), mean = mean_ratio(&p);
    denoise(&p);
    CHECK(error_true(&p) < 0.25 * before, "error %g, before %g", error_true(&p), before);
    CHECK_NEAR(mean_ratio(&p), mean, 0.02, "mean");
    points_free(&p);
}

static void steady_light_stays(void)
{
    points p = floor_make((lmb_vec3){0, 0, 0});
    for (size_t i = 0; i < COUNT; ++i) {
        p.truth[i] = 1.0;
    }
    points_gather(&p, 0.2, 6);
    for (size_t i = 0; i < COUNT; ++i) {
        const float sun = i % 7 < 3 ? 5.0f : 0.0f;
        p.gathered[i].steady.channel[0].c[2] = sun;
        p.gathered[i].moments.channel[0].c[2] += sun;
    }
    denoise(&p);
    for (size_t i = 0; i < COUNT; ++i) {
        p.gathered[i].moments.channel[0].c[2] -= p.gathered[i].steady.channel[0].c[2];
    }
    CHECK(error_true(&p) < 0.03, "error %g", error_true(&p));
    points_free(&p);
}

static void threads_do_not_matter(void)
{
    lmb_gathered *first = NULL;
    for (int threads = 1; threads <= 7; threads += 3) {
        points p = floor_make((lmb_vec3){0, 0, 0});
        for (size_t i = 0; i < COUNT; ++i) {
            p.truth[i] = i % SIDE < SIDE / 3 ? 1.0 : 0.6;
        }
        points_gather(&p, 0.2, 7);
        lmb_pool *pool;
        CHECK(lmb_pool_create(threads, &pool) == LMB_OK, "pool");
        CHECK(lmb_denoise(p.point, p.count, NULL, pool, NULL, p.gathered) == LMB_OK, "denoise");
        lmb_pool_destroy(pool);
        if (first) {
            CHECK(memcmp(first, p.gathered, COUNT * sizeof *first) == 0, "%d threads", threads);
        } else {
            first = malloc(COUNT * sizeof *first);
            memcpy(first, p.gathered, COUNT * sizeof *first);
        }
        points_free(&p);
    }
    free(first);
}

/* Floors on top of each other, so that more points are around each than are kept in mind from pass to pass. */
static void stacks_lose_their_noise(void)
{
    enum { FLOORS = 12 };
    points p = points_make((size_t)FLOORS * COUNT);
    for (size_t i = 0; i < p.count; ++i) {
        const size_t floor = i / COUNT, x = i % SIDE, z = i / SIDE % SIDE;
        const lmb_vec3 at = {SPACING * (float)x, 0.5f * SPACING * (float)floor, SPACING * (float)z};
        p.point[i] = (lmb_denoise_point){at, {0.0f, 1.0f, 0.0f}, SPACING};
        p.truth[i] = 0.5 + 0.5 * (double)z / SIDE + 0.3 * (double)(floor % 2);
    }
    points_gather(&p, 0.1, 10);
    const double before = error_true(&p);
    denoise(&p);
    CHECK(error_true(&p) < 0.2 * before, "error %g, before %g", error_true(&p), before);
    CHECK_NEAR(mean_ratio(&p), 1.0, 1e-3, "mean");
    points_free(&p);
}

/* No points, one, many in one place, and spacings and places of all sizes. */
static void odd_points(void)
{
    points none = points_make(0);
    denoise(&none);
    points_free(&none);
    points p = points_make(3000);
    for (size_t i = 0; i < p.count; ++i) {
        const uint32_t n = (uint32_t)i;
        const float size = i < 1500 ? 1.0f : powf(10.0f, 8.0f * lmb_random(8, n, 0, 0) - 4.0f);
        p.point[i] = (lmb_denoise_point){{size * lmb_random(8, n, 1, 0), 0.0f, size * lmb_random(8, n, 2, 0)},
                                         {0.0f, 1.0f, 0.0f},
                                         i < 1500 ? 10.0f : size};
        p.truth[i] = 1.0;
    }
    points_gather(&p, 0.3, 9);
    const double before = error_true(&p);
    denoise(&p);
    for (size_t i = 0; i < p.count; ++i) {
        CHECK(isfinite(squared_error(&p, i)) && p.gathered[i].squared_error >= 0.0, "point %zu", i);
    }
    CHECK(error_true(&p) < before, "error %g, before %g", error_true(&p), before);
    p.count = 1;
    denoise(&p);
    points_free(&p);
}

/* A wall stands at x = 0 among lattice points half a metre apart. */
static bool wall_open(level_fixture *level)
{
    const char *path = LMB_TEST_OUTPUT_DIR "/denoise_wall.glb";
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int wall = lmb_level_builder_add_mesh(builder, "wall");
    lmb_level_builder_add_quad(builder, wall, material, (lmb_vec3){0, -9, -9}, (lmb_vec3){0, 18, 0},
                               (lmb_vec3){0, 0, 18});
    lmb_level_builder_place(builder, "wall", wall, (lmb_vec3){0, 0, 0});
    lmb_error error = {""};
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 2);
}

/* The mean of the first coefficients of points at that x. */
static double mean_at(const points *p, float x)
{
    double sum = 0.0, count = 0.0;
    for (size_t i = 0; i < p->count; ++i) {
        if (fabsf(p->point[i].position.x - x) < 0.04f) {
            sum += (double)p->gathered[i].moments.channel[1].c[0];
            count += 1.0;
        }
    }
    return sum / count;
}

/* Points in space lose their noise by those that they see, and slopes stay; light does not go through walls. */
static void space_is_filtered_by_sight(void)
{
    enum { EDGE = 10 };
    level_fixture level;
    if (!wall_open(&level)) {
        return;
    }
    points p = points_make(EDGE * EDGE * EDGE);
    for (size_t i = 0; i < p.count; ++i) {
        const lmb_vec3 at = {(float)(i % EDGE), (float)(i / EDGE % EDGE), (float)(i / EDGE / EDGE)};
        const lmb_vec3 position = lmb_vec3_scale(lmb_vec3_sub(at, lmb_vec3_of(4.5f, 4.5f, 4.5f)), 0.5f);
        p.point[i] = (lmb_denoise_point){.position = position, .spacing = 0.5f};
        p.truth[i] = position.x < 0.0f ? 1.0 + 0.05 * (double)at.y : 0.2;
    }
    points_gather(&p, 0.5, 9);
    const double before = error_true(&p);
    CHECK(lmb_denoise_in_space(p.point, p.count, level.tracer, level.pool, NULL, p.gathered) == LMB_OK, "denoise");
    CHECK(error_true(&p) < 0.4 * before, "error %g, before %g", error_true(&p), before);
    CHECK(fabs(log(error_said(&p) / error_true(&p))) < log(1.5), "said %g, true %g", error_said(&p), error_true(&p));
    CHECK_NEAR(mean_at(&p, 0.25f), 0.2, 0.02, "the dark side");
    CHECK_NEAR(mean_at(&p, -0.25f), 1.225, 0.05, "the lit side");
    points_free(&p);
    level_fixture_close(&level);
}

/* Light on a floor does not go under a wall that stands on it, however much noise hides the step. */
static void walls_part_surfaces(void)
{
    level_fixture level;
    if (!wall_open(&level)) {
        return;
    }
    const float half = 0.5f * SPACING * (SIDE - 1);
    points p = floor_make(lmb_vec3_of(-half, 0.0f, -half));
    for (size_t i = 0; i < COUNT; ++i) {
        p.truth[i] = p.point[i].position.x < 0.0f ? 1.0 : 0.0;
    }
    points_gather(&p, 1.0, 11);
    const double before = error_true(&p);
    CHECK(lmb_denoise(p.point, p.count, level.tracer, level.pool, NULL, p.gathered) == LMB_OK, "denoise");
    CHECK(error_true(&p) < 0.2 * before, "error %g, before %g", error_true(&p), before);
    for (size_t i = 0; i < COUNT; ++i) {
        CHECK(p.truth[i] > 0.0 || squared_error(&p, i) == 0.0, "point %zu got light", i);
    }
    CHECK_NEAR(mean_at(&p, -0.5f * SPACING), 1.0, 0.05, "beside the wall");
    points_free(&p);
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"slopes_lose_their_noise", slopes_lose_their_noise},
    {"edges_stay", edges_stay},
    {"clean_light_is_untouched", clean_light_is_untouched},
    {"surfaces_are_kept_apart", surfaces_are_kept_apart},
    {"rare_light_is_spread_not_lost", rare_light_is_spread_not_lost},
    {"steady_light_stays", steady_light_stays},
    {"threads_do_not_matter", threads_do_not_matter},
    {"stacks_lose_their_noise", stacks_lose_their_noise},
    {"odd_points", odd_points},
    {"space_is_filtered_by_sight", space_is_filtered_by_sight},
    {"walls_part_surfaces", walls_part_surfaces},
};

TEST_MAIN(cases)
