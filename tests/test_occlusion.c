/* lambent/occlusion.h against quadrature over cones and GSL's dense linear algebra. */
#include "harness.h"
#include "sh_oracle.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>

#include <lambent/occlusion.h>

static const double cone_cosines[] = {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0};
enum { CONE_COUNT = sizeof cone_cosines / sizeof cone_cosines[0] };

/* integral over the cone of f Y_i */
static void clip_by_quadrature(const double c[9], ovec axis, double cone_cos, double clipped[9])
{
    const orule cone = oracle_zone(axis, cone_cos, 1.0, 8, 16);
    memset(clipped, 0, 9 * sizeof clipped[0]);
    for (size_t k = 0; k < cone.count; ++k) {
        double basis[9];
        oracle_basis(cone.nodes[k].direction, basis);
        const double light = cone.nodes[k].weight * oracle_evaluate(c, cone.nodes[k].direction);
        for (int i = 0; i < 9; ++i) {
            clipped[i] += light * basis[i];
        }
    }
    oracle_rule_free(cone);
}

static void hemisphere_gram(ovec axis, double cone_cos, gsl_matrix *gram)
{
    const orule cone = oracle_zone(axis, cone_cos, 1.0, 8, 16);
    gsl_matrix_set_zero(gram);
    for (size_t k = 0; k < cone.count; ++k) {
        double basis[9];
        oracle_basis(cone.nodes[k].direction, basis);
        for (size_t i = 0; i < 9; ++i) {
            for (size_t j = 0; j < 9; ++j) {
                *gsl_matrix_ptr(gram, i, j) += cone.nodes[k].weight * basis[i] * basis[j];
            }
        }
    }
    oracle_rule_free(cone);
}

static void test_multiply_is_the_clipped_projection(void)
{
    uint64_t random = 11;
    for (int k = 0; k < 400; ++k) {
        double c[9], expected[9];
        const lmb_sh3 radiance = oracle_random_sh3(&random, 0.5, c);
        lmb_vec3 axis;
        const ovec a = oracle_random_normal(&random, &axis);
        const double cone_cos = (double)(float)cone_cosines[k % CONE_COUNT];
        clip_by_quadrature(c, a, cone_cos, expected);
        const lmb_sh2 actual = lmb_sh3_multiply_cone(&radiance, axis, (float)cone_cos);
        const double solid_angle_share = 1.0 - cone_cos;
        for (int i = 0; i < 4; ++i) {
            CHECK_NEAR(actual.c[i], expected[i], 1e-6 + 2e-6 * solid_angle_share, "set %d, cone %g, coefficient %d", k,
                       cone_cos, i);
        }
    }
}

/* Entries of G(c) read off by unit sets about +z, where the local frame is the world's. */
static void test_gram_entries(void)
{
    static const struct {
        int from, to;
        double at_zero;
    } entries[] = {
        {0, 0, 0.5},
        {0, 2, 0.43301270189221932}, /* sqrt3/4 */
        {6, 0, 0.0},
        {2, 2, 0.5},
        {6, 2, 0.24206145913796356}, /* sqrt15/16 */
        {3, 3, 0.5},
        {1, 1, 0.5},
        {7, 3, 0.41926274578121062}, /* 3 sqrt5/16 */
        {5, 1, 0.41926274578121062},
        {7, 1, 0.0},
        {4, 1, 0.0},
        {8, 0, 0.0},
    };
    for (size_t k = 0; k < sizeof entries / sizeof entries[0]; ++k) {
        lmb_sh3 unit = {{0}};
        unit.c[entries[k].from] = 1.0f;
        double c[9] = {0};
        c[entries[k].from] = 1.0;
        for (int i = 0; i < CONE_COUNT; ++i) {
            double expected[9];
            clip_by_quadrature(c, (ovec){0, 0, 1}, cone_cosines[i], expected);
            const lmb_sh2 actual = lmb_sh3_multiply_cone(&unit, (lmb_vec3){0, 0, 1}, (float)cone_cosines[i]);
            CHECK_NEAR(actual.c[entries[k].to], expected[entries[k].to], 2e-7, "G %d %d at c = %g", entries[k].from,
                       entries[k].to, cone_cosines[i]);
        }
        const lmb_sh2 hemisphere = lmb_sh3_multiply_cone(&unit, (lmb_vec3){0, 0, 1}, 0.0f);
        CHECK_NEAR(hemisphere.c[entries[k].to], entries[k].at_zero, 1e-7, "G %d %d at c = 0", entries[k].from,
                   entries[k].to);
    }
}

