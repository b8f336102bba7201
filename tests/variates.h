/* Variates for the tests that choose at random: the same every time and everywhere. */
#ifndef LMB_TESTS_VARIATES_H
#define LMB_TESTS_VARIATES_H

#include <stdint.h>

/* The next in [0, 1), of 24 bits, so that it stays below 1 as a float: SplitMix64 (Steele et al. 2014). */
static inline double variate_next(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = (*state ^ (*state >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 40) * 0x1p-24;
}

#endif
