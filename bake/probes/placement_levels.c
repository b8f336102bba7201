/* Which cells are of which level: an octree of cubes of 2 x 2 x 2 cells, from the coarsest level down. */
#include "probes/placement_trial.h"

#include <stdlib.h>
#include <string.h>

/* Points that a cube adds at most when it gives way to 4 x 4 x 4 cells. */
enum { CUBE_POINTS = 125, LEVELS_MOST = 24 };

typedef struct level_tree {
    const lmb_levels_settings *settings;
    lmb_sites sites;
    uint32_t count;
    lmb_level_cubes level[LEVELS_MOST]; /* the finest first */
    int64_t kept;                       /* probes of levels that are decided */
} level_tree;

static int32_t halved(int64_t value)
{
    return (int32_t)((value - (value & 1)) / 2);
}

/* Along one axis, the cubes of a coarser level whose cells touch a point of the even one. */
static void cube_range(int32_t point, uint32_t coarser, int32_t range[2])
{
    const int64_t step = INT64_C(1) << coarser;
    const int64_t rest = (int64_t)((uint64_t)point & (uint64_t)(step - 1));
    const int64_t cell = (point - rest) / step;
    range[1] = halved(cell);
    range[0] = rest == 0 ? halved(cell - 1) : range[1];
}

/* The cubes of the coarsest level around all free points, in the order that files have points. */
static lmb_result coarsest_add(level_tree *tree)
{
    const lmb_probes *even = tree->sites.even;
    lmb_point_set found = {0};
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < even->count && result == LMB_OK; ++i) {
        int32_t range[3][2];
        for (int axis = 0; axis < 3; ++axis) {
            cube_range(even->point[i][axis], tree->settings->coarser, range[axis]);
        }
        for (int side = 0; side < 8 && result == LMB_OK && even->validity[i] >= LMB_PROBES_MIN_VALIDITY; ++side) {
            const int32_t cube[3] = {range[0][side & 1], range[1][side >> 1 & 1], range[2][side >> 2]};
            result = lmb_point_set_add(&found, cube);
        }
    }
    lmb_point_set_sort(&found);
    for (int32_t i = 0; i < found.count && result == LMB_OK; ++i) {
        result = lmb_point_set_add(&tree->level[tree->count - 1].cubes, found.point[i]);
    }
    lmb_point_set_free(&found);
    return result;
}

typedef struct cube_rank {
    float error;
    int32_t cube;
} cube_rank;

/* The worst first; the order of the cubes where they are alike. */
static int ranks_compare(const void *a, const void *b)
{
    const cube_rank *const p = a, *const q = b;
    return p->error != q->error ? (p->error < q->error ? 1 : -1) : p->cube < q->cube ? -1 : p->cube > q->cube;
}

/* Marks the cubes that give way. */
static lmb_result cubes_choose(level_tree *tree, lmb_level_cubes *cubes)
{
    /* A finer level has eight times as many probes in the same space, and takes away almost all of the error: so many
     * times as much it has to be. */
    const double coarser = (double)(UINT64_C(1) << 3 * (tree->count - 1 - cubes->level));
    const float most = (float)(coarser * tree->settings->tolerance * tree->settings->tolerance);
    cube_rank *const rank = malloc(((size_t)cubes->cubes.count + 1) * sizeof *rank);
    if (!rank) {
        return LMB_ERROR_MEMORY;
    }
    int32_t count = 0;
    for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
        if (cubes->error[cube] > most) {
            rank[count++] = (cube_rank){cubes->error[cube], cube};
        }
    }
    if (count > 0) {
        qsort(rank, (size_t)count, sizeof *rank, ranks_compare);
    }
    const int64_t room = (tree->settings->max_probes - tree->kept - cubes->corner_count) / CUBE_POINTS;
    for (int32_t i = 0; i < count && i < room; ++i) {
        cubes->split[rank[i].cube] = true;
    }
    free(rank);
    return LMB_OK;
}

/* The eight cubes that each split one gives way to. */
static lmb_result children_add(const lmb_level_cubes *cubes, lmb_level_cubes *finer)
{
    lmb_result result = LMB_OK;
    for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
        for (int i = 0; i < 8 && result == LMB_OK && cubes->split[cube]; ++i) {
            int32_t child[3];
            lmb_cube_cell(cubes->cubes.point[cube], i, child);
            result = lmb_point_set_add(&finer->cubes, child);
        }
    }
    return result;
}

/* Decides one level and begins the next. */
static lmb_result level_divide(level_tree *tree, uint32_t level)
{
    lmb_level_cubes *const cubes = &tree->level[level];
    cubes->level = level;
    /* Corners and trial points take one half of a level's time, regions the other. */
    tree->sites.share = 0.5 / tree->count;
    tree->sites.done = 2.0 * tree->sites.share * (tree->count - 1 - level);
    lmb_result result = lmb_cubes_open(&tree->sites, cubes);
    if (result != LMB_OK || level == 0) {
        return result;
    }
    result = lmb_cubes_try(&tree->sites, tree->settings->dark, cubes);
    if (result == LMB_OK) {
        result = cubes_choose(tree, cubes);
    }
    if (result == LMB_OK) {
        result = children_add(cubes, &tree->level[level - 1]);
    }
    lmb_point_set corners = {0};
    if (result == LMB_OK) {
        result = lmb_cubes_corners(cubes, false, &corners);
    }
    tree->kept += corners.count;
    lmb_point_set_free(&corners);
    return result;
}

