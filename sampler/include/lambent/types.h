/* Plain values that every part of Lambent shares.
 *
 * World space is glTF's: right-handed, +Y up, metres. Colours are linear, Rec. 709 primaries. */
#ifndef LAMBENT_TYPES_H
#define LAMBENT_TYPES_H

#include <float.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A point (metres), a direction (unit length where a function says so) or a normal, in world space. */
typedef struct lmb_vec3 {
    float x, y, z;
} lmb_vec3;

/* A point of the world in metres, for points so far out that floats are too coarse. */
typedef struct lmb_vec3d {
    double x, y, z;
} lmb_vec3d;

/* Linear red, green, blue. An array, so that per-channel work is a loop. */
typedef struct lmb_rgb {
    float c[3];
} lmb_rgb;

/* Light fit for a shader: in [0, FLT_MAX], NaN gives 0. */
static inline float lmb_light_clamped(float light)
{
    return light > 0.0f ? (light < FLT_MAX ? light : FLT_MAX) : 0.0f;
}

/* Rec. 709 luminance of a linear colour. */
static inline float lmb_luminance(lmb_rgb colour)
{
    return 0.2126f * colour.c[0] + 0.7152f * colour.c[1] + 0.0722f * colour.c[2];
}

#ifdef __cplusplus
}
#endif

#endif
