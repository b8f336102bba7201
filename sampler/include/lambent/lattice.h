/* Lattice arithmetic, the same for whoever bakes, packs or samples a volume.
 *
 * Point (i, j, k) of a lattice lies at spacing * (i axis[0] + j axis[1] + k axis[2]) in the world, which for the
 * world's own axes is spacing * (i, j, k): lattices of one spacing and one set of axes always line up. */
#ifndef LAMBENT_LATTICE_H
#define LAMBENT_LATTICE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The points min .. min + size - 1 of each axis. */
typedef struct lmb_lattice {
    float spacing; /* metres, > 0 */
    int32_t min[3];
    int32_t size[3]; /* >= 1; min + size - 1 is an int32_t */
    /* Its x, y and z in the world: unit vectors at right angles, right-handed, to within LMB_LATTICE_AXES_ERROR. All
     * zero: the world's own. lmb_lattice_turn sets them. */
    lmb_vec3d axis[3];
} lmb_lattice;

/* A dot product of two axes is so near to 0 or 1: the round trip from 10^6 spacings away is out by some 10^-6 of one.
 */
#define LMB_LATTICE_AXES_ERROR 1e-12

/* Whether its axes are others than the world's. Those of a lattice that is not turned never enter a result. */
static inline bool lmb_lattice_is_turned(const lmb_lattice *lattice)
{
    const lmb_vec3d *const axis = lattice->axis;
    const bool is_diagonal = axis[0].y == 0.0 && axis[0].z == 0.0 && axis[1].x == 0.0 && axis[1].z == 0.0 &&
                             axis[2].x == 0.0 && axis[2].y == 0.0;
    return !is_diagonal || axis[0].x < 0.0 || axis[1].y < 0.0 || axis[2].z < 0.0;
}

/* A vector in the lattice's axes, told in the world's. */
static inline lmb_vec3d lmb_lattice_vector_to_world(const lmb_lattice *lattice, lmb_vec3d v)
{
    const lmb_vec3d *const axis = lattice->axis;
    if (!lmb_lattice_is_turned(lattice)) {
        return v;
    }
    const lmb_vec3d world = {v.x * axis[0].x + v.y * axis[1].x + v.z * axis[2].x,
                             v.x * axis[0].y + v.y * axis[1].y + v.z * axis[2].y,
                             v.x * axis[0].z + v.y * axis[1].z + v.z * axis[2].z};
    return world;
}

/* A vector in the world's axes, told in the lattice's. */
static inline lmb_vec3d lmb_lattice_vector_from_world(const lmb_lattice *lattice, lmb_vec3d v)
{
    const lmb_vec3d *const axis = lattice->axis;
    if (!lmb_lattice_is_turned(lattice)) {
        return v;
    }
    const lmb_vec3d local = {v.x * axis[0].x + v.y * axis[0].y + v.z * axis[0].z,
                             v.x * axis[1].x + v.y * axis[1].y + v.z * axis[1].z,
                             v.x * axis[2].x + v.y * axis[2].y + v.z * axis[2].z};
    return local;
}

/* Turns it: its x axis gets the direction of `x`, its y axis that of what `y` has at right angles to it, its z axis is
 * their cross product. `x` and `y` may be columns of an object's transform, scaled and skewed; 1e-100 to 1e100 long.
 * @return false, and nothing is changed, when they are longer, shorter, not finite, or within 1e-6 of parallel */
static inline bool lmb_lattice_turn(lmb_lattice *lattice, lmb_vec3d x, lmb_vec3d y)
{
    const double x_length = sqrt(x.x * x.x + x.y * x.y + x.z * x.z);
    const double y_length = sqrt(y.x * y.x + y.y * y.y + y.z * y.z);
    if (!(x_length >= 1e-100 && x_length <= 1e100 && y_length >= 1e-100 && y_length <= 1e100)) {
        return false;
    }
    const lmb_vec3d first = {x.x / x_length, x.y / x_length, x.z / x_length};
    lmb_vec3d second = {y.x / y_length, y.y / y_length, y.z / y_length};
    /* Gram-Schmidt; the second pass takes away what rounding left along `first` where they were almost parallel. */
    for (int pass = 0; pass < 2; ++pass) {
        const double along = first.x * second.x + first.y * second.y + first.z * second.z;
        second.x -= along * first.x;
        second.y -= along * first.y;
        second.z -= along * first.z;
        const double length = sqrt(second.x * second.x + second.y * second.y + second.z * second.z);
        if (!(length > 1e-6)) {
            return false;
        }
        second.x /= length;
        second.y /= length;
        second.z /= length;
    }
    lattice->axis[0] = first;
    lattice->axis[1] = second;
    lattice->axis[2].x = first.y * second.z - first.z * second.y;
    lattice->axis[2].y = first.z * second.x - first.x * second.z;
    lattice->axis[2].z = first.x * second.y - first.y * second.x;
    return true;
}

/* World place of a point, metres. */
static inline lmb_vec3d lmb_lattice_position(const lmb_lattice *lattice, const int32_t point[3])
{
    const double spacing = (double)lattice->spacing;
    const lmb_vec3d position = {point[0] * spacing, point[1] * spacing, point[2] * spacing};
    return lmb_lattice_vector_to_world(lattice, position);
}

/* A world place, metres, in lattice coordinates: of a point's place the point, but for rounding where the lattice is
 * turned, or the point is beyond 2^29. */
static inline lmb_vec3d lmb_lattice_coordinates(const lmb_lattice *lattice, lmb_vec3d position)
{
    const double spacing = (double)lattice->spacing;
    lmb_vec3d coordinates = lmb_lattice_vector_from_world(lattice, position);
    coordinates.x /= spacing;
    coordinates.y /= spacing;
    coordinates.z /= spacing;
    return coordinates;
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

/* The cell that a world place lies in, by its first point, and where in it, from 0 up to 1 along each of the lattice's
 * axes. A cell has its low sides and not its high ones; which side of one a turned lattice's point falls on is up to
 * rounding.
 * @return false, and nothing is set, outside of all cells, or for NaN: a lattice one point thick has none */
static inline bool lmb_lattice_cell(const lmb_lattice *lattice, lmb_vec3d position, int32_t cell[3], double fraction[3])
{
    const lmb_vec3d coordinates = lmb_lattice_coordinates(lattice, position);
    const double at[3] = {coordinates.x, coordinates.y, coordinates.z};
    for (int axis = 0; axis < 3; ++axis) {
        const double local = floor(at[axis]) - (double)lattice->min[axis];
        if (!(local >= 0.0 && local + 1.0 < (double)lattice->size[axis])) {
            return false;
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const double below = floor(at[axis]);
        cell[axis] = (int32_t)below;
        fraction[axis] = at[axis] - below;
    }
    return true;
}

#ifdef __cplusplus
}
#endif

#endif
