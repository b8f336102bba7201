/* The fitted hemisphere multiply: what it is by other code, what it keeps, and that it is worth having. */
#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/occlusion.h>

#include "harness.h"
#include "multiply_weights.h"
#include "sh_oracle.h"

static double length_of(ovec a)
{
    return sqrt(ovec_dot(a, a));
}

static double moments_distance(lmb_moments a, lmb_moments b)
{
    const ovec off = ovec_mix(ovec_of(a.vector), 1.0, ovec_of(b.vector), -1.0);
    return fmax(fabs((double)a.scalar - (double)b.scalar), length_of(off));
}

static lmb_moments gram(const lmb_sh3 *radiance, lmb_vec3 normal, float cone_cos)
{
    const lmb_sh2 clipped = lmb_sh3_multiply_cone(radiance, normal, cone_cos);
    return lmb_moments_from_sh2(&clipped);
}

/* Non-negative light of a few directions over an even sky. */
static lmb_sh3 random_light(uint64_t *random)
{
    lmb_sh3 light = {{0.0f}};
    light.c[0] = (float)(2.0 * oracle_random(random));
    const int lights = 1 + (int)(4.0 * oracle_random(random));
    for (int i = 0; i < lights; ++i) {
        lmb_sh3_add_light(&light, ovec_float(oracle_random_direction(random)), (float)oracle_random(random));
    }
    return light;
}

/* The rule once more, in long double, in a frame of the normal, with coefficients there and Gram's moments by
 * quadrature. */

typedef struct local_light {
    long double l[9]; /* of the local frame, Condon-Shortley signs, over l0 */
    ovec x, y, n;
} local_light;

static local_light local_light_of(const double c[9], ovec n)
{
    local_light local = {.n = n};
    ovec_frame(n, &local.x, &local.y);
    const orule sphere = oracle_zone(n, -1.0, 1.0, 4, 8);
    for (size_t k = 0; k < sphere.count; ++k) {
        const ovec d = sphere.nodes[k].direction;
        double basis[9];
        oracle_basis((ovec){ovec_dot(d, local.x), ovec_dot(d, local.y), ovec_dot(d, n)}, basis);
        for (int i = 0; i < 9; ++i) {
            local.l[i] += (long double)(sphere.nodes[k].weight * oracle_evaluate(c, d) * basis[i] / c[0]);
        }
    }
    oracle_rule_free(sphere);
    return local;
}

static void oracle_network(const lmb_multiply_network *w, const long double *x, double cone_cos, long double *output)
{
    long double first[LMB_MULTIPLY_FIRST], second[LMB_MULTIPLY_SECOND];
    for (int u = 0; u < LMB_MULTIPLY_FIRST; ++u) {
        first[u] = (long double)w->first[u] + (long double)w->cone[u] * (long double)cone_cos;
        for (int i = 0; i < LMB_MULTIPLY_INVARIANTS; ++i) {
            first[u] += (long double)w->invariant[i][u] * x[i];
        }
        first[u] = fmaxl(first[u], 0.0L);
    }
    for (int u = 0; u < LMB_MULTIPLY_SECOND; ++u) {
        second[u] = (long double)w->second[u];
        for (int i = 0; i < LMB_MULTIPLY_FIRST; ++i) {
            second[u] += (long double)w->first_weight[i][u] * first[i];
        }
        second[u] = fmaxl(second[u], 0.0L);
    }
    for (int u = 0; u <= LMB_MULTIPLY_OUTPUTS; ++u) {
        output[u] = (long double)(u < LMB_MULTIPLY_OUTPUTS ? w->output[u] : w->qv);
        for (int i = 0; i < LMB_MULTIPLY_SECOND; ++i) {
            output[u] += (long double)(u < LMB_MULTIPLY_OUTPUTS ? w->second_weight[i][u] : w->qv_weight[i]) * second[i];
        }
    }
}

