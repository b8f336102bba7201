/* How few probes levels could do with: the octree that an oracle would choose, beside even lattices.
 *
 *     lambent_levels_bound LEVEL --spacing M --min-spacing M [bake options] [--points N] [--truth N] [--cells N]
 *                          [--absolute]
 *
 * bakes an even lattice of each spacing between the two, in memory, and knows the error of each at random places of
 * free space. The octree minimises the sum of squared relative errors (none counted as more than 1; with --absolute all
 * are relative to the RMS of all places' light) and a price times probes, bottom up (Breiman et al. 1984, pruning by
 * cost and complexity); half of the places choose it, the other half say what it reaches. Nodes are cubes of --cells
 * (2, as files have them, or 1) cells along each axis. Probes are counted as the corners of all regions of all cells of
 * all leaves; what a probe costs a node is shared with the other leaves that have it, which some rounds settle. One
 * line for each, tabs between:
 *
 *     "even" and its spacing; probes; RMS, by the half that chooses and by the other
 *     "oracle" and its price; probes; of these not on coarser leaves; RMS likewise; how many times as many probes an
 *     even lattice of the latter RMS has
 *     "baked": the same tree, baked as levels, hanging probes and all: probes; baked ones; RMS likewise; how many times
 *
 * Where "oracle" and "baked" are apart, continuity between levels is what costs; where "baked" and lambent_levels are
 * apart, it is the choice. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake_arguments.h"
#include "levels_places.h"

static const char usage[] =
    "usage: lambent_levels_bound LEVEL --spacing M --min-spacing M [options]\n"
    "\n"
    "  --points N            places in free space (default 20000)\n"
    "  --truth N             samples at each (default 512)\n"
    "  --cells N             of a node of the octree along each axis, 1 or 2 (default 2)\n"
    "  --absolute            errors relative to the RMS light of all places, not to each one's own\n" BAKE_USAGE
        LEVEL_USAGE;

enum { MOST_LEVELS = 12, ROUNDS = 4, PRICES = 10, HALVES = 2 };

/* A node of a level: `cells` along each axis. */
typedef struct bound_node {
    int32_t point[3];
    double cost, error; /* probes; of the places that choose */
    double best;        /* with what is below */
    int32_t child[8];   /* or -1 */
    bool has_cells, split, leaf;
} bound_node;

typedef struct bound_level {
    lmb_bake bake; /* an even lattice */
    int32_t cell_count;
    int32_t (*cell)[3];
    int32_t *cell_cut; /* [cell] or -1 */
    int32_t *cell_node;
    int32_t *refs; /* [probe] leaves' cells that have it; of all cells at first */
    lmb_probe_index index;
    int32_t node_count, node_room;
    bound_node *node;
    float *share; /* [place] */
    double error[HALVES];
} bound_level;

typedef struct bound {
    level_places places;
    int32_t cells;
    bool absolute; /* errors are relative to the RMS of all places' light, not to the place's own */
    double mean_squared_light;
    int count;
    bound_level level[MOST_LEVELS]; /* the coarsest first */
} bound;

static int32_t floor_divided(int32_t value, int32_t by)
{
    const int32_t rest = ((value % by) + by) % by;
    return (value - rest) / by;
}

/* ------------------------------------------------------------------------------------------------- nodes */

static int32_t node_add(bound_level *level, const int32_t point[3])
{
    const int32_t found = lmb_probe_index_find(&level->index, point);
    if (found >= 0) {
        return found;
    }
    if (level->node_count == level->node_room) {
        level->node_room = 2 * level->node_room + 64;
        bound_node *const grown = realloc(level->node, (size_t)level->node_room * sizeof *grown);
        if (!grown) {
            return -1;
        }
        level->node = grown;
    }
    level->node[level->node_count] =
        (bound_node){.point = {point[0], point[1], point[2]}, .child = {-1, -1, -1, -1, -1, -1, -1, -1}};
    return lmb_probe_index_add(&level->index, point, level->node_count) == LMB_OK ? level->node_count++ : -1;
}

/* With all nodes above. @return -1: no memory */
static int32_t node_add_all(bound *work, int at, const int32_t point[3])
{
    const int32_t node = node_add(&work->level[at], point);
    if (at > 0 && node >= 0) {
        int32_t above[3];
        int octant = 0;
        for (int axis = 0; axis < 3; ++axis) {
            above[axis] = floor_divided(point[axis], 2);
            octant |= (point[axis] - 2 * above[axis]) << axis;
        }
        const int32_t parent = node_add_all(work, at - 1, above);
        if (parent < 0) {
            return -1;
        }
        work->level[at - 1].node[parent].child[octant] = node;
    }
    return node;
}

