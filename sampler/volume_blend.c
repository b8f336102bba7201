#include <lambent/sky.h>
#include <lambent/volume.h>

#include <assert.h>
#include <string.h>

/* Adds a volume's light, each colour by its weight. @return as lmb_volume_sample_at */
static bool light_add(const lmb_volume *volume, lmb_rgb weight, lmb_vec3d position, lmb_sh3_rgb *sum)
{
    lmb_sh3_rgb light;
    const bool inside = lmb_volume_sample_at(volume, position, &light);
    for (int channel = 0; channel < 3; ++channel) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            sum->channel[channel].c[k] += weight.c[channel] * light.channel[channel].c[k];
        }
    }
    return inside;
}

bool lmb_volume_blend(const lmb_volume *const *volume, const float *weight, uint32_t count, lmb_vec3d position,
                      lmb_sh3_rgb *radiance)
{
    assert(radiance && (count == 0 || (volume && weight)));
    bool inside = count > 0;
    memset(radiance, 0, sizeof *radiance);
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_rgb grey = {{weight[i], weight[i], weight[i]}};
        inside = light_add(volume[i], grey, position, radiance) && inside;
    }
    return inside;
}

bool lmb_volume_blend_rgb(const lmb_volume *const *volume, const lmb_rgb *weight, uint32_t count, lmb_vec3d position,
                          lmb_sh3_rgb *radiance)
{
    assert(radiance && (count == 0 || (volume && weight)));
    bool inside = count > 0;
    memset(radiance, 0, sizeof *radiance);
    for (uint32_t i = 0; i < count; ++i) {
        inside = light_add(volume[i], weight[i], position, radiance) && inside;
    }
    return inside;
}
