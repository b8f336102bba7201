/* The run-time file: what is packed comes out of the sampler, and no bytes whatsoever make it misbehave.
 *
 * The oracle interpolates the lmb_probes itself, in double; it shares nothing with the file. */
#define _POSIX_C_SOURCE 200809L

#include "probes_fixture.h"
#include "harness.h"

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/volume.h>
#include <lambent/volume_format.h>

#include <float.h>
#include <stddef.h>
#include <unistd.h>

/* Probes packed and opened. */
typedef struct packed {
    unsigned char *data;
    size_t size;
    lmb_pack_stats stats;
    lmb_volume *volume;
} packed;

static packed pack_and_open(const lmb_probes *probes)
{
    packed p = {NULL, 0, {0}, NULL};
    const lmb_result result = lmb_pack(probes, &p.data, &p.size, &p.stats);
    CHECK(result == LMB_OK, "pack: %d", result);
    const lmb_result opened = result == LMB_OK ? lmb_volume_open_memory(p.data, p.size, &p.volume) : result;
    CHECK(opened == LMB_OK, "open: %d", opened);
    if (!p.volume) {
        abort();
    }
    return p;
}

static void close_packed(packed *p)
{
    lmb_volume_close(p->volume);
    free(p->data);
}

/* --------------------------------------------------------------------------------------------- the oracle */

/* `lit[probe]`: does light reach the probe, by flooding over 26 neighbours until nothing changes? */
static bool *flood_light(const lmb_probes *probes)
{
    bool *const lit = calloc((size_t)probes->count + 1, 1);
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            bool reached = probes->validity[probe] >= 0.5f;
            for (int32_t n = 0; n < 27 && !reached; ++n) {
                const int32_t *const at = probes->point[probe];
                const int32_t other =
                    lmb_probes_find(probes, 0, at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1);
                reached = other >= 0 && lit[other];
            }
            changed |= reached && !lit[probe];
            lit[probe] |= reached;
        }
    }
    return lit;
}

/* Light at a point of the box, relative to its first: a probe's that is lit, else the mean of the lit ones around it,
 * by one over the square of the distance. @return false: there are none */
static bool oracle_point(const lmb_probes *probes, const bool *lit, const int32_t at[3], double light[27])
{
    const int32_t *const min = probes->level[0].lattice.min;
    double weights = 0.0;
    memset(light, 0, 27 * sizeof *light);
    for (int32_t n = 0; n < 28; ++n) {
        const int32_t k = n == 0 ? 13 : n - 1; /* itself first */
        const int32_t x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
        const int32_t probe = lmb_probes_find(probes, 0, min[0] + at[0] + x, min[1] + at[1] + y, min[2] + at[2] + z);
        if (probe < 0 || !lit[probe] || (n > 0 && k == 13)) {
            continue;
        }
        const double weight = n == 0 ? 1.0 : 1.0 / (x * x + y * y + z * z);
        weights += weight;
        for (int i = 0; i < 27; ++i) {
            light[i] += weight * (double)probes->radiance[0][probe].channel[i / 9].c[i % 9];
        }
        if (n == 0) {
            break;
        }
    }
    for (int i = 0; i < 27 && weights > 0.0; ++i) {
        light[i] /= weights;
    }
    return weights > 0.0;
}

/* What a cell is: there when its eight corners are lit, or one of them was baked. */
typedef enum oracle_kind { ORACLE_NONE, ORACLE_COMPLETED, ORACLE_WHOLE } oracle_kind;

/* Its trilinear light. */
static oracle_kind oracle_cell(const lmb_probes *probes, const bool *lit, const int32_t cell[3], const double t[3],
                               double light[27])
{
    const int32_t *const min = probes->level[0].lattice.min;
    bool whole = true, touched = false;
    memset(light, 0, 27 * sizeof *light);
    for (int corner = 0; corner < 8; ++corner) {
        const int32_t at[3] = {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)};
        const int32_t probe = lmb_probes_find(probes, 0, min[0] + at[0], min[1] + at[1], min[2] + at[2]);
        whole = whole && probe >= 0 && lit[probe];
        touched = touched || (probe >= 0 && probes->validity[probe] >= 0.5f);
        double of_corner[27], weight = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            weight *= corner >> axis & 1 ? t[axis] : 1.0 - t[axis];
        }
        oracle_point(probes, lit, at, of_corner);
        for (int i = 0; i < 27; ++i) {
            light[i] += weight * of_corner[i];
        }
    }
    return whole ? ORACLE_WHOLE : touched ? ORACLE_COMPLETED : ORACLE_NONE;
}

/* At lattice coordinates relative to the box, clamped to it. On a face between two cells `side` chooses, by a bit for
 * each axis. */
