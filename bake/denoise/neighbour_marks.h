/* Neighbours remembered, a bit for each candidate of a point. */
#ifndef LMB_NEIGHBOUR_MARKS_H
#define LMB_NEIGHBOUR_MARKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "denoise/neighbours.h"

/* A point whose cell has more candidates has no marks: they would take more memory than its light. On a plane there
 * are some 600. */
enum { LMB_NEIGHBOUR_MARKS_MOST = 4096 };

typedef struct lmb_neighbour_marks {
    size_t *first; /* [cell] of words, and the count of all at its end */
    uint64_t *word;
} lmb_neighbour_marks;

/* No candidate is marked yet. @return LMB_ERROR_MEMORY */
lmb_result lmb_neighbour_marks_make(const lmb_neighbour_cells *cells, lmb_neighbour_marks *marks);
void lmb_neighbour_marks_free(lmb_neighbour_marks *marks);

/* Where to find a point. */
typedef struct lmb_neighbour_point {
    const lmb_neighbour_cells *cells;
    const lmb_neighbour_ranges *ranges; /* of its cell */
    uint32_t cell, rank;
} lmb_neighbour_point;

/* Marks just these, if the point has marks. */
void lmb_neighbour_marks_set(lmb_neighbour_marks *marks, const lmb_neighbour_point *point, const lmb_neighbours *found);

/* Those marked, as lmb_neighbours_find finds them. @return whether the point has marks */
bool lmb_neighbour_marks_get(const lmb_neighbour_marks *marks, const lmb_neighbour_point *point, lmb_neighbours *found);

#endif