/* Gram's moments of the polynomial: integrals of L/pi and L w/pi over the cone. */
static double clipped_moments(const double c[9], ovec n, double cone_cos, ovec *vector)
{
    double scalar = 0.0;
    *vector = (ovec){0.0, 0.0, 0.0};
    const orule cone = oracle_zone(n, cone_cos, 1.0, 4, 8);
    for (size_t k = 0; k < cone.count; ++k) {
        const double light = cone.nodes[k].weight * oracle_evaluate(c, cone.nodes[k].direction) / ORACLE_PI;
        scalar += light;
        *vector = ovec_mix(*vector, 1.0, cone.nodes[k].direction, light);
    }
    oracle_rule_free(cone);
    return scalar;
}

static double oracle_moments(const double c[9], ovec n, double cone_cos, ovec *vector)
{
    const local_light local = local_light_of(c, n);
    const long double *l = local.l;
    /* Complex numbers of the tangent plane: v, q, and Q as what it makes of the conjugate. */
    const long double v[2] = {-l[3], -l[1]}, q[2] = {-l[7], -l[5]}, m[2] = {l[8], l[4]};
    const long double qv[2] = {m[0] * v[0] + m[1] * v[1], m[1] * v[0] - m[0] * v[1]};
    long double x[LMB_MULTIPLY_INVARIANTS] = {l[2],
                                              l[6],
                                              v[0] * v[0] + v[1] * v[1],
                                              q[0] * q[0] + q[1] * q[1],
                                              v[0] * q[0] + v[1] * q[1],
                                              m[0] * m[0] + m[1] * m[1],
                                              v[0] * qv[0] + v[1] * qv[1],
                                              q[0] * qv[0] + q[1] * qv[1]};
    long double opened[LMB_MULTIPLY_OUTPUTS + 1], closing[LMB_MULTIPLY_OUTPUTS + 1], square = 0.0L;
    oracle_network(&lmb_multiply_opened, x, 0.0, opened);
    oracle_network(&lmb_multiply_closing, x, cone_cos, closing);
    for (int i = 1; i < 9; ++i) {
        square += l[i] * l[i];
    }
    const long double even = (long double)LMB_MULTIPLY_EVEN_SQUARE;
    const long double axial = (long double)(c[0] * (1.0 - cone_cos)) * square / (square + even);
    const long double tangential = axial * (long double)sqrt(1.0 - cone_cos * cone_cos);
    for (int i = 0; i <= LMB_MULTIPLY_OUTPUTS; ++i) {
        opened[i] += (long double)cone_cos * closing[i];
    }
    const double scalar = clipped_moments(c, n, cone_cos, vector);
    const double more[2] = {(double)(tangential * (opened[2] * v[0] + opened[3] * q[0] + opened[4] * qv[0])),
                            (double)(tangential * (opened[2] * v[1] + opened[3] * q[1] + opened[4] * qv[1]))};
    *vector = ovec_mix(*vector, 1.0, n, (double)(axial * opened[1]));
    *vector = ovec_mix(*vector, 1.0, ovec_mix(local.x, more[0], local.y, more[1]), 1.0);
    return scalar + (double)(axial * opened[0]);
}

static void test_matches_local_frame(void)
{
    uint64_t random = 11;
    for (int k = 0; k < 3000; ++k) {
        const lmb_sh3 light = random_light(&random);
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const float cone_cos = k % 2 ? 0.0f : (float)oracle_random(&random);
        double c[9];
        for (int i = 0; i < 9; ++i) {
            c[i] = (double)light.c[i];
        }
        ovec vector;
        const double scalar = oracle_moments(c, n, (double)cone_cos, &vector);
        const lmb_moments found = lmb_moments_from_probe(&light, n_v, cone_cos);
        const double tolerance = 1e-5 * c[0];
        CHECK_NEAR(found.scalar, scalar, tolerance, "light %d, cone %g", k, (double)cone_cos);
        CHECK_NEAR(length_of(ovec_mix(ovec_of(found.vector), 1.0, vector, -1.0)), 0.0, tolerance, "light %d, cone %g",
                   k, (double)cone_cos);
    }
}

