/* lambent/hhd.h: moments of known lights are recovered, every rule of the robust solve, IrradZ round trips, and inputs
 * that must not break any of it. */
#include "harness.h"
#include "sh_oracle.h"

#include <float.h>

#include <lambent/hhd.h>
#include <lambent/occlusion.h>

/* Moments in double of a hemisphere light of radiance `ambient` and a light of irradiance `directional` along d. */
static lmb_moments moments_of(double ambient, double directional, ovec n, ovec d)
{
    const ovec b = ovec_mix(n, ambient, d, directional);
    return (lmb_moments){(float)(2.0 * ambient + directional), ovec_float(b)};
}

static ovec direction_at(ovec n, double angle, double turn)
{
    ovec x, y;
    ovec_frame(n, &x, &y);
    const ovec flat = ovec_mix(x, cos(turn), y, sin(turn));
    return ovec_mix(n, cos(angle), flat, sin(angle));
}

static double degrees_between(lmb_vec3 a, ovec b)
{
    const ovec u = ovec_unit(ovec_of(a)), c = ovec_cross(u, b);
    return atan2(sqrt(ovec_dot(c, c)), ovec_dot(u, b)) * 180.0 / ORACLE_PI;
}

/* What every solution must be, whatever went in. `case_name` and `k` name the input. */
static void check_physical(lmb_hhd hhd, lmb_vec3 n_v, const char *case_name, int k)
{
    const ovec d = ovec_of(hhd.direction);
    CHECK(hhd.ambient >= 0.0f && hhd.ambient <= FLT_MAX, "%s %d: C_a = %g", case_name, k, (double)hhd.ambient);
    CHECK(hhd.directional >= 0.0f && hhd.directional <= FLT_MAX, "%s %d: C_d = %g", case_name, k,
          (double)hhd.directional);
    CHECK_NEAR(ovec_dot(d, d), 1.0, 1e-6, "%s %d: |d|^2", case_name, k);
    const ovec n = ovec_of(n_v);
    const double length = sqrt(ovec_dot(n, n));
    if (length > 0.0 && isfinite(length)) {
        CHECK(ovec_dot(d, n) >= -3e-7 * length, "%s %d: d.n_v = %g", case_name, k, ovec_dot(d, n) / length);
    }
}

static void check_light(float irradiance, const char *case_name, int k)
{
    CHECK(irradiance >= 0.0f && irradiance <= FLT_MAX, "%s %d: irradiance %g", case_name, k, (double)irradiance);
}

static lmb_sh3_rgb grey(const lmb_sh3 *sh)
{
    return (lmb_sh3_rgb){{*sh, *sh, *sh}};
}

static void test_moments_are_the_integrals(void)
{
    uint64_t random = 31;
    for (int k = 0; k < 100; ++k) {
        double c[9];
        const lmb_sh3 radiance = oracle_random_sh3(&random, 1.0, c);
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        const double cone_cos = k % 2 ? 0.0 : 0.5;
        const orule cone = oracle_zone(n, cone_cos, 1.0, 8, 16);
        double scalar = 0.0;
        ovec vector = {0, 0, 0};
        for (size_t i = 0; i < cone.count; ++i) {
            const double light = cone.nodes[i].weight * oracle_evaluate(c, cone.nodes[i].direction) / ORACLE_PI;
            scalar += light;
            vector = ovec_mix(vector, 1.0, cone.nodes[i].direction, light);
        }
        oracle_rule_free(cone);
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance, normal, (float)cone_cos);
        const lmb_moments moments = lmb_moments_from_sh2(&clipped);
        CHECK_NEAR(moments.scalar, scalar, 3e-6, "b_c, set %d", k);
        CHECK_NEAR(moments.vector.x, vector.x, 3e-6, "b.x, set %d", k);
        CHECK_NEAR(moments.vector.y, vector.y, 3e-6, "b.y, set %d", k);
        CHECK_NEAR(moments.vector.z, vector.z, 3e-6, "b.z, set %d", k);
    }
}

static void test_known_lights_are_recovered(void)
{
    uint64_t random = 32;
    for (int k = 0; k < 20000; ++k) {
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const ovec d =
            direction_at(n, 0.49 * ORACLE_PI * oracle_random(&random), 2 * ORACLE_PI * oracle_random(&random));
        const double scale = pow(10.0, 12.0 * oracle_random(&random) - 6.0);
        const double ambient = scale * oracle_random(&random), directional = scale * (0.05 + oracle_random(&random));
        const lmb_hhd hhd = lmb_hhd_solve(moments_of(ambient, directional, n, d), n_v);
        CHECK_NEAR(hhd.ambient, ambient, 3e-5 * scale, "case %d", k);
        CHECK_NEAR(hhd.directional, directional, 3e-5 * scale, "case %d", k);
        CHECK(degrees_between(hhd.direction, d) < 0.01, "case %d: %g degrees off", k,
              degrees_between(hhd.direction, d));
        check_physical(hhd, n_v, "known light", k);

        lmb_vec3 normal;
        const ovec m = oracle_random_normal(&random, &normal);
        const double truth = ambient * (1.0 + ovec_dot(m, n)) / 2.0 + directional * fmax(0.0, ovec_dot(m, d));
        CHECK_NEAR(lmb_hhd_evaluate(&hhd, n_v, normal), truth, 1e-4 * scale, "irradiance, case %d", k);
    }
}

