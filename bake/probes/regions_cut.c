/* Cutting the cells that need more than the lattice's own eight probes. */
#include "probes/regions_internal.h"

#include <stdlib.h>
#include <string.h>

/* A cell that is to be cut. */
typedef struct cell_cut {
    uint32_t cell;
    uint32_t regions;
    uint8_t name[LMB_CELL_REGIONS_MOST];    /* [label] its region, or LMB_REGION_NONE */
    uint32_t region[LMB_CELL_REGIONS_MOST]; /* [region] the first one of all that is it */
    lmb_region_tree tree;
} cell_cut;

typedef struct cut_work {
    lmb_region_work *all;
    cell_cut *cut;
    size_t count;
} cut_work;

/* Names the regions that are reached: those of the same eight values are one. */
static void regions_name(const lmb_region_work *all, const lmb_region_cell *cell, cell_cut *cut)
{
    cut->regions = 0;
    for (uint32_t label = 0; label < cell->count; ++label) {
        const uint32_t own = cell->first + label;
        cut->name[label] = LMB_REGION_NONE;
        if (!all->reached[own]) {
            continue;
        }
        for (uint32_t i = 0; i < cut->regions && cut->name[label] == LMB_REGION_NONE; ++i) {
            if (memcmp(all->corner[own], all->corner[cut->region[i]], sizeof all->corner[own]) == 0) {
                cut->name[label] = (uint8_t)i;
            }
        }
        if (cut->name[label] == LMB_REGION_NONE) {
            cut->name[label] = (uint8_t)cut->regions;
            cut->region[cut->regions++] = own;
        }
    }
}

/* Whether the lattice's own probes are what a region has. */
static bool is_plain(const lmb_region_work *all, const lmb_region_cell *cell, uint32_t region)
{
    bool plain = cell->probes == 8;
    for (int i = 0; i < 8 && plain; ++i) {
        plain = all->corner[region][i] == lmb_probes_find(all->probes, cell->level, cell->point[0] + (i & 1),
                                                          cell->point[1] + (i >> 1 & 1), cell->point[2] + (i >> 2));
    }
    return plain;
}

static void cell_part(void *context, size_t task, int worker)
{
    const cut_work *const work = context;
    cell_cut *const cut = &work->cut[task];
    cut->tree.plane_count = cut->tree.strays = 0;
    if (cut->regions > 1) {
        lmb_region_tree_grow(work->all, &work->all->cell[cut->cell], cut->name, &cut->tree, &work->all->rays[worker]);
    }
}

static lmb_result cell_cut_add(const cut_work *work, const cell_cut *cut)
{
    lmb_region_work *const all = work->all;
    const lmb_region_cell *const cell = &all->cell[cut->cell];
    int32_t corner[LMB_CELL_REGIONS_MOST][8];
    for (uint32_t i = 0; i < cut->regions; ++i) {
        memcpy(corner[i], all->corner[cut->region[i]], sizeof corner[i]);
    }
    all->stats->cells_cut += 1;
    all->stats->cells_parted += cut->regions > 1;
    all->stats->planes += cut->tree.plane_count;
    all->stats->strays += cut->tree.strays;
    return lmb_probes_cut(all->probes, cell->level, cell->point, cut->tree.plane, cut->tree.plane_count,
                          (const int32_t(*)[8])corner, cut->regions);
}

lmb_result lmb_region_cells_cut(lmb_region_work *all)
{
    cut_work work = {.all = all, .cut = malloc(((size_t)all->cell_count + 1) * sizeof *work.cut)};
    if (!work.cut) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < all->cell_count; ++i) {
        cell_cut *const cut = &work.cut[work.count];
        cut->cell = i;
        regions_name(all, &all->cell[i], cut);
        work.count += cut->regions > 1 || (cut->regions == 1 && !is_plain(all, &all->cell[i], cut->region[0]));
    }
    lmb_result result = lmb_pool_run(all->pool, work.count, cell_part, &work, "regions", all->progress);
    for (size_t i = 0; i < work.count && result == LMB_OK; ++i) {
        result = cell_cut_add(&work, &work.cut[i]);
    }
    free(work.cut);
    return result;
}