static oracle_kind oracle_sample(const lmb_probes *probes, const bool *lit, const double at[3], int side,
                                 double light[27])
{
    int32_t cell[3];
    double t[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double last = probes->level[0].lattice.size[axis] - 1;
        const double inside = at[axis] < 0.0 ? 0.0 : at[axis] > last ? last : at[axis];
        const double nudged = floor(side >> axis & 1 ? inside + 1e-6 : inside - 1e-6);
        const double last_cell = last > 0.0 ? last - 1.0 : 0.0;
        const double below = nudged < 0.0 ? 0.0 : nudged > last_cell ? last_cell : nudged;
        cell[axis] = (int32_t)below;
        t[axis] = inside - below;
    }
    const oracle_kind there = oracle_cell(probes, lit, cell, t, light);
    for (int i = 0; i < 27 && there == ORACLE_NONE; ++i) {
        light[i] = 0.0;
    }
    return there;
}

/* Rounded for certain: gcc 12.2 at -O2 drops the rounding to float when it vectorises what follows. */
static float round_to_float(double value)
{
    const volatile float rounded = (float)value;
    return rounded;
}

/* How far off, in cells, a float position may be before it counts as outside (docs/formats.md, sampling). */
static double position_slack(const lmb_probes *probes)
{
    double farthest = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        farthest =
            fmax(farthest, fmax(fabs((double)probes->level[0].lattice.min[axis]),
                                fabs(probes->level[0].lattice.min[axis] + probes->level[0].lattice.size[axis] - 1.0)));
    }
    return fmin(farthest * 0x1p-22, 0x1p-6);
}

static void check_point(const lmb_probes *probes, const bool *lit, const packed *p, const double at[3],
                        double tolerance)
{
    const double slack = position_slack(probes);
    float position[3];
    double rounded[3]; /* where that float position really is */
    double outside = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        position[axis] =
            round_to_float((probes->level[0].lattice.min[axis] + at[axis]) * (double)probes->level[0].lattice.spacing);
        rounded[axis] =
            (double)position[axis] / (double)probes->level[0].lattice.spacing - probes->level[0].lattice.min[axis];
        outside = fmax(outside, fmax(-rounded[axis], rounded[axis] - (probes->level[0].lattice.size[axis] - 1)));
    }
    lmb_sh3_rgb light;
    memset(&light, 0xff, sizeof light);
    const bool inside = lmb_volume_sample(p->volume, (lmb_vec3){position[0], position[1], position[2]}, &light);
    bool agrees = false;
    for (int side = 0; side < 8 && !agrees; ++side) {
        double expected[27];
        const oracle_kind there = oracle_sample(probes, lit, rounded, side, expected);
        agrees = !inside || (there && outside <= 1.01 * slack);
        agrees = agrees && (inside || !there || outside > 0.0);
        /* What is made of probes as they are stored is rounded twice. */
        const double tolerated = there == ORACLE_COMPLETED ? 2.0 * tolerance : tolerance;
        for (int i = 0; i < 27 && agrees; ++i) {
            agrees = fabs((double)light.channel[i / 9].c[i % 9] - expected[i]) <= tolerated;
        }
    }
    CHECK(agrees, "(%g, %g, %g): %s, first coefficient %g", at[0], at[1], at[2], inside ? "inside" : "outside",
          (double)light.channel[0].c[0]);
    if (at[0] == round(at[0]) && at[1] == round(at[1]) && at[2] == round(at[2]) && outside <= slack) {
        const int32_t probe = lmb_probes_find(probes, 0, probes->level[0].lattice.min[0] + (int32_t)at[0],
                                              probes->level[0].lattice.min[1] + (int32_t)at[1],
                                              probes->level[0].lattice.min[2] + (int32_t)at[2]);
        CHECK(inside || probe < 0 || probes->validity[probe] < 0.5f,
              "baked point (%g, %g, %g), however its position rounds", at[0], at[1], at[2]);
    }
}

/* ---------------------------------------------------------------------------------------------- sampling */

static void check_volume(const lmb_lattice *lattice, double density, double magnitude, uint64_t seed)
{
    lmb_probes *const probes = fixture_random_probes(lattice, density, 0.6, magnitude, seed);
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    bool *const lit = flood_light(probes);
    packed p = pack_and_open(probes);
    /* Halfs hold 11 bits; interpolation adds float rounding and the rounding of t. */
    const double tolerance = magnitude * (0x1p-11 + 1e-5) + 0x1p-25 * (double)p.stats.scale;

    const lmb_volume_info info = lmb_volume_get_info(p.volume);
    uint64_t baked_count = 0, lit_count = 0;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        baked_count += probes->validity[probe] >= 0.5f;
        lit_count += lit[probe];
    }
    CHECK(info.probe_count >= baked_count && info.probe_count <= lit_count, "%llu probes stored, %llu baked, %llu lit",
          (unsigned long long)info.probe_count, (unsigned long long)baked_count, (unsigned long long)lit_count);
    CHECK(lmb_volume_spacing_at(p.volume, info.bounds_min) == lattice->spacing && info.file_bytes == p.size &&
              p.stats.bytes == p.size,
          "info");
    CHECK(info.bounds_min.x == lattice->min[0] * (double)lattice->spacing &&
              info.bounds_min.z == lattice->min[2] * (double)lattice->spacing &&
              info.bounds_max.y == (lattice->min[1] + (lattice->size[1] - 1)) * (double)lattice->spacing,
          "box");

    for (int32_t z = 0; z < lattice->size[2]; ++z) {
        for (int32_t y = 0; y < lattice->size[1]; ++y) {
            for (int32_t x = 0; x < lattice->size[0]; ++x) {
                check_point(probes, lit, &p, (double[3]){x, y, z}, tolerance);
            }
        }
    }
    uint64_t state = seed + 99;
    for (int i = 0; i < 3000; ++i) {
        double at[3];
        for (int axis = 0; axis < 3; ++axis) {
            /* Up to half a cell outside the box; a quarter of the coordinates in the planes between points. */
            at[axis] = fixture_random(&state) * lattice->size[axis] - 0.5;
            at[axis] = fixture_random(&state) < 0.25 ? round(at[axis]) : at[axis];
        }
        check_point(probes, lit, &p, at, tolerance);
    }
    close_packed(&p);
    free(lit);
    lmb_probes_destroy(probes);
}

