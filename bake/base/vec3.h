/* Vectors of three floats. */
#ifndef LMB_VEC3_H
#define LMB_VEC3_H

#include <math.h>

#include <lambent/types.h>

#include "base/scalar.h"

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

#endif
