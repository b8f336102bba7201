/* Levels of probes: finer ones where light changes fast, and nowhere else. */
#include <stdlib.h>

#include <lambent/placement.h>
#include <lambent/probes_bake.h>

#include "level_fixture.h"
#include "probes_fixture.h"
#include "scenes/levels.h"

#define PI 3.14159265358979323846
#define TOLERANCE 0.015

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/placement_levels_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

/* Levels of 2, 1, 0.5 and 0.25 m; NULL is a failed check. */
static lmb_probes *levels_place(const level_fixture *level, int32_t max_probes, const lmb_vec3d *seed,
                                lmb_placement_stats *stats)
{
    lmb_error error = {{0}};
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = 1.0f;
    settings.seeds = seed;
    settings.seed_count = seed ? 1 : 0;
    const lmb_levels_settings levels = {.coarser = 1,
                                        .finer = 2,
                                        .tolerance = TOLERANCE,
                                        .dark = 1e-3,
                                        .effort = {.samples = 64, .max_samples = 1024, .tolerance = TOLERANCE},
                                        .max_probes = max_probes,
                                        .has_seeds = seed != NULL};
    lmb_probes *probes = NULL;
    lmb_result result = lmb_placement_make(level->tracer, &settings, level->pool, &probes, stats, &error);
    if (result == LMB_OK) {
        result = lmb_placement_levels(&level->transport, &levels, level->pool, &probes, stats, &error);
    }
    CHECK(result == LMB_OK, "%s", error.message);
    if (result != LMB_OK) {
        lmb_probes_destroy(probes);
        return NULL;
    }
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    CHECK(stats->probes_valid + stats->probes_dilated + stats->probes_hanging == probes->count, "%d probes",
          probes->count);
    return probes;
}

static bool sphere_open(level_fixture *level, int threads)
{
    lmb_error error = {{0}};
    const char *path = output_path("sphere");
    return level_fixture_open(level, path, lmb_level_sphere_room(path, 4.0f, 6, 0.0f, 100.0f, &error), &error, threads);
}

static void even_light_needs_one_level(void)
{
    lmb_error error = {{0}};
    level_fixture level;
    const char *path = output_path("furnace");
    if (!level_fixture_open(&level, path, lmb_level_furnace(path, 8.0f, 0.5f, (lmb_rgb){{1, 1, 1}}, false, &error),
                            &error, 2)) {
        return;
    }
    lmb_placement_stats stats;
    lmb_probes *probes = levels_place(&level, 100000, NULL, &stats);
    if (probes) {
        /* Walls on points of the lattice: 5 points a side in the room. */
        CHECK(probes->level_count == 1 && probes->level[0].lattice.spacing == 2.0f, "%u levels", probes->level_count);
        CHECK(stats.probes_valid == 125 && stats.probes_hanging == 0, "%d", stats.probes_valid);
    }
    lmb_probes_destroy(probes);
    level_fixture_close(&level);
}

/* Normalised irradiance's norm over all normals, of one channel. */
static double norm_of(const double moments[LMB_SH3_COUNT])
{
    double sum = 0.0;
    for (int k = 0; k < LMB_SH3_COUNT; ++k) {
        const double band = k == 0 ? 1.0 : k < 4 ? 2.0 / 3.0 : 0.25;
        sum += band * band * moments[k] * moments[k];
    }
    return sqrt(sum / (4.0 * PI));
}

/* A lamp of 100 cd at the origin in a black room: its moments are 100 / d^2 Y(direction to it). */
static void lamp_moments(lmb_vec3d at, double moments[LMB_SH3_COUNT])
{
    const double squared = at.x * at.x + at.y * at.y + at.z * at.z, length = sqrt(squared);
    const lmb_sh3 basis =
        lmb_sh3_basis((lmb_vec3){(float)(-at.x / length), (float)(-at.y / length), (float)(-at.z / length)});
    for (int k = 0; k < LMB_SH3_COUNT; ++k) {
        moments[k] = 100.0 / squared * (double)basis.c[k];
    }
}

