#include "local_light.h"

#include <stdlib.h>
#include <string.h>

static bool set_read(const lmb_volume *volume, uint32_t index, local_light_set *set)
{
    const lmb_local_set baked = lmb_volume_local_set_get(volume, index);
    const size_t count = lmb_local_frame_count(&baked.frame);
    set->frame = baked.frame;
    set->radiance = malloc(count * sizeof *set->radiance);
    set->visibility = malloc(count * sizeof *set->visibility);
    if (!set->radiance || !set->visibility) {
        return false;
    }
    lmb_volume_local_set_light(volume, index, set->radiance, set->visibility);
    return true;
}

static int32_t set_of_instance(const lmb_volume *volume, uint32_t count, const lmb_instance *instance)
{
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_local_set set = lmb_volume_local_set_get(volume, i);
        if (set.node == instance->node && set.place == instance->place) {
            return (int32_t)i;
        }
    }
    return -1;
}

lmb_result local_light_open(const lmb_volume *volume, const lmb_scene *scene, local_light *opened)
{
    local_light local = {.count = volume ? lmb_volume_local_set_count(volume) : 0};
    local.set = calloc((size_t)local.count + 1, sizeof *local.set);
    local.of_instance = malloc(((size_t)scene->instance_count + 1) * sizeof *local.of_instance);
    bool good = local.set && local.of_instance;
    for (uint32_t i = 0; good && i < local.count; ++i) {
        good = set_read(volume, i, &local.set[i]);
    }
    if (!good) {
        local_light_close(&local);
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *const instance = &scene->instances[i];
        local.of_instance[i] = volume && instance->has_local_set ? set_of_instance(volume, local.count, instance) : -1;
    }
    local.key_count = volume ? lmb_volume_key_lights(volume, local.key) : 0;
    *opened = local;
    return LMB_OK;
}

void local_light_close(local_light *closed)
{
    for (uint32_t i = 0; closed->set && i < closed->count; ++i) {
        free(closed->set[i].radiance);
        free(closed->set[i].visibility);
    }
    free(closed->set);
    free(closed->of_instance);
    *closed = (local_light){0};
}

bool local_light_has(const local_light *local, const lmb_scene *scene, uint32_t instance)
{
    return local->of_instance[instance] >= 0 && scene->instances[instance].lit_locally;
}

void local_light_sample(const local_light *local, uint32_t instance, lmb_vec3d position, lmb_sh3_rgb *radiance,
                        key_lights_seen *keys)
{
    const local_light_set *const set = &local->set[local->of_instance[instance]];
    keys->count = local->key_count;
    memcpy(keys->light, local->key, sizeof keys->light);
    lmb_local_set_sample_with_keys(&set->frame, set->radiance, (const float(*)[LMB_KEY_LIGHTS_MOST])set->visibility,
                                   position, radiance, keys->visibility);
}
