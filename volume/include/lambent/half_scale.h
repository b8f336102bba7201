/* Light in half floats: the range is brought to the values before they are stored. */
#ifndef LAMBENT_HALF_SCALE_H
#define LAMBENT_HALF_SCALE_H

#ifdef __cplusplus
extern "C" {
#endif

/* The largest finite half. */
#define LMB_HALF_MAX 65504.0f

/* The power of two to divide by: 1 while `largest`, the largest absolute value, is 0 or in 2^-4 .. 65504 (below 6e-5
 * halfs lose precision), else what brings it into 2^14 .. 2^15; at least 2^-96. */
float lmb_half_scale(float largest);

#ifdef __cplusplus
}
#endif

#endif
