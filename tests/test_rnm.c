/* Radiosity normal mapping: the slopes, light on them, and the blend. */
#include "harness.h"
#include "sh_oracle.h"

#include <float.h>

#include <lambent/rnm.h>

enum { ROUNDS = 200 };

/* `a` turned by the shortest way that takes unit `from` to unit `to`: Rodrigues' formula. */
static ovec turned(ovec a, ovec from, ovec to)
{
    const ovec axis = ovec_cross(from, to);
    const double cosine = ovec_dot(from, to), along = ovec_dot(axis, a) / (1.0 + cosine);
    const ovec across = ovec_cross(axis, a);
    return ovec_mix(ovec_mix(a, cosine, across, 1.0), 1.0, axis, along);
}

static void oracle_slopes(ovec n, ovec slope[3])
{
    const ovec from = {0.36, 0.8, 0.48};
    const ovec x = turned((ovec){0.48, -0.6, 0.64}, from, n), y = turned((ovec){0.8, 0.0, -0.6}, from, n);
    for (int k = 0; k < 3; ++k) {
        const double turn = 2.0 * ORACLE_PI * k / 3.0;
        const ovec flat = ovec_mix(x, sqrt(2.0 / 3.0) * cos(turn), y, sqrt(2.0 / 3.0) * sin(turn));
        slope[k] = ovec_mix(flat, 1.0, n, sqrt(1.0 / 3.0));
    }
}

static void slopes_are_the_turned_ones(void)
{
    uint64_t random = 1;
    for (int k = 0; k < ROUNDS; ++k) {
        lmb_vec3 normal, slope[LMB_RNM_SLOPES];
        ovec expected[3];
        const ovec n = oracle_random_normal(&random, &normal);
        oracle_slopes(n, expected);
        lmb_rnm_slopes(lmb_vec3_scale(normal, k % 2 ? 1.0f : 7.5f), slope);
        for (int i = 0; i < 3; ++i) {
            CHECK_NEAR(slope[i].x, expected[i].x, 1e-6, "normal %d, slope %d", k, i);
            CHECK_NEAR(slope[i].y, expected[i].y, 1e-6, "normal %d, slope %d", k, i);
            CHECK_NEAR(slope[i].z, expected[i].z, 1e-6, "normal %d, slope %d", k, i);
        }
    }
}

static void check_orthonormal(lmb_vec3 n, const lmb_vec3 slope[3], const char *what, int k)
{
    for (int i = 0; i < 3; ++i) {
        CHECK_NEAR(lmb_vec3_dot(slope[i], n), sqrt(1.0 / 3.0), 1e-5, "%s %d, slope %d", what, k, i);
        for (int j = 0; j < 3; ++j) {
            CHECK_NEAR(lmb_vec3_dot(slope[i], slope[j]), i == j, 1e-5, "%s %d, slopes %d and %d", what, k, i, j);
        }
    }
    const lmb_vec3 last = lmb_vec3_cross(slope[0], slope[1]);
    CHECK_NEAR(lmb_vec3_dot(last, slope[2]), 1.0, 1e-5, "%s %d: right-handed", what, k);
}

/* However near to the one normal that has no frame of its own; and at it, and of no normal. */
static void slopes_are_orthonormal(void)
{
    const lmb_vec3 single = {-0.36f, -0.8f, -0.48f};
    uint64_t random = 2;
    lmb_vec3 slope[LMB_RNM_SLOPES];
    for (int k = 0; k < ROUNDS; ++k) {
        lmb_vec3 off;
        oracle_random_normal(&random, &off);
        const float near_by = powf(10.0f, -0.05f * (float)k);
        const lmb_vec3 n = lmb_vec3_unit_or(lmb_vec3_mad(single, off, near_by), single);
        lmb_rnm_slopes(n, slope);
        check_orthonormal(n, slope, "power", k);
    }
    lmb_rnm_slopes(single, slope);
    check_orthonormal(single, slope, "single", 0);
    lmb_rnm_slopes(lmb_vec3_of(NAN, 0.0f, 0.0f), slope);
    check_orthonormal(lmb_vec3_of(0.0f, 1.0f, 0.0f), slope, "none", 0);
}

/* Normals that differ little have slopes that differ little: of floors, ceilings and all walls, not more than four
 * times as much. */
