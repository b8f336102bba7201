#include "textures_eight_bits.h"

#include <math.h>

static float byte_rounded(float share)
{
    return (float)floor(255.0 * fmin(fmax((double)share, 0.0), 1.0) + 0.5) / 255.0f;
}

static void multiplier_store(float *planes, size_t texels)
{
    float brightest = 1e-30f;
    for (size_t i = 0; i < 3 * texels; ++i) {
        brightest = fmaxf(brightest, planes[i]);
    }
    for (size_t i = 0; i < texels; ++i) {
        const float largest = fmaxf(fmaxf(planes[i], planes[texels + i]), planes[2 * texels + i]);
        const float multiplier = fmaxf(ceilf(255.0f * largest / brightest), 1.0f) / 255.0f * brightest;
        for (size_t c = 0; c < 3; ++c) {
            planes[c * texels + i] = multiplier * byte_rounded(planes[c * texels + i] / multiplier);
        }
    }
}

/* As EXT_texture_shared_exponent has it: mantissas of 9 bits below 1, the exponent biased by 15. */
static void exponent_store(float *planes, size_t texels)
{
    for (size_t i = 0; i < texels; ++i) {
        const float largest = fmaxf(fmaxf(planes[i], planes[texels + i]), planes[2 * texels + i]);
        int exponent = -15;
        if (largest > 0x1p-16f) {
            frexp((double)largest, &exponent);
        }
        if (ldexp((double)largest, 9 - exponent) >= 511.5) {
            ++exponent;
        }
        for (size_t c = 0; c < 3; ++c) {
            const double mantissa = floor(ldexp((double)planes[c * texels + i], 9 - exponent) + 0.5);
            planes[c * texels + i] = (float)ldexp(mantissa, exponent - 9);
        }
    }
}

void eight_bits_light(eight_bits kind, float *planes, size_t texels)
{
    if (kind == EIGHT_BITS_MULTIPLIER) {
        multiplier_store(planes, texels);
    } else {
        exponent_store(planes, texels);
    }
}

void eight_bits_range(float *values, size_t count, float low, float high)
{
    for (size_t i = 0; i < count; ++i) {
        values[i] = low + (high - low) * byte_rounded((values[i] - low) / (high - low));
    }
}

float half_rounded(float value)
{
    int exponent = 0;
    frexp((double)value, &exponent);
    const int last = exponent - 11 > -24 ? exponent - 11 : -24;
    return (float)ldexp(nearbyint(ldexp((double)value, -last)), last);
}