static int32_t place_node(const bound *work, int at, const place *of)
{
    const lmb_vec3d world = lmb_scene_to_world(work->places.level->scene, of->position);
    const double size = (double)work->level[at].bake.probes->level[0].lattice.spacing * work->cells;
    const int32_t point[3] = {(int32_t)floor(world.x / size), (int32_t)floor(world.y / size),
                              (int32_t)floor(world.z / size)};
    return lmb_probe_index_find(&work->level[at].index, point);
}

/* ------------------------------------------------------------------------------------------------- cells */

static void cell_add(bound_level *level, const int32_t cell[3], int32_t cut)
{
    memcpy(level->cell[level->cell_count], cell, sizeof level->cell[0]);
    level->cell_cut[level->cell_count++] = cut;
}

static bool cells_list(bound_level *level)
{
    const lmb_probes *const probes = level->bake.probes;
    const size_t most = (size_t)probes->count + probes->cut.count + 1;
    level->cell = malloc(most * sizeof *level->cell);
    level->cell_cut = malloc(most * sizeof *level->cell_cut);
    level->cell_node = malloc(most * sizeof *level->cell_node);
    level->refs = calloc(most, sizeof *level->refs);
    if (!level->cell || !level->cell_cut || !level->cell_node || !level->refs) {
        return false;
    }
    for (uint32_t i = 0; i < probes->cut.count; ++i) {
        cell_add(level, probes->cut.cell[i].point, (int32_t)i);
    }
    for (int32_t i = 0; i < probes->level[0].count; ++i) {
        const int32_t *const point = probes->point[i];
        if (lmb_probe_index_find(&probes->level[0].cut, point) < 0 && lmb_probes_cell_is_leaf(probes, 0, point)) {
            cell_add(level, point, -1);
        }
    }
    return true;
}

/* Calls `use` for each corner of each region of a cell. */
typedef void (*probe_use)(void *context, int32_t probe);
static void cell_probes(const bound_level *level, int32_t cell, probe_use use, void *context)
{
    const lmb_probes *const probes = level->bake.probes;
    const int32_t cut = level->cell_cut[cell];
    if (cut < 0) {
        const int32_t *const at = level->cell[cell];
        for (int i = 0; i < 8; ++i) {
            use(context, lmb_probes_find(probes, 0, at[0] + (i & 1), at[1] + (i >> 1 & 1), at[2] + (i >> 2)));
        }
        return;
    }
    const lmb_cut_cell *const one = &probes->cut.cell[cut];
    for (uint32_t region = 0; region < one->region_count; ++region) {
        for (int i = 0; i < 8; ++i) {
            use(context, probes->cut.corner[one->region_first + region][i]);
        }
    }
}

static void refs_add(void *context, int32_t probe)
{
    int32_t *const refs = context;
    ++refs[probe];
}

typedef struct cost_sum {
    const int32_t *refs;
    bool counted; /* the cell is among those that have references */
    double sum;
} cost_sum;

static void cost_add(void *context, int32_t probe)
{
    cost_sum *const cost = context;
    cost->sum += 1.0 / (cost->refs[probe] + !cost->counted);
}

static void refs_count(bound_level *level, bool leaves)
{
    memset(level->refs, 0, (size_t)level->bake.probes->count * sizeof *level->refs);
    for (int32_t i = 0; i < level->cell_count; ++i) {
        if (!leaves || level->node[level->cell_node[i]].leaf) {
            cell_probes(level, i, refs_add, level->refs);
        }
    }
}

/* What nodes cost when the leaves at hand, or all cells, share probes with them. */
static void costs_set(bound_level *level, bool leaves)
{
    for (int32_t i = 0; i < level->node_count; ++i) {
        level->node[i].cost = 0.0;
    }
    for (int32_t i = 0; i < level->cell_count; ++i) {
        bound_node *const node = &level->node[level->cell_node[i]];
        cost_sum cost = {.refs = level->refs, .counted = !leaves || node->leaf};
        cell_probes(level, i, cost_add, &cost);
        node->cost += cost.sum;
    }
}

/* -------------------------------------------------------------------------------------------------- trees */