static void test_sample(void)
{
    static const struct {
        lmb_lattice lattice;
        double density;
        double magnitude;
    } cases[] = {
        {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}}, 1.0, 1.0},
        {{.spacing = 0.5f, .min = {-4, 7, 2}, .size = {9, 9, 9}}, 1.0, 3.0},
        {{.spacing = 0.3f, .min = {-5, -6, -7}, .size = {13, 6, 10}}, 1.0, 100.0},
        {{.spacing = 1.7f, .min = {3, 3, 3}, .size = {12, 11, 7}}, 0.9, 5.0},
        {{.spacing = 1.7f, .min = {3, 3, 3}, .size = {12, 11, 7}}, 0.3, 5.0},
        {{.spacing = 0.25f, .min = {0, 0, 0}, .size = {30, 3, 17}}, 0.02, 5.0},
        {{.spacing = 1.0f, .min = {-2, -2, -2}, .size = {6, 6, 1}}, 1.0, 5.0},
        {{.spacing = 2.0f, .min = {0, 0, 0}, .size = {1, 1, 1}}, 1.0, 5.0},
        {{.spacing = 2.0f, .min = {0, 0, 0}, .size = {1, 9, 1}}, 1.0, 5.0},
        {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {6, 6, 6}}, 1.0, 1e7},
        {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {6, 6, 6}}, 1.0, 1e-9},
        {{.spacing = 0.5f, .min = {20000, -30000, 7}, .size = {6, 7, 8}}, 0.8, 2.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const int before = test_failures;
        check_volume(&cases[i].lattice, cases[i].density, cases[i].magnitude, i + 1);
        CHECK(test_failures == before, "case %zu", i);
    }
}

static bool is_finite_light(const lmb_sh3_rgb *light)
{
    for (int i = 0; i < 27; ++i) {
        if (!isfinite(light->channel[i / 9].c[i % 9])) {
            return false;
        }
    }
    return true;
}

static bool is_dark(const lmb_sh3_rgb *light)
{
    static const lmb_sh3_rgb dark;
    return memcmp(light, &dark, sizeof dark) == 0;
}

