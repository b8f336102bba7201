/* SH2 of what a hemisphere or a cone lets through: the quadratic to linear multiply, convolved with the cosine. */
#include <lambent/occlusion.h>

#include "model/clipped.h"
#include "model/models.h"

enum { CHANNELS = 3 * LMB_SH2_COUNT };

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    for (int c = 0; c < 3; ++c) {
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance->channel[c], n, cone_cos);
        for (int i = 0; i < LMB_SH2_COUNT; ++i) {
            channel[LMB_SH2_COUNT * c + i] = clipped.c[i];
        }
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    lmb_sh3_rgb radiance = {0};
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH2_COUNT; ++i) {
            radiance.channel[c].c[i] = channel[LMB_SH2_COUNT * c + i];
        }
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh3_rgb_irradiance(&radiance, normal[i]);
    }
}

const lmb_model lmb_model_sh2 = {
    .name = "sh2",
    .title = "SH2, quadratic to linear multiply",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .encode = encode,
    .evaluate = evaluate,
};
