#include "models_spread.h"

#include <math.h>
#include <string.h>

enum { LEAST_EXPONENT = -20, BIN_SHIFT = 23 - 6, LEAST_BITS = (127 + LEAST_EXPONENT) * MODELS_BINS_AN_OCTAVE };

size_t models_bin_of(float error)
{
    uint32_t bits;
    memcpy(&bits, &error, sizeof bits);
    const int bin = (int)(bits >> BIN_SHIFT) - LEAST_BITS + 1;
    return (size_t)(bin < 0 ? 0 : bin < MODELS_BIN_COUNT ? bin : MODELS_BIN_COUNT - 1);
}

/* The lower edge of a bin. */
static double bin_edge(size_t bin)
{
    const double octaves = (double)(bin - 1) / MODELS_BINS_AN_OCTAVE, whole = floor(octaves);
    return bin == 0 ? 0.0 : ldexp(1.0 + octaves - whole, (int)whole + LEAST_EXPONENT);
}

void models_spread_add(models_spread *spread, const uint32_t bin[MODELS_BIN_COUNT])
{
    for (size_t i = 0; i < MODELS_BIN_COUNT; ++i) {
        spread->bin[i] += bin[i];
        spread->count += bin[i];
    }
}

double models_spread_quantile(const models_spread *spread, double share)
{
    const double wanted = share * (double)spread->count;
    double below = 0.0;
    for (size_t i = 0; i + 1 < MODELS_BIN_COUNT; ++i) {
        const double here = (double)spread->bin[i];
        if (here > 0.0 && below + here >= wanted) {
            return bin_edge(i) + (wanted - below) / here * (bin_edge(i + 1) - bin_edge(i));
        }
        below += here;
    }
    return spread->count > 0 ? bin_edge(MODELS_BIN_COUNT - 1) : 0.0;
}

double models_spread_share_over(const models_spread *spread, float value)
{
    const size_t own = models_bin_of(value);
    /* Of the value's own bin, the part above it. */
    const double width = bin_edge(own + 1) - bin_edge(own);
    double over = (double)spread->bin[own] * (bin_edge(own + 1) - (double)value) / width;
    for (size_t i = own + 1; i < MODELS_BIN_COUNT; ++i) {
        over += (double)spread->bin[i];
    }
    return spread->count > 0 ? over / (double)spread->count : 0.0;
}
