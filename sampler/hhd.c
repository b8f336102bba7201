#include <lambent/hhd.h>

#include <lambent/occlusion.h>

#include "sh_internal.h"

static bool moments_are_finite(lmb_moments m)
{
    return isfinite(m.scalar) && isfinite(m.vector.x) && isfinite(m.vector.y) && isfinite(m.vector.z);
}

lmb_moments lmb_moments_from_sh2(const lmb_sh2 *clipped_radiance)
{
    lmb_moments moments;
    moments.scalar = clipped_radiance->c[0] * (float)(2.0 / LMB_SQRT_PI);
    moments.vector = lmb_vec3_scale(lmb_sh_linear(clipped_radiance->c), (float)(2.0 / (LMB_SQRT_3 * LMB_SQRT_PI)));
    return moments;
}

/* The largest of b_c and |b_i|: what the moments are divided by before anything is squared. */
static float moments_scale(lmb_moments m)
{
    return lmb_larger(lmb_larger(m.scalar, fabsf(m.vector.x)), lmb_larger(fabsf(m.vector.y), fabsf(m.vector.z)));
}

/* With p = |b_perp|, x = b_c - 2 I_z and R = sqrt(x^2 + 3 p^2) the closed form (minus root of
 * 3 C_a^2 - 2 (2 b_c - I_z) C_a + b_c^2 - |b|^2 = 0) becomes
 *
 *     C_d = (2R - x)/3,   C_d (n_v.d) = (R - 2x)/3,   C_d d_perp = b_perp,   C_a = (b_c - C_d)/2,
 *
 * where R >= |x| rules out a negative discriminant and C_d < 0, and C_d keeps its relative precision beside a C_a that
 * is a thousand times brighter. */
lmb_hhd lmb_hhd_solve(lmb_moments moments, lmb_vec3 vertex_normal)
{
    const lmb_vec3 n = lmb_normal_mended(vertex_normal);
    if (!(moments.scalar > 0.0f) || !moments_are_finite(moments)) {
        return (lmb_hhd){0.0f, 0.0f, n};
    }
    const float scale = moments_scale(moments);
    const float b_c = moments.scalar / scale;
    const lmb_vec3 b = {moments.vector.x / scale, moments.vector.y / scale, moments.vector.z / scale};
    /* SH ringing of light from below the horizon: no negative light. */
    const float i_z = lmb_larger(lmb_vec3_dot(b, n), 0.0f);
    lmb_vec3 b_perp = lmb_vec3_perpendicular(b, n);
    float p_squared = lmb_vec3_dot(b_perp, b_perp);
    if (!(p_squared > FLT_EPSILON * FLT_EPSILON)) { /* the rounding of b: it could point anywhere, down too */
        b_perp = (lmb_vec3){0.0f, 0.0f, 0.0f};
        p_squared = 0.0f;
    }
    const float p = sqrtf(p_squared);
    const float x = b_c - 2.0f * i_z;

    float ambient, directional, height;
    if (p_squared + i_z * i_z > b_c * b_c) {
        /* More directional than any non-negative radiance (ringing): C_a would be negative. */
        ambient = 0.0f;
        directional = sqrtf(p_squared + i_z * i_z);
        height = i_z;
    } else if (p < x) {
        /* Light mostly at the horizon: d would fall below it, and I(n_v) would not be I_z. */
        ambient = i_z;
        directional = p;
        height = 0.0f;
    } else {
        const float root = sqrtf(x * x + 3.0f * p_squared);
        directional = (2.0f * root - x) / 3.0f;
        ambient = lmb_larger(0.5f * (b_c - directional), 0.0f);
        height = lmb_larger((root - 2.0f * x) / 3.0f, 0.0f);
    }
    lmb_hhd hhd;
    hhd.ambient = lmb_light_clamped(ambient * scale);
    hhd.directional = lmb_light_clamped(directional * scale);
    hhd.direction = lmb_vec3_unit_or(lmb_vec3_mad(b_perp, n, height), n);
    return hhd;
}

