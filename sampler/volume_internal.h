/* The open volume, and the steps of opening one: map the file, verify it, derive what sampling needs. */
#ifndef LMB_VOLUME_INTERNAL_H
#define LMB_VOLUME_INTERNAL_H

#include <lambent/volume.h>
#include <lambent/volume_format.h>

enum { LMB_BRICK_ROW = LMB_BRICK_POINTS, LMB_BRICK_SLICE = LMB_BRICK_POINTS * LMB_BRICK_POINTS };

struct lmb_volume {
    const uint32_t *directory;
    const lmb_volume_brick *bricks;
    double inverse_spacing;
    double min[3];        /* lattice coordinates */
    double last[3];       /* of the box's last point, relative to min */
    int32_t last_cell[3]; /* >= 0 even where the box is one point thick */
    size_t bricks_along[3];
    double slack; /* lattice units that a float position near a lattice point may be off it */
    float scale;
    lmb_volume_header header;
    void *mapping;     /* NULL when the caller owns the bytes */
    bool is_allocated; /* false when the caller gave the handle's memory */
};

static inline bool lmb_brick_holds(const lmb_volume_brick *brick, uint32_t point)
{
    return brick->probes[point / 64] >> point % 64 & 1u;
}

/* Number of corner `i` (bit 0 is x, 1 is y, 2 is z) among the brick's points, relative to the cell's first. */
static inline uint32_t lmb_brick_corner(uint32_t i)
{
    return (i & 1u) + LMB_BRICK_ROW * (i >> 1 & 1u) + LMB_BRICK_SLICE * (i >> 2);
}

/* Verifies the file in memory wholly and sets header, directory, bricks, last_cell and bricks_along. Needs no memory.
 * @return LMB_ERROR_FORMAT, _TRUNCATED, _VERSION, _CHECKSUM */
lmb_result lmb_volume_verify(const unsigned char *data, size_t size, lmb_volume *volume);

/* Maps a regular file for reading. `path` is UTF-8.
 * @return LMB_ERROR_IO, LMB_ERROR_TRUNCATED (empty) */
lmb_result lmb_volume_map(const char *path, void **mapping, size_t *size);
void lmb_volume_unmap(void *mapping, size_t size);

#endif
