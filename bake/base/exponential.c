#include "base/exponential.h"

#include <math.h>

/* log 2 in two parts (Cody and Waite 1980): multiples of the first up to 2^20 are exact. */
static const double LOG2_HIGH = 0x1.62e42fee00000p-1;
static const double LOG2_LOW = 0x1.a39ef35793c76p-33;

double lmb_exp(double x)
{
    if (!(x > -746.0)) {
        return x <= -746.0 ? 0.0 : x; /* NaN stays */
    }
    if (x > 710.0) {
        return (double)INFINITY;
    }
    const double twos = floor(x * (1.0 / 0.69314718055994530942) + 0.5);
    const double rest = (x - twos * LOG2_HIGH) - twos * LOG2_LOW;
    /* Taylor series: at |rest| <= log(2)/2 the next term is below 5e-18. */
    double sum = 1.0;
    for (int k = 13; k >= 1; --k) {
        sum = 1.0 + sum * rest / (double)k;
    }
    return ldexp(sum, (int)twos);
}

double lmb_log(double x)
{
    int twos;
    double part = frexp(x, &twos);
    if (part < 0.70710678118654752440) {
        part *= 2.0;
        --twos;
    }
    /* log((1+s)/(1-s)) = 2 (s + s^3/3 + ...): at |s| <= 0.172 the next term is below 1e-18. */
    const double s = (part - 1.0) / (part + 1.0);
    double sum = 0.0;
    for (int k = 11; k >= 1; --k) {
        sum = (sum + 1.0 / (double)(2 * k + 1)) * s * s;
    }
    return (double)twos * LOG2_HIGH + ((double)twos * LOG2_LOW + 2.0 * s * (1.0 + sum));
}
