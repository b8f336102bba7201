/* lambent/sh.h and lambent/result.h: basis, signs, units, irradiance, and inputs that must not break it. */
#include "harness.h"
#include "sh_oracle.h"

#include <float.h>

#include <lambent/result.h>
#include <lambent/sh.h>

/* Irradiance of the set alone, negative too: lifted by a constant radiance, and the constant taken off. */
static double irradiance_unclamped(lmb_sh3 radiance, lmb_vec3 normal)
{
    const double lift = 4.0;
    radiance.c[0] += (float)(lift * 2.0 * sqrt(ORACLE_PI));
    return (double)lmb_sh3_irradiance(&radiance, normal) - lift;
}

static void test_basis_is_gsl_with_condon_shortley_signs(void)
{
    uint64_t random = 1;
    for (int k = 0; k < 2000; ++k) {
        lmb_vec3 direction;
        const ovec d = oracle_random_normal(&random, &direction);
        const lmb_sh3 actual = lmb_sh3_basis(direction);
        double expected[9];
        oracle_basis(d, expected);
        for (int i = 0; i < 9; ++i) {
            CHECK_NEAR(actual.c[i], expected[i], 4e-7, "Y_%d at %g %g %g", i, d.x, d.y, d.z);
        }
    }
}

static void test_basis_is_orthonormal(void)
{
    const orule sphere = oracle_zone((ovec){0, 0, 1}, -1.0, 1.0, 8, 16);
    double gram[9][9] = {{0}};
    for (size_t k = 0; k < sphere.count; ++k) {
        const lmb_sh3 y = lmb_sh3_basis(ovec_float(sphere.nodes[k].direction));
        for (int i = 0; i < 9; ++i) {
            for (int j = 0; j < 9; ++j) {
                gram[i][j] += sphere.nodes[k].weight * (double)y.c[i] * (double)y.c[j];
            }
        }
    }
    for (int i = 0; i < 9; ++i) {
        for (int j = 0; j < 9; ++j) {
            CHECK_NEAR(gram[i][j], i == j ? 1.0 : 0.0, 1e-6, "Y_%d Y_%d", i, j);
        }
    }
    oracle_rule_free(sphere);
}

/* Signs written out by hand: the mirrored (all-positive) set passes every test that only projects and evaluates. */
static void test_a_light_on_each_axis_has_the_stated_signs(void)
{
    static const struct {
        lmb_vec3 axis;
        int linear;
        float sign;
    } cases[] = {
        {{1, 0, 0}, 3, -1}, {{-1, 0, 0}, 3, 1}, {{0, 1, 0}, 1, -1},
        {{0, -1, 0}, 1, 1}, {{0, 0, 1}, 2, 1},  {{0, 0, -1}, 2, -1},
    };
    const double n1 = sqrt(3.0 / (4.0 * ORACLE_PI));
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        const lmb_vec3 axis = cases[k].axis;
        lmb_sh3 light = {{0}};
        lmb_sh3_add_light(&light, axis, 1.0f);
        for (int i = 1; i < 4; ++i) {
            CHECK_NEAR(light.c[i], i == cases[k].linear ? (double)cases[k].sign * n1 : 0.0, 1e-7, "axis %zu, l1[%d]", k,
                       i);
        }
        lmb_sh3 by_hand = {{1.0f}};
        by_hand.c[cases[k].linear] = cases[k].sign;
        const lmb_vec3 away = {-axis.x, -axis.y, -axis.z};
        CHECK(irradiance_unclamped(by_hand, axis) > 5.0 * fabs(irradiance_unclamped(by_hand, away)), "axis %zu", k);
        CHECK(irradiance_unclamped(light, axis) > 15.0 * fabs(irradiance_unclamped(light, away)), "axis %zu", k);
        for (size_t other = 0; other < sizeof cases / sizeof cases[0]; ++other) {
            CHECK(other == k ||
                      lmb_sh3_irradiance(&light, cases[other].axis) < 0.25f * lmb_sh3_irradiance(&light, axis),
                  "light %zu, normal %zu", k, other);
        }
    }
}

