#include "run/bake_phases_levels.h"

#include <math.h>

#include "base/clock.h"
#include "run/step.h"

/* The even level is the finest of the plan whose box has no more points than this: looking at a point costs some
 * hundred rays, and what is missed in gaps narrower than its spacing no finer level finds. */
#define EVEN_POINTS 65536.0

/* Without --spacing, how many times the default spacing the coarsest one is. */
#define COARSEST_SPACINGS 4.0f

/* Trials: noise of so many tolerances at each place, by no more samples than this. Bands 1 and 2, which have most of
 * the noise, count for less in irradiance than in what the effort goes by. */
#define TRIAL_NOISE 1.0
enum { TRIAL_SAMPLES = 64, TRIAL_MAX_SAMPLES = 512 };

/* What is darker than this share of the level's mean light is held to that. */
#define DARK_SHARE 0.01

static double box_points(const lmb_scene *scene, double spacing)
{
    const double size[3] = {(double)scene->bounds_max.x - (double)scene->bounds_min.x,
                            (double)scene->bounds_max.y - (double)scene->bounds_min.y,
                            (double)scene->bounds_max.z - (double)scene->bounds_min.z};
    return (size[0] / spacing + 2.0) * (size[1] / spacing + 2.0) * (size[2] / spacing + 2.0);
}

lmb_level_plan lmb_bake_level_plan(const lmb_bake_settings *settings, const lmb_scene *scene)
{
    const float detail = settings->detail > 0.0f ? settings->detail : 1.0f;
    const float usual = lmb_placement_default_spacing(scene) / detail;
    const bool has_levels = settings->min_spacing > 0.0f;
    lmb_level_plan plan = {.even_spacing = settings->spacing > 0.0f ? settings->spacing
                                           : has_levels             ? COARSEST_SPACINGS * usual
                                                                    : usual};
    const double most = fmin(EVEN_POINTS, (double)settings->max_probes);
    float spacing = plan.even_spacing;
    while (has_levels && 0.5f * spacing >= 0.9999f * settings->min_spacing) {
        spacing *= 0.5f;
        if (plan.finer == 0 && box_points(scene, (double)spacing) <= most) {
            plan.even_spacing = spacing;
            ++plan.coarser;
        } else {
            ++plan.finer;
        }
    }
    return plan;
}

/* The phase before said that it was done; it can still be stopped. */
typedef struct regions_report {
    const lmb_progress *progress;
    lmb_bake_phase phase;
} regions_report;

static bool report_regions(void *context, const char *name, double done)
{
    const regions_report *report = context;
    (void)name;
    (void)done;
    return report->progress->report(report->progress->context, lmb_bake_phase_name(report->phase), 1.0);
}

lmb_result lmb_bake_regions(lmb_bake *bake, lmb_bake_phase phase, lmb_error *error)
{
    lmb_bake_record *record = &bake->record;
    regions_report report = {bake->progress, phase};
    const lmb_progress progress = {bake->progress && bake->progress->report ? report_regions : NULL, &report};
    lmb_result result = lmb_regions_make(bake->level->tracer, bake->level->pool, &progress, bake->probes,
                                         &bake->regions, &record->regions);
    record->rays[phase] += record->regions.rays;
    if (result == LMB_OK && bake->probes->level_count > 1) {
        result = lmb_placement_hang(bake->level->tracer, bake->level->pool, bake->probes, &record->placement);
    }
    return result == LMB_OK ? LMB_OK : lmb_error_set(error, result, "regions: %s", lmb_result_text(result));
}

void lmb_bake_record_levels(lmb_bake *bake)
{
    lmb_bake_record *record = &bake->record;
    const lmb_probes *probes = bake->probes;
    record->probes = probes->count;
    record->level_count = 0;
    for (uint32_t level = 0; level < probes->level_count && record->level_count < LMB_BAKE_LEVELS_MOST; ++level) {
        record->level[record->level_count++] =
            (lmb_level_record){probes->level[level].lattice.spacing, probes->level[level].count};
    }
}

lmb_result lmb_bake_levels(lmb_bake *bake, lmb_error *error)
{
    lmb_bake_record *record = &bake->record;
    const lmb_level_plan plan = lmb_bake_level_plan(&record->settings, bake->level->scene);
    if (!bake->probes || plan.coarser + plan.finer == 0) {
        return LMB_OK;
    }
    const double start = lmb_clock_seconds();
    const uint64_t placed_rays = record->placement.rays;
    const float even_spacing = bake->probes->level[0].lattice.spacing;
    lmb_levels_settings settings = {.coarser = plan.coarser,
                                    .finer = plan.finer,
                                    .tolerance = record->settings.tolerance,
                                    .dark = DARK_SHARE * bake->level->mean_light,
                                    .effort = lmb_bake_effort(&record->settings, bake->level),
                                    .max_probes = record->settings.max_probes,
                                    .has_seeds = record->settings.seed_count + bake->level->scene->seed_point_count > 0,
                                    .progress = bake->progress};
    settings.effort.samples = TRIAL_SAMPLES;
    settings.effort.max_samples = TRIAL_MAX_SAMPLES;
    settings.effort.tolerance = TRIAL_NOISE * record->settings.tolerance;
    const char *name = lmb_bake_phase_name(LMB_PHASE_LEVELS);
    lmb_result result = step_report(bake->progress, name, 0.0, error);
    if (result == LMB_OK) {
        result = lmb_placement_levels(&bake->level->transport, &settings, bake->level->pool, &bake->probes,
                                      &record->placement, error);
    }
    record->rays[LMB_PHASE_LEVELS] = record->placement.rays - placed_rays;
    lmb_bake_record_levels(bake);
    if (result == LMB_OK) {
        result = lmb_bake_regions(bake, LMB_PHASE_LEVELS, error);
    }
    record->settings.spacing = ldexpf(even_spacing, (int)plan.coarser);
    record->settings.min_spacing = ldexpf(even_spacing, -(int)plan.finer);
    record->seconds[LMB_PHASE_LEVELS] = lmb_clock_seconds() - start;
    return result == LMB_OK ? step_report(bake->progress, name, 1.0, error) : result;
}
