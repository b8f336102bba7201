/* Which cells are of which level: an octree of cubes of 2 x 2 x 2 cells, from the coarsest level down. */
#include "probes/placement_trial.h"

#include <stdlib.h>
#include <string.h>

enum { LEVELS_MOST = 24 };

/* Tolerances are raised by this much at once. */
#define RAISE 1.04

typedef struct level_tree {
    const lmb_levels_settings *settings;
    lmb_level_rules rules;
    lmb_sites sites;
    uint32_t count;
    lmb_level_cubes level[LEVELS_MOST]; /* the finest first */
    double raised;                      /* all tolerances, by this factor */
    uint32_t levels_lost;               /* finest ones that boxes want and do not get */
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

/* Whether a cube gives way: a finer level has eight times as many probes in the same space, and takes away almost all
 * of the error. So many times as much it has to be. */
static bool cube_gives_way(const level_tree *tree, const lmb_level_cubes *cubes, int32_t cube)
{
    const double coarser = (double)(UINT64_C(1) << 3 * (tree->count - 1 - cubes->level));
    return (cubes->forced[cube] && cubes->level > tree->levels_lost) ||
           (cubes->tried[cube] && (double)cubes->error[cube] > coarser * tree->raised * tree->raised);
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

/* Probes of all levels down to this one, whose cubes are all whole yet. */
static lmb_result probes_count(const level_tree *tree, uint32_t level, int64_t *count)
{
    lmb_result result = LMB_OK;
    *count = 0;
    for (uint32_t at = level; at < tree->count && result == LMB_OK; ++at) {
        lmb_point_set corners = {0};
        result = lmb_cubes_corners(&tree->level[at], LMB_CUBES_WHOLE, &corners);
        *count += corners.count;
        lmb_point_set_free(&corners);
    }
    return result;
}

/* Takes back what gives way no more, and what came of it. @return whether there was any */
static bool levels_prune(level_tree *tree, uint32_t level)
{
    bool any = false;
    for (uint32_t at = tree->count - 1; at > level; --at) {
        lmb_level_cubes *const cubes = &tree->level[at], *const finer = &tree->level[at - 1];
        for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
            if (cubes->split[cube] && (!cubes->open[cube] || !cube_gives_way(tree, cubes, cube))) {
                cubes->split[cube] = false;
                any = true;
            }
        }
        for (int32_t cube = 0; cube < finer->cubes.count; ++cube) {
            int32_t parent[3];
            for (int axis = 0; axis < 3; ++axis) {
                parent[axis] = halved(finer->cubes.point[cube][axis]);
            }
            if (!cubes->split[lmb_probe_index_find(&cubes->cubes.index, parent)]) {
                finer->open[cube] = 0;
            }
        }
    }
    return any;
}

static bool any_tried_is_split(const level_tree *tree)
{
    for (uint32_t level = 1; level < tree->count; ++level) {
        const lmb_level_cubes *const cubes = &tree->level[level];
        for (int32_t cube = 0; cube < cubes->cubes.count; ++cube) {
            if (cubes->split[cube] && cubes->tried[cube]) {
                return true;
            }
        }
    }
    return false;
}

/* While there are too many probes, raises the tolerances, and when that saves none, leaves out the finest levels that
 * boxes want. */
static lmb_result levels_limit(level_tree *tree, uint32_t level)
{
    for (;;) {
        int64_t count;
        const lmb_result result = probes_count(tree, level, &count);
        if (result != LMB_OK || count <= tree->settings->max_probes) {
            return result;
        }
        for (bool any = false; !any;) {
            if (any_tried_is_split(tree)) {
                tree->raised *= RAISE;
            } else if (tree->levels_lost + 1 < tree->count) {
                ++tree->levels_lost;
            } else {
                return LMB_OK;
            }
            any = levels_prune(tree, level);
        }
    }
}

/* Begins one level, decides it, and adds the next one's cubes. */
static lmb_result level_divide(level_tree *tree, uint32_t level)
{
    lmb_level_cubes *const cubes = &tree->level[level];
    cubes->level = level;
    /* Corners and trial points take one half of a level's time, regions the other. */
    tree->sites.share = 0.5 / tree->count;
    tree->sites.done = 2.0 * tree->sites.share * (tree->count - 1 - level);
    lmb_result result = lmb_cubes_open(&tree->sites, cubes);
    if (result == LMB_OK) {
        result = levels_limit(tree, level);
    }
    if (result != LMB_OK || level == 0) {
        return result;
    }
    if (lmb_cubes_rule(&tree->sites, &tree->rules, cubes)) {
        result = lmb_cubes_try(&tree->sites, &tree->rules, tree->settings->dark, cubes);
    }
    for (int32_t cube = 0; cube < cubes->cubes.count && result == LMB_OK; ++cube) {
        cubes->split[cube] = cube_gives_way(tree, cubes, cube);
    }
    return result == LMB_OK ? children_add(cubes, &tree->level[level - 1]) : result;
}

static lmb_result level_make(const level_tree *tree, uint32_t level, lmb_probes *probes)
{
    lmb_point_set corners = {0};
    lmb_result result = lmb_cubes_corners(&tree->level[level], LMB_CUBES_WHOLE, &corners);
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
                       .rules = {lmb_tracer_scene(transport->tracer), settings->rule, settings->tolerance},
                       .raised = 1.0,
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
    stats->tolerance_scale = tree.raised;
    stats->levels_lost = tree.levels_lost;
    tree_free(&tree);
    if (result != LMB_OK) {
        lmb_probes_destroy(made);
        return lmb_error_set(error, result, "levels: %s", lmb_result_text(result));
    }
    lmb_probes_destroy(*probes);
    *probes = made;
    return LMB_OK;
}
