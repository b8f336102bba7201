/* How `lambent check` counts errors and where it looks: hand-made numbers, synthetic noise, areas and angles known by
 * analysis, and whole checks of levels and volumes whose light is known. */
#include "check.h"
#include "check_points.h"
#include "constant_volume.h"
#include "level_builder.h"
#include "level_fixture.h"
#include "levels.h"

#include <lambent/opaque_surface.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>

#include <stdlib.h>

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/check_" name

static lmb_rgb grey(double value)
{
    return (lmb_rgb){{(float)value, (float)value, (float)value}};
}

static void one_point_by_hand(void)
{
    const lmb_rgb x[2] = {{{1, 2, 3}}, {{0, 0, 6}}};
    const lmb_rgb r1[2] = {{{1, 1, 1}}, {{0, 2, 4}}};
    const lmb_rgb r2[2] = {{{3, 1, 2}}, {{0, 1, 4}}};
    const point_error error = point_error_of(x, r1, r2, 2);
    /* (x-r1)(x-r2): 0*-2, 1*1, 2*1, 0, -2*-1, 2*2; r1 r2: 3, 1, 2, 0, 2, 16 */
    CHECK_NEAR(error.product, (0 + 1 + 2 + 0 + 2 + 4) / 6.0, 1e-12, "product");
    CHECK_NEAR(error.reference, 24 / 6.0, 1e-12, "reference");
    CHECK_NEAR(error.own, (4 + 1 + 2.25 + 0 + 2.25 + 16) / 6.0, 1e-12, "own light");
    const point_light light = point_light_of(x, r1, r2, 2);
    CHECK_NEAR(light.reference, (2 + 1 + 1.5 + 0 + 1.5 + 4) / 6.0, 1e-12, "mean");
    CHECK_NEAR(light.reference_noise, (1 + 0 + 0.25 + 0 + 0.25 + 0) / 6.0, 1e-12, "noise");
    CHECK_NEAR(light.reference_product, 24 / 6.0, 1e-12, "product");
    CHECK_NEAR(light.excess, (0 + 1 + 1.5 + 0 + 0 + 2) / 6.0, 1e-12, "excess");
}

static void summary_by_hand(void)
{
    /* Own errors of 1 to 100 hundredths of a reference of 2: their squares' mean is 101 201 / 6e4. */
    point_error errors[100];
    for (int i = 0; i < 100; ++i) {
        const double off = 0.02 * ((37 * i) % 100 + 1);
        errors[i] = (point_error){.product = off * off, .reference = 4.0, .own = 4.0};
    }
    error_summary summary;
    CHECK(error_summarize(errors, NULL, 100, &summary) == LMB_OK, "memory");
    CHECK_NEAR(summary.rel_rmse, sqrt(101.0 * 201.0 / 6e4), 1e-9, "the mean of 1 to 100 squared");
    CHECK_NEAR(summary.median, 0.50, 1e-9, "median");
    CHECK_NEAR(summary.p95, 0.95, 1e-9, "p95");
    CHECK_NEAR(summary.share_over_10pct, 0.90, 1e-9, "11 to 100 hundredths");
    CHECK_NEAR(summary.max, 1.0, 1e-9, "max");
    /* Products 1 and 3 in turn over a reference of 4: the ratio's residuals are +-1, its error sqrt(100/(100 99))/4,
     * the root's half of that over sqrt(0.5). */
    for (int i = 0; i < 100; ++i) {
        errors[i].product = i % 2 == 0 ? 1.0 : 3.0;
    }
    CHECK(error_summarize(errors, NULL, 100, &summary) == LMB_OK, "memory");
    CHECK_NEAR(summary.rel_rmse, sqrt(2.0 / 4.0), 1e-12, "mean product 2, mean reference 4");
    CHECK_NEAR(summary.std_error, 0.5 * sqrt(1.0 / 99.0) / 4.0 / sqrt(0.5), 1e-12, "standard error");
}