static void test_far_and_broken_positions(void)
{
    const lmb_lattice lattice = {.spacing = 0.5f, .min = {-4, 0, 4}, .size = {6, 6, 6}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 5.0, 3);
    packed p = pack_and_open(probes);
    static const float odd[] = {0.0f, -0.0f, 1.0f, 1e30f, -FLT_MAX, FLT_MAX, FLT_MIN, 1e-45f, INFINITY, -INFINITY, NAN};
    enum { COUNT = sizeof odd / sizeof odd[0] };
    for (int i = 0; i < COUNT * COUNT * COUNT; ++i) {
        const lmb_vec3 position = {odd[i % COUNT], odd[i / COUNT % COUNT], odd[i / COUNT / COUNT]};
        lmb_sh3_rgb light;
        const bool inside = lmb_volume_sample(p.volume, position, &light);
        const bool is_nan = isnan(position.x) || isnan(position.y) || isnan(position.z);
        CHECK(is_finite_light(&light), "(%g, %g, %g)", (double)position.x, (double)position.y, (double)position.z);
        CHECK(is_dark(&light) == is_nan, "(%g, %g, %g): dark is not for NaN", (double)position.x, (double)position.y,
              (double)position.z);
        CHECK(!inside ||
                  (fabsf(position.x) <= 2.0f && fabsf(position.y) <= 2.5f && position.z >= 2.0f && position.z <= 4.5f),
              "(%g, %g, %g) is not inside", (double)position.x, (double)position.y, (double)position.z);
    }
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* 10 000 km away a position in double finds what one at the origin finds; there a float is exact to 1 m. */
static void test_positions_in_double(void)
{
    const lmb_lattice near = {.spacing = 0.1f, .min = {-3, 2, 0}, .size = {6, 5, 4}};
    const lmb_lattice away = {.spacing = 0.1f, .min = {100000000, -99999999, 2}, .size = {6, 5, 4}};
    lmb_probes *const near_probes = fixture_random_probes(&near, 1.0, 1.0, 5.0, 4);
    lmb_probes *const far_probes = fixture_random_probes(&away, 1.0, 1.0, 5.0, 4);
    packed a = pack_and_open(near_probes), b = pack_and_open(far_probes);
    uint64_t state = 5;
    for (int i = 0; i < 500; ++i) {
        double at[3], there[3];
        bool at_the_edge = false; /* out there both kinds of position are inside up to a 64th of a cell beyond it */
        for (int axis = 0; axis < 3; ++axis) {
            const double cells = fixture_random(&state) * near.size[axis] - 0.5;
            at_the_edge |= fabs(cells) < 0x1p-5 || fabs(cells - (near.size[axis] - 1)) < 0x1p-5;
            at[axis] = (near.min[axis] + cells) * (double)near.spacing;
            there[axis] = (away.min[axis] + cells) * (double)near.spacing;
        }
        lmb_sh3_rgb light, light_there, light_float;
        /* Volatile: gcc 12 takes a pair of doubles to float and back without rounding them (-O2, vectors). */
        const volatile lmb_vec3 rounded = {(float)at[0], (float)at[1], (float)at[2]};
        const bool inside = lmb_volume_sample_at(a.volume, (lmb_vec3d){at[0], at[1], at[2]}, &light);
        const bool inside_there =
            lmb_volume_sample_at(b.volume, (lmb_vec3d){there[0], there[1], there[2]}, &light_there);
        CHECK(at_the_edge || inside == inside_there, "(%g, %g, %g)", at[0], at[1], at[2]);
        for (int k = 0; k < 27; ++k) {
            CHECK_NEAR(light_there.channel[k / 9].c[k % 9], light.channel[k / 9].c[k % 9], 1e-5, "(%g, %g, %g)", at[0],
                       at[1], at[2]);
        }
        lmb_volume_sample(a.volume, rounded, &light_float);
        lmb_volume_sample_at(a.volume, (lmb_vec3d){(double)rounded.x, (double)rounded.y, (double)rounded.z}, &light);
        CHECK(memcmp(&light, &light_float, sizeof light) == 0, "a float's value in double");
    }
    static const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, -1e300};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; ++i) {
        lmb_sh3_rgb light;
        CHECK(!lmb_volume_sample_at(a.volume, (lmb_vec3d){0.0, odd[i], 0.2}, &light), "%g is not inside", odd[i]);
        CHECK(is_finite_light(&light) && (!isnan(odd[i]) || is_dark(&light)), "%g", odd[i]);
    }
    close_packed(&a);
    close_packed(&b);
    lmb_probes_destroy(near_probes);
    lmb_probes_destroy(far_probes);
}

/* Packing looks at probes, not at the bricks of the box: eight million here, of which the ends hold light. */
static void test_few_in_a_large_box(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {-400, -400, -400}, .size = {801, 801, 801}};
    /* The second lies where eight bricks meet, the last in the last brick's last corner. */
    static const int32_t points[3][3] = {{-400, -400, -400}, {0, 0, 0}, {400, 400, 400}};
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK && lmb_probes_add_level(probes, &lattice, points, 3) == LMB_OK, "made");
    for (int i = 0; i < 3; ++i) {
        probes->validity[i] = 1.0f;
        probes->radiance[0][i].channel[0].c[0] = (float)(i + 1);
    }
    packed p = pack_and_open(probes);
    const lmb_volume_info info = lmb_volume_get_info(p.volume);
    CHECK(info.probe_count == 3 && info.brick_count == 10, "%llu probes, %u bricks",
          (unsigned long long)info.probe_count, info.brick_count);
    for (int i = 0; i < 3; ++i) {
        lmb_sh3_rgb light;
        const lmb_vec3 at = {(float)points[i][0], (float)points[i][1], (float)points[i][2]};
        CHECK(lmb_volume_sample(p.volume, at, &light) && light.channel[0].c[0] == (float)(i + 1), "%d: %g", i,
              (double)light.channel[0].c[0]);
    }
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* What is beyond even the largest scale keeps its direction: the whole probe is scaled. */
static void test_overflow(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 3);
    for (int i = 0; i < 27; ++i) {
        probes->radiance[0][0].channel[i / 9].c[i % 9] = (float)(i - 13) * 2e37f;
    }
    packed p = pack_and_open(probes);
    CHECK(p.stats.overflow_count == 26, "%llu overflows", (unsigned long long)p.stats.overflow_count);
    CHECK(p.stats.scale == 0x1p96f, "scale %g", (double)p.stats.scale);
    lmb_sh3_rgb light;
    CHECK(lmb_volume_sample(p.volume, (lmb_vec3){0, 0, 0}, &light), "inside");
    const double largest = (double)light.channel[2].c[8];
    CHECK(largest > 0.0 && is_finite_light(&light), "largest %g", largest);
    for (int i = 0; i < 27; ++i) {
        CHECK_NEAR((double)light.channel[i / 9].c[i % 9] / largest, (i - 13) / 13.0, 1e-3, "coefficient %d", i);
    }
    close_packed(&p);

    /* Sunlight beside candles: a scale, no overflow. */
    for (int32_t probe = 0; probe < 8; ++probe) {
        probes->radiance[0][probe] = (lmb_sh3_rgb){{{{probe % 2 ? 3e6f : 1.0f}}}};
    }
    p = pack_and_open(probes);
    CHECK(p.stats.overflow_count == 0 && p.stats.scale == 128.0f, "scale %g", (double)p.stats.scale);
    CHECK(lmb_volume_get_info(p.volume).scale == p.stats.scale, "scale in the file");
    CHECK(lmb_volume_sample(p.volume, (lmb_vec3){0, 0, 0}, &light), "inside");
    CHECK_NEAR(light.channel[0].c[0], 1.0, 1e-3, "the candle");
    CHECK(lmb_volume_sample(p.volume, (lmb_vec3){1, 1, 1}, &light), "inside");
    CHECK_NEAR(light.channel[0].c[0], 3e6, 3e3, "the sun");
    close_packed(&p);
    lmb_probes_destroy(probes);
}

