/* How relative errors spread, counted in narrow bins, so that threads can count apart. */
#ifndef LMB_TOOLS_MODELS_SPREAD_H
#define LMB_TOOLS_MODELS_SPREAD_H

#include <stddef.h>
#include <stdint.h>

/* Errors from 2^-20 to 2^5, 64 bins an octave by the leading bits of the float, with one bin for what is smaller and
 * one for what is larger. */
enum { MODELS_BINS_AN_OCTAVE = 64, MODELS_OCTAVES = 25, MODELS_BIN_COUNT = MODELS_BINS_AN_OCTAVE * MODELS_OCTAVES + 2 };

/* The bin of an error >= 0. */
size_t models_bin_of(float error);

typedef struct models_spread {
    uint64_t bin[MODELS_BIN_COUNT];
    uint64_t count;
} models_spread;

void models_spread_add(models_spread *spread, const uint32_t bin[MODELS_BIN_COUNT]);

/* The value that a share of all stay below, bins taken as filled evenly; 0 of none. */
double models_spread_quantile(const models_spread *spread, double share);

/* The share that is above a value. */
double models_spread_share_over(const models_spread *spread, float value);

#endif