/* Each point's own error is relative to its own light, but to no less than a hundredth of the mean. */
static void own_errors_are_relative_to_own_light(void)
{
    const point_error errors[] = {
        {.reference = 4.0, .own = 4.0, .product = 0.16},        /* 0.4 of 2 */
        {.reference = 0.25, .own = 0.25, .product = 0.04},      /* 0.2 of 0.5 */
        {.reference = 1e-6, .own = 1e-6, .product = 1e-6},      /* 0.001, of a hundredth of the mean of 0.8336... */
        {.reference = 100.0, .own = 100.0, .product = 10000.0}, /* does not count */
    };
    const bool has[] = {true, true, true, false};
    error_summary summary;
    CHECK(error_summarize(errors, has, 4, &summary) == LMB_OK, "memory");
    CHECK_NEAR(summary.median, 0.2, 1e-9, "the second of three");
    CHECK_NEAR(summary.max, 0.4, 1e-9, "the largest of those that count");
    CHECK_NEAR(summary.share_over_10pct, 1.0, 1e-9, "all three");
    const bool last[] = {true, true, false, false};
    CHECK(error_summarize(errors, last, 4, &summary) == LMB_OK && summary.median < 0.21, "the smaller of two");
    const point_error dark[] = {errors[0], {.reference = 0.0, .own = 0.0, .product = 1e-4}};
    CHECK(error_summarize(dark, NULL, 2, &summary) == LMB_OK, "memory");
    CHECK_NEAR(summary.max, 1.0, 1e-9, "0.01 where it is dark, over a hundredth of the mean of 2 and 0");
    const point_light lights[] = {{.reference = 2.0}, {.reference = 0.001, .excess = 0.5}, {.reference = 0.001}};
    CHECK_NEAR(leak_summarize(lights, has, 3).leak, 0.25 / (2.002 / 3.0), 1e-9, "two dark points");
    const bool without[] = {true, true, false};
    CHECK_NEAR(leak_summarize(lights, without, 3).leak, 0.5 / (2.001 / 2.0), 1e-9, "one dark point");
}

static void nothing_to_measure_is_nan(void)
{
    const point_error dark = {.product = 1.0, .reference = 0.0};
    error_summary summary = {0};
    CHECK(error_summarize(NULL, NULL, 0, &summary) == LMB_OK && isnan(summary.rel_rmse) && isnan(summary.max),
          "no points");
    CHECK(error_summarize(&dark, NULL, 1, &summary) == LMB_OK && isnan(summary.rel_rmse) && isnan(summary.p95),
          "no light");
    const point_error below = {.product = -0.5, .reference = 1.0, .own = 1.0};
    CHECK(error_summarize(&below, NULL, 1, &summary) == LMB_OK && summary.rel_rmse == 0.0,
          "noise below zero clamps to 0");
    const leak_summary leak = leak_summarize(NULL, NULL, 0);
    CHECK(leak.leak == 0.0 && leak.dark_points == 0 && isnan(leak.reference_mean), "no points");
}

/* Uniform noise of variance `deviation`^2 and mean 0. */
static double noise(uint32_t index, uint32_t dimension, double deviation)
{
    return sqrt(12.0) * deviation * ((double)lmb_random(7, index, dimension, 0) - 0.5);
}

/* A reference ten times noisier than the error to find: the halves' product finds it, and says how well. */
static void noise_of_the_reference_cancels(void)
{
    enum { POINTS = 2000, NORMALS = 8, RUNS = 40 };
    const double truth = 2.0, off = 0.1, deviation = 1.0;
    point_error *errors = malloc(POINTS * sizeof *errors);
    CHECK(errors, "memory");
    double sum = 0.0, square_sum = 0.0, claimed = 0.0;
    for (uint32_t run = 0; run < RUNS && errors; ++run) {
        for (uint32_t i = 0; i < POINTS; ++i) {
            lmb_rgb x[NORMALS], r1[NORMALS], r2[NORMALS];
            for (uint32_t k = 0; k < NORMALS; ++k) {
                const uint32_t index = (run * POINTS + i) * NORMALS + k;
                x[k] = grey(truth + (index % 2 == 0 ? off : -off));
                r1[k] = grey(truth + noise(index, 0, deviation));
                r2[k] = grey(truth + noise(index, 1, deviation));
            }
            errors[i] = point_error_of(x, r1, r2, NORMALS);
        }
        error_summary summary;
        CHECK(error_summarize(errors, NULL, POINTS, &summary) == LMB_OK, "memory");
        sum += summary.rel_rmse;
        square_sum += summary.rel_rmse * summary.rel_rmse;
        claimed += summary.std_error / RUNS;
    }
    free(errors);
    /* One run's product has standard deviation sqrt(1 + 2 off^2) / sqrt(16000), 80 % of off^2; the mean of squares over
     * runs is unbiased but for the clamp at 0. */
    CHECK_NEAR(square_sum / RUNS, off * off / (truth * truth), 0.4 * off * off / (truth * truth),
               "mean square of rel_rmse over %d runs", RUNS);
    const double spread = sqrt(square_sum / RUNS - sum / RUNS * (sum / RUNS));
    CHECK(claimed > 0.5 * spread && claimed < 2.5 * spread, "claimed error %g, spread %g", claimed, spread);
}

