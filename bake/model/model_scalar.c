/* Scalar irradiance: I_z alone, whatever the shading normal. */
#include <lambent/hhd.h>
#include <lambent/occlusion.h>

#include "model/clipped.h"
#include "model/models.h"

enum { CHANNELS = 3 };

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    lmb_moments moments[3];
    lmb_clipped_moments(radiance, vertex_normal, cone_cos, moments);
    for (int c = 0; c < 3; ++c) {
        channel[c] = lmb_vec3_dot(moments[c].vector, lmb_unit_normal(vertex_normal));
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    (void)normal;
    for (int i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c) {
            irradiance[i].c[c] = lmb_light_clamped(channel[c]);
        }
    }
}

const lmb_model lmb_model_scalar = {
    .name = "scalar",
    .title = "scalar irradiance I_z",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .irradiance_first = true,
    .cone = true,
    .encode = encode,
    .evaluate = evaluate,
};
