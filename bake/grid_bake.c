#include <lambent/grid_bake.h>

#include <stdlib.h>

#include "bake_internal.h"

enum { PROBES_PER_TASK = 4 };

typedef struct lmb_grid_work {
    lmb_grid *grid;
    const lmb_transport *transport;
    uint32_t samples;
    float *relative_error; /* [probe] negative when not baked */
    uint64_t *rays;        /* [probe] */
} lmb_grid_work;

static void grid_task(void *context, size_t task, int worker)
{
    (void)worker;
    const lmb_grid_work *work = context;
    lmb_grid *grid = work->grid;
    const int32_t first = (int32_t)(task * PROBES_PER_TASK);
    const int32_t last = first + PROBES_PER_TASK < grid->probe_count ? first + PROBES_PER_TASK : grid->probe_count;
    for (int32_t i = first; i < last; ++i) {
        work->relative_error[i] = -1.0f;
        if (grid->validity[i] < LMB_GRID_MIN_VALIDITY) {
            continue;
        }
        const lmb_gather_point point = {.position = lmb_grid_position(grid, i)};
        lmb_gathered gathered;
        lmb_gather_sh3(work->transport, &point, work->samples, &gathered);
        grid->radiance[i] = gathered.moments;
        work->relative_error[i] = gathered.relative_error;
        work->rays[i] = gathered.rays;
    }
}

lmb_result lmb_grid_bake(lmb_grid *grid, const lmb_transport *transport, uint32_t samples, lmb_pool *pool,
                         const lmb_progress *progress, lmb_grid_bake_stats *stats)
{
    const size_t count = (size_t)grid->probe_count;
    lmb_grid_work work = {.grid = grid,
                          .transport = transport,
                          .samples = samples,
                          .relative_error = calloc(count + 1, sizeof(float)),
                          .rays = calloc(count + 1, sizeof(uint64_t))};
    lmb_result result = work.relative_error && work.rays ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        const size_t tasks = (count + PROBES_PER_TASK - 1) / PROBES_PER_TASK;
        result = lmb_pool_run(pool, tasks, grid_task, &work, "probes", progress);
    }
    if (result == LMB_OK) {
        *stats = (lmb_grid_bake_stats){0};
        double sum = 0.0;
        int64_t baked = 0;
        for (size_t i = 0; i < count; ++i) {
            stats->rays += work.rays[i];
            if (work.relative_error[i] >= 0.0f) {
                sum += (double)work.relative_error[i] * (double)work.relative_error[i];
                ++baked;
            }
        }
        stats->relative_error = baked > 0 ? sqrt(sum / (double)baked) : 0.0;
        result = lmb_grid_dilate(grid);
    }
    free(work.relative_error);
    free(work.rays);
    return result;
}
