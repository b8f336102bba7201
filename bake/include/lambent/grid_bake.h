/* Filling a placed grid with light. */
#ifndef LAMBENT_GRID_BAKE_H
#define LAMBENT_GRID_BAKE_H

#include <lambent/grid.h>
#include <lambent/probe.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_grid_bake_stats {
    uint64_t samples;
    uint64_t rays;
    double squared_error; /* summed over the baked probes, as lmb_gathered has them */
    double squared_length;
} lmb_grid_bake_stats;

/* Gathers with that effort at every valid probe, then dilates into the others. @return LMB_ERROR_MEMORY,
 * _INTERRUPTED */
lmb_result lmb_grid_bake(lmb_grid *grid, const lmb_transport *transport, const lmb_gather_effort *effort,
                         lmb_pool *pool, const lmb_progress *progress, lmb_grid_bake_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