static void slopes_are_smooth(void)
{
    for (int k = 0; k < 720; ++k) {
        const double turn = ORACLE_PI * k / 360.0, step = 1e-3;
        lmb_vec3 at[2][LMB_RNM_SLOPES];
        for (int i = 0; i < 2; ++i) {
            const double a = turn + step * i;
            lmb_rnm_slopes(lmb_vec3_of((float)cos(a), 0.0f, (float)sin(a)), at[i]);
        }
        for (int i = 0; i < 3; ++i) {
            const lmb_vec3 change = lmb_vec3_sub(at[1][i], at[0][i]);
            CHECK(lmb_vec3_length(change) < 4e-3f, "wall %d, slope %d: %g", k, i, (double)lmb_vec3_length(change));
        }
    }
}

/* Light of SH3 above the horizon and above the slope's own, by quadrature. */
static void harmonics_on_slopes(void)
{
    uint64_t random = 3;
    for (int k = 0; k < 20; ++k) {
        double c[3][9];
        lmb_sh3_rgb radiance;
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        for (int i = 0; i < 3; ++i) {
            radiance.channel[i] = oracle_random_sh3(&random, 5.0, c[i]);
        }
        ovec slope[3];
        oracle_slopes(n, slope);
        const lmb_rnm rnm = lmb_rnm_from_sh3(&radiance, normal);
        const orule rule = oracle_zone(n, 0.0, 1.0, 120, 240);
        for (int s = 0; s < 3; ++s) {
            double sum[3] = {0.0};
            for (size_t i = 0; i < rule.count; ++i) {
                const ovec w = rule.nodes[i].direction;
                const double cosine = rule.nodes[i].weight * fmax(ovec_dot(w, slope[s]), 0.0) / ORACLE_PI;
                for (int j = 0; j < 3 && cosine > 0.0; ++j) {
                    sum[j] += cosine * oracle_evaluate(c[j], w);
                }
            }
            for (int j = 0; j < 3; ++j) {
                CHECK_NEAR(rnm.light[s].c[j], fmax(sum[j], 0.0), 3e-4, "light %d, slope %d, colour %d", k, s, j);
            }
        }
        oracle_rule_free(rule);
    }
}

/* A sky that is the same all over gives each slope (1 + 1/sqrt3)/2, which is all that any normal gets of it: RNM
 * does not know that the horizon hides less from n_v. */
static void white_sky(void)
{
    const lmb_vec3 n = {0.6f, 0.0f, -0.8f};
    lmb_sh3_rgb white = {{{{2.0f * (float)sqrt(ORACLE_PI)}}}};
    white.channel[1] = white.channel[2] = white.channel[0];
    const lmb_rnm rnm = lmb_rnm_from_sh3(&white, n);
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(n, slope);
    CHECK_NEAR(lmb_rnm_evaluate(&rnm, slope, n).c[0], 0.5 * (1.0 + sqrt(1.0 / 3.0)), 1e-6, "n_v");
    CHECK_NEAR(lmb_rnm_evaluate(&rnm, slope, slope[2]).c[0], 0.5 * (1.0 + sqrt(1.0 / 3.0)), 1e-6, "a slope");
}

/* On a slope its own light, halfway between two the mean of both, and nothing where none is faced. */
static void blend(void)
{
    const lmb_vec3 axes[3] = {{0.0f, 0.0f, 1.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}};
    const lmb_rnm rnm = {{{{1.0f, 0.5f, 0.0f}}, {{2.0f, 4.0f, 8.0f}}, {{3.0f, 0.0f, 1.0f}}}};
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes_in_axes(axes, slope);
    check_orthonormal(axes[2], slope, "axes", 0);
    CHECK_NEAR(slope[0].z, sqrt(2.0 / 3.0), 1e-6, "B1 is towards x");
    CHECK(slope[1].x > 0.7f && slope[2].x < -0.7f, "B2 is towards y");
    for (int k = 0; k < 3; ++k) {
        const lmb_vec3 middle = lmb_vec3_unit_or(lmb_vec3_add(slope[k], slope[(k + 1) % 3]), axes[2]);
        for (int c = 0; c < 3; ++c) {
            const float next = rnm.light[(k + 1) % 3].c[c];
            CHECK_NEAR(lmb_rnm_evaluate(&rnm, slope, slope[k]).c[c], rnm.light[k].c[c], 1e-6, "slope %d", k);
            CHECK_NEAR(lmb_rnm_evaluate(&rnm, slope, middle).c[c], 0.5f * (rnm.light[k].c[c] + next), 1e-6, "%d", k);
        }
    }
    const lmb_rgb none = lmb_rnm_evaluate(&rnm, slope, lmb_vec3_of(0.0f, -1.0f, 0.0f));
    CHECK(none.c[0] == 0.0f && none.c[1] == 0.0f && none.c[2] == 0.0f, "%g", (double)none.c[0]);
}

