#include <lambent/sh.h>

#include "sh_internal.h"

lmb_sh3 lmb_sh3_basis(lmb_vec3 direction)
{
    const float x = direction.x, y = direction.y, z = direction.z;
    return (lmb_sh3){{
        (float)LMB_SH_N0,
        -(float)LMB_SH_N1 * y,
        (float)LMB_SH_N1 * z,
        -(float)LMB_SH_N1 * x,
        (float)LMB_SH_N2 * x * y,
        -(float)LMB_SH_N2 * y * z,
        (float)LMB_SH_N20 * (3.0f * z * z - 1.0f),
        -(float)LMB_SH_N2 * x * z,
        (float)LMB_SH_N22 * (x * x - y * y),
    }};
}

static float sh3_dot(const lmb_sh3 *a, const lmb_sh3 *b)
{
    float sum = 0.0f;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        sum += a->c[i] * b->c[i];
    }
    return sum;
}

float lmb_sh3_evaluate(const lmb_sh3 *radiance, lmb_vec3 direction)
{
    const lmb_sh3 basis = lmb_sh3_basis(direction);
    return sh3_dot(radiance, &basis);
}

/* The rare dot product that float cannot hold: 0 for broken coefficients, else the sum in double, clamped. */
static float unrepresentable_irradiance(const lmb_sh3 *radiance, const lmb_sh3 *kernel)
{
    double sum = 0.0;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        if (!isfinite(radiance->c[i])) {
            return 0.0f;
        }
        sum += (double)radiance->c[i] * (double)kernel->c[i];
    }
    return sum > 0.0 ? (float)fmin(sum, (double)FLT_MAX) : 0.0f;
}

static float kernel_irradiance(const lmb_sh3 *radiance, const lmb_sh3 *kernel)
{
    const float sum = sh3_dot(radiance, kernel);
    return isfinite(sum) ? lmb_light_clamped(sum) : unrepresentable_irradiance(radiance, kernel);
}

float lmb_sh3_irradiance(const lmb_sh3 *radiance, lmb_vec3 normal)
{
    const lmb_sh3 kernel = lmb_sh3_irradiance_kernel(normal);
    return kernel_irradiance(radiance, &kernel);
}

lmb_rgb lmb_sh3_rgb_irradiance(const lmb_sh3_rgb *radiance, lmb_vec3 normal)
{
    const lmb_sh3 kernel = lmb_sh3_irradiance_kernel(normal);
    lmb_rgb irradiance;
    for (int i = 0; i < 3; ++i) {
        irradiance.c[i] = kernel_irradiance(&radiance->channel[i], &kernel);
    }
    return irradiance;
}

float lmb_sh2_irradiance(const lmb_sh2 *radiance, lmb_vec3 normal)
{
    const float *c = radiance->c;
    const float linear = lmb_vec3_dot(lmb_sh_linear(c), normal);
    const float sum = (float)LMB_SH_N0 * c[0] + (float)(2.0 / 3.0 * LMB_SH_N1) * linear;
    if (!isfinite(sum)) {
        const lmb_sh3 wide = {{c[0], c[1], c[2], c[3], 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}};
        return lmb_sh3_irradiance(&wide, normal);
    }
    return lmb_light_clamped(sum);
}

lmb_rgb lmb_sh2_rgb_irradiance(const lmb_sh2_rgb *radiance, lmb_vec3 normal)
{
    lmb_rgb irradiance;
    for (int i = 0; i < 3; ++i) {
        irradiance.c[i] = lmb_sh2_irradiance(&radiance->channel[i], normal);
    }
    return irradiance;
}

static void sh3_add_scaled(lmb_sh3 *sum, const lmb_sh3 *term, float scale)
{
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        sum->c[i] += scale * term->c[i];
    }
}

void lmb_sh3_add_light(lmb_sh3 *radiance, lmb_vec3 direction, float weight)
{
    const lmb_sh3 basis = lmb_sh3_basis(direction);
    sh3_add_scaled(radiance, &basis, weight);
}

void lmb_sh3_rgb_add_light(lmb_sh3_rgb *radiance, lmb_vec3 direction, lmb_rgb weight)
{
    const lmb_sh3 basis = lmb_sh3_basis(direction);
    for (int i = 0; i < 3; ++i) {
        sh3_add_scaled(&radiance->channel[i], &basis, weight.c[i]);
    }
}

lmb_sh3_rgb lmb_sh3_rgb_lerp(const lmb_sh3_rgb *a, const lmb_sh3_rgb *b, float t)
{
    lmb_sh3_rgb mix;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < LMB_SH3_COUNT; ++j) {
            const float from = a->channel[i].c[j];
            mix.channel[i].c[j] = from + (b->channel[i].c[j] - from) * t;
        }
    }
    return mix;
}

/* v'_i = a_i.v and M'_ij = a_i.M a_j, with v and M as in sh_internal.h. */
lmb_sh3 lmb_sh3_in_axes(const lmb_sh3 *sh, const lmb_vec3 axes[3])
{
    const lmb_vec3 v = lmb_sh_linear(sh->c);
    const lmb_vec3 mx = lmb_sh3_quadratic_times(sh, axes[0]);
    const lmb_vec3 my = lmb_sh3_quadratic_times(sh, axes[1]);
    const lmb_vec3 mz = lmb_sh3_quadratic_times(sh, axes[2]);
    const float xx_minus_yy = lmb_vec3_dot(axes[0], mx) - lmb_vec3_dot(axes[1], my);
    return (lmb_sh3){{
        sh->c[0],
        -lmb_vec3_dot(axes[1], v),
        lmb_vec3_dot(axes[2], v),
        -lmb_vec3_dot(axes[0], v),
        lmb_vec3_dot(axes[0], my) * (float)(2.0 / LMB_SH_N2),
        lmb_vec3_dot(axes[1], mz) * (float)(-2.0 / LMB_SH_N2),
        lmb_vec3_dot(axes[2], mz) * (float)(0.5 / LMB_SH_N20),
        lmb_vec3_dot(axes[0], mz) * (float)(-2.0 / LMB_SH_N2),
        xx_minus_yy * (float)(0.5 / LMB_SH_N22),
    }};
}

lmb_sh3_rgb lmb_sh3_rgb_in_axes(const lmb_sh3_rgb *sh, const lmb_vec3 axes[3])
{
    lmb_sh3_rgb turned;
    for (int i = 0; i < 3; ++i) {
        turned.channel[i] = lmb_sh3_in_axes(&sh->channel[i], axes);
    }
    return turned;
}

lmb_sh3 lmb_sh3_rgb_luminance(const lmb_sh3_rgb *radiance)
{
    lmb_sh3 luminance;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        luminance.c[i] =
            lmb_luminance((lmb_rgb){{radiance->channel[0].c[i], radiance->channel[1].c[i], radiance->channel[2].c[i]}});
    }
    return luminance;
}
