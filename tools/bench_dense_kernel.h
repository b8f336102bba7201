/* Sampling dense arrays, once for each instruction set: a file that includes this has defined blend_fp32 and
 * blend_fp16, weighted sums over the eight corners of a cell. */
#ifndef LMB_TOOLS_BENCH_DENSE_KERNEL_H
#define LMB_TOOLS_BENCH_DENSE_KERNEL_H

#include "bench_dense.h"

/* How many samples ahead is asked for, and how many are kept on the way; a power of two beyond it. */
enum { DENSE_AHEAD = 12, DENSE_RING = 16 };

typedef struct dense_place {
    size_t first; /* point */
    float t[3];
} dense_place;

static inline dense_place dense_locate(const lmb_bench_dense *dense, lmb_vec3 position)
{
    const float in[3] = {position.x, position.y, position.z};
    int32_t cell[3];
    dense_place place;
    for (int axis = 0; axis < 3; ++axis) {
        const float at = in[axis] * dense->inverse_spacing - dense->min[axis];
        const float clamped = at > 0.0f ? (at < dense->last[axis] ? at : dense->last[axis]) : 0.0f;
        const int32_t whole = (int32_t)clamped;
        cell[axis] = whole < dense->last_cell[axis] ? whole : dense->last_cell[axis];
        place.t[axis] = clamped - (float)cell[axis];
    }
    place.first =
        (size_t)cell[0] + (size_t)dense->size[0] * ((size_t)cell[1] + (size_t)dense->size[1] * (size_t)cell[2]);
    return place;
}

static inline void dense_weights(const float t[3], float scale, float weight[8])
{
    const float u[2] = {1.0f - t[0], t[0]}, v[2] = {1.0f - t[1], t[1]}, w[2] = {scale * (1.0f - t[2]), scale * t[2]};
    for (unsigned i = 0; i < 8; ++i) {
        weight[i] = u[i & 1u] * v[i >> 1 & 1u] * w[i >> 2];
    }
}

/* The four rows of two neighbouring points each that a cell has. */
static inline void dense_rows(const lmb_bench_dense *dense, const dense_place *place, size_t row[4])
{
    const size_t across = (size_t)dense->size[0], layer = across * (size_t)dense->size[1];
    row[0] = place->first;
    row[1] = place->first + across;
    row[2] = place->first + layer;
    row[3] = place->first + layer + across;
}

static inline void dense_blend(const lmb_bench_dense *dense, const dense_place *place, int half, lmb_sh3_rgb *radiance)
{
    size_t row[4];
    float weight[8];
    dense_rows(dense, place, row);
    dense_weights(place->t, dense->scale, weight);
    if (half) {
        blend_fp16(dense->fp16, row, weight, radiance);
    } else {
        blend_fp32(dense->fp32, row, weight, radiance);
    }
}

static inline void dense_prefetch(const lmb_bench_dense *dense, const dense_place *place, int half)
{
    size_t row[4];
    dense_rows(dense, place, row);
    for (int i = 0; i < 4; ++i) {
        if (half) {
            const uint16_t *const at = dense->fp16 + row[i] * BENCH_DENSE_HALFS;
            __builtin_prefetch(at);
            __builtin_prefetch(at + BENCH_DENSE_HALFS);
        } else {
            const float *const at = dense->fp32 + row[i] * BENCH_DENSE_FLOATS;
            __builtin_prefetch(at);
            __builtin_prefetch(at + 16);
            __builtin_prefetch(at + 32);
            __builtin_prefetch(at + 48);
            __builtin_prefetch(at + 2 * BENCH_DENSE_FLOATS - 1);
        }
    }
}

static inline void dense_run(const lmb_bench_dense *dense, const lmb_vec3 *position, size_t count,
                             lmb_sh3_rgb *radiance, int half)
{
    for (size_t i = 0; i < count; ++i) {
        const dense_place place = dense_locate(dense, position[i]);
        dense_blend(dense, &place, half, &radiance[i]);
    }
}

static inline void dense_run_ahead(const lmb_bench_dense *dense, const lmb_vec3 *position, size_t count,
                                   lmb_sh3_rgb *radiance, int half)
{
    dense_place ring[DENSE_RING];
    for (size_t i = 0; i < count + DENSE_AHEAD; ++i) {
        if (i < count) {
            ring[i % DENSE_RING] = dense_locate(dense, position[i]);
            dense_prefetch(dense, &ring[i % DENSE_RING], half);
        }
        if (i >= DENSE_AHEAD) {
            dense_blend(dense, &ring[(i - DENSE_AHEAD) % DENSE_RING], half, &radiance[i - DENSE_AHEAD]);
        }
    }
}

static void sample_fp32(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    dense_run(dense, position, count, radiance, 0);
}

static void sample_fp32_prefetch(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    dense_run_ahead(dense, position, count, radiance, 0);
}

static void sample_fp16(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    dense_run(dense, position, count, radiance, 1);
}

static void sample_fp16_prefetch(const void *dense, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance)
{
    dense_run_ahead(dense, position, count, radiance, 1);
}

#define BENCH_DENSE_KERNEL(what)                                                                                       \
    {                                                                                                                  \
        .name = what, .fp32 = sample_fp32, .fp32_prefetch = sample_fp32_prefetch, .fp16 = sample_fp16,                 \
        .fp16_prefetch = sample_fp16_prefetch                                                                          \
    }

#endif
