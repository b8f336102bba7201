/* What an object in a picture reflects of the level as in a mirror, rough or not. */
#ifndef LMB_TOOLS_SHADE_SPECULAR_H
#define LMB_TOOLS_SHADE_SPECULAR_H

#include <lambent/gather.h>

#include "shade.h"

typedef struct specular_place {
    lmb_gather_point point; /* with the vertex normal */
    lmb_vec3 normal;        /* by the normal map */
    lmb_vec3 view;          /* unit, towards the eye */
} specular_place;

/* Of shader->specular: by the probes' harmonics and key lights. */
lmb_rgb shade_specular_of_probes(const lmb_shader *shader, const specular_place *place);

/* By rays, and key lights as they are seen from there. */
lmb_rgb shade_specular_of_reference(const lmb_shader *shader, const specular_place *place);

/* Radiance from a direction, without a sun that was taken out of the environment's picture. */
lmb_rgb radiance_without_keys(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                              uint32_t sample);

#endif
