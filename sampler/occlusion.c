#include <lambent/occlusion.h>

#include "occlusion_internal.h"

float lmb_cone_cos_from_visibility(float visibility)
{
    return sqrtf(1.0f - lmb_unit_interval_or_one(visibility));
}

float lmb_cone_cos_from_solid_angle_visibility(float visibility)
{
    return 1.0f - lmb_unit_interval_or_one(visibility);
}

float lmb_cone_cos_from_bent_visibility(float visibility, float axis_dot_normal)
{
    return sqrtf(1.0f - lmb_unit_interval_or_one(visibility / axis_dot_normal));
}

lmb_sh2 lmb_sh3_multiply_cone(const lmb_sh3 *radiance, lmb_vec3 axis, float cone_cos)
{
    const lmb_sh3_axial l = lmb_sh3_about_axis(radiance, axis);
    return lmb_sh3_axial_clipped(&l, axis, lmb_unit_interval_or_zero(cone_cos));
}

typedef struct dvec3 {
    double x, y, z;
} dvec3;

static double dvec3_dot(dvec3 a, dvec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static dvec3 dvec3_add_scaled(dvec3 a, dvec3 b, double s)
{
    return (dvec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/* Band 2 as the symmetric matrix M of sh_internal.h, in double. */
typedef struct quadratic {
    double xx, yy, zz, xy, yz, xz;
} quadratic;

static dvec3 quadratic_times(const quadratic *m, dvec3 n)
{
    return (dvec3){m->xx * n.x + m->xy * n.y + m->xz * n.z, m->xy * n.x + m->yy * n.y + m->yz * n.z,
                   m->xz * n.x + m->yz * n.y + m->zz * n.z};
}

/* m += s (a b^T + b a^T) */
static void quadratic_add_outer(quadratic *m, dvec3 a, dvec3 b, double s)
{
    m->xx += s * 2.0 * a.x * b.x;
    m->yy += s * 2.0 * a.y * b.y;
    m->zz += s * 2.0 * a.z * b.z;
    m->xy += s * (a.x * b.y + a.y * b.x);
    m->yz += s * (a.y * b.z + a.z * b.y);
    m->xz += s * (a.x * b.z + a.z * b.x);
}

static quadratic quadratic_of_sh3(const lmb_sh3 *sh)
{
    const double zonal = LMB_SH_N20 * (double)sh->c[6];
    const double sectoral = LMB_SH_N22 * (double)sh->c[8];
    quadratic m;
    m.xx = sectoral - zonal;
    m.yy = -sectoral - zonal;
    m.zz = 2.0 * zonal;
    m.xy = 0.5 * LMB_SH_N2 * (double)sh->c[4];
    m.yz = -0.5 * LMB_SH_N2 * (double)sh->c[5];
    m.xz = -0.5 * LMB_SH_N2 * (double)sh->c[7];
    return m;
}

static lmb_sh3 sh3_of_bands(double l0, dvec3 v, const quadratic *m)
{
    return (lmb_sh3){{
        (float)l0,
        (float)-v.y,
        (float)v.z,
        (float)-v.x,
        (float)(m->xy * (2.0 / LMB_SH_N2)),
        (float)(m->yz * (-2.0 / LMB_SH_N2)),
        (float)(m->zz * (0.5 / LMB_SH_N20)),
        (float)(m->xz * (-2.0 / LMB_SH_N2)),
        (float)((m->xx - m->yy) * (0.5 / LMB_SH_N22)),
    }};
}

/* The caller's normal is unit in float only; the inverse below has condition number 254, so make it unit in double. */
static dvec3 unit_in_double(lmb_vec3 normal)
{
    const lmb_vec3 mended = lmb_normal_mended(normal);
    const dvec3 n = {(double)mended.x, (double)mended.y, (double)mended.z};
    const double length = sqrt(dvec3_dot(n, n));
    return (dvec3){n.x / length, n.y / length, n.z / length};
}

/* G(0)^-1 block by block. The zonal block (00, 10, 20) has determinant 1/512, the tangential one (x, xz) 19/256, the
 * 2,+-2 block is 1/2:
 *
 *     98         -64 sqrt3   24 sqrt5          128/19        -48 sqrt5/19
 *    -64 sqrt3   128        -16 sqrt15        -48 sqrt5/19    128/19            2
 *     24 sqrt5  -16 sqrt15   32
 */
lmb_sh3 lmb_sh3_fit_hemisphere(const lmb_sh3 *moments, lmb_vec3 normal)
{
    const dvec3 n = unit_in_double(normal);
    const double l0 = (double)moments->c[0];
    const dvec3 v = {-(double)moments->c[3], -(double)moments->c[1], (double)moments->c[2]};
    quadratic m = quadratic_of_sh3(moments);
    const dvec3 mn = quadratic_times(&m, n);

    const double l1_zonal = dvec3_dot(v, n);
    const double m_zonal = dvec3_dot(mn, n);
    const double l2_zonal = m_zonal * (0.5 / LMB_SH_N20);
    const dvec3 l1_tangential = dvec3_add_scaled(v, n, -l1_zonal);
    const dvec3 zero = {0.0, 0.0, 0.0};
    const dvec3 l2_tangential = dvec3_add_scaled(zero, dvec3_add_scaled(mn, n, -m_zonal), 2.0 / LMB_SH_N2);

    const double fit0 = 98.0 * l0 - 64.0 * LMB_SQRT_3 * l1_zonal + 24.0 * LMB_SQRT_5 * l2_zonal;
    const double fit1 = -64.0 * LMB_SQRT_3 * l0 + 128.0 * l1_zonal - 16.0 * LMB_SQRT_15 * l2_zonal;
    const double fit2 = 24.0 * LMB_SQRT_5 * l0 - 16.0 * LMB_SQRT_15 * l1_zonal + 32.0 * l2_zonal;
    const double same = 128.0 / 19.0, cross = -48.0 * LMB_SQRT_5 / 19.0;

    dvec3 fit_v = dvec3_add_scaled(zero, n, fit1);
    fit_v = dvec3_add_scaled(fit_v, l1_tangential, same);
    fit_v = dvec3_add_scaled(fit_v, l2_tangential, cross);

    /* Doubling all of M is right for the 2,+-2 block; what that gives to the other two blocks is taken off again. */
    quadratic fit_m = {2.0 * m.xx, 2.0 * m.yy, 2.0 * m.zz, 2.0 * m.xy, 2.0 * m.yz, 2.0 * m.xz};
    const double zonal_change = LMB_SH_N20 * (fit2 - 2.0 * l2_zonal);
    quadratic_add_outer(&fit_m, n, n, 1.5 * zonal_change);
    fit_m.xx -= zonal_change;
    fit_m.yy -= zonal_change;
    fit_m.zz -= zonal_change;
    dvec3 tangential_change = dvec3_add_scaled(zero, l1_tangential, cross);
    tangential_change = dvec3_add_scaled(tangential_change, l2_tangential, same - 2.0);
    quadratic_add_outer(&fit_m, n, tangential_change, 0.5 * LMB_SH_N2);
    return sh3_of_bands(fit0, fit_v, &fit_m);
}
