/* Probe grids with random contents, for the tests of what stores and samples them. */
#ifndef LMB_TESTS_GRID_FIXTURE_H
#define LMB_TESTS_GRID_FIXTURE_H

#include <lambent/grid.h>

#include <stdint.h>
#include <stdlib.h>

/* xorshift64: good enough to fill grids, and the same everywhere. */
static inline double fixture_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-53;
}

/* A grid where a point holds a probe with probability `density`, valid with probability `valid_share`; coefficients
 * are in -magnitude .. magnitude. Aborts when out of memory. */
static inline lmb_grid *fixture_grid(float spacing, const int32_t min[3], const int32_t size[3], double density,
                                     double valid_share, double magnitude, uint64_t seed)
{
    uint64_t state = seed * UINT64_C(0x9e3779b97f4a7c15) + 1;
    lmb_grid *grid = NULL;
    if (lmb_grid_create(spacing, min, size, &grid) != LMB_OK) {
        abort();
    }
    const size_t points = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    uint8_t *const wanted = malloc(points);
    if (!wanted) {
        abort();
    }
    for (size_t i = 0; i < points; ++i) {
        wanted[i] = fixture_random(&state) < density;
    }
    if (lmb_grid_add_probes(grid, wanted) != LMB_OK) {
        abort();
    }
    free(wanted);
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        const double draw = fixture_random(&state);
        grid->validity[probe] = (float)(fixture_random(&state) < valid_share ? 0.5 + 0.5 * draw : 0.49 * draw);
        for (int i = 0; i < 27; ++i) {
            grid->radiance[probe].channel[i / 9].c[i % 9] = (float)((2.0 * fixture_random(&state) - 1.0) * magnitude);
        }
    }
    return grid;
}

#endif
