/* Lights of an extent: suns are discs in the sky, lamps are spheres of an even radiance. */
#ifndef LMB_SOFT_LIGHT_H
#define LMB_SOFT_LIGHT_H

#include <lambent/emitters.h>

/* What a light's extent is measured by: the sine of half its angle for a sun, metres of radius for a lamp; 0 for a
 * light without. */
float lmb_light_extent(const lmb_light *light);

/* Where a sample of a light goes. */
typedef struct lmb_light_point {
    lmb_vec3 direction; /* unit */
    lmb_vec3 end;       /* on a lamp, on the side that is seen */
    float factor; /* of irradiance on a surface that faces the point, over lux for a sun, over candela for a lamp */
} lmb_light_point;

/* A direction to the disc that is uniform in its solid angle, by `u` in [0, 1)^2; `to_sun` is unit. A surface
 * that faces the disc's middle gets the sun's lux: E = L pi sine^2. */
lmb_light_point lmb_sun_point(lmb_vec3 to_sun, float sine, const float u[2]);

/* The same of a sphere of radius > 0 about `centre`, of the part that is seen from `position`, whose radiance
 * I / (pi radius^2) is that of I candela from afar. From inside, all of it is seen. What is nearer than `min_distance`
 * counts as that far. */
lmb_light_point lmb_lamp_point(lmb_vec3 centre, float radius, lmb_vec3 position, float min_distance, const float u[2]);

#endif
