/* Dense arrays in plain C. */
#include "bench_dense.h"

#include <string.h>

static inline void blend_fp32(const float *values, const size_t row[4], const float weight[8], lmb_sh3_rgb *radiance)
{
    float sum[BENCH_DENSE_FLOATS] = {0.0f};
    for (unsigned i = 0; i < 8; ++i) {
        const float *const at = values + (row[i >> 1] + (i & 1u)) * BENCH_DENSE_FLOATS;
        for (int k = 0; k < BENCH_DENSE_FLOATS; ++k) {
            sum[k] += weight[i] * at[k];
        }
    }
    memcpy(radiance, sum, sizeof *radiance);
}

/* The bits of a finite half, moved to their places in a float, are its value times 2^-112. */
static inline float half_bits_as_float(uint16_t half)
{
    const uint32_t bits = (uint32_t)(half & 0x7fffu) << 13 | (uint32_t)(half & 0x8000u) << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline void blend_fp16(const uint16_t *values, const size_t row[4], const float weight[8], lmb_sh3_rgb *radiance)
{
    float sum[BENCH_DENSE_HALFS] = {0.0f};
    for (unsigned i = 0; i < 8; ++i) {
        const uint16_t *const at = values + (row[i >> 1] + (i & 1u)) * BENCH_DENSE_HALFS;
        for (int k = 0; k < BENCH_DENSE_HALFS; ++k) {
            sum[k] += weight[i] * 0x1p112f * half_bits_as_float(at[k]);
        }
    }
    memcpy(radiance, sum, sizeof *radiance);
}

#include "bench_dense_kernel.h"

const lmb_bench_dense_kernel bench_dense_plain = BENCH_DENSE_KERNEL("plain C");