static void std_error_is_honest_where_it_is_small(void)
{
    enum { POINTS = 400, RUNS = 60 };
    double sum = 0.0, square_sum = 0.0, claimed = 0.0;
    point_error errors[POINTS];
    for (uint32_t run = 0; run < RUNS; ++run) {
        for (uint32_t i = 0; i < POINTS; ++i) {
            const uint32_t index = run * POINTS + i;
            const double truth = 1.0 + (double)lmb_random(9, index, 2, 0);
            const lmb_rgb x = grey(truth + 0.4 * ((double)lmb_random(9, index, 3, 0) - 0.5));
            const lmb_rgb r1 = grey(truth + noise(index, 4, 0.05));
            const lmb_rgb r2 = grey(truth + noise(index, 5, 0.05));
            errors[i] = point_error_of(&x, &r1, &r2, 1);
        }
        error_summary summary;
        CHECK(error_summarize(errors, NULL, POINTS, &summary) == LMB_OK, "memory");
        sum += summary.rel_rmse;
        square_sum += summary.rel_rmse * summary.rel_rmse;
        claimed += summary.std_error / RUNS;
    }
    /* Errors uniform in +-0.2, truth uniform in [1, 2]. */
    CHECK_NEAR(sum / RUNS, sqrt(0.04 / 3.0 / (7.0 / 3.0)), 0.001, "rel_rmse");
    const double spread = sqrt((square_sum - sum * sum / RUNS) / (RUNS - 1));
    CHECK_NEAR(claimed / spread, 1.0, 0.3, "claimed %g, spread %g", claimed, spread);
}

/* Points that are right though the reference is noisy: half of the products are below 0. */
static void noise_does_not_make_half_of_the_points_wrong(void)
{
    enum { POINTS = 1001 };
    point_error errors[POINTS];
    for (uint32_t i = 0; i < POINTS; ++i) {
        const lmb_rgb x = grey(1.0), r1 = grey(1.0 + noise(i, 6, 0.2)), r2 = grey(1.0 + noise(i, 7, 0.2));
        errors[i] = point_error_of(&x, &r1, &r2, 1);
    }
    error_summary summary;
    CHECK(error_summarize(errors, NULL, POINTS, &summary) == LMB_OK, "memory");
    CHECK(summary.median < 0.05, "median %g of noise of 0.2", summary.median);
}

static void leak_counts_only_dark_points(void)
{
    /* Mean reference 1: below 0.01 is dark. */
    const point_light lights[4] = {{.reference = 2.0, .reference_product = 4.0, .excess = 5.0},
                                   {.reference = 1.985, .reference_product = 4.0, .reference_noise = 0.02},
                                   {.reference = 0.010, .excess = 7.0},
                                   {.reference = 0.005, .excess = 0.25}};
    const leak_summary leak = leak_summarize(lights, NULL, 4);
    CHECK_NEAR(leak.reference_mean, 1.0, 1e-12, "mean");
    CHECK(leak.dark_points == 1, "%zu dark points", leak.dark_points);
    CHECK_NEAR(leak.leak, 0.25, 1e-12, "leak");
    CHECK_NEAR(leak.reference_std_error, sqrt(0.02 / 8.0), 1e-12, "standard error");
}

