#include <lambent/grid_bake.h>

#include <lambent/placement.h>

#include <stdlib.h>

#include "bake_internal.h"

enum { PROBES_PER_TASK = 4 };

/* A probe speaks for the space within half a spacing of it. */
#define LIGHT_DISTANCE_SPACINGS 0.5f

typedef struct lmb_grid_work {
    lmb_grid *grid;
    const lmb_transport *transport;
    const lmb_gather_effort *effort;
    lmb_grid_bake_stats *stats; /* [probe] zero when not baked */
} lmb_grid_work;

static void grid_task(void *context, size_t task, int worker)
{
    (void)worker;
    const lmb_grid_work *work = context;
    lmb_grid *grid = work->grid;
    const int32_t first = (int32_t)(task * PROBES_PER_TASK);
    const int32_t last = first + PROBES_PER_TASK < grid->probe_count ? first + PROBES_PER_TASK : grid->probe_count;
    for (int32_t i = first; i < last; ++i) {
        if (grid->validity[i] < LMB_GRID_MIN_VALIDITY) {
            continue;
        }
        uint64_t rays = 0;
        const lmb_vec3 position =
            lmb_placement_relocate(work->transport->tracer, lmb_grid_position(grid, i), grid->spacing, &rays);
        const lmb_gather_point point = {.position = position,
                                        .min_light_distance = LIGHT_DISTANCE_SPACINGS * grid->spacing};
        lmb_gathered gathered;
        lmb_gather_sh3_area(work->transport, &point, 1, work->effort, &gathered);
        grid->radiance[i] = gathered.moments;
        work->stats[i] = (lmb_grid_bake_stats){gathered.samples, rays + gathered.rays, gathered.squared_error,
                                               gathered.squared_length};
    }
}

lmb_result lmb_grid_bake(lmb_grid *grid, const lmb_transport *transport, const lmb_gather_effort *effort,
                         lmb_pool *pool, const lmb_progress *progress, lmb_grid_bake_stats *stats)
{
    const size_t count = (size_t)grid->probe_count;
    lmb_grid_work work = {.grid = grid,
                          .transport = transport,
                          .effort = effort,
                          .stats = calloc(count + 1, sizeof(lmb_grid_bake_stats))};
    lmb_result result = work.stats ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        const size_t tasks = (count + PROBES_PER_TASK - 1) / PROBES_PER_TASK;
        result = lmb_pool_run(pool, tasks, grid_task, &work, "probes", progress);
    }
    if (result == LMB_OK) {
        *stats = (lmb_grid_bake_stats){0};
        for (size_t i = 0; i < count; ++i) {
            stats->samples += work.stats[i].samples;
            stats->rays += work.stats[i].rays;
            stats->squared_error += work.stats[i].squared_error;
            stats->squared_length += work.stats[i].squared_length;
        }
        result = lmb_grid_dilate(grid);
    }
    free(work.stats);
    return result;
}
