#include "tiles_internal.h"

#include <assert.h>
#include <string.h>

/* Positions of a batch whose tiles are found at a time: few enough for the stack, so many that the pauses between are
 * short. */
enum { LMB_TILES_CHUNK = 256 };

static bool dark(lmb_sh3_rgb *radiance)
{
    memset(radiance, 0, sizeof *radiance);
    return false;
}

bool lmb_volume_tiles_sample(const lmb_volume_tiles *tiles, lmb_vec3d position, lmb_sh3_rgb *radiance)
{
    assert(tiles && radiance);
    const lmb_volume *const volume = lmb_tiles_volume(tiles, position);
    return volume ? tiles->calls->sample(volume, position.x, position.y, position.z, radiance) : dark(radiance);
}

bool lmb_volume_tiles_sample_with_keys(const lmb_volume_tiles *tiles, lmb_vec3d position, lmb_sh3_rgb *radiance,
                                       float visibility[LMB_KEY_LIGHTS_MOST])
{
    assert(tiles && radiance && visibility);
    const lmb_volume *const volume = lmb_tiles_volume(tiles, position);
    if (volume) {
        return tiles->calls->sample_with_keys(volume, position.x, position.y, position.z, radiance, visibility);
    }
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    return dark(radiance);
}

bool lmb_volume_tiles_irradiance(const lmb_volume_tiles *tiles, lmb_vec3d position, lmb_vec3 normal,
                                 lmb_rgb *irradiance)
{
    assert(tiles && irradiance);
    const lmb_volume *const volume = lmb_tiles_volume(tiles, position);
    if (volume) {
        return tiles->calls->irradiance(volume, position.x, position.y, position.z, &normal, irradiance);
    }
    memset(irradiance, 0, sizeof *irradiance);
    return false;
}

/* Finds the volumes of so many positions, LMB_TILES_CHUNK at most. */
static size_t volumes_find(const lmb_volume_tiles *tiles, const lmb_vec3d *position, size_t left,
                           const lmb_volume *volume[LMB_TILES_CHUNK])
{
    const size_t count = left < LMB_TILES_CHUNK ? left : LMB_TILES_CHUNK;
    for (size_t i = 0; i < count; ++i) {
        volume[i] = lmb_tiles_volume(tiles, position[i]);
    }
    return count;
}

void lmb_volume_tiles_sample_batch(const lmb_volume_tiles *tiles, const lmb_vec3d *position, size_t count,
                                   lmb_sh3_rgb *radiance, float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)
{
    assert(tiles && (count == 0 || (position && radiance)));
    const lmb_volume *volume[LMB_TILES_CHUNK];
    for (size_t at = 0; at < count;) {
        const size_t found = volumes_find(tiles, position + at, count - at, volume);
        const lmb_volume_batch batch = {volume,
                                        position + at,
                                        found,
                                        radiance + at,
                                        visibility ? visibility + at : NULL,
                                        inside ? inside + at : NULL};
        tiles->calls->batch_of(&batch);
        at += found;
    }
}

void lmb_volume_tiles_irradiance_batch(const lmb_volume_tiles *tiles, const lmb_vec3d *position, const lmb_vec3 *normal,
                                       size_t count, lmb_rgb *irradiance, bool *inside)
{
    assert(tiles && (count == 0 || (position && normal && irradiance)));
    const lmb_volume *volume[LMB_TILES_CHUNK];
    for (size_t at = 0; at < count;) {
        const size_t found = volumes_find(tiles, position + at, count - at, volume);
        tiles->calls->irradiance_batch_of(volume, position + at, normal + at, found, irradiance + at,
                                          inside ? inside + at : NULL);
        at += found;
    }
}
