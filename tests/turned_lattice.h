/* Random turned lattices and, apart from the library's own arithmetic, the rotations that they are turned by. */
#ifndef LMB_TESTS_TURNED_LATTICE_H
#define LMB_TESTS_TURNED_LATTICE_H

#include <math.h>
#include <stdlib.h>

#include <lambent/lattice.h>

#include "probes_fixture.h"

/* world = m local */
typedef struct rotation {
    double m[3][3];
} rotation;

/* About a random axis by a random angle, after Rodrigues: cos I + sin [a] + (1 - cos) a a^T. */
static inline rotation rotation_random(uint64_t *state)
{
    const double z = 2.0 * fixture_random(state) - 1.0, around = 6.283185307179586 * fixture_random(state);
    const double a[3] = {sqrt(1.0 - z * z) * cos(around), sqrt(1.0 - z * z) * sin(around), z};
    const double angle = 0.1 + 2.9 * fixture_random(state), c = cos(angle), s = sin(angle);
    const double cross[3][3] = {{0.0, -a[2], a[1]}, {a[2], 0.0, -a[0]}, {-a[1], a[0], 0.0}};
    rotation turn;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            turn.m[row][column] = (row == column ? c : 0.0) + s * cross[row][column] + (1.0 - c) * a[row] * a[column];
        }
    }
    return turn;
}

/* Lattice coordinates in the world. */
static inline lmb_vec3d rotation_place(const rotation *turn, double spacing, lmb_vec3d local)
{
    double world[3];
    for (int row = 0; row < 3; ++row) {
        world[row] = spacing * (turn->m[row][0] * local.x + turn->m[row][1] * local.y + turn->m[row][2] * local.z);
    }
    return (lmb_vec3d){world[0], world[1], world[2]};
}

static inline lmb_vec3d rotation_point(const rotation *turn, double spacing, const int32_t point[3])
{
    return rotation_place(turn, spacing, (lmb_vec3d){point[0], point[1], point[2]});
}

static inline double places_distance(lmb_vec3d a, lmb_vec3d b)
{
    const double x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrt(x * x + y * y + z * z);
}

/* A lattice of 64 points a side, turned by a random rotation; it is told by columns that are scaled and skewed. */
static inline lmb_lattice turned_lattice(uint64_t *state, float spacing, rotation *turn)
{
    *turn = rotation_random(state);
    const double scale_x = 0.01 + 9.0 * fixture_random(state), scale_y = 0.01 + 9.0 * fixture_random(state);
    const double skew = 4.0 * fixture_random(state) - 2.0;
    double x[3], y[3];
    for (int row = 0; row < 3; ++row) {
        x[row] = scale_x * turn->m[row][0];
        y[row] = scale_y * (turn->m[row][1] + skew * turn->m[row][0]);
    }
    lmb_lattice lattice = {.spacing = spacing, .min = {-32, -32, -32}, .size = {64, 64, 64}};
    if (!lmb_lattice_turn(&lattice, (lmb_vec3d){x[0], x[1], x[2]}, (lmb_vec3d){y[0], y[1], y[2]})) {
        abort();
    }
    return lattice;
}

#endif
