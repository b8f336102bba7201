/* Linear least squares for light: unknown values of which weighted sums are known. */
#ifndef LMB_TOOLS_LEAKS_FIT_H
#define LMB_TOOLS_LEAKS_FIT_H

#include <stddef.h>
#include <stdint.h>

#include <lambent/result.h>
#include <lambent/sh.h>

/* sum over i of weight[i] x[unknown[i]] = right, for each of the 27 coefficients. */
typedef struct leaks_equation {
    uint32_t unknown[8];
    float weight[8];
    uint32_t count;
    lmb_sh3_rgb right;
} leaks_equation;

/* The unknowns that leave the least sum of squares, by conjugate gradients from 0, which gives the shortest where there
 * are several (Hestenes and Stiefel 1952; "CGLS" of Bjorck 1996). @return LMB_ERROR_MEMORY */
lmb_result leaks_fit(const leaks_equation *equation, size_t equation_count, lmb_sh3_rgb *unknown, size_t unknown_count);

#endif
