#include <lambent/regions.h>

#include <stdlib.h>
#include <string.h>

#include "probes/regions_internal.h"

void lmb_regions_destroy(lmb_regions *regions)
{
    if (regions) {
        free(regions->point);
        free(regions->place);
        free(regions->corner);
        free(regions->hanging);
        free(regions->hangs);
        free(regions->unknown);
        free(regions->unknown_of);
        free(regions);
    }
}

const lmb_region_point *lmb_regions_points(const lmb_regions *regions, size_t *count)
{
    *count = regions->point_count;
    return regions->point;
}

bool lmb_regions_hangs(const lmb_regions *regions, int32_t probe)
{
    return regions->hangs[probe] != 0;
}

static void work_free(lmb_region_work *work)
{
    for (uint32_t level = 0; work->index && level < work->probes->level_count; ++level) {
        lmb_probe_index_free(&work->index[level]);
    }
    free(work->index);
    free(work->cell);
    for (uint32_t i = 0; work->look && i < work->look_count; ++i) {
        free(work->look[i].end);
        free(work->look[i].extension);
    }
    free(work->look);
    free(work->looked);
    free(work->looking);
    free(work->place);
    free(work->placed);
    free(work->root);
    free(work->reached);
    free(work->corner);
    free(work->link);
    free(work->rays);
}

/* The steps, one after the other. */
static lmb_result regions_find(lmb_region_work *work)
{
    static lmb_result (*const step[])(lmb_region_work *) = {
        lmb_region_cells_find, lmb_region_cells_look,   lmb_region_corners_name,
        lmb_region_cells_cut,  lmb_region_hanging_find, lmb_region_points_choose,
    };
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < sizeof step / sizeof step[0] && result == LMB_OK; ++i) {
        result = step[i](work);
    }
    return result;
}

lmb_result lmb_regions_make(const lmb_tracer *tracer, lmb_pool *pool, const lmb_progress *progress, lmb_probes *probes,
                            lmb_regions **regions, lmb_regions_stats *stats)
{
    if (probes->ghost_count > 0 || probes->cut.count > 0) {
        return LMB_ERROR_ARGUMENT;
    }
    *stats = (lmb_regions_stats){0};
    lmb_region_work work = {.tracer = tracer,
                            .pool = pool,
                            .progress = progress,
                            .probes = probes,
                            .index = calloc((size_t)probes->level_count + 1, sizeof *work.index),
                            .rays = calloc((size_t)lmb_pool_threads(pool), sizeof *work.rays),
                            .regions = calloc(1, sizeof *work.regions),
                            .stats = stats};
    const lmb_result result = work.index && work.rays && work.regions ? regions_find(&work) : LMB_ERROR_MEMORY;
    stats->cells_looked_into = work.look_count;
    for (int i = 0; work.rays && i < lmb_pool_threads(pool); ++i) {
        stats->rays += work.rays[i];
    }
    work_free(&work);
    if (result != LMB_OK) {
        lmb_regions_destroy(work.regions);
        return result;
    }
    *regions = work.regions;
    return LMB_OK;
}
