/* Light in four bytes a texel, as rivals store it, and numbers in one: what comes back. */
#ifndef LMB_TOOLS_TEXTURES_EIGHT_BITS_H
#define LMB_TOOLS_TEXTURES_EIGHT_BITS_H

#include <stddef.h>

typedef enum eight_bits {
    EIGHT_BITS_MULTIPLIER,     /* RGBM8: RGB in 8 bits times a multiplier in 8 bits, up to the image's brightest */
    EIGHT_BITS_SHARED_EXPONENT /* RGBE9995: three mantissas of 9 bits with one exponent of 5 */
} eight_bits;

/* Of three planes of `texels`, one after the other. */
void eight_bits_light(eight_bits kind, float *planes, size_t texels);

/* Numbers in a range as one byte each. */
void eight_bits_range(float *values, size_t count, float low, float high);

/* A half. */
float half_rounded(float value);

#endif
