/* Probes with random contents, for the tests of what stores and samples them. */
#ifndef LMB_TESTS_PROBES_FIXTURE_H
#define LMB_TESTS_PROBES_FIXTURE_H

#include <lambent/probes.h>

#include <stdint.h>
#include <stdlib.h>

/* xorshift64: good enough to fill probes, and the same everywhere. */
static inline double fixture_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return (double)(*state >> 11) * 0x1p-53;
}

/* Probes at the wanted points of a box, [x + size[0] (y + size[1] z)], x fastest; NULL: all of them. NULL when that
 * cannot be. */
static inline lmb_probes *fixture_probes(const lmb_lattice *lattice, const uint8_t *wanted)
{
    const size_t points = (size_t)lattice->size[0] * (size_t)lattice->size[1] * (size_t)lattice->size[2];
    int32_t(*const point)[3] = malloc(points * sizeof *point);
    int32_t count = 0;
    for (size_t i = 0; point && i < points; ++i) {
        if (!wanted || wanted[i]) {
            const size_t width = (size_t)lattice->size[0], height = (size_t)lattice->size[1];
            point[count][0] = lattice->min[0] + (int32_t)(i % width);
            point[count][1] = lattice->min[1] + (int32_t)(i / width % height);
            point[count][2] = lattice->min[2] + (int32_t)(i / width / height);
            ++count;
        }
    }
    lmb_probes *probes = NULL;
    if (point && lmb_probes_create(&probes) == LMB_OK &&
        lmb_probes_add_level(probes, lattice, (const int32_t(*)[3])point, count) != LMB_OK) {
        lmb_probes_destroy(probes);
        probes = NULL;
    }
    free(point);
    return probes;
}

/* A point of the box holds a probe with probability `density`, valid with probability `valid_share`; coefficients
 * are in -magnitude .. magnitude. Aborts when out of memory. */
static inline lmb_probes *fixture_random_probes(const lmb_lattice *lattice, double density, double valid_share,
                                                double magnitude, uint64_t seed)
{
    uint64_t state = seed * UINT64_C(0x9e3779b97f4a7c15) + 1;
    const size_t points = (size_t)lattice->size[0] * (size_t)lattice->size[1] * (size_t)lattice->size[2];
    uint8_t *const wanted = malloc(points);
    if (!wanted) {
        abort();
    }
    for (size_t i = 0; i < points; ++i) {
        wanted[i] = fixture_random(&state) < density;
    }
    lmb_probes *const probes = fixture_probes(lattice, wanted);
    if (!probes) {
        abort();
    }
    free(wanted);
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const double draw = fixture_random(&state);
        probes->validity[probe] = (float)(fixture_random(&state) < valid_share ? 0.5 + 0.5 * draw : 0.49 * draw);
        for (int i = 0; i < 27; ++i) {
            probes->radiance[0][probe].channel[i / 9].c[i % 9] =
                (float)((2.0 * fixture_random(&state) - 1.0) * magnitude);
        }
    }
    return probes;
}

#endif
