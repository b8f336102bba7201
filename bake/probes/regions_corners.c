/* Which corners of regions are one value, and what holds it. */
#include "probes/regions_internal.h"

#include <stdlib.h>
#include <string.h>

enum { NO_ROOT = -1 };

/* What naming values goes through; arrays over roots have room for all corners. */
typedef struct naming {
    lmb_region_work *work;
    int32_t *value;    /* [root] a probe or a ghost, or -1 */
    uint32_t *plain;   /* [root] cells that are plain if the lattice's own probe is the value */
    uint32_t *claimed; /* [probe] the root that has it, or UINT32_MAX */
} naming;

static uint32_t root_of(uint32_t *root, uint32_t i)
{
    while (root[i] != i) {
        i = root[i] = root[root[i]];
    }
    return i;
}

/* The first one is the root. */
static void unite(uint32_t *root, uint32_t one, uint32_t other)
{
    const uint32_t a = root_of(root, one), b = root_of(root, other);
    root[a > b ? a : b] = a > b ? b : a;
}

static const lmb_region_look *look_of(const lmb_region_work *work, const lmb_region_cell *cell)
{
    return cell->look == UINT32_MAX ? NULL : &work->look[cell->look];
}

static uint8_t label_of(const lmb_region_look *look, int node)
{
    return look ? look->label[node] : 0;
}

/* --- unions ------------------------------------------------------------------------------------------------------- */

/* The four corners of the face between a region and one of the next cell along the axis. `part` is a forest of regions.
 */
static void regions_unite(lmb_region_work *work, uint32_t *part, uint32_t low, uint32_t high, int axis)
{
    unite(part, low, high);
    for (uint32_t i = 0; i < 8; ++i) {
        if (!(i >> axis & 1u)) {
            unite(work->root, 8 * low + (i | 1u << axis), 8 * high + i);
        }
    }
}

static void cells_unite(lmb_region_work *work, uint32_t *part, const lmb_region_cell *low, const lmb_region_cell *high,
                        int axis)
{
    const lmb_region_look *const below = look_of(work, low), *const above = look_of(work, high);
    if (low->count == 0 || high->count == 0) {
        return;
    }
    if (!below && !above) {
        regions_unite(work, part, low->first, high->first, axis);
        return;
    }
    const uint64_t open = below ? below->open[2 * axis + 1] : above->open[2 * axis];
    for (int line = 0; line < LMB_REGION_LINES; ++line) {
        const uint8_t a = label_of(below, lmb_region_line_node(axis, line, LMB_REGION_SIDE - 1));
        const uint8_t b = label_of(above, lmb_region_line_node(axis, line, 0));
        if ((open >> line & 1u) != 0 && a != LMB_REGION_NONE && b != LMB_REGION_NONE) {
            regions_unite(work, part, low->first + a, high->first + b, axis);
        }
    }
}

/* A corner of a finer region, by its root. */
typedef struct touch {
    uint32_t root, steps, link;
} touch;

static int touches_compare(const void *left, const void *right)
{
    const touch *const a = left, *const b = right;
    if (a->root != b->root) {
        return a->root < b->root ? -1 : 1;
    }
    return a->steps != b->steps ? (a->steps < b->steps ? -1 : 1) : (a->link < b->link ? -1 : a->link > b->link);
}

/* Two coarse cells, of one level, that a finer corner touches: what they have in common there is one. */
static void parents_unite(lmb_region_work *work, const lmb_region_link *one, const lmb_region_link *other)
{
    float weight[2][8];
    lmb_region_weights(one->t, weight[0]);
    lmb_region_weights(other->t, weight[1]);
    for (uint32_t a = 0; a < 8; ++a) {
        for (uint32_t b = 0; b < 8; ++b) {
            bool same = weight[0][a] > 0.0f && weight[1][b] > 0.0f;
            for (uint32_t axis = 0; axis < 3; ++axis) {
                /* From the finer corner to either: the same way. */
                same = same && (float)(a >> axis & 1u) - one->t[axis] == (float)(b >> axis & 1u) - other->t[axis];
            }
            if (same) {
                unite(work->root, 8 * one->coarse + a, 8 * other->coarse + b);
            }
        }
    }
}

/* Coarse cells may touch at edges alone, with finer cells all around. `all` has room for every link. */
static void touching_unite(lmb_region_work *work, touch *all)
{
    for (uint32_t level = 0; level + 1 < work->probes->level_count; ++level) {
        size_t count = 0;
        for (uint32_t i = 0; i < work->link_count; ++i) {
            const lmb_region_link *const link = &work->link[i];
            if (link->level == level) {
                all[count++] = (touch){root_of(work->root, 8 * link->fine + link->corner), link->steps, i};
            }
        }
        qsort(all, count, sizeof *all, touches_compare);
        for (size_t i = 1; i < count; ++i) {
            if (all[i].root == all[i - 1].root && all[i].steps == all[i - 1].steps) {
                parents_unite(work, &work->link[all[i - 1].link], &work->link[all[i].link]);
            }
        }
    }
}

