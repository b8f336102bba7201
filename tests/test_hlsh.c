/* lambent/hlsh.h against its definition: clip, truncate, convolve and fit, each by quadrature and dense solves. */
#include "harness.h"
#include "sh_oracle.h"

#include <float.h>

#include <gsl/gsl_linalg.h>

#include <lambent/hlsh.h>

/* I_z, C_a and the tangential vector, in double. */
typedef struct oracle_hlsh {
    double irradiance_z, ambient;
    ovec tangential;
} oracle_hlsh;

/* Least squares of C_a (1 - t) + c_x x + c_y y against irradiance - I_z t at the hemisphere's nodes. */
static oracle_hlsh fit_with_fixed_z(const orule *hemisphere, ovec n, const double *irradiance, double irradiance_z)
{
    ovec x, y;
    ovec_frame(n, &x, &y);
    double normal_matrix[9] = {0}, right[3] = {0}, solution[3];
    for (size_t k = 0; k < hemisphere->count; ++k) {
        const onode node = hemisphere->nodes[k];
        const double t = ovec_dot(node.direction, n);
        const double basis[3] = {1.0 - t, ovec_dot(node.direction, x), ovec_dot(node.direction, y)};
        for (int i = 0; i < 3; ++i) {
            right[i] += node.weight * basis[i] * (irradiance[k] - irradiance_z * t);
            for (int j = 0; j < 3; ++j) {
                normal_matrix[3 * i + j] += node.weight * basis[i] * basis[j];
            }
        }
    }
    gsl_matrix_view a = gsl_matrix_view_array(normal_matrix, 3, 3);
    gsl_vector_view b = gsl_vector_view_array(right, 3), s = gsl_vector_view_array(solution, 3);
    gsl_linalg_HH_solve(&a.matrix, &b.vector, &s.vector);
    return (oracle_hlsh){irradiance_z, solution[0], ovec_mix(x, solution[1], y, solution[2])};
}

/* Target T1: clip the polynomial by the cone, truncate to SH3, convolve, fit with I_z exact. */
static oracle_hlsh truncated_target(const double c[9], ovec n, double cone_cos)
{
    static const double convolve[9] = {1.0, 2 / 3.0, 2 / 3.0, 2 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25};
    const orule cone = oracle_zone(n, cone_cos, 1.0, 8, 16);
    double clipped[9] = {0}, irradiance_z = 0.0;
    for (size_t k = 0; k < cone.count; ++k) {
        double basis[9];
        oracle_basis(cone.nodes[k].direction, basis);
        const double light = cone.nodes[k].weight * oracle_evaluate(c, cone.nodes[k].direction);
        irradiance_z += light * ovec_dot(cone.nodes[k].direction, n) / ORACLE_PI;
        for (int i = 0; i < 9; ++i) {
            clipped[i] += light * basis[i] * convolve[i];
        }
    }
    oracle_rule_free(cone);
    const orule hemisphere = oracle_zone(n, 0.0, 1.0, 8, 16);
    double irradiance[8 * 16];
    for (size_t k = 0; k < hemisphere.count; ++k) {
        irradiance[k] = oracle_evaluate(clipped, hemisphere.nodes[k].direction);
    }
    const oracle_hlsh fit = fit_with_fixed_z(&hemisphere, n, irradiance, irradiance_z);
    oracle_rule_free(hemisphere);
    return fit;
}

static void check_hlsh(const lmb_hlsh *actual, const oracle_hlsh *expected, double tolerance, const char *what, int k)
{
    CHECK_NEAR(actual->irradiance_z, expected->irradiance_z, tolerance, "%s %d", what, k);
    CHECK_NEAR(actual->ambient, expected->ambient, tolerance, "%s %d", what, k);
    CHECK_NEAR(actual->tangential.x, expected->tangential.x, tolerance, "%s %d", what, k);
    CHECK_NEAR(actual->tangential.y, expected->tangential.y, tolerance, "%s %d", what, k);
    CHECK_NEAR(actual->tangential.z, expected->tangential.z, tolerance, "%s %d", what, k);
}

static void test_from_sh3_is_the_truncated_target(void)
{
    static const double cone_cosines[] = {0.0, 0.05, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0};
    uint64_t random = 21;
    for (int k = 0; k < 400; ++k) {
        double c[9];
        const lmb_sh3 radiance = oracle_random_sh3(&random, 1.0, c);
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        const double cone_cos = (double)(float)cone_cosines[k % 8];
        const oracle_hlsh expected = truncated_target(c, n, cone_cos);
        const lmb_hlsh actual = lmb_hlsh_from_sh3(&radiance, normal, (float)cone_cos);
        check_hlsh(&actual, &expected, 1e-7 + 1e-6 * (1.0 - cone_cos), "set", k);
        const lmb_sh3_rgb rgb = {{radiance, {{0}}, radiance}};
        const lmb_hlsh_rgb coloured = lmb_hlsh_rgb_from_sh3(&rgb, normal, (float)cone_cos);
        CHECK(memcmp(&coloured.channel[2], &actual, sizeof actual) == 0, "set %d: colour differs", k);
        CHECK(coloured.channel[1].irradiance_z == 0.0f && coloured.channel[1].ambient == 0.0f, "set %d", k);
    }
}