static double lamp_error(const lmb_probes *probes, lmb_vec3d at)
{
    double truth[LMB_SH3_COUNT], off[LMB_SH3_COUNT];
    lamp_moments(at, truth);
    const lmb_sh3_rgb light = lmb_probes_light(probes, 0, at);
    for (int k = 0; k < LMB_SH3_COUNT; ++k) {
        off[k] = (double)light.channel[1].c[k] - truth[k];
    }
    return norm_of(off) / norm_of(truth);
}

/* The spacing of the cell around a place. */
static double spacing_at(const lmb_probes *probes, lmb_vec3d at)
{
    int32_t around[8];
    double fraction[3];
    if (!lmb_probes_around(probes, at, around, fraction)) {
        return 0.0;
    }
    double finest = 1e9;
    for (int i = 0; i < 8; ++i) {
        finest = fmin(finest, (double)lmb_probes_footprint(probes, around[i]));
    }
    return finest;
}

/* The field of a lamp is known: where a level is not the finest, interpolation keeps to the tolerance, and across the
 * borders of levels there is no step. */
static void lamp_keeps_the_tolerance(void)
{
    level_fixture level;
    if (!sphere_open(&level, 2)) {
        return;
    }
    lmb_placement_stats stats;
    lmb_gather_stats baked;
    lmb_probes *probes = levels_place(&level, 100000, NULL, &stats);
    const bool good = probes && lmb_probes_bake(probes, &level.transport, &(lmb_gather_effort){.samples = 64},
                                                level.pool, NULL, &baked) == LMB_OK;
    CHECK(good, "bake");
    uint64_t state = 5;
    double squared = 0.0;
    int count = 0, finest = 0, coarse = 0;
    for (int i = 0; i < 20000 && good; ++i) {
        const lmb_vec3d at = {5.0 * fixture_random(&state) - 2.5, 5.0 * fixture_random(&state) - 2.5,
                              5.0 * fixture_random(&state) - 2.5};
        const double spacing = spacing_at(probes, at);
        const double distance = sqrt(at.x * at.x + at.y * at.y + at.z * at.z);
        CHECK(distance > 0.5 || spacing == 0.25, "%g m from the lamp: %g m", distance, spacing);
        finest += spacing == 0.25;
        coarse += spacing >= 1.0;
        if (spacing > 0.25 && distance < 3.0) { /* walls are 4 m away */
            /* As the choice counts it: by the space that a probe has. */
            const double error = fmin(lamp_error(probes, at), 1.0), share = spacing / 2.0;
            squared += error * error * share * share * share;
            ++count;
        }
    }
    CHECK(finest > 0 && coarse > 0 && count > 1000, "%d finest, %d of 1 m and more", finest, coarse);
    CHECK(sqrt(squared / count) <= TOLERANCE, "%g", sqrt(squared / count));
    lmb_probes_destroy(probes);
    level_fixture_close(&level);
}

/* Along lines through the room, from 10^-5 m before every face of cells to as much behind. */
static void there_is_no_step_along_lines(void)
{
    level_fixture level;
    if (!sphere_open(&level, 2)) {
        return;
    }
    lmb_placement_stats stats;
    lmb_gather_stats baked;
    lmb_probes *probes = levels_place(&level, 100000, NULL, &stats);
    const bool good = probes && lmb_probes_bake(probes, &level.transport, &(lmb_gather_effort){.samples = 64},
                                                level.pool, NULL, &baked) == LMB_OK;
    uint64_t state = 11;
    double largest = 0.0;
    int borders = 0;
    for (int i = 0; i < 20000 && good; ++i) {
        double at[3];
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = 5.0 * fixture_random(&state) - 2.5;
        }
        at[i % 3] = 0.25 * floor(4.0 * at[i % 3]) - 1e-5;
        const lmb_vec3d before = {at[0], at[1], at[2]};
        at[i % 3] += 2e-5;
        const lmb_vec3d after = {at[0], at[1], at[2]};
        borders += spacing_at(probes, before) != spacing_at(probes, after);
        double truth[LMB_SH3_COUNT], off[LMB_SH3_COUNT];
        lamp_moments(before, truth);
        const lmb_sh3_rgb a = lmb_probes_light(probes, 0, before), b = lmb_probes_light(probes, 0, after);
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            off[k] = (double)b.channel[1].c[k] - (double)a.channel[1].c[k];
        }
        largest = fmax(largest, norm_of(off) / norm_of(truth));
    }
    CHECK(borders > 100, "%d", borders);
    CHECK(largest < 1e-3, "%g", largest);
    lmb_probes_destroy(probes);
    level_fixture_close(&level);
}

