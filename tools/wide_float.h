/* Put before everything else that is compiled, makes long doubles of all floats. The system's headers come first, with
 * floats as they are; they are not read again. */
#ifndef LMB_TOOLS_WIDE_FLOAT_H
#define LMB_TOOLS_WIDE_FLOAT_H

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define float long double
#define sqrtf sqrtl
#define fabsf fabsl
#define fmaxf fmaxl
#define fminf fminl
#define sinf sinl
#define cosf cosl
#define acosf acosl
#define atan2f atan2l
#define powf powl
#define expf expl

#define STABILITY_RUN stability_run_wide
#define STABILITY_EXPORT __attribute__((visibility("default")))

#endif
