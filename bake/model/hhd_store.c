#include "model/hhd_store.h"

#include "model/clipped.h"

void lmb_hhd_store_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                            lmb_rgb *irradiance)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    const lmb_hhd_rgb hhd = lmb_hhd_stored(channel);
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
