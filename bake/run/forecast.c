#include "run/forecast.h"

#include <lambent/probes_bake.h>

#include "base/clock.h"
#include "solve/light_rows.h"

/* A trial takes no more elements than this, nor more than one of so many, nor more samples at each. */
enum { TRIAL_MOST = 128, TRIAL_ONE_OF = 32, TRIAL_SAMPLES = 1024 };

#define TRIAL_WEIGHT 0.05

/* Rough, for as long as the surface light is not solved: every side of every cell gets some pilot samples, fewer on
 * small triangles, then half of them, the lit ones, the rest of theirs, but those of small triangles; bounces take a
 * part more. */
#define LIT_SHARE 0.5
#define BOUNCES_SHARE 0.1

/* Measured, of one thread; writing is a small part of any bake. */
#define DENOISE_SECONDS_PER_TEXEL 1e-5
#define WRITE_SECONDS_PER_PROBE 3e-6
#define WRITE_SECONDS_PER_TEXEL 1e-6
#define WRITE_SECONDS_PER_CHARTED_TRIANGLE 3e-6

/* What a trial says of all elements. */
typedef struct trial_result {
    double seconds;
    double seconds_per_sample;
} trial_result;

/* Some of a list's elements, spread over it. */
typedef struct trial_list {
    const lmb_gather_list *all;
    size_t count;
} trial_list;

static void trial_site(const void *context, size_t element, lmb_gather_site *site)
{
    const trial_list *list = context;
    list->all->find_site(list->all->context, list->all->count * element / list->count, site);
}

/* Seconds for all of a list's elements, from some of them, and for one sample. */
static lmb_result trial_run(const lmb_bake *bake, const lmb_transport *transport, const lmb_gather_list *all,
                            trial_result *trial)
{
    const lmb_gather_effort wanted = lmb_bake_effort(&bake->record.settings, bake->level);
    const lmb_gather_effort tried = {.samples = wanted.samples < TRIAL_SAMPLES ? wanted.samples : TRIAL_SAMPLES};
    const size_t share = all->count / TRIAL_ONE_OF, most = share < TRIAL_MOST ? share : TRIAL_MOST;
    const trial_list some = {all, most > 0 ? most : 1};
    const lmb_gather_list list = {.name = "trial",
                                  .count = some.count,
                                  .most_points = all->most_points,
                                  .find_site = trial_site,
                                  .context = &some};
    const lmb_gather_job job = lmb_gather_job_all(transport, &list, &tried);
    lmb_gathered gathered[TRIAL_MOST];
    lmb_gather_stats stats;
    const double start = lmb_clock_seconds();
    const lmb_result result = lmb_gather_elements(&job, bake->level->pool, NULL, gathered, &stats);
    const double threads = lmb_pool_threads(bake->level->pool), groups = (double)job.group_count;
    const double seconds = (lmb_clock_seconds() - start) * (groups < threads ? groups / threads : 1.0);
    if (result != LMB_OK) {
        return result;
    }
    double samples = 0.0;
    for (size_t i = 0; i < some.count; ++i) {
        samples += lmb_gather_effort_samples(&wanted, &gathered[i]);
    }
    trial->seconds_per_sample = seconds / (double)stats.samples;
    trial->seconds = trial->seconds_per_sample * samples / (double)some.count * (double)all->count;
    return LMB_OK;
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
    const double pilot =
        2.0 * ((double)LMB_ROWS_PILOT_SAMPLES * settings.max_cells + LMB_ROWS_SMALL_SAMPLES * triangles);
    const double lit = 2.0 * LIT_SHARE * (LMB_ROWS_SAMPLES - LMB_ROWS_PILOT_SAMPLES) * settings.max_cells;
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

static lmb_result probes_try(const lmb_bake *bake, const lmb_transport *transport, trial_result *trial)
{
    lmb_probe_list list;
    lmb_result result = lmb_probe_list_create(bake->probes, bake->regions, transport->tracer, &list);
    if (result == LMB_OK && list.count > 0) {
        const lmb_gather_list elements = lmb_probe_list_elements(&list);
        result = trial_run(bake, transport, &elements, trial);
    }
    lmb_probe_list_free(&list);
    return result;
}

static lmb_result texels_try(const lmb_bake *bake, const lmb_transport *transport, trial_result *trial)
{
    const lmb_gather_list elements = lmb_texel_list_elements(bake->texels);
    return elements.count > 0 ? trial_run(bake, transport, &elements, trial) : LMB_OK;
}

lmb_result lmb_forecast_make(const lmb_bake *bake, lmb_forecast *forecast)
{
    lmb_transport transport = bake->level->transport;
    const bool unsolved = bake->record.settings.estimator == LMB_ESTIMATOR_CACHED && !bake->level->surface;
    if (unsolved) {
        transport.bounces = 0; /* as many rays as when bounces are looked up */
    }
    trial_result probes = {0.0, 0.0}, texels = {0.0, 0.0};
    *forecast = (lmb_forecast){.known = true};
    lmb_result result = bake->probes ? probes_try(bake, &transport, &probes) : LMB_OK;
    if (result == LMB_OK && bake->lightmap) {
        result = texels_try(bake, &transport, &texels);
    }
    forecast->seconds[LMB_PHASE_PROBES] = probes.seconds;
    forecast->seconds[LMB_PHASE_LIGHTMAPS] = texels.seconds;
    if (unsolved) {
        surface_guess(bake, bake->probes ? probes.seconds_per_sample : texels.seconds_per_sample, forecast);
    }
    if (bake->lightmap && bake->record.settings.denoise) {
        forecast->seconds[LMB_PHASE_DENOISE] = DENOISE_SECONDS_PER_TEXEL * (double)bake->lightmap->covered_texel_count /
                                               (double)lmb_pool_threads(bake->level->pool);
    }
    forecast->seconds[LMB_PHASE_WRITE] = write_guess(bake);
    return result;
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
