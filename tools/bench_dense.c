#include "bench_dense.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <Imath/half.h>

#include <lambent/half_scale.h>

static const lmb_bench_dense_kernel *kernel_choose(void)
{
#if defined(__x86_64__)
    const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); /* they all have F16C */
    if (has && bench_dense_avx2) {
        return bench_dense_avx2;
    }
#endif
    return &bench_dense_plain;
}

const char *bench_dense_kernel_name(void)
{
    return kernel_choose()->name;
}

static void dense_destroy(void *data)
{
    lmb_bench_dense *const dense = data;
    if (dense) {
        free(dense->fp32);
        free(dense->fp16);
        free(dense);
    }
}

/* A box of one point along an axis gets a second one, without a probe. */
static bool dense_shape(const lmb_lattice *lattice, lmb_bench_dense *dense, size_t *points)
{
    *points = 1;
    dense->inverse_spacing = 1.0f / lattice->spacing;
    for (int axis = 0; axis < 3; ++axis) {
        dense->size[axis] = lattice->size[axis] > 1 ? lattice->size[axis] : 2;
        dense->min[axis] = (float)lattice->min[axis];
        dense->last[axis] = (float)(lattice->size[axis] - 1);
        dense->last_cell[axis] = dense->size[axis] - 2;
        if (*points > ((size_t)1 << 31) / BENCH_DENSE_HALFS / (size_t)dense->size[axis]) {
            return false;
        }
        *points *= (size_t)dense->size[axis];
    }
    return true;
}

/* A power of two that brings all light into the range of halfs. */
static float half_scale_find(const lmb_probes *probes)
{
    float largest = 0.0f;
    for (int32_t probe = 0; probe < probes->count - probes->ghost_count; ++probe) {
        for (int i = 0; i < BENCH_DENSE_FLOATS; ++i) {
            const float value = probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
            largest = fmaxf(largest, fabsf(value));
        }
    }
    return lmb_half_scale(largest);
}

static void dense_fill(const lmb_probes *probes, lmb_bench_dense *dense)
{
    dense->scale = dense->fp32 ? 1.0f : half_scale_find(probes);
    const int32_t *const min = probes->level[0].lattice.min;
    for (int32_t probe = 0; probe < probes->count - probes->ghost_count; ++probe) {
        const int32_t *const point = probes->point[probe];
        const size_t at = (size_t)(point[0] - min[0]) +
                          (size_t)dense->size[0] *
                              ((size_t)(point[1] - min[1]) + (size_t)dense->size[1] * (size_t)(point[2] - min[2]));
        for (size_t i = 0; i < BENCH_DENSE_FLOATS; ++i) {
            const float value = probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
            if (dense->fp32) {
                dense->fp32[at * BENCH_DENSE_FLOATS + i] = value;
            } else {
                dense->fp16[at * BENCH_DENSE_HALFS + i] = imath_float_to_half(value / dense->scale);
            }
        }
    }
}

/* NULL when the box is too large, or out of memory. */
static lmb_bench_dense *dense_make(const lmb_probes *probes, bool half, double *bytes, lmb_result *result)
{
    lmb_bench_dense *const dense = calloc(1, sizeof *dense);
    size_t points;
    *result = LMB_ERROR_MEMORY;
    if (!dense) {
        return NULL;
    }
    if (!dense_shape(&probes->level[0].lattice, dense, &points)) {
        *result = LMB_ERROR_ARGUMENT;
        dense_destroy(dense);
        return NULL;
    }
    size_t size = points * (half ? BENCH_DENSE_HALFS * sizeof(uint16_t) : BENCH_DENSE_FLOATS * sizeof(float));
    *bytes = (double)size;
    size = (size + 16 + 63) / 64 * 64; /* the last point is read beyond its end */
    void *const values = aligned_alloc(64, size);
    if (!values) {
        dense_destroy(dense);
        return NULL;
    }
    memset(values, 0, size);
    if (half) {
        dense->fp16 = values;
    } else {
        dense->fp32 = values;
    }
    dense_fill(probes, dense);
    *result = LMB_OK;
    return dense;
}

lmb_result bench_dense_create(const lmb_probes *probes, lmb_bench_sampler sampler[BENCH_DENSE_SAMPLERS])
{
    const lmb_bench_dense_kernel *const kernel = kernel_choose();
    lmb_result result;
    double bytes[2] = {0.0, 0.0};
    lmb_bench_dense *const fp32 = dense_make(probes, false, &bytes[0], &result);
    lmb_bench_dense *const fp16 = fp32 ? dense_make(probes, true, &bytes[1], &result) : NULL;
    if (!fp16) {
        dense_destroy(fp32);
        return result;
    }
    sampler[0] = (lmb_bench_sampler){"dense.fp32", fp32, bytes[0], kernel->fp32, dense_destroy};
    sampler[1] = (lmb_bench_sampler){"dense.fp32.prefetch", fp32, bytes[0], kernel->fp32_prefetch, NULL};
    sampler[2] = (lmb_bench_sampler){"dense.fp16", fp16, bytes[1], kernel->fp16, dense_destroy};
    sampler[3] = (lmb_bench_sampler){"dense.fp16.prefetch", fp16, bytes[1], kernel->fp16_prefetch, NULL};
    return LMB_OK;
}
