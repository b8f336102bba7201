#include "model/clipped.h"

#include <lambent/occlusion.h>

void lmb_normal_axes(lmb_vec3 normal, lmb_vec3 axes[3])
{
    axes[2] = lmb_unit_normal(normal);
    lmb_vec3_frame(axes[2], &axes[0], &axes[1]);
}

void lmb_clipped_sh2(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos, float sh2[3 * LMB_SH2_COUNT])
{
    const lmb_vec3 n = lmb_unit_normal(axis);
    for (int c = 0; c < 3; ++c) {
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance->channel[c], n, cone_cos);
        for (int i = 0; i < LMB_SH2_COUNT; ++i) {
            sh2[LMB_SH2_COUNT * c + i] = clipped.c[i];
        }
    }
}

void lmb_clipped_moments(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos, lmb_moments moments[3])
{
    const lmb_vec3 n = lmb_unit_normal(axis);
    for (int c = 0; c < 3; ++c) {
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance->channel[c], n, cone_cos);
        moments[c] = lmb_moments_from_sh2(&clipped);
    }
}

lmb_moments lmb_moments_luminance(const lmb_moments moments[3])
{
    const lmb_moments *r = &moments[0], *g = &moments[1], *b = &moments[2];
    return (lmb_moments){lmb_luminance(lmb_rgb_of(r->scalar, g->scalar, b->scalar)),
                         {lmb_luminance(lmb_rgb_of(r->vector.x, g->vector.x, b->vector.x)),
                          lmb_luminance(lmb_rgb_of(r->vector.y, g->vector.y, b->vector.y)),
                          lmb_luminance(lmb_rgb_of(r->vector.z, g->vector.z, b->vector.z))}};
}

/* G(c)_ij, the integral of Y_i Y_j over z > c (Roughton et al. 2024): blocks of 00, 10, 20; of x, xz and of y, yz; of
 * what has two turns. */
lmb_sh3 lmb_clipped_sh3(const lmb_sh3 *local, float cone_cos)
{
    const float c = lmb_saturate(cone_cos), cc = c * c, closing = 1.0f - c, sine_squared = 1.0f - cc;
    const float g00_10 = 0.43301270f * sine_squared, g00_20 = 0.55901699f * c * sine_squared;
    const float g10_10 = 0.5f * (1.0f - c * cc), g10_20 = 0.24206146f * sine_squared * (1.0f + 3.0f * cc);
    const float g20_20 = 0.125f * closing * (4.0f - c + cc * (-1.0f + 9.0f * c + 9.0f * cc));
    const float gx_x = 0.25f * closing * closing * (2.0f + c), gx_xz = 0.41926275f * sine_squared * sine_squared;
    const float gxz_xz = 0.25f * closing * closing * (2.0f + c * (4.0f + c * (6.0f + c * 3.0f)));
    const float g22_22 = 0.0625f * closing * closing * closing * (8.0f + c * (9.0f + c * 3.0f));
    const float *l = local->c;
    return (lmb_sh3){{
        0.5f * closing * l[0] + g00_10 * l[2] + g00_20 * l[6],
        gx_x * l[1] + gx_xz * l[5],
        g00_10 * l[0] + g10_10 * l[2] + g10_20 * l[6],
        gx_x * l[3] + gx_xz * l[7],
        g22_22 * l[4],
        gx_xz * l[1] + gxz_xz * l[5],
        g00_20 * l[0] + g10_20 * l[2] + g20_20 * l[6],
        gx_xz * l[3] + gxz_xz * l[7],
        g22_22 * l[8],
    }};
}

lmb_sh3_rgb lmb_clipped_sh3_rgb(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos)
{
    lmb_vec3 axes[3];
    lmb_normal_axes(axis, axes);
    const lmb_vec3 back[3] = {
        {axes[0].x, axes[1].x, axes[2].x}, {axes[0].y, axes[1].y, axes[2].y}, {axes[0].z, axes[1].z, axes[2].z}};
    lmb_sh3_rgb clipped;
    for (int c = 0; c < 3; ++c) {
        const lmb_sh3 local = lmb_sh3_in_axes(&radiance->channel[c], axes);
        const lmb_sh3 seen = lmb_clipped_sh3(&local, cone_cos);
        clipped.channel[c] = lmb_sh3_in_axes(&seen, back);
    }
    return clipped;
}

void lmb_clipped_irradiance(const lmb_sh3_rgb *radiance, const lmb_vec3 axes[3], float cone_cos, lmb_sh3 irradiance[3])
{
    for (int c = 0; c < 3; ++c) {
        const lmb_sh3 local = lmb_sh3_in_axes(&radiance->channel[c], axes);
        irradiance[c] = lmb_clipped_sh3(&local, cone_cos);
        for (int i = 1; i < LMB_SH3_COUNT; ++i) {
            irradiance[c].c[i] *= i < LMB_SH2_COUNT ? 2.0f / 3.0f : 0.25f;
        }
    }
}

lmb_sh3_rgb lmb_unclipped_sh3_rgb(const lmb_sh3_rgb *clipped, lmb_vec3 normal)
{
    lmb_sh3_rgb radiance;
    for (int c = 0; c < 3; ++c) {
        radiance.channel[c] = lmb_sh3_fit_hemisphere(&clipped->channel[c], normal);
    }
    return radiance;
}
