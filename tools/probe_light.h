/* What a volume or a local set gives at a place, and what models make of it. */
#ifndef LMB_TOOLS_PROBE_LIGHT_H
#define LMB_TOOLS_PROBE_LIGHT_H

#include <lambent/model.h>
#include <lambent/volume.h>

#include "check_reference.h"
#include "key_lights_seen.h"

/* Harmonics, and the key lights that they leave out. */
typedef struct probe_light {
    lmb_sh3_rgb radiance;
    key_lights_seen keys;
} probe_light;

probe_light probe_light_of_volume(const lmb_volume *volume, lmb_vec3d position);

/* The normalised irradiance of a model's channels on CHECK_NORMALS normals, with key lights. */
void channels_evaluate(const lmb_model *model, const float *channel, const key_lights_seen *keys,
                       lmb_vec3 vertex_normal, const lmb_vec3 *normals, irradiance_set *set);

/* What a probe gives by the default model of that use. */
void probe_light_evaluate(lmb_model_use use, const probe_light *light, lmb_vec3 vertex_normal, float cone_cos,
                          const lmb_vec3 *normals, irradiance_set *set);

#endif