static void test_cone_cosine_is_clamped(void)
{
    uint64_t random = 12;
    double c[9];
    const lmb_sh3 radiance = oracle_random_sh3(&random, 1.0, c);
    const lmb_vec3 axis = {0.0f, 0.8f, 0.6f};
    const lmb_sh2 open = lmb_sh3_multiply_cone(&radiance, axis, 0.0f);
    static const float below[] = {-0.0f, -1e-6f, -0.5f, -INFINITY, NAN};
    for (size_t k = 0; k < sizeof below / sizeof below[0]; ++k) {
        const lmb_sh2 clamped = lmb_sh3_multiply_cone(&radiance, axis, below[k]);
        for (int i = 0; i < 4; ++i) {
            CHECK(clamped.c[i] == open.c[i], "c = %g, coefficient %d", (double)below[k], i);
        }
    }
    static const float above[] = {1.0f, 1.0000001f, 2.0f, INFINITY};
    for (size_t k = 0; k < sizeof above / sizeof above[0]; ++k) {
        const lmb_sh2 closed = lmb_sh3_multiply_cone(&radiance, axis, above[k]);
        for (int i = 0; i < 4; ++i) {
            CHECK(closed.c[i] == 0.0f, "c = %g, coefficient %d", (double)above[k], i);
        }
    }
}

/* Cone cosine -> visibility by quadrature -> cone cosine. */
static void test_visibility_to_cone(void)
{
    static const double bends[] = {0.0, 0.2, 0.5};
    for (int k = 0; k < CONE_COUNT; ++k) {
        const double c = cone_cosines[k];
        const ovec n = {0, 0, 1};
        for (size_t b = 0; b < sizeof bends / sizeof bends[0]; ++b) {
            if (acos(c) + bends[b] > ORACLE_PI / 2.0) {
                continue; /* the cone would reach below the horizon */
            }
            const ovec axis = {sin(bends[b]), 0.0, cos(bends[b])};
            const orule cone = oracle_zone(axis, c, 1.0, 8, 16);
            double cosine_weighted = 0.0, uniform = 0.0;
            for (size_t i = 0; i < cone.count; ++i) {
                cosine_weighted += cone.nodes[i].weight * ovec_dot(cone.nodes[i].direction, n) / ORACLE_PI;
                uniform += cone.nodes[i].weight / (2.0 * ORACLE_PI);
            }
            oracle_rule_free(cone);
            const float bent = lmb_cone_cos_from_bent_visibility((float)cosine_weighted, (float)axis.z);
            CHECK_NEAR(bent, c, c < 0.2 ? 2e-6 : 1e-6, "cone %g bent by %g", c, bends[b]);
            CHECK_NEAR(lmb_cone_cos_from_solid_angle_visibility((float)uniform), c, 1e-6, "cone %g", c);
            if (b == 0) {
                CHECK_NEAR(lmb_cone_cos_from_visibility((float)cosine_weighted), c, 2e-6, "cone %g", c);
            }
        }
    }
    CHECK_NEAR(lmb_cone_cos_from_visibility(0.5f), sqrt(0.5), 1e-7, "45 degrees");
    CHECK_NEAR(lmb_cone_cos_from_solid_angle_visibility(0.5f), 0.5, 1e-7, "60 degrees");
}

