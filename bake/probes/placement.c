#include "probes/placement_internal.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEFAULT_POINTS 32768.0
#define MAX_LATTICE_POINTS ((int64_t)1 << 28)
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

static bool lattice_fit(lmb_survey *survey, const lmb_scene *scene, float spacing)
{
    const float low[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float high[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    const double origin[3] = {scene->origin.x, scene->origin.y, scene->origin.z};
    int64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double first = floor(((double)low[axis] + origin[axis]) / (double)spacing);
        const double last = fmax(ceil(((double)high[axis] + origin[axis]) / (double)spacing), first + 1.0);
        if (!(fabs(first) < 1e9) || !(fabs(last) < 1e9)) {
            return false;
        }
        survey->min[axis] = (int32_t)first;
        survey->size[axis] = (int32_t)(last - first) + 1;
        count *= survey->size[axis];
        if (count > MAX_LATTICE_POINTS) {
            return false;
        }
    }
    survey->spacing = spacing;
    survey->origin = scene->origin;
    survey->count = (size_t)count;
    return true;
}

static void survey_free(lmb_survey *survey)
{
    free(survey->validity);
    free(survey->free);
    *survey = (lmb_survey){0};
}

/* Marks the corners of every cell that has a free corner. Returns how many there are. */
static int64_t wanted_mark(const lmb_survey *survey, uint8_t *wanted)
{
    memset(wanted, 0, survey->count);
    int64_t count = 0;
    for (int32_t z = 0; z + 1 < survey->size[2]; ++z) {
        for (int32_t y = 0; y + 1 < survey->size[1]; ++y) {
            for (int32_t x = 0; x + 1 < survey->size[0]; ++x) {
                bool any = false;
                for (int k = 0; k < 8; ++k) {
                    any |= survey->free[survey_index(survey, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] != 0;
                }
                for (int k = 0; k < 8 && any; ++k) {
                    uint8_t *mark = &wanted[survey_index(survey, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))];
                    count += *mark == 0;
                    *mark = 1;
                }
            }
        }
    }
    return count;
}

static bool survey_any_free(const lmb_survey *survey)
{
    return memchr(survey->free, 1, survey->count) != NULL;
}

/* All seeds: the caller's, then the scene's own. */
typedef struct seed_list {
    uint32_t count;
    uint32_t callers;
    lmb_vec3 *at;
    lmb_seed_state *state;
} seed_list;

enum { SEED_TEXT = 160 };

/* Which seed, and why it is none. */
static void seed_describe(const lmb_scene *scene, const seed_list *seeds, uint32_t i, char text[SEED_TEXT])
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
static lmb_result seeds_fail(const lmb_scene *scene, const seed_list *seeds, lmb_error *error)
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

static void seeds_warn(const lmb_scene *scene, const seed_list *seeds, const lmb_warnings *warnings)
{
    for (uint32_t i = 0; i < seeds->count; ++i) {
        if (seeds->state[i] != LMB_SEED_FREE) {
            char text[SEED_TEXT];
            seed_describe(scene, seeds, i, text);
            lmb_warn(warnings, "%s: %s: ignored", scene->path, text);
        }
    }
}

/* Classifies the survey at one spacing. */
static lmb_result survey_make(lmb_survey *survey, const lmb_tracer *tracer, float spacing, const seed_list *seeds,
                              lmb_pool *pool, const lmb_progress *progress, lmb_placement_stats *stats,
                              lmb_error *error)
{
    if (!lattice_fit(survey, lmb_tracer_scene(tracer), spacing)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                             "%s: spacing of %g m is too fine for the level's size, or so far from the world's origin",
                             lmb_tracer_scene(tracer)->path, (double)spacing);
    }
    survey->validity = calloc(survey->count, sizeof *survey->validity);
    survey->free = calloc(survey->count, sizeof *survey->free);
    if (!survey->validity || !survey->free) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for %zu lattice points", survey->count);
    }
    lmb_result result = lmb_survey_classify(survey, tracer, pool, progress, &stats->rays);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "placement: %s", lmb_result_text(result));
    }
    stats->everything_solid = !survey_any_free(survey);
    if (stats->everything_solid) {
        for (size_t i = 0; i < survey->count; ++i) {
            survey->free[i] = 1;
            survey->validity[i] = 1.0f;
        }
    }
    if (seeds->count > 0) {
        result = lmb_survey_flood(survey, tracer, seeds->at, seeds->count, seeds->state, &stats->rays);
        if (result != LMB_OK) {
            return lmb_error_set(error, result, "out of memory");
        }
        if (!survey_any_free(survey)) {
            return seeds_fail(lmb_tracer_scene(tracer), seeds, error);
        }
        stats->seeds_in_solid = false;
        for (uint32_t i = 0; i < seeds->count; ++i) {
            stats->seeds_in_solid |= seeds->state[i] != LMB_SEED_FREE;
        }
    }
    return LMB_OK;
}

