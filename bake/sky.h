/* The environment as a light: radiance by direction, and sampling in proportion to it. */
#ifndef LMB_SKY_H
#define LMB_SKY_H

#include <lambent/emitters.h>

typedef struct lmb_sky {
    const lmb_environment *environment;
    double *cumulative; /* [pixel] running sum of luminance x solid angle; NULL when not an image with light */
    double *row_cosine; /* [height + 1] cosine of the polar angle at each row's upper edge */
    double total;
    double rotation_sine;
    double rotation_cosine;
} lmb_sky;

/* @return LMB_ERROR_MEMORY */
lmb_result lmb_sky_create(const lmb_environment *environment, lmb_sky *created);
void lmb_sky_free(lmb_sky *freed);

lmb_rgb lmb_sky_radiance(const lmb_sky *sky, lmb_vec3 direction);
bool lmb_sky_sample(const lmb_sky *sky, const float point[2], lmb_light_sample *sample);
float lmb_sky_density(const lmb_sky *sky, lmb_vec3 direction);

#endif
