/* Cells of probes: those that are cut, and finding the one around a place. */
#include <lambent/probes.h>

#include "volume_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static void corner_point(const int32_t first[3], int corner, int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = first[axis] + (corner >> axis & 1);
    }
}

/* Whether each is the level's probe at that corner, or a ghost of it. */
static bool corners_are_sane(const lmb_probes *probes, uint32_t level, const int32_t point[3], const int32_t corner[8])
{
    const lmb_probe_level *const own = &probes->level[level];
    bool sane = true;
    for (int i = 0; i < 8; ++i) {
        int32_t at[3];
        corner_point(point, i, at);
        const bool is_ghost = corner[i] >= own->ghost_first && corner[i] < own->ghost_first + own->ghost_count;
        sane = sane && (is_ghost ? memcmp(probes->point[corner[i]], at, sizeof at) == 0
                                 : corner[i] >= 0 && corner[i] == lmb_probe_index_find(&own->index, at));
    }
    return sane;
}

static bool cell_is_sane(const lmb_probes *probes, uint32_t level, const int32_t point[3])
{
    const lmb_lattice *const lattice = &probes->level[level].lattice;
    bool sane = true;
    for (int axis = 0; axis < 3; ++axis) {
        sane = sane && (int64_t)point[axis] + 1 < (int64_t)lattice->min[axis] + lattice->size[axis];
    }
    return sane && lmb_lattice_has(lattice, point);
}

static bool ghosts_are_sane(const lmb_probes *probes)
{
    int64_t ghosts = 0;
    bool sane = true;
    for (uint32_t level = 0; sane && level < probes->level_count; ++level) {
        const lmb_probe_level *const own = &probes->level[level];
        ghosts += own->ghost_count;
        sane =
            own->ghost_count == 0 || (own->ghost_count > 0 && own->ghost_first >= probes->count - probes->ghost_count &&
                                      (int64_t)own->ghost_first + own->ghost_count <= probes->count);
        for (int32_t i = 0; sane && i < own->ghost_count; ++i) {
            sane = lmb_lattice_has(&own->lattice, probes->point[own->ghost_first + i]);
        }
    }
    return sane && ghosts == probes->ghost_count;
}

bool lmb_probes_cuts_are_sane(const lmb_probes *probes)
{
    const lmb_cut_cells *const cut = &probes->cut;
    bool sane = ghosts_are_sane(probes);
    for (uint32_t i = 0; sane && i < cut->count; ++i) {
        const lmb_cut_cell *const cell = &cut->cell[i];
        sane = (uint64_t)cell->plane_first + cell->plane_count <= cut->plane_count &&
               (uint64_t)cell->region_first + cell->region_count <= cut->region_count &&
               cell->level < probes->level_count && cell_is_sane(probes, cell->level, cell->point) &&
               lmb_probe_index_find(&probes->level[cell->level].cut, cell->point) == (int32_t)i &&
               lmb_cell_planes_are_sane(&cut->plane[cell->plane_first], cell->plane_count, cell->region_count);
        for (uint32_t region = 0; sane && region < cell->region_count; ++region) {
            sane = corners_are_sane(probes, cell->level, cell->point, cut->corner[cell->region_first + region]);
        }
    }
    return sane;
}

/* Room for `added` more elements; it doubles with every power of two. */
static bool array_reserve(void **array, size_t size, uint32_t count, uint32_t added)
{
    size_t room = 1;
    while (room < count) {
        room *= 2;
    }
    if (*array && count + (size_t)added <= room) {
        return true;
    }
    while (room < count + (size_t)added) {
        room *= 2;
    }
    void *const grown = realloc(*array, room * size);
    *array = grown ? grown : *array;
    return grown != NULL;
}

static bool cuts_reserve(lmb_cut_cells *cut, uint32_t planes, uint32_t regions)
{
    void *cell = cut->cell, *plane = cut->plane, *corner = cut->corner;
    const bool good = array_reserve(&cell, sizeof *cut->cell, cut->count, 1) &&
                      array_reserve(&plane, sizeof *cut->plane, cut->plane_count, planes) &&
                      array_reserve(&corner, sizeof *cut->corner, cut->region_count, regions);
    cut->cell = cell;
    cut->plane = plane;
    cut->corner = corner;
    return good;
}