/* C_d -> 0, C_a -> 0 and n_v.d -> 0: the answer goes to the limit and stays physical on the way. */
static void test_limits(void)
{
    uint64_t random = 41;
    for (int k = 0; k < 3000; ++k) {
        const double small = pow(10.0, -15.0 * k / 3000.0);
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const ovec d = direction_at(n, 1.2 * oracle_random(&random), 2 * ORACLE_PI * oracle_random(&random));
        const ovec low = direction_at(n, ORACLE_PI / 2.0 - small, 2 * ORACLE_PI * oracle_random(&random));
        const struct {
            double ambient, directional;
            ovec d;
        } limits[] = {{1.0, small, d}, {small, 1.0, d}, {0.3, 1.0, low}, {small, 1.0, low}};
        for (int i = 0; i < 4; ++i) {
            const double ambient = limits[i].ambient, directional = limits[i].directional;
            const lmb_hhd hhd = lmb_hhd_solve(moments_of(ambient, directional, n, limits[i].d), n_v);
            check_physical(hhd, n_v, "limit", 10 * k + i);
            CHECK_NEAR(hhd.ambient, ambient, 2e-6, "limit %d, small %g", i, small);
            CHECK_NEAR(hhd.directional, directional, 2e-6, "limit %d, small %g", i, small);
            const double i_z = ambient + directional * ovec_dot(limits[i].d, n);
            CHECK_NEAR(lmb_hhd_evaluate(&hhd, n_v, n_v), i_z, 1e-6, "limit %d, small %g", i, small);
        }
    }
}

/* C_a a thousand times C_d, in float: the sum-of-squares discriminant never fails and the direction holds. */
static void test_faint_highlight_in_float(void)
{
    uint64_t random = 33;
    double worst = 0.0;
    for (int k = 0; k < 400000; ++k) {
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const double angle = acos(oracle_random(&random));
        const ovec d = direction_at(n, angle, 2 * ORACLE_PI * oracle_random(&random));
        const lmb_moments moments = moments_of(1000.0, 1.0, n, d);
        const lmb_hhd hhd = lmb_hhd_solve(moments, n_v);
        const double error = degrees_between(hhd.direction, d);
        worst = fmax(worst, error);
        CHECK(error < 0.05, "moments %.9g (%.9g %.9g %.9g), n_v (%.9g %.9g %.9g): %g degrees", (double)moments.scalar,
              (double)moments.vector.x, (double)moments.vector.y, (double)moments.vector.z, (double)n_v.x,
              (double)n_v.y, (double)n_v.z, error);
        CHECK_NEAR(hhd.directional, 1.0, 2e-3, "case %d", k);
        CHECK_NEAR(hhd.ambient, 1000.0, 2e-3, "case %d", k);
    }
    printf("     C_a = 1000 C_d: direction at most %.4f degrees off\n", worst);
}

/* True moments of random non-negative radiance: no clamp may be needed but the horizon's, moments survive, I_z always.
 */
static void test_random_non_negative_radiance(void)
{
    uint64_t random = 34;
    int at_horizon = 0;
    for (int k = 0; k < 5000; ++k) {
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        double scalar = 0.0;
        ovec vector = {0, 0, 0};
        const int lights = 1 + k % 7;
        for (int i = 0; i < lights; ++i) {
            ovec d = oracle_random_direction(&random);
            const double height = ovec_dot(d, n);
            d = ovec_mix(d, 1.0, n, height < 0.0 ? -2.0 * height : 0.0);
            if (k % 3 == 0) { /* most of the light low over the horizon */
                d = ovec_unit(ovec_mix(d, 1.0, n, -0.95 * ovec_dot(d, n)));
            }
            const double light = pow(oracle_random(&random), 4.0);
            scalar += light;
            vector = ovec_mix(vector, 1.0, d, light);
        }
        const double ambient = k % 2 ? 0.3 * oracle_random(&random) : 0.0;
        scalar += 2.0 * ambient;
        vector = ovec_mix(vector, 1.0, n, ambient);

        const lmb_hhd hhd = lmb_hhd_solve((lmb_moments){(float)scalar, ovec_float(vector)}, n_v);
        check_physical(hhd, n_v, "random radiance", k);
        const double i_z = ovec_dot(vector, n), tolerance = 2e-6 * scalar;
        CHECK_NEAR(lmb_hhd_evaluate(&hhd, n_v, n_v), i_z, tolerance, "I(n_v), case %d", k);
        const ovec b_perp = ovec_mix(vector, 1.0, n, -i_z);
        if (sqrt(ovec_dot(b_perp, b_perp)) < scalar - 2.0 * i_z) {
            ++at_horizon;
            CHECK_NEAR(ovec_dot(ovec_of(hhd.direction), n), 0.0, 3e-7, "horizontal, case %d", k);
            continue;
        }
        const ovec b = ovec_mix(n, (double)hhd.ambient, ovec_of(hhd.direction), (double)hhd.directional);
        const ovec error = ovec_mix(b, 1.0, vector, -1.0);
        CHECK_NEAR(2.0 * (double)hhd.ambient + (double)hhd.directional, scalar, 4.0 * tolerance, "b_c, case %d", k);
        CHECK_NEAR(sqrt(ovec_dot(error, error)), 0.0, 2.0 * tolerance, "b, case %d", k);
    }
    CHECK(at_horizon > 100 && at_horizon < 2500, "%d of 5000 at the horizon: the cases do not cover both", at_horizon);
}

