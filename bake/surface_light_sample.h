/* Samples of cells: the direct light at a point of one, what a ray from there sees, and how open the point is. */
#ifndef LMB_SURFACE_LIGHT_SAMPLE_H
#define LMB_SURFACE_LIGHT_SAMPLE_H

#include "direct.h"
#include "surface_light_bounce.h"
#include "surface_light_internal.h"

/* A sample of one side of a cell: the caller sets the first three. */
typedef struct lmb_side_sample {
    lmb_path path; /* at its first vertex */
    lmb_cell cell;
    bool front;
    lmb_rgb direct; /* that was found: irradiance over pi */
    lmb_link link;  /* what was seen; its target is a side */
} lmb_side_sample;

/* Takes up to LMB_SIDE_SAMPLES samples at once, so that rays of a kind go together. Sets what they find. Samples of one
 * side come one after the other, as they are numbered. */
enum { LMB_SIDE_SAMPLES = LMB_RAY_BATCH / LMB_AIMED_MOST };
void lmb_side_samples_take(const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count);

#endif
