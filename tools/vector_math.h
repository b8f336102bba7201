/* Vector arithmetic that the tools' own files share. */
#ifndef LMB_TOOLS_VECTOR_MATH_H
#define LMB_TOOLS_VECTOR_MATH_H

#include <math.h>

#include <lambent/types.h>

#define TOOLS_PI_F 3.14159265358979323846f

static inline lmb_vec3 vector_add(lmb_vec3 a, lmb_vec3 b)
{
    return (lmb_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline lmb_vec3 vector_sub(lmb_vec3 a, lmb_vec3 b)
{
    return (lmb_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline lmb_vec3 vector_scale(lmb_vec3 a, float s)
{
    return (lmb_vec3){a.x * s, a.y * s, a.z * s};
}

/* a + b s */
static inline lmb_vec3 vector_mad(lmb_vec3 a, lmb_vec3 b, float s)
{
    return (lmb_vec3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}

static inline float vector_dot(lmb_vec3 a, lmb_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline lmb_vec3 vector_cross(lmb_vec3 a, lmb_vec3 b)
{
    return (lmb_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float vector_length(lmb_vec3 a)
{
    return sqrtf(vector_dot(a, a));
}

/* Unit vector along `a`, or `fallback` when it has no direction. */
static inline lmb_vec3 vector_unit_or(lmb_vec3 a, lmb_vec3 fallback)
{
    const float length = vector_length(a);
    return length > 0.0f && isfinite(length) ? vector_scale(a, 1.0f / length) : fallback;
}

/* Two unit vectors that complete unit `n` to a right-handed frame. */
static inline void vector_frame(lmb_vec3 n, lmb_vec3 *tangent, lmb_vec3 *bitangent)
{
    const lmb_vec3 other = fabsf(n.x) < 0.6f ? (lmb_vec3){1.0f, 0.0f, 0.0f} : (lmb_vec3){0.0f, 1.0f, 0.0f};
    *tangent = vector_unit_or(vector_cross(other, n), other);
    *bitangent = vector_cross(n, *tangent);
}

static inline lmb_rgb colour_add(lmb_rgb a, lmb_rgb b)
{
    return (lmb_rgb){{a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}};
}

static inline lmb_rgb colour_mul(lmb_rgb a, lmb_rgb b)
{
    return (lmb_rgb){{a.c[0] * b.c[0], a.c[1] * b.c[1], a.c[2] * b.c[2]}};
}

static inline lmb_rgb colour_scale(lmb_rgb a, float s)
{
    return (lmb_rgb){{a.c[0] * s, a.c[1] * s, a.c[2] * s}};
}

static inline float colour_max(lmb_rgb a)
{
    return fmaxf(a.c[0], fmaxf(a.c[1], a.c[2]));
}

#endif
