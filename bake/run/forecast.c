#include "run/forecast.h"

#include <lambent/opaque_surface.h>
#include <lambent/placement.h>
#include <lambent/surface.h>

#include "base/clock.h"

/* A trial takes no more elements than this, nor more than one of so many, nor more samples at each. */
enum { TRIAL_MOST = 128, TRIAL_ONE_OF = 32, TRIAL_SAMPLES = 1024 };

#define TRIAL_WEIGHT 0.05

/* Rough, for as long as the surface light is not solved: every side of every cell gets some pilot samples, fewer on
 * small triangles, then half of them, the lit ones, the rest of theirs, but those of small triangles; bounces take a
 * part more. */
#define PILOT_SAMPLES 4.0
#define SMALL_SAMPLES 2.0
#define LIT_SAMPLES 8.0
#define LIT_SHARE 0.5
#define BOUNCES_SHARE 0.1

/* Measured; writing is a small part of any bake. */
#define WRITE_SECONDS_PER_PROBE 3e-6
#define WRITE_SECONDS_PER_TEXEL 1e-6
#define WRITE_SECONDS_PER_CHARTED_TRIANGLE 3e-6

typedef struct trial_work {
    const lmb_bake *bake;
    lmb_transport transport;
    lmb_opaque_surface surface;
    lmb_gather_effort effort;
    uint32_t count;
    uint32_t wanted[TRIAL_MOST]; /* samples that each element would take */
} trial_work;

static uint32_t trial_samples(const trial_work *work)
{
    return work->effort.samples < TRIAL_SAMPLES ? work->effort.samples : TRIAL_SAMPLES;
}

static void element_try(trial_work *work, const lmb_gather_point *point, size_t element)
{
    lmb_gathered gathered;
    lmb_gather_sh3_area(&work->transport, point, 1, trial_samples(work), &gathered);
    work->wanted[element] = lmb_gather_effort_samples(&work->effort, &gathered);
}

static void probe_task(void *context, size_t task, int worker)
{
    (void)worker;
    trial_work *work = context;
    const lmb_grid *grid = work->bake->grid;
    int32_t probe = (int32_t)((int64_t)grid->probe_count * (int64_t)task / work->count);
    while (probe + 1 < grid->probe_count && grid->validity[probe] < LMB_GRID_MIN_VALIDITY) {
        ++probe;
    }
    uint64_t rays = 0;
    const lmb_gather_point point = {.position = lmb_placement_relocate(
                                        work->transport.tracer, lmb_grid_position(grid, probe), grid->spacing, &rays)};
    element_try(work, &point, task);
}

static void texel_task(void *context, size_t task, int worker)
{
    (void)worker;
    trial_work *work = context;
    const lmb_tracer *tracer = work->transport.tracer;
    const lmb_hit at = lmb_opaque_surface_point(&work->surface, 0, (uint32_t)task, work->count);
    const lmb_place place = lmb_trace_place(tracer, &at);
    bool pushed_out;
    const lmb_gather_point point =
        lmb_surface_gather_point(tracer, &place, 1.0f / work->bake->lightmap->settings.texels_per_m, &pushed_out);
    element_try(work, &point, task);
}

/* Seconds for all of `total` elements, from some of them, and for one sample. */
static double trial_run(trial_work *work, lmb_task_function task, double total, double *seconds_per_sample)
{
    double count = total / TRIAL_ONE_OF;
    count = count < TRIAL_MOST ? count : TRIAL_MOST;
    work->count = count > 1.0 ? (uint32_t)count : 1;
    const double start = lmb_clock_seconds();
    lmb_pool_run(work->bake->level->pool, work->count, task, work, "trial", NULL);
    const double seconds = lmb_clock_seconds() - start;
    double wanted = 0.0;
    for (uint32_t i = 0; i < work->count; ++i) {
        wanted += work->wanted[i];
    }
    *seconds_per_sample = seconds / ((double)work->count * trial_samples(work));
    return *seconds_per_sample * wanted / work->count * total;
}