/* The published hemisphere weights, read off by unit sets about +z. */
static void test_hemisphere_weights(void)
{
    static const struct {
        int coefficient;
        double irradiance_z, ambient, tangential_x;
    } rows[] = {
        {0, 0.2820948, 0.1410474, 0.0},
        {2, 0.3257350, 0.0874777, 0.0},
        {6, 0.1576958, -0.0689919, 0.0},
        {3, 0.0, 0.0, -0.2058111}, /* the world's l11 is negative towards +x */
        {7, 0.0, 0.0, -0.1877818},
        {4, 0.0, 0.0, 0.0},
        {8, 0.0, 0.0, 0.0},
    };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; ++k) {
        lmb_sh3 unit = {{0}};
        unit.c[rows[k].coefficient] = 1.0f;
        const lmb_hlsh hlsh = lmb_hlsh_from_sh3(&unit, (lmb_vec3){0, 0, 1}, 0.0f);
        CHECK_NEAR(hlsh.irradiance_z, rows[k].irradiance_z, 1e-7, "coefficient %d", rows[k].coefficient);
        CHECK_NEAR(hlsh.ambient, rows[k].ambient, 1e-7, "coefficient %d", rows[k].coefficient);
        CHECK_NEAR(hlsh.tangential.x, rows[k].tangential_x, 1e-7, "coefficient %d", rows[k].coefficient);
        CHECK_NEAR(hlsh.tangential.y, 0.0, 1e-7, "coefficient %d", rows[k].coefficient);
    }
}

/* A delta light at every angle: its true irradiance max(0, n.w)/pi, fitted by quadrature. */
static void test_add_light_is_the_least_squares_projector(void)
{
    enum { COSINES = 96, TURNS = 192 };
    static double irradiance[COSINES * TURNS];
    uint64_t random = 22;
    for (int degrees = 0; degrees <= 180; degrees += 5) {
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        ovec x, y;
        ovec_frame(n, &x, &y);
        const double angle = degrees * ORACLE_PI / 180.0;
        const lmb_vec3 direction = ovec_float(ovec_mix(n, cos(angle), x, sin(angle)));
        const ovec light = ovec_of(direction);
        const double irradiance_z = fmax(0.0, ovec_dot(light, n)) / ORACLE_PI;
        const orule hemisphere = oracle_zone(n, 0.0, 1.0, COSINES, TURNS);
        for (size_t k = 0; k < hemisphere.count; ++k) {
            const bool above = degrees < 90; /* light from below the surface is not there at all */
            irradiance[k] = above ? fmax(0.0, ovec_dot(hemisphere.nodes[k].direction, light)) / ORACLE_PI : 0.0;
        }
        const oracle_hlsh expected = fit_with_fixed_z(&hemisphere, n, irradiance, degrees < 90 ? irradiance_z : 0.0);
        oracle_rule_free(hemisphere);
        if (degrees == 90) {
            continue; /* on the edge itself rounding decides */
        }
        lmb_hlsh actual = {0};
        lmb_hlsh_add_light(&actual, normal, direction, 1.0f);
        check_hlsh(&actual, &expected, 1e-5, "degrees", degrees);
    }
}

/* The exact irradiance of each clipped basis function (target T2), in closed form: C_a of l0, l1z', l20' and the
 * tangential c of l1x', l21'. */
static void untruncated_target(double c, double target[5])
{
    const double a = acos(c), s = sin(a), q = pow(ORACLE_PI, 1.5);
    const double s2 = sin(2 * a), s4 = sin(4 * a), c2 = cos(2 * a), c3 = cos(3 * a);
    target[0] = (2 * a * (s * s - c * c) - 4 * a + 3 * ORACLE_PI * (1 - c) * (1 - c) + 3 * s2) / (8 * q);
    target[1] = sqrt(3.0) / q *
                (-a * c * c * c / 3 + ORACLE_PI * (3 * s * s + 2 * c * c * c - 2) / 8 - s * s * s / 9 + c * c * s / 3);
    target[2] = sqrt(5.0) / (256 * q) *
                (28 * a - 16 * a * c2 - 24 * a * c2 * c2 - 24 * s2 + 15 * s4 +
                 ORACLE_PI * (24 * c + 18 * c2 * c2 + 12 * c2 - 24 * c3 - 30));
    target[3] = sqrt(3.0) / (18 * q) *
                (9 * a * c - 3 * a * c * c * c + c * c * s - 7 * s + ORACLE_PI * (3 * c * c * c - 9 * c + 6));
    target[4] = sqrt(15.0) / (64 * q) * (3 * a + (2 * ORACLE_PI - 2 * a) * (1 - c2) * (1 - c2) - 2 * s2 + s4 / 4);
}