/* Links of levels make their regions parts of one space. `part` is a forest of regions. */
static lmb_result levels_unite(lmb_region_work *work, uint32_t *part)
{
    const lmb_result result = lmb_region_levels_link(work);
    if (result != LMB_OK || work->link_count == 0) {
        return result;
    }
    touch *const all = malloc(work->link_count * sizeof *all);
    if (!all) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < work->link_count; ++i) {
        unite(part, work->link[i].fine, work->link[i].coarse);
    }
    touching_unite(work, all);
    free(all);
    return LMB_OK;
}

static bool corner_is_baked(const lmb_probes *probes, int32_t probe)
{
    return probe >= 0 && probes->validity[probe] >= LMB_PROBES_MIN_VALIDITY;
}

static int32_t corner_probe(const lmb_probes *probes, const lmb_region_cell *cell, int corner)
{
    return lmb_probes_find(probes, cell->level, cell->point[0] + (corner & 1), cell->point[1] + (corner >> 1 & 1),
                           cell->point[2] + (corner >> 2));
}

/* Corners whose baked probe a cell's region sees. */
static unsigned real_corners(const lmb_region_work *work, const lmb_region_cell *cell, uint32_t region)
{
    const lmb_region_look *const look = look_of(work, cell);
    if (look) {
        return look->real[region];
    }
    unsigned real = 0;
    for (int i = 0; i < 8; ++i) {
        real |= (unsigned)corner_is_baked(work->probes, corner_probe(work->probes, cell, i)) << i;
    }
    return real;
}

/* A region is reached that sees a baked probe, or touches another that is. */
static void regions_reach(lmb_region_work *work, uint32_t *part)
{
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        const lmb_region_cell *const cell = &work->cell[i];
        for (uint32_t region = 0; region < cell->count; ++region) {
            if (real_corners(work, cell, region) != 0) {
                work->reached[root_of(part, cell->first + region)] = 1;
            }
        }
    }
    for (uint32_t region = 0; region < work->region_count; ++region) {
        work->reached[region] = work->reached[root_of(part, region)]; /* a root comes before what hangs on it */
    }
}

static lmb_result corners_unite(lmb_region_work *work)
{
    uint32_t *const part = malloc(((size_t)work->region_count + 1) * sizeof *part);
    if (!part) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < 8 * work->region_count; ++i) {
        work->root[i] = i;
        part[i / 8] = i / 8;
    }
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        const lmb_region_cell *const cell = &work->cell[i];
        for (int axis = 0; axis < 3; ++axis) {
            int32_t next[3] = {cell->point[0], cell->point[1], cell->point[2]};
            ++next[axis];
            const int32_t other = lmb_probe_index_find(&work->index[cell->level], next);
            if (other >= 0) {
                cells_unite(work, part, cell, &work->cell[other], axis);
            }
        }
    }
    const lmb_result result = levels_unite(work, part);
    regions_reach(work, part);
    free(part);
    return result;
}

/* --- values ------------------------------------------------------------------------------------------------------- */

static uint32_t regions_reached(const lmb_region_work *work, const lmb_region_cell *cell)
{
    uint32_t count = 0;
    for (uint32_t region = 0; region < cell->count; ++region) {
        count += work->reached[cell->first + region];
    }
    return count;
}

/* Gives values that are baked their probes, and counts what the others are needed for. */
static void real_name(const naming *names, const lmb_region_cell *cell)
{
    lmb_region_work *const work = names->work;
    const bool single = cell->probes == 8 && regions_reached(work, cell) == 1;
    for (uint32_t region = 0; region < cell->count; ++region) {
        const unsigned real = work->reached[cell->first + region] ? real_corners(work, cell, region) : 0u;
        for (int i = 0; i < 8 && work->reached[cell->first + region]; ++i) {
            const uint32_t root = root_of(work->root, 8 * (cell->first + region) + (uint32_t)i);
            names->plain[root] += single;
            if ((real >> i & 1u) != 0) {
                names->value[root] = corner_probe(work->probes, cell, i);
                names->claimed[names->value[root]] = root;
            }
        }
    }
}

/* Which value a probe that was not baked is best for: that which leaves most cells plain. */
static void slots_claim(const naming *names, const lmb_region_cell *cell)
{
    lmb_region_work *const work = names->work;
    for (uint32_t i = 0; i < 8 * cell->count; ++i) {
        const int32_t probe = corner_probe(work->probes, cell, (int)(i % 8));
        if (!work->reached[cell->first + i / 8] || probe < 0 || corner_is_baked(work->probes, probe)) {
            continue;
        }
        const uint32_t root = root_of(work->root, 8 * cell->first + i), now = names->claimed[probe];
        if (now == UINT32_MAX || names->plain[root] > names->plain[now] ||
            (root < now && names->plain[root] == names->plain[now])) {
            names->claimed[probe] = root;
        }
    }
}

