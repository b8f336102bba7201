/* IrradZ with its direction as a point of the disc (lambent/direction_disc.h): what compressed textures hold. */
#include <lambent/direction_disc.h>
#include <lambent/hhd.h>
#include <lambent/vector.h>

#include "model/models.h"

enum { R, G, B, WEIGHT, X, Y, CHANNELS };

static const char *const names[CHANNELS] = {"R", "G", "B", "w", "p.x", "p.y"};

static const lmb_model_part parts[] = {{.name = "irradiance", .count = 3},
                                       {.name = "ambient_weight", .count = 1, .low = 0.0f, .high = 1.0f},
                                       {.name = "direction", .count = 2, .low = -1.0f, .high = 1.0f},
                                       {.name = NULL, .count = 0}};

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_irradz irradz = lmb_irradz_encode(radiance, vertex_normal, cone_cos);
    for (int c = 0; c < 3; ++c) {
        channel[c] = irradz.irradiance_z.c[c];
    }
    channel[WEIGHT] = irradz.ambient_weight;
    lmb_disc_from_direction(irradz.direction, vertex_normal, &channel[X], &channel[Y]);
}

static lmb_irradz irradz_of(const float *channel, lmb_vec3 vertex_normal)
{
    return (lmb_irradz){{{channel[R], channel[G], channel[B]}},
                        channel[WEIGHT],
                        lmb_disc_to_direction(channel[X], channel[Y], vertex_normal)};
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    const lmb_irradz irradz = irradz_of(channel, vertex_normal);
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_irradz_evaluate(&irradz, vertex_normal, normal[i]);
    }
}

static void unit_decode(const float *channel, lmb_vec3 normal, float *ambient, float *directional, float *height)
{
    lmb_irradz unit = irradz_of(channel, normal);
    unit.irradiance_z = lmb_rgb_of(1.0f, 1.0f, 1.0f);
    const lmb_hhd_rgb hhd = lmb_irradz_decode(&unit, normal);
    *ambient = hhd.ambient.c[0];
    *directional = hhd.directional.c[0];
    *height = lmb_vec3_dot(hhd.direction, normal);
}

static const lmb_model_direction direction = {
    .weight = WEIGHT, .first = LMB_MODEL_NO_LENGTH, .min_height = LMB_DISC_MIN_COS, .decode = unit_decode};

const lmb_model lmb_model_irradz_disc = {
    .name = "irradz-hhd.disc",
    .short_name = "disc",
    .title = "IrradZ, direction on the disc",
    .uses = LMB_MODEL_FOR_LIGHTMAP | LMB_MODEL_FOR_TEXTURE,
    .default_uses = LMB_MODEL_FOR_TEXTURE,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = 3,
    .irradiance_first = true,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .convention = "irradiance: normalised (integral of L cos / pi), at the vertex normal, linear Rec. 709; w: ambient "
                  "weight; p: direction on the disc about the vertex normal",
    .encode = encode,
    .evaluate = evaluate,
    .direction = &direction,
};
