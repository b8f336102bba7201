/* Which points see each other. Light on one side of a wall says nothing of the light on the other. */
#ifndef LMB_SIGHT_H
#define LMB_SIGHT_H

#include <lambent/pool.h>
#include <lambent/trace.h>

#include "denoise/neighbours.h"

typedef struct lmb_sight {
    const lmb_tracer *tracer; /* NULL: nothing stands between any two */
    const lmb_neighbour_cells *cells;
    lmb_vec3 *eye; /* [rank] where it looks from: of a surface's, over it */
    float *clear;  /* [rank] metres around it in which nothing stands */
} lmb_sight;

/* Looks around each point. `cells` must outlive it, and is of points that all have a normal, or none.
 * @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result lmb_sight_make(const lmb_tracer *tracer, const lmb_neighbour_cells *cells, lmb_pool *pool, lmb_sight *sight);
void lmb_sight_free(lmb_sight *sight);

/* Leaves the neighbours that the first of them sees. The same from either side. */
void lmb_sight_keep(const lmb_sight *sight, lmb_neighbours *found);

#endif
