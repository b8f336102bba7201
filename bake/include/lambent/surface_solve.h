/* Solving the light on surfaces (lambent/surface_light.h). */
#ifndef LAMBENT_SURFACE_SOLVE_H
#define LAMBENT_SURFACE_SOLVE_H

#include <lambent/pool.h>
#include <lambent/surface_light.h>
#include <lambent/transport.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_surface_light_settings {
    float cell_size;    /* metres: no edge of a cell is longer than this; 0: as fine as max_cells allows */
    uint32_t max_cells; /* the cell size grows until there are no more than this, beside the one that each triangle has
                           anyway; > 0 */
    uint32_t samples;   /* for each side of a cell, in proportion fewer for small cells, but 2; 0: 8 */
    const lmb_progress *progress; /* NULL: none */
} lmb_surface_light_settings;

lmb_surface_light_settings lmb_surface_light_settings_default(void);

typedef struct lmb_surface_light_stats {
    uint32_t cells;
    uint32_t lit_sides; /* of two for each cell, or more where it is in pieces: those that any light can reach */
    int passes;         /* over the transport, until the solution stood still, or transport.bounces - 1 */
    uint64_t rays;
    size_t bytes_solving; /* at most at once, the solution's own among them */
} lmb_surface_light_stats;

/* Solves the light of transport's scene; `transport->surface` is not used. The same transport and settings give the
 * same solution for any number of threads.
 * @return LMB_ERROR_UNSUPPORTED (more than 16 million static triangles), _MEMORY, _INTERRUPTED */
lmb_result lmb_surface_light_solve(const lmb_transport *transport, const lmb_surface_light_settings *settings,
                                   lmb_pool *pool, lmb_surface_light **light, lmb_surface_light_stats *stats,
                                   lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
