#include "probes/placement_internal.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/probe_boxes.h>

#define DEFAULT_POINTS 32768.0
/* A probe count over the limit is approached in this many steps at most. */
#define MAX_SPACING_STEPS 12

lmb_placement_settings lmb_placement_settings_default(void)
{
    return (lmb_placement_settings){.max_probes = 262144};
}

float lmb_placement_default_spacing(const lmb_scene *scene)
{
    const double low[3] = {(double)scene->bounds_min.x, (double)scene->bounds_min.y, (double)scene->bounds_min.z};
    const double high[3] = {(double)scene->bounds_max.x, (double)scene->bounds_max.y, (double)scene->bounds_max.z};
    double longest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        longest = fmax(longest, high[axis] - low[axis]);
    }
    if (!(longest > 0.0) || !isfinite(longest)) {
        return 1.0f;
    }
    /* A flat level is not infinitely thin: no side counts as less than 1/64 of the longest. */
    double volume = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        volume *= fmax(high[axis] - low[axis], longest / 64.0);
    }
    /* Cube root by Newton, then up to the next round figure; libm's cbrt and log differ between machines. */
    const double target = volume / DEFAULT_POINTS;
    double spacing = longest;
    for (int i = 0; i < 100; ++i) {
        spacing -= (spacing - target / (spacing * spacing)) / 3.0;
    }
    double decade = 1.0;
    while (decade > spacing) {
        decade /= 10.0;
    }
    while (decade * 10.0 <= spacing) {
        decade *= 10.0;
    }
    static const double round_figures[] = {1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};
    size_t i = 0;
    while (round_figures[i] * decade < spacing * (1.0 - 1e-9)) {
        ++i;
    }
    return (float)(round_figures[i] * decade);
}

bool lmb_placement_box(const lmb_scene *scene, float spacing, lmb_lattice *box)
{
    const float low[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float high[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    const double origin[3] = {scene->origin.x, scene->origin.y, scene->origin.z};
    for (int axis = 0; axis < 3; ++axis) {
        const double first = floor(((double)low[axis] + origin[axis]) / (double)spacing);
        const double last = fmax(ceil(((double)high[axis] + origin[axis]) / (double)spacing), first + 1.0);
        if (!(fabs(first) < 1e9) || !(fabs(last) < 1e9)) {
            return false;
        }
        box->min[axis] = (int32_t)first;
        box->size[axis] = (int32_t)(last - first) + 1;
    }
    box->spacing = spacing;
    return true;
}

static void survey_free(lmb_survey *survey)
{
    lmb_point_set_free(&survey->points);
    free(survey->validity);
    free(survey->free);
    *survey = (lmb_survey){0};
}

/* Adds the points next to those of a set along an axis. */
static lmb_result points_widen(const lmb_lattice *box, int axis, lmb_point_set *set)
{
    lmb_result result = LMB_OK;
    const int32_t count = set->count;
    for (int32_t i = 0; i < count; ++i) {
        int32_t at[3];
        memcpy(at, set->point[i], sizeof at);
        for (int step = -1; step <= 1 && result == LMB_OK; step += 2) {
            at[axis] = set->point[i][axis] + step;
            if (lmb_lattice_has(box, at)) {
                result = lmb_point_set_add(set, at);
            }
        }
    }
    return result;
}

/* Whether probes are wanted around a point, that a box keeps from having them or not. */
static bool point_is_wanted(const lmb_survey *survey, int32_t i, bool despite_boxes)
{
    return survey->free[i] &&
           (despite_boxes || !lmb_scene_probes_excluded(lmb_tracer_scene(survey->tracer),
                                                        survey_position(survey, survey->points.point[i])));
}

/* The corners of every cell that has a wanted corner: every point that is, or is next to, one, found along one axis
 * after the other. A box has at least one cell along each. */
static lmb_result wanted_find(const lmb_survey *survey, bool despite_boxes, lmb_point_set *wanted)
{
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < survey->points.count && result == LMB_OK; ++i) {
        if (point_is_wanted(survey, i, despite_boxes)) {
            result = lmb_point_set_add(wanted, survey->points.point[i]);
        }
    }
    for (int axis = 0; axis < 3 && result == LMB_OK; ++axis) {
        result = points_widen(&survey->box, axis, wanted);
    }
    return result;
}

static bool survey_any_free(const lmb_survey *survey)
{
    return survey->points.count > 0 && memchr(survey->free, 1, (size_t)survey->points.count) != NULL;
}

enum { SEED_TEXT = 160 };

/* Which seed, and why it is none. */
static void seed_describe(const lmb_scene *scene, const lmb_seed_list *seeds, uint32_t i, char text[SEED_TEXT])
{
    const bool has_name = i >= seeds->callers && scene->seed_names;
    const char *name = has_name ? scene->seed_names[i - seeds->callers] : "";
    const lmb_vec3d at = lmb_scene_to_world(scene, seeds->at[i]);
    snprintf(text, SEED_TEXT, "seed %s%.60s%sat %g,%g,%g lies %s", has_name ? "node '" : "point ", name,
             has_name ? "' " : "", at.x, at.y, at.z,
             seeds->state[i] == LMB_SEED_OUTSIDE ? "outside the level's bounds"
                                                 : "in a solid, or in a gap narrower than the spacing");
}

/* Names the first few. */
static lmb_result seeds_fail(const lmb_scene *scene, const lmb_seed_list *seeds, lmb_error *error)
{
    enum { NAMED = 2 };
    char text[NAMED][SEED_TEXT] = {""}, more[48] = "";
    const uint32_t named = seeds->count < NAMED ? seeds->count : NAMED;
    for (uint32_t i = 0; i < named; ++i) {
        seed_describe(scene, seeds, i, text[i]);
    }
    if (seeds->count > NAMED) {
        snprintf(more, sizeof more, "; so do %u more", seeds->count - NAMED);
    }
    return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: no seed lies in free space: %s%s%s%s", scene->path, text[0],
                         named > 1 ? "; " : "", text[1], more);
}