static void tree_choose(bound *work, double price)
{
    for (int at = work->count; at-- > 0;) {
        bound_level *const level = &work->level[at];
        for (int32_t i = 0; i < level->node_count; ++i) {
            bound_node *const node = &level->node[i];
            double below = 0.0;
            bool has_child = false;
            for (int child = 0; child < 8; ++child) {
                if (node->child[child] >= 0) {
                    below += work->level[at + 1].node[node->child[child]].best;
                    has_child = true;
                }
            }
            const double own = node->error + price * node->cost;
            node->split = has_child && (!node->has_cells || below < own);
            node->best = node->split ? below : own;
            node->leaf = at == 0 && !node->split;
        }
    }
    for (int at = 1; at < work->count; ++at) {
        const bound_level *const above = &work->level[at - 1];
        bool *const reached = calloc((size_t)work->level[at].node_count + 1, sizeof *reached);
        for (int32_t i = 0; i < above->node_count && reached; ++i) {
            for (int child = 0; child < 8 && above->node[i].split; ++child) {
                if (above->node[i].child[child] >= 0) {
                    reached[above->node[i].child[child]] = true;
                }
            }
        }
        for (int32_t i = 0; i < work->level[at].node_count && reached; ++i) {
            bound_node *const node = &work->level[at].node[i];
            node->leaf = reached[i] && !node->split;
            node->split = reached[i] && node->split;
        }
        free(reached);
    }
}

/* Whether a point of a level touches a leaf of a coarser one. */
static bool point_touches_coarser(const bound *work, int at, const int32_t point[3])
{
    for (int side = 0; side < 8; ++side) {
        int32_t cell[3];
        for (int axis = 0; axis < 3; ++axis) {
            cell[axis] = point[axis] - (side >> axis & 1);
        }
        for (int above = at - 1; above >= 0; --above) {
            int32_t node[3];
            for (int axis = 0; axis < 3; ++axis) {
                cell[axis] = floor_divided(cell[axis], 2);
                node[axis] = floor_divided(cell[axis], work->cells);
            }
            const int32_t found = lmb_probe_index_find(&work->level[above].index, node);
            if (found >= 0 && work->level[above].node[found].leaf) {
                return true;
            }
        }
    }
    return false;
}

typedef struct tree_figures {
    int64_t probes, own; /* not on coarser leaves */
    double error[HALVES];
} tree_figures;

static tree_figures tree_measure(const bound *work)
{
    tree_figures figures = {0};
    for (int at = 0; at < work->count; ++at) {
        const bound_level *const level = &work->level[at];
        for (int32_t i = 0; i < level->bake.probes->count; ++i) {
            if (level->refs[i] > 0) {
                ++figures.probes;
                figures.own += !point_touches_coarser(work, at, level->bake.probes->point[i]);
            }
        }
    }
    double sum[HALVES] = {0.0}, count[HALVES] = {0.0};
    for (uint32_t i = 0; i < work->places.count; ++i) {
        for (int at = 0; at < work->count; ++at) {
            const int32_t node = place_node(work, at, &work->places.place[i]);
            if (node >= 0 && work->level[at].node[node].leaf) {
                sum[i % HALVES] += (double)work->level[at].share[i];
                count[i % HALVES] += 1.0;
            }
        }
    }
    for (int half = 0; half < HALVES; ++half) {
        figures.error[half] = sqrt(fmax(sum[half], 0.0) / fmax(count[half], 1.0));
    }
    return figures;
}

/* --------------------------------------------------------------------------------------------- true bakes */

static lmb_result level_copy(const bound_level *from, lmb_probes *to)
{
    const lmb_probes *const even = from->bake.probes;
    const int32_t own = even->level[0].count;
    bool *const used = calloc((size_t)own + 1, sizeof *used);
    int32_t(*const point)[3] = malloc(((size_t)own + 1) * sizeof *point);
    lmb_result result = used && point ? LMB_OK : LMB_ERROR_MEMORY;
    for (int32_t i = 0; i < from->cell_count && result == LMB_OK; ++i) {
        const int32_t *const cell = from->cell[i];
        for (int corner = 0; corner < 8 && from->node[from->cell_node[i]].leaf; ++corner) {
            const int32_t probe =
                lmb_probes_find(even, 0, cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2));
            if (probe >= 0) {
                used[probe] = true;
            }
        }
    }
    int32_t count = 0;
    for (int32_t i = 0; i < own && result == LMB_OK; ++i) {
        if (used[i]) {
            memcpy(point[count++], even->point[i], sizeof point[0]);
        }
    }
    if (result == LMB_OK && (count > 0 || to->level_count > 0)) {
        result = lmb_probes_add_level(to, &even->level[0].lattice, (const int32_t(*)[3])point, count);
    }
    for (int32_t i = 0, made = to->count - count; i < own && result == LMB_OK; ++i) {
        if (used[i]) {
            to->validity[made++] = even->validity[i];
        }
    }
    free(point);
    free(used);
    return result;
}

