/* Specular reflection by samples: what pictures and measurements hold the sampler's layers against (lambent/specular.h
 * has the reflectance). */
#ifndef LMB_TOOLS_HALF_VECTOR_H
#define LMB_TOOLS_HALF_VECTOR_H

#include <stdbool.h>

#include <lambent/types.h>

/* Reflectance of a dielectric by Snell's law, of that along its normal and the cosine of the angle of incidence. */
double dielectric_reflectance(double f0, double cosine);

/* Where a facet sends the view, and with how much. */
typedef struct half_vector_sample {
    lmb_vec3 towards;
    double arrives; /* of the radiance from there, but for the Fresnel factor */
    double along;   /* the cosine that it takes */
} half_vector_sample;

/* Picks a facet in proportion to D (N.H) by u in [0, 1)^2. @return false where no light can come from */
bool half_vector_pick(float roughness, lmb_vec3 normal, lmb_vec3 view, const float u[2], half_vector_sample *picked);

/* What a lobe does with light from a direction. */
typedef struct half_vector_response {
    double reflects; /* of radiance from there, for each solid angle, but for the Fresnel factor: f/F (N.L) */
    double along;    /* the cosine that that takes */
    double density;  /* per solid angle, with which half_vector_pick finds the direction */
} half_vector_response;

/* @return false where nothing is reflected. `roughness` > 0 */
bool half_vector_respond(float roughness, lmb_vec3 normal, lmb_vec3 view, lmb_vec3 towards,
                         half_vector_response *response);

#endif