static void seeds_warn(const lmb_scene *scene, const lmb_seed_list *seeds, const lmb_warnings *warnings)
{
    for (uint32_t i = 0; i < seeds->count; ++i) {
        if (seeds->state[i] != LMB_SEED_FREE) {
            char text[SEED_TEXT];
            seed_describe(scene, seeds, i, text);
            lmb_warn(warnings, "%s: %s: ignored", scene->path, text);
        }
    }
}

static lmb_result survey_fail(const lmb_survey *survey, float spacing, lmb_result result, lmb_error *error)
{
    const char *path = lmb_tracer_scene(survey->tracer)->path;
    if (result == LMB_ERROR_UNSUPPORTED) {
        return lmb_error_set(error, result,
                             "%s: spacing of %g m is too fine for the level's size, or so far from the world's origin",
                             path, (double)spacing);
    }
    if (result == LMB_ERROR_MEMORY) {
        return lmb_error_set(error, result, "out of memory for %d lattice points", survey->points.count);
    }
    return lmb_error_set(error, result, "placement: %s", lmb_result_text(result));
}

/* Looks at the whole box. Where it is all solid, its points count as free. */
static lmb_result survey_everything(lmb_survey *survey, bool *everything_solid)
{
    const lmb_result result = lmb_survey_fill(survey);
    *everything_solid = result == LMB_OK && !survey_any_free(survey);
    for (int32_t i = 0; *everything_solid && i < survey->points.count; ++i) {
        survey->free[i] = 1;
        survey->validity[i] = 1.0f;
    }
    return result;
}

/* Looks at what seeds reach. When they all lie in solids, the whole box says whether everything does. */
static lmb_result survey_from_seeds(lmb_survey *survey, const lmb_seed_list *seeds, bool *any, bool *everything_solid)
{
    lmb_result result = lmb_survey_flood(survey, seeds, any);
    if (result == LMB_OK && !*any && survey_box_points(survey) <= LMB_POINT_SET_MOST) {
        result = survey_everything(survey, everything_solid);
        if (result == LMB_OK && *everything_solid) {
            result = lmb_survey_flood(survey, seeds, any);
        }
    }
    const lmb_progress *progress = survey->progress;
    const bool reports = result == LMB_OK && progress && progress->report;
    return reports && !progress->report(progress->context, "place", 1.0) ? LMB_ERROR_INTERRUPTED : result;
}

/* Looks at the level at one spacing. `survey` has its tracer, pool and progress. */
static lmb_result survey_make(lmb_survey *survey, float spacing, const lmb_seed_list *seeds, lmb_placement_stats *stats,
                              lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(survey->tracer);
    survey->origin = scene->origin;
    stats->everything_solid = false;
    bool any = true;
    lmb_result result = lmb_placement_box(scene, spacing, &survey->box) ? LMB_OK : LMB_ERROR_UNSUPPORTED;
    if (result == LMB_OK) {
        result = seeds->count > 0 ? survey_from_seeds(survey, seeds, &any, &stats->everything_solid)
                                  : survey_everything(survey, &stats->everything_solid);
    }
    stats->rays += survey->rays;
    if (result != LMB_OK) {
        return survey_fail(survey, spacing, result, error);
    }
    if (!any) {
        return seeds_fail(scene, seeds, error);
    }
    stats->seeds_in_solid = false;
    for (uint32_t i = 0; i < seeds->count; ++i) {
        stats->seeds_in_solid |= seeds->state[i] != LMB_SEED_FREE;
    }
    return LMB_OK;
}