/* l2-2 > 0 is bright where xy > 0, l2-1 < 0 where yz > 0, l21 < 0 where xz > 0, l22 > 0 along x. */
static void test_quadratic_signs_by_hand(void)
{
    const float r = 0.70710678f;
    static const int index[4] = {4, 5, 7, 8};
    static const double expected[4] = {1.0, -1.0, -1.0, 1.0};
    const lmb_vec3 direction[4] = {{r, r, 0}, {0, r, r}, {r, 0, r}, {1, 0, 0}};
    for (int k = 0; k < 4; ++k) {
        const lmb_sh3 y = lmb_sh3_basis(direction[k]);
        CHECK_NEAR(y.c[index[k]], expected[k] * sqrt(15.0 / (16.0 * ORACLE_PI)), 1e-6, "Y_%d", index[k]);
    }
    CHECK_NEAR(lmb_sh3_basis((lmb_vec3){0, 0, 1}).c[6], sqrt(5.0 / (4.0 * ORACLE_PI)), 1e-6, "Y_20 at +z");
}

static void test_projecting_a_polynomial_gives_it_back(void)
{
    uint64_t random = 2;
    const orule sphere = oracle_zone(ovec_unit((ovec){1, 2, -0.5}), -1.0, 1.0, 6, 12);
    for (int k = 0; k < 50; ++k) {
        double c[9];
        const lmb_sh3 source = oracle_random_sh3(&random, 0.0, c);
        lmb_sh3 projected = {{0}};
        for (size_t i = 0; i < sphere.count; ++i) {
            lmb_sh3_add_light(&projected, ovec_float(sphere.nodes[i].direction),
                              (float)(oracle_evaluate(c, sphere.nodes[i].direction) * sphere.nodes[i].weight));
        }
        for (int i = 0; i < 9; ++i) {
            CHECK_NEAR(projected.c[i], c[i], 3e-6, "coefficient %d of set %d", i, k);
        }
        lmb_vec3 direction;
        const ovec d = oracle_random_normal(&random, &direction);
        CHECK_NEAR(lmb_sh3_evaluate(&source, direction), oracle_evaluate(c, d), 2e-6, "set %d", k);
    }
    oracle_rule_free(sphere);
}

/* E/pi of a quadratic polynomial, by quadrature over the hemisphere of the normal: exact, no truncation is involved. */
static void test_irradiance_is_the_cosine_integral(void)
{
    uint64_t random = 3;
    for (int k = 0; k < 200; ++k) {
        double c[9];
        const lmb_sh3 radiance = oracle_random_sh3(&random, 1.0, c);
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        const orule hemisphere = oracle_zone(n, 0.0, 1.0, 6, 12);
        double irradiance = 0.0;
        for (size_t i = 0; i < hemisphere.count; ++i) {
            const onode node = hemisphere.nodes[i];
            irradiance += node.weight * oracle_evaluate(c, node.direction) * ovec_dot(node.direction, n) / ORACLE_PI;
        }
        oracle_rule_free(hemisphere);
        CHECK_NEAR(lmb_sh3_irradiance(&radiance, normal), fmax(0.0, irradiance), 2e-6, "set %d", k);
        CHECK_NEAR(irradiance_unclamped(radiance, normal), irradiance, 2e-6, "set %d", k);
        const lmb_sh3_rgb rgb = {{radiance, radiance, radiance}};
        CHECK_NEAR(lmb_sh3_rgb_irradiance(&rgb, normal).c[k % 3], fmax(0.0, irradiance), 2e-6, "set %d, channel", k);
        const lmb_sh2 linear = {{radiance.c[0], radiance.c[1], radiance.c[2], radiance.c[3]}};
        double without = 0.0, basis[9];
        oracle_basis(n, basis);
        for (int i = 0; i < LMB_SH2_COUNT; ++i) {
            without += c[i] * basis[i] * (i == 0 ? 1.0 : 2.0 / 3.0);
        }
        const lmb_sh2_rgb linear_rgb = {{linear, linear, linear}};
        CHECK_NEAR(lmb_sh2_irradiance(&linear, normal), fmax(0.0, without), 2e-6, "set %d, two bands", k);
        CHECK_NEAR(lmb_sh2_rgb_irradiance(&linear_rgb, normal).c[k % 3], fmax(0.0, without), 2e-6, "set %d", k);
    }
}

static void test_constant_radiance_one_gives_irradiance_one(void)
{
    const lmb_sh3 constant = {{(float)(2.0 * sqrt(ORACLE_PI))}};
    uint64_t random = 4;
    for (int k = 0; k < 20; ++k) {
        lmb_vec3 normal;
        (void)oracle_random_normal(&random, &normal);
        CHECK_NEAR(lmb_sh3_irradiance(&constant, normal), 1.0, 1e-6, "normal %d", k);
        CHECK_NEAR(lmb_sh3_evaluate(&constant, normal), 1.0, 1e-6, "normal %d", k);
    }
}

