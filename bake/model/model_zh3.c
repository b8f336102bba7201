/* ZH3: SH2 and of band 2 only what is zonal about the direction of the linear band, which colours share; or that
 * guessed from SH2 (Roughton, Sloan, Silvennoinen, Iwanicki and Shirley, "ZH3: Quadratic Zonal Harmonics", 2024). */
#include <lambent/sh.h>

#include "model/clipped.h"
#include "model/models.h"

enum { ZONAL = 3 * LMB_SH2_COUNT, SH2_CHANNELS = ZONAL, CHANNELS = ZONAL + 3 };

/* sqrt(5/(4 pi)), the zonal harmonic at its own axis */
#define ZONAL_PEAK 0.63078313f

/* The direction of the luminance's linear band. */
static lmb_vec3 shared_axis(const float *channel)
{
    lmb_vec3 v = {0.0f, 0.0f, 0.0f};
    const float share[3] = {0.2126f, 0.7152f, 0.0722f};
    for (int c = 0; c < 3; ++c) {
        v = lmb_vec3_mad(v, lmb_linear_band(&channel[LMB_SH2_COUNT * c]), share[c]);
    }
    return lmb_vec3_unit_or(v, lmb_vec3_of(0.0f, 1.0f, 0.0f));
}

static void linear_store(const lmb_sh3_rgb *radiance, float *channel)
{
    for (int i = 0; i < SH2_CHANNELS; ++i) {
        channel[i] = radiance->channel[i / LMB_SH2_COUNT].c[i % LMB_SH2_COUNT];
    }
}

static void store(const lmb_sh3_rgb *radiance, float *channel)
{
    linear_store(radiance, channel);
    const lmb_vec3 axis = shared_axis(channel);
    for (int c = 0; c < 3; ++c) {
        lmb_sh3 quadratic = radiance->channel[c];
        for (int i = 0; i < LMB_SH2_COUNT; ++i) {
            quadratic.c[i] = 0.0f;
        }
        channel[ZONAL + c] = lmb_sh3_evaluate(&quadratic, axis) * (1.0f / ZONAL_PEAK);
    }
}

static void gram_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    store(&clipped, channel);
}

static void unoccluded_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)vertex_normal;
    (void)cone_cos;
    store(radiance, channel);
}

static void linear_unoccluded_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos,
                                     float *channel)
{
    (void)vertex_normal;
    (void)cone_cos;
    linear_store(radiance, channel);
}

/* Normalised irradiance of SH2 and of zonal coefficients `k` about `axis`. */
static void zonal_evaluate(const float *channel, lmb_vec3 axis, const float k[3], const lmb_vec3 *normal, int count,
                           lmb_rgb *irradiance)
{
    for (int c = 0; c < 3; ++c) {
        const float *l = &channel[LMB_SH2_COUNT * c];
        const lmb_vec3 v = lmb_vec3_scale(lmb_linear_band(l), 2.0f / 3.0f * LMB_N1);
        for (int i = 0; i < count; ++i) {
            const float cosine = lmb_vec3_dot(axis, normal[i]);
            const float zonal = 0.25f * LMB_N20 * k[c] * (3.0f * cosine * cosine - 1.0f);
            irradiance[i].c[c] = lmb_light_clamped(l[0] * LMB_N0 + lmb_vec3_dot(v, normal[i]) + zonal);
        }
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    zonal_evaluate(channel, shared_axis(channel), &channel[ZONAL], normal, count, irradiance);
}

/* k = l0 r (0.08 + 0.6 r), r = |v.axis|/l0 */
static void hallucinated_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                                  lmb_rgb *irradiance)
{
    (void)vertex_normal;
    const lmb_vec3 axis = shared_axis(channel);
    float k[3];
    for (int c = 0; c < 3; ++c) {
        const float *l = &channel[LMB_SH2_COUNT * c];
        const float along = fabsf(lmb_vec3_dot(lmb_linear_band(l), axis));
        k[c] = l[0] > 0.0f ? along * (0.08f + 0.6f * (along / l[0])) : 0.0f;
    }
    zonal_evaluate(channel, axis, k, normal, count, irradiance);
}

const lmb_model lmb_model_zh3_gram = {
    .name = "zh3.gram",
    .title = "ZH3 of the quadratic multiply",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .cone = true,
    .encode = gram_encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_zh3_unoccluded = {
    .name = "zh3.unoccluded",
    .title = "ZH3 of all light",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .unoccluded = true,
    .encode = unoccluded_encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_zh3_hallucinated_gram = {
    .name = "zh3.hallucinated.gram",
    .title = "ZH3 guessed from the multiplied SH2",
    .channel_count = SH2_CHANNELS,
    .bytes = 2 * SH2_CHANNELS,
    LMB_LINEAR_ROW(SH2_CHANNELS),
    .cone = true,
    .encode = lmb_clipped_sh2,
    .evaluate = hallucinated_evaluate,
};

const lmb_model lmb_model_zh3_hallucinated_unoccluded = {
    .name = "zh3.hallucinated.unoccluded",
    .title = "ZH3 guessed from SH2 of all light",
    .channel_count = SH2_CHANNELS,
    .bytes = 2 * SH2_CHANNELS,
    .unoccluded = true,
    .encode = linear_unoccluded_encode,
    .evaluate = hallucinated_evaluate,
};
