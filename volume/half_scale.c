#include <lambent/half_scale.h>

#include <math.h>

enum { STORED_EXPONENT = 15, LEAST_EXPONENT = -96 };

float lmb_half_scale(float largest)
{
    if (largest == 0.0f || (largest >= 0.0625f && largest <= LMB_HALF_MAX)) {
        return 1.0f;
    }
    int exponent;
    frexpf(largest, &exponent); /* largest = m 2^exponent, m in [1/2, 1) */
    exponent -= STORED_EXPONENT;
    return ldexpf(1.0f, exponent > LEAST_EXPONENT ? exponent : LEAST_EXPONENT);
}