/* One delta light of irradiance 1 undershoots to -0.25 in SH2 and to -0.0396 in SH3, at the angles where it should. */
static void test_undershoot_of_a_delta_light(void)
{
    lmb_sh3 light = {{0}};
    lmb_sh3_add_light(&light, (lmb_vec3){0, 0, 1}, (float)ORACLE_PI);
    lmb_sh3 linear = light;
    for (int i = 4; i < 9; ++i) {
        linear.c[i] = 0.0f;
    }
    double least2 = 1.0, least3 = 1.0;
    for (int k = 0; k <= 1800; ++k) {
        const double angle = ORACLE_PI * k / 1800.0;
        const lmb_vec3 normal = {(float)sin(angle), 0.0f, (float)cos(angle)};
        least2 = fmin(least2, irradiance_unclamped(linear, normal));
        least3 = fmin(least3, irradiance_unclamped(light, normal));
    }
    CHECK_NEAR(least2, -0.25, 1e-5, "SH2");
    CHECK_NEAR(least3, -0.0396, 5e-5, "SH3");
}

/* Bounds over l0 for any non-negative radiance: such sets are sums of delta lights and the bounds are convex, so delta
 * lights reach them and never pass them. */
static void test_bounds_of_non_negative_radiance(void)
{
    const double sqrt3 = sqrt(3.0), sqrt5 = sqrt(5.0), sqrt15 = sqrt(15.0);
    double most_sectoral[9] = {0}, least_zonal = 0.0, most_zonal = 0.0;
    uint64_t random = 7;
    for (int k = 0; k < 100000; ++k) {
        lmb_vec3 direction;
        (void)oracle_random_normal(&random, &direction);
        lmb_sh3 light = {{0}};
        lmb_sh3_add_light(&light, direction, 1.0f);
        double over[9];
        for (int i = 0; i < 9; ++i) {
            over[i] = (double)light.c[i] / (double)light.c[0];
            most_sectoral[i] = fmax(most_sectoral[i], fabs(over[i]));
        }
        CHECK_NEAR(sqrt(over[1] * over[1] + over[2] * over[2] + over[3] * over[3]), sqrt3, 1e-6, "light %d", k);
        least_zonal = fmin(least_zonal, over[6]);
        most_zonal = fmax(most_zonal, over[6]);
    }
    CHECK_NEAR(least_zonal, -sqrt5 / 2.0, 1e-3, "l20");
    CHECK_NEAR(most_zonal, sqrt5, 1e-3, "l20");
    static const int sectoral[] = {4, 5, 7, 8};
    for (int k = 0; k < 4; ++k) {
        CHECK_NEAR(most_sectoral[sectoral[k]], sqrt15 / 2.0, 1e-3, "coefficient %d", sectoral[k]);
    }
}

static void test_colour_lerp_and_luminance(void)
{
    uint64_t random = 5;
    double c[9];
    lmb_sh3_rgb a, b;
    for (int i = 0; i < 3; ++i) {
        a.channel[i] = oracle_random_sh3(&random, 0.0, c);
        b.channel[i] = oracle_random_sh3(&random, 0.0, c);
    }
    const lmb_sh3_rgb start = lmb_sh3_rgb_lerp(&a, &b, 0.0f);
    const lmb_sh3_rgb mix = lmb_sh3_rgb_lerp(&a, &b, 0.25f);
    const lmb_sh3 luminance = lmb_sh3_rgb_luminance(&a);
    for (int j = 0; j < 9; ++j) {
        double y = 0.0;
        for (int i = 0; i < 3; ++i) {
            static const double rec709[3] = {0.2126, 0.7152, 0.0722};
            const double from = (double)a.channel[i].c[j], to = (double)b.channel[i].c[j];
            y += rec709[i] * from;
            CHECK(start.channel[i].c[j] == a.channel[i].c[j], "channel %d, coefficient %d", i, j);
            CHECK_NEAR(mix.channel[i].c[j], 0.75 * from + 0.25 * to, 2e-7, "channel %d, coefficient %d", i, j);
        }
        CHECK_NEAR(luminance.c[j], y, 2e-7, "coefficient %d", j);
    }
    lmb_sh3_rgb lit = {0};
    const lmb_vec3 direction = {0.0f, 0.6f, -0.8f};
    lmb_sh3_rgb_add_light(&lit, direction, (lmb_rgb){{1.0f, 2.0f, 3.0f}});
    for (int i = 0; i < 3; ++i) {
        lmb_sh3 single = {{0}};
        lmb_sh3_add_light(&single, direction, (float)(i + 1));
        CHECK(memcmp(&single, &lit.channel[i], sizeof single) == 0, "channel %d", i);
    }
}