/* One row per rule of the solve, with n_v = +y. */
static void test_each_rule_of_the_solve(void)
{
    static const struct {
        const char *rule;
        lmb_moments moments;
        lmb_hhd expected;
    } cases[] = {
        {"no light", {0.0f, {0, 0, 0}}, {0, 0, {0, 1, 0}}},
        {"b_c < 0", {-1.0f, {1, 1, 0}}, {0, 0, {0, 1, 0}}},
        {"b_c NaN", {NAN, {1, 1, 0}}, {0, 0, {0, 1, 0}}},
        {"b infinite", {1.0f, {INFINITY, 1, 0}}, {0, 0, {0, 1, 0}}},
        {"I_z < 0 becomes 0", {1.0f, {0.5f, -0.5f, 0}}, {0, 0.5f, {1, 0, 0}}},
        {"I_z < 0, nothing else", {1.0f, {0, -0.5f, 0}}, {0, 0, {0, 1, 0}}},
        {"pure hemisphere", {2.0f, {0, 1, 0}}, {1, 0, {0, 1, 0}}},
        {"delta on the axis", {1.0f, {0, 1, 0}}, {0, 1, {0, 1, 0}}},
        {"delta at the horizon", {1.0f, {1, 0, 0}}, {0, 1, {1, 0, 0}}},
        {"|b| > b_c", {1.0f, {3, 4, 0}}, {0, 5, {0.6f, 0.8f, 0}}},
        {"ring at the horizon", {1.0f, {0, 0, 0}}, {0, 0, {0, 1, 0}}},
        {"low ring", {1.0f, {0, 0.1f, 0}}, {0.1f, 0, {0, 1, 0}}},
        {"low ring, uneven", {1.0f, {0, 0.1f, -0.2f}}, {0.1f, 0.2f, {0, 0, -1}}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        const lmb_hhd hhd = lmb_hhd_solve(cases[k].moments, (lmb_vec3){0, 1, 0});
        CHECK_NEAR(hhd.ambient, cases[k].expected.ambient, 1e-6, "%s", cases[k].rule);
        CHECK_NEAR(hhd.directional, cases[k].expected.directional, 1e-6, "%s", cases[k].rule);
        CHECK_NEAR(hhd.direction.x, cases[k].expected.direction.x, 1e-6, "%s", cases[k].rule);
        CHECK_NEAR(hhd.direction.y, cases[k].expected.direction.y, 1e-6, "%s", cases[k].rule);
        CHECK_NEAR(hhd.direction.z, cases[k].expected.direction.z, 1e-6, "%s", cases[k].rule);
    }
}

/* The solve scales with the light: fp16's edges, a sun, denormals and the end of float change nothing but the scale. */
static void test_solve_scales(void)
{
    static const float scales[] = {1e-37f, 5.96e-8f, 6.1e-5f, 1.0f, 255.9f, 65504.0f, 222208.0f, 1e6f, 1e18f, 1e37f};
    const ovec n = {0, 0, 1};
    const ovec d = direction_at(n, 1.0, 2.0);
    for (size_t k = 0; k < sizeof scales / sizeof scales[0]; ++k) {
        const double s = (double)scales[k];
        const lmb_hhd hhd = lmb_hhd_solve(moments_of(0.4 * s, 0.7 * s, n, d), (lmb_vec3){0, 0, 1});
        CHECK_NEAR((double)hhd.ambient / s, 0.4, 2e-6, "scale %g", s);
        CHECK_NEAR((double)hhd.directional / s, 0.7, 2e-6, "scale %g", s);
        CHECK(degrees_between(hhd.direction, d) < 1e-3, "scale %g", s);
    }
}

/* Delta light through SH3 and the hemisphere multiply, 0 to 180 degrees off the axis. */
static void test_delta_light_at_every_angle(void)
{
    uint64_t random = 35;
    for (int degrees = 0; degrees <= 180; ++degrees) {
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const ovec d = direction_at(n, degrees * ORACLE_PI / 180.0, 2 * ORACLE_PI * oracle_random(&random));
        lmb_sh3 radiance = {{0}};
        lmb_sh3_add_light(&radiance, ovec_float(d), (float)ORACLE_PI);
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance, n_v, 0.0f);
        const lmb_moments moments = lmb_moments_from_sh2(&clipped);
        const double i_z = ovec_dot(ovec_of(moments.vector), n);
        /* (1 + 2x + 5/8 (3x^2 - 1))/4 is negative from 104.1 to 145.5 degrees, 1/2 + 3x/4 from 131.8 on. */
        CHECK((i_z < 0.0) == (degrees >= 105 && degrees <= 145), "I_z = %g at %d degrees", i_z, degrees);
        CHECK((moments.scalar <= 0.0f) == (degrees >= 132), "b_c = %g at %d degrees", (double)moments.scalar, degrees);

        const lmb_hhd hhd = lmb_hhd_solve(moments, n_v);
        check_physical(hhd, n_v, "degrees", degrees);
        if (degrees <= 85) {
            CHECK(degrees_between(hhd.direction, d) < 20.0, "%d degrees: %g off", degrees,
                  degrees_between(hhd.direction, d));
        }
        const lmb_sh3_rgb rgb = grey(&radiance);
        const lmb_irradz irradz = lmb_irradz_encode(&rgb, n_v, 0.0f);
        const lmb_hhd_rgb decoded = lmb_irradz_decode(&irradz, n_v);
        CHECK_NEAR(lmb_hhd_rgb_evaluate(&decoded, n_v, n_v).c[1], fmax(0.0, i_z), 1e-6, "%d degrees", degrees);
        for (int k = 0; k < 20; ++k) {
            lmb_vec3 normal;
            (void)oracle_random_normal(&random, &normal);
            check_light(lmb_hhd_evaluate(&hhd, n_v, normal), "degrees", degrees);
            check_light(lmb_hhd_rgb_evaluate(&decoded, n_v, normal).c[0], "decoded at degrees", degrees);
        }
    }
}

