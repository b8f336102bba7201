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

static bool lattice_fit(lmb_lattice *lattice, const lmb_scene *scene, float spacing)
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
        lattice->min[axis] = (int32_t)first;
        lattice->size[axis] = (int32_t)(last - first) + 1;
        count *= lattice->size[axis];
        if (count > MAX_LATTICE_POINTS) {
            return false;
        }
    }
    lattice->spacing = spacing;
    lattice->origin = scene->origin;
    lattice->count = (size_t)count;
    return true;
}

static void lattice_free(lmb_lattice *lattice)
{
    free(lattice->validity);
    free(lattice->free);
    *lattice = (lmb_lattice){0};
}

/* Marks the corners of every cell that has a free corner. Returns how many there are. */
static int64_t wanted_mark(const lmb_lattice *lattice, uint8_t *wanted)
{
    memset(wanted, 0, lattice->count);
    int64_t count = 0;
    for (int32_t z = 0; z + 1 < lattice->size[2]; ++z) {
        for (int32_t y = 0; y + 1 < lattice->size[1]; ++y) {
            for (int32_t x = 0; x + 1 < lattice->size[0]; ++x) {
                bool any = false;
                for (int k = 0; k < 8; ++k) {
                    any |= lattice->free[lattice_index(lattice, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] != 0;
                }
                for (int k = 0; k < 8 && any; ++k) {
                    uint8_t *mark = &wanted[lattice_index(lattice, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))];
                    count += *mark == 0;
                    *mark = 1;
                }
            }
        }
    }
    return count;
}

static bool lattice_any_free(const lmb_lattice *lattice)
{
    return memchr(lattice->free, 1, lattice->count) != NULL;
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

/* Classifies the lattice at one spacing. */
static lmb_result lattice_make(lmb_lattice *lattice, const lmb_tracer *tracer, float spacing, const seed_list *seeds,
                               lmb_pool *pool, const lmb_progress *progress, lmb_placement_stats *stats,
                               lmb_error *error)
{
    if (!lattice_fit(lattice, lmb_tracer_scene(tracer), spacing)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                             "%s: spacing of %g m is too fine for the level's size, or so far from the world's origin",
                             lmb_tracer_scene(tracer)->path, (double)spacing);
    }
    lattice->validity = calloc(lattice->count, sizeof *lattice->validity);
    lattice->free = calloc(lattice->count, sizeof *lattice->free);
    if (!lattice->validity || !lattice->free) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for %zu lattice points", lattice->count);
    }
    lmb_result result = lmb_lattice_classify(lattice, tracer, pool, progress, &stats->rays);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "placement: %s", lmb_result_text(result));
    }
    stats->everything_solid = !lattice_any_free(lattice);
    if (stats->everything_solid) {
        for (size_t i = 0; i < lattice->count; ++i) {
            lattice->free[i] = 1;
            lattice->validity[i] = 1.0f;
        }
    }
    if (seeds->count > 0) {
        result = lmb_lattice_flood(lattice, tracer, seeds->at, seeds->count, seeds->state, &stats->rays);
        if (result != LMB_OK) {
            return lmb_error_set(error, result, "out of memory");
        }
        if (!lattice_any_free(lattice)) {
            return seeds_fail(lmb_tracer_scene(tracer), seeds, error);
        }
        stats->seeds_in_solid = false;
        for (uint32_t i = 0; i < seeds->count; ++i) {
            stats->seeds_in_solid |= seeds->state[i] != LMB_SEED_FREE;
        }
    }
    return LMB_OK;
}

