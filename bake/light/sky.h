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
    lmb_environment_seen *pixel; /* of an image; else NULL */
    uint32_t aimed_count;        /* pixels that stand out, or 0 when they are not worth it */
    uint32_t *aimed;             /* [aimed] the pixel */
    double *cumulative;          /* [aimed] running sum of excess x solid angle */
    uint32_t *guide;             /* [aimed] where the search for that share of the total begins */
    double *row_cosine;          /* [height + 1] cosine of the polar angle at each row's upper edge */
    double total;                /* last of `cumulative` */
    float mean;                  /* luminance over the sphere */
    float rotation_sine;
    float rotation_cosine;
} lmb_sky;

/* `aimed`: whether lmb_sky_sample_batch is wanted. @return LMB_ERROR_MEMORY */
lmb_result lmb_sky_create(const lmb_environment *environment, bool aimed, lmb_sky *created);
void lmb_sky_free(lmb_sky *freed);

/* Radiance from a direction, and the density per solid angle with which lmb_sky_sample picks it. */
lmb_environment_seen lmb_sky_look(const lmb_sky *sky, lmb_vec3 direction);

/* The radiance with what has been taken out of the picture. */
lmb_rgb lmb_sky_shown(const lmb_sky *sky, lmb_vec3 direction);

/* lmb_sky_look for `count` directions at once: memory is slow, and waits for many at a time. `direction[axis][i]`. */
void lmb_sky_look_batch(const lmb_sky *sky, const float *const direction[3], uint32_t count,
                        lmb_environment_seen *seen);

/* Directions for `count` points; where one picks nothing, its density is 0. */
void lmb_sky_sample_batch(const lmb_sky *sky, const float *x, const float *y, uint32_t count, lmb_light_sample *sample);

#endif