static void test_a_light_on_each_axis(void)
{
    static const lmb_vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int light = 0; light < 6; ++light) {
        lmb_sh3 radiance = {{0}};
        lmb_sh3_add_light(&radiance, axes[light], (float)ORACLE_PI);
        const lmb_sh3_rgb rgb = grey(&radiance);
        for (int n_v = 0; n_v < 6; ++n_v) {
            const lmb_irradz irradz = lmb_irradz_encode(&rgb, axes[n_v], 0.0f);
            const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, axes[n_v]);
            const float towards = lmb_hhd_rgb_evaluate(&hhd, axes[n_v], axes[light]).c[0];
            const float away = lmb_hhd_rgb_evaluate(&hhd, axes[n_v], axes[light ^ 1]).c[0];
            if (n_v == (light ^ 1)) {
                CHECK(irradz.irradiance_z.c[0] < 0.07f, "light %d from behind: %g", light,
                      (double)irradz.irradiance_z.c[0]);
            } else {
                CHECK(towards > 0.49f && away < 0.1f * towards, "light %d, n_v %d: towards %g, away %g", light, n_v,
                      (double)towards, (double)away);
            }
        }
    }
}

/* A ring of lights round the horizon, a pure hemisphere, a sun of 1e6 beside candle light, and no light. */
static void test_named_skies(void)
{
    const lmb_vec3 up = {0, 1, 0};
    const lmb_sh3_rgb none = {0};
    const lmb_irradz dark = lmb_irradz_encode(&none, up, 0.0f);
    CHECK(dark.irradiance_z.c[0] == 0.0f && dark.ambient_weight == 1.0f && dark.direction.y == 1.0f, "no light");

    lmb_sh3_rgb ring = {0}, sun = {0};
    for (int k = 0; k < 64; ++k) {
        const double phi = 2 * ORACLE_PI * k / 64.0;
        lmb_sh3_rgb_add_light(&ring, (lmb_vec3){(float)cos(phi), 0, (float)sin(phi)}, (lmb_rgb){{1, 1, 1}});
    }
    lmb_sh3_rgb_add_light(&sun, (lmb_vec3){0.6f, 0.8f, 0}, (lmb_rgb){{1e6f, 1e6f, 1e6f}});
    lmb_sh3_rgb_add_light(&sun, (lmb_vec3){-0.8f, 0.6f, 0}, (lmb_rgb){{1, 0.5f, 0.1f}});
    const lmb_sh3_rgb skies[2] = {ring, sun};
    uint64_t random = 36;
    for (int k = 0; k < 2000; ++k) {
        lmb_vec3 n_v, normal;
        (void)oracle_random_normal(&random, &n_v);
        (void)oracle_random_normal(&random, &normal);
        const lmb_irradz irradz = lmb_irradz_encode(&skies[k % 2], k < 2 ? up : n_v, 0.0f);
        const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, k < 2 ? up : n_v);
        for (int i = 0; i < 3; ++i) {
            check_light(lmb_hhd_rgb_evaluate(&hhd, k < 2 ? up : n_v, normal).c[i], k % 2 ? "sun" : "ring", k);
        }
    }

    /* The true moments of a white hemisphere: all ambient. */
    const lmb_hhd hemisphere = lmb_hhd_solve((lmb_moments){2.0f, {0, 1, 0}}, up);
    CHECK(hemisphere.ambient == 1.0f && hemisphere.directional == 0.0f && hemisphere.direction.y == 1.0f,
          "C_a = %g, C_d = %g", (double)hemisphere.ambient, (double)hemisphere.directional);
    const lmb_sh3_rgb white = {{{{3.5449077f}}, {{3.5449077f}}, {{3.5449077f}}}};
    const lmb_irradz encoded = lmb_irradz_encode(&white, up, 0.0f);
    CHECK_NEAR(encoded.irradiance_z.c[2], 1.0, 1e-6, "white sky");
    CHECK_NEAR(encoded.ambient_weight, 1.0, 1e-3, "white sky");
}

