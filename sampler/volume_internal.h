/* The open volume, and the steps of opening one: map the file, verify it, derive what sampling needs. */
#ifndef LMB_VOLUME_INTERNAL_H
#define LMB_VOLUME_INTERNAL_H

#include <lambent/lattice.h>
#include <lambent/volume.h>

#include "volume_kernel.h"

/* A cell of the lattice by its first point, and where in it a position is, 0 to 1. */
typedef struct lmb_cell {
    uint32_t at[3];
    float t[4]; /* the last is anything finite */
} lmb_cell;

/* Fields of three axes have a fourth one, 0, where kernels read four at once. */
struct lmb_volume {
    const lmb_volume_kernel *kernel;
    const uint32_t *directory;
    const unsigned char *bricks; /* each with what follows it */
    size_t brick_stride;
    const lmb_volume_keys *keys; /* NULL: none */
    double inverse_spacing;
    double slack;         /* lattice units that a float position near a lattice point may be off it */
    double min[4];        /* lattice coordinates */
    double last[4];       /* of the box's last point, relative to min */
    double nearest[4];    /* that counts as inside: -slack, */
    double farthest[4];   /* to last + slack */
    int32_t last_cell[4]; /* >= 0 even where the box is one point thick */
    size_t bricks_along[3];
    size_t brick_step[2]; /* directory entries from a brick to the next one along y and z */
    float scale;
    lmb_volume_header header;
    void *mapping;     /* NULL when the caller owns the bytes */
    bool is_allocated; /* false when the caller gave the handle's memory */
};

static inline const lmb_volume_brick *lmb_volume_brick_at(const lmb_volume *volume, uint32_t index)
{
    return (const lmb_volume_brick *)(volume->bricks + index * volume->brick_stride);
}

/* Of each key light, from the brick itself on. */
static inline const lmb_brick_visibility *lmb_volume_brick_visibility(const lmb_volume_brick *brick)
{
    return (const lmb_brick_visibility *)(brick + 1);
}

/* Verifies the file in memory wholly and sets header, keys, directory, bricks, last_cell and bricks_along. Needs no
 * memory.
 * @return LMB_ERROR_FORMAT, _TRUNCATED, _VERSION, _CHECKSUM */
lmb_result lmb_volume_verify(const unsigned char *data, size_t size, lmb_volume *volume);

/* Maps a regular file for reading. `path` is UTF-8.
 * @return LMB_ERROR_IO, LMB_ERROR_TRUNCATED (empty) */
lmb_result lmb_volume_map(const char *path, void **mapping, size_t *size);
void lmb_volume_unmap(void *mapping, size_t size);

#endif
