#include "model/hhd_store.h"

#include "model/clipped.h"

const char *const lmb_hhd_channel_names[LMB_HHD_CHANNELS] = {"a.R", "a.G", "a.B", "d.R", "d.G",
                                                             "d.B", "d.X", "d.Y", "d.Z"};
const lmb_model_part lmb_hhd_parts[] = {
    {"ambient", 3, 0.0f, 0.0f}, {"directional", 3, 0.0f, 0.0f}, {"direction", 3, 0.0f, 0.0f}, {NULL, 0, 0.0f, 0.0f}};

void lmb_hhd_average(float *channel, float total)
{
    lmb_hhd_rgb hhd = lmb_hhd_stored(channel);
    hhd.ambient = lmb_rgb_scale(hhd.ambient, 1.0f / total);
    hhd.directional = lmb_rgb_scale(hhd.directional, 1.0f / total);
    hhd.direction = lmb_vec3_unit_or(hhd.direction, hhd.direction);
    lmb_hhd_store(&hhd, channel);
}

void lmb_hhd_store_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                            lmb_rgb *irradiance)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_hhd_rgb hhd = lmb_hhd_stored(channel);
    hhd.direction = lmb_vec3_unit_or(hhd.direction, n); /* it may have been filtered */
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_hhd_rgb_evaluate(&hhd, n, normal[i]);
    }
}

float lmb_hhd_share(lmb_moments colour, lmb_moments luminance, lmb_vec3 vertex_normal)
{
    const float all = lmb_vec3_dot(luminance.vector, vertex_normal);
    return all > 0.0f ? lmb_light_clamped(lmb_vec3_dot(colour.vector, vertex_normal)) / all
                      : lmb_light_clamped(colour.scalar) / luminance.scalar;
}
