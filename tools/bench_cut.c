#include "bench_cut.h"

#include <string.h>

/* The same in each cell. */
enum { PLANES = 2, REGIONS = 3 };
static const lmb_cell_plane planes[PLANES] = {
    {.normal = {9830, 0, 13106}, .offset = 9000, .child = {LMB_CELL_REGION, 1}},
    {.normal = {0, 13106, -9830}, .offset = 2000, .child = {LMB_CELL_REGION + 1, LMB_CELL_REGION + 2}}};

/* Which region each corner of a cell is in. */
static void corner_regions(uint32_t region[8])
{
    for (int i = 0; i < 8; ++i) {
        const float t[3] = {(float)(i & 1), (float)(i >> 1 & 1), (float)(i >> 2)};
        region[i] = lmb_cell_region(planes, PLANES, t);
    }
}

/* Cuts the cell whose first corner is a probe, where it is whole. The ghost of probe i is `ghost_first` + i. */
static lmb_result cell_cut(lmb_probes *probes, int32_t first, int32_t ghost_first, const uint32_t region[8])
{
    const int32_t *const point = probes->point[first];
    int32_t corner[REGIONS][8];
    for (int i = 0; i < 8; ++i) {
        const int32_t probe =
            lmb_probes_find(probes, 0, point[0] + (i & 1), point[1] + (i >> 1 & 1), point[2] + (i >> 2));
        if (probe < 0) {
            return LMB_OK;
        }
        for (uint32_t k = 0; k < REGIONS; ++k) {
            corner[k][i] = region[i] == k ? probe : ghost_first + probe;
        }
    }
    return lmb_probes_cut(probes, 0, point, planes, PLANES, (const int32_t(*)[8])corner, REGIONS);
}

static lmb_result cells_cut(lmb_probes *probes, int32_t ghost_first)
{
    uint32_t region[8];
    corner_regions(region);
    lmb_result result = LMB_OK;
    for (int32_t probe = 0; probe < ghost_first && result == LMB_OK; ++probe) {
        result = cell_cut(probes, probe, ghost_first, region);
    }
    return result;
}

static void light_copy(const lmb_probes *from, lmb_probes *to, int32_t first, int32_t count)
{
    memcpy(to->radiance[0] + first, from->radiance[0], (size_t)count * sizeof *to->radiance[0]);
    memcpy(to->validity + first, from->validity, (size_t)count * sizeof *to->validity);
}

lmb_probes *bench_cut_probes(const lmb_probes *probes)
{
    const lmb_probe_level *const level = &probes->level[0];
    const int32_t(*const point)[3] = (const int32_t(*)[3])probes->point;
    lmb_probes *made = NULL;
    int32_t ghost_first = 0;
    lmb_result result = lmb_probes_create(&made);
    if (result == LMB_OK) {
        result = lmb_probes_add_level(made, &level->lattice, point, level->count);
    }
    if (result == LMB_OK) {
        result = lmb_probes_add_ghosts(made, 0, point, level->count, &ghost_first);
    }
    if (result == LMB_OK) {
        light_copy(probes, made, 0, level->count);
        light_copy(probes, made, ghost_first, level->count);
        result = cells_cut(made, ghost_first);
    }
    if (result != LMB_OK) {
        lmb_probes_destroy(made);
        return NULL;
    }
    return made;
}
