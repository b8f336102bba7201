#include "fit_solve.h"

#include <math.h>
#include <stdbool.h>

#include <lambent/vector.h>

void fit_sectoral_times(const fit_sh3 *sh, const float *v, float *result)
{
    result[0] = sh->m[0] * v[0] + sh->m[1] * v[1];
    result[1] = sh->m[1] * v[0] - sh->m[0] * v[1];
}

static fit_moments gram_moments(const fit_sh3 *sh)
{
    const float c = sh->cone_cos, closing = 1.0f - c, sine_squared = closing * (1.0f + c);
    const float root_3 = sqrtf(3.0f), root_5 = sqrtf(5.0f), root_15 = sqrtf(15.0f);
    const float y0 = 0.5f * closing + 0.25f * root_3 * sine_squared * sh->l1_zonal +
                     0.25f * root_5 * c * sine_squared * sh->l2_zonal;
    const float y1 = 0.25f * root_3 * sine_squared + 0.5f * (1.0f - c * c * c) * sh->l1_zonal +
                     root_15 / 16.0f * sine_squared * (1.0f + 3.0f * c * c) * sh->l2_zonal;
    const float x_x = 0.25f * closing * closing * (2.0f + c);
    const float x_xz = 3.0f * root_5 / 16.0f * sine_squared * sine_squared;
    const float scale = 2.0f / sqrtf(3.0f * LMB_PI_F);
    return (fit_moments){2.0f / sqrtf(LMB_PI_F) * y0,
                         scale * y1,
                         {scale * (x_x * sh->v[0] + x_xz * sh->q[0]), scale * (x_x * sh->v[1] + x_xz * sh->q[1])}};
}

/* How far outputs reach: nothing is left of them where the cone closes, nor in light that is the same from everywhere,
 * of which Gram is right. */
typedef struct output_reach {
    float axial, tangential;
} output_reach;

static output_reach output_reach_of(const fit_sh3 *sh)
{
    const float c = sh->cone_cos, *v = sh->v, *q = sh->q, *m = sh->m;
    const float square = sh->l1_zonal * sh->l1_zonal + sh->l2_zonal * sh->l2_zonal + v[0] * v[0] + v[1] * v[1] +
                         q[0] * q[0] + q[1] * q[1] + m[0] * m[0] + m[1] * m[1];
    const float axial = (1.0f - c) * square / (square + FIT_EVEN_SQUARE);
    return (output_reach){axial, axial * sqrtf(1.0f - c * c)};
}

fit_moments fit_moments_of(const fit_sh3 *sh, const float *output)
{
    fit_moments moments = gram_moments(sh);
    if (output) {
        float qv[2];
        fit_sectoral_times(sh, sh->v, qv);
        const output_reach reach = output_reach_of(sh);
        moments.scalar += reach.axial * output[FIT_SCALAR];
        moments.zonal += reach.axial * output[FIT_ZONAL];
        for (int i = 0; i < 2; ++i) {
            moments.tangential[i] +=
                reach.tangential * (output[FIT_V] * sh->v[i] + output[FIT_Q] * sh->q[i] + output[FIT_QV] * qv[i]);
        }
    }
    return moments;
}

/* The cases of the sampler's solve. */
typedef enum hhd_case { HHD_DARK, HHD_PLAIN, HHD_DIRECTIONAL, HHD_HORIZONTAL } hhd_case;

typedef struct hhd_terms {
    hhd_case which;
    float i_z, x, root;
} hhd_terms;

static hhd_terms hhd_terms_of(const fit_moments *b)
{
    const float p_squared = b->tangential[0] * b->tangential[0] + b->tangential[1] * b->tangential[1];
    hhd_terms terms = {.which = HHD_PLAIN, .i_z = lmb_larger(b->zonal, 0.0f)};
    terms.x = b->scalar - 2.0f * terms.i_z;
    terms.root = sqrtf(terms.x * terms.x + 3.0f * p_squared);
    if (!(b->scalar > 0.0f)) {
        terms.which = HHD_DARK;
    } else if (p_squared + terms.i_z * terms.i_z > b->scalar * b->scalar) {
        terms.which = HHD_DIRECTIONAL;
    } else if (sqrtf(p_squared) < terms.x || !(terms.root > 0.0f)) {
        terms.which = HHD_HORIZONTAL;
    }
    return terms;
}

fit_light fit_solve(const fit_moments *moments)
{
    const hhd_terms terms = hhd_terms_of(moments);
    fit_light light = {0.0f, {moments->tangential[0], moments->tangential[1], 0.0f}};
    switch (terms.which) {
    case HHD_DARK:
        light.directional[0] = light.directional[1] = 0.0f;
        break;
    case HHD_DIRECTIONAL:
        light.directional[2] = terms.i_z;
        break;
    case HHD_HORIZONTAL:
        light.ambient = terms.i_z;
        break;
    case HHD_PLAIN:
        light.directional[2] = (terms.root - 2.0f * terms.x) / 3.0f;
        light.ambient = 0.5f * (moments->scalar - (2.0f * terms.root - terms.x) / 3.0f);
        break;
    }
    return light;
}

/* Of the moments, from those of the light. */
static fit_moments moments_slopes(const fit_moments *moments, const fit_light *slope)
{
    const hhd_terms terms = hhd_terms_of(moments);
    fit_moments back = {0.0f, 0.0f, {slope->directional[0], slope->directional[1]}};
    switch (terms.which) {
    case HHD_DARK:
        return (fit_moments){0.0f, 0.0f, {0.0f, 0.0f}};
    case HHD_DIRECTIONAL:
        back.zonal = slope->directional[2];
        break;
    case HHD_HORIZONTAL:
        back.zonal = slope->ambient;
        break;
    case HHD_PLAIN: {
        const float of_root = (slope->directional[2] - slope->ambient) / 3.0f;
        const float of_x = slope->ambient / 6.0f - 2.0f * slope->directional[2] / 3.0f + of_root * terms.x / terms.root;
        back.scalar = 0.5f * slope->ambient + of_x;
        back.zonal = -2.0f * of_x;
        back.tangential[0] += 3.0f * of_root * moments->tangential[0] / terms.root;
        back.tangential[1] += 3.0f * of_root * moments->tangential[1] / terms.root;
        break;
    }
    }
    if (!(moments->zonal > 0.0f)) {
        back.zonal = 0.0f;
    }
    return back;
}

void fit_slopes(const fit_sh3 *sh, const fit_moments *moments, const fit_light *slope, float *output_slope)
{
    const fit_moments back = moments_slopes(moments, slope);
    float qv[2];
    fit_sectoral_times(sh, sh->v, qv);
    const output_reach reach = output_reach_of(sh);
    const float *t = back.tangential;
    output_slope[FIT_SCALAR] = reach.axial * back.scalar;
    output_slope[FIT_ZONAL] = reach.axial * back.zonal;
    output_slope[FIT_V] = reach.tangential * (t[0] * sh->v[0] + t[1] * sh->v[1]);
    output_slope[FIT_Q] = reach.tangential * (t[0] * sh->q[0] + t[1] * sh->q[1]);
    output_slope[FIT_QV] = reach.tangential * (t[0] * qv[0] + t[1] * qv[1]);
}