static void shading_normals_lean_60_degrees_at_most(void)
{
    enum { COUNT = 8, STREAMS = 500 };
    static const lmb_vec3 axes[] = {{0, 1, 0}, {0, 0, -1}, {1, 0, 0}, {0.6f, 0, -0.8f}};
    for (size_t a = 0; a < sizeof axes / sizeof axes[0]; ++a) {
        const lmb_vec3 axis = axes[a];
        double cosine_sum = 0.0, lowest = 1.0, side[3] = {0};
        for (uint64_t stream = 0; stream < STREAMS; ++stream) {
            lmb_vec3 normals[COUNT];
            shading_normals(axis, stream, COUNT, normals);
            for (int k = 0; k < COUNT; ++k) {
                const double x = (double)normals[k].x, y = (double)normals[k].y, z = (double)normals[k].z;
                const double cosine = x * (double)axis.x + y * (double)axis.y + z * (double)axis.z;
                CHECK_NEAR(x * x + y * y + z * z, 1.0, 1e-5, "unit, axis %zu stream %d", a, (int)stream);
                cosine_sum += cosine;
                lowest = fmin(lowest, cosine);
                side[0] += x - cosine * (double)axis.x;
                side[1] += y - cosine * (double)axis.y;
                side[2] += z - cosine * (double)axis.z;
            }
        }
        CHECK(lowest > 0.5 - 1e-5 && lowest < 0.52, "axis %zu: the lowest cosine is %g", a, lowest);
        /* E[cos] over the cap with density in proportion to cos: (1 - c^3)/3 over (1 - c^2)/2, c = 1/2. */
        CHECK_NEAR(cosine_sum / (COUNT * STREAMS), 7.0 / 9.0, 0.005, "axis %zu: mean cosine", a);
        for (int i = 0; i < 3; ++i) {
            CHECK_NEAR(side[i] / (COUNT * STREAMS), 0.0, 0.02, "axis %zu: leans to no side (%d)", a, i);
        }
    }
}

static void sphere_directions_are_uniform(void)
{
    enum { COUNT = 8, STREAMS = 1000 };
    double mean[3] = {0}, square[3] = {0};
    for (uint64_t stream = 0; stream < STREAMS; ++stream) {
        lmb_vec3 directions[COUNT];
        sphere_directions(stream, COUNT, directions);
        for (int k = 0; k < COUNT; ++k) {
            const double d[3] = {(double)directions[k].x, (double)directions[k].y, (double)directions[k].z};
            for (int i = 0; i < 3; ++i) {
                mean[i] += d[i] / (COUNT * STREAMS);
                square[i] += d[i] * d[i] / (COUNT * STREAMS);
            }
        }
    }
    for (int i = 0; i < 3; ++i) {
        CHECK_NEAR(mean[i], 0.0, 0.02, "axis %d", i);
        CHECK_NEAR(square[i], 1.0 / 3.0, 0.01, "axis %d", i);
    }
}

static int add_material(lmb_level_builder *builder, lmb_level_alpha alpha_mode)
{
    lmb_level_material material = lmb_level_material_default();
    material.alpha_mode = alpha_mode;
    material.alpha = 0.5f;
    return lmb_level_builder_add_material(builder, &material);
}

static int add_quad_mesh(lmb_level_builder *builder, const char *name, int material, float width, float height)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){0, 0, 0}, (lmb_vec3){width, 0, 0},
                               (lmb_vec3){0, height, 0});
    return mesh;
}