static void test_pack_refuses(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {3, 3, 3}};
    unsigned char *data = NULL;
    size_t bytes = 0;
    lmb_probes *probes = fixture_random_probes(&lattice, 0.0, 1.0, 1.0, 1);
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "no probes");
    lmb_probes_destroy(probes);
    probes = fixture_random_probes(&lattice, 1.0, 0.0, 1.0, 1);
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "no probe with light");
    lmb_probes_destroy(probes);
    probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 1);
    probes->radiance[0][26].channel[2].c[8] = NAN;
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "NaN");
    probes->radiance[0][26].channel[2].c[8] = INFINITY;
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "infinity");
    lmb_probes_destroy(probes);
    probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 1);
    CHECK(lmb_lattice_turn(&probes->level[0].lattice, (lmb_vec3d){-1.0, 0.0, 0.0}, (lmb_vec3d){0.0, 1.0, 0.0}) &&
              lmb_probes_validate(probes, NULL) == LMB_OK,
          "turned");
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "a turned lattice");
    lmb_probes_destroy(probes);
    probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 1);
    uint32_t set;
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK, "a set");
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "two sets");
    lmb_probes_destroy(probes);
    probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 1);
    const lmb_lattice coarse = {.spacing = 3.0f, .size = {1, 1, 1}};
    CHECK(lmb_probes_add_level(probes, &coarse, (const int32_t[1][3]){{0, 0, 0}}, 1) == LMB_OK, "a level");
    CHECK(lmb_pack(probes, &data, &bytes, NULL) == LMB_ERROR_ARGUMENT, "a level of three times the spacing");
    lmb_probes_destroy(probes);
    CHECK(!data && bytes == 0, "outputs untouched");
}

/* --------------------------------------------------------------------------------------- broken contents */

/* A copy whose end is the end of its allocation, so that AddressSanitizer sees every read beyond. */
static lmb_result open_copy(const unsigned char *data, size_t size, unsigned char **copy, lmb_volume **volume)
{
    *copy = malloc(size ? size : 1);
    if (!*copy) {
        abort();
    }
    memcpy(*copy, data, size);
    *volume = NULL;
    return lmb_volume_open_memory(*copy, size, volume);
}

static packed pack_small(void)
{
    const lmb_lattice lattice = {.spacing = 0.5f, .min = {-3, 0, 3}, .size = {6, 3, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 0.9, 0.7, 5.0, 17);
    packed p = pack_and_open(probes);
    lmb_probes_destroy(probes);
    return p;
}

static void test_truncation(void)
{
    packed p = pack_small();
    for (size_t size = 0; size < p.size; ++size) {
        unsigned char *copy;
        lmb_volume *volume;
        const lmb_result result = open_copy(p.data, size, &copy, &volume);
        CHECK(result == LMB_ERROR_TRUNCATED && !volume, "%zu of %zu bytes: %d", size, p.size, result);
        free(copy);
    }
    unsigned char *const longer = calloc(1, p.size + 16);
    memcpy(longer, p.data, p.size);
    lmb_volume *volume = NULL;
    CHECK(lmb_volume_open_memory(longer, p.size + 16, &volume) == LMB_ERROR_FORMAT && !volume, "bytes at the end");
    free(longer);
    close_packed(&p);
}

/* Every byte, changed in one way; those of the header in nine. */
static void test_corruption(void)
{
    packed p = pack_small();
    static const unsigned char changes[] = {0xff, 0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80};
    for (size_t i = 0; i < p.size; ++i) {
        const size_t count = i < LMB_VOLUME_HEADER_BYTES ? sizeof changes : 1;
        for (size_t c = 0; c < count; ++c) {
            p.data[i] ^= changes[c];
            lmb_volume *volume = NULL;
            const lmb_result result = lmb_volume_open_memory(p.data, p.size, &volume);
            /* Without wedges, the same bytes are of version 4 too. */
            const bool is_version_4 = i == offsetof(lmb_volume_header, version) && p.data[i] == 4;
            CHECK((result == LMB_OK) == is_version_4 && (volume != NULL) == is_version_4, "byte %zu xor %u: %d", i,
                  changes[c], result);
            lmb_volume_close(volume);
            p.data[i] ^= changes[c];
        }
    }
    close_packed(&p);
}

static void repair_checksum(unsigned char *data, size_t size)
{
    const uint64_t checksum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    memcpy(data + offsetof(lmb_volume_header, checksum), &checksum, sizeof checksum);
}

/* Samples all over and around the box that the file claims. @return everything was finite */
static bool samples_are_finite(const lmb_volume *volume)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    bool finite = true;
    uint64_t state = 5;
    for (int i = 0; i < 40; ++i) {
        const double t[3] = {1.2 * fixture_random(&state) - 0.1, 1.2 * fixture_random(&state) - 0.1,
                             1.2 * fixture_random(&state) - 0.1};
        const lmb_vec3d low = info.bounds_min, high = info.bounds_max;
        const lmb_vec3 position = {(float)(low.x + t[0] * (high.x - low.x)), (float)(low.y + t[1] * (high.y - low.y)),
                                   (float)(low.z + t[2] * (high.z - low.z))};
        lmb_sh3_rgb light;
        lmb_volume_sample(volume, position, &light);
        finite = finite && is_finite_light(&light);
    }
    return finite;
}