/* Unit d, tilted up in its own plane with the unit normal n until n.d >= LMB_IRRADZ_MIN_COS. */
static lmb_vec3 tilted_above_horizon(lmb_vec3 d, lmb_vec3 n)
{
    if (lmb_vec3_dot(d, n) >= LMB_IRRADZ_MIN_COS) {
        return d;
    }
    const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
    const lmb_vec3 flat = lmb_vec3_unit_or(lmb_vec3_perpendicular(d, n), none);
    const float min_sine = sqrtf(1.0f - LMB_IRRADZ_MIN_COS * LMB_IRRADZ_MIN_COS);
    const lmb_vec3 tilted = lmb_vec3_mad(lmb_vec3_scale(flat, min_sine), n, LMB_IRRADZ_MIN_COS);
    return lmb_vec3_unit_or(tilted, n);
}

/* w for `hhd` seen with direction `d`, which may have been tilted up: C_d = (1 - w) I_z/(n.d) survives while w >= 0
 * allows it, and C_a gives up what the higher d adds to I(n_v), so that I(n_v) = I_z stays exact. */
static float ambient_weight(const lmb_hhd *hhd, lmb_vec3 d, lmb_vec3 n)
{
    if (!(hhd->directional > 0.0f)) {
        return 1.0f;
    }
    const float i_z = hhd->ambient + hhd->directional * lmb_larger(lmb_vec3_dot(hhd->direction, n), 0.0f);
    return lmb_unit_interval_or_zero(1.0f - hhd->directional / i_z * lmb_vec3_dot(d, n));
}

/* `n` is unit. Moments of each colour; those of their luminance say w and d. */
static lmb_irradz irradz_of_moments(const lmb_moments of_colour[3], lmb_vec3 n)
{
    lmb_irradz irradz;
    lmb_rgb scalar, x, y, z;
    for (int i = 0; i < 3; ++i) {
        const lmb_moments moments =
            moments_are_finite(of_colour[i]) ? of_colour[i] : (lmb_moments){0.0f, {0.0f, 0.0f, 0.0f}};
        irradz.irradiance_z.c[i] = lmb_light_clamped(lmb_vec3_dot(moments.vector, n));
        scalar.c[i] = moments.scalar;
        x.c[i] = moments.vector.x;
        y.c[i] = moments.vector.y;
        z.c[i] = moments.vector.z;
    }
    const lmb_moments luminance = {lmb_luminance(scalar), {lmb_luminance(x), lmb_luminance(y), lmb_luminance(z)}};
    const lmb_hhd hhd = lmb_hhd_solve(luminance, n);
    irradz.direction = tilted_above_horizon(hhd.direction, n);
    irradz.ambient_weight = ambient_weight(&hhd, irradz.direction, n);
    return irradz;
}

lmb_irradz lmb_irradz_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    const lmb_vec3 n = lmb_normal_mended(vertex_normal);
    lmb_moments moments[3];
    for (int i = 0; i < 3; ++i) {
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance->channel[i], n, cone_cos);
        moments[i] = lmb_moments_from_sh2(&clipped);
    }
    return irradz_of_moments(moments, n);
}

lmb_irradz lmb_irradz_from_probe(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    const lmb_vec3 n = lmb_normal_mended(vertex_normal);
    lmb_moments moments[3];
    for (int i = 0; i < 3; ++i) {
        moments[i] = lmb_moments_from_probe(&radiance->channel[i], n, cone_cos);
    }
    return irradz_of_moments(moments, n);
}

lmb_hhd_rgb lmb_irradz_decode(const lmb_irradz *irradz, lmb_vec3 vertex_normal)
{
    const lmb_vec3 n = lmb_normal_mended(vertex_normal);
    const float w = lmb_unit_interval_or_one(irradz->ambient_weight);
    /* Directions that agree are nowhere lower than this, before their mean is made unit. What is lower was mixed from
     * surfaces that face apart, and tells nothing of where light comes from here. */
    const float agreed = lmb_unit_interval_or_one(lmb_vec3_dot(irradz->direction, n) * (1.0f / LMB_IRRADZ_MIN_COS));
    const float directional = (1.0f - w) * agreed * agreed;
    const float ambient = w + (1.0f - w) * (1.0f - agreed * agreed);
    lmb_hhd_rgb hhd;
    hhd.direction = tilted_above_horizon(lmb_vec3_unit_or(irradz->direction, n), n);
    const float height = lmb_larger(lmb_vec3_dot(hhd.direction, n), LMB_IRRADZ_MIN_COS);
    for (int i = 0; i < 3; ++i) {
        const float i_z = lmb_light_clamped(irradz->irradiance_z.c[i]);
        hhd.ambient.c[i] = ambient * i_z;
        hhd.directional.c[i] = lmb_light_clamped(directional * i_z / height);
    }
    return hhd;
}
