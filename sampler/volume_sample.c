#include "volume_internal.h"

#include <assert.h>

bool lmb_volume_sample(const lmb_volume *volume, lmb_vec3 position, lmb_sh3_rgb *radiance)
{
    assert(volume && radiance);
    return volume->calls->sample(volume, (double)position.x, (double)position.y, (double)position.z, radiance);
}

bool lmb_volume_sample_at(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance)
{
    assert(volume && radiance);
    return volume->calls->sample(volume, position.x, position.y, position.z, radiance);
}

bool lmb_volume_sample_with_keys(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance,
                                 float visibility[LMB_KEY_LIGHTS_MOST])
{
    assert(volume && radiance && visibility);
    return volume->calls->sample_with_keys(volume, position.x, position.y, position.z, radiance, visibility);
}

void lmb_volume_sample_batch(const lmb_volume *volume, const lmb_vec3d *position, size_t count, lmb_sh3_rgb *radiance,
                             float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)
{
    assert(volume && (count == 0 || (position && radiance)));
    volume->calls->batch(volume, position, count, radiance, visibility, inside);
}

bool lmb_volume_irradiance(const lmb_volume *volume, lmb_vec3d position, lmb_vec3 normal, lmb_rgb *irradiance)
{
    assert(volume && irradiance);
    return volume->calls->irradiance(volume, position.x, position.y, position.z, &normal, irradiance);
}

void lmb_volume_irradiance_batch(const lmb_volume *volume, const lmb_vec3d *position, const lmb_vec3 *normal,
                                 size_t count, lmb_rgb *irradiance, bool *inside)
{
    assert(volume && (count == 0 || (position && normal && irradiance)));
    volume->calls->irradiance_batch(volume, position, normal, count, irradiance, inside);
}
