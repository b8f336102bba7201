/* Cut cells as bytes, as probes.vdb holds them (docs/formats.md). */
#ifndef LAMBENT_VDB_CELLS_H
#define LAMBENT_VDB_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/cell.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A cell whose corners name layers: 0 is the level's probe at that point, 1 and more are ghosts of it. */
typedef struct lmb_vdb_cell {
    int32_t point[3];
    uint32_t plane_count, region_count; /* up to LMB_CELL_PLANES_MOST and _REGIONS_MOST */
    lmb_cell_plane plane[LMB_CELL_PLANES_MOST];
    uint8_t layer[LMB_CELL_REGIONS_MOST][8];
} lmb_vdb_cell;

enum {
    LMB_VDB_CELL_HEAD_BYTES = 14,
    LMB_VDB_CELL_PLANE_BYTES = 10,
    LMB_VDB_CELL_REGION_BYTES = 8,
    LMB_VDB_CELL_BYTES_MOST = LMB_VDB_CELL_HEAD_BYTES + LMB_VDB_CELL_PLANE_BYTES * LMB_CELL_PLANES_MOST +
                              LMB_VDB_CELL_REGION_BYTES * LMB_CELL_REGIONS_MOST
};

/* @return how many bytes it has written, LMB_VDB_CELL_BYTES_MOST at most */
size_t lmb_vdb_cell_write(const lmb_vdb_cell *cell, unsigned char *bytes);

/* Reads what is at `*bytes`, of `*size`, and takes it away from there.
 * @return false where there are too few bytes, or more planes or regions than a cell has; then `cell` holds anything */
bool lmb_vdb_cell_read(const unsigned char **bytes, size_t *size, lmb_vdb_cell *cell);

#ifdef __cplusplus
}
#endif

#endif
