/* Searching the direction of an ambient and a directional light that come closest to some irradiance over a hemisphere
 * (Roughton, Sloan, Silvennoinen and Shirley, SIGGRAPH 2024). */
#ifndef LMB_MODEL_DIRECTION_SEARCH_H
#define LMB_MODEL_DIRECTION_SEARCH_H

#include <lambent/sh.h>

/* All about local +z, the surface's normal: C_a (a0 + a1 z) + C_d max(0, n.d), with a0 + a1 = 1, is held to I_z at +z.
 */
typedef struct lmb_light_fit {
    lmb_sh3 irradiance; /* SH3 of normalised irradiance */
    float irradiance_z; /* I_z >= 0 */
    float a0, a1;       /* (1, 0): the same all over; (1/2, 1/2): a hemisphere light */
} lmb_light_fit;

/* C_d that minimises the squared error over the hemisphere for a unit direction, 0 <= C_d, 0 <= C_a = I_z - C_d d.z. */
float lmb_light_fit_directional(const lmb_light_fit *fit, lmb_vec3 direction);

/* The best direction among those in the plane of the irradiance's own tangential part: golden section over the angle.
 */
lmb_vec3 lmb_light_fit_in_plane(const lmb_light_fit *fit);

/* The best direction of all: the same in planes all around, then golden section over the plane. */
lmb_vec3 lmb_light_fit_anywhere(const lmb_light_fit *fit);

#endif
