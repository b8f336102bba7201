/* A direction above a surface as two numbers, which textures of two channels hold.
 *
 * Lambert's equal-area map of the hemisphere about the surface's normal n: with h = n.d,
 *
 *     p = d_perp / sqrt(1 + h),   |p|^2 = 1 - h,   d = n (1 - |p|^2) + (T p.x + B p.y) sqrt(1 + h)
 *
 * p lies in the unit disc, n itself at its centre. A mean of points of the disc is one: what filtering leaves is a unit
 * direction above the horizon, and as h is concave in p it is at least as high as the mean of the heights, so that
 * (1 - w) I_z / h (lambent/hhd.h) does not grow by filtering d.
 *
 * T and B complete n to a frame: two fixed vectors, turned as the fixed axis A = T x B is turned to n by the shortest
 * way. A frame of n alone: surfaces that meet smoothly agree, whatever their texture coordinates, and normals that
 * differ by an angle a little off have frames that differ by as little. No frame does so everywhere: this one turns
 * fast around -A, which no wall, floor or ceiling faces.
 *
 * Inline and pure, as lambent/hhd.h; the shader include has the same. */
#ifndef LAMBENT_DIRECTION_DISC_H
#define LAMBENT_DIRECTION_DISC_H

#include <lambent/vector.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What of it is lower is taken for this: LMB_IRRADZ_MIN_COS of lambent/hhd.h. */
#define LMB_DISC_MIN_COS 0.05f

/* T and B of unit `n`: T' - (n.T') (A + n) / (1 + A.n), likewise B'. */
static inline void lmb_disc_frame(lmb_vec3 n, lmb_vec3 *tangent, lmb_vec3 *bitangent)
{
    const lmb_vec3 axis = {-0.36f, 0.8f, -0.48f};
    const lmb_vec3 t = {-0.8f, 0.0f, 0.6f}, b = {0.48f, 0.6f, 0.64f};
    const float turn = 1.0f / lmb_larger(1.0f + lmb_vec3_dot(axis, n), 1e-6f);
    const lmb_vec3 half = lmb_vec3_add(axis, n);
    *tangent = lmb_vec3_mad(t, half, -lmb_vec3_dot(n, t) * turn);
    *bitangent = lmb_vec3_mad(b, half, -lmb_vec3_dot(n, b) * turn);
}

/* The point of unit `direction`, which is not below the horizon of unit `n`. */
static inline void lmb_disc_from_direction(lmb_vec3 direction, lmb_vec3 n, float *x, float *y)
{
    lmb_vec3 tangent, bitangent;
    lmb_disc_frame(n, &tangent, &bitangent);
    const float shrink = 1.0f / sqrtf(1.0f + lmb_larger(lmb_vec3_dot(n, direction), 0.0f));
    *x = lmb_vec3_dot(tangent, direction) * shrink;
    *y = lmb_vec3_dot(bitangent, direction) * shrink;
}

/* And back, of any filtered point of the disc: at least LMB_DISC_MIN_COS above the horizon; unit, but a little longer
 * for points lower than that. */
static inline lmb_vec3 lmb_disc_to_direction(float x, float y, lmb_vec3 n)
{
    lmb_vec3 tangent, bitangent;
    lmb_disc_frame(n, &tangent, &bitangent);
    const float height = lmb_larger(1.0f - (x * x + y * y), LMB_DISC_MIN_COS);
    const float stretch = sqrtf(1.0f + height);
    return lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(n, height), tangent, x * stretch), bitangent, y * stretch);
}

#ifdef __cplusplus
}
#endif

#endif
