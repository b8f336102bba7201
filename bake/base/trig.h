/* Repeatable trigonometry: the same bits on every machine, which libm's has not. */
#ifndef LMB_TRIG_H
#define LMB_TRIG_H

#include <math.h>
#include <stdint.h>

#include <lambent/vector.h>

/* Sine and cosine of `angle_rad` (|angle| below 1e6), within 4e-16 of the truth, and the same bits on every machine,
 * which libm's are not. */
void lmb_sincos(double angle_rad, double *sine, double *cosine);

/* Angle of (x, y), of any length but 0, from +x towards +y in radians, in (-pi, pi], within 1e-15. */
double lmb_angle_of(double x, double y);

/* Sine and cosine of 2 pi turns, turns in [0, 1), within 2e-7: the nearest quarter is taken off, and for the rest, at
 * most pi/4, the Taylor series end below that. */
static inline void lmb_turn_sincos(float turns, float *sine, float *cosine)
{
    const int32_t quarter = (int32_t)(turns * 4.0f + 0.5f);
    const float x = (turns - (float)quarter * 0.25f) * (2.0f * LMB_PI_F);
    const float s2 = x * x;
    const float s =
        x * (1.0f - s2 * (1.0f / 6.0f - s2 * (1.0f / 120.0f - s2 * (1.0f / 5040.0f - s2 * (1.0f / 362880.0f)))));
    const float c = 1.0f - s2 * (0.5f - s2 * (1.0f / 24.0f - s2 * (1.0f / 720.0f - s2 * (1.0f / 40320.0f))));
    const float swapped_s = quarter & 1 ? c : s;
    const float swapped_c = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -swapped_s : swapped_s;
    *cosine = (quarter + 1) & 2 ? -swapped_c : swapped_c;
}

/* Angle of (x, y) from +x towards +y in turns, in (-1/2, 1/2], within 4e-7: a half-angle step leaves at most tan(pi/8)
 * for the series. (0, 0) gives 0. */
static inline float lmb_turn_of(float x, float y)
{
    const float ax = fabsf(x), ay = fabsf(y);
    const float larger = ax > ay ? ax : ay;
    const float smaller = ax > ay ? ay : ax;
    const float sum = larger + sqrtf(larger * larger + smaller * smaller);
    const float t = sum > 0.0f ? smaller / sum : 0.0f;
    const float s = t * t;
    const float series =
        1.0f - s * (1.0f / 3.0f - s * (1.0f / 5.0f - s * (1.0f / 7.0f - s * (1.0f / 9.0f - s * (1.0f / 11.0f)))));
    const float eighth = t * series * (1.0f / LMB_PI_F); /* twice the half angle, in turns */
    const float quarter = ax > ay ? eighth : 0.25f - eighth;
    const float half = x < 0.0f ? 0.5f - quarter : quarter;
    return y < 0.0f ? -half : half;
}

#endif