/* Turned or mirrored light gives turned or mirrored moments. */
static void test_turns_and_mirrors(void)
{
    uint64_t random = 12;
    for (int k = 0; k < 2000; ++k) {
        const lmb_sh3 light = random_light(&random);
        lmb_vec3 n;
        oracle_random_normal(&random, &n);
        ovec axis[3] = {oracle_random_direction(&random)};
        ovec_frame(axis[0], &axis[1], &axis[2]);
        if (k % 2) {
            axis[2] = (ovec){-axis[2].x, -axis[2].y, -axis[2].z};
        }
        const lmb_vec3 axes[3] = {ovec_float(axis[0]), ovec_float(axis[1]), ovec_float(axis[2])};
        const lmb_sh3 turned = lmb_sh3_in_axes(&light, axes);
        const ovec exact = ovec_of(n);
        const ovec there = {ovec_dot(axis[0], exact), ovec_dot(axis[1], exact), ovec_dot(axis[2], exact)};
        const float cone_cos = k % 3 ? 0.0f : 0.4f;
        const lmb_moments before = lmb_moments_from_probe(&light, n, cone_cos);
        const lmb_moments after = lmb_moments_from_probe(&turned, ovec_float(there), cone_cos);
        const ovec b = ovec_of(before.vector);
        const lmb_moments expected = {
            before.scalar, ovec_float((ovec){ovec_dot(axis[0], b), ovec_dot(axis[1], b), ovec_dot(axis[2], b)})};
        CHECK_NEAR(moments_distance(after, expected), 0.0, 2e-5 * (double)light.c[0], "light %d", k);
    }
}

static lmb_sh3 scaled(const lmb_sh3 *sh, float s)
{
    lmb_sh3 product;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        product.c[i] = s * sh->c[i];
    }
    return product;
}

/* Any brightness: to the bit by powers of two, which floats hold exactly. */
static void test_scales_with_light(void)
{
    uint64_t random = 13;
    for (int k = 0; k < 500; ++k) {
        const lmb_sh3 light = random_light(&random);
        lmb_vec3 n;
        oracle_random_normal(&random, &n);
        const float cone_cos = k % 3 ? 0.0f : 0.3f;
        const lmb_moments once = lmb_moments_from_probe(&light, n, cone_cos);
        for (int power = -60; power <= 60; power += 30) {
            const float s = ldexpf(1.0f, power);
            const lmb_sh3 brighter = scaled(&light, s);
            const lmb_moments m = lmb_moments_from_probe(&brighter, n, cone_cos);
            CHECK(m.scalar == s * once.scalar && m.vector.x == s * once.vector.x && m.vector.y == s * once.vector.y &&
                      m.vector.z == s * once.vector.z,
                  "light %d by 2^%d", k, power);
        }
        const float s = (float)(0.1 + 10.0 * oracle_random(&random));
        const lmb_sh3 brighter = scaled(&light, s);
        const lmb_moments m = lmb_moments_from_probe(&brighter, n, cone_cos);
        const lmb_moments expected = {s * once.scalar, {s * once.vector.x, s * once.vector.y, s * once.vector.z}};
        CHECK_NEAR(moments_distance(m, expected), 0.0, 1e-5 * (double)brighter.c[0], "light %d by %g", k, (double)s);
    }
}

/* Light that is the same from everywhere is what Gram says, which is right. */
static void test_even_light_is_exact(void)
{
    const lmb_sh3 white = {{(float)(2.0 * sqrt(ORACLE_PI))}};
    for (int k = 0; k <= 10; ++k) {
        const float c = 0.1f * (float)k;
        const double open = 1.0 - (double)c * (double)c;
        const lmb_moments m = lmb_moments_from_probe(&white, (lmb_vec3){0.6f, 0.0f, 0.8f}, c);
        CHECK_NEAR(m.scalar, 2.0 * (1.0 - (double)c), 1e-6, "cone %g", (double)c);
        CHECK_NEAR(length_of(ovec_mix(ovec_of(m.vector), 1.0, (ovec){0.6 * open, 0.0, 0.8 * open}, -1.0)), 0.0, 1e-6,
                   "cone %g", (double)c);
    }
}

/* As n_v turns through the light's own axes, where tangential parts vanish, as a cone opens to the hemisphere or
 * closes, and as the light fades, nothing jumps. */
