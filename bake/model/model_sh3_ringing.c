/* SH3 of what a hemisphere lets through, kept from ringing: harmonics cut off after three bands swing below zero beside
 * a bright light. A window lowers the bands for all light alike; what keeps contrast lowers them only as far as some
 * normal of the hemisphere would get negative irradiance. */
#include <lambent/sh.h>

#include "model/clipped.h"
#include "model/models.h"

/* Light that swings does so most at the horizon. */
enum { CHANNELS = 3 * LMB_SH3_COUNT, AT_HORIZON = 48, NORMALS = AT_HORIZON + 64, STEPS = 10 };

static void windowed_store(const lmb_sh3 *sh, float band1, float band2, float *channel)
{
    for (int i = 0; i < LMB_SH3_COUNT; ++i) {
        channel[i] = sh->c[i] * (i == 0 ? 1.0f : i < 4 ? band1 : band2);
    }
}

/* Hann's window, cos^2(pi l / 6). */
static void window_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    for (int c = 0; c < 3; ++c) {
        windowed_store(&clipped.channel[c], 0.75f, 0.25f, &channel[LMB_SH3_COUNT * c]);
    }
}

/* Irradiance of each band by itself on normals spread over the hemisphere. */
typedef struct band_light {
    float zero;
    float one[NORMALS];
    float two[NORMALS];
} band_light;

static void bands_find(const lmb_sh3 *sh, const lmb_vec3 normal[NORMALS], band_light *light)
{
    light->zero = LMB_N0 * sh->c[0];
    for (int k = 0; k < NORMALS; ++k) {
        const lmb_sh3 basis = lmb_sh3_basis(normal[k]);
        light->one[k] = light->two[k] = 0.0f;
        for (int i = 1; i < LMB_SH3_COUNT; ++i) {
            *(i < 4 ? &light->one[k] : &light->two[k]) += (i < 4 ? 2.0f / 3.0f : 0.25f) * sh->c[i] * basis.c[i];
        }
    }
}

static bool is_light(const band_light *light, float s)
{
    bool good = true;
    for (int k = 0; k < NORMALS; ++k) {
        good = good && light->zero + s * (light->one[k] + s * light->two[k]) >= 0.0f;
    }
    return good;
}

/* The most of the bands, s of the first and s^2 of the second, that leaves no normal with negative irradiance. */
static float bands_kept(const band_light *light)
{
    float low = 0.0f, high = 1.0f;
    if (is_light(light, 1.0f)) {
        return 1.0f;
    }
    for (int step = 0; step < STEPS; ++step) {
        const float middle = 0.5f * (low + high);
        *(is_light(light, middle) ? &low : &high) = middle;
    }
    return low;
}

static void kept_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_sh3_rgb clipped = lmb_clipped_sh3_rgb(radiance, vertex_normal, cone_cos);
    lmb_vec3 axes[3], normal[NORMALS];
    lmb_normal_axes(vertex_normal, axes);
    for (int k = 0; k < NORMALS; ++k) {
        const float z = k < AT_HORIZON ? 0.0f : ((float)(k - AT_HORIZON) + 0.5f) / (NORMALS - AT_HORIZON);
        const float turn = (float)k * (k < AT_HORIZON ? 2.0f * LMB_PI_F / AT_HORIZON : 2.39996323f);
        const float r = sqrtf(1.0f - z * z);
        const lmb_vec3 across = lmb_vec3_mad(lmb_vec3_scale(axes[0], r * cosf(turn)), axes[1], r * sinf(turn));
        normal[k] = lmb_vec3_mad(across, axes[2], z);
    }
    for (int c = 0; c < 3; ++c) {
        band_light light;
        bands_find(&clipped.channel[c], normal, &light);
        const float s = bands_kept(&light);
        windowed_store(&clipped.channel[c], s, s * s, &channel[LMB_SH3_COUNT * c]);
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    lmb_sh3_rgb sh3;
    for (int i = 0; i < CHANNELS; ++i) {
        sh3.channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] = channel[i];
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh3_rgb_irradiance(&sh3, normal[i]);
    }
}

const lmb_model lmb_model_sh3_window = {
    .name = "sh3.gram.window",
    .title = "SH3, quadratic multiply, Hann's window",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .encode = window_encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_sh3_kept = {
    .name = "sh3.gram.kept",
    .title = "SH3, quadratic multiply, bands kept while no normal's light is negative",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .cone = true,
    .encode = kept_encode,
    .evaluate = evaluate,
};
