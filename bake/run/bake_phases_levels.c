#include "run/bake_phases_levels.h"

#include <math.h>
#include <stdlib.h>

#include "base/clock.h"
#include "run/bake_phases_record.h"
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

/* Spacings of boxes are looked for within so many levels of the level's own. */
enum { LEVELS_AWAY = 30 };

/* Spacings that differ by no more than rounding are one. */
#define ROUNDED_UP 1.0001f

/* What is darker than this share of the level's mean light is held to that. */
#define DARK_SHARE 0.01

static double box_points(const lmb_scene *scene, double spacing)
{
    const double size[3] = {(double)scene->bounds_max.x - (double)scene->bounds_min.x,
                            (double)scene->bounds_max.y - (double)scene->bounds_min.y,
                            (double)scene->bounds_max.z - (double)scene->bounds_min.z};
    return (size[0] / spacing + 2.0) * (size[1] / spacing + 2.0) * (size[2] / spacing + 2.0);
}

/* Levels count from the level's own spacing, which is 0: finer ones are below it. */
typedef struct level_span {
    int coarsest, finest;
} level_span;

/* The coarsest one of a spacing that is not more than this. */
static int level_below(float own, float spacing)
{
    int level = 0;
    for (; level < LEVELS_AWAY && ldexpf(own, level + 1) <= ROUNDED_UP * spacing; ++level) {
    }
    for (; level > -LEVELS_AWAY && ldexpf(own, level) > ROUNDED_UP * spacing; --level) {
    }
    return level;
}

/* The finest one of a spacing that is not less than this, from some level on. */
static int level_above(float own, float spacing, int from)
{
    int level = from;
    for (; level > -LEVELS_AWAY && ROUNDED_UP * ldexpf(own, level - 1) >= spacing; --level) {
    }
    return level;
}

static float own_spacing(const lmb_bake_settings *settings, const lmb_scene *scene)
{
    const float detail = settings->detail > 0.0f ? settings->detail : 1.0f;
    const float usual = lmb_placement_default_spacing(scene) / detail;
    return settings->spacing > 0.0f ? settings->spacing
                                    : (settings->min_spacing > 0.0f ? COARSEST_SPACINGS * usual : usual);
}

/* Of a box, or of all other places: NULL. */
static level_span span_of(const lmb_bake_settings *settings, float own, const lmb_probe_box *box)
{
    const float least = box && box->min_spacing > 0.0f ? box->min_spacing : settings->min_spacing;
    const int coarsest = box && box->spacing > 0.0f ? level_below(own, box->spacing) : 0;
    return (level_span){coarsest, least > 0.0f ? level_above(own, least, coarsest) : coarsest};
}

lmb_level_plan lmb_bake_level_plan(const lmb_bake_settings *settings, const lmb_scene *scene)
{
    const float own = own_spacing(settings, scene);
    level_span all = span_of(settings, own, NULL);
    for (uint32_t i = 0; i < scene->probe_box_count; ++i) {
        const level_span span = span_of(settings, own, &scene->probe_boxes[i]);
        if (!scene->probe_boxes[i].exclude) {
            all.coarsest = span.coarsest > all.coarsest ? span.coarsest : all.coarsest;
            all.finest = span.finest < all.finest ? span.finest : all.finest;
        }
    }
    const double most = fmin(EVEN_POINTS, (double)settings->max_probes);
    int even = 0;
    while (even > all.finest && box_points(scene, (double)ldexpf(own, even - 1)) <= most) {
        --even;
    }
    return (lmb_level_plan){.even_spacing = ldexpf(own, even),
                            .coarser = (uint32_t)(all.coarsest - even),
                            .finer = (uint32_t)(even - all.finest),
                            .own = (uint32_t)(-all.finest)};
}