/* I_z per channel is exact through encode, decode and evaluation; d and w obey their contract. */
static void test_irradz_round_trip_keeps_irradiance_z(void)
{
    uint64_t random = 37;
    int tilted = 0;
    for (int k = 0; k < 20000; ++k) {
        lmb_sh3_rgb radiance;
        double c[3][9];
        for (int i = 0; i < 3; ++i) {
            radiance.channel[i] = oracle_random_sh3(&random, k % 5, c[i]);
        }
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const float cone_cos = k % 3 == 0 ? (float)oracle_random(&random) : 0.0f;
        const lmb_irradz irradz = lmb_irradz_encode(&radiance, n_v, cone_cos);
        const double height = ovec_dot(ovec_of(irradz.direction), n);
        CHECK(irradz.ambient_weight >= 0.0f && irradz.ambient_weight <= 1.0f, "case %d", k);
        CHECK(height >= (double)LMB_IRRADZ_MIN_COS - 1e-6, "case %d: n_v.d = %g", k, height);
        CHECK_NEAR(ovec_dot(ovec_of(irradz.direction), ovec_of(irradz.direction)), 1.0, 1e-6, "case %d", k);
        tilted += height < (double)LMB_IRRADZ_MIN_COS + 1e-6;
        const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, n_v);
        const lmb_rgb irradiance = lmb_hhd_rgb_evaluate(&hhd, n_v, n_v);
        for (int i = 0; i < 3; ++i) {
            const double cc = (double)cone_cos;
            const orule cone = oracle_zone(n, cc, 1.0, 4, 6);
            double i_z = 0.0;
            for (size_t j = 0; k % 100 == 0 && j < cone.count; ++j) {
                const onode node = cone.nodes[j];
                i_z += node.weight * oracle_evaluate(c[i], node.direction) * ovec_dot(node.direction, n) / ORACLE_PI;
            }
            oracle_rule_free(cone);
            if (k % 100 == 0) {
                CHECK_NEAR(irradz.irradiance_z.c[i], fmax(0.0, i_z), 2e-6, "I_z, case %d channel %d", k, i);
            }
            CHECK_NEAR(irradiance.c[i], irradz.irradiance_z.c[i], 2e-6 * (1.0 + (double)irradz.irradiance_z.c[i]),
                       "I(n_v), case %d channel %d", k, i);
        }
    }
    CHECK(tilted > 50, "only %d cases near the horizon", tilted);
}

/* Where d needs no tilt, decoding gives back the luminance's HHD; where it does, C_d survives if I_z lets it. */
static void test_irradz_keeps_the_split_of_the_luminance(void)
{
    uint64_t random = 38;
    int kept = 0, tilted = 0, unlit = 0;
    for (int k = 0; k < 20000; ++k) {
        double c[9];
        const lmb_sh3 radiance = oracle_random_sh3(&random, 1.0 + k % 3, c);
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance, n_v, 0.0f);
        const lmb_moments moments = lmb_moments_from_sh2(&clipped);
        const lmb_hhd expected = lmb_hhd_solve(moments, n_v);
        const lmb_sh3_rgb rgb = grey(&radiance);
        const lmb_irradz irradz = lmb_irradz_encode(&rgb, n_v, 0.0f);
        if (moments.scalar <= 0.0f) {
            ++unlit; /* nothing to split: whatever I_z the ringing leaves is ambient */
            CHECK(irradz.ambient_weight == 1.0f, "case %d: w = %g", k, (double)irradz.ambient_weight);
            continue;
        }
        const lmb_hhd_rgb actual = lmb_irradz_decode(&irradz, n_v);
        const double height = ovec_dot(ovec_of(expected.direction), n);
        const double i_z = (double)irradz.irradiance_z.c[0];
        const double room = i_z / (double)LMB_IRRADZ_MIN_COS; /* the most that a tilted C_d can be */
        if (height > (double)LMB_IRRADZ_MIN_COS + 1e-5) {
            ++kept;
            CHECK_NEAR(actual.ambient.c[1], expected.ambient, 1e-5, "case %d", k);
            CHECK(degrees_between(actual.direction, ovec_of(expected.direction)) < 1e-3, "case %d", k);
        } else {
            ++tilted;
        }
        CHECK_NEAR(actual.directional.c[1], fmin((double)expected.directional, fmax(room, 0.0)), 5e-5,
                   "case %d, d.n %g", k, height);
    }
    CHECK(kept > 5000 && tilted > 50 && unlit > 50, "%d kept, %d tilted, %d unlit", kept, tilted, unlit);
}

/* n_v.d -> 0: delta light of the polynomial kind cannot get there, so feed the decoder what filtering may give. */
static void test_decode_mends_what_filtering_breaks(void)
{
    static const lmb_vec3 directions[] = {
        {0, 0.3f, 0}, {0.5f, 0.1f, 0.2f}, {1, 0, 0},         {1, -1e-6f, 0}, {0.6f, -0.8f, 0},
        {0, -1, 0},   {0, 0, 0},          {1e-30f, 0, 0},    {1e-45f, 0, 0}, {1e30f, 1e30f, 1e30f},
        {NAN, 0, 1},  {INFINITY, 0, 0},   {3e38f, 3e38f, 0},
    };
    static const float weights[] = {-0.5f, 0.0f, 1e-45f, 0.3f, 1.0f, 1.00001f, 7.0f, NAN, INFINITY, -INFINITY};
    const lmb_vec3 n_v = {0, 1, 0};
    for (size_t i = 0; i < sizeof directions / sizeof directions[0]; ++i) {
        for (size_t j = 0; j < sizeof weights / sizeof weights[0]; ++j) {
            const int k = (int)(100 * i + j);
            const lmb_irradz irradz = {{{0.25f, 65504.0f, 1e-40f}}, weights[j], directions[i]};
            const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, n_v);
            for (int channel = 0; channel < 3; ++channel) {
                const lmb_hhd one = {hhd.ambient.c[channel], hhd.directional.c[channel], hhd.direction};
                check_physical(one, n_v, "direction and weight", k);
                const double i_z = (double)irradz.irradiance_z.c[channel];
                CHECK_NEAR(lmb_hhd_evaluate(&one, n_v, n_v), i_z, 2e-6 * i_z + 1e-44, "direction and weight %d", k);
            }
            CHECK(hhd.direction.y >= LMB_IRRADZ_MIN_COS - 1e-7f, "direction and weight %d: %g", k,
                  (double)hhd.direction.y);
        }
    }
    const lmb_irradz broken = {{{NAN, -1.0f, INFINITY}}, 0.5f, {0, 1, 0}};
    const lmb_hhd_rgb mended = lmb_irradz_decode(&broken, n_v);
    CHECK(mended.ambient.c[0] == 0.0f && mended.ambient.c[1] == 0.0f, "NaN and negative I_z give no light");
    check_light(lmb_hhd_rgb_evaluate(&mended, n_v, n_v).c[2], "infinite I_z", 0);
}

