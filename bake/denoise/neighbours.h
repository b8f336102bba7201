/* Which points are around a point on its surface. */
#ifndef LMB_NEIGHBOURS_H
#define LMB_NEIGHBOURS_H

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

/* The ranks that may be neighbours of a cell's points. */
enum { LMB_NEIGHBOUR_RANGES = 27 };
typedef struct lmb_neighbour_ranges {
    uint32_t count;
    uint32_t first[LMB_NEIGHBOUR_RANGES], end[LMB_NEIGHBOUR_RANGES];
} lmb_neighbour_ranges;

void lmb_neighbour_ranges_find(const lmb_neighbour_cells *cells, uint32_t cell, lmb_neighbour_ranges *ranges);

/* A neighbour: where it is from the point, in spacings: of a surface in its tangent plane, with z = 0. */
typedef struct lmb_neighbour {
    uint32_t rank;
    float x, y, z;
    float square; /* of the distance */
} lmb_neighbour;

/* Those within `reach` spacings of the point of that rank: itself, then others by rising rank, as many as there is room
 * for. */
enum { LMB_NEIGHBOURS_MOST = 1024 };
uint32_t lmb_neighbours_find(const lmb_neighbour_cells *cells, const lmb_neighbour_ranges *ranges, uint32_t rank,
                             float reach, lmb_neighbour found[LMB_NEIGHBOURS_MOST]);

#endif
