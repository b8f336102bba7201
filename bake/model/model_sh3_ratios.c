/* SH3 of what the hemisphere lets through as compressed textures hold it: l0 as a colour, and the other coefficients
 * over l0, which light bounds (|band 1| <= sqrt(3), |band 2| <= sqrt(5)); of each colour, or of luminance for all
 * three. What filtering leaves is l0 filtered times ratios filtered. */
#include <lambent/sh.h>
#include <lambent/vector.h>

#include "model/clipped.h"
#include "model/models.h"

enum {
    COLOURS = 3,
    LINEAR = 3,
    QUADRATIC = 5,
    RATIOS = LINEAR + QUADRATIC,
    OWN_CHANNELS = COLOURS + COLOURS * RATIOS,
    SHARED_CHANNELS = COLOURS + RATIOS
};

#define LINEAR_MOST 1.7320508f
#define QUADRATIC_MOST 2.2360680f

/* 0 where there is no light. */
static float ratio_of(const lmb_sh3 *sh3, int i)
{
    const float most = i <= LINEAR ? LINEAR_MOST : QUADRATIC_MOST;
    const float ratio = sh3->c[0] > 0.0f ? sh3->c[i] / sh3->c[0] : 0.0f;
    return lmb_larger(lmb_smaller(ratio, most), -most);
}

/* The ratio i, from 1, of a colour lies with those of the same i, so that a layer for each colour is next to it. */
static void own_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    for (int c = 0; c < COLOURS; ++c) {
        channel[c] = lmb_larger(clipped.channel[c].c[0], 0.0f);
        for (int i = 1; i <= RATIOS; ++i) {
            channel[COLOURS * i + c] = ratio_of(&clipped.channel[c], i);
        }
    }
}

static void shared_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    lmb_sh3 luminance;
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        luminance.c[i] =
            lmb_luminance(lmb_rgb_of(clipped.channel[0].c[i], clipped.channel[1].c[i], clipped.channel[2].c[i]));
    }
    for (int c = 0; c < COLOURS; ++c) {
        channel[c] = lmb_larger(clipped.channel[c].c[0], 0.0f);
    }
    for (int i = 1; i <= RATIOS; ++i) {
        channel[COLOURS + i - 1] = ratio_of(&luminance, i);
    }
}

/* Colour c's ratio i lies `each` (i - 1) + `colour` c behind l0. */
static lmb_sh3_rgb ratios_decode(const float *channel, int each, int colour)
{
    lmb_sh3_rgb sh3;
    for (int c = 0; c < COLOURS; ++c) {
        const float l0 = lmb_larger(channel[c], 0.0f);
        sh3.channel[c].c[0] = l0;
        for (int i = 1; i <= RATIOS; ++i) {
            sh3.channel[c].c[i] = l0 * channel[COLOURS + each * (i - 1) + c * colour];
        }
    }
    return sh3;
}

static void ratios_evaluate(const float *channel, int each, int colour, const lmb_vec3 *normal, int count,
                            lmb_rgb *irradiance)
{
    const lmb_sh3_rgb sh3 = ratios_decode(channel, each, colour);
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh3_rgb_irradiance(&sh3, normal[i]);
    }
}

static void own_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                         lmb_rgb *irradiance)
{
    (void)vertex_normal;
    ratios_evaluate(channel, COLOURS, 1, normal, count, irradiance);
}

static void shared_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                            lmb_rgb *irradiance)
{
    (void)vertex_normal;
    ratios_evaluate(channel, 1, 0, normal, count, irradiance);
}

static void own_radiance(const float *channel, lmb_vec3 vertex_normal, lmb_sh3_rgb *radiance)
{
    const lmb_sh3_rgb clipped = ratios_decode(channel, COLOURS, 1);
    *radiance = lmb_unclipped_sh3_rgb(&clipped, vertex_normal);
}

static void shared_radiance(const float *channel, lmb_vec3 vertex_normal, lmb_sh3_rgb *radiance)
{
    const lmb_sh3_rgb clipped = ratios_decode(channel, 1, 0);
    *radiance = lmb_unclipped_sh3_rgb(&clipped, vertex_normal);
}

static const lmb_model_part own_parts[] = {
    {.name = "l0", .count = COLOURS},
    {.name = "linear", .count = COLOURS * LINEAR, .low = -LINEAR_MOST, .high = LINEAR_MOST},
    {.name = "quadratic", .count = COLOURS * QUADRATIC, .low = -QUADRATIC_MOST, .high = QUADRATIC_MOST},
    {.name = NULL}};

static const lmb_model_part shared_parts[] = {
    {.name = "l0", .count = COLOURS},
    {.name = "linear", .count = LINEAR, .low = -LINEAR_MOST, .high = LINEAR_MOST},
    {.name = "quadratic", .count = QUADRATIC, .low = -QUADRATIC_MOST, .high = QUADRATIC_MOST},
    {.name = NULL}};

const lmb_model lmb_model_sh3_ratios = {
    .name = "sh3.ratios",
    .title = "SH3, bands over l0",
    .uses = LMB_MODEL_FOR_LIGHTMAP | LMB_MODEL_FOR_TEXTURE,
    .channel_count = OWN_CHANNELS,
    .channel_name = lmb_numbered_channels,
    .part = own_parts,
    .light_count = COLOURS,
    .bytes = 2 * OWN_CHANNELS,
    .cone = true,
    .convention = "l0 of SH3 radiance above the horizon, red, green and blue; then each other coefficient over it",
    .encode = own_encode,
    .evaluate = own_evaluate,
    .radiance = own_radiance,
};

const lmb_model lmb_model_sh3_shared_ratios = {
    .name = "sh3.shared-ratios",
    .title = "SH3, bands of luminance over l0",
    .uses = LMB_MODEL_FOR_LIGHTMAP | LMB_MODEL_FOR_TEXTURE,
    .channel_count = SHARED_CHANNELS,
    .channel_name = lmb_numbered_channels,
    .part = shared_parts,
    .light_count = COLOURS,
    .bytes = 2 * SHARED_CHANNELS,
    .cone = true,
    .convention =
        "l0 of SH3 radiance above the horizon, red, green and blue; then luminance's other coefficients over its",
    .encode = shared_encode,
    .evaluate = shared_evaluate,
    .radiance = shared_radiance,
};