/* A forged file, its checksum right: refused, or sampled without a bad read and without NaN. */
static void test_forgery(void)
{
    packed p = pack_small();
    unsigned char *const exact = malloc(p.size);
    memcpy(exact, p.data, p.size);
    static const unsigned char changes[] = {0x01, 0x80, 0xff, 0x7c, 0x10};
    int accepted = 0, refused = 0;
    for (size_t i = 0; i < p.size; i += i < LMB_VOLUME_HEADER_BYTES + 64 ? 1 : 37) {
        for (size_t c = 0; c < sizeof changes; ++c) {
            const unsigned char kept = exact[i];
            exact[i] = (unsigned char)(kept ^ changes[c]);
            repair_checksum(exact, p.size);
            lmb_volume *volume = NULL;
            const lmb_result result = lmb_volume_open_memory(exact, p.size, &volume);
            CHECK((result == LMB_OK) == (volume != NULL), "byte %zu xor %u", i, changes[c]);
            if (volume) {
                CHECK(samples_are_finite(volume), "byte %zu xor %u gives NaN or infinity", i, changes[c]);
                ++accepted;
            } else {
                ++refused;
            }
            lmb_volume_close(volume);
            exact[i] = kept;
        }
    }
    CHECK(accepted > 0 && refused > 0, "%d accepted, %d refused: forgeries never reach the checks", accepted, refused);
    free(exact);
    close_packed(&p);
}

