/* Vectors, clamps and the frame of an axis, shared by the sampler's SH code.
 *
 * Band 1 is the vector v = (-l11, -l1-1, l10): L1(n) = N1 v.n. Band 2 is the symmetric traceless matrix M with
 * L2(n) = n^T M n. Both turn with the world, so what a formula needs "in the frame of the axis" is a dot product or a
 * projection, and no SH is ever rotated. */
#ifndef LMB_SH_INTERNAL_H
#define LMB_SH_INTERNAL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include <lambent/sh.h>
#include <lambent/vector.h>

/* Normalisation of the basis (lambent/sh.h). */
#define LMB_SH_N0 0.28209479177387814  /* 1 / (2 sqrt(pi)) */
#define LMB_SH_N1 0.48860251190291992  /* sqrt(3 / (4 pi)) */
#define LMB_SH_N2 1.0925484305920792   /* sqrt(15 / (4 pi)) */
#define LMB_SH_N20 0.31539156525252005 /* sqrt(5 / (16 pi)) */
#define LMB_SH_N22 0.54627421529603959 /* sqrt(15 / (16 pi)) */

#define LMB_SQRT_PI 1.7724538509055161
#define LMB_SQRT_3 1.7320508075688773
#define LMB_SQRT_5 2.2360679774997897
#define LMB_SQRT_15 3.8729833462074169

/* The part of `a` perpendicular to the unit `axis`. Projected twice: after one projection a vector nearly along the
 * axis keeps a rounding error that is as long as its perpendicular part. */
static inline lmb_vec3 lmb_vec3_perpendicular(lmb_vec3 a, lmb_vec3 axis)
{
    const lmb_vec3 once = lmb_vec3_mad(a, axis, -lmb_vec3_dot(a, axis));
    return lmb_vec3_mad(once, axis, -lmb_vec3_dot(once, axis));
}

/* A unit normal from what may be a broken one; +Y when it has no direction. */
static inline lmb_vec3 lmb_normal_mended(lmb_vec3 normal)
{
    return lmb_vec3_unit_or(normal, (lmb_vec3){0.0f, 1.0f, 0.0f});
}

/* `x` in [0, 1]; NaN gives 0. */
static inline float lmb_unit_interval_or_zero(float x)
{
    return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f;
}

/* `x` in [0, 1]; NaN gives 1. */
static inline float lmb_unit_interval_or_one(float x)
{
    return x < 1.0f ? (x > 0.0f ? x : 0.0f) : 1.0f;
}

/* Band 1 as a vector. */
static inline lmb_vec3 lmb_sh_linear(const float *c)
{
    return (lmb_vec3){-c[3], -c[1], c[2]};
}

/* M n */
static inline lmb_vec3 lmb_sh3_quadratic_times(const lmb_sh3 *sh, lmb_vec3 n)
{
    const float half_n2 = (float)(0.5 * LMB_SH_N2);
    const float zonal = (float)LMB_SH_N20 * sh->c[6];
    const float sectoral = (float)LMB_SH_N22 * sh->c[8];
    const float xy = half_n2 * sh->c[4];
    const float yz = -half_n2 * sh->c[5];
    const float xz = -half_n2 * sh->c[7];
    return (lmb_vec3){(sectoral - zonal) * n.x + xy * n.y + xz * n.z, xy * n.x - (zonal + sectoral) * n.y + yz * n.z,
                      xz * n.x + yz * n.y + 2.0f * zonal * n.z};
}

/* The parts of an SH3 that a cone about an axis can turn into linear SH. Zonal parts are scalars, tangential ones
 * world-space vectors perpendicular to the axis, positive towards the light. The 2,+-2 part about the axis is not
 * here: it stays in its own block. */
typedef struct lmb_sh3_axial {
    float l0;
    float l1_zonal;
    float l2_zonal;
    lmb_vec3 l1_tangential;
    lmb_vec3 l2_tangential;
} lmb_sh3_axial;

static inline lmb_sh3_axial lmb_sh3_about_axis(const lmb_sh3 *sh, lmb_vec3 axis)
{
    const lmb_vec3 v = lmb_sh_linear(sh->c);
    const lmb_vec3 m = lmb_sh3_quadratic_times(sh, axis);
    const float v_axis = lmb_vec3_dot(v, axis);
    const float m_axis = lmb_vec3_dot(m, axis);
    lmb_sh3_axial axial;
    axial.l0 = sh->c[0];
    axial.l1_zonal = v_axis;
    axial.l2_zonal = m_axis * (float)(0.5 / LMB_SH_N20);
    axial.l1_tangential = lmb_vec3_mad(v, axis, -v_axis);
    axial.l2_tangential = lmb_vec3_scale(lmb_vec3_mad(m, axis, -m_axis), (float)(2.0 / LMB_SH_N2));
    return axial;
}

/* The nine numbers whose dot product with radiance is the normalised irradiance on `normal`: the basis there, its bands
 * times 1, 2/3 and 1/4 (Ramamoorthi and Hanrahan 2001, divided by pi). */
static inline lmb_sh3 lmb_sh3_irradiance_kernel(lmb_vec3 normal)
{
    const float band_1 = 2.0f / 3.0f, band_2 = 0.25f;
    const float x = normal.x, y = normal.y, z = normal.z;
    lmb_sh3 kernel;
    kernel.c[0] = (float)LMB_SH_N0;
    kernel.c[1] = -(float)LMB_SH_N1 * y * band_1;
    kernel.c[2] = (float)LMB_SH_N1 * z * band_1;
    kernel.c[3] = -(float)LMB_SH_N1 * x * band_1;
    kernel.c[4] = (float)LMB_SH_N2 * x * y * band_2;
    kernel.c[5] = -(float)LMB_SH_N2 * y * z * band_2;
    kernel.c[6] = (float)LMB_SH_N20 * (3.0f * z * z - 1.0f) * band_2;
    kernel.c[7] = -(float)LMB_SH_N2 * x * z * band_2;
    kernel.c[8] = (float)LMB_SH_N22 * (x * x - y * y) * band_2;
    return kernel;
}

#endif
