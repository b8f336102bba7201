/* Which probes of finer levels hang on coarser ones' cells. */
#include "probes/placement_internal.h"

#include <stdlib.h>

#include <lambent/vector.h>

enum { PROBES_PER_TASK = 256 };

typedef struct hang_work {
    const lmb_tracer *tracer;
    lmb_probes *probes;
    uint64_t *rays; /* [task] */
} hang_work;

typedef struct hang_view {
    const hang_work *work;
    uint64_t rays;
} hang_view;

/* As light is gathered there. */
static bool probe_sees(void *context, int32_t probe, lmb_vec3d place)
{
    hang_view *view = context;
    const lmb_probes *probes = view->work->probes;
    if (!(probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY)) {
        return false;
    }
    const lmb_tracer *tracer = view->work->tracer;
    const lmb_vec3 from = lmb_placement_relocate(tracer, lmb_probes_position(probes, probe),
                                                 lmb_probes_footprint(probes, probe), &view->rays);
    const lmb_vec3 to = lmb_scene_from_world(lmb_tracer_scene(tracer), place);
    return lmb_rgb_max(lmb_trace_transmittance(tracer, from, to, &view->rays)) > 0.0f;
}

static void hang_task(void *context, size_t task, int worker)
{
    (void)worker;
    const hang_work *work = context;
    hang_view view = {work, 0};
    const int32_t first = (int32_t)task * PROBES_PER_TASK, rest = work->probes->count - first;
    lmb_probes_find_hanging(work->probes, first, rest < PROBES_PER_TASK ? rest : PROBES_PER_TASK, probe_sees, &view);
    work->rays[task] = view.rays;
}

static void probes_count(const lmb_probes *probes, lmb_placement_stats *stats)
{
    stats->probes_valid = stats->probes_dilated = stats->probes_hanging = 0;
    for (int32_t i = 0; i < probes->count - probes->ghost_count; ++i) {
        const bool hangs = probes->hanging[i] != 0;
        const bool baked = !hangs && probes->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        stats->probes_hanging += hangs;
        stats->probes_valid += baked;
        stats->probes_dilated += !hangs && !baked;
    }
}

lmb_result lmb_placement_hang(const lmb_tracer *tracer, lmb_pool *pool, lmb_probes *probes, lmb_placement_stats *stats)
{
    const size_t tasks = ((size_t)probes->count + PROBES_PER_TASK - 1) / PROBES_PER_TASK;
    hang_work work = {tracer, probes, calloc(tasks + 1, sizeof *work.rays)};
    if (!work.rays) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_pool_run(pool, tasks, hang_task, &work, "levels", NULL);
    for (size_t i = 0; i < tasks; ++i) {
        stats->rays += work.rays[i];
    }
    free(work.rays);
    probes_count(probes, stats);
    return result;
}
