#include <lambent/hlsh.h>

#include <lambent/hhd.h>

#include "sh_internal.h"

/* What one unit of each axial part of the radiance adds to HLSH behind a cone of cosine c: radiance clipped by the
 * cone, truncated to SH3, convolved, fitted over the hemisphere with I_z exact (docs/maths.md). Every weight is
 * factored by (1 - c), so that a closing cone goes to 0 without cancellation. */
typedef struct hlsh_weights {
    float z_l0, z_l1, z_l2;    /* I_z */
    float ca_l0, ca_l1, ca_l2; /* C_a */
    float c_l1, c_l2;          /* c */
} hlsh_weights;

static hlsh_weights hlsh_weights_of_cone(float cone_cos)
{
    const float c = lmb_unit_interval_or_zero(cone_cos);
    const float closing = 1.0f - c;
    const float sine_squared = closing * (1.0f + c);
    hlsh_weights w;
    w.z_l0 = (float)(0.5 / LMB_SQRT_PI) * sine_squared;
    w.z_l1 = (float)(1.0 / (LMB_SQRT_3 * LMB_SQRT_PI)) * closing * (1.0f + c * (1.0f + c));
    w.z_l2 = (float)(LMB_SQRT_5 / (8.0 * LMB_SQRT_PI)) * sine_squared * (1.0f + 3.0f * c * c);
    w.ca_l0 = (float)(1.0 / (256.0 * LMB_SQRT_PI)) * closing * (64.0f - c * (47.0f + c * 15.0f));
    w.ca_l1 =
        (float)(LMB_SQRT_3 / (3072.0 * LMB_SQRT_PI)) * closing * (275.0f + c * (275.0f - c * (391.0f + c * 135.0f)));
    w.ca_l2 = (float)(LMB_SQRT_5 / (512.0 * LMB_SQRT_PI)) * closing *
              (-28.0f + c * (83.0f + c * (51.0f - c * (75.0f + c * 27.0f))));
    w.c_l1 = (float)(LMB_SQRT_3 / (3072.0 * LMB_SQRT_PI)) * closing * closing * (647.0f + c * (526.0f + c * 135.0f));
    w.c_l2 = (float)(LMB_SQRT_15 / (256.0 * LMB_SQRT_PI)) * closing * closing *
             (22.0f + c * (44.0f + c * (34.0f + c * 9.0f)));
    return w;
}

static lmb_hlsh hlsh_weighted(const hlsh_weights *w, const lmb_sh3 *radiance, lmb_vec3 vertex_normal)
{
    const lmb_sh3_axial l = lmb_sh3_about_axis(radiance, vertex_normal);
    lmb_hlsh hlsh;
    hlsh.irradiance_z = w->z_l0 * l.l0 + w->z_l1 * l.l1_zonal + w->z_l2 * l.l2_zonal;
    hlsh.ambient = w->ca_l0 * l.l0 + w->ca_l1 * l.l1_zonal + w->ca_l2 * l.l2_zonal;
    hlsh.tangential = lmb_vec3_mad(lmb_vec3_scale(l.l1_tangential, w->c_l1), l.l2_tangential, w->c_l2);
    return hlsh;
}

lmb_hlsh lmb_hlsh_from_sh3(const lmb_sh3 *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    const hlsh_weights weights = hlsh_weights_of_cone(cone_cos);
    return hlsh_weighted(&weights, radiance, vertex_normal);
}

lmb_hlsh_rgb lmb_hlsh_rgb_from_sh3(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    const hlsh_weights weights = hlsh_weights_of_cone(cone_cos);
    lmb_hlsh_rgb hlsh;
    for (int i = 0; i < 3; ++i) {
        hlsh.channel[i] = hlsh_weighted(&weights, &radiance->channel[i], vertex_normal);
    }
    return hlsh;
}

/* With gamma the angle from n_v to the light, I_z gains cos(gamma)/pi, c gains (pi - gamma) w_perp/pi^2, and C_a gains
 * 3/(4 pi) + cos(gamma)/(4 pi) - [sin(gamma) + (pi - gamma) cos(gamma)]/pi^2: the inner products of (n.w)+ with
 * x, y and 1 - z over the hemisphere, which are orthogonal there. */
static void add_light_above(lmb_hlsh *hlsh, lmb_vec3 vertex_normal, lmb_vec3 direction, float cosine, float weight)
{
    const float pi = (float)LMB_PI;
    const lmb_vec3 tangential = lmb_vec3_mad(direction, vertex_normal, -cosine);
    const float sine = sqrtf(lmb_vec3_dot(tangential, tangential));
    const float rest = pi - atan2f(sine, cosine);
    hlsh->irradiance_z += weight * cosine / pi;
    hlsh->ambient += weight * ((3.0f + cosine) / (4.0f * pi) - (sine + rest * cosine) / (pi * pi));
    hlsh->tangential = lmb_vec3_mad(hlsh->tangential, tangential, weight * rest / (pi * pi));
}

void lmb_hlsh_add_light(lmb_hlsh *hlsh, lmb_vec3 vertex_normal, lmb_vec3 direction, float weight)
{
    const float cosine = lmb_vec3_dot(direction, vertex_normal);
    if (cosine > 0.0f) {
        add_light_above(hlsh, vertex_normal, direction, cosine, weight);
    }
}

/* HLSH of the HHD light that the moments solve to: its hemisphere light C_a (1 + t)/2 is I_z = C_a with C_a/2 at the
 * horizon, its directional light is projected exactly. That is never below the horizon, but often on it. */
lmb_hlsh lmb_hlsh_from_probe(const lmb_sh3 *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    const lmb_hhd hhd = lmb_hhd_solve(lmb_moments_from_probe(radiance, vertex_normal, cone_cos), vertex_normal);
    const float cosine = lmb_larger(lmb_vec3_dot(hhd.direction, vertex_normal), 0.0f);
    lmb_hlsh hlsh = {hhd.ambient, 0.5f * hhd.ambient, {0.0f, 0.0f, 0.0f}};
    add_light_above(&hlsh, vertex_normal, hhd.direction, cosine, (float)LMB_PI * hhd.directional);
    return hlsh;
}

lmb_hlsh_rgb lmb_hlsh_rgb_from_probe(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    lmb_hlsh_rgb hlsh;
    for (int i = 0; i < 3; ++i) {
        hlsh.channel[i] = lmb_hlsh_from_probe(&radiance->channel[i], vertex_normal, cone_cos);
    }
    return hlsh;
}
