#include <lambent/key_lights.h>

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/environment.h>
#include <lambent/vector.h>

#include "scene/scene_internal.h"

/* Of half an ulp more than the degrees that files say. */
#define MOST_ANGLE_RAD ((float)(LMB_KEY_MOST_ANGLE_DEG * 1.000001 * LMB_PI / 180.0))

/* Luminance of a light that may be kept apart; 0 of any other. */
static float light_strength(const lmb_light *light)
{
    const float luminance = lmb_luminance(light->intensity);
    const bool may = light->type == LMB_LIGHT_DIRECTIONAL && !light->indirect_only &&
                     light->angle_rad <= MOST_ANGLE_RAD && isfinite(luminance);
    return may ? luminance : 0.0f;
}

/* Puts a light into its place among the strongest. */
static void strongest_add(lmb_scene *scene, uint32_t most, uint32_t light)
{
    const float strength = light_strength(&scene->lights[light]);
    uint32_t at = scene->key_light_count;
    while (at > 0 && strength > light_strength(&scene->lights[scene->key_light[at - 1]])) {
        --at;
    }
    if (!(strength > 0.0f) || at == most) {
        return;
    }
    scene->key_light_count += scene->key_light_count < most;
    for (uint32_t i = scene->key_light_count - 1; i > at; --i) {
        scene->key_light[i] = scene->key_light[i - 1];
    }
    scene->key_light[at] = light;
}

/* Makes a light of the sun, the scene's last, and takes it out of the picture. */
static lmb_result sun_separate(lmb_scene *scene, const lmb_environment_sun *sun)
{
    lmb_result result = lmb_scene_add_sun(scene, sun);
    if (result == LMB_OK) {
        result = lmb_environment_take_sun(&scene->environment, sun);
    }
    if (result == LMB_OK) {
        scene->lights[scene->light_count - 1].set = scene->environment.set;
    }
    return result;
}

/* Whether the sun is as strong as those that are kept apart. */
static bool sun_is_wanted(const lmb_scene *scene, uint32_t most, const lmb_environment_sun *sun)
{
    return sun->count > 0 &&
           (scene->key_light_count < most ||
            lmb_luminance(sun->irradiance) > light_strength(&scene->lights[scene->key_light[most - 1]]));
}

lmb_result lmb_scene_choose_key_lights(lmb_scene *scene, uint32_t most)
{
    assert(most <= LMB_KEY_LIGHTS_MOST && scene->key_light_count == 0);
    if (most == 0) {
        return LMB_OK;
    }
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        strongest_add(scene, most, i);
    }
    lmb_environment_sun sun;
    lmb_result result = lmb_environment_find_sun(&scene->environment, &sun);
    if (result == LMB_OK && sun_is_wanted(scene, most, &sun)) {
        result = sun_separate(scene, &sun);
        if (result == LMB_OK) {
            strongest_add(scene, most, scene->light_count - 1);
        }
    }
    lmb_environment_sun_free(&sun);
    return result;
}

uint32_t lmb_scene_key_lights(const lmb_scene *scene, lmb_key_light light[LMB_KEY_LIGHTS_MOST])
{
    memset(light, 0, LMB_KEY_LIGHTS_MOST * sizeof *light);
    for (uint32_t i = 0; i < scene->key_light_count; ++i) {
        const lmb_light *from = &scene->lights[scene->key_light[i]];
        light[i].direction = lmb_vec3_scale(from->direction, -1.0f);
        light[i].irradiance = lmb_rgb_scale(from->intensity, 1.0f / LMB_PI_F);
    }
    return scene->key_light_count;
}