static void probes_are_limited(void)
{
    level_fixture level;
    if (!sphere_open(&level, 2)) {
        return;
    }
    static const int32_t limits[] = {400, 1000, 2000, 4000};
    int32_t last = 0;
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; ++i) {
        lmb_placement_stats stats;
        lmb_probes *probes = levels_place(&level, limits[i], NULL, &stats);
        CHECK(probes && probes->count <= limits[i] && probes->count > last, "%d of %d", probes ? probes->count : -1,
              limits[i]);
        last = probes ? probes->count : last;
        lmb_probes_destroy(probes);
    }
    level_fixture_close(&level);
}

static void threads_do_not_matter(void)
{
    static const int threads[] = {1, 2, 5};
    lmb_probes *made[3] = {NULL};
    for (int i = 0; i < 3; ++i) {
        level_fixture level;
        lmb_placement_stats stats;
        if (sphere_open(&level, threads[i])) {
            made[i] = levels_place(&level, 100000, NULL, &stats);
            level_fixture_close(&level);
        }
        CHECK(made[i] && made[i]->count == made[0]->count && made[i]->level_count == made[0]->level_count, "%d threads",
              threads[i]);
        if (made[i] && made[i]->count == made[0]->count) {
            const size_t count = (size_t)made[0]->count;
            CHECK(memcmp(made[i]->point, made[0]->point, count * sizeof *made[0]->point) == 0, "%d", threads[i]);
            CHECK(memcmp(made[i]->validity, made[0]->validity, count * sizeof *made[0]->validity) == 0, "%d",
                  threads[i]);
        }
    }
    for (int i = 0; i < 3; ++i) {
        lmb_probes_destroy(made[i]);
    }
}

/* Of two sealed rooms only the seed's has probes of any level that are baked. */
static void seeds_hold_for_all_levels(void)
{
    lmb_error error = {{0}};
    level_fixture level;
    const lmb_two_rooms rooms = lmb_two_rooms_default();
    const char *path = output_path("rooms");
    if (!level_fixture_open(&level, path, lmb_level_two_rooms(path, &rooms, &error), &error, 2)) {
        return;
    }
    const lmb_vec3d seed = {-1.0, 1.0, 1.0};
    lmb_placement_stats stats;
    lmb_probes *probes = levels_place(&level, 100000, &seed, &stats);
    int there = 0, fine = 0;
    for (int32_t i = 0; probes && i < probes->count; ++i) {
        const lmb_vec3 p = lmb_probes_position(probes, i);
        const bool valid = probes->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        const bool inside = p.x > -4.06f && p.x < 0.06f && p.y > -0.06f && p.y < 3.06f && fabsf(p.z) < 2.06f;
        CHECK(!valid || inside, "%g %g %g", (double)p.x, (double)p.y, (double)p.z);
        there += valid;
        fine += valid && lmb_probes_footprint(probes, i) < 0.5f;
    }
    CHECK(there > 100 && fine > 50, "%d, fine %d", there, fine);
    lmb_probes_destroy(probes);
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"even light needs one level", even_light_needs_one_level},
    {"a lamp keeps the tolerance", lamp_keeps_the_tolerance},
    {"there is no step along lines", there_is_no_step_along_lines},
    {"probes are limited", probes_are_limited},
    {"threads do not matter", threads_do_not_matter},
    {"seeds hold for all levels", seeds_hold_for_all_levels},
};

TEST_MAIN(cases)
