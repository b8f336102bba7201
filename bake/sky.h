/* The environment as a light: radiance by direction, and sampling of what is brighter than its mean.
 *
 * Rays in all directions find an even sky well; what they find badly are suns and windows. So directions are aimed in
 * proportion to how far a pixel's luminance is above the mean ("MIS compensation", Karlik et al. 2019), and rays find
 * the rest alone. */
#ifndef LMB_SKY_H
#define LMB_SKY_H

#include <lambent/emitters.h>

typedef struct lmb_sky {
    const lmb_environment *environment;
    double *cumulative; /* [pixel] running sum of excess x solid angle; NULL when nothing stands out */
    uint32_t *guide;    /* [pixel] where the search for that share of the total begins */
    double *row_cosine; /* [height + 1] cosine of the polar angle at each row's upper edge */
    double total;       /* last of `cumulative` */
    float mean;         /* luminance over the sphere */
    float rotation_sine;
    float rotation_cosine;
} lmb_sky;

/* @return LMB_ERROR_MEMORY */
lmb_result lmb_sky_create(const lmb_environment *environment, lmb_sky *created);
void lmb_sky_free(lmb_sky *freed);

/* Radiance from a direction, and the density per solid angle with which lmb_sky_sample picks it. */
lmb_rgb lmb_sky_radiance(const lmb_sky *sky, lmb_vec3 direction, float *density);
bool lmb_sky_sample(const lmb_sky *sky, const float point[2], lmb_light_sample *sample);

#endif
