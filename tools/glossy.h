/* The truth that specular layers are held against: what a surface reflects of the path tracer's light by the
 * reflectance of lambent/specular.h, with light on its way reflected diffusely, as the bake has it. */
#ifndef LMB_TOOLS_GLOSSY_H
#define LMB_TOOLS_GLOSSY_H

#include <lambent/gather.h>
#include <lambent/specular.h>

/* A surface that is looked at. */
typedef struct specular_place {
    lmb_gather_point point; /* with the vertex normal */
    lmb_vec3 normal;        /* by the normal map */
    lmb_vec3 view;          /* unit, towards the eye */
    lmb_specular specular;
} specular_place;

/* Radiance towards the eye: by `samples` half vectors and as many points on emitters, weighted by the balance
 * heuristic, and punctual lights and suns, key lights too, by rays towards them. Below LMB_SPECULAR_LEAST_ROUGHNESS
 * lobes stay as wide. `stream` tells independent estimates apart. */
lmb_rgb glossy_radiance(const lmb_transport *transport, const specular_place *place, uint32_t samples, uint64_t stream);

#endif