static void test_visibility_outside_its_range(void)
{
    static const struct {
        float visibility, cone_cos;
    } cases[] = {{1.0f, 0}, {1.00001f, 0}, {2.0f, 0},  {INFINITY, 0}, {NAN, 0},
                 {0.0f, 1}, {-1e-6f, 1},   {-3.0f, 1}, {-INFINITY, 1}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        const float v = cases[k].visibility;
        CHECK(lmb_cone_cos_from_visibility(v) == cases[k].cone_cos, "V = %g", (double)v);
        CHECK(lmb_cone_cos_from_solid_angle_visibility(v) == cases[k].cone_cos, "V = %g", (double)v);
        CHECK(lmb_cone_cos_from_bent_visibility(v, 0.5f) == cases[k].cone_cos, "V = %g", (double)v);
    }
    CHECK(lmb_cone_cos_from_bent_visibility(0.6f, 0.5f) == 0.0f, "more than the bent hemisphere shows");
    for (int i = 0; i < ORACLE_NASTY_COUNT; ++i) {
        for (int j = 0; j < ORACLE_NASTY_COUNT; ++j) {
            const float c = lmb_cone_cos_from_bent_visibility(oracle_nasty[i], oracle_nasty[j]);
            CHECK(c >= 0.0f && c <= 1.0f, "V = %g, b.n = %g: %g", (double)oracle_nasty[i], (double)oracle_nasty[j],
                  (double)c);
        }
    }
}

/* Light from each axis: the multiply keeps what is above the horizon on the right side. */
static void test_a_light_on_each_axis_stays_on_its_side(void)
{
    static const lmb_vec3 axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int light = 0; light < 6; ++light) {
        lmb_sh3 radiance = {{0}};
        lmb_sh3_add_light(&radiance, axes[light], 1.0f);
        for (int n = 0; n < 6; ++n) {
            const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance, axes[n], 0.0f);
            const lmb_vec3 v = {-clipped.c[3], -clipped.c[1], clipped.c[2]};
            const float towards = v.x * axes[light].x + v.y * axes[light].y + v.z * axes[light].z;
            if (n == (light ^ 1)) {
                CHECK(fabsf(towards) < 0.1f, "light %d, normal %d: %g", light, n, (double)towards);
            } else {
                CHECK(towards > 0.2f, "light %d, normal %d: %g", light, n, (double)towards);
            }
        }
    }
}

static void test_fit_is_the_dense_solve(void)
{
    uint64_t random = 13;
    gsl_matrix *gram = gsl_matrix_alloc(9, 9);
    gsl_vector *moments = gsl_vector_alloc(9), *solution = gsl_vector_alloc(9);
    gsl_permutation *permutation = gsl_permutation_alloc(9);
    for (int k = 0; k < 500; ++k) {
        double c[9];
        const lmb_sh3 input = oracle_random_sh3(&random, 0.0, c);
        lmb_vec3 normal;
        ovec n = oracle_random_normal(&random, &normal);
        if (k < 6) {
            n = (ovec){k / 2 == 0 ? 1 - k % 2 * 2 : 0, k / 2 == 1 ? 1 - k % 2 * 2 : 0, k / 2 == 2 ? 1 - k % 2 * 2 : 0};
            normal = ovec_float(n);
        }
        hemisphere_gram(n, 0.0, gram);
        for (size_t i = 0; i < 9; ++i) {
            gsl_vector_set(moments, i, c[i]);
        }
        int sign;
        gsl_linalg_LU_decomp(gram, permutation, &sign);
        gsl_linalg_LU_solve(gram, permutation, moments, solution);
        const lmb_sh3 actual = lmb_sh3_fit_hemisphere(&input, normal);
        for (size_t i = 0; i < 9; ++i) {
            CHECK_NEAR(actual.c[i], gsl_vector_get(solution, i), 4e-5, "set %d, normal %g %g %g, coefficient %zu", k,
                       n.x, n.y, n.z, i);
        }
    }
    gsl_permutation_free(permutation);
    gsl_vector_free(solution);
    gsl_vector_free(moments);
    gsl_matrix_free(gram);
}

