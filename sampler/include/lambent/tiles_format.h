/* The layout of an index of tiles, version 1, as C structs: for those who write one. docs/formats.md is normative;
 * everything is little-endian, and the structs have no padding of their own.
 *
 *     header | grid: a word for each place of a tile | tiles
 *
 * each part from the next multiple of 64 on. */
#ifndef LAMBENT_TILES_FORMAT_H
#define LAMBENT_TILES_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/key_light.h>
#include <lambent/volume_format.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LMB_TILES_MAGIC "\x89LMT\r\n\x1a\n"

enum { LMB_TILES_VERSION = 1, LMB_TILES_HEADER_BYTES = 192 };

typedef struct lmb_tiles_header {
    unsigned char magic[LMB_VOLUME_MAGIC_SIZE];
    uint32_t version;
    uint32_t header_bytes;
    uint64_t file_bytes;
    uint64_t checksum; /* lmb_volume_hash, from LMB_VOLUME_CHECKSUM_START on */
    float spacing;     /* this and what follows: as in the undivided volume, and in the header of every tile */
    float scale;
    int32_t min[3]; /* of the undivided volume */
    int32_t size[3];
    int32_t tile_cells[3]; /* cells of the finest level along each axis of a tile; a multiple of the coarsest brick */
    uint32_t level_count;
    uint32_t key_light_count;
    uint32_t probe_form;
    uint32_t tile_count; /* that have files, >= 1 */
    uint32_t reserved;
    lmb_key_light key_light[LMB_KEY_LIGHTS_MOST];
} lmb_tiles_header;

/* A tile has the cells tile_cells * at up to tile_cells * (at + 1), as far as the undivided volume has them. */
typedef struct lmb_tiles_entry {
    int32_t at[3];
    uint32_t reserved;
    uint64_t file_bytes; /* of its .lmb */
    uint64_t checksum;   /* as in its header */
} lmb_tiles_entry;

/* Where everything lies, in bytes. */
typedef struct lmb_tiles_layout {
    int32_t grid_first[3]; /* the first place of a tile that has cells of the box, */
    uint32_t grid_size[3]; /* and how many places along each axis */
    uint64_t places;       /* x + grid_size[0] (y + grid_size[1] z): 1 + the number of the tile there, or 0 */
    uint64_t grid, tiles, end;
} lmb_tiles_layout;

/* From box, tiles and their count of a header.
 * @return false: the box or a tile is none, or there are more than 2^31 places */
static inline bool lmb_tiles_layout_find(const lmb_tiles_header *header, lmb_tiles_layout *layout)
{
    const uint64_t mask = LMB_VOLUME_ALIGNMENT - 1;
    layout->places = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t first = header->min[axis], last = first + header->size[axis] - 1;
        const int32_t cells = header->tile_cells[axis];
        if (header->size[axis] < 1 || last > INT32_MAX || cells < 1) {
            return false;
        }
        const int32_t last_cell = (int32_t)(last > first ? last - 1 : first);
        layout->grid_first[axis] = lmb_volume_floor_divide((int32_t)first, cells);
        layout->grid_size[axis] = (uint32_t)(lmb_volume_floor_divide(last_cell, cells) - layout->grid_first[axis] + 1);
        if (layout->grid_size[axis] > (UINT64_C(1) << 31) / layout->places) {
            return false;
        }
        layout->places *= layout->grid_size[axis];
    }
    layout->grid = LMB_TILES_HEADER_BYTES;
    layout->tiles = (layout->grid + layout->places * sizeof(uint32_t) + mask) & ~mask;
    layout->end = (layout->tiles + header->tile_count * sizeof(lmb_tiles_entry) + mask) & ~mask;
    return true;
}

/* The box of a tile's volume, on the finest lattice: the part of the undivided one's, with the points at its end. */
static inline void lmb_tiles_box(const lmb_tiles_header *header, const int32_t at[3], int32_t min[3], int32_t size[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t first = (int64_t)at[axis] * header->tile_cells[axis], end = first + header->tile_cells[axis];
        const int64_t low = header->min[axis], high = low + header->size[axis] - 1;
        const int64_t from = first > low ? first : low, to = end < high ? end : high;
        min[axis] = (int32_t)from;
        size[axis] = (int32_t)(to - from + 1);
    }
}

#ifdef __cplusplus
}
#endif

#endif
