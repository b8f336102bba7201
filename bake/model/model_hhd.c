/* HHD by the closed form from moments of the Gram multiply, as the papers have it (lambent/hhd.h), and three ways for
 * it to have colour: all shared but the light's; C_a of its own; a direction of its own. */
#include <lambent/hhd.h>

#include "model/clipped.h"
#include "model/hhd_store.h"
#include "model/models.h"

/* One solution, of luminance, shared by the colours. */
static void closed_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_moments moments[3];
    lmb_clipped_moments(radiance, n, cone_cos, moments);
    const lmb_moments luminance = lmb_moments_luminance(moments);
    const lmb_hhd solved = lmb_hhd_solve(luminance, n);
    lmb_hhd_rgb hhd = {.direction = solved.direction};
    for (int c = 0; c < 3; ++c) {
        const float share = lmb_hhd_share(moments[c], luminance, n);
        hhd.ambient.c[c] = lmb_light_clamped(solved.ambient * share);
        hhd.directional.c[c] = lmb_light_clamped(solved.directional * share);
    }
    lmb_hhd_store(&hhd, channel);
}

const lmb_model lmb_model_hhd_closed_gram = {
    .name = "hhd.closed.gram",
    .title = "HHD, closed form, colours share w and d",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .cone = true,
    .encode = closed_encode,
    .evaluate = lmb_hhd_store_evaluate,
};

/* With d and I_z fixed, C_a = I_z - h C_d, h = n_v.d, and what is left of the moments,
 * b_c - 2 I_z - (1 - 2h) C_d and b_perp - C_d d_perp, is least at
 * C_d = [(1 - 2h)(b_c - 2 I_z) + b_perp.d_perp] / [(1 - 2h)^2 + |d_perp|^2]; C_a and C_d stay non-negative. */
static void channel_solve(lmb_moments moments, lmb_vec3 n, lmb_vec3 d, float *ambient, float *directional)
{
    const float i_z = lmb_light_clamped(lmb_vec3_dot(moments.vector, n));
    const float height = lmb_larger(lmb_vec3_dot(d, n), 0.0f), tilt = 1.0f - 2.0f * height;
    const lmb_vec3 d_perp = lmb_vec3_mad(d, n, -height);
    const float found = (tilt * (moments.scalar - 2.0f * i_z) + lmb_vec3_dot(moments.vector, d_perp)) /
                        (tilt * tilt + lmb_vec3_dot(d_perp, d_perp));
    const float least = lmb_light_clamped(found);
    *directional = least * height < i_z ? least : height > 0.0f ? lmb_light_clamped(i_z / height) : 0.0f;
    *ambient = lmb_light_clamped(i_z - *directional * height);
}

/* The direction of luminance. */
static void channels_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_moments moments[3];
    lmb_clipped_moments(radiance, n, cone_cos, moments);
    lmb_hhd_rgb hhd = {.direction = lmb_hhd_solve(lmb_moments_luminance(moments), n).direction};
    for (int c = 0; c < 3; ++c) {
        channel_solve(moments[c], n, hhd.direction, &hhd.ambient.c[c], &hhd.directional.c[c]);
    }
    lmb_hhd_store(&hhd, channel);
}

const lmb_model lmb_model_hhd_channels_gram = {
    .name = "hhd.channels.gram",
    .title = "HHD, closed form, C_a of each colour",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .cone = true,
    .encode = channels_encode,
    .evaluate = lmb_hhd_store_evaluate,
};

/* C_a, C_d and d of each colour. */
enum { OF_COLOUR = 5, THREE_CHANNELS = 3 * OF_COLOUR };

static void three_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    lmb_moments moments[3];
    lmb_clipped_moments(radiance, vertex_normal, cone_cos, moments);
    for (int c = 0; c < 3; ++c) {
        const lmb_hhd hhd = lmb_hhd_solve(moments[c], vertex_normal);
        const float stored[OF_COLOUR] = {hhd.ambient, hhd.directional, hhd.direction.x, hhd.direction.y,
                                         hhd.direction.z};
        for (int i = 0; i < OF_COLOUR; ++i) {
            channel[OF_COLOUR * c + i] = stored[i];
        }
    }
}

static void three_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                           lmb_rgb *irradiance)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    for (int c = 0; c < 3; ++c) {
        const float *stored = &channel[OF_COLOUR * c];
        const lmb_hhd hhd = {stored[0], stored[1], {stored[2], stored[3], stored[4]}};
        for (int i = 0; i < count; ++i) {
            irradiance[i].c[c] = lmb_hhd_evaluate(&hhd, n, normal[i]);
        }
    }
}

const lmb_model lmb_model_hhd_three_gram = {
    .name = "hhd.three.gram",
    .title = "HHD, closed form, one of each colour",
    .channel_count = THREE_CHANNELS,
    .bytes = 2 * THREE_CHANNELS,
    .cone = true,
    .encode = three_encode,
    .evaluate = three_evaluate,
};
