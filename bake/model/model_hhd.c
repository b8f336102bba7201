/* HHD by the closed form from moments of the Gram multiply, as the papers have it (lambent/hhd.h). */
#include <lambent/hhd.h>

#include "model/clipped.h"
#include "model/models.h"

/* C_a and C_d of each colour, then d. */
enum { AMBIENT, DIRECTIONAL = 3, DIRECTION = 6, CHANNELS = 9 };

static void store(const lmb_hhd_rgb *hhd, float *channel)
{
    for (int c = 0; c < 3; ++c) {
        channel[AMBIENT + c] = hhd->ambient.c[c];
        channel[DIRECTIONAL + c] = hhd->directional.c[c];
    }
    channel[DIRECTION] = hhd->direction.x;
    channel[DIRECTION + 1] = hhd->direction.y;
    channel[DIRECTION + 2] = hhd->direction.z;
}

/* How much of each colour there is in a light whose luminance was solved: by I_z, which stays exact so; of light at the
 * horizon, whose I_z is 0, by the scalar moment. */
static float share_of(lmb_moments colour, lmb_moments luminance, lmb_vec3 n)
{
    const float all = lmb_vec3_dot(luminance.vector, n);
    return all > 0.0f ? lmb_light_clamped(lmb_vec3_dot(colour.vector, n)) / all
                      : lmb_light_clamped(colour.scalar) / luminance.scalar;
}

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
        const float share = share_of(moments[c], luminance, n);
        hhd.ambient.c[c] = lmb_light_clamped(solved.ambient * share);
        hhd.directional.c[c] = lmb_light_clamped(solved.directional * share);
    }
    store(&hhd, channel);
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    const lmb_hhd_rgb hhd = {{{channel[AMBIENT], channel[AMBIENT + 1], channel[AMBIENT + 2]}},
                             {{channel[DIRECTIONAL], channel[DIRECTIONAL + 1], channel[DIRECTIONAL + 2]}},
                             {channel[DIRECTION], channel[DIRECTION + 1], channel[DIRECTION + 2]}};
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_hhd_rgb_evaluate(&hhd, n, normal[i]);
    }
}

const lmb_model lmb_model_hhd_closed_gram = {
    .name = "hhd.closed.gram",
    .title = "HHD, closed form, colours share w and d",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .encode = closed_encode,
    .evaluate = evaluate,
};