/* Rough seconds of solving the surface light, by what a sample of a probe costs. */
static void surface_guess(const lmb_bake *bake, double seconds_per_sample, lmb_forecast *forecast)
{
    const lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    const lmb_scene *scene = bake->level->scene;
    double triangles = 0.0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        triangles += scene->instances[i].dynamic ? 0.0 : scene->meshes[scene->instances[i].mesh].triangle_count;
    }
    const double pilot = 2.0 * (PILOT_SAMPLES * settings.max_cells + SMALL_SAMPLES * triangles);
    const double lit = 2.0 * LIT_SHARE * (LIT_SAMPLES - PILOT_SAMPLES) * settings.max_cells;
    forecast->seconds[LMB_PHASE_PILOT] = pilot * seconds_per_sample;
    forecast->seconds[LMB_PHASE_SURFACE] = lit * seconds_per_sample;
    forecast->seconds[LMB_PHASE_BOUNCES] = BOUNCES_SHARE * (pilot + lit) * seconds_per_sample;
}

/* Triangles of the meshes that are written again, with UVs of their own. */
static double charted_triangles(const lmb_lightmap *lightmap)
{
    double count = 0.0;
    for (uint32_t i = 0; i < lightmap->scene->mesh_count; ++i) {
        count += lightmap->corner_uv[i] ? lightmap->scene->meshes[i].triangle_count : 0.0;
    }
    return count;
}

static double write_guess(const lmb_bake *bake)
{
    double seconds = WRITE_SECONDS_PER_PROBE * bake->record.placement.probes_valid;
    if (bake->lightmap) {
        seconds += WRITE_SECONDS_PER_TEXEL * (double)bake->lightmap->covered_texel_count +
                   WRITE_SECONDS_PER_CHARTED_TRIANGLE * charted_triangles(bake->lightmap);
    }
    return seconds;
}

lmb_result lmb_forecast_make(const lmb_bake *bake, lmb_forecast *forecast)
{
    trial_work work = {.bake = bake,
                       .transport = bake->level->transport,
                       .effort = lmb_bake_effort(&bake->record.settings, bake->level)};
    double seconds_per_sample = 0.0;
    const bool unsolved = bake->record.settings.estimator == LMB_ESTIMATOR_CACHED && !bake->level->surface;
    if (unsolved) {
        work.transport.bounces = 0; /* as many rays as when bounces are looked up */
    }
    const double probes = bake->record.placement.probes_valid;
    const double texels = bake->lightmap ? (double)bake->lightmap->covered_texel_count : 0.0;
    *forecast = (lmb_forecast){.known = true};
    if (probes > 0.0) {
        forecast->seconds[LMB_PHASE_PROBES] = trial_run(&work, probe_task, probes, &seconds_per_sample);
    }
    if (texels > 0.0) {
        const lmb_result result = lmb_opaque_surface_create(work.transport.tracer, &work.surface);
        if (result != LMB_OK) {
            return result;
        }
        if (lmb_opaque_surface_area(&work.surface) > 0.0) {
            forecast->seconds[LMB_PHASE_LIGHTMAPS] = trial_run(&work, texel_task, texels, &(double){0.0});
        }
        lmb_opaque_surface_free(&work.surface);
    }
    if (unsolved && probes > 0.0) {
        surface_guess(bake, seconds_per_sample, forecast);
    }
    forecast->seconds[LMB_PHASE_WRITE] = write_guess(bake);
    return LMB_OK;
}

double lmb_forecast_left(const lmb_forecast *forecast, lmb_bake_phase phase, double done, double elapsed)
{
    if (!forecast->known) {
        return -1.0;
    }
    /* Bounces say nothing of how many there will be. How another phase gets on counts as much as the trial once
     * TRIAL_WEIGHT of it is done. */
    const double expected = forecast->seconds[phase];
    double left = phase == LMB_PHASE_BOUNCES
                      ? expected
                      : (1.0 - done) * (TRIAL_WEIGHT * expected + elapsed) / (TRIAL_WEIGHT + done);
    for (int later = (int)phase + 1; later < LMB_PHASE_COUNT; ++later) {
        left += forecast->seconds[later];
    }
    return left;
}
