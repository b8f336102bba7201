/* Taking noise off what was gathered at surface points.
 *
 * Each point's light is estimated anew from the points around it, in space: a plane (in each coefficient) is fitted to
 * those that lie on the same surface, within several radii, and of the radii that is taken which has the least error.
 * That error needs no reference: two independent halves of the samples tell it (after Rousselle, Knaus and Zwicker
 * 2012, "Adaptive Rendering with Non-local Means Filtering", who choose among filters by two buffers; and Bitterli et
 * al. 2016, "Nonlinearly Weighted First-order Regression", for the fit). Where light changes faster than the points
 * are apart, as in a shadow's edge, or has no noise, the smallest radius wins: the point stays as it is. Steady light
 * (lmb_gathered) is not filtered. */
#ifndef LAMBENT_DENOISE_H
#define LAMBENT_DENOISE_H

#include <stddef.h>

#include <lambent/gather_sh3.h>
#include <lambent/pool.h>
#include <lambent/trace.h>
#include <lambent/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_denoise_point {
    lmb_vec3 position;
    lmb_vec3 normal; /* unit; 0: a point in space */
    float spacing;   /* metres, > 0: to the next points of its surface, or in space */
} lmb_denoise_point;

/* Filters the moments of `count` points on surfaces, by those that each sees from half a spacing over its own, and sets
 * their squared errors to what is left. `tracer` NULL: nothing stands on the surfaces. The same for any number of
 * threads. @return LMB_ERROR_MEMORY, _INTERRUPTED; then `gathered` is as it was */
lmb_result lmb_denoise(const lmb_denoise_point *points, size_t count, const lmb_tracer *tracer, lmb_pool *pool,
                       const lmb_progress *progress, lmb_gathered *gathered);

/* The same of points in space, by those within about two spacings: as the value of a field that is
 * linear in all three directions. */
lmb_result lmb_denoise_in_space(const lmb_denoise_point *points, size_t count, const lmb_tracer *tracer, lmb_pool *pool,
                                const lmb_progress *progress, lmb_gathered *gathered);

#ifdef __cplusplus
}
#endif

#endif
