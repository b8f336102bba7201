/* A point's light by those around it. */
#ifndef LMB_PLANE_FILTER_H
#define LMB_PLANE_FILTER_H

#include "denoise/neighbours.h"

/* A point's noisy light: 27 coefficients of the mean of its replicates, then of half their difference, each filled up
 * with zeros to whole vectors. */
enum { LMB_LIGHT_HALF = 32, LMB_LIGHT_ROW = 2 * LMB_LIGHT_HALF };

/* 1 at the middle, 0 at `radius` and beyond. */
static inline float lmb_biweight(float square, float radius)
{
    const float rest = 1.0f - square / (radius * radius);
    return rest > 0.0f ? rest * rest : 0.0f;
}

/* Some of a point's neighbours, and weights of the value at the middle of a plane that is fitted to them by least
 * squares: the sum of weight x value is that. */
typedef struct lmb_plane {
    lmb_neighbours_part part;
    float weight[LMB_NEIGHBOURS_MOST]; /* [of the part] */
} lmb_plane;

/* Of those within a radius. Where they lie to one side only, the plane's slope is held back. */
void lmb_plane_fit(const lmb_neighbours *found, float radius, lmb_plane *plane);

/* All within a radius weigh the same, 1 together. */
void lmb_plane_even(const lmb_neighbours *found, float radius, lmb_plane *plane);

/* Sums of the light of those, of whole rows or of their first halves. `light` is [rank]. */
void lmb_plane_rows(const lmb_plane *plane, const lmb_neighbours *found, const float (*light)[LMB_LIGHT_ROW],
                    float sum[LMB_LIGHT_ROW]);
void lmb_plane_halves(const lmb_plane *plane, const lmb_neighbours *found, const float (*light)[LMB_LIGHT_ROW],
                      float sum[LMB_LIGHT_HALF]);

#endif
