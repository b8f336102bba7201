#include "probe_light.h"

probe_light probe_light_of_volume(const lmb_volume *volume, lmb_vec3d position)
{
    probe_light light;
    light.keys.count = lmb_volume_key_lights(volume, light.keys.light);
    lmb_volume_sample_with_keys(volume, position, &light.radiance, light.keys.visibility);
    return light;
}

void channels_evaluate(const lmb_model *model, const float *channel, const key_lights_seen *keys,
                       lmb_vec3 vertex_normal, const lmb_vec3 *normals, irradiance_set *set)
{
    model->evaluate(channel, vertex_normal, normals, CHECK_NORMALS, set->at);
    for (int k = 0; k < CHECK_NORMALS; ++k) {
        set->at[k] = key_lights_add(keys, vertex_normal, normals[k], set->at[k]);
    }
}

void probe_light_evaluate(lmb_model_use use, const probe_light *light, lmb_vec3 vertex_normal, float cone_cos,
                          const lmb_vec3 *normals, irradiance_set *set)
{
    const lmb_model *model = lmb_model_default(use);
    float channel[LMB_MODEL_MOST_CHANNELS];
    model->encode(&light->radiance, vertex_normal, cone_cos, channel);
    channels_evaluate(model, channel, &light->keys, vertex_normal, normals, set);
}
