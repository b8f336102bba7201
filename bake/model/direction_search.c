#include "model/direction_search.h"

#include <math.h>

#include "model/clipped.h"

/* Irradiance as a polynomial whose x axis is turned into a plane through z; what is odd in y meets nothing there. */
typedef struct plane_polynomial {
    float one, z, x, xz;
    float zonal;   /* of 3z^2 - 1 */
    float squares; /* of x^2 - y^2 */
} plane_polynomial;

static plane_polynomial polynomial_in_plane(const lmb_sh3 *e, float cosine, float sine)
{
    const float *c = e->c;
    return (plane_polynomial){
        .one = LMB_N0 * c[0],
        .z = LMB_N1 * c[2],
        .x = -LMB_N1 * (cosine * c[3] + sine * c[1]),
        .xz = -LMB_N2 * (cosine * c[7] + sine * c[5]),
        .zonal = LMB_N20 * c[6],
        .squares = LMB_N22 * (cosine * cosine - sine * sine) * c[8] + LMB_N2 * cosine * sine * c[4],
    };
}

/* Inner products over the hemisphere with max(0, n.d), d = (sin g, 0, cos g). The lune where both z and n.d are
 * positive is psi from g - pi/2 to pi/2, all beta in (0, pi), n = (sin beta sin psi, cos beta, sin beta cos psi). */
typedef struct lune {
    float one, z, x, xx, yy, zz, xz, self;
} lune;

static lune lune_of(float gamma)
{
    const float s = sinf(gamma), c = cosf(gamma), rest = LMB_PI_F - gamma, sixth = LMB_PI_F * (3.0f / 16.0f);
    const float cos2 = c * c - s * s, sin2 = 2.0f * s * c;
    return (lune){
        .one = 0.5f * LMB_PI_F * (1.0f + c),
        .z = (2.0f / 3.0f) * (s + rest * c),
        .x = (2.0f / 3.0f) * rest * s,
        .xx = sixth * (1.0f + c - (c + cos2) * (1.0f / 3.0f)),
        .zz = sixth * (1.0f + c + (c + cos2) * (1.0f / 3.0f)),
        .yy = 0.125f * LMB_PI_F * (1.0f + c),
        .xz = sixth * (2.0f * s + sin2) * (1.0f / 3.0f),
        .self = (2.0f / 3.0f) * (rest + s * c),
    };
}

/* With C_a = I_z - h C_d the model is I_z A + C_d g, A = a0 + a1 z, g = max(0, n.d) - h A: C_d is <E - I_z A, g>/<g,
 * g>, and takes C_d (2 <E - I_z A, g> - C_d <g, g>) off the squared error. */
typedef struct step {
    float directional;
    float gain;
} step;

static step step_at(const lmb_light_fit *fit, const plane_polynomial *e, float gamma)
{
    const lune with = lune_of(gamma);
    const float pi = LMB_PI_F, h = lmb_larger(cosf(gamma), 0.0f), a0 = fit->a0, a1 = fit->a1;
    const float e_light = e->one * with.one + e->z * with.z + e->x * with.x + e->xz * with.xz +
                          e->zonal * (3.0f * with.zz - with.one) + e->squares * (with.xx - with.yy);
    const float e_one = pi * (2.0f * e->one + e->z);
    const float e_z = pi * (e->one + (2.0f / 3.0f) * e->z + 0.5f * e->zonal);
    const float e_ambient = a0 * e_one + a1 * e_z;
    const float ambient_light = a0 * with.one + a1 * with.z;
    const float ambient_self = pi * (2.0f * a0 * a0 + 2.0f * a0 * a1 + (2.0f / 3.0f) * a1 * a1);
    const float product = e_light - h * e_ambient - fit->irradiance_z * (ambient_light - h * ambient_self);
    const float self = with.self - 2.0f * h * ambient_light + h * h * ambient_self;
    float directional = self > 0.0f ? lmb_larger(product / self, 0.0f) : 0.0f;
    if (directional * h > fit->irradiance_z) {
        directional = fit->irradiance_z / h;
    }
    return (step){directional, directional * (2.0f * product - directional * self)};
}

