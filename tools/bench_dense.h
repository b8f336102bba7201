/* The simplest thing that holds a volume: arrays of all points of its box, probes or none. */
#ifndef LMB_TOOLS_BENCH_DENSE_H
#define LMB_TOOLS_BENCH_DENSE_H

#include <stdint.h>

#include <lambent/probes.h>

#include "bench_sampler.h"

/* fp32, fp16, and both once more with prefetches. */
enum { BENCH_DENSE_SAMPLERS = 4 };

/* Values of a point in the arrays: fp32 without gaps, fp16 a cache line each. */
enum { BENCH_DENSE_FLOATS = 27, BENCH_DENSE_HALFS = 32 };

typedef struct lmb_bench_dense {
    float *fp32;    /* [x + size[0] (y + size[1] z)]; four readable floats follow. NULL: halfs instead */
    uint16_t *fp16; /* the bits of halfs, 64-byte aligned */
    float scale;    /* of what is stored: 1 for floats */
    float inverse_spacing;
    float min[3];         /* lattice coordinates of the first point */
    float last[3];        /* of the last one, from the first */
    int32_t last_cell[3]; /* >= 0 */
    int32_t size[3];      /* points along each axis, >= 2 */
} lmb_bench_dense;

/* What samples such an array, by AVX2, FMA and F16C or without. */
typedef struct lmb_bench_dense_kernel {
    const char *name;
    void (*fp32)(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
    void (*fp32_prefetch)(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
    void (*fp16)(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
    void (*fp16_prefetch)(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
} lmb_bench_dense_kernel;

extern const lmb_bench_dense_kernel bench_dense_plain;
extern const lmb_bench_dense_kernel *const bench_dense_avx2; /* NULL: not built for this processor */

/* Fills the samplers `dense.fp32`, `dense.fp16`, `dense.fp32.prefetch` and `dense.fp16.prefetch` from one level's
 * probes; points without one are 0.
 * @return LMB_ERROR_MEMORY, _ARGUMENT (the box has more than 2^31 values): then there is none */
lmb_result bench_dense_create(const lmb_probes *probes, lmb_bench_sampler sampler[BENCH_DENSE_SAMPLERS]);

/* The kernel that they run on this machine. */
const char *bench_dense_kernel_name(void);

#endif