/* Opaque 1 x 1, opaque 1 x 3 scaled by two, a pane that lets light through, and a thing that moves. */
static lmb_result write_quads(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int opaque = add_material(builder, LMB_LEVEL_OPAQUE);
    const int pane = add_material(builder, LMB_LEVEL_BLEND);
    lmb_level_builder_place(builder, "small", add_quad_mesh(builder, "small", opaque, 1, 1), (lmb_vec3){0, 0, 0});
    lmb_level_builder_place(builder, "pane", add_quad_mesh(builder, "pane", pane, 5, 5), (lmb_vec3){0, 0, 1});
    lmb_level_node node = lmb_level_node_default("large");
    node.mesh = add_quad_mesh(builder, "large", opaque, 1, 3);
    node.scale = (lmb_vec3){2, 2, 2};
    lmb_level_builder_add_node(builder, &node);
    node = lmb_level_node_default("door");
    node.mesh = add_quad_mesh(builder, "door", opaque, 9, 9);
    node.dynamic = true;
    lmb_level_builder_add_node(builder, &node);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void surface_points_are_spread_by_area(void)
{
    enum { COUNT = 13000 };
    const char *path = OUTPUT("quads.glb");
    lmb_error error = {""};
    level_fixture level;
    if (!level_fixture_open(&level, path, write_quads(path, &error), &error, 1)) {
        return;
    }
    lmb_opaque_surface surface;
    CHECK(lmb_opaque_surface_create(level.tracer, &surface) == LMB_OK, "memory");
    CHECK_NEAR(lmb_opaque_surface_area(&surface), 13.0, 1e-5, "1 + 2 * 6");
    int small = 0, large = 0, other = 0, cell[2][2] = {{0}};
    for (uint32_t i = 0; i < COUNT; ++i) {
        const lmb_hit point = lmb_opaque_surface_point(&surface, 3, i, COUNT);
        const char *name = level.scene->instances[point.instance].name;
        CHECK(point.u >= 0.0f && point.v >= 0.0f && point.u + point.v <= 1.0f + 1e-6f, "point %u", i);
        if (strcmp(name, "small") == 0) {
            ++small;
        } else if (strcmp(name, "large") == 0) {
            ++large;
            const lmb_place place = lmb_trace_place(level.tracer, &point);
            ++cell[place.position.x > 1.0f][place.position.y > 3.0f];
        } else {
            ++other;
        }
    }
    CHECK(small >= COUNT / 13 - 1 && small <= COUNT / 13 + 1, "%d on the small quad", small);
    CHECK(large >= COUNT / 13 * 12 - 1 && large <= COUNT / 13 * 12 + 1, "%d on the large quad", large);
    CHECK(other == 0, "%d on a pane or on a thing that moves", other);
    for (int i = 0; i < 4; ++i) {
        CHECK_NEAR(cell[i / 2][i % 2], 3000, 200, "quarter %d of the large quad", i);
    }
    const lmb_hit again = lmb_opaque_surface_point(&surface, 3, 17, COUNT);
    const lmb_hit once = lmb_opaque_surface_point(&surface, 3, 17, COUNT);
    const lmb_hit reseeded = lmb_opaque_surface_point(&surface, 4, 17, COUNT);
    CHECK(again.triangle == once.triangle && again.u == once.u && again.v == once.v, "the same seed, the same point");
    CHECK(reseeded.u != once.u || reseeded.v != once.v, "another seed, another point");
    lmb_opaque_surface_free(&surface);
    level_fixture_close(&level);
}

static void ambient_visibility_of_a_wall(void)
{
    const char *path = OUTPUT("quads.glb");
    lmb_error error = {""};
    level_fixture level;
    if (!level_fixture_open(&level, path, write_quads(path, &error), &error, 1)) {
        return;
    }
    /* The pane of 50 % in front of the wall, far larger than what lies within reach, lets half through. */
    const lmb_vec3 at = {2.5f, 2.5f, 0.9999f}, towards = {0, 0, 1}, away = {0, 0, -1};
    CHECK_NEAR(ambient_visibility(level.tracer, at, towards, 0.5f, 1, 256), 0.5, 0.01, "towards the pane");
    CHECK_NEAR(ambient_visibility(level.tracer, at, away, 0.5f, 1, 256), 1.0, 1e-6, "nothing within reach");
    level_fixture_close(&level);
}

/* In a furnace the truth is one radiance everywhere: a volume that is 10 % too bright is wrong by 10 %, by any model.
 */
static void furnace_gives_the_error_that_was_put_in(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("furnace.glb");
    const lmb_result written = lmb_level_furnace(path, 4.0f, 0.5f, (lmb_rgb){{0.5f, 1.0f, 2.0f}}, false, &error);
    check_report reports[2] = {{0}};
    for (int threads = 1; threads <= 2; ++threads) {
        level_fixture level;
        constant_volume light;
        if (!level_fixture_open(&level, path, written, &error, threads)) {
            return;
        }
        if (constant_volume_make(level.scene, (lmb_rgb){{1.1f, 2.2f, 4.4f}}, &light)) {
            const check_subject subject = {&level.transport, light.volume, NULL, level.pool, NULL};
            const check_settings settings = {.points = 100, .samples = 64, .seed = 5};
            CHECK(check_run(&subject, &settings, NULL, &reports[threads - 1]) == LMB_OK, "runs");
            constant_volume_close(&light);
        }
        level_fixture_close(&level);
    }
    const check_report *report = &reports[0];
    CHECK(report->points == 100, "%zu points", report->points);
    /* Though the volume reaches beyond the closed box, from where its walls show their backs. */
    CHECK(report->free_points == 100, "%zu free points", report->free_points);
    static const check_pair pairs_with_error[] = {CHECK_PROBE_VS_REFERENCE, CHECK_OBJECT_VS_REFERENCE,
                                                  CHECK_VOLUME_VS_REFERENCE};
    for (size_t i = 0; i < sizeof pairs_with_error / sizeof pairs_with_error[0]; ++i) {
        const error_summary *summary = &report->error[pairs_with_error[i]];
        CHECK_NEAR(summary->rel_rmse, 0.1, 4 * summary->std_error + 0.002, "%s", check_pair_name(pairs_with_error[i]));
        CHECK(summary->std_error < 0.02, "%s: +-%g", check_pair_name(pairs_with_error[i]), summary->std_error);
    }
    CHECK(report->error[CHECK_COINCIDENT_PROBE_VS_REFERENCE].rel_rmse < 0.08, "a traced probe is right: %g",
          report->error[CHECK_COINCIDENT_PROBE_VS_REFERENCE].rel_rmse);
    for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
        const error_summary *one = &reports[0].error[pair], *two = &reports[1].error[pair];
        CHECK(isnan(one->rel_rmse) == check_pair_needs_lightmap((check_pair)pair), "%s",
              check_pair_name((check_pair)pair));
        CHECK(memcmp(one, two, sizeof *one) == 0, "%s: the same for two threads", check_pair_name((check_pair)pair));
    }
    CHECK(report->leak.dark_points == 0 && report->leak.leak == 0.0, "nothing is dark");
    CHECK(isnan(report->lightmap_leak), "no lightmap");
}