/* One for each box of the scene, and one for all other places. NULL: out of memory. */
static lmb_level_rule *rules_make(const lmb_bake_settings *settings, const lmb_scene *scene, const lmb_level_plan *plan)
{
    const float own = ldexpf(plan->even_spacing, (int)plan->own - (int)plan->finer);
    lmb_level_rule *const rules = malloc((scene->probe_box_count + 1) * sizeof *rules);
    for (uint32_t i = 0; i <= scene->probe_box_count && rules; ++i) {
        const lmb_probe_box *const box = i < scene->probe_box_count ? &scene->probe_boxes[i] : NULL;
        const level_span span = span_of(settings, own, box);
        rules[i] =
            (lmb_level_rule){.coarsest = (uint32_t)(span.coarsest + (int)plan->own),
                             .finest = (uint32_t)(span.finest + (int)plan->own),
                             .tolerance = box && box->tolerance > 0.0f ? (double)box->tolerance : settings->tolerance};
    }
    return rules;
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

/* What --max-probes cost. */
static void limit_warn(const lmb_bake *bake)
{
    const lmb_placement_stats *stats = &bake->record.placement;
    const lmb_warnings *warnings = &bake->level->warnings;
    if (stats->tolerance_scale > 1.0) {
        lmb_warn(warnings, "%s: no more than %d probes: tolerances of levels are %.3g times what was asked for",
                 bake->level->scene->path, bake->record.settings.max_probes, stats->tolerance_scale);
    }
    if (stats->levels_lost > 0) {
        lmb_warn(warnings, "%s: no more than %d probes: the finest %u levels that boxes ask for are left out",
                 bake->level->scene->path, bake->record.settings.max_probes, stats->levels_lost);
    }
}

static lmb_result levels_place(lmb_bake *bake, const lmb_level_plan *plan, lmb_error *error)
{
    lmb_bake_record *record = &bake->record;
    lmb_level_rule *const rules = rules_make(&record->settings, bake->level->scene, plan);
    if (!rules) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for boxes of probes");
    }
    lmb_levels_settings settings = {.coarser = plan->coarser,
                                    .finer = plan->finer,
                                    .tolerance = record->settings.tolerance,
                                    .rule = rules,
                                    .dark = DARK_SHARE * bake->level->mean_light,
                                    .effort = lmb_bake_effort(&record->settings, bake->level),
                                    .max_probes = record->settings.max_probes,
                                    .has_seeds = record->settings.seed_count + bake->level->scene->seed_point_count > 0,
                                    .progress = bake->progress};
    settings.effort.samples = TRIAL_SAMPLES;
    settings.effort.max_samples = TRIAL_MAX_SAMPLES;
    settings.effort.tolerance = TRIAL_NOISE * record->settings.tolerance;
    const lmb_result result = lmb_placement_levels(&bake->level->transport, &settings, bake->level->pool, &bake->probes,
                                                   &record->placement, error);
    free(rules);
    return result;
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
    const char *name = lmb_bake_phase_name(LMB_PHASE_LEVELS);
    lmb_result result = step_report(bake->progress, name, 0.0, error);
    if (result == LMB_OK) {
        result = levels_place(bake, &plan, error);
    }
    record->rays[LMB_PHASE_LEVELS] = record->placement.rays - placed_rays;
    lmb_bake_record_levels(bake);
    if (result == LMB_OK) {
        limit_warn(bake);
        result = lmb_bake_regions(bake, LMB_PHASE_LEVELS, error);
    }
    const level_span own = span_of(&record->settings, own_spacing(&record->settings, bake->level->scene), NULL);
    record->settings.spacing = ldexpf(even_spacing, (int)plan.own - (int)plan.finer);
    if (record->settings.min_spacing > 0.0f) {
        record->settings.min_spacing = ldexpf(record->settings.spacing, own.finest);
    }
    record->seconds[LMB_PHASE_LEVELS] = lmb_clock_seconds() - start;
    return result == LMB_OK ? step_report(bake->progress, name, 1.0, error) : result;
}
