/* Halfs that are not negative, by their bits: a scale whose equal steps are, from power of two to power of two, equal
 * shares of the value. */
#ifndef LMB_HALF_CODES_H
#define LMB_HALF_CODES_H

#include <stdint.h>
#include <string.h>

/* The bits of 65504, the largest finite half. */
#define HALF_CODE_MOST 31743

static inline float half_code_value(int32_t code)
{
    if (code < 1024) {
        return (float)code * 0x1p-24f;
    }
    const uint32_t bits = (uint32_t)(code + (112 << 10)) << 13;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The inverse, between codes too, for 0 to 65504. */
static inline float half_code_of(float value)
{
    if (value < 0x1p-14f) {
        return value * 0x1p24f;
    }
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (float)(bits - (112u << 23)) * 0x1p-13f;
}

#endif