/* The same with a lightmap that was baked: right itself, and what the probe is 10 % off from. */
static void lightmaps_take_part(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("furnace_lightmap.glb");
    const lmb_result written = lmb_level_furnace(path, 4.0f, 0.5f, (lmb_rgb){{0.5f, 1.0f, 2.0f}}, false, &error);
    level_fixture level;
    constant_volume light;
    if (!level_fixture_open(&level, path, written, &error, 2)) {
        return;
    }
    if (!constant_volume_make(level.scene, (lmb_rgb){{1.1f, 2.2f, 4.4f}}, &light)) {
        level_fixture_close(&level);
        return;
    }
    const lmb_lightmap_settings texels = {.texels_per_m = 2.0f, .max_image_size = 256};
    lmb_gather_stats stats;
    lmb_lightmap *lightmap = NULL;
    const bool baked = lmb_lightmap_create(level.scene, &texels, &lightmap, &error) == LMB_OK &&
                       lmb_lightmap_bake(lightmap, &level.transport, &(lmb_gather_effort){.samples = 1024}, level.pool,
                                         NULL, &stats) == LMB_OK;
    CHECK(baked, "%s", error.message);
    const check_subject subject = {&level.transport, light.volume, lightmap, level.pool, NULL};
    const check_settings settings = {.points = 200, .samples = 128, .seed = 2};
    check_report report;
    if (baked) {
        CHECK(check_run(&subject, &settings, NULL, &report) == LMB_OK, "runs");
        CHECK(report.error[CHECK_LIGHTMAP_VS_REFERENCE].rel_rmse < 0.03, "lightmap: %g",
              report.error[CHECK_LIGHTMAP_VS_REFERENCE].rel_rmse);
        CHECK_NEAR(report.error[CHECK_PROBE_VS_LIGHTMAP].rel_rmse, 0.1, 0.02, "probe against lightmap");
        /* Without occlusion a leaning normal gets 1.1 of the radiance, not (1 + t)/2 of it: off by 0.1 to 0.35 for t of
         * 1 to 1/2, over a root mean square of 0.89. */
        const double unoccluded = report.error[CHECK_UNOCCLUDED_PROBE_VS_LIGHTMAP].rel_rmse;
        CHECK(unoccluded > 0.2 && unoccluded < 0.35, "unoccluded: %g", unoccluded);
        CHECK(report.lightmap_leak == 0.0, "nothing is dark");
        /* What has no lightmap is not compared with one. */
        lightmap->region[0].image = -1;
        CHECK(check_run(&subject, &settings, NULL, &report) == LMB_OK, "runs");
        for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
            CHECK(isnan(report.error[pair].rel_rmse) == check_pair_needs_lightmap((check_pair)pair), "%s",
                  check_pair_name((check_pair)pair));
        }
    }
    lmb_lightmap_destroy(lightmap);
    constant_volume_close(&light);
    level_fixture_close(&level);
}

