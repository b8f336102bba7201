/* Samples of cells: the direct light at a point of one, what a ray from there sees, and how open the point is. */
#ifndef LMB_SIDE_SAMPLE_H
#define LMB_SIDE_SAMPLE_H

#include "transport/direct.h"
#include "solve/bounces.h"
#include "surface/surface_light_internal.h"

/* Dimension pairs of a sample that its path's vertices 0 and 2 and further do not use: where it starts on its cell, and
 * the direction in which it looks for openness. */
enum { LMB_PAIR_START = PAIRS_PER_VERTEX, LMB_PAIR_OPENNESS };

/* The stream of a side's samples, apart from those of gather points. */
uint64_t lmb_side_stream(const lmb_transport *transport, const lmb_cell *cell, uint32_t side);

/* A sample of one side of a cell: the caller sets the first five. */
typedef struct lmb_side_sample {
    lmb_path path; /* at its first vertex */
    lmb_cell cell;
    bool front;
    uint64_t start_stream; /* its start's variates are those of this sample of this stream */
    uint32_t start_sample;
    lmb_rgb direct; /* that was found: irradiance over pi */
    lmb_rgb sun;    /* the part of it that directional lights give */
    lmb_link link;  /* what was seen; its target is a patch */
} lmb_side_sample;

/* Takes up to LMB_SIDE_SAMPLES samples at once, so that rays of a kind go together. Sets what they find. Samples of one
 * patch come one after the other, as they are numbered. */
enum { LMB_SIDE_SAMPLES = LMB_RAY_BATCH / LMB_AIMED_MOST };
void lmb_side_samples_take(const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count);

/* Of samples that see uneven patches: sets `direct` to how much more sun than the patch's mean arrives from the very
 * point that is seen. */
void lmb_side_samples_correct(const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count);

#endif