static void test_continuous(void)
{
    uint64_t random = 14;
    for (int k = 0; k < 200; ++k) {
        lmb_sh3 light = {{0.2f}};
        const ovec d = oracle_random_direction(&random), side = oracle_random_direction(&random);
        lmb_sh3_add_light(&light, ovec_float(d), 1.0f);
        if (k % 2) {
            lmb_sh3_add_light(&light, ovec_float(oracle_random_direction(&random)), 0.5f);
        }
        lmb_moments last = {0.0f, {0.0f, 0.0f, 0.0f}};
        const double step = 1e-3;
        for (int i = -40; i <= 40; ++i) {
            const ovec n = ovec_unit(ovec_mix(d, 1.0, side, i * step));
            const lmb_moments m = lmb_moments_from_probe(&light, ovec_float(n), 0.0f);
            CHECK(i == -40 || moments_distance(m, last) < 5.0 * step * (double)light.c[0], "turn %d of light %d", i, k);
            last = m;
        }
        const lmb_vec3 n = ovec_float(side);
        for (int i = 0; i <= 10000; ++i) { /* a light that leaves the cone makes it steep */
            const lmb_moments m = lmb_moments_from_probe(&light, n, 1e-4f * (float)i);
            CHECK(i == 0 || moments_distance(m, last) < 40e-4 * (double)light.c[0], "cone %d of light %d", i, k);
            last = m;
        }
        CHECK(last.scalar == 0.0f && length_of(ovec_of(last.vector)) == 0.0, "closed, light %d", k);
        for (float l0 = 1.0f; l0 > 1e-37f; l0 *= 0.1f) {
            light.c[0] = l0;
            const lmb_moments m = lmb_moments_from_probe(&light, n, 0.0f), g = gram(&light, n, 0.0f);
            CHECK(moments_distance(m, g) <= 10.0 * (double)l0 + 1e-6, "l0 %g of light %d", (double)l0, k);
        }
        light.c[0] = 0.0f;
        CHECK(moments_distance(lmb_moments_from_probe(&light, n, 0.0f), gram(&light, n, 0.0f)) == 0.0, "light %d", k);
    }
}

/* HLSH is the least-squares fit, with I(n_v) held, of what HHD gives, wherever its direction is. */
static void test_hlsh_fits_hhd(void)
{
    uint64_t random = 16;
    for (int k = 0; k < 400; ++k) {
        const lmb_sh3 light = random_light(&random);
        lmb_vec3 n_v;
        const ovec n = oracle_random_normal(&random, &n_v);
        const float cone_cos = k % 2 ? 0.0f : 0.5f;
        const lmb_hhd hhd = lmb_hhd_solve(lmb_moments_from_probe(&light, n_v, cone_cos), n_v);
        const lmb_hlsh found = lmb_hlsh_from_probe(&light, n_v, cone_cos);
        const double i_z = (double)lmb_hhd_evaluate(&hhd, n_v, n_v);
        double ambient = -0.5 * i_z;
        ovec tangential = {0.0, 0.0, 0.0};
        const orule hemisphere = oracle_zone(n, 0.0, 1.0, 60, 120);
        for (size_t i = 0; i < hemisphere.count; ++i) {
            const ovec d = hemisphere.nodes[i].direction;
            const double t = ovec_dot(d, n);
            const double part =
                1.5 / ORACLE_PI * hemisphere.nodes[i].weight * (double)lmb_hhd_evaluate(&hhd, n_v, ovec_float(d));
            ambient += part * (1.0 - t);
            tangential = ovec_mix(tangential, 1.0, ovec_mix(d, 1.0, n, -t), part);
        }
        oracle_rule_free(hemisphere);
        const double tolerance = 1e-3 * (double)light.c[0];
        CHECK_NEAR(found.irradiance_z, i_z, 1e-5 * (double)light.c[0], "light %d", k);
        CHECK_NEAR(found.ambient, ambient, tolerance, "light %d", k);
        CHECK_NEAR(length_of(ovec_mix(ovec_of(found.tangential), 1.0, tangential, -1.0)), 0.0, tolerance, "light %d",
                   k);
    }
}

static void check_light(float light, const char *what, int k)
{
    CHECK(light >= 0.0f && light <= FLT_MAX, "%s %d: %g", what, k, (double)light);
}