static void compare_at_once(const lmb_irradz *irradz, lmb_vec3 n_v, lmb_vec3 n, int k)
{
    const lmb_hhd_rgb hhd = lmb_irradz_decode(irradz, n_v);
    const lmb_rgb apart = lmb_hhd_rgb_evaluate(&hhd, n_v, n), once = lmb_irradz_evaluate(irradz, n_v, n);
    for (int c = 0; c < 3; ++c) {
        check_light(once.c[c], "at once", k);
        CHECK_NEAR(once.c[c], apart.c[c], 4e-6 * (double)(hhd.ambient.c[c] + hhd.directional.c[c]) + 1e-37,
                   "case %d, channel %d", k, c);
    }
}

/* Decoding and evaluating at once gives what one after the other does, whatever is stored. */
static void test_at_once_is_one_after_the_other(void)
{
    static const float weights[] = {-0.5f, 0.0f, 0.3f, 1.0f, 7.0f, NAN};
    uint64_t random = 7;
    for (int k = 0; k < 60000; ++k) {
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const double angle = k % 3 == 0 ? 1.5 + 0.08 * oracle_random(&random) : ORACLE_PI * oracle_random(&random);
        const double length = k % 5 == 0 ? pow(10.0, -30.0 * oracle_random(&random)) : oracle_random(&random);
        const ovec d = direction_at(n, angle, 2 * ORACLE_PI * oracle_random(&random));
        const ovec shading =
            direction_at(n, ORACLE_PI * oracle_random(&random), 2 * ORACLE_PI * oracle_random(&random));
        const float w = k % 7 == 0 ? weights[k / 7 % 6] : (float)oracle_random(&random);
        const ovec none = {0, 0, 0};
        const lmb_irradz irradz = {{{1.0f, 1e-3f, 6e4f}}, w, ovec_float(ovec_mix(none, 0.0, d, length))};
        compare_at_once(&irradz, n_v, ovec_float(shading), k);
    }
}

/* What filtering gives: a d that agrees decodes as it stands; one that was mixed from surfaces facing apart says less
 * the lower n_v.d is before d is made unit, and nothing at the horizon. */
static void test_decode_trusts_directions_that_agree(void)
{
    static const struct {
        const char *mixed;
        lmb_vec3 d;
        double ambient, directional; /* of I_z = 1, w = 0.4, n_v = +y */
    } cases[] = {
        {"nothing", {0.6f, 0.8f, 0}, 0.4, 0.6 / 0.8},
        {"to the left and to the right", {0, 0.5f, 0}, 0.4, 0.6},
        {"nothing, as low as is stored", {0.99874922f, 0.05f, 0}, 0.4, 0.6 / 0.05},
        {"half of it from behind", {0.6f, 0.025f, 0}, 0.4 + 0.6 * 0.75, 0.6 * 0.25 / 0.05},
        {"up and down, a little left", {0.1f, 0.025f, 0}, 0.4 + 0.6 * 0.75, 0.6 * 0.25 / (0.025 / 0.10307764)},
        {"at the horizon", {1, 0, 0}, 1.0, 0.0},
        {"behind", {0.8f, -0.6f, 0}, 1.0, 0.0},
        {"up and down alike", {0, 0, 0}, 1.0, 0.0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        const lmb_irradz irradz = {{{1.0f, 2.0f, 0.0f}}, 0.4f, cases[k].d};
        const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, (lmb_vec3){0, 1, 0});
        for (int i = 0; i < 3; ++i) {
            const double i_z = (double)irradz.irradiance_z.c[i];
            CHECK_NEAR(hhd.ambient.c[i], i_z * cases[k].ambient, 1e-6, "%s", cases[k].mixed);
            CHECK_NEAR(hhd.directional.c[i], i_z * cases[k].directional, 2e-5, "%s", cases[k].mixed);
        }
    }
}

/* Two lights over one normal, filtered: C_d is no more than the brighter one's, for the same I_z. From any n_v, however
 * turned, no more than the guard allows, without a step as n_v turns. */