/* Fields of the header set to chosen values, the checksum right. */
static void test_forged_fields(void)
{
    /* One row of bricks, and the four rows of six points that they share. */
    enum { DIRECTORY = LMB_VOLUME_HEADER_BYTES, BRICKS = DIRECTORY + 64 + 128, PROBES = BRICKS + 2 * 128 };
    static const struct {
        const char *name;
        size_t offset;
        uint32_t value;
        lmb_result expected;
    } cases[] = {
        {"version 0", offsetof(lmb_volume_header, version), 0, LMB_ERROR_VERSION},
        {"version 1", offsetof(lmb_volume_header, version), 1, LMB_ERROR_VERSION},
        {"version 2", offsetof(lmb_volume_header, version), 2, LMB_ERROR_VERSION},
        {"version 4", offsetof(lmb_volume_header, version), 4, LMB_OK},
        {"version 6", offsetof(lmb_volume_header, version), 6, LMB_ERROR_VERSION},
        {"the last version", offsetof(lmb_volume_header, version), UINT32_MAX, LMB_ERROR_VERSION},
        {"header size", offsetof(lmb_volume_header, header_bytes), 64, LMB_ERROR_FORMAT},
        {"spacing 0", offsetof(lmb_volume_header, spacing), 0, LMB_ERROR_FORMAT},
        {"spacing -1", offsetof(lmb_volume_header, spacing), 0xbf800000, LMB_ERROR_FORMAT},
        {"spacing NaN", offsetof(lmb_volume_header, spacing), 0x7fc00000, LMB_ERROR_FORMAT},
        {"spacing infinite", offsetof(lmb_volume_header, spacing), 0x7f800000, LMB_ERROR_FORMAT},
        {"spacing FLT_MAX", offsetof(lmb_volume_header, spacing), 0x7f7fffff, LMB_ERROR_FORMAT},
        {"spacing denormal", offsetof(lmb_volume_header, spacing), 1, LMB_OK},
        {"scale 0", offsetof(lmb_volume_header, scale), 0, LMB_ERROR_FORMAT},
        {"scale -1", offsetof(lmb_volume_header, scale), 0xbf800000, LMB_ERROR_FORMAT},
        {"scale NaN", offsetof(lmb_volume_header, scale), 0x7fc00000, LMB_ERROR_FORMAT},
        {"scale infinite", offsetof(lmb_volume_header, scale), 0x7f800000, LMB_ERROR_FORMAT},
        {"scale 1.5", offsetof(lmb_volume_header, scale), 0x3fc00000, LMB_ERROR_FORMAT},
        {"scale 2^97", offsetof(lmb_volume_header, scale), 0x70000000, LMB_ERROR_FORMAT},
        {"scale 2^96", offsetof(lmb_volume_header, scale), 0x6f800000, LMB_OK},
        {"scale 2^-97", offsetof(lmb_volume_header, scale), 0x0f000000, LMB_ERROR_FORMAT},
        {"scale 2^-96", offsetof(lmb_volume_header, scale), 0x0f800000, LMB_OK},
        {"min", offsetof(lmb_volume_header, min), INT32_MAX, LMB_ERROR_FORMAT},
        {"size 0", offsetof(lmb_volume_header, size), 0, LMB_ERROR_FORMAT},
        {"size -1", offsetof(lmb_volume_header, size), UINT32_MAX, LMB_ERROR_FORMAT},
        {"size huge", offsetof(lmb_volume_header, size), INT32_MAX - 100, LMB_ERROR_FORMAT},
        {"size of fewer blocks", offsetof(lmb_volume_header, size), 3, LMB_OK},
        {"size of more blocks", offsetof(lmb_volume_header, size), 300, LMB_ERROR_FORMAT},
        {"no probes", offsetof(lmb_volume_header, probe_count), 0, LMB_ERROR_FORMAT},
        {"nothing stored", offsetof(lmb_volume_header, stored_count), 0, LMB_ERROR_FORMAT},
        {"fewer stored", offsetof(lmb_volume_header, stored_count), 23, LMB_ERROR_FORMAT},
        {"stored huge", offsetof(lmb_volume_header, stored_count), UINT32_MAX, LMB_ERROR_FORMAT},
        {"bricks 0", offsetof(lmb_volume_header, brick_count), 0, LMB_ERROR_FORMAT},
        {"bricks 1", offsetof(lmb_volume_header, brick_count), 1, LMB_ERROR_FORMAT},
        {"bricks 4", offsetof(lmb_volume_header, brick_count), 4, LMB_ERROR_FORMAT},
        {"bricks huge", offsetof(lmb_volume_header, brick_count), UINT32_MAX, LMB_ERROR_FORMAT},
        {"no levels", offsetof(lmb_volume_header, level_count), 0, LMB_ERROR_FORMAT},
        {"levels huge", offsetof(lmb_volume_header, level_count), 16, LMB_ERROR_FORMAT},
        {"key lights", offsetof(lmb_volume_header, key_light_count), 1, LMB_ERROR_FORMAT},
        {"key lights huge", offsetof(lmb_volume_header, key_light_count), UINT32_MAX, LMB_ERROR_FORMAT},
        {"probe size", offsetof(lmb_volume_header, probe_bytes), 52, LMB_ERROR_FORMAT},
        {"cut cells", offsetof(lmb_volume_header, cut_count), 1, LMB_ERROR_FORMAT},
        {"cut cells' bytes", offsetof(lmb_volume_header, cut_bytes), 4, LMB_ERROR_FORMAT},
        {"cut cells' bytes, 4 GiB", offsetof(lmb_volume_header, cut_bytes) + 4, 1, LMB_ERROR_FORMAT},
        {"reserved", offsetof(lmb_volume_header, reserved) + 28, 1, LMB_ERROR_FORMAT},
        {"entry none", DIRECTORY, 0, LMB_OK},
        {"entry huge", DIRECTORY, UINT32_MAX, LMB_ERROR_FORMAT},
        {"entry 3", DIRECTORY + 4, 3, LMB_ERROR_FORMAT},
        {"entry twice", DIRECTORY + 4, 1, LMB_OK},
        {"entry of level 1", DIRECTORY, UINT32_C(1) << 28, LMB_ERROR_FORMAT},
        {"no cells", BRICKS, 0, LMB_ERROR_FORMAT},
        {"other cells", BRICKS + 4, 1, LMB_OK},
        {"a cell that is cut too", BRICKS + 8, 1, LMB_ERROR_FORMAT},
        {"a cut cell", BRICKS + 12, 0x80000000, LMB_ERROR_FORMAT},
        {"a row behind the end", BRICKS + 16, 20 * 27, LMB_ERROR_FORMAT},
        {"a row before the start", BRICKS + 16, UINT32_MAX - 26, LMB_ERROR_FORMAT},
        {"a row's other start", BRICKS + 16, 27, LMB_OK},
        {"a row between probes", BRICKS + 16, 26, LMB_ERROR_FORMAT},
        {"a brick that is none, with cells", BRICKS - 128, 1, LMB_ERROR_FORMAT},
        {"cut cells from 1", BRICKS + 116, 1, LMB_ERROR_FORMAT},
        {"reserved of a brick", BRICKS + 120, 1, LMB_ERROR_FORMAT},
        {"infinite half", PROBES, 0x7c00, LMB_ERROR_FORMAT},
        {"NaN half", PROBES, 0xfe000000, LMB_ERROR_FORMAT},
    };
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {6, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 5.0, 17);
    packed p = pack_and_open(probes);
    lmb_probes_destroy(probes);
    CHECK(lmb_volume_get_info(p.volume).brick_count == 2, "two bricks");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        unsigned char *copy = malloc(p.size);
        memcpy(copy, p.data, p.size);
        memcpy(copy + cases[i].offset, &cases[i].value, sizeof cases[i].value);
        repair_checksum(copy, p.size);
        lmb_volume *volume = NULL;
        const lmb_result result = lmb_volume_open_memory(copy, p.size, &volume);
        CHECK(result == cases[i].expected, "%s: %d", cases[i].name, result);
        if (volume) {
            CHECK(samples_are_finite(volume), "%s gives NaN or infinity", cases[i].name);
        }
        lmb_volume_close(volume);
        free(copy);
    }
    close_packed(&p);
}