/* Lights add up: integrated over a cone about +z they give the untruncated target, which the truncated one meets within
 * 0.6 % at c = 0 and 3 % of the tangential part at c = 0.7. */
static void test_lights_integrate_to_the_untruncated_target(void)
{
    static const int coefficient[5] = {0, 2, 6, 3, 7};
    static const double sign[5] = {1, 1, 1, -1, -1}; /* Condon-Shortley against positive local axes */
    static const double cone_cosines[] = {0.0, 0.3, 0.7};
    const lmb_vec3 n_v = {0, 0, 1};
    for (int k = 0; k < 3; ++k) {
        const double c = cone_cosines[k];
        double target[5];
        untruncated_target(c, target);
        const orule cone = oracle_zone((ovec){0, 0, 1}, c, 1.0, 64, 16);
        for (int row = 0; row < 5; ++row) {
            double sum = 0.0; /* of small float steps, in double */
            for (size_t i = 0; i < cone.count; ++i) {
                double basis[9];
                oracle_basis(cone.nodes[i].direction, basis);
                lmb_hlsh one = {0};
                lmb_hlsh_add_light(&one, n_v, ovec_float(cone.nodes[i].direction),
                                   (float)(sign[row] * basis[coefficient[row]] * cone.nodes[i].weight));
                sum += (double)(row < 3 ? one.ambient : one.tangential.x);
            }
            CHECK_NEAR(sum, target[row], 2e-6, "row %d, c = %g", row, c);

            lmb_sh3 unit = {{0}};
            unit.c[coefficient[row]] = (float)sign[row];
            const lmb_hlsh truncated = lmb_hlsh_from_sh3(&unit, n_v, (float)c);
            if (row >= 3) {
                CHECK_NEAR(truncated.tangential.x, target[row], (k == 0 ? 0.006 : 0.03) * target[row],
                           "T1 and T2, row %d, c = %g", row, c);
            }
        }
        oracle_rule_free(cone);
    }
}

static void test_evaluate_is_the_model(void)
{
    uint64_t random = 23;
    for (int k = 0; k < 500; ++k) {
        double c[9];
        const lmb_sh3 radiance = oracle_random_sh3(&random, 3.0, c);
        lmb_vec3 n_v, normal;
        (void)oracle_random_normal(&random, &n_v);
        const ovec n = oracle_random_normal(&random, &normal);
        const lmb_hlsh h = lmb_hlsh_from_sh3(&radiance, n_v, 0.0f);
        CHECK_NEAR(lmb_hlsh_evaluate(&h, n_v, n_v), fmax(0.0, (double)h.irradiance_z), 1e-6, "I(n_v), set %d", k);
        const double t = ovec_dot(n, ovec_of(n_v));
        const ovec n_perp = ovec_mix(n, 1.0, ovec_of(n_v), -t);
        const double model =
            (double)h.irradiance_z * t + (double)h.ambient * (1.0 - t) + ovec_dot(n_perp, ovec_of(h.tangential));
        CHECK_NEAR(lmb_hlsh_evaluate(&h, n_v, normal), fmax(0.0, model), 2e-6, "set %d", k);
        const lmb_hlsh_rgb rgb = {{h, h, h}};
        CHECK(lmb_hlsh_rgb_evaluate(&rgb, n_v, normal).c[k % 3] == lmb_hlsh_evaluate(&h, n_v, normal), "set %d", k);
    }
}

static void test_a_light_on_each_axis(void)
{
    static const lmb_vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int light = 0; light < 6; ++light) {
        for (int n_v = 0; n_v < 6; ++n_v) {
            lmb_sh3 radiance = {{0}};
            lmb_sh3_add_light(&radiance, axes[light], (float)ORACLE_PI);
            const lmb_hlsh h = lmb_hlsh_from_sh3(&radiance, axes[n_v], 0.0f);
            const float towards = lmb_hlsh_evaluate(&h, axes[n_v], axes[light]);
            const float away = lmb_hlsh_evaluate(&h, axes[n_v], axes[light ^ 1]);
            if (n_v == (light ^ 1)) {
                /* What SH3 leaves behind the light: (1 - 2 + 5/4)/4. */
                CHECK_NEAR(h.irradiance_z, 0.0625, 1e-6, "light %d from behind", light);
            } else {
                CHECK(towards > 0.5f && away < 0.35f, "light %d, n_v %d: towards %g, away %g", light, n_v,
                      (double)towards, (double)away);
            }
        }
    }
}