/* The grid of the wanted points, its box trimmed to them. */
static lmb_result grid_from_lattice(const lmb_lattice *lattice, const uint8_t *wanted, lmb_grid **grid,
                                    lmb_placement_stats *stats)
{
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX};
    int32_t high[3] = {-1, -1, -1};
    for (int32_t z = 0; z < lattice->size[2]; ++z) {
        for (int32_t y = 0; y < lattice->size[1]; ++y) {
            for (int32_t x = 0; x < lattice->size[0]; ++x) {
                if (wanted[lattice_index(lattice, x, y, z)]) {
                    const int32_t at[3] = {x, y, z};
                    for (int axis = 0; axis < 3; ++axis) {
                        low[axis] = at[axis] < low[axis] ? at[axis] : low[axis];
                        high[axis] = at[axis] > high[axis] ? at[axis] : high[axis];
                    }
                }
            }
        }
    }
    int32_t min[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
        min[axis] = lattice->min[axis] + low[axis];
        size[axis] = high[axis] - low[axis] + 1;
    }
    lmb_grid *created;
    lmb_result result = lmb_grid_create(lattice->spacing, min, size, &created);
    if (result != LMB_OK) {
        return result;
    }
    uint8_t *trimmed = malloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2]);
    result = trimmed ? LMB_OK : LMB_ERROR_MEMORY;
    size_t at = 0;
    for (int32_t z = low[2]; trimmed && z <= high[2]; ++z) {
        for (int32_t y = low[1]; y <= high[1]; ++y) {
            memcpy(trimmed + at, wanted + lattice_index(lattice, low[0], y, z), (size_t)size[0]);
            at += (size_t)size[0];
        }
    }
    if (trimmed) {
        result = lmb_grid_add_probes(created, trimmed);
        free(trimmed);
    }
    if (result != LMB_OK) {
        lmb_grid_destroy(created);
        return result;
    }
    for (int32_t i = 0; i < created->probe_count; ++i) {
        const int32_t *p = created->lattice[i];
        const size_t from =
            lattice_index(lattice, p[0] - lattice->min[0], p[1] - lattice->min[1], p[2] - lattice->min[2]);
        const bool baked = lattice->free[from] && lattice->validity[from] >= LMB_GRID_MIN_VALIDITY;
        created->validity[i] = baked ? lattice->validity[from] : 0.0f;
        stats->probes_valid += baked;
        stats->probes_dilated += !baked;
    }
    created->origin = lattice->origin;
    *grid = created;
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
                              const lmb_progress *progress, lmb_grid **grid, lmb_placement_stats *stats,
                              lmb_error *error)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    if (!(scene->bounds_min.x <= scene->bounds_max.x)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: the level has no static triangles", scene->path);
    }
    *stats = (lmb_placement_stats){0};
    lmb_lattice lattice = {0};
    uint8_t *wanted = NULL;
    seed_list seeds;
    if (!seeds_gather(scene, settings, &seeds)) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_result result = LMB_OK;
    float spacing = settings->spacing > 0.0f ? settings->spacing : lmb_placement_default_spacing(scene);
    for (int step = 0; result == LMB_OK; ++step) {
        result = lattice_make(&lattice, tracer, spacing, &seeds, pool, progress, stats, error);
        wanted = result == LMB_OK ? malloc(lattice.count) : NULL;
        if (result == LMB_OK && !wanted) {
            result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
        }
        const int64_t count = wanted ? wanted_mark(&lattice, wanted) : 0;
        if (result != LMB_OK || count <= settings->max_probes || step == MAX_SPACING_STEPS) {
            break;
        }
        /* Counts fall with the cube of the spacing; a third of the excess is a step that does not overshoot. */
        const double excess = (double)count / (double)settings->max_probes;
        spacing *= (float)fmin(1.0 + (excess - 1.0) / 3.0 + 0.01, 2.0);
        lattice_free(&lattice);
        free(wanted);
        wanted = NULL;
    }
    if (result == LMB_OK) {
        result = grid_from_lattice(&lattice, wanted, grid, stats);
        if (result == LMB_OK) {
            result = lmb_grid_count_cells(*grid, tracer, &stats->cells, &stats->cells_crossed);
            if (result != LMB_OK) {
                lmb_grid_destroy(*grid);
                *grid = NULL;
            }
        }
        if (result != LMB_OK) {
            lmb_error_set(error, result, "out of memory");
        } else {
            seeds_warn(scene, &seeds, &settings->warnings);
        }
    }
    lattice_free(&lattice);
    free(wanted);
    seeds_free(&seeds);
    return result;
}
