/* The open index of tiles: what is derived of it, its readers, and a pointer for each tile. */
#ifndef LMB_TILES_INTERNAL_H
#define LMB_TILES_INTERNAL_H

#include <lambent/tiles.h>
#include <lambent/tiles_format.h>

#include "volume_atomic.h"
#include "volume_internal.h"

enum { LMB_TILES_LINE = 64 };

/* Threads that entered at even times, or at odd ones: on a line of its own, as all of them write it. */
typedef struct lmb_tiles_readers {
    lmb_atomic_count count;
    char padding[LMB_TILES_LINE - sizeof(lmb_atomic_count)];
} lmb_tiles_readers;

/* Positions are told as in the undivided volume (volume_internal.h): the volumes of tiles have its origin, so that
 * every number of a sample is the same. */
struct lmb_volume_tiles {
    const lmb_volume_calls *calls;
    const uint32_t *grid;
    double inverse_spacing;
    double origin[3], first[3], last[3];
    int32_t last_cell[3];
    double to_grid[3];      /* cells from the grid's beginning to the origin, and half a one */
    double inverse_tile[3]; /* 1 / tile_cells */
    size_t grid_step[2];
    double slack;
    int32_t origin_cell[3];
    const lmb_tiles_header *header;
    const lmb_tiles_entry *entry;
    bool is_allocated;
    char padding[LMB_TILES_LINE];
    lmb_tiles_readers readers[2]; /* [time modulo 2] */
    lmb_atomic_count time;        /* goes on when nobody is in from the time before */
    char padding_behind[LMB_TILES_LINE];
    lmb_atomic_pointer volume[]; /* [tile] lmb_volume, or NULL */
};

/* The place in the grid of the position, or of the nearest in the bounds; of NaN any. The middle of a cell, over the
 * length of a tile, is no whole number, and too far from one for rounding to matter. */
static inline size_t lmb_tiles_place(const lmb_volume_tiles *tiles, lmb_vec3d position)
{
    const double in[3] = {position.x, position.y, position.z};
    size_t place[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double first = tiles->first[axis], last = tiles->last[axis];
        const double at = in[axis] * tiles->inverse_spacing - tiles->origin[axis];
        const int32_t whole = (int32_t)(at > first ? (at < last ? at : last) : first);
        const int32_t cell = whole < tiles->last_cell[axis] ? whole : tiles->last_cell[axis];
        place[axis] = (size_t)(int32_t)(((double)cell + tiles->to_grid[axis]) * tiles->inverse_tile[axis]);
    }
    return place[0] + tiles->grid_step[0] * place[1] + tiles->grid_step[1] * place[2];
}

/* The volume that is set where the position is, or NULL. */
static inline const lmb_volume *lmb_tiles_volume(const lmb_volume_tiles *tiles, lmb_vec3d position)
{
    const uint32_t tile = tiles->grid[lmb_tiles_place(tiles, position)];
    return tile > 0 ? (const lmb_volume *)lmb_atomic_load(&tiles->volume[tile - 1]) : NULL;
}

#endif
