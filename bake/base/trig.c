#include "base/trig.h"

#include <math.h>

/* Taylor series: at |x| <= pi/4 the next terms are below 2e-17. */
static double sine_series(double x)
{
    const double s = x * x;
    double sum = 0.0;
    for (int k = 8; k >= 1; --k) {
        sum = -(1.0 + sum) * s / (double)((2 * k) * (2 * k + 1));
    }
    return x * (1.0 + sum);
}

static double cosine_series(double x)
{
    const double s = x * x;
    double sum = 0.0;
    for (int k = 8; k >= 1; --k) {
        sum = -(1.0 + sum) * s / (double)((2 * k - 1) * (2 * k));
    }
    return 1.0 + sum;
}

void lmb_sincos(double angle_rad, double *sine, double *cosine)
{
    /* pi/2 in two parts (Cody and Waite 1980), so that the reduction keeps its last bits. */
    const double half_pi_high = 0x1.921fb54400000p+0;
    const double half_pi_low = 0x1.0b4611a626331p-34;
    const double turns = floor(angle_rad * (2.0 / LMB_PI) + 0.5);
    const double x = (angle_rad - turns * half_pi_high) - turns * half_pi_low;
    const double s = sine_series(x);
    const double c = cosine_series(x);
    switch ((int64_t)turns & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
        break;
    }
}

double lmb_angle_of(double x, double y)
{
    const double length = sqrt(x * x + y * y);
    const double rough = 2.0 * LMB_PI * (double)lmb_turn_of((float)(x / length), (float)(y / length));
    double sine, cosine;
    lmb_sincos(rough, &sine, &cosine);
    return rough + (y * cosine - x * sine) / length; /* the sine of what is missing, at most 3e-6 */
}
