#include "bake_internal.h"

/* Taylor series: at |x| <= pi/4 the next terms are below 2e-17. */
static double sine_series(double x)
{
    const double s = x * x;
    double sum = 0.0;
    for (int k = 8; k >= 1; --k) {
        sum = -(1.0 + sum) * s / (double)((2 * k) * (2 * k + 1));
    }
    return x * (1.0 + sum);
}

static double cosine_series(double x)
{
    const double s = x * x;
    double sum = 0.0;
    for (int k = 8; k >= 1; --k) {
        sum = -(1.0 + sum) * s / (double)((2 * k - 1) * (2 * k));
    }
    return 1.0 + sum;
}

void lmb_sincos(double angle_rad, double *sine, double *cosine)
{
    /* pi/2 in two parts (Cody and Waite 1980), so that the reduction keeps its last bits. */
    const double half_pi_high = 0x1.921fb54400000p+0;
    const double half_pi_low = 0x1.0b4611a626331p-34;
    const double turns = floor(angle_rad * (2.0 / LMB_PI) + 0.5);
    const double x = (angle_rad - turns * half_pi_high) - turns * half_pi_low;
    const double s = sine_series(x);
    const double c = cosine_series(x);
    switch ((int64_t)turns & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
        break;
    }
}

/* Inverse tangent of x in [0, 1]: two half-angle steps bring it below 0.2, where the series is short. */
static double atan_unit(double x)
{
    x = x / (1.0 + sqrt(1.0 + x * x));
    x = x / (1.0 + sqrt(1.0 + x * x));
    const double s = x * x;
    double sum = 0.0;
    for (int k = 11; k >= 0; --k) {
        sum = 1.0 / (double)(2 * k + 1) - s * sum;
    }
    return 4.0 * x * sum;
}

double lmb_atan2(double y, double x)
{
    const double ax = fabs(x);
    const double ay = fabs(y);
    if (!(ax + ay > 0.0)) {
        return 0.0;
    }
    double angle = ay <= ax ? atan_unit(ay / ax) : LMB_PI / 2.0 - atan_unit(ax / ay);
    angle = x < 0.0 ? LMB_PI - angle : angle;
    return y < 0.0 ? -angle : angle;
}

double lmb_acos(double x)
{
    x = x > 1.0 ? 1.0 : x < -1.0 ? -1.0 : x;
    return lmb_atan2(sqrt((1.0 - x) * (1.0 + x)), x);
}

/* The point at height z and azimuth 2 pi u of the unit sphere about `axis`. */
static lmb_vec3 direction_about(lmb_vec3 axis, float z, float u)
{
    double s, c;
    lmb_sincos(2.0 * LMB_PI * (double)u, &s, &c);
    const float r = sqrtf(fmaxf(0.0f, (1.0f - z) * (1.0f + z)));
    lmb_vec3 tangent, bitangent;
    vec3_frame(axis, &tangent, &bitangent);
    const lmb_vec3 flat = vec3_mad(vec3_scale(tangent, r * (float)c), bitangent, r * (float)s);
    return vec3_normalize_or(vec3_mad(flat, axis, z), axis);
}

lmb_vec3 lmb_sphere_sample(const float point[2])
{
    return direction_about(vec3(0.0f, 0.0f, 1.0f), 1.0f - 2.0f * point[0], point[1]);
}

lmb_vec3 lmb_hemisphere_sample(lmb_vec3 axis, const float point[2])
{
    /* The height's distribution function is (z + z^2)/2. */
    const float z = 0.5f * (sqrtf(9.0f - 8.0f * point[0]) - 1.0f);
    return direction_about(axis, z, point[1]);
}

lmb_vec3 lmb_cosine_sample(lmb_vec3 axis, const float point[2])
{
    return direction_about(axis, sqrtf(1.0f - point[0]), point[1]);
}
