/* Linear light to bytes that a screen shows. */
#ifndef LMB_TOOLS_TONEMAP_H
#define LMB_TOOLS_TONEMAP_H

#include <stddef.h>
#include <stdint.h>

/* Exposure value that brings the log-average luminance of the lit pixels to a middle grey of 0.18; 0 for a picture
 * without light. `rgb`: 3 floats a pixel. */
float exposure_of_picture(const float *rgb, size_t pixel_count);

/* Display-linear value in [0, 1] of exposed light: straight in the dark, a shoulder towards white at 6 (Reinhard et al.
 * 2002, "Photographic Tone Reproduction", eq. 4). Never falls; NaN gives 0. */
float tone_curve(float light);

/* sRGB byte of a display-linear value, rounded. */
uint8_t srgb_of_linear(float linear);

/* sRGB bytes of a picture exposed by 2^`exposure_ev`. */
void picture_tonemap(const float *rgb, size_t pixel_count, float exposure_ev, uint8_t *srgb);

/* False colour of signed differences: white for none, red for `full` and more, blue for -`full` and less, by
 * luminance. */
void picture_difference_colour(const float *rgb, size_t pixel_count, float full, uint8_t *srgb);

#endif