lmb_result lmb_probes_cut(lmb_probes *probes, uint32_t level, const int32_t point[3], const lmb_cell_plane *plane,
                          uint32_t plane_count, const int32_t (*corner)[8], uint32_t region_count)
{
    assert(probes && level < probes->level_count && point && (plane || plane_count == 0) && corner);
    lmb_cut_cells *const cut = &probes->cut;
    bool sane = cell_is_sane(probes, level, point) && lmb_cell_planes_are_sane(plane, plane_count, region_count) &&
                cut->count < INT32_MAX;
    for (uint32_t region = 0; sane && region < region_count; ++region) {
        sane = corners_are_sane(probes, level, point, corner[region]);
    }
    if (!sane) {
        return LMB_ERROR_ARGUMENT;
    }
    if (!cuts_reserve(cut, plane_count, region_count)) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_probe_index_add(&probes->level[level].cut, point, (int32_t)cut->count);
    if (result != LMB_OK) {
        return result;
    }
    cut->cell[cut->count++] = (lmb_cut_cell){.point = {point[0], point[1], point[2]},
                                             .level = level,
                                             .plane_first = cut->plane_count,
                                             .plane_count = plane_count,
                                             .region_first = cut->region_count,
                                             .region_count = region_count};
    if (plane_count > 0) {
        memcpy(&cut->plane[cut->plane_count], plane, plane_count * sizeof *plane);
    }
    memcpy(&cut->corner[cut->region_count], corner, region_count * sizeof *corner);
    cut->plane_count += plane_count;
    cut->region_count += region_count;
    return LMB_OK;
}

/* The regions of a cut cell that a place is in: level, point, fraction and cut are set. */
static void regions_find(const lmb_probes *probes, lmb_probe_cell *cell)
{
    const lmb_cut_cell *const cut = &probes->cut.cell[cell->cut];
    const float t[3] = {(float)cell->fraction[0], (float)cell->fraction[1], (float)cell->fraction[2]};
    const lmb_cell_regions at = lmb_cell_regions_at(&probes->cut.plane[cut->plane_first], cut->plane_count, t);
    const int heavier = at.share > 0.5f;
    cell->region = at.region[heavier];
    cell->share = heavier ? 1.0 - (double)at.share : (double)at.share;
    memcpy(cell->probe, probes->cut.corner[cut->region_first + cell->region], sizeof cell->probe);
    memcpy(cell->other, probes->cut.corner[cut->region_first + at.region[1 - heavier]], sizeof cell->other);
}

/* Completes a cell whose level, point and fraction are set. @return whether it is there */
static bool cell_complete(const lmb_probes *probes, lmb_probe_cell *cell)
{
    const lmb_probe_level *const own = &probes->level[cell->level];
    cell->cut = lmb_probe_index_find(&own->cut, cell->point);
    cell->region = 0;
    cell->share = 0.0;
    if (cell->cut >= 0) {
        regions_find(probes, cell);
        return true;
    }
    bool whole = true;
    for (int i = 0; whole && i < 8; ++i) {
        int32_t at[3];
        corner_point(cell->point, i, at);
        cell->probe[i] = lmb_probe_index_find(&own->index, at);
        whole = cell->probe[i] >= 0;
    }
    memcpy(cell->other, cell->probe, sizeof cell->other);
    return whole;
}

bool lmb_probes_cell_at(const lmb_probes *probes, uint32_t level, const int32_t cell[3], const double fraction[3],
                        lmb_probe_cell *found)
{
    *found = (lmb_probe_cell){.level = level};
    memcpy(found->point, cell, sizeof found->point);
    memcpy(found->fraction, fraction, sizeof found->fraction);
    return cell_complete(probes, found);
}

bool lmb_probes_cell(const lmb_probes *probes, lmb_vec3d position, lmb_probe_cell *cell)
{
    assert(probes && cell);
    lmb_probe_cell found = {0};
    for (found.level = 0; found.level < probes->level_count; ++found.level) {
        if (lmb_lattice_cell(&probes->level[found.level].lattice, position, found.point, found.fraction) &&
            cell_complete(probes, &found) && lmb_probes_cell_is_leaf(probes, found.level, found.point)) {
            *cell = found;
            return true;
        }
    }
    return false;
}

bool lmb_probes_around(const lmb_probes *probes, lmb_vec3d position, int32_t probe[8], double fraction[3])
{
    assert(probes && probe && fraction);
    lmb_probe_cell cell;
    if (!lmb_probes_cell(probes, position, &cell)) {
        return false;
    }
    memcpy(probe, cell.probe, sizeof cell.probe);
    memcpy(fraction, cell.fraction, sizeof cell.fraction);
    return true;
}

lmb_sh3_rgb lmb_probes_light(const lmb_probes *probes, uint32_t set, lmb_vec3d position)
{
    assert(probes && set < probes->set_count);
    lmb_sh3_rgb light = {{{{0.0f}}}};
    lmb_probe_cell cell;
    if (!lmb_probes_cell(probes, position, &cell)) {
        return light;
    }
    const lmb_sh3_rgb *const radiance = probes->radiance[set];
    const double *const t = cell.fraction;
    for (int channel = 0; channel < 3; ++channel) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            double sum = 0.0, other = 0.0;
            for (int i = 0; i < 8; ++i) {
                const double weight =
                    (i & 1 ? t[0] : 1.0 - t[0]) * (i & 2 ? t[1] : 1.0 - t[1]) * (i & 4 ? t[2] : 1.0 - t[2]);
                sum += weight * (double)radiance[cell.probe[i]].channel[channel].c[k];
                other += weight * (double)radiance[cell.other[i]].channel[channel].c[k];
            }
            light.channel[channel].c[k] = (float)(sum + cell.share * (other - sum));
        }
    }
    return light;
}
