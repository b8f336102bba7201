#include "vdb_cells.h"

#include <string.h>

static unsigned char *put(unsigned char *to, uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i) {
        *to++ = (unsigned char)(value >> 8 * i & 0xffu);
    }
    return to;
}

static uint32_t take(const unsigned char **from, int bytes)
{
    uint32_t value = 0;
    for (int i = 0; i < bytes; ++i) {
        value |= (uint32_t) * (*from)++ << 8 * i;
    }
    return value;
}

size_t lmb_vdb_cell_write(const lmb_vdb_cell *cell, unsigned char *bytes)
{
    unsigned char *to = bytes;
    for (int axis = 0; axis < 3; ++axis) {
        to = put(to, (uint32_t)cell->point[axis], 4);
    }
    to = put(to, cell->plane_count, 1);
    to = put(to, cell->region_count, 1);
    for (uint32_t i = 0; i < cell->plane_count; ++i) {
        const lmb_cell_plane *const plane = &cell->plane[i];
        for (int axis = 0; axis < 3; ++axis) {
            to = put(to, (uint16_t)plane->normal[axis], 2);
        }
        to = put(to, (uint16_t)plane->offset, 2);
        to = put(to, plane->child[0], 1);
        to = put(to, plane->child[1], 1);
    }
    for (uint32_t region = 0; region < cell->region_count; ++region) {
        memcpy(to, cell->layer[region], LMB_VDB_CELL_REGION_BYTES);
        to += LMB_VDB_CELL_REGION_BYTES;
    }
    return (size_t)(to - bytes);
}

bool lmb_vdb_cell_read(const unsigned char **bytes, size_t *size, lmb_vdb_cell *cell)
{
    if (*size < LMB_VDB_CELL_HEAD_BYTES) {
        return false;
    }
    const unsigned char *from = *bytes;
    for (int axis = 0; axis < 3; ++axis) {
        cell->point[axis] = (int32_t)take(&from, 4);
    }
    cell->plane_count = take(&from, 1);
    cell->region_count = take(&from, 1);
    const size_t needed = LMB_VDB_CELL_HEAD_BYTES + (size_t)LMB_VDB_CELL_PLANE_BYTES * cell->plane_count +
                          (size_t)LMB_VDB_CELL_REGION_BYTES * cell->region_count;
    if (cell->plane_count > LMB_CELL_PLANES_MOST || cell->region_count > LMB_CELL_REGIONS_MOST || *size < needed) {
        return false;
    }
    for (uint32_t i = 0; i < cell->plane_count; ++i) {
        lmb_cell_plane *const plane = &cell->plane[i];
        for (int axis = 0; axis < 3; ++axis) {
            plane->normal[axis] = (int16_t)take(&from, 2);
        }
        plane->offset = (int16_t)take(&from, 2);
        plane->child[0] = (uint8_t)take(&from, 1);
        plane->child[1] = (uint8_t)take(&from, 1);
    }
    for (uint32_t region = 0; region < cell->region_count; ++region) {
        memcpy(cell->layer[region], from, LMB_VDB_CELL_REGION_BYTES);
        from += LMB_VDB_CELL_REGION_BYTES;
    }
    *bytes += needed;
    *size -= needed;
    return true;
}
