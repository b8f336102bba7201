/* The dominant light of a texel (Chen and Liu, "Lighting and Material of Halo 3", 2008), for highlights: the intensity
 * c that brings SH of one light nearest to the texel's, sum of l_i Y_i(d) over sum of Y_i(d)^2, along its linear band.
 * Filterable: stored is not the unit direction but the linear band itself, whose mean is that of the texels' light; its
 * direction after filtering is the one that filtered harmonics would have. */
#include <lambent/sh.h>

#include "model/clipped.h"
#include "model/models.h"

/* c of each colour, then v of luminance: L1(n) = sqrt(3/(4 pi)) v.n. */
enum { INTENSITY = 0, DIRECTION = 3, CHANNELS = 6 };

static const char *const names[CHANNELS] = {"R", "G", "B", "d.X", "d.Y", "d.Z"};
static const lmb_model_part parts[] = {
    {"intensity", 3, 0.0f, 0.0f}, {"direction", 3, 0.0f, 0.0f}, {NULL, 0, 0.0f, 0.0f}};

/* Of nine coefficients, for any direction. */
#define SQUARED_BASIS (9.0f / (4.0f * LMB_PI_F))

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    const lmb_sh3 luminance = lmb_sh3_rgb_luminance(&clipped);
    const lmb_vec3 v = lmb_linear_band(luminance.c);
    const lmb_vec3 d = lmb_vec3_unit_or(v, lmb_unit_normal(vertex_normal));
    for (int c = 0; c < 3; ++c) {
        channel[INTENSITY + c] = lmb_light_clamped(lmb_sh3_evaluate(&clipped.channel[c], d) / SQUARED_BASIS);
    }
    channel[DIRECTION] = v.x;
    channel[DIRECTION + 1] = v.y;
    channel[DIRECTION + 2] = v.z;
}

/* Irradiance of that light alone. */
static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    const lmb_vec3 v = {channel[DIRECTION], channel[DIRECTION + 1], channel[DIRECTION + 2]};
    const lmb_vec3 d = lmb_vec3_unit_or(v, lmb_unit_normal(vertex_normal));
    for (int i = 0; i < count; ++i) {
        const float cosine = lmb_larger(lmb_vec3_dot(normal[i], d), 0.0f) * (1.0f / LMB_PI_F);
        for (int c = 0; c < 3; ++c) {
            irradiance[i].c[c] = lmb_light_clamped(channel[INTENSITY + c] * cosine);
        }
    }
}

const lmb_model lmb_model_dominant = {
    .name = "dominant",
    .title = "the dominant light alone, for highlights",
    .uses = LMB_MODEL_FOR_LIGHTMAP,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .convention =
        "R, G, B: radiance times solid angle of the dominant light; d.XYZ: the linear band of luminance in world "
        "space, +Y up, whose direction is the light's; all / lambent:scale",
    .encode = encode,
    .evaluate = evaluate,
};