/* What the hemisphere sees of a quadratic polynomial determines it. */
static void test_fit_recovers_a_polynomial(void)
{
    uint64_t random = 14;
    for (int k = 0; k < 200; ++k) {
        double c[9], moments[9];
        (void)oracle_random_sh3(&random, 1.0, c);
        lmb_vec3 normal;
        const ovec n = oracle_random_normal(&random, &normal);
        clip_by_quadrature(c, n, 0.0, moments);
        lmb_sh3 input;
        for (int i = 0; i < 9; ++i) {
            input.c[i] = (float)moments[i];
        }
        const lmb_sh3 fit = lmb_sh3_fit_hemisphere(&input, normal);
        for (int i = 0; i < 9; ++i) {
            CHECK_NEAR(fit.c[i], c[i], 1e-4, "set %d, coefficient %d", k, i);
        }
    }
}

/* The fit is ill-conditioned: a normal that is unit only roughly must not be taken at its word. */
static void test_fit_mends_its_normal(void)
{
    static const float lengths[] = {1e-30f, 0.01f, 0.999f, 1.0001f, 2.0f, 1e30f};
    uint64_t random = 15;
    double c[9];
    const lmb_sh3 input = oracle_random_sh3(&random, 1.0, c);
    const lmb_vec3 normal = {0.48f, -0.6f, 0.64f};
    const lmb_sh3 expected = lmb_sh3_fit_hemisphere(&input, normal);
    for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; ++k) {
        const float s = lengths[k];
        const lmb_sh3 fit = lmb_sh3_fit_hemisphere(&input, (lmb_vec3){s * normal.x, s * normal.y, s * normal.z});
        for (int i = 0; i < 9; ++i) {
            CHECK_NEAR(fit.c[i], expected.c[i], 1e-4, "length %g, coefficient %d", (double)s, i);
        }
    }
    for (int k = 0; k < ORACLE_NASTY_COUNT; ++k) {
        const lmb_sh3 fit = lmb_sh3_fit_hemisphere(&input, (lmb_vec3){oracle_nasty[k], 0.0f, 0.0f});
        for (int i = 0; i < 9; ++i) {
            CHECK(isfinite(fit.c[i]), "normal %g 0 0, coefficient %d", (double)oracle_nasty[k], i);
        }
    }
}

static void test_condition_numbers(void)
{
    static const struct {
        double cone_cos, condition, tolerance;
    } cases[] = {{0.0, 254.0, 1.0}, {0.5, 1.7e4, 500.0}, {0.8, 1.7e6, 5e4}};
    gsl_matrix *gram = gsl_matrix_alloc(9, 9);
    gsl_vector *values = gsl_vector_alloc(9);
    gsl_eigen_symm_workspace *workspace = gsl_eigen_symm_alloc(9);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        hemisphere_gram((ovec){0, 0, 1}, cases[k].cone_cos, gram);
        gsl_eigen_symm(gram, values, workspace);
        CHECK_NEAR(gsl_vector_max(values) / gsl_vector_min(values), cases[k].condition, cases[k].tolerance, "c = %g",
                   cases[k].cone_cos);
    }
    gsl_eigen_symm_free(workspace);
    gsl_vector_free(values);
    gsl_matrix_free(gram);
}

static const test_case cases[] = {
    {"multiply is the clipped projection", test_multiply_is_the_clipped_projection},
    {"Gram entries", test_gram_entries},
    {"cone cosine is clamped", test_cone_cosine_is_clamped},
    {"visibility to cone", test_visibility_to_cone},
    {"visibility outside its range", test_visibility_outside_its_range},
    {"a light on each axis stays on its side", test_a_light_on_each_axis_stays_on_its_side},
    {"hemispherical fit is the dense solve", test_fit_is_the_dense_solve},
    {"hemispherical fit recovers a polynomial", test_fit_recovers_a_polynomial},
    {"hemispherical fit mends its normal", test_fit_mends_its_normal},
    {"condition numbers of the Gram matrix", test_condition_numbers},
};

TEST_MAIN(cases)
