/* Arithmetic with the values of lambent/types.h, inline, for all parts of Lambent. A game has its own. */
#ifndef LAMBENT_VECTOR_H
#define LAMBENT_VECTOR_H

#include <math.h>
#include <stdbool.h>

#include <lambent/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LMB_PI 3.14159265358979323846
#define LMB_PI_F 3.14159265358979323846f

/* The larger and the smaller of two numbers, `b` when `a` is NaN: single instructions, which fmaxf and fminf with their
 * rules for NaN are not. */
static inline float lmb_larger(float a, float b)
{
    return a > b ? a : b;
}

static inline float lmb_smaller(float a, float b)
{
    return a < b ? a : b;
}

/* Clamped to [0, 1]; 0 when NaN. */
static inline float lmb_saturate(float a)
{
    return lmb_smaller(lmb_larger(a, 0.0f), 1.0f);
}

static inline lmb_vec3 lmb_vec3_of(float x, float y, float z)
{
    const lmb_vec3 v = {x, y, z};
    return v;
}

static inline lmb_vec3 lmb_vec3_add(lmb_vec3 a, lmb_vec3 b)
{
    return lmb_vec3_of(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline lmb_vec3 lmb_vec3_sub(lmb_vec3 a, lmb_vec3 b)
{
    return lmb_vec3_of(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline lmb_vec3 lmb_vec3_scale(lmb_vec3 a, float s)
{
    return lmb_vec3_of(a.x * s, a.y * s, a.z * s);
}

/* a + b s */
static inline lmb_vec3 lmb_vec3_mad(lmb_vec3 a, lmb_vec3 b, float s)
{
    return lmb_vec3_of(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}

static inline float lmb_vec3_dot(lmb_vec3 a, lmb_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline lmb_vec3 lmb_vec3_cross(lmb_vec3 a, lmb_vec3 b)
{
    return lmb_vec3_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float lmb_vec3_length(lmb_vec3 a)
{
    return sqrtf(lmb_vec3_dot(a, a));
}

/* Unit vector along `a`, or `fallback` when it has no direction (zero, NaN, infinite). In double: squares of floats can
 * neither overflow nor vanish there. */
static inline lmb_vec3 lmb_vec3_unit_or(lmb_vec3 a, lmb_vec3 fallback)
{
    const double x = (double)a.x, y = (double)a.y, z = (double)a.z;
    const double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0.0 && length < (double)INFINITY)) {
        return fallback;
    }
    return lmb_vec3_of((float)(x / length), (float)(y / length), (float)(z / length));
}

static inline lmb_vec3 lmb_vec3_smaller(lmb_vec3 a, lmb_vec3 b)
{
    return lmb_vec3_of(lmb_smaller(a.x, b.x), lmb_smaller(a.y, b.y), lmb_smaller(a.z, b.z));
}

static inline lmb_vec3 lmb_vec3_larger(lmb_vec3 a, lmb_vec3 b)
{
    return lmb_vec3_of(lmb_larger(a.x, b.x), lmb_larger(a.y, b.y), lmb_larger(a.z, b.z));
}

/* Two unit vectors that complete unit `n` to a right-handed frame, continuous but at n.z = 0 (after Duff et al. 2017,
 * "Building an Orthonormal Basis, Revisited"). */
static inline void lmb_vec3_frame(lmb_vec3 n, lmb_vec3 *tangent, lmb_vec3 *bitangent)
{
    const float sign = n.z >= 0.0f ? 1.0f : -1.0f;
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    *tangent = lmb_vec3_of(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *bitangent = lmb_vec3_of(b, sign + n.y * n.y * a, -n.y);
}

static inline lmb_rgb lmb_rgb_of(float r, float g, float b)
{
    const lmb_rgb c = {{r, g, b}};
    return c;
}

static inline lmb_rgb lmb_rgb_add(lmb_rgb a, lmb_rgb b)
{
    return lmb_rgb_of(a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]);
}

static inline lmb_rgb lmb_rgb_mul(lmb_rgb a, lmb_rgb b)
{
    return lmb_rgb_of(a.c[0] * b.c[0], a.c[1] * b.c[1], a.c[2] * b.c[2]);
}

static inline lmb_rgb lmb_rgb_scale(lmb_rgb a, float s)
{
    return lmb_rgb_of(a.c[0] * s, a.c[1] * s, a.c[2] * s);
}

static inline float lmb_rgb_max(lmb_rgb a)
{
    return lmb_larger(lmb_larger(a.c[0], a.c[1]), a.c[2]);
}

static inline bool lmb_rgb_is_finite(lmb_rgb a)
{
    return isfinite(a.c[0]) && isfinite(a.c[1]) && isfinite(a.c[2]);
}

#ifdef __cplusplus
}
#endif

#endif
