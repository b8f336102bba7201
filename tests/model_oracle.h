/* Oracles for rows of the table of models: light behind a cone by quadrature, a row on one normal, least squares over
 * the hemisphere. */
#ifndef LMB_TESTS_MODEL_ORACLE_H
#define LMB_TESTS_MODEL_ORACLE_H

#include <float.h>

#include <gsl/gsl_linalg.h>

#include <lambent/model.h>

#include "harness.h"
#include "sh_oracle.h"

static inline const lmb_model *oracle_row(const char *name)
{
    const lmb_model *model = lmb_model_find(name, 0);
    CHECK(model, "there is no %s", name);
    return model;
}

static inline lmb_sh3_rgb oracle_grey(lmb_sh3 sh)
{
    return (lmb_sh3_rgb){{sh, sh, sh}};
}

/* A row's answer for the green of `radiance`. */
static inline double oracle_answer(const lmb_model *model, const lmb_sh3_rgb *radiance, lmb_vec3 n_v, float cone_cos,
                                   lmb_vec3 normal)
{
    float channel[LMB_MODEL_MOST_CHANNELS];
    lmb_rgb irradiance;
    model->encode(radiance, n_v, cone_cos, channel);
    model->evaluate(channel, n_v, &normal, 1, &irradiance);
    return (double)irradiance.c[1];
}

/* SH coefficients of the polynomial of `bands` bands of c inside a cone. */
static inline void oracle_clip(const double c[9], int bands, ovec axis, double cone_cos, double clipped[9])
{
    double used[9] = {0.0};
    for (int i = 0; i < bands * bands; ++i) {
        used[i] = c[i];
    }
    const orule cone = oracle_zone(axis, cone_cos, 1.0, 8, 16);
    for (int i = 0; i < 9; ++i) {
        clipped[i] = 0.0;
    }
    for (size_t k = 0; k < cone.count; ++k) {
        double basis[9];
        oracle_basis(cone.nodes[k].direction, basis);
        const double light = cone.nodes[k].weight * oracle_evaluate(used, cone.nodes[k].direction);
        for (int i = 0; i < 9; ++i) {
            clipped[i] += light * basis[i];
        }
    }
    oracle_rule_free(cone);
}

/* Normalised irradiance of the first bands of radiance, not clamped. */
static inline double oracle_irradiance(const double c[9], int bands, ovec n)
{
    double basis[9], sum = 0.0;
    oracle_basis(n, basis);
    for (int i = 0; i < bands * bands; ++i) {
        sum += c[i] * basis[i] * (i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25);
    }
    return sum;
}

/* Normalised irradiance at the axis of what a cone about it lets through: the cosine is linear SH itself. */
static inline double oracle_irradiance_z(const double clipped[9], ovec axis)
{
    return ovec_dot((ovec){-clipped[3], -clipped[1], clipped[2]}, axis) * 2.0 / sqrt(3.0 * ORACLE_PI);
}

/* A function of a direction. */
typedef double (*oracle_function)(ovec n, const void *context);

/* Coefficients of the `count` functions that come closest to a target over the hemisphere of `axis`. */
static inline void oracle_least_squares(ovec axis, int count, const oracle_function *function, const void *context,
                                        oracle_function target, const void *target_context, double *coefficient)
{
    double gram[36] = {0.0}, moment[6] = {0.0};
    const orule rule = oracle_zone(axis, 0.0, 1.0, 24, 48);
    for (size_t k = 0; k < rule.count; ++k) {
        const ovec n = rule.nodes[k].direction;
        double value[6];
        for (int i = 0; i < count; ++i) {
            value[i] = function[i](n, context);
        }
        for (int i = 0; i < count; ++i) {
            moment[i] += rule.nodes[k].weight * value[i] * target(n, target_context);
            for (int j = 0; j < count; ++j) {
                gram[i * count + j] += rule.nodes[k].weight * value[i] * value[j];
            }
        }
    }
    oracle_rule_free(rule);
    gsl_matrix_view a = gsl_matrix_view_array(gram, (size_t)count, (size_t)count);
    gsl_vector_view b = gsl_vector_view_array(moment, (size_t)count);
    gsl_vector_view x = gsl_vector_view_array(coefficient, (size_t)count);
    gsl_linalg_HH_solve(&a.matrix, &b.vector, &x.vector);
}

#endif
