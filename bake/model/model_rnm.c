/* Radiosity normal mapping (McTaggart 2004): light on three slopes about the normal, blended by the squared cosines of
 * the shading normal with them. */
#include "model/clipped.h"
#include "model/models.h"

/* The light of each slope. */
enum { SLOPES = 3, CHANNELS = 3 * SLOPES };

/* Orthonormal, each 35 degrees above the horizon; the first is printed wrong in the note that games go by. */
static const lmb_vec3 slope[SLOPES] = {
    {0.81649658f, 0.0f, 0.57735027f},
    {-0.40824829f, 0.70710678f, 0.57735027f},
    {-0.40824829f, -0.70710678f, 0.57735027f},
};

static void slopes_in_world(lmb_vec3 vertex_normal, lmb_vec3 world[SLOPES])
{
    lmb_vec3 axes[3];
    lmb_normal_axes(vertex_normal, axes);
    for (int k = 0; k < SLOPES; ++k) {
        const lmb_vec3 flat = lmb_vec3_mad(lmb_vec3_scale(axes[0], slope[k].x), axes[1], slope[k].y);
        world[k] = lmb_vec3_mad(flat, axes[2], slope[k].z);
    }
}

static void encode_light(const lmb_directed_light *light, size_t count, lmb_vec3 vertex_normal, float *channel)
{
    lmb_vec3 world[SLOPES];
    slopes_in_world(vertex_normal, world);
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_rgb sum[SLOPES] = {{{0.0f}}};
    for (size_t i = 0; i < count; ++i) {
        if (!(lmb_vec3_dot(light[i].direction, n) > 0.0f)) {
            continue;
        }
        for (int k = 0; k < SLOPES; ++k) {
            const float cosine = lmb_larger(lmb_vec3_dot(light[i].direction, world[k]), 0.0f);
            sum[k] = lmb_rgb_add(sum[k], lmb_rgb_scale(light[i].weight, cosine * (1.0f / LMB_PI_F)));
        }
    }
    for (int i = 0; i < CHANNELS; ++i) {
        channel[i] = sum[i / 3].c[i % 3];
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    lmb_vec3 world[SLOPES];
    slopes_in_world(vertex_normal, world);
    for (int i = 0; i < count; ++i) {
        lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
        float total = 0.0f;
        for (int k = 0; k < SLOPES; ++k) {
            const float cosine = lmb_larger(lmb_vec3_dot(normal[i], world[k]), 0.0f), weight = cosine * cosine;
            sum = lmb_rgb_add(
                sum, lmb_rgb_scale(lmb_rgb_of(channel[3 * k], channel[3 * k + 1], channel[3 * k + 2]), weight));
            total += weight;
        }
        for (int c = 0; c < 3; ++c) {
            irradiance[i].c[c] = total > 0.0f ? lmb_light_clamped(sum.c[c] / total) : 0.0f;
        }
    }
}

const lmb_model lmb_model_rnm = {
    .name = "rnm",
    .title = "radiosity normal mapping",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .encode_light = encode_light,
    .evaluate = evaluate,
};
