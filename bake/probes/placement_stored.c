#include "probes/placement_stored.h"

#include <stdlib.h>

#include "probes/regions_stored.h"

static void lattice_move(lmb_stored *stored, lmb_lattice *lattice)
{
    LMB_STORED(stored, lattice->spacing);
    LMB_STORED(stored, lattice->min);
    LMB_STORED(stored, lattice->size);
    LMB_STORED(stored, lattice->axis);
}

static void points_write(lmb_stored *stored, const lmb_probes *probes, int32_t first, int32_t count)
{
    LMB_STORED(stored, count);
    if (count > 0) {
        lmb_stored_array(stored, probes->point[first], (size_t)count, sizeof *probes->point);
    }
}

/* The caller's, and their count. */
static int32_t (*points_read(lmb_stored *stored, int32_t *count))[3]
{
    LMB_STORED(stored, *count);
    return lmb_stored_expect(stored, *count >= 0) ? lmb_stored_array(stored, NULL, (size_t)*count, 3 * sizeof(int32_t))
                                                  : NULL;
}

static void cut_write(lmb_stored *stored, const lmb_cut_cells *cut, uint32_t cell)
{
    lmb_cut_cell own = cut->cell[cell];
    LMB_STORED(stored, own.point);
    LMB_STORED(stored, own.level);
    LMB_STORED(stored, own.plane_count);
    LMB_STORED(stored, own.region_count);
    for (uint32_t i = 0; i < own.plane_count; ++i) {
        lmb_cell_plane plane = cut->plane[own.plane_first + i];
        LMB_STORED(stored, plane);
    }
    lmb_stored_array(stored, cut->corner[own.region_first], own.region_count, sizeof *cut->corner);
}

void lmb_placement_write(const lmb_probes *probes, const lmb_regions *regions, lmb_stored *stored)
{
    uint32_t levels = probes->level_count, cuts = probes->cut.count;
    LMB_STORED(stored, levels);
    for (uint32_t i = 0; i < levels; ++i) {
        const lmb_probe_level *const level = &probes->level[i];
        lmb_lattice lattice = level->lattice;
        lattice_move(stored, &lattice);
        points_write(stored, probes, level->first, level->count);
    }
    for (uint32_t i = 0; i < levels; ++i) {
        points_write(stored, probes, probes->level[i].ghost_first, probes->level[i].ghost_count);
    }
    LMB_STORED(stored, cuts);
    for (uint32_t i = 0; i < cuts; ++i) {
        cut_write(stored, &probes->cut, i);
    }
    lmb_stored_array(stored, probes->validity, (size_t)probes->count, sizeof *probes->validity);
    lmb_stored_array(stored, probes->hanging, (size_t)probes->count, sizeof *probes->hanging);
    lmb_regions_write(regions, probes->count, stored);
}

/* What the probes say to it. */
static void take(lmb_stored *stored, lmb_result result)
{
    if (result == LMB_ERROR_MEMORY) {
        stored->result = result;
    }
    lmb_stored_expect(stored, result == LMB_OK);
}

static void level_read(lmb_stored *stored, lmb_probes *probes)
{
    lmb_lattice lattice;
    int32_t count;
    lattice_move(stored, &lattice);
    int32_t(*const point)[3] = points_read(stored, &count);
    if (point) {
        take(stored, lmb_probes_add_level(probes, &lattice, (const int32_t(*)[3])point, count));
    }
    free(point);
}

static void ghosts_read(lmb_stored *stored, lmb_probes *probes, uint32_t level)
{
    int32_t count, first;
    int32_t(*const point)[3] = points_read(stored, &count);
    if (point && count > 0) {
        take(stored, lmb_probes_add_ghosts(probes, level, (const int32_t(*)[3])point, count, &first));
    }
    free(point);
}

static void cut_read(lmb_stored *stored, lmb_probes *probes)
{
    lmb_cut_cell cell;
    lmb_cell_plane plane[LMB_CELL_PLANES_MOST];
    int32_t corner[LMB_CELL_REGIONS_MOST][8];
    LMB_STORED(stored, cell.point);
    LMB_STORED(stored, cell.level);
    LMB_STORED(stored, cell.plane_count);
    LMB_STORED(stored, cell.region_count);
    if (!lmb_stored_expect(stored, cell.level < probes->level_count && cell.plane_count <= LMB_CELL_PLANES_MOST &&
                                       cell.region_count <= LMB_CELL_REGIONS_MOST)) {
        return;
    }
    lmb_stored_value(stored, plane, cell.plane_count * sizeof *plane);
    lmb_stored_value(stored, corner, cell.region_count * sizeof *corner);
    if (stored->result == LMB_OK) {
        take(stored, lmb_probes_cut(probes, cell.level, cell.point, plane, cell.plane_count,
                                    (const int32_t(*)[8])corner, cell.region_count));
    }
}

static void probes_read(lmb_stored *stored, lmb_probes *probes)
{
    uint32_t levels, cuts;
    LMB_STORED(stored, levels);
    for (uint32_t i = 0; i < levels && stored->result == LMB_OK; ++i) {
        level_read(stored, probes);
    }
    for (uint32_t i = 0; i < levels && stored->result == LMB_OK; ++i) {
        ghosts_read(stored, probes, i);
    }
    LMB_STORED(stored, cuts);
    for (uint32_t i = 0; i < cuts && stored->result == LMB_OK; ++i) {
        cut_read(stored, probes);
    }
    if (lmb_stored_expect(stored, probes->level_count > 0 && probes->count > 0)) {
        lmb_stored_value(stored, probes->validity, (size_t)probes->count * sizeof *probes->validity);
        lmb_stored_value(stored, probes->hanging, (size_t)probes->count * sizeof *probes->hanging);
    }
    if (stored->result == LMB_OK) {
        lmb_stored_expect(stored, lmb_probes_validate(probes, NULL) == LMB_OK);
    }
}

lmb_result lmb_placement_read(lmb_stored *stored, lmb_vec3d origin, lmb_probes **probes, lmb_regions **regions)
{
    lmb_probes *read;
    if (lmb_probes_create(&read) != LMB_OK) {
        return LMB_ERROR_MEMORY;
    }
    read->origin = origin;
    probes_read(stored, read);
    lmb_regions *cells = stored->result == LMB_OK ? lmb_regions_read(stored, read->count) : NULL;
    if (stored->result != LMB_OK) {
        lmb_regions_destroy(cells);
        lmb_probes_destroy(read);
        return stored->result;
    }
    *probes = read;
    *regions = cells;
    return LMB_OK;
}
