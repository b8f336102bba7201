/* Cut cells of files of either version, for those who list what is in a volume: their planes, and the probes of their
 * regions. */
#ifndef LMB_VOLUME_CUT_CELL_H
#define LMB_VOLUME_CUT_CELL_H

#include "volume_cut.h"

typedef struct lmb_volume_cut_cell {
    const lmb_volume_brick *brick;
    uint32_t cell; /* its number in the brick */
    uint32_t region_count, plane_count;
    const lmb_cell_plane *plane;
    const lmb_volume_cut *record;     /* NULL: of version 3 */
    const lmb_volume_cut_3 *record_3; /* else NULL */
} lmb_volume_cut_cell;

/* A cell that is cut. */
static inline lmb_volume_cut_cell lmb_volume_cut_cell_of(const lmb_volume *volume, const lmb_volume_brick *brick,
                                                         uint32_t cell)
{
    lmb_volume_cut_cell cut = {.brick = brick, .cell = cell};
    if (volume->cut_offsets) {
        cut.record_3 = lmb_volume_cut_3_at(volume, brick->cut_first + lmb_volume_cuts_before(brick, cell));
        cut.region_count = cut.record_3->region_count;
        cut.plane_count = cut.record_3->plane_count;
        cut.plane = lmb_volume_cut_3_planes(cut.record_3);
    } else {
        cut.record = lmb_volume_cut_record(volume, lmb_volume_cut_at(volume, lmb_volume_cut_slot(brick, cell)));
        cut.region_count = cut.record->region_count;
        cut.plane_count = cut.record->plane_count;
        cut.plane = lmb_volume_cut_planes(cut.record);
    }
    return cut;
}

/* Where the brick has the corners of a cell; modulo 2^32, as rows are, where it has none. */
static inline void lmb_volume_own_places(const lmb_volume *volume, const lmb_volume_brick *brick, uint32_t cell,
                                         uint32_t place[8])
{
    for (uint32_t i = 0; i < 8; ++i) {
        const uint32_t x = cell % 4 + i % 2, y = cell / 4 % 4 + i / 2 % 2, z = cell / 16 + i / 4;
        place[i] = brick->row[y + LMB_BRICK_POINTS * z] + x * volume->probe_units;
    }
}

/* Where the probes of a region are.
 * @return bit i: corner i is not the brick's own */
static inline uint32_t lmb_volume_cut_cell_places(const lmb_volume *volume, const lmb_volume_cut_cell *cut,
                                                  uint32_t region, uint32_t place[8])
{
    uint32_t own[8], ghosts = 0;
    lmb_volume_own_places(volume, cut->brick, cut->cell, own);
    if (cut->record_3) {
        memcpy(place, lmb_volume_cut_3_corners(cut->record_3, region), 8 * sizeof place[0]);
    } else {
        const lmb_volume_cut_region *const of = &lmb_volume_cut_regions(cut->record)[region];
        const uint32_t *const row = &cut->brick->row[cut->cell / 4 % 4 + LMB_BRICK_POINTS * (cut->cell / 16)];
        lmb_volume_cut_places(row, cut->cell % 4, volume->probe_units, of->ghosts,
                              lmb_volume_cut_ghosts(cut->record) + of->first, cut->brick->ghost_first, place);
    }
    for (uint32_t i = 0; i < 8; ++i) {
        ghosts |= (uint32_t)(place[i] != own[i]) << i;
    }
    return ghosts;
}

#endif