/* Probes at the wanted points, in the order that files have them; points lose theirs. */
static lmb_result probes_make(const lmb_survey *survey, lmb_point_set *wanted, lmb_probes **probes,
                              lmb_placement_stats *stats)
{
    lmb_point_set_sort(wanted);
    const lmb_lattice lattice = lmb_point_set_box(wanted, survey->box.spacing);
    lmb_probes *created = NULL;
    lmb_result result = lmb_probes_create(&created);
    if (result == LMB_OK) {
        result = lmb_probes_add_level(created, &lattice, (const int32_t(*)[3])wanted->point, wanted->count);
    }
    if (result != LMB_OK) {
        lmb_probes_destroy(created);
        return result;
    }
    for (int32_t i = 0; i < created->count; ++i) {
        const int32_t from = lmb_probe_index_find(&survey->points.index, created->point[i]);
        const bool baked = from >= 0 && survey->free[from] && survey->validity[from] >= LMB_PROBES_MIN_VALIDITY;
        created->validity[i] = baked ? survey->validity[from] : 0.0f;
        stats->probes_valid += baked;
        stats->probes_dilated += !baked;
    }
    created->origin = survey->origin;
    *probes = created;
    return LMB_OK;
}

static void seeds_free(lmb_seed_list *seeds)
{
    free(seeds->at);
    free(seeds->state);
}

/* False when out of memory. */
static bool seeds_gather(const lmb_scene *scene, const lmb_placement_settings *settings, lmb_seed_list *seeds)
{
    seeds->callers = settings->seed_count;
    seeds->count = settings->seed_count + scene->seed_point_count;
    seeds->at = malloc((seeds->count + 1u) * sizeof *seeds->at);
    seeds->state = calloc(seeds->count + 1u, sizeof *seeds->state);
    if (!seeds->at || !seeds->state) {
        seeds_free(seeds);
        return false;
    }
    for (uint32_t i = 0; i < settings->seed_count; ++i) {
        seeds->at[i] = lmb_scene_from_world(scene, settings->seeds[i]);
    }
    if (scene->seed_point_count > 0) {
        memcpy(seeds->at + settings->seed_count, scene->seed_points, scene->seed_point_count * sizeof *seeds->at);
    }
    return true;
}

/* Surveys the level, at a spacing that grows until there are few enough wanted points. */
static lmb_result survey_fit(lmb_survey *survey, lmb_point_set *wanted, const lmb_placement_settings *settings,
                             const lmb_seed_list *seeds, lmb_placement_stats *stats, lmb_error *error)
{
    const lmb_survey empty = *survey;
    float spacing =
        settings->spacing > 0.0f ? settings->spacing : lmb_placement_default_spacing(lmb_tracer_scene(survey->tracer));
    for (int step = 0;; ++step) {
        lmb_result result = survey_make(survey, spacing, seeds, stats, error);
        if (result != LMB_OK) {
            return result;
        }
        result = wanted_find(survey, false, wanted);
        if (result != LMB_OK) {
            return survey_fail(survey, spacing, result, error);
        }
        if (wanted->count == 0) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: all free space lies in boxes without probes",
                                 lmb_tracer_scene(survey->tracer)->path);
        }
        if (wanted->count <= settings->max_probes || step == MAX_SPACING_STEPS) {
            return LMB_OK;
        }
        /* Counts fall with the cube of the spacing; a third of the excess is a step that does not overshoot. */
        const double excess = (double)wanted->count / (double)settings->max_probes;
        spacing *= (float)fmin(1.0 + (excess - 1.0) / 3.0 + 0.01, 2.0);
        survey_free(survey);
        *survey = empty;
        lmb_point_set_free(wanted);
    }
}

static lmb_result probes_place(const lmb_survey *survey, lmb_point_set *wanted, lmb_probes **probes,
                               lmb_placement_stats *stats)
{
    lmb_probes *made = NULL;
    lmb_result result = probes_make(survey, wanted, &made, stats);
    if (result == LMB_OK) {
        result = lmb_placement_count_cells(made, 0, survey->tracer, &stats->cells, &stats->cells_crossed);
    }
    if (result != LMB_OK) {
        lmb_probes_destroy(made);
        return result;
    }
    *probes = made;
    return LMB_OK;
}

lmb_result lmb_placement_make(const lmb_tracer *tracer, const lmb_placement_settings *settings, lmb_pool *pool,
                              lmb_probes **probes, lmb_placement_stats *stats, lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    if (!(scene->bounds_min.x <= scene->bounds_max.x)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: the level has no static triangles", scene->path);
    }
    *stats = (lmb_placement_stats){0};
    lmb_survey survey = {.tracer = tracer, .pool = pool, .progress = settings->progress};
    lmb_point_set wanted = {0};
    lmb_seed_list seeds;
    if (!seeds_gather(scene, settings, &seeds)) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_result result = survey_fit(&survey, &wanted, settings, &seeds, stats, error);
    if (result == LMB_OK && settings->for_levels) {
        result = wanted_find(&survey, true, &wanted);
    }
    if (result == LMB_OK) {
        result = probes_place(&survey, &wanted, probes, stats);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "out of memory");
        } else {
            seeds_warn(scene, &seeds, &settings->warnings);
        }
    }
    survey_free(&survey);
    lmb_point_set_free(&wanted);
    seeds_free(&seeds);
    return result;
}
