/* Radiosity normal mapping (lambent/rnm.h), of a texel's SH3, and of the light itself. */
#include <lambent/rnm.h>

#include "model/clipped.h"
#include "model/models.h"

enum { CHANNELS = 3 * LMB_RNM_SLOPES };

static const char *const names[CHANNELS] = {"1.R", "1.G", "1.B", "2.R", "2.G", "2.B", "3.R", "3.G", "3.B"};

static const lmb_model_part parts[] = {
    {"slope_1", 3, 0.0f, 0.0f}, {"slope_2", 3, 0.0f, 0.0f}, {"slope_3", 3, 0.0f, 0.0f}, {NULL, 0, 0.0f, 0.0f}};

static void store(const lmb_rnm *rnm, float *channel)
{
    for (int i = 0; i < CHANNELS; ++i) {
        channel[i] = rnm->light[i / 3].c[i % 3];
    }
}

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)cone_cos;
    const lmb_rnm rnm = lmb_rnm_from_sh3(radiance, vertex_normal);
    store(&rnm, channel);
}

static void encode_light(const lmb_directed_light *light, size_t count, lmb_vec3 vertex_normal, float *channel)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(n, slope);
    lmb_rnm rnm = {{{{0.0f}}}};
    for (size_t i = 0; i < count; ++i) {
        lmb_rnm_add_light(&rnm, n, slope, light[i].direction, light[i].weight);
    }
    store(&rnm, channel);
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(vertex_normal, slope);
    lmb_rnm rnm;
    for (int i = 0; i < CHANNELS; ++i) {
        rnm.light[i / 3].c[i % 3] = channel[i];
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_rnm_evaluate(&rnm, slope, normal[i]);
    }
}

const lmb_model lmb_model_rnm = {
    .name = "rnm",
    .title = "radiosity normal mapping",
    .uses = LMB_MODEL_FOR_LIGHTMAP,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .convention =
        "1, 2, 3: normalised irradiance (integral of L cos / pi) on slopes B1, B2, B3 about the vertex normal "
        "(lambent/rnm.h) / lambent:scale, linear Rec. 709",
    .encode = encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_rnm_light = {
    .name = "rnm.light",
    .title = "radiosity normal mapping of the light itself",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .encode_light = encode_light,
    .evaluate = evaluate,
};