/* Everything that a game can make of it. */
static void check_hard(const lmb_sh3 *light, lmb_vec3 n_v, float cone_cos, const char *what, int k)
{
    const lmb_vec3 n = {0.36f, 0.48f, 0.8f};
    const lmb_sh3_rgb rgb = {{*light, *light, *light}};
    const lmb_hhd hhd = lmb_hhd_solve(lmb_moments_from_probe(light, n_v, cone_cos), n_v);
    check_light(lmb_hhd_evaluate(&hhd, n_v, n), what, k);
    const lmb_irradz irradz = lmb_irradz_from_probe(&rgb, n_v, cone_cos);
    const lmb_hhd_rgb decoded = lmb_irradz_decode(&irradz, n_v);
    check_light(irradz.irradiance_z.c[0], what, k);
    check_light(lmb_hhd_rgb_evaluate(&decoded, n_v, n).c[1], what, k);
    const lmb_hlsh_rgb hlsh = lmb_hlsh_rgb_from_probe(&rgb, n_v, cone_cos);
    check_light(lmb_hlsh_rgb_evaluate(&hlsh, n_v, n).c[2], what, k);
}

static void test_hard_light(void)
{
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    for (int degrees = 0; degrees <= 180; ++degrees) {
        lmb_sh3 light = {{0.0f}};
        const float angle = (float)(degrees * ORACLE_PI / 180.0);
        lmb_sh3_add_light(&light, (lmb_vec3){sinf(angle), cosf(angle), 0.0f}, 1e6f);
        for (int c = 0; c <= 4; ++c) {
            check_hard(&light, up, 0.25f * (float)c, "degrees", degrees);
        }
    }
    uint64_t random = 15;
    for (int k = 0; k < 200000; ++k) {
        lmb_sh3 light;
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const double u = oracle_random(&random);
            light.c[i] = k % 2 || u < 0.5 ? (float)(4.0 * u - 2.0)
                                          : oracle_nasty[(int)(oracle_random(&random) * ORACLE_NASTY_COUNT)];
        }
        lmb_vec3 n_v;
        oracle_random_normal(&random, &n_v);
        if (k % 3 == 0) {
            const float stretch = oracle_nasty[k / 3 % ORACLE_NASTY_COUNT];
            n_v = (lmb_vec3){stretch * n_v.x, stretch * n_v.y, n_v.z};
        }
        const float cone_cos = k % 5 ? 0.0f : oracle_nasty[k / 5 % ORACLE_NASTY_COUNT];
        check_hard(&light, n_v, cone_cos, "set", k);
    }
}

/* A sky of a gradient and a lamp or sun of any width, sampled; with `wall`, what a probe just above a floor sees. */
enum { SKY_LIGHTS = 600 };
typedef struct sky_light {
    ovec direction;
    double weight;
} sky_light;

static void sky_make(uint64_t *random, sky_light light[SKY_LIGHTS])
{
    const ovec up = oracle_random_direction(random), sun = oracle_random_direction(random);
    const double zenith = oracle_random(random), ground = oracle_random(random);
    const double width = oracle_random(random) * oracle_random(random), power = 20.0 * oracle_random(random) - 4.0;
    for (int i = 0; i < SKY_LIGHTS; ++i) {
        const ovec d = oracle_random_direction(random);
        if (i < SKY_LIGHTS * 5 / 6) {
            const double t = ovec_dot(up, d);
            light[i] = (sky_light){d, (t > 0.0 ? 0.5 + (zenith - 0.5) * t : ground) / (SKY_LIGHTS * 5.0 / 6.0)};
        } else {
            light[i] = (sky_light){ovec_unit(ovec_mix(sun, 1.0, d, width)), fmax(power, 0.0) / (SKY_LIGHTS / 6.0)};
        }
    }
}

typedef struct squares {
    double reference, rule, gram, hlsh, hlsh_t1;
} squares;

