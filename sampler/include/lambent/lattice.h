/* Lattice and brick arithmetic, the same for whoever bakes, packs or samples a volume.
 *
 * Point (i, j, k) of a lattice lies at (i, j, k) * spacing in the world, so that lattices of one spacing always line
 * up. Points are stored in bricks of 4 x 4 x 4 cells with all their corners, 5 x 5 x 5 points
 * (lambent/volume_format.h). */
#ifndef LAMBENT_LATTICE_H
#define LAMBENT_LATTICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/types.h>
#include <lambent/volume_format.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The points min .. min + size - 1 of each axis. */
typedef struct lmb_lattice {
    float spacing; /* metres, > 0 */
    int32_t min[3];
    int32_t size[3]; /* >= 1; min + size - 1 is an int32_t */
} lmb_lattice;

/* World place of a point, metres. */
static inline lmb_vec3d lmb_lattice_position(const lmb_lattice *lattice, const int32_t point[3])
{
    const double spacing = (double)lattice->spacing;
    const lmb_vec3d position = {point[0] * spacing, point[1] * spacing, point[2] * spacing};
    return position;
}

static inline bool lmb_lattice_has(const lmb_lattice *lattice, const int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t local = (int64_t)point[axis] - lattice->min[axis];
        if (local < 0 || local >= lattice->size[axis]) {
            return false;
        }
    }
    return true;
}

/* Bricks along an axis: every cell has one, and a lattice one point thick still has its points. */
static inline size_t lmb_lattice_bricks_along(int32_t size)
{
    const size_t cells = size > 1 ? (size_t)size - 1 : 1;
    return (cells + LMB_BRICK_CELLS - 1) / LMB_BRICK_CELLS;
}

/* Number of a brick in the directory, of `bricks` along each axis. */
static inline size_t lmb_lattice_brick(const size_t bricks[3], size_t x, size_t y, size_t z)
{
    return x + bricks[0] * (y + bricks[1] * z);
}

/* Numbers of a point and a cell within their brick. */
static inline unsigned lmb_brick_point(unsigned x, unsigned y, unsigned z)
{
    return x + LMB_BRICK_POINTS * (y + LMB_BRICK_POINTS * z);
}

static inline unsigned lmb_brick_cell(unsigned x, unsigned y, unsigned z)
{
    return x + LMB_BRICK_CELLS * (y + LMB_BRICK_CELLS * z);
}

/* Whether a brick holds a probe at a point. */
static inline bool lmb_brick_holds(const lmb_volume_brick *brick, unsigned point)
{
    return (brick->probes[point / 64] >> point % 64 & 1u) != 0;
}

/* How far corner 0 .. 7 of a cell (bit 0 is x, 1 is y, 2 is z) is from its first among the brick's points. */
static inline unsigned lmb_brick_corner(unsigned corner)
{
    return lmb_brick_point(corner & 1u, corner >> 1 & 1u, corner >> 2);
}

#ifdef __cplusplus
}
#endif

#endif
