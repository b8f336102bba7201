/* SH3 of what a hemisphere or a cone lets through, and what is made of SH3 without that: scaled by ambient occlusion,
 * along the bent normal, and packed for a shader as Halo 3 has it. */
#include <lambent/sh.h>

#include "model/clipped.h"
#include "model/models.h"

/* Coefficient by coefficient of each colour; behind them a visibility. */
enum { VISIBILITY = 3 * LMB_SH3_COUNT, SH3_CHANNELS = VISIBILITY, AO_CHANNELS = VISIBILITY + 1 };

static void store(const lmb_sh3_rgb *sh3, float *channel)
{
    for (int i = 0; i < SH3_CHANNELS; ++i) {
        channel[i] = sh3->channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
    }
}

static lmb_sh3_rgb stored(const float *channel)
{
    lmb_sh3_rgb sh3;
    for (int i = 0; i < SH3_CHANNELS; ++i) {
        sh3.channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] = channel[i];
    }
    return sh3;
}

static void gram_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    store(&clipped, channel);
}

static void gram_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                          lmb_rgb *irradiance)
{
    (void)vertex_normal;
    const lmb_sh3_rgb sh3 = stored(channel);
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh3_rgb_irradiance(&sh3, normal[i]);
    }
}

static void gram_radiance(const float *channel, lmb_vec3 vertex_normal, lmb_sh3_rgb *radiance)
{
    const lmb_sh3_rgb clipped = stored(channel);
    *radiance = lmb_unclipped_sh3_rgb(&clipped, vertex_normal);
}

const lmb_model lmb_model_sh3_gram = {
    .name = "sh3.gram",
    .title = "SH3, quadratic multiply",
    .channel_count = SH3_CHANNELS,
    .bytes = 2 * SH3_CHANNELS,
    LMB_LINEAR_ROW(SH3_CHANNELS),
    .cone = true,
    .encode = gram_encode,
    .evaluate = gram_evaluate,
    .radiance = gram_radiance,
};

/* Cosine-weighted visibility at the axis. */
static void ao_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)vertex_normal;
    const float c = lmb_saturate(cone_cos);
    store(radiance, channel);
    channel[VISIBILITY] = 1.0f - c * c;
}

/* The share of a white sky that a hemisphere lets through to a normal t off its own: (1 + t)/2. */
static float horizon_visibility(lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    return lmb_saturate(0.5f + 0.5f * lmb_vec3_dot(vertex_normal, normal));
}

static void ao_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                        lmb_rgb *irradiance)
{
    const lmb_vec3 n_v = lmb_unit_normal(vertex_normal);
    const lmb_sh3_rgb sh3 = stored(channel);
    for (int i = 0; i < count; ++i) {
        const float visibility = channel[VISIBILITY] * horizon_visibility(n_v, normal[i]);
        irradiance[i] = lmb_rgb_scale(lmb_sh3_rgb_irradiance(&sh3, normal[i]), visibility);
    }
}

const lmb_model lmb_model_sh3_ao = {
    .name = "sh3.ao",
    .title = "SH3 x ambient occlusion",
    .channel_count = AO_CHANNELS,
    .bytes = 2 * AO_CHANNELS,
    .cone = true,
    .encode = ao_encode,
    .evaluate = ao_evaluate,
};

/* The mean direction of what both normals see is halfway between them. */
static void bent_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                          lmb_rgb *irradiance)
{
    const lmb_vec3 n_v = lmb_unit_normal(vertex_normal);
    const lmb_sh3_rgb sh3 = stored(channel);
    for (int i = 0; i < count; ++i) {
        const float visibility = channel[VISIBILITY] * horizon_visibility(n_v, normal[i]);
        const lmb_vec3 bent = lmb_vec3_unit_or(lmb_vec3_add(normal[i], n_v), normal[i]);
        irradiance[i] = lmb_rgb_scale(lmb_sh3_rgb_irradiance(&sh3, bent), visibility);
    }
}

const lmb_model lmb_model_sh3_bent = {
    .name = "sh3.bent",
    .title = "SH3 along the bent normal x ambient occlusion",
    .channel_count = AO_CHANNELS,
    .bytes = 2 * AO_CHANNELS,
    .cone = true,
    .encode = ao_encode,
    .evaluate = bent_evaluate,
};

/* Chen and Liu, "Lighting and Material of Halo 3", 2008, listing 1: three constants of each colour for band 1, three
 * and four for band 2, after l0 of all. */
enum { CONSTANT = 0, COLOUR = 3, LINEAR = 0, CROSS = 3, SQUARE = 6, OF_COLOUR = 10, HALO3_CHANNELS = 33 };

static void halo3_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)vertex_normal;
    (void)cone_cos;
    for (int c = 0; c < 3; ++c) {
        const float *l = radiance->channel[c].c;
        const float packed[OF_COLOUR] = {
            l[3], l[1], -l[2], -l[4], l[5], l[7], -l[8], l[8], -l[6] * 1.7320508f, l[6] * 1.7320508f};
        channel[CONSTANT + c] = l[0];
        for (int i = 0; i < OF_COLOUR; ++i) {
            channel[COLOUR + OF_COLOUR * c + i] = packed[i];
        }
    }
}

static void halo3_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                           lmb_rgb *irradiance)
{
    (void)vertex_normal;
    const float c1 = 0.429043f, c2 = 0.511664f, c4 = 0.886227f;
    for (int i = 0; i < count; ++i) {
        const lmb_vec3 n = normal[i];
        for (int c = 0; c < 3; ++c) {
            const float *k = &channel[COLOUR + OF_COLOUR * c];
            const float linear = n.x * k[LINEAR] + n.y * k[LINEAR + 1] + n.z * k[LINEAR + 2];
            const float cross = n.x * n.y * k[CROSS] + n.y * n.z * k[CROSS + 1] + n.z * n.x * k[CROSS + 2];
            const float square = n.x * n.x * k[SQUARE] + n.y * n.y * k[SQUARE + 1] + n.z * n.z * k[SQUARE + 2] +
                                 k[SQUARE + 3] * (1.0f / 3.0f);
            const float sum = c4 * channel[CONSTANT + c] - 2.0f * c2 * linear - 2.0f * c1 * cross - c1 * square;
            irradiance[i].c[c] = lmb_light_clamped(sum * (1.0f / LMB_PI_F));
        }
    }
}

const lmb_model lmb_model_sh3_halo3 = {
    .name = "sh3.halo3",
    .title = "SH3 unoccluded, packed as in Halo 3",
    .channel_count = HALO3_CHANNELS,
    .bytes = 2 * HALO3_CHANNELS,
    .unoccluded = true,
    .encode = halo3_encode,
    .evaluate = halo3_evaluate,
};
