/* Packing shapes into as little of one image as can be found. */
#ifndef LMB_CHART_WIDTHS_H
#define LMB_CHART_WIDTHS_H

#include <lambent/pool.h>

#include "lightmap/chart_canvas.h"

enum { CHART_TURNS = 4 };

/* One shape to be packed, in the turns that it may have. */
typedef struct chart_item {
    size_t id; /* of whose it is */
    int turns;
    chart_shape shape[CHART_TURNS];
} chart_item;

/* Sorts tall before low, then wide before narrow, then by id: low ones fill what tall ones leave. */
void lmb_chart_items_sort(chart_item *items, size_t count);
void lmb_chart_items_free(chart_item *items, size_t count);

typedef struct chart_widths {
    const chart_item *items;
    size_t count;
    int32_t gutter;        /* texels between them, and at the borders */
    int32_t most;          /* texels along a side, gutters at the borders included */
    lmb_pool *pool;        /* NULL: the caller's thread */
    chart_place *place;    /* [item] out */
    int32_t width, height; /* out, gutters at the borders included */
} chart_widths;

/* Packs at several widths, as many as the time allows, and keeps the smallest. The same items give the same places,
 * for any number of threads.
 * @return LMB_ERROR_MEMORY, or LMB_ERROR_ARGUMENT when they do not fit */
lmb_result lmb_chart_widths_pack(chart_widths *job);

/* Packs what fits into the largest image; what does not has the turn -1. @return LMB_ERROR_MEMORY */
lmb_result lmb_chart_widths_fill(chart_widths *job);

#endif