/* Errors of one sky on normals over the hemisphere. */
static void sky_errors(const sky_light light[SKY_LIGHTS], ovec n, bool wall, double cone_cos, squares *sum)
{
    lmb_sh3 sh = {{0.0f}};
    double i_z = 0.0;
    for (int i = 0; i < SKY_LIGHTS; ++i) {
        const double z = ovec_dot(light[i].direction, n);
        i_z += light[i].weight * fmax(z, 0.0) / ORACLE_PI;
        if (z > 0.0 || !wall) {
            lmb_sh3_add_light(&sh, ovec_float(light[i].direction), (float)light[i].weight);
        }
    }
    if (wall) {
        /* Radiance I_z/2 in the lower hemisphere: integrals of the basis there are sqrt(pi) and -sqrt(3 pi)/2 along n.
         */
        sh.c[0] += (float)(0.5 * i_z * sqrt(ORACLE_PI));
        const double linear = 0.25 * i_z * sqrt(3.0 * ORACLE_PI);
        sh.c[1] += (float)(linear * n.y);
        sh.c[2] -= (float)(linear * n.z);
        sh.c[3] += (float)(linear * n.x);
    }
    const lmb_vec3 n_v = ovec_float(n);
    const float c = (float)cone_cos;
    const lmb_hhd rule = lmb_hhd_solve(lmb_moments_from_probe(&sh, n_v, c), n_v);
    const lmb_hhd papers = lmb_hhd_solve(gram(&sh, n_v, c), n_v);
    const lmb_hlsh hlsh = lmb_hlsh_from_probe(&sh, n_v, c), t1 = lmb_hlsh_from_sh3(&sh, n_v, c);
    const orule normals = oracle_zone(n, 0.0, 1.0, 3, 8);
    for (size_t k = 0; k < normals.count; ++k) {
        const lmb_vec3 normal = ovec_float(normals.nodes[k].direction);
        double truth = 0.0;
        for (int i = 0; i < SKY_LIGHTS; ++i) {
            const bool seen = ovec_dot(light[i].direction, n) > cone_cos;
            truth +=
                seen ? light[i].weight * fmax(ovec_dot(light[i].direction, ovec_of(normal)), 0.0) / ORACLE_PI : 0.0;
        }
        sum->reference += truth * truth;
        sum->rule += pow((double)lmb_hhd_evaluate(&rule, n_v, normal) - truth, 2.0);
        sum->gram += pow((double)lmb_hhd_evaluate(&papers, n_v, normal) - truth, 2.0);
        sum->hlsh += pow((double)lmb_hlsh_evaluate(&hlsh, n_v, normal) - truth, 2.0);
        sum->hlsh_t1 += pow((double)lmb_hlsh_evaluate(&t1, n_v, normal) - truth, 2.0);
    }
    oracle_rule_free(normals);
}

/* Skies that nothing was fitted to: the rule is much nearer to the truth than Gram, in the open, above a wall, and
 * behind cones. */
static void test_errors_fall(void)
{
    static const struct {
        const char *name;
        bool wall;
        double cone_cos, most; /* of Gram's error */
    } cases[] = {
        {"open", false, 0.0, 0.7}, {"wall", true, 0.0, 0.6}, {"cone", false, 0.4, 0.7}, {"narrow", true, 0.8, 0.8}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        uint64_t random = 2024;
        squares sum = {0.0, 0.0, 0.0, 0.0, 0.0};
        for (int k = 0; k < 600; ++k) {
            sky_light light[SKY_LIGHTS];
            sky_make(&random, light);
            sky_errors(light, oracle_random_direction(&random), cases[i].wall, cases[i].cone_cos, &sum);
        }
        const double rule = sqrt(sum.rule / sum.gram), hlsh = sqrt(sum.hlsh / sum.hlsh_t1);
        printf("%s: %.3f of Gram's error %.3f; HLSH %.3f of %.3f\n", cases[i].name, rule,
               sqrt(sum.gram / sum.reference), hlsh, sqrt(sum.hlsh_t1 / sum.reference));
        CHECK(rule < cases[i].most, "%s: %g of Gram's error", cases[i].name, rule);
        CHECK(hlsh < 0.95, "%s: %g of the error of HLSH by Gram", cases[i].name, hlsh);
    }
}

static const test_case cases[] = {
    {"matches_local_frame", test_matches_local_frame},
    {"turns_and_mirrors", test_turns_and_mirrors},
    {"scales_with_light", test_scales_with_light},
    {"even_light_is_exact", test_even_light_is_exact},
    {"continuous", test_continuous},
    {"hlsh_fits_hhd", test_hlsh_fits_hhd},
    {"hard_light", test_hard_light},
    {"errors_fall", test_errors_fall},
};

TEST_MAIN(cases)