/* Every kind of hostile light, through both ways in; evaluated at normals that are unit and at some that are not. */
static void test_evaluation_is_never_broken(void)
{
    uint64_t random = 24;
    for (int k = 0; k < 200000; ++k) {
        lmb_sh3 radiance;
        for (int j = 0; j < 9; ++j) {
            const size_t pick = (size_t)(oracle_random(&random) * ORACLE_NASTY_COUNT);
            radiance.c[j] =
                oracle_random(&random) < 0.5 ? (float)(2.0 * oracle_random(&random) - 1.0) : oracle_nasty[pick];
        }
        lmb_vec3 n_v, normal;
        (void)oracle_random_normal(&random, &n_v);
        (void)oracle_random_normal(&random, &normal);
        if (k % 4 == 1) {
            const float stretch = oracle_nasty[k / 4 % ORACLE_NASTY_COUNT];
            n_v = (lmb_vec3){n_v.x * stretch, n_v.y * stretch, n_v.z * stretch};
        } else if (k % 4 == 2) {
            normal.x = oracle_nasty[k / 4 % ORACLE_NASTY_COUNT];
        }
        const float cone_cos = k % 2 ? 0.0f : oracle_nasty[k / 2 % ORACLE_NASTY_COUNT];
        lmb_hlsh h = lmb_hlsh_from_sh3(&radiance, n_v, cone_cos);
        lmb_hlsh_add_light(&h, n_v, normal, radiance.c[0]);
        const float irradiance = lmb_hlsh_evaluate(&h, n_v, normal);
        CHECK(irradiance >= 0.0f && irradiance <= FLT_MAX, "case %d gives %g", k, (double)irradiance);
    }
}

static void test_simple_skies(void)
{
    const lmb_vec3 up = {0, 1, 0};
    const lmb_sh3 none = {{0}};
    const lmb_hlsh dark = lmb_hlsh_from_sh3(&none, up, 0.0f);
    CHECK(lmb_hlsh_evaluate(&dark, up, up) == 0.0f, "no light");
    lmb_hlsh nan_weight = {0};
    lmb_hlsh_add_light(&nan_weight, up, up, NAN);
    CHECK(lmb_hlsh_evaluate(&nan_weight, up, up) == 0.0f, "NaN gives 0");
    lmb_hlsh nan_direction = {0};
    lmb_hlsh_add_light(&nan_direction, up, (lmb_vec3){NAN, NAN, NAN}, 1.0f);
    CHECK(nan_direction.irradiance_z == 0.0f, "a light from nowhere adds nothing");

    /* Constant radiance over the hemisphere: I(n) = (1 + t)/2, which the model holds exactly. */
    const orule hemisphere = oracle_zone((ovec){0, 1, 0}, 0.0, 1.0, 48, 16);
    lmb_hlsh sky = {0};
    for (size_t i = 0; i < hemisphere.count; ++i) {
        lmb_hlsh_add_light(&sky, up, ovec_float(hemisphere.nodes[i].direction), (float)hemisphere.nodes[i].weight);
    }
    oracle_rule_free(hemisphere);
    CHECK_NEAR(sky.irradiance_z, 1.0, 1e-5, "white sky");
    CHECK_NEAR(sky.ambient, 0.5, 1e-5, "white sky");
    CHECK_NEAR(lmb_hlsh_evaluate(&sky, up, (lmb_vec3){1, 0, 0}), 0.5, 1e-5, "white sky");

    /* A sun of 1e6 beside candle light is still the sun, and its own irradiance is exact. */
    lmb_hlsh sun = {0};
    lmb_hlsh_add_light(&sun, up, up, 1e6f);
    lmb_hlsh_add_light(&sun, up, (lmb_vec3){1, 0, 0}, 1.0f);
    CHECK_NEAR(lmb_hlsh_evaluate(&sun, up, up), 1e6 / ORACLE_PI, 0.1, "sun");
}

static const test_case cases[] = {
    {"from SH3: clip, truncate, convolve, fit", test_from_sh3_is_the_truncated_target},
    {"hemisphere weights", test_hemisphere_weights},
    {"add_light is the least-squares projector", test_add_light_is_the_least_squares_projector},
    {"lights integrate to the untruncated target", test_lights_integrate_to_the_untruncated_target},
    {"evaluate is the model", test_evaluate_is_the_model},
    {"a light on each axis", test_a_light_on_each_axis},
    {"evaluation is never broken", test_evaluation_is_never_broken},
    {"simple skies", test_simple_skies},
};

TEST_MAIN(cases)