static void test_filtered_directions_make_no_light(void)
{
    uint64_t random = 42;
    for (int k = 0; k < 20000; ++k) {
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        lmb_irradz texel[2];
        double directional[2];
        for (int i = 0; i < 2; ++i) {
            const double angle = (k % 2 ? 1.52 : 1.0) * oracle_random(&random);
            const ovec d = direction_at(n, angle, 2 * ORACLE_PI * oracle_random(&random));
            texel[i] = (lmb_irradz){{{1.0f, 1.0f, 1.0f}}, (float)oracle_random(&random), ovec_float(d)};
            directional[i] = (double)lmb_irradz_decode(&texel[i], n_v).directional.c[0];
        }
        const float t = (float)oracle_random(&random);
        const ovec mixed =
            ovec_mix(ovec_of(texel[0].direction), 1.0 - (double)t, ovec_of(texel[1].direction), (double)t);
        const lmb_irradz filtered = {{{1.0f, 1.0f, 1.0f}},
                                     (1.0f - t) * texel[0].ambient_weight + t * texel[1].ambient_weight,
                                     ovec_float(mixed)};
        const double both = (double)lmb_irradz_decode(&filtered, n_v).directional.c[0];
        CHECK(both <= 1.00001 * fmax(directional[0], directional[1]), "case %d: %g and %g become %g", k, directional[0],
              directional[1], both);

        const double length = sqrt(ovec_dot(mixed, mixed));
        const double most = (1.0 - (double)filtered.ambient_weight) * length / (double)LMB_IRRADZ_MIN_COS;
        const double turn = 2 * ORACLE_PI * oracle_random(&random);
        double last = 0.0;
        for (int step = 0; k % 50 == 0 && step <= 2000; ++step) {
            const ovec turned = direction_at(n, ORACLE_PI * step / 2000.0, turn);
            const lmb_vec3 float_turned = ovec_float(turned);
            const lmb_hhd_rgb hhd = lmb_irradz_decode(&filtered, float_turned);
            const double now = (double)hhd.directional.c[0];
            CHECK(now <= 1.001 * most + 1e-5, "case %d, step %d: C_d = %g of %g", k, step, now, most);
            CHECK(step == 0 || fabs(now - last) <= 0.07 * most + 1e-5, "case %d: C_d steps from %g to %g at %d", k,
                  last, now, step);
            const lmb_hhd one = {hhd.ambient.c[0], hhd.directional.c[0], hhd.direction};
            CHECK_NEAR(lmb_hhd_evaluate(&one, float_turned, float_turned), 1.0, 1e-5, "case %d, step %d", k, step);
            last = now;
        }
    }
}

static const lmb_vec3 nasty_normals[] = {
    {0, 1, 0},           {0.57735027f, 0.57735027f, 0.57735027f},
    {0, 0, 0},           {0, 2, 0},
    {0.1f, 0.2f, -0.1f}, {1e-45f, 0, 0},
    {1e-30f, 1e-30f, 0}, {3e38f, 0, 0},
    {NAN, 0, 1},         {NAN, NAN, NAN},
    {0, INFINITY, 0},    {-INFINITY, 1, 0},
    {1.001f, 0, 0},      {3e38f, -3e38f, 3e38f},
};
enum { NASTY_NORMAL_COUNT = sizeof nasty_normals / sizeof nasty_normals[0] };

/* Every combination of nasty moments, with every nasty normal in turn. */
static void test_solve_is_never_broken(void)
{
    int k = 0;
    for (int s = 0; s < ORACLE_NASTY_COUNT; ++s) {
        for (int x = 0; x < ORACLE_NASTY_COUNT; ++x) {
            for (int y = 0; y < ORACLE_NASTY_COUNT; ++y) {
                for (int z = 0; z < ORACLE_NASTY_COUNT; ++z, ++k) {
                    const lmb_moments moments = {oracle_nasty[s], {oracle_nasty[x], oracle_nasty[y], oracle_nasty[z]}};
                    const lmb_vec3 n_v = nasty_normals[k % NASTY_NORMAL_COUNT];
                    const lmb_hhd hhd = lmb_hhd_solve(moments, n_v);
                    check_physical(hhd, n_v, "moments", k);
                    const lmb_vec3 normal = nasty_normals[k / NASTY_NORMAL_COUNT % NASTY_NORMAL_COUNT];
                    check_light(lmb_hhd_evaluate(&hhd, n_v, normal), "moments", k);
                }
            }
        }
    }
}

static void test_encoder_is_never_broken(void)
{
    uint64_t random = 39;
    for (int k = 0; k < 200000; ++k) {
        lmb_sh3_rgb radiance;
        for (int i = 0; i < 27; ++i) {
            const size_t pick = (size_t)(oracle_random(&random) * ORACLE_NASTY_COUNT);
            radiance.channel[i / 9].c[i % 9] = oracle_random(&random) < (k % 2 ? 0.95 : 0.3)
                                                   ? (float)(2.0 * oracle_random(&random) - 1.0)
                                                   : oracle_nasty[pick];
        }
        lmb_vec3 n_v, normal;
        (void)oracle_random_normal(&random, &n_v);
        (void)oracle_random_normal(&random, &normal);
        if (k % 5 == 0) {
            n_v = nasty_normals[k / 5 % NASTY_NORMAL_COUNT];
        }
        const float cone_cos = k % 4 ? 0.0f : oracle_nasty[k / 4 % ORACLE_NASTY_COUNT];
        const lmb_irradz irradz = lmb_irradz_encode(&radiance, n_v, cone_cos);
        CHECK(irradz.ambient_weight >= 0.0f && irradz.ambient_weight <= 1.0f, "case %d", k);
        const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, n_v);
        const lmb_rgb irradiance = lmb_hhd_rgb_evaluate(&hhd, n_v, normal);
        const lmb_rgb bounce = lmb_self_bounce((lmb_rgb){{0.5f, NAN, -1.0f}}, irradz.irradiance_z, n_v, normal);
        for (int i = 0; i < 3; ++i) {
            check_light(irradz.irradiance_z.c[i], "I_z", k);
            check_light(irradiance.c[i], "decoded", k);
            check_light(bounce.c[i], "bounce", k);
            const lmb_hhd channel = {hhd.ambient.c[i], hhd.directional.c[i], hhd.direction};
            check_physical(channel, n_v, "decoded", k);
        }
    }
}

