/* Key lights as they are seen from a point. */
#ifndef LMB_TOOLS_KEY_LIGHTS_SEEN_H
#define LMB_TOOLS_KEY_LIGHTS_SEEN_H

#include <stdint.h>

#include <lambent/key_light.h>

typedef struct key_lights_seen {
    uint32_t count;
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    float visibility[LMB_KEY_LIGHTS_MOST];
} key_lights_seen;

/* Irradiance of the rest of the light with that of key lights. */
static inline lmb_rgb key_lights_add(const key_lights_seen *keys, lmb_vec3 vertex_normal, lmb_vec3 normal, lmb_rgb rest)
{
    for (uint32_t i = 0; i < keys->count; ++i) {
        rest = lmb_rgb_add(rest, lmb_key_light_irradiance(&keys->light[i], keys->visibility[i], vertex_normal, normal));
    }
    return rest;
}

/* Harmonics of all of the light. */
static inline lmb_sh3_rgb key_lights_add_sh3(const key_lights_seen *keys, const lmb_sh3_rgb *rest)
{
    lmb_sh3_rgb whole = *rest;
    for (uint32_t i = 0; i < keys->count; ++i) {
        lmb_key_light_add_to_sh3(&keys->light[i], keys->visibility[i], &whole);
    }
    return whole;
}

#endif