/* The box of the wanted points, and their list, x fastest; NULL: no memory. */
static int32_t (*wanted_list(const lmb_survey *survey, const uint8_t *wanted, int64_t count, lmb_lattice *lattice))[3]
{
    int32_t(*const point)[3] = malloc(((size_t)count + 1) * sizeof *point);
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};
    size_t found = 0;
    for (size_t i = 0; point && i < survey->count; ++i) {
        if (!wanted[i]) {
            continue;
        }
        const size_t width = (size_t)survey->size[0], height = (size_t)survey->size[1];
        const int32_t at[3] = {(int32_t)(i % width), (int32_t)(i / width % height), (int32_t)(i / width / height)};
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = at[axis] < low[axis] ? at[axis] : low[axis];
            high[axis] = at[axis] > high[axis] ? at[axis] : high[axis];
            point[found][axis] = survey->min[axis] + at[axis];
        }
        ++found;
    }
    lattice->spacing = survey->spacing;
    for (int axis = 0; axis < 3; ++axis) {
        lattice->min[axis] = survey->min[axis] + low[axis];
        lattice->size[axis] = high[axis] - low[axis] + 1;
    }
    return point;
}

/* Probes at the wanted points. */
static lmb_result probes_make(const lmb_survey *survey, const uint8_t *wanted, int64_t count, lmb_probes **probes,
                              lmb_placement_stats *stats)
{
    lmb_lattice lattice;
    lmb_probes *created = NULL;
    int32_t(*const point)[3] = wanted_list(survey, wanted, count, &lattice);
    lmb_result result = point ? lmb_probes_create(&created) : LMB_ERROR_MEMORY;
    if (result == LMB_OK) {
        result = lmb_probes_add_level(created, &lattice, (const int32_t(*)[3])point, (int32_t)count);
    }
    free(point);
    if (result != LMB_OK) {
        lmb_probes_destroy(created);
        return result;
    }
    for (int32_t i = 0; i < created->count; ++i) {
        const int32_t *p = created->point[i];
        const size_t from = survey_index(survey, p[0] - survey->min[0], p[1] - survey->min[1], p[2] - survey->min[2]);
        const bool baked = survey->free[from] && survey->validity[from] >= LMB_PROBES_MIN_VALIDITY;
        created->validity[i] = baked ? survey->validity[from] : 0.0f;
        stats->probes_valid += baked;
        stats->probes_dilated += !baked;
    }
    created->origin = survey->origin;
    *probes = created;
    return LMB_OK;
}

static void seeds_free(seed_list *seeds)
{
    free(seeds->at);
    free(seeds->state);
}

/* False when out of memory. */
static bool seeds_gather(const lmb_scene *scene, const lmb_placement_settings *settings, seed_list *seeds)
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

lmb_result lmb_placement_make(const lmb_tracer *tracer, const lmb_placement_settings *settings, lmb_pool *pool,
                              const lmb_progress *progress, lmb_probes **probes, lmb_placement_stats *stats,
                              lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    if (!(scene->bounds_min.x <= scene->bounds_max.x)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: the level has no static triangles", scene->path);
    }
    *stats = (lmb_placement_stats){0};
    lmb_survey survey = {0};
    uint8_t *wanted = NULL;
    seed_list seeds;
    if (!seeds_gather(scene, settings, &seeds)) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_result result = LMB_OK;
    int64_t count = 0;
    float spacing = settings->spacing > 0.0f ? settings->spacing : lmb_placement_default_spacing(scene);
    for (int step = 0; result == LMB_OK; ++step) {
        result = survey_make(&survey, tracer, spacing, &seeds, pool, progress, stats, error);
        wanted = result == LMB_OK ? malloc(survey.count) : NULL;
        if (result == LMB_OK && !wanted) {
            result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
        }
        count = wanted ? wanted_mark(&survey, wanted) : 0;
        if (result != LMB_OK || count <= settings->max_probes || step == MAX_SPACING_STEPS) {
            break;
        }
        /* Counts fall with the cube of the spacing; a third of the excess is a step that does not overshoot. */
        const double excess = (double)count / (double)settings->max_probes;
        spacing *= (float)fmin(1.0 + (excess - 1.0) / 3.0 + 0.01, 2.0);
        survey_free(&survey);
        free(wanted);
        wanted = NULL;
    }
    if (result == LMB_OK) {
        result = probes_make(&survey, wanted, count, probes, stats);
        if (result == LMB_OK) {
            result = lmb_placement_count_cells(*probes, 0, tracer, &stats->cells, &stats->cells_crossed);
            if (result != LMB_OK) {
                lmb_probes_destroy(*probes);
                *probes = NULL;
            }
        }
        if (result != LMB_OK) {
            lmb_error_set(error, result, "out of memory");
        } else {
            seeds_warn(scene, &seeds, &settings->warnings);
        }
    }
    survey_free(&survey);
    free(wanted);
    seeds_free(&seeds);
    return result;
}
