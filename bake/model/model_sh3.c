/* SH3 as it is: radiance of which nothing is clipped (lambent/sh.h). */
#include "model/models.h"

enum { CHANNELS = 3 * LMB_SH3_COUNT };

/* Coefficient by coefficient, R G B of each. */
static const char *const names[CHANNELS] = {"R",    "G",    "B",    "y1.R", "y1.G", "y1.B", "y2.R", "y2.G", "y2.B",
                                            "y3.R", "y3.G", "y3.B", "y4.R", "y4.G", "y4.B", "y5.R", "y5.G", "y5.B",
                                            "y6.R", "y6.G", "y6.B", "y7.R", "y7.G", "y7.B", "y8.R", "y8.G", "y8.B"};

static const lmb_model_part parts[] = {{"radiance", CHANNELS, 0.0f, 0.0f}, {NULL, 0, 0.0f, 0.0f}};

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)vertex_normal;
    (void)cone_cos;
    for (int i = 0; i < CHANNELS; ++i) {
        channel[i] = radiance->channel[i % 3].c[i / 3];
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    lmb_sh3_rgb radiance;
    for (int i = 0; i < CHANNELS; ++i) {
        radiance.channel[i % 3].c[i / 3] = channel[i];
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh3_rgb_irradiance(&radiance, normal[i]);
    }
}

const lmb_model lmb_model_sh3 = {
    .name = "sh3",
    .full_name = "sh3.unoccluded",
    .short_name = "sh3",
    .title = "SH3",
    .uses = LMB_MODEL_FOR_SURFACE | LMB_MODEL_FOR_OBJECT,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .unoccluded = true,
    .convention =
        "R G B, y1 .. y8: SH coefficients of radiance in world space, +Y up (docs/maths.md), / lambent:scale, "
        "linear Rec. 709",
    .encode = encode,
    .evaluate = evaluate,
};