static lmb_vec3 direction_of(float cosine, float sine, float gamma)
{
    const float flat = sinf(gamma);
    return lmb_vec3_of(flat * cosine, flat * sine, cosf(gamma));
}

/* Golden section: the larger part of an interval. */
#define GOLDEN 0.61803399f

enum { ANGLE_STEPS = 18, PLANE_STEPS = 14, PLANES = 16 };

/* The angle from z of the largest gain in a plane, and that gain. */
static float angle_search(const lmb_light_fit *fit, const plane_polynomial *e, float *gain)
{
    float low = 0.0f, high = 0.5f * LMB_PI_F;
    float left = high - GOLDEN * (high - low), right = low + GOLDEN * (high - low);
    float left_gain = step_at(fit, e, left).gain, right_gain = step_at(fit, e, right).gain;
    for (int i = 0; i < ANGLE_STEPS; ++i) {
        if (left_gain > right_gain) {
            high = right;
            right = left;
            right_gain = left_gain;
            left = high - GOLDEN * (high - low);
            left_gain = step_at(fit, e, left).gain;
        } else {
            low = left;
            left = right;
            left_gain = right_gain;
            right = low + GOLDEN * (high - low);
            right_gain = step_at(fit, e, right).gain;
        }
    }
    *gain = lmb_larger(left_gain, right_gain);
    return 0.5f * (low + high);
}

float lmb_light_fit_directional(const lmb_light_fit *fit, lmb_vec3 direction)
{
    const float flat = sqrtf(direction.x * direction.x + direction.y * direction.y);
    const float cosine = flat > 0.0f ? direction.x / flat : 1.0f, sine = flat > 0.0f ? direction.y / flat : 0.0f;
    const plane_polynomial e = polynomial_in_plane(&fit->irradiance, cosine, sine);
    return step_at(fit, &e, atan2f(flat, direction.z)).directional;
}

lmb_vec3 lmb_light_fit_in_plane(const lmb_light_fit *fit)
{
    /* Of the linear band: where most of the irradiance comes from. */
    const float x = -fit->irradiance.c[3], y = -fit->irradiance.c[1], length = sqrtf(x * x + y * y);
    const float cosine = length > 0.0f ? x / length : 1.0f, sine = length > 0.0f ? y / length : 0.0f;
    const plane_polynomial e = polynomial_in_plane(&fit->irradiance, cosine, sine);
    float gain;
    return direction_of(cosine, sine, angle_search(fit, &e, &gain));
}

static float plane_search(const lmb_light_fit *fit, float azimuth, float *gamma)
{
    const plane_polynomial e = polynomial_in_plane(&fit->irradiance, cosf(azimuth), sinf(azimuth));
    float gain;
    *gamma = angle_search(fit, &e, &gain);
    return gain;
}

lmb_vec3 lmb_light_fit_anywhere(const lmb_light_fit *fit)
{
    const float apart = 2.0f * LMB_PI_F / PLANES;
    float gamma, best = 0.0f, best_gain = -1.0f;
    for (int i = 0; i < PLANES; ++i) {
        const float gain = plane_search(fit, apart * (float)i, &gamma);
        if (gain > best_gain) {
            best_gain = gain;
            best = apart * (float)i;
        }
    }
    float low = best - apart, high = best + apart;
    for (int i = 0; i < PLANE_STEPS; ++i) {
        const float left = high - GOLDEN * (high - low), right = low + GOLDEN * (high - low);
        if (plane_search(fit, left, &gamma) > plane_search(fit, right, &gamma)) {
            high = right;
        } else {
            low = left;
        }
    }
    const float azimuth = 0.5f * (low + high);
    plane_search(fit, azimuth, &gamma);
    return direction_of(cosf(azimuth), sinf(azimuth), gamma);
}