/* Numbers the ghosts of a level, from 0, in the order of cells. @return how many */
static int32_t ghosts_number(const naming *names, uint32_t level, int32_t (*point)[3], uint32_t *root_of_ghost)
{
    const lmb_region_work *const work = names->work;
    int32_t count = 0;
    for (uint32_t c = 0; c < work->cell_count; ++c) {
        const lmb_region_cell *const cell = &work->cell[c];
        for (uint32_t i = 0; cell->level == level && i < 8 * cell->count; ++i) {
            const uint32_t root = root_of(work->root, 8 * cell->first + i);
            if (work->reached[cell->first + i / 8] && names->value[root] < 0) {
                for (int axis = 0; axis < 3; ++axis) {
                    point[count][axis] = cell->point[axis] + (int32_t)(i >> axis & 1u);
                }
                root_of_ghost[count] = root;
                names->value[root] = count++;
            }
        }
    }
    return count;
}

/* Ghosts may lie where no probes do. */
static void box_widen(lmb_lattice *box, const int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const int32_t last = box->min[axis] + box->size[axis] - 1;
        const int32_t first = point[axis] < box->min[axis] ? point[axis] : box->min[axis];
        box->size[axis] = (point[axis] > last ? point[axis] : last) - first + 1;
        box->min[axis] = first;
    }
}

static lmb_result ghosts_add(const naming *names)
{
    lmb_region_work *const work = names->work;
    const size_t most = 8 * (size_t)work->region_count + 1;
    int32_t(*const point)[3] = malloc(most * sizeof *point);
    uint32_t *const root = malloc(most * sizeof *root);
    lmb_result result = point && root ? LMB_OK : LMB_ERROR_MEMORY;
    for (uint32_t level = 0; level < work->probes->level_count && result == LMB_OK; ++level) {
        const int32_t count = ghosts_number(names, level, point, root);
        int32_t first = 0;
        for (int32_t i = 0; i < count; ++i) {
            box_widen(&work->probes->level[level].lattice, point[i]);
        }
        if (count > 0) {
            result = lmb_probes_add_ghosts(work->probes, level, (const int32_t(*)[3])point, count, &first);
        }
        for (int32_t i = 0; i < count; ++i) {
            names->value[root[i]] += first;
        }
        work->stats->ghosts += count;
    }
    free(point);
    free(root);
    return result;
}

static lmb_result values_name(const naming *names)
{
    lmb_region_work *const work = names->work;
    memset(names->value, 0xff, 8 * (size_t)work->region_count * sizeof *names->value);
    memset(names->claimed, 0xff, (size_t)work->probes->count * sizeof *names->claimed);
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        real_name(names, &work->cell[i]);
    }
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        slots_claim(names, &work->cell[i]);
    }
    for (int32_t probe = 0; probe < work->probes->count; ++probe) {
        if (names->claimed[probe] != UINT32_MAX) {
            names->value[names->claimed[probe]] = probe;
        }
    }
    const lmb_result result = ghosts_add(names);
    for (uint32_t i = 0; i < 8 * work->region_count && result == LMB_OK; ++i) {
        work->corner[i / 8][i % 8] = work->reached[i / 8] ? names->value[root_of(work->root, i)] : -1;
    }
    return result;
}

lmb_result lmb_region_corners_name(lmb_region_work *work)
{
    for (uint32_t i = 0; i < work->cell_count; ++i) {
        lmb_region_cell *const cell = &work->cell[i];
        cell->first = work->region_count;
        cell->count = cell->look != UINT32_MAX ? work->look[cell->look].count : cell->probes > 0;
        if (cell->count > UINT32_MAX / 8 - 1 - work->region_count) {
            return LMB_ERROR_MEMORY;
        }
        work->region_count += cell->count;
    }
    const size_t regions = (size_t)work->region_count + 1;
    work->root = malloc(8 * regions * sizeof *work->root);
    work->reached = calloc(regions, 1);
    work->corner = malloc(regions * sizeof *work->corner);
    const naming names = {.work = work,
                          .value = malloc(8 * regions * sizeof *names.value),
                          .plain = calloc(8 * regions, sizeof *names.plain),
                          .claimed = malloc(((size_t)work->probes->count + 1) * sizeof *names.claimed)};
    lmb_result result = LMB_ERROR_MEMORY;
    if (work->root && work->reached && work->corner && names.value && names.plain && names.claimed) {
        result = corners_unite(work);
    }
    if (result == LMB_OK) {
        result = values_name(&names);
    }
    free(names.value);
    free(names.plain);
    free(names.claimed);
    return result;
}