/* One broken channel does not take the others with it. */
static void test_broken_channel_is_dark_and_alone(void)
{
    lmb_sh3_rgb radiance = {0};
    lmb_sh3_rgb_add_light(&radiance, (lmb_vec3){0.6f, 0.8f, 0}, (lmb_rgb){{1, 2, 3}});
    const lmb_vec3 up = {0, 1, 0};
    const lmb_irradz whole = lmb_irradz_encode(&radiance, up, 0.0f);
    radiance.channel[0].c[4] = NAN;
    const lmb_irradz mended = lmb_irradz_encode(&radiance, up, 0.0f);
    CHECK(mended.irradiance_z.c[0] == 0.0f, "%g", (double)mended.irradiance_z.c[0]);
    CHECK(mended.irradiance_z.c[1] == whole.irradiance_z.c[1] && mended.irradiance_z.c[2] == whole.irradiance_z.c[2],
          "green and blue");
    CHECK(degrees_between(mended.direction, ovec_of(whole.direction)) < 0.01, "same light, same direction");
}

static void test_cone_closes_smoothly(void)
{
    uint64_t random = 40;
    double c[9];
    const lmb_sh3 sh = oracle_random_sh3(&random, 3.0, c);
    const lmb_sh3_rgb radiance = grey(&sh);
    const lmb_vec3 n_v = {0, 0, 1};
    float last = INFINITY;
    for (int k = 0; k <= 1000; ++k) {
        const float cone_cos = (float)k / 1000.0f;
        const lmb_irradz irradz = lmb_irradz_encode(&radiance, n_v, cone_cos);
        const lmb_hhd_rgb hhd = lmb_irradz_decode(&irradz, n_v);
        const lmb_hhd channel = {hhd.ambient.c[0], hhd.directional.c[0], hhd.direction};
        check_physical(channel, n_v, "cone", k);
        CHECK(irradz.irradiance_z.c[0] <= last + 1e-6f, "cone %d lets in more than a wider one", k);
        last = irradz.irradiance_z.c[0];
    }
    CHECK(last == 0.0f, "closed, yet %g", (double)last);
}

/* albedo I_z (1 - t)/2 is what a white floor of radiance albedo I_z below the horizon sends to n. */
static void test_self_bounce(void)
{
    const ovec n_v = {0, 1, 0};
    for (int degrees = 0; degrees <= 90; degrees += 15) {
        const ovec n = {sin(degrees * ORACLE_PI / 180.0), cos(degrees * ORACLE_PI / 180.0), 0};
        const orule below = oracle_zone(n_v, -1.0, 0.0, 200, 400);
        double irradiance = 0.0;
        for (size_t i = 0; i < below.count; ++i) {
            irradiance += below.nodes[i].weight * fmax(0.0, ovec_dot(below.nodes[i].direction, n)) / ORACLE_PI;
        }
        oracle_rule_free(below);
        const lmb_rgb bounce = lmb_self_bounce((lmb_rgb){{0.5f, 1.0f, 0.0f}}, (lmb_rgb){{2.0f, 3.0f, 4.0f}},
                                               (lmb_vec3){0, 1, 0}, ovec_float(n));
        CHECK_NEAR(bounce.c[0], irradiance, 1e-4, "%d degrees", degrees);
        CHECK_NEAR(bounce.c[1], 3.0 * irradiance, 3e-4, "%d degrees", degrees);
        CHECK(bounce.c[2] == 0.0f, "%d degrees", degrees);
    }
}

static const test_case cases[] = {
    {"moments are the integrals", test_moments_are_the_integrals},
    {"known lights are recovered", test_known_lights_are_recovered},
    {"limits of C_a, C_d and n_v.d", test_limits},
    {"faint highlight in float", test_faint_highlight_in_float},
    {"random non-negative radiance", test_random_non_negative_radiance},
    {"each rule of the solve", test_each_rule_of_the_solve},
    {"solve scales", test_solve_scales},
    {"at once is one after the other", test_at_once_is_one_after_the_other},
    {"delta light at every angle", test_delta_light_at_every_angle},
    {"a light on each axis", test_a_light_on_each_axis},
    {"named skies", test_named_skies},
    {"IrradZ round trip keeps I_z", test_irradz_round_trip_keeps_irradiance_z},
    {"IrradZ keeps the split of the luminance", test_irradz_keeps_the_split_of_the_luminance},
    {"decode mends what filtering breaks", test_decode_mends_what_filtering_breaks},
    {"decode trusts directions that agree", test_decode_trusts_directions_that_agree},
    {"filtered directions make no light", test_filtered_directions_make_no_light},
    {"solve is never broken", test_solve_is_never_broken},
    {"encoder is never broken", test_encoder_is_never_broken},
    {"broken channel is dark and alone", test_broken_channel_is_dark_and_alone},
    {"cone closes smoothly", test_cone_closes_smoothly},
    {"self bounce", test_self_bounce},
};

TEST_MAIN(cases)