static void test_coloured_irradiance_is_never_broken(void)
{
    uint64_t random = 6;
    for (int k = 0; k < 200000; ++k) {
        lmb_sh3_rgb radiance;
        bool broken[3] = {false, false, false};
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 9; ++j) {
                const size_t pick = (size_t)(oracle_random(&random) * ORACLE_NASTY_COUNT);
                const bool plain = k % 3 != 0 && oracle_random(&random) < 0.9;
                radiance.channel[i].c[j] = plain ? (float)(2.0 * oracle_random(&random) - 1.0) : oracle_nasty[pick];
                broken[i] = broken[i] || !isfinite(radiance.channel[i].c[j]);
            }
        }
        lmb_vec3 normal;
        (void)oracle_random_normal(&random, &normal);
        const lmb_rgb irradiance = lmb_sh3_rgb_irradiance(&radiance, normal);
        for (int i = 0; i < 3; ++i) {
            CHECK(irradiance.c[i] >= 0.0f && irradiance.c[i] <= FLT_MAX, "case %d channel %d: %g", k, i,
                  (double)irradiance.c[i]);
            CHECK(!broken[i] || irradiance.c[i] == 0.0f, "case %d channel %d: %g", k, i, (double)irradiance.c[i]);
        }
    }
}

static void test_huge_light_saturates_instead_of_vanishing(void)
{
    lmb_sh3_rgb radiance = {0};
    for (int i = 0; i < 3; ++i) {
        radiance.channel[i].c[0] = FLT_MAX;
        radiance.channel[i].c[2] = i == 0 ? FLT_MAX : -FLT_MAX;
        radiance.channel[i].c[6] = i == 2 ? -FLT_MAX : FLT_MAX;
    }
    const lmb_rgb up = lmb_sh3_rgb_irradiance(&radiance, (lmb_vec3){0, 0, 1});
    CHECK_NEAR(up.c[0] / FLT_MAX, 0.28209479 + 0.32573501 + 0.15769578, 1e-6, "all three bands");
    CHECK_NEAR(up.c[1] / FLT_MAX, 0.28209479 - 0.32573501 + 0.15769578, 1e-6, "linear band taken away");
    CHECK(up.c[2] == 0.0f, "%g", (double)up.c[2]);
    /* Every coefficient at FLT_MAX towards the brightest place: more than a float holds. */
    lmb_sh3_rgb full;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 9; ++j) {
            full.channel[i].c[j] = (j == 1 || j == 3 || j == 5 || j == 7) ? -FLT_MAX : FLT_MAX;
        }
    }
    const float r = 0.57735027f;
    CHECK(lmb_sh3_rgb_irradiance(&full, (lmb_vec3){r, r, r}).c[0] == FLT_MAX, "saturates");
}

static void test_every_result_has_a_text(void)
{
    for (int i = LMB_OK; i <= LMB_ERROR_INTERRUPTED; ++i) {
        const char *text = lmb_result_text((lmb_result)i);
        CHECK(text && text[0] && text[strlen(text) - 1] != '.', "result %d", i);
        CHECK(strcmp(text, lmb_result_text((lmb_result)99)) != 0, "result %d has the text of an unknown one", i);
        for (int j = LMB_OK; j < i; ++j) {
            CHECK(strcmp(text, lmb_result_text((lmb_result)j)) != 0, "results %d and %d", i, j);
        }
    }
}

static const test_case cases[] = {
    {"basis is GSL's with Condon-Shortley signs", test_basis_is_gsl_with_condon_shortley_signs},
    {"basis is orthonormal", test_basis_is_orthonormal},
    {"a light on each axis has the stated signs", test_a_light_on_each_axis_has_the_stated_signs},
    {"quadratic signs by hand", test_quadratic_signs_by_hand},
    {"projecting a polynomial gives it back", test_projecting_a_polynomial_gives_it_back},
    {"irradiance is the cosine integral", test_irradiance_is_the_cosine_integral},
    {"constant radiance 1 gives irradiance 1", test_constant_radiance_one_gives_irradiance_one},
    {"undershoot of a delta light", test_undershoot_of_a_delta_light},
    {"bounds of non-negative radiance", test_bounds_of_non_negative_radiance},
    {"colour: lerp and luminance", test_colour_lerp_and_luminance},
    {"coloured irradiance is never broken", test_coloured_irradiance_is_never_broken},
    {"huge light saturates instead of vanishing", test_huge_light_saturates_instead_of_vanishing},
    {"every result has a text", test_every_result_has_a_text},
};

TEST_MAIN(cases)
