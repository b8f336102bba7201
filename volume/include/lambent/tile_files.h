/* Tiles of a volume (lambent/tiles.h) as files: an index FILE.lmt, and beside it FILE_X_Y_Z.lmb for the tile that
 * begins at X, Y and Z times the tiles' size. */
#ifndef LAMBENT_TILE_FILES_H
#define LAMBENT_TILE_FILES_H

#include <lambent/error.h>
#include <lambent/tiles.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The path of the tile at `at` beside the index. The caller frees it. NULL when out of memory. */
char *lmb_tile_files_path(const char *index, const int32_t at[3]);

typedef struct lmb_tile_files_stats {
    uint32_t count;
    double tile_size; /* metres, rounded to whole bricks of the coarsest level */
    uint64_t bytes;   /* of all tiles, without the index */
} lmb_tile_files_stats;

/* Splits a .lmb in memory (16-byte aligned, verified here) into tiles as near to `metres` as lmb_split_cells comes, and
 * writes them, and the index last, whose path ends in ".lmt".
 * @return LMB_ERROR_WRITE, and what opening the volume and lmb_split can */
lmb_result lmb_tile_files_write(const unsigned char *volume, size_t size, double metres, const char *index,
                                lmb_tile_files_stats *stats, lmb_error *error);

/* Whether a file begins as an index of tiles does. False also of one that cannot be read. */
bool lmb_tile_files_is_index(const char *path);

/* An index and those of its tiles that were needed so far. For one thread. */
typedef struct lmb_tile_files lmb_tile_files;

/* Opens an index, and no tile yet. @return what reading it and lmb_volume_tiles_open_memory can */
lmb_result lmb_tile_files_open(const char *index, lmb_tile_files **files, lmb_error *error);

/* Closes the index with all tiles. NULL is allowed. */
void lmb_tile_files_close(lmb_tile_files *files);

/* To sample, and to ask; tiles are set and closed here alone. */
const lmb_volume_tiles *lmb_tile_files_tiles(const lmb_tile_files *files);

/* Has a tile open and set; LMB_VOLUME_NO_TILE needs none. `*volume`, which may be NULL, gets the tile's volume, or
 * NULL where it is none: open until `files` is closed. @return what opening and lmb_volume_tiles_set can, with a line
 * that names the tile's file */
lmb_result lmb_tile_files_need(lmb_tile_files *files, uint32_t tile, const lmb_volume **volume, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
