/* Which points are around a point on its surface, or in space. */
#ifndef LMB_NEIGHBOURS_H
#define LMB_NEIGHBOURS_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/denoise.h>

/* Points sorted into cubes about as wide as the farthest that is looked for. Points of much smaller spacing have cubes
 * of their own and no neighbours among the others. */
typedef struct lmb_neighbour_cells {
    uint32_t count;
    uint32_t *element;   /* [rank] what point it is */
    float *x, *y, *z;    /* [rank] */
    float *nx, *ny, *nz; /* [rank] */
    float *spacing;      /* [rank] */
    uint32_t cell_count;
    uint64_t *key;   /* [cell] rising */
    uint32_t *first; /* [cell] its first rank, and the count at the end */
    float reach;
} lmb_neighbour_cells;

/* `reach` is in spacings. @return LMB_ERROR_MEMORY */
lmb_result lmb_neighbour_cells_make(const lmb_denoise_point *points, uint32_t count, float reach,
                                    lmb_neighbour_cells *cells);
void lmb_neighbour_cells_free(lmb_neighbour_cells *cells);

/* The points that may be neighbours of a cell's: candidates, counted from 0 through all ranges. */
enum { LMB_NEIGHBOUR_RANGES = 9 };
typedef struct lmb_neighbour_ranges {
    uint32_t count;
    uint32_t first[LMB_NEIGHBOUR_RANGES], end[LMB_NEIGHBOUR_RANGES]; /* ranks */
    uint32_t candidates;
} lmb_neighbour_ranges;

void lmb_neighbour_ranges_find(const lmb_neighbour_cells *cells, uint32_t cell, lmb_neighbour_ranges *ranges);

/* The neighbours of a point: itself, then others by rising rank, as many as there is room for. Where they are from the
 * point, in spacings: of a surface in its tangent plane, with z = 0. */
enum { LMB_NEIGHBOURS_MOST = 1024 };
typedef struct lmb_neighbours {
    uint32_t count;
    bool flat; /* z = 0 */
    uint32_t rank[LMB_NEIGHBOURS_MOST];
    uint32_t candidate[LMB_NEIGHBOURS_MOST]; /* which of the ranges' it is; not of the point itself */
    float x[LMB_NEIGHBOURS_MOST], y[LMB_NEIGHBOURS_MOST], z[LMB_NEIGHBOURS_MOST];
    float square[LMB_NEIGHBOURS_MOST]; /* of the distance */
} lmb_neighbours;

/* Those within the cells' reach of the point of that rank, but where they are. */
void lmb_neighbours_find(const lmb_neighbour_cells *cells, const lmb_neighbour_ranges *ranges, uint32_t rank,
                         lmb_neighbours *found);

/* Where they are. */
void lmb_neighbours_place(const lmb_neighbour_cells *cells, lmb_neighbours *found);

/* Which of a list, by their places in it. */
typedef struct lmb_neighbours_part {
    uint32_t count;
    uint32_t place[LMB_NEIGHBOURS_MOST];
} lmb_neighbours_part;

/* Those within a radius. */
void lmb_neighbours_within(const lmb_neighbours *found, float radius, lmb_neighbours_part *part);

#endif
