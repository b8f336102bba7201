/* Splitting a volume: which tiles there are and the index of them (split.c), the volume of one (split_tile.c), and the
 * local sets that it has (split_locals.c). */
#ifndef LMB_SPLIT_INTERNAL_H
#define LMB_SPLIT_INTERNAL_H

#include <lambent/split.h>

#define LMB_SPLIT_NOTHING UINT32_C(0xffffffff)

/* The volume that is split, and what a tile takes of it, by numbers. */
typedef struct lmb_splitting {
    const unsigned char *source;
    const lmb_volume_header *header;
    lmb_volume_layout layout;
    const uint32_t *directory;
    const lmb_volume_brick *brick;
    uint32_t units; /* from a probe to the next */
    lmb_tiles_header tiles;
    lmb_tiles_layout grid;
    uint32_t *local_tile; /* [local set] the number of its tile; NULL: there are none */
    /* Of the tile at hand. */
    uint32_t *brick_list; /* rising numbers of its bricks */
    uint32_t brick_count;
    uint8_t *brick_taken; /* [brick of the volume] */
    uint32_t *probe_list; /* rising numbers of its probes */
    uint32_t probe_count;
    uint32_t *probe_number; /* [probe of the volume] its number in the tile, or LMB_SPLIT_NOTHING */
} lmb_splitting;

/* Finds the bricks of the tile at a place: brick_list and brick_count. */
void lmb_split_bricks(lmb_splitting *splitting, const int32_t at[3]);

/* The .lmb of the tile whose bricks were found; the caller frees `*data`.
 * @return LMB_ERROR_MEMORY, _FORMAT (rows or ghosts that no writer leaves) */
lmb_result lmb_split_tile(lmb_splitting *splitting, const lmb_tiles_entry *tile, uint32_t number, unsigned char **data,
                          size_t *size);

/* Finds which tile each local set is in, of those that have cells. @return LMB_ERROR_MEMORY */
lmb_result lmb_split_locals_place(lmb_splitting *splitting, const lmb_tiles_entry *tile);

/* The local sets of a tile: how many bytes, and those, of memory that is 0. */
uint64_t lmb_split_locals_bytes(const lmb_splitting *splitting, uint32_t number);
void lmb_split_locals_write(const lmb_splitting *splitting, uint32_t number, unsigned char *to);

#endif
