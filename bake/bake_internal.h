/* Vector arithmetic and repeatable trigonometry that the baker's own files share. */
#ifndef LMB_BAKE_INTERNAL_H
#define LMB_BAKE_INTERNAL_H

#include <math.h>

#include <lambent/scene.h>

#define LMB_PI 3.14159265358979323846
#define LMB_PI_F 3.14159265358979323846f

/* The larger and the smaller of two numbers: single instructions, which fmaxf and fminf with their rules for NaN are
 * not. */
static inline float float_larger(float a, float b)
{
    return a > b ? a : b;
}

static inline float float_smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline lmb_vec3 vec3(float x, float y, float z)
{
    const lmb_vec3 v = {x, y, z};
    return v;
}

static inline lmb_vec3 vec3_add(lmb_vec3 a, lmb_vec3 b)
{
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline lmb_vec3 vec3_sub(lmb_vec3 a, lmb_vec3 b)
{
    return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline lmb_vec3 vec3_smaller(lmb_vec3 a, lmb_vec3 b)
{
    return vec3(float_smaller(a.x, b.x), float_smaller(a.y, b.y), float_smaller(a.z, b.z));
}

static inline lmb_vec3 vec3_larger(lmb_vec3 a, lmb_vec3 b)
{
    return vec3(float_larger(a.x, b.x), float_larger(a.y, b.y), float_larger(a.z, b.z));
}

static inline lmb_vec3 vec3_scale(lmb_vec3 a, float s)
{
    return vec3(a.x * s, a.y * s, a.z * s);
}

/* a + b s */
static inline lmb_vec3 vec3_mad(lmb_vec3 a, lmb_vec3 b, float s)
{
    return vec3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}

static inline float vec3_dot(lmb_vec3 a, lmb_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline lmb_vec3 vec3_cross(lmb_vec3 a, lmb_vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float vec3_length(lmb_vec3 a)
{
    return sqrtf(vec3_dot(a, a));
}

/* Unit vector along `a`, or `fallback` when `a` has no direction. Safe for very small and very large vectors. */
static inline lmb_vec3 vec3_normalize_or(lmb_vec3 a, lmb_vec3 fallback)
{
    const double x = (double)a.x, y = (double)a.y, z = (double)a.z;
    const double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0.0) || !isfinite(length)) {
        return fallback;
    }
    return vec3((float)(x / length), (float)(y / length), (float)(z / length));
}

static inline lmb_vec3 affine_point(const lmb_affine *t, lmb_vec3 p)
{
    const double x = (double)p.x, y = (double)p.y, z = (double)p.z;
    return vec3((float)(t->m[0][0] * x + t->m[0][1] * y + t->m[0][2] * z + t->m[0][3]),
                (float)(t->m[1][0] * x + t->m[1][1] * y + t->m[1][2] * z + t->m[1][3]),
                (float)(t->m[2][0] * x + t->m[2][1] * y + t->m[2][2] * z + t->m[2][3]));
}

static inline lmb_vec3 affine_vector(const lmb_affine *t, lmb_vec3 v)
{
    const double x = (double)v.x, y = (double)v.y, z = (double)v.z;
    return vec3((float)(t->m[0][0] * x + t->m[0][1] * y + t->m[0][2] * z),
                (float)(t->m[1][0] * x + t->m[1][1] * y + t->m[1][2] * z),
                (float)(t->m[2][0] * x + t->m[2][1] * y + t->m[2][2] * z));
}

/* Two unit vectors that complete unit `n` to a right-handed frame, continuous but at n.z = 0 (after Duff et al. 2017,
 * "Building an Orthonormal Basis, Revisited"). */
static inline void vec3_frame(lmb_vec3 n, lmb_vec3 *tangent, lmb_vec3 *bitangent)
{
    const float sign = n.z >= 0.0f ? 1.0f : -1.0f;
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    *tangent = vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *bitangent = vec3(b, sign + n.y * n.y * a, -n.y);
}

static inline lmb_rgb rgb(float r, float g, float b)
{
    const lmb_rgb c = {{r, g, b}};
    return c;
}

static inline lmb_rgb rgb_mul(lmb_rgb a, lmb_rgb b)
{
    return rgb(a.c[0] * b.c[0], a.c[1] * b.c[1], a.c[2] * b.c[2]);
}

static inline lmb_rgb rgb_scale(lmb_rgb a, float s)
{
    return rgb(a.c[0] * s, a.c[1] * s, a.c[2] * s);
}

static inline lmb_rgb rgb_add(lmb_rgb a, lmb_rgb b)
{
    return rgb(a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]);
}

static inline float rgb_max(lmb_rgb a)
{
    const float larger = a.c[0] > a.c[1] ? a.c[0] : a.c[1];
    return larger > a.c[2] ? larger : a.c[2];
}

static inline bool rgb_is_finite(lmb_rgb a)
{
    return isfinite(a.c[0]) && isfinite(a.c[1]) && isfinite(a.c[2]);
}

/* Sine and cosine of `angle_rad` (|angle| below 1e6), within 4e-16 of the truth, and the same bits on every machine,
 * which libm's are not. */
void lmb_sincos(double angle_rad, double *sine, double *cosine);

/* Sine and cosine of 2 pi turns, turns in [0, 1), within 2e-7: the nearest quarter is taken off, and for the rest, at
 * most pi/4, the Taylor series end below that. */
static inline void lmb_turn_sincos(float turns, float *sine, float *cosine)
{
    const int32_t quarter = (int32_t)(turns * 4.0f + 0.5f);
    const float x = (turns - (float)quarter * 0.25f) * (2.0f * LMB_PI_F);
    const float s2 = x * x;
    const float s =
        x * (1.0f - s2 * (1.0f / 6.0f - s2 * (1.0f / 120.0f - s2 * (1.0f / 5040.0f - s2 * (1.0f / 362880.0f)))));
    const float c = 1.0f - s2 * (0.5f - s2 * (1.0f / 24.0f - s2 * (1.0f / 720.0f - s2 * (1.0f / 40320.0f))));
    const float swapped_s = quarter & 1 ? c : s;
    const float swapped_c = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -swapped_s : swapped_s;
    *cosine = (quarter + 1) & 2 ? -swapped_c : swapped_c;
}

/* Angle of (x, y) from +x towards +y in turns, in (-1/2, 1/2], within 4e-7: a half-angle step leaves at most tan(pi/8)
 * for the series. (0, 0) gives 0. */
static inline float lmb_turn_of(float x, float y)
{
    const float ax = fabsf(x), ay = fabsf(y);
    const float larger = ax > ay ? ax : ay;
    const float smaller = ax > ay ? ay : ax;
    const float sum = larger + sqrtf(larger * larger + smaller * smaller);
    const float t = sum > 0.0f ? smaller / sum : 0.0f;
    const float s = t * t;
    const float series =
        1.0f - s * (1.0f / 3.0f - s * (1.0f / 5.0f - s * (1.0f / 7.0f - s * (1.0f / 9.0f - s * (1.0f / 11.0f)))));
    const float eighth = t * series * (1.0f / LMB_PI_F); /* twice the half angle, in turns */
    const float quarter = ax > ay ? eighth : 0.25f - eighth;
    const float half = x < 0.0f ? 0.5f - quarter : quarter;
    return y < 0.0f ? -half : half;
}

/* Density of the hemisphere's directions, cosine / pi mixed with uniform: half and half, so that neither irradiance nor
 * the scalar moment has unbounded weights. `cosine` is of the angle to the axis. */
static inline float lmb_hemisphere_density(float cosine)
{
    return cosine > 0.0f ? (0.5f + cosine) / (2.0f * LMB_PI_F) : 0.0f;
}

#endif
