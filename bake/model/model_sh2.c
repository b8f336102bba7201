/* SH2: of all light, and of what a hemisphere or a cone lets through, by the quadratic to linear multiply or by that of
 * SH2 alone; and the non-linear irradiance that Geomerics made of SH2. */
#include "model/clipped.h"
#include "model/models.h"

enum { CHANNELS = 3 * LMB_SH2_COUNT };

/* Forgets band 2 first. */
static void linear_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    lmb_sh3_rgb linear = *radiance;
    for (int c = 0; c < 3; ++c) {
        for (int i = LMB_SH2_COUNT; i < LMB_SH3_COUNT; ++i) {
            linear.channel[c].c[i] = 0.0f;
        }
    }
    lmb_clipped_sh2(&linear, vertex_normal, cone_cos, channel);
}

static void unoccluded_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)vertex_normal;
    (void)cone_cos;
    for (int i = 0; i < CHANNELS; ++i) {
        channel[i] = radiance->channel[i / LMB_SH2_COUNT].c[i % LMB_SH2_COUNT];
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    lmb_sh2_rgb sh2;
    for (int i = 0; i < CHANNELS; ++i) {
        sh2.channel[i / LMB_SH2_COUNT].c[i % LMB_SH2_COUNT] = channel[i];
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh2_rgb_irradiance(&sh2, normal[i]);
    }
}

const lmb_model lmb_model_sh2 = {
    .name = "sh2",
    .title = "SH2, quadratic to linear multiply",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .at_run_time = true,
    .cone = true,
    .encode = lmb_clipped_sh2,
    .evaluate = evaluate,
};

const lmb_model lmb_model_sh2_linear = {
    .name = "sh2.linear",
    .title = "SH2, linear multiply",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .encode = linear_encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_sh2_unoccluded = {
    .name = "sh2.unoccluded",
    .title = "SH2 of all light",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .unoccluded = true,
    .encode = unoccluded_encode,
    .evaluate = evaluate,
};

/* R0 [a + (1-a)(p+1) q^p], q = (1 + n.R1/|R1|)/2, p = 1 + 2 |R1|/R0, a = (1 - |R1|/R0)/(1 + |R1|/R0), with the mean
 * radiance R0 = l0/(2 sqrt(pi)) and R1 = v/(2 sqrt(3 pi)) (Martin, "Enlighten real-time radiosity", 2011). */
static void geomerics_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                               lmb_rgb *irradiance)
{
    (void)vertex_normal;
    const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
    for (int c = 0; c < 3; ++c) {
        const float *l = &channel[LMB_SH2_COUNT * c];
        const float r0 = l[0] * LMB_N0;
        const lmb_vec3 v = lmb_linear_band(l);
        const float share = r0 > 0.0f ? lmb_saturate(lmb_vec3_length(v) * (1.0f / 6.1399602f) / r0) : 0.0f;
        const float p = 1.0f + 2.0f * share, a = (1.0f - share) / (1.0f + share);
        const lmb_vec3 d = lmb_vec3_unit_or(v, none);
        for (int i = 0; i < count; ++i) {
            const float q = lmb_saturate(0.5f + 0.5f * lmb_vec3_dot(normal[i], d));
            irradiance[i].c[c] = lmb_light_clamped(r0 * (a + (1.0f - a) * (p + 1.0f) * powf(q, p)));
        }
    }
}

const lmb_model lmb_model_geomerics_gram = {
    .name = "geomerics.gram",
    .title = "Geomerics' non-linear SH2, multiplied",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .cone = true,
    .encode = lmb_clipped_sh2,
    .evaluate = geomerics_evaluate,
};

const lmb_model lmb_model_geomerics_unoccluded = {
    .name = "geomerics.unoccluded",
    .title = "Geomerics' non-linear SH2 of all light",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .unoccluded = true,
    .encode = unoccluded_encode,
    .evaluate = geomerics_evaluate,
};