/* A bump map that is flat is the blend at n_v; in shadow it is as much less. */
static void self_shadowed(void)
{
    const lmb_vec3 n = {0.0f, 1.0f, 0.0f};
    const lmb_rnm rnm = {{{{1.0f, 0.5f, 0.0f}}, {{2.0f, 4.0f, 8.0f}}, {{3.0f, 0.0f, 1.0f}}}};
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(n, slope);
    const lmb_rgb flat = lmb_ssbump_evaluate(&rnm, lmb_rgb_of(85.0f / 255.0f, 85.0f / 255.0f, 85.0f / 255.0f));
    const lmb_rgb dark = lmb_ssbump_evaluate(&rnm, lmb_rgb_of(0.0f, 0.25f, 0.5f));
    for (int c = 0; c < 3; ++c) {
        CHECK_NEAR(flat.c[c], lmb_rnm_evaluate(&rnm, slope, n).c[c], 1e-6, "flat, colour %d", c);
        CHECK_NEAR(dark.c[c], 0.25f * rnm.light[1].c[c] + 0.5f * rnm.light[2].c[c], 1e-6, "dark, colour %d", c);
    }
}

/* One light, added, is what its cosines say; from below the horizon, nothing. */
static void one_light(void)
{
    uint64_t random = 4;
    for (int k = 0; k < ROUNDS; ++k) {
        lmb_vec3 normal, direction, slope[LMB_RNM_SLOPES];
        const ovec n = oracle_random_normal(&random, &normal), d = oracle_random_normal(&random, &direction);
        ovec expected[3];
        oracle_slopes(n, expected);
        lmb_rnm_slopes(normal, slope);
        lmb_rnm rnm = {{{{0.0f}}}};
        lmb_rnm_add_light(&rnm, normal, slope, direction, lmb_rgb_of(1.0f, 2.0f, 0.0f));
        for (int s = 0; s < 3; ++s) {
            const double light = ovec_dot(n, d) > 0.0 ? fmax(ovec_dot(expected[s], d), 0.0) / ORACLE_PI : 0.0;
            CHECK_NEAR(rnm.light[s].c[1], 2.0 * light, 1e-6, "light %d, slope %d", k, s);
        }
    }
}

static bool is_light(lmb_rgb a)
{
    return a.c[0] >= 0.0f && a.c[0] <= FLT_MAX && a.c[1] >= 0.0f && a.c[1] <= FLT_MAX && a.c[2] >= 0.0f &&
           a.c[2] <= FLT_MAX;
}

static void broken_input_gives_light(void)
{
    uint64_t random = 5;
    for (int k = 0; k < 2000; ++k) {
        lmb_sh3_rgb radiance;
        lmb_rnm raw;
        lmb_vec3 normal, slope[LMB_RNM_SLOPES];
        double c[9];
        for (int i = 0; i < 3; ++i) {
            radiance.channel[i] = oracle_random_sh3(&random, 0.0, c);
            radiance.channel[i].c[(k + i) % 9] = oracle_nasty[k % ORACLE_NASTY_COUNT];
            raw.light[i] = (lmb_rgb){{oracle_nasty[(k + i) % ORACLE_NASTY_COUNT], 1.0f, oracle_nasty[k / 21 % 21]}};
        }
        oracle_random_normal(&random, &normal);
        normal = k % 7 == 0 ? lmb_vec3_of(oracle_nasty[k % ORACLE_NASTY_COUNT], 0.0f, 1.0f) : normal;
        lmb_rnm_slopes(normal, slope);
        const lmb_rnm rnm = lmb_rnm_from_sh3(&radiance, normal);
        CHECK(is_light(rnm.light[0]) && is_light(rnm.light[1]) && is_light(rnm.light[2]), "encoded %d", k);
        CHECK(is_light(lmb_rnm_evaluate(&rnm, slope, normal)), "evaluated %d", k);
        CHECK(is_light(lmb_rnm_evaluate(&raw, slope, normal)), "raw %d", k);
        CHECK(is_light(lmb_ssbump_evaluate(&raw, raw.light[0])), "bump %d", k);
    }
}

static const test_case cases[] = {
    {"slopes_are_the_turned_ones", slopes_are_the_turned_ones},
    {"slopes_are_orthonormal", slopes_are_orthonormal},
    {"slopes_are_smooth", slopes_are_smooth},
    {"harmonics_on_slopes", harmonics_on_slopes},
    {"white_sky", white_sky},
    {"blend", blend},
    {"self_shadowed", self_shadowed},
    {"one_light", one_light},
    {"broken_input_gives_light", broken_input_gives_light},
};

TEST_MAIN(cases)
