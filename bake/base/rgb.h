/* Colours. */
#ifndef LMB_RGB_H
#define LMB_RGB_H

#include <math.h>
#include <stdbool.h>

#include <lambent/types.h>

static inline lmb_rgb rgb(float r, float g, float b)
{
    const lmb_rgb c = {{r, g, b}};
    return c;
}

static inline lmb_rgb rgb_mul(lmb_rgb a, lmb_rgb b)
{
    return rgb(a.c[0] * b.c[0], a.c[1] * b.c[1], a.c[2] * b.c[2]);
}

static inline lmb_rgb rgb_scale(lmb_rgb a, float s)
{
    return rgb(a.c[0] * s, a.c[1] * s, a.c[2] * s);
}

static inline lmb_rgb rgb_add(lmb_rgb a, lmb_rgb b)
{
    return rgb(a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]);
}

static inline float rgb_max(lmb_rgb a)
{
    const float larger = a.c[0] > a.c[1] ? a.c[0] : a.c[1];
    return larger > a.c[2] ? larger : a.c[2];
}

static inline bool rgb_is_finite(lmb_rgb a)
{
    return isfinite(a.c[0]) && isfinite(a.c[1]) && isfinite(a.c[2]);
}

#endif