/* As lmb_bake_levels makes levels. `*bake` is to be ended. */
static lmb_result tree_bake(const bound *work, lmb_bake *bake)
{
    *bake = lmb_bake_begin(&work->places.settings, work->places.level, NULL);
    lmb_result result = lmb_probes_create(&bake->probes);
    for (int at = work->count; at-- > 0 && result == LMB_OK;) {
        result = level_copy(&work->level[at], bake->probes);
    }
    lmb_placement_stats *const stats = &bake->record.placement;
    lmb_pool *const pool = work->places.level->pool;
    if (result == LMB_OK) {
        bake->probes->origin = work->level[0].bake.probes->origin;
        result = lmb_placement_hang(work->places.level->tracer, pool, bake->probes, stats);
    }
    if (result == LMB_OK) {
        result = lmb_regions_make(work->places.level->tracer, pool, NULL, bake->probes, &bake->regions,
                                  &bake->record.regions);
    }
    if (result == LMB_OK) {
        result = lmb_placement_hang(work->places.level->tracer, pool, bake->probes, stats);
    }
    return result == LMB_OK ? places_gather(bake) : result;
}

/* ----------------------------------------------------------------------------------------------- figures */

/* Squared relative errors of probes; where they have no cell it is 1. */
static void shares_measure(const bound *work, const lmb_probes *probes, float *shares, double error[HALVES])
{
    double sum[HALVES] = {0.0}, count[HALVES] = {0.0};
    for (uint32_t i = 0; i < work->places.count; ++i) {
        double squared, share;
        const bool has = place_error(&work->places, probes, &work->places.place[i], &squared, &share);
        const double own = has ? fmin(share, 1.0) : 1.0;
        const double light = work->places.place[i].squared_light;
        const double counted = work->absolute ? (has ? squared : light) / work->mean_squared_light : own;
        if (shares) {
            shares[i] = (float)counted;
        }
        sum[i % HALVES] += counted;
        count[i % HALVES] += 1.0;
    }
    for (int half = 0; half < HALVES; ++half) {
        error[half] = sqrt(fmax(sum[half], 0.0) / fmax(count[half], 1.0));
    }
}

/* How many probes an even lattice of that error has, on logarithmic axes. */
static double even_probes(const bound *work, double error)
{
    int at = 0;
    while (at + 2 < work->count && work->level[at + 1].error[1] > error) {
        ++at;
    }
    const bound_level *const a = &work->level[at], *const b = &work->level[at + 1];
    const double ratio = (double)b->bake.probes->count / (double)a->bake.probes->count;
    const double slope = log(ratio) / log(b->error[1] / a->error[1]);
    return (double)a->bake.probes->count * exp(slope * log(error / a->error[1]));
}

static lmb_result level_begin(bound *work, int at, double spacing, lmb_error *error)
{
    bound_level *const level = &work->level[at];
    lmb_bake_settings settings = work->places.settings;
    settings.min_spacing = 0.0f;
    settings.spacing = (float)spacing;
    settings.max_probes = INT32_MAX; /* the spacing is to stay */
    lmb_result result = places_bake(&work->places, &settings, &level->bake, error);
    work->count = at + 1;
    if (result != LMB_OK) {
        return result;
    }
    level->share = malloc((work->places.count + (size_t)1) * sizeof *level->share);
    if (!level->share || !cells_list(level)) {
        return LMB_ERROR_MEMORY;
    }
    shares_measure(work, level->bake.probes, level->share, level->error);
    for (int32_t i = 0; i < level->cell_count; ++i) {
        int32_t point[3];
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = floor_divided(level->cell[i][axis], work->cells);
        }
        level->cell_node[i] = node_add_all(work, at, point);
        if (level->cell_node[i] < 0) {
            return LMB_ERROR_MEMORY;
        }
        level->node[level->cell_node[i]].has_cells = true;
    }
    printf("even\t%g\t%d\t\t%.4f\t%.4f\n", spacing, level->bake.probes->count, level->error[0], level->error[1]);
    return LMB_OK;
}

static void errors_set(bound *work)
{
    for (int at = 0; at < work->count; ++at) {
        for (uint32_t i = 0; i < work->places.count; i += HALVES) {
            const int32_t node = place_node(work, at, &work->places.place[i]);
            if (node >= 0) {
                work->level[at].node[node].error += (double)work->level[at].share[i];
            }
        }
    }
}

