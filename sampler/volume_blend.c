#include <lambent/volume.h>

#include <assert.h>
#include <string.h>

bool lmb_volume_blend(const lmb_volume *const *volume, const float *weight, uint32_t count, lmb_vec3d position,
                      lmb_sh3_rgb *radiance)
{
    assert(radiance && (count == 0 || (volume && weight)));
    bool inside = count > 0;
    memset(radiance, 0, sizeof *radiance);
    for (uint32_t i = 0; i < count; ++i) {
        lmb_sh3_rgb light;
        inside = lmb_volume_sample_at(volume[i], position, &light) && inside;
        for (int channel = 0; channel < 3; ++channel) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                radiance->channel[channel].c[k] += weight[i] * light.channel[channel].c[k];
            }
        }
    }
    return inside;
}