static void test_wrong_kind(void)
{
    static const _Alignas(16) char texts[][256] = {
        "glTF", "PK\x03\x04", " BDV", "\x89PNG\r\n\x1a\n", "\x89LMB\n\n\x1a\n", "{}"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        lmb_volume *volume = NULL;
        CHECK(lmb_volume_open_memory(texts[i], sizeof texts[i], &volume) == LMB_ERROR_FORMAT && !volume, "'%s'",
              texts[i]);
    }
}

/* -------------------------------------------------------------------------------------------------- files */

static void test_files(void)
{
    const char *const path = LMB_TEST_OUTPUT_DIR "/volume with \xc3\xa9.lmb";
    packed p = pack_small();
    CHECK(lmb_file_write(path, p.data, p.size, NULL) == LMB_OK, "write");
    lmb_volume *mapped = NULL;
    CHECK(lmb_volume_open_file(path, &mapped) == LMB_OK, "open");
    unlink(path); /* the mapping lives on */
    if (mapped) {
        uint64_t state = 8;
        for (int i = 0; i < 1000; ++i) {
            const lmb_vec3 position = {(float)(4.0 * fixture_random(&state) - 2.0), (float)fixture_random(&state),
                                       (float)(1.0 + fixture_random(&state))};
            lmb_sh3_rgb a, b;
            const bool inside_a = lmb_volume_sample(mapped, position, &a);
            const bool inside_b = lmb_volume_sample(p.volume, position, &b);
            CHECK(inside_a == inside_b && memcmp(&a, &b, sizeof a) == 0, "sample %d", i);
        }
    }
    lmb_volume_close(mapped);
    close_packed(&p);
    lmb_volume_close(NULL);

    lmb_volume *volume = NULL;
    CHECK(lmb_volume_open_file(path, &volume) == LMB_ERROR_IO, "missing");
    CHECK(lmb_volume_open_file(LMB_TEST_OUTPUT_DIR, &volume) == LMB_ERROR_IO, "a folder");
    CHECK(lmb_volume_open_file("/dev/zero", &volume) == LMB_ERROR_IO, "a device");
    CHECK(lmb_volume_open_file("", &volume) == LMB_ERROR_IO, "no name");
    CHECK(lmb_file_write(path, "", 0, NULL) == LMB_OK, "write nothing");
    CHECK(lmb_volume_open_file(path, &volume) == LMB_ERROR_TRUNCATED, "an empty file");
    CHECK(lmb_file_write(path, "not a volume", 12, NULL) == LMB_OK, "write text");
    CHECK(lmb_volume_open_file(path, &volume) == LMB_ERROR_FORMAT, "a text");
    CHECK(!volume, "output untouched");
    unlink(path);
}

/* The same probes always pack to the same bytes: those of tests/golden/small.lmb, which builds for other machines read.
 * Only a new version of the format changes them: what is packed now then lies in the tests' output folder. */
static void test_golden_file(void)
{
    static const lmb_lattice lattice = {.spacing = 0.75f, .min = {-3, 0, 2}, .size = {7, 4, 5}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 0.97, 1.0, 0.5, 14);
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        for (int channel = 0; channel < 3; ++channel) {
            probes->radiance[0][probe].channel[channel].c[0] += 2.0f; /* as real light has it: above all else */
        }
    }
    packed p = pack_and_open(probes);
    unsigned char *golden = NULL;
    size_t size_of_golden = 0;
    CHECK(lmb_file_read(LMB_GOLDEN_DIR "/small.lmb", &golden, &size_of_golden, NULL) == LMB_OK, "small.lmb");
    const bool is_same = size_of_golden == p.size && memcmp(golden, p.data, p.size) == 0;
    CHECK(is_same, "packed %zu bytes, small.lmb has %zu", p.size, size_of_golden);
    if (!is_same) {
        lmb_file_write(LMB_TEST_OUTPUT_DIR "/small.lmb", p.data, p.size, NULL);
    }
    free(golden);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"samples are the probes' trilinear light", test_sample},
    {"far and broken positions", test_far_and_broken_positions},
    {"positions in double", test_positions_in_double},
    {"few probes in a large box", test_few_in_a_large_box},
    {"light beyond fp16", test_overflow},
    {"probes that cannot be packed", test_pack_refuses},
    {"every truncation is refused", test_truncation},
    {"corrupted bytes are refused", test_corruption},
    {"forged bytes do no harm", test_forgery},
    {"forged fields", test_forged_fields},
    {"other kinds of file", test_wrong_kind},
    {"mapped files", test_files},
    {"the golden file", test_golden_file},
};
TEST_MAIN(cases)