/* Points are added until the standard error of every line is below a tenth of its figure, or there are enough. */
static void points_are_added_until_enough_is_known(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("round_rooms.glb");
    const lmb_two_rooms rooms = lmb_two_rooms_default();
    level_fixture level;
    constant_volume light;
    if (!level_fixture_open(&level, path, lmb_level_two_rooms(path, &rooms, &error), &error, 2)) {
        return;
    }
    if (constant_volume_make(level.scene, (lmb_rgb){{0.25f, 0.25f, 0.25f}}, &light)) {
        const check_subject subject = {&level.transport, light.volume, NULL, level.pool, NULL};
        check_settings settings = {.points = 20, .max_points = 50, .samples = 64, .seed = 1};
        check_report report;
        CHECK(check_run(&subject, &settings, NULL, &report) == LMB_OK, "runs");
        CHECK(report.points == 50, "%zu points: 20, 20 and 10", report.points);
        settings.max_points = 100000;
        CHECK(check_run(&subject, &settings, NULL, &report) == LMB_OK, "runs");
        CHECK(report.points > 100 && report.points < 20000, "%zu points", report.points);
        for (int pair = 0; pair < CHECK_PAIR_COUNT; ++pair) {
            const error_summary *one = &report.error[pair];
            CHECK(isnan(one->rel_rmse) || one->std_error < 0.1 * one->rel_rmse, "%s: %g +- %g",
                  check_pair_name((check_pair)pair), one->rel_rmse, one->std_error);
        }
        constant_volume_close(&light);
    }
    level_fixture_close(&level);
}

/* One room lit, one dark, and a volume that is equally bright all over: what the dark room's walls get is the leak. */
static void leak_into_a_dark_room(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("rooms.glb");
    lmb_two_rooms rooms = lmb_two_rooms_default();
    rooms.green_radiance = 0.0f;
    level_fixture level;
    constant_volume light;
    if (!level_fixture_open(&level, path, lmb_level_two_rooms(path, &rooms, &error), &error, 2)) {
        return;
    }
    if (constant_volume_make(level.scene, (lmb_rgb){{0.25f, 0.25f, 0.25f}}, &light)) {
        const check_subject subject = {&level.transport, light.volume, NULL, level.pool, NULL};
        const check_settings settings = {.points = 200, .samples = 32, .seed = 1};
        check_report report;
        CHECK(check_run(&subject, &settings, NULL, &report) == LMB_OK, "runs");
        /* The dark room, and the outside of the whole hull. */
        CHECK(report.leak.dark_points > 100 && report.leak.dark_points < 180, "%zu dark points",
              report.leak.dark_points);
        /* A hemisphere of one radiance gives a normal that leans by a cosine t (1 + t)/2 of it; E[t] = 7/9. */
        CHECK_NEAR(report.leak.leak * report.leak.reference_mean, 0.25 * 8 / 9, 0.002, "leak");
        constant_volume_close(&light);
    }
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"one_point_by_hand", one_point_by_hand},
    {"summary_by_hand", summary_by_hand},
    {"own_errors_are_relative_to_own_light", own_errors_are_relative_to_own_light},
    {"nothing_to_measure_is_nan", nothing_to_measure_is_nan},
    {"noise_of_the_reference_cancels", noise_of_the_reference_cancels},
    {"std_error_is_honest_where_it_is_small", std_error_is_honest_where_it_is_small},
    {"noise_does_not_make_half_of_the_points_wrong", noise_does_not_make_half_of_the_points_wrong},
    {"leak_counts_only_dark_points", leak_counts_only_dark_points},
    {"shading_normals_lean_60_degrees_at_most", shading_normals_lean_60_degrees_at_most},
    {"sphere_directions_are_uniform", sphere_directions_are_uniform},
    {"surface_points_are_spread_by_area", surface_points_are_spread_by_area},
    {"ambient_visibility_of_a_wall", ambient_visibility_of_a_wall},
    {"furnace_gives_the_error_that_was_put_in", furnace_gives_the_error_that_was_put_in},
    {"lightmaps_take_part", lightmaps_take_part},
    {"points_are_added_until_enough_is_known", points_are_added_until_enough_is_known},
    {"leak_into_a_dark_room", leak_into_a_dark_room},
};

TEST_MAIN(cases)
