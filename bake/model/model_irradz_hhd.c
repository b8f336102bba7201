/* IrradZ: HHD in the form that lightmaps store (lambent/hhd.h), of a texel's SH3 or of a probe's. */
#include <lambent/hhd.h>
#include <lambent/vector.h>

#include "model/models.h"

enum { R, G, B, DIRECTION, WEIGHT = DIRECTION + 3, CHANNELS };

static const char *const names[CHANNELS] = {"R", "G", "B", "d.X", "d.Y", "d.Z", "w"};

static const lmb_model_part parts[] = {{"irradiance", 3, 0.0f, 0.0f},
                                       {"direction", 3, -1.0f, 1.0f},
                                       {"ambient_weight", 1, 0.0f, 1.0f},
                                       {NULL, 0, 0.0f, 0.0f}};

static lmb_irradz irradz_of(const float *channel)
{
    return (lmb_irradz){{{channel[R], channel[G], channel[B]}},
                        channel[WEIGHT],
                        {channel[DIRECTION], channel[DIRECTION + 1], channel[DIRECTION + 2]}};
}

static void store(const lmb_irradz *irradz, float *channel)
{
    for (int c = 0; c < 3; ++c) {
        channel[c] = irradz->irradiance_z.c[c];
    }
    channel[WEIGHT] = irradz->ambient_weight;
    channel[DIRECTION] = irradz->direction.x;
    channel[DIRECTION + 1] = irradz->direction.y;
    channel[DIRECTION + 2] = irradz->direction.z;
}

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_irradz irradz = lmb_irradz_encode(radiance, vertex_normal, cone_cos);
    store(&irradz, channel);
}

static void probe_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_irradz irradz = lmb_irradz_from_probe(radiance, vertex_normal, cone_cos);
    store(&irradz, channel);
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    const lmb_irradz irradz = irradz_of(channel);
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_irradz_evaluate(&irradz, vertex_normal, normal[i]);
    }
}

static void average(float *channel, float total)
{
    const lmb_irradz sum = irradz_of(channel);
    const lmb_rgb light = lmb_rgb_scale(sum.irradiance_z, 1.0f / total);
    const lmb_vec3 direction = lmb_vec3_unit_or(sum.direction, sum.direction);
    for (int c = 0; c < 3; ++c) {
        channel[c] = light.c[c];
    }
    channel[WEIGHT] = sum.ambient_weight / total;
    channel[DIRECTION] = direction.x;
    channel[DIRECTION + 1] = direction.y;
    channel[DIRECTION + 2] = direction.z;
}

static void unit_decode(const float *channel, lmb_vec3 normal, float *ambient, float *directional, float *height)
{
    lmb_irradz unit = irradz_of(channel);
    unit.irradiance_z = lmb_rgb_of(1.0f, 1.0f, 1.0f);
    const lmb_hhd_rgb hhd = lmb_irradz_decode(&unit, normal);
    *ambient = hhd.ambient.c[0];
    *directional = hhd.directional.c[0];
    *height = lmb_vec3_dot(hhd.direction, normal);
}

static const lmb_model_direction direction = {
    .weight = WEIGHT, .first = DIRECTION, .min_height = LMB_IRRADZ_MIN_COS, .decode = unit_decode};

static const char convention[] =
    "irradiance: normalised (integral of L cos / pi), at the vertex normal, linear Rec. 709; d: direction in world "
    "space, +Y up, filter and decode as it is; w: ambient weight";

const lmb_model lmb_model_irradz_hhd = {
    .name = "irradz-hhd",
    .short_name = "hhd",
    .title = "IrradZ",
    .uses = LMB_MODEL_FOR_LIGHTMAP | LMB_MODEL_FOR_TEXTURE,
    .default_uses = LMB_MODEL_FOR_LIGHTMAP,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = 3,
    .irradiance_first = true,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .convention = convention,
    .encode = encode,
    .evaluate = evaluate,
    .average = average,
    .direction = &direction,
};

const lmb_model lmb_model_hhd_closed_fitted = {
    .name = "hhd.closed.fitted",
    .short_name = "hhd",
    .title = "IrradZ by the fitted multiply",
    .uses = LMB_MODEL_FOR_SURFACE | LMB_MODEL_FOR_OBJECT,
    .default_uses = LMB_MODEL_FOR_SURFACE,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = 3,
    .irradiance_first = true,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .convention = convention,
    .encode = probe_encode,
    .evaluate = evaluate,
    .average = average,
    .direction = &direction,
};