static lmb_result level_make(const level_tree *tree, uint32_t level, lmb_probes *probes)
{
    lmb_point_set corners = {0};
    lmb_result result = lmb_cubes_corners(&tree->level[level], false, &corners);
    if (result == LMB_OK) {
        lmb_point_set_sort(&corners);
        const lmb_lattice lattice = lmb_point_set_box(&corners, lmb_sites_spacing(&tree->sites, level));
        /* Levels without probes are left out at the finest end; within, the next one has twice the spacing. */
        if (corners.count > 0 || probes->level_count > 0) {
            result = lmb_probes_add_level(probes, &lattice, (const int32_t(*)[3])corners.point, corners.count);
        }
    }
    if (result == LMB_OK && corners.count > 0) {
        const int32_t first = probes->count - corners.count;
        for (int32_t i = first; i < probes->count; ++i) {
            probes->validity[i] = lmb_sites_find(&tree->sites, level, probes->point[i])->validity;
        }
    }
    lmb_point_set_free(&corners);
    return result;
}

/* The coarsest level that has cells. */
static uint32_t last_level(const level_tree *tree)
{
    uint32_t last = tree->count - 1;
    for (bool has = false; last > 0 && !has; last -= !has) {
        const lmb_level_cubes *const cubes = &tree->level[last];
        for (int32_t cube = 0; cube < cubes->cubes.count && !has; ++cube) {
            has = cubes->open[cube] != 0 && !cubes->split[cube];
        }
    }
    return last;
}

static lmb_result levels_make(const level_tree *tree, lmb_probes **probes)
{
    lmb_probes *made = NULL;
    lmb_result result = lmb_probes_create(&made);
    const uint32_t last = last_level(tree);
    for (uint32_t level = 0; level <= last && result == LMB_OK; ++level) {
        result = level_make(tree, level, made);
    }
    if (result != LMB_OK) {
        lmb_probes_destroy(made);
        return result;
    }
    made->origin = tree->sites.even->origin;
    *probes = made;
    return LMB_OK;
}

static lmb_result cells_count(const lmb_probes *probes, const lmb_tracer *tracer, lmb_placement_stats *stats)
{
    stats->cells = stats->cells_crossed = 0;
    lmb_result result = LMB_OK;
    for (uint32_t level = 0; level < probes->level_count && result == LMB_OK; ++level) {
        int64_t cells, crossed;
        result = lmb_placement_count_cells(probes, level, tracer, &cells, &crossed);
        if (result == LMB_OK) {
            stats->cells += cells;
            stats->cells_crossed += crossed;
        }
    }
    return result;
}

static lmb_result tree_grow(level_tree *tree)
{
    lmb_result result = lmb_sites_open(&tree->sites);
    if (result == LMB_OK) {
        result = coarsest_add(tree);
    }
    for (uint32_t level = tree->count; level-- > 0 && result == LMB_OK;) {
        result = level_divide(tree, level);
    }
    return result;
}

static void tree_free(level_tree *tree)
{
    lmb_sites_close(&tree->sites);
    for (uint32_t level = 0; level < tree->count; ++level) {
        lmb_level_cubes_free(&tree->level[level]);
    }
}

lmb_result lmb_placement_levels(const lmb_transport *transport, const lmb_levels_settings *settings, lmb_pool *pool,
                                lmb_probes **probes, lmb_placement_stats *stats, lmb_error *error)
{
    if (settings->coarser + settings->finer >= LEVELS_MOST) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "levels: the finest spacing is too fine");
    }
    level_tree tree = {.settings = settings,
                       .sites = {.transport = transport,
                                 .pool = pool,
                                 .even = *probes,
                                 .even_level = settings->finer,
                                 .has_seeds = settings->has_seeds,
                                 .everything_is_free = stats->everything_solid,
                                 .effort = settings->effort,
                                 .progress = settings->progress},
                       .count = settings->coarser + settings->finer + 1};
    lmb_probes *made = NULL;
    lmb_result result = tree_grow(&tree);
    if (result == LMB_OK) {
        result = levels_make(&tree, &made);
    }
    if (result == LMB_OK) {
        result = cells_count(made, transport->tracer, stats);
    }
    if (result == LMB_OK) {
        result = lmb_placement_hang(transport->tracer, pool, made, stats);
    }
    stats->rays += tree.sites.rays;
    tree_free(&tree);
    if (result != LMB_OK) {
        lmb_probes_destroy(made);
        return lmb_error_set(error, result, "levels: %s", lmb_result_text(result));
    }
    lmb_probes_destroy(*probes);
    *probes = made;
    return LMB_OK;
}
