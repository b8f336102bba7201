/* Ambient cube (McTaggart 2004), which Bevy's irradiance volumes store: irradiance on the six sides of the world's
 * axes, blended by the squares of the normal. */
#include "model/clipped.h"
#include "model/models.h"

/* Sides +x, +y, +z, -x, -y, -z. */
enum { SIDES = 6, CHANNELS = 3 * SIDES };

static void store(const lmb_sh3_rgb *radiance, float *channel)
{
    for (int k = 0; k < SIDES; ++k) {
        const float sign = k < 3 ? 1.0f : -1.0f;
        const lmb_vec3 side = lmb_vec3_of(k % 3 == 0 ? sign : 0.0f, k % 3 == 1 ? sign : 0.0f, k % 3 == 2 ? sign : 0.0f);
        const lmb_rgb light = lmb_sh3_rgb_irradiance(radiance, side);
        for (int c = 0; c < 3; ++c) {
            channel[3 * k + c] = light.c[c];
        }
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

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    (void)vertex_normal;
    for (int i = 0; i < count; ++i) {
        const float along[3] = {normal[i].x, normal[i].y, normal[i].z};
        lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
        for (int axis = 0; axis < 3; ++axis) {
            const float *side = &channel[3 * (along[axis] < 0.0f ? axis + 3 : axis)];
            sum = lmb_rgb_add(sum, lmb_rgb_scale(lmb_rgb_of(side[0], side[1], side[2]), along[axis] * along[axis]));
        }
        for (int c = 0; c < 3; ++c) {
            irradiance[i].c[c] = lmb_light_clamped(sum.c[c]);
        }
    }
}

const lmb_model lmb_model_cube_gram = {
    .name = "cube.gram",
    .title = "ambient cube of the quadratic multiply",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .cone = true,
    .encode = gram_encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_cube_unoccluded = {
    .name = "cube.unoccluded",
    .title = "ambient cube of all light",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .unoccluded = true,
    .encode = unoccluded_encode,
    .evaluate = evaluate,
};
