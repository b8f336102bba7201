/* Key lights: suns kept apart from the harmonics.
 *
 * Harmonics cannot hold a sun: they ring, and a shadow's edge blurs over the probes' spacing. So a file names up to
 * four directional lights, and holds for each probe and texel how much of each is seen from there. The harmonics beside
 * it hold everything but the direct light of these: their bounces too. What is left out is added here, exactly. */
#ifndef LAMBENT_KEY_LIGHT_H
#define LAMBENT_KEY_LIGHT_H

#include <lambent/sh.h>
#include <lambent/vector.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_KEY_LIGHTS_MOST = 4 };

typedef struct lmb_key_light {
    lmb_vec3 direction; /* unit, towards the light */
    lmb_rgb irradiance; /* normalised (E/pi), of a surface that faces the light and sees all of it */
} lmb_key_light;

/* Normalised irradiance that the light gives a surface of vertex normal n_v and shading normal n: visibility x
 * irradiance x max(0, n.d), where n_v.d > 0. What has no vertex normal of its own gives its shading normal twice.
 * `visibility` is the unshadowed share of the light, 0 to 1. Never NaN or negative. */
static inline lmb_rgb lmb_key_light_irradiance(const lmb_key_light *light, float visibility, lmb_vec3 vertex_normal,
                                               lmb_vec3 normal)
{
    const float faced = lmb_vec3_dot(vertex_normal, light->direction) > 0.0f ? visibility : 0.0f;
    const float factor = lmb_larger(lmb_vec3_dot(normal, light->direction), 0.0f) * faced;
    lmb_rgb irradiance;
    for (int c = 0; c < 3; ++c) {
        irradiance.c[c] = lmb_light_clamped(light->irradiance.c[c] * factor);
    }
    return irradiance;
}

/* Adds the light to harmonics of radiance, as well as they can hold it: for who has use for harmonics alone. */
static inline void lmb_key_light_add_to_sh3(const lmb_key_light *light, float visibility, lmb_sh3_rgb *radiance)
{
    lmb_sh3_rgb_add_light(radiance, light->direction, lmb_rgb_scale(light->irradiance, LMB_PI_F * visibility));
}

#ifdef __cplusplus
}
#endif

#endif
