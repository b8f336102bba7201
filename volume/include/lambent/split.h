/* Splitting a run-time volume, .lmb, into tiles (docs/formats.md; opened by lambent/tiles.h). */
#ifndef LAMBENT_SPLIT_H
#define LAMBENT_SPLIT_H

#include <lambent/tiles_format.h>
#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Takes the .lmb of a tile, which is gone when it returns. What it returns but LMB_OK ends the split with that. */
typedef struct lmb_split_sink {
    lmb_result (*write)(void *context, const int32_t at[3], const unsigned char *data, size_t size);
    void *context;
} lmb_split_sink;

/* Cells of the finest level along a tile that is so many metres long, as near as whole bricks of the coarsest level
 * come; one of these at least. */
int32_t lmb_split_cells(const lmb_volume_info *info, double metres);

/* Splits an open volume of version 4 or 5 into tiles of so many cells of the finest level along each axis: multiples of
 * a brick of the coarsest one. Gives each tile that has cells to `sink`, x fastest, then y and z; then `*index` is the
 * index of all in malloc'ed memory, 16-byte aligned, which the caller frees. Local sets are in the tile that
 * lmb_volume_tiles_find gives of their middle or, where that has no cells, one of the nearest that have.
 * @return LMB_ERROR_MEMORY, _ARGUMENT (tile_cells), _VERSION (version 3 of the format is not split), _FORMAT (a volume
 * that no writer leaves), or what the sink returned; then `*index` is not touched */
lmb_result lmb_split(const lmb_volume *volume, const int32_t tile_cells[3], const lmb_split_sink *sink,
                     unsigned char **index, size_t *index_size);

#ifdef __cplusplus
}
#endif

#endif
