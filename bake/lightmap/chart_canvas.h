/* Packing by texels: shapes are bitmaps, and stand on a canvas as low as they fit, into each other's corners and holes.
 */
#ifndef LMB_CHART_CANVAS_H
#define LMB_CHART_CANVAS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "lightmap/chart_internal.h"

/* What a chart touches, texel by texel: bit x % 64 of bits[y words + x / 64]. */
typedef struct chart_shape {
    int32_t width, height;
    int32_t words; /* of a row */
    bool solid;    /* every texel is set */
    uint64_t key;  /* of what it looks like; 0: too large to tell it from others by that */
    uint64_t *bits;
    int32_t *bottom; /* [x] the first row that is set; `height`: none */
    int32_t *run;    /* [y] the longest row of set texels */
    int32_t *alike;  /* [y] how many rows look the same from that one on, itself included */
    int32_t least_run;
} chart_shape;

/* The texels of a width x height box that its triangles (three corners each, count corners) reach into.
 * @return false: out of memory */
bool lmb_chart_shape_make(const chart_vec2 *corners, size_t count, int32_t width, int32_t height, chart_shape *shape);

/* A whole box. @return false: out of memory */
bool lmb_chart_shape_make_box(int32_t width, int32_t height, chart_shape *shape);

/* The same, turned by a quarter: what was at (x, y) is at (height - y, x). @return false: out of memory */
bool lmb_chart_shape_turn(const chart_shape *shape, chart_shape *turned);

void lmb_chart_shape_free(chart_shape *shape);

/* How many looks of shapes are remembered. */
enum { CHART_SEEN = 1024 };

/* Shapes that stand on a canvas are at least the gutter apart, and from its borders left, right and below. It is open
 * upwards. */
typedef struct chart_canvas {
    int32_t width, gutter;
    int32_t words;
    int32_t height;      /* rows that there is memory for */
    uint64_t *blocked;   /* [y words + word] what stands there, with the gutter around it */
    int32_t *room;       /* [y] the longest free row; the width above `height` */
    int32_t *top;        /* [x] the first row that is free with all above it */
    int32_t *lowest;     /* [x] scratch */
    uint64_t *hit, *row; /* [words] scratch */
    struct {
        uint64_t key;
        int32_t row;
    } seen[CHART_SEEN];              /* rows below which there is no place for shapes that look so */
    int32_t used_width, used_height; /* with the gutter beyond */
    uint64_t work;                   /* steps of all searches so far */
} chart_canvas;

/* Where a shape stands: its least corner, after that many quarters of a turn. */
typedef struct chart_place {
    int32_t x, y;
    int turn;
} chart_place;

/* @return false: out of memory; then, too, chart_canvas_free is to be called */
bool lmb_chart_canvas_make(int32_t width, int32_t gutter, chart_canvas *canvas);
void lmb_chart_canvas_free(chart_canvas *canvas);

/* Stands a shape on the canvas, in the turn (of `turns` that follow each other) that keeps it lowest, no higher than
 * `most_height` with the gutter beyond. `place->turn` is -1 where it does not fit. @return false: out of memory */
bool lmb_chart_canvas_add(chart_canvas *canvas, const chart_shape *shape, int turns, int32_t most_height,
                          chart_place *place);

#endif
