#include <lambent/grid_bake.h>

#include <lambent/placement.h>

#include <stdlib.h>

/* A probe speaks for the space within half a spacing of it. */
#define LIGHT_DISTANCE_SPACINGS 0.5f

typedef struct lmb_grid_work {
    lmb_grid *grid;
    const lmb_transport *transport;
    const lmb_gather_effort *effort;
    size_t count;               /* of probes that are gathered at */
    int32_t *probes;            /* these */
    lmb_grid_bake_stats *stats; /* [group] */
} lmb_grid_work;

static lmb_gather_point probe_point(const lmb_grid_work *work, int32_t probe, uint64_t *rays)
{
    const lmb_grid *grid = work->grid;
    return (lmb_gather_point){.position = lmb_placement_relocate(work->transport->tracer,
                                                                 lmb_grid_position(grid, probe), grid->spacing, rays),
                              .min_light_distance = LIGHT_DISTANCE_SPACINGS * grid->spacing};
}

static void group_task(void *context, size_t group, int worker)
{
    (void)worker;
    const lmb_grid_work *work = context;
    const size_t first = lmb_gather_group_first(work->count, group);
    const uint32_t count = (uint32_t)(lmb_gather_group_first(work->count, group + 1) - first);
    lmb_grid_bake_stats *stats = &work->stats[group];
    lmb_gather_point points[LMB_GATHER_GROUP_MOST];
    lmb_gather_element elements[LMB_GATHER_GROUP_MOST];
    for (uint32_t i = 0; i < count; ++i) {
        points[i] = probe_point(work, work->probes[first + i], &stats->rays);
        elements[i] = (lmb_gather_element){.points = &points[i], .point_count = 1};
    }
    lmb_gather_sh3_group(work->transport, work->effort, elements, count);
    for (uint32_t i = 0; i < count; ++i) {
        const lmb_gathered *gathered = &elements[i].gathered;
        work->grid->radiance[work->probes[first + i]] = gathered->moments;
        stats->samples += gathered->samples;
        stats->rays += gathered->rays;
        stats->squared_error += gathered->squared_error;
        stats->squared_length += gathered->squared_length;
    }
}

/* In the grid's order, in which neighbours follow each other. */
static void probes_list(lmb_grid_work *work)
{
    for (int32_t i = 0; i < work->grid->probe_count; ++i) {
        if (work->grid->validity[i] >= LMB_GRID_MIN_VALIDITY) {
            work->probes[work->count++] = i;
        }
    }
}

static lmb_grid_bake_stats stats_sum(const lmb_grid_work *work)
{
    lmb_grid_bake_stats sum = {0};
    for (size_t i = 0; i < lmb_gather_group_count(work->count); ++i) {
        sum.samples += work->stats[i].samples;
        sum.rays += work->stats[i].rays;
        sum.squared_error += work->stats[i].squared_error;
        sum.squared_length += work->stats[i].squared_length;
    }
    return sum;
}

lmb_result lmb_grid_bake(lmb_grid *grid, const lmb_transport *transport, const lmb_gather_effort *effort,
                         lmb_pool *pool, const lmb_progress *progress, lmb_grid_bake_stats *stats)
{
    const size_t most = (size_t)grid->probe_count + 1;
    lmb_grid_work work = {.grid = grid,
                          .transport = transport,
                          .effort = effort,
                          .probes = malloc(most * sizeof *work.probes),
                          .stats = calloc(most / LMB_GATHER_GROUP + 1, sizeof *work.stats)};
    lmb_result result = work.probes && work.stats ? LMB_OK : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        probes_list(&work);
        result = lmb_pool_run(pool, lmb_gather_group_count(work.count), group_task, &work, "probes", progress);
    }
    if (result == LMB_OK) {
        *stats = stats_sum(&work);
        result = lmb_grid_dilate(grid);
    }
    free(work.probes);
    free(work.stats);
    return result;
}
