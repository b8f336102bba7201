/* Which lights of a level are kept apart from the harmonics (lambent/key_light.h). */
#ifndef LAMBENT_KEY_LIGHTS_H
#define LAMBENT_KEY_LIGHTS_H

#include <lambent/key_light.h>
#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The whole angle of a sun that one direction may stand for, degrees. Harmonics hold a wider one well. */
#define LMB_KEY_MOST_ANGLE_DEG 10.0

/* Keeps up to `most` <= LMB_KEY_LIGHTS_MOST directional lights apart, the strongest by the luminance of their
 * irradiance: the level's own, but for wide ones and those that are only to bounce, and the sun in the environment's
 * picture (lmb_environment_find_sun), which becomes a light of the scene and is taken out of the picture. Of a scene
 * that has not been asked before, and before emitters are made. @return LMB_ERROR_MEMORY */
lmb_result lmb_scene_choose_key_lights(lmb_scene *scene, uint32_t most);

/* Those, as files have them; how many. What is beyond is 0. */
uint32_t lmb_scene_key_lights(const lmb_scene *scene, lmb_key_light light[LMB_KEY_LIGHTS_MOST]);

/* Whether one of the scene's lights is among them. */
static inline bool lmb_scene_light_is_key(const lmb_scene *scene, uint32_t light)
{
    bool is_key = false;
    for (uint32_t i = 0; i < scene->key_light_count; ++i) {
        is_key = is_key || scene->key_light[i] == light;
    }
    return is_key;
}

#ifdef __cplusplus
}
#endif

#endif