static lmb_result price_measure(bound *work, double price)
{
    for (int round = 0; round < ROUNDS; ++round) {
        for (int at = 0; at < work->count; ++at) {
            if (round == 0) {
                refs_count(&work->level[at], false);
            }
            costs_set(&work->level[at], round > 0);
        }
        tree_choose(work, price);
        for (int at = 0; at < work->count; ++at) {
            refs_count(&work->level[at], true);
        }
    }
    const tree_figures figures = tree_measure(work);
    printf("oracle\t%.3g\t%lld\t%lld\t%.4f\t%.4f\t%.2f\n", price, (long long)figures.probes, (long long)figures.own,
           figures.error[0], figures.error[1], even_probes(work, figures.error[1]) / (double)figures.probes);
    if (work->cells != 2) {
        return LMB_OK;
    }
    lmb_bake bake;
    const lmb_result result = tree_bake(work, &bake);
    if (result == LMB_OK) {
        double error[HALVES];
        shares_measure(work, bake.probes, NULL, error);
        printf("baked\t\t%d\t%d\t%.4f\t%.4f\t%.2f\n", bake.probes->count, bake.record.placement.probes_valid, error[0],
               error[1], even_probes(work, error[1]) / bake.probes->count);
    }
    lmb_bake_end(&bake);
    fflush(stdout);
    return result;
}

static lmb_result bound_measure(bound *work, lmb_error *error)
{
    const double coarsest = (double)work->places.settings.spacing, finest = (double)work->places.settings.min_spacing;
    lmb_result result = places_make(&work->places, finest, error);
    for (uint32_t i = 0; i < work->places.count; ++i) {
        work->mean_squared_light += work->places.place[i].squared_light / work->places.count;
    }
    for (int at = 0; at < MOST_LEVELS && ldexp(coarsest, -at) > 0.99 * finest && result == LMB_OK; ++at) {
        result = level_begin(work, at, ldexp(coarsest, -at), error);
    }
    if (result != LMB_OK) {
        return result;
    }
    errors_set(work);
    const bound_level *const first = &work->level[0];
    const double unit = first->error[0] * first->error[0] * work->places.count / HALVES / first->bake.probes->count;
    for (int i = 0; i < PRICES && result == LMB_OK; ++i) {
        result = price_measure(work, 2.0 * unit / pow(3.0, i));
    }
    return result;
}

static void bound_free(bound *work)
{
    for (int at = 0; at < work->count; ++at) {
        bound_level *const level = &work->level[at];
        lmb_bake_end(&level->bake);
        lmb_probe_index_free(&level->index);
        free(level->cell);
        free(level->cell_cut);
        free(level->cell_node);
        free(level->refs);
        free(level->node);
        free(level->share);
    }
    free(work->places.place);
}

int main(int count, char **values)
{
    static bound work = {.cells = 2};
    work.places = (level_places){.wanted = 20000, .truth_samples = 512, .settings = lmb_bake_settings_default()};
    lmb_bake_settings *const settings = &work.places.settings;
    lmb_arguments arguments = arguments_begin(count - 1, values + 1, "lambent_levels_bound", usage);
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (bake_argument(settings, &arguments, argument)) {
            continue;
        }
        if (strcmp(argument, "--points") == 0) {
            work.places.wanted = (uint32_t)arguments_integer(&arguments, argument, 1, 1 << 24);
        } else if (strcmp(argument, "--truth") == 0) {
            work.places.truth_samples = (uint32_t)arguments_integer(&arguments, argument, 4, 1 << 28);
        } else if (strcmp(argument, "--absolute") == 0) {
            work.absolute = true;
        } else if (strcmp(argument, "--cells") == 0) {
            work.cells = (int32_t)arguments_integer(&arguments, argument, 1, 2);
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (arguments.failed || arguments.help || !settings->level.path || !(settings->min_spacing > 0.0f) ||
        !(settings->spacing >= 2.0f * settings->min_spacing)) {
        fputs(usage, stderr);
        return 2;
    }
    lmb_error error = {{0}};
    lmb_level level;
    const lmb_warnings warnings = console_warnings(arguments.quiet);
    lmb_result result = lmb_level_open(&settings->level, &warnings, NULL, &level, &error);
    if (result == LMB_OK) {
        work.places.level = &level;
        result = bound_measure(&work, &error);
        bound_free(&work);
        lmb_level_close(&level);
    }
    return result == LMB_OK ? 0 : command_fail(result, &error);
}
