/* Sampling in plain C: what every processor runs, and what the others are held against. */
#include "volume_kernel.h"

#include "volume_locate.h"

#include <string.h>

/* Halfs read at once from a probe: its 27 and 5 of what follows, so that the loop has a round number of turns. */
enum { LANES = 32 };

/* The bits of finite halfs, moved to their places in floats, are their values times 2^-112 (denormals too). */
static inline void halfs_expand(const unsigned char *probe, float value[LANES])
{
    uint16_t half[LANES];
    uint32_t bits[LANES];
    memcpy(half, probe, sizeof half);
    for (int k = 0; k < LANES; ++k) {
        const uint32_t wide = half[k];
        bits[k] = (wide & 0x7fffu) << 13 | (wide & 0x8000u) << 16;
    }
    memcpy(value, bits, sizeof bits);
}

/* Weighted sum over the corners. A weight of 0 is harmless: every stored half is finite. In loops so plain that
 * compilers find them to be vectors. */
static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    float sum[LANES] = {0.0f}, weight[8];
    weights_store(at, weight);
    for (uint32_t i = 0; i < 8; i += 2) {
        const float weight_a = weight[i] * 0x1p112f;
        const float weight_b = weight[i + 1] * 0x1p112f;
        float a[LANES], b[LANES];
        halfs_expand(corner[i], a);
        halfs_expand(corner[i + 1], b);
        for (int k = 0; k < LANES; ++k) {
            const float pair = weight_a * a[k] + weight_b * b[k];
            sum[k] = i == 0 ? pair : sum[k] + pair;
        }
    }
    for (int k = 0; k < LANES; ++k) {
        sum[k] *= scale;
    }
    memcpy(radiance, sum, sizeof *radiance);
}

/* The three halfs of a compact probe, times a weight. */
static inline void firsts_weigh(const unsigned char *probe, float weight, float first[3])
{
    for (int c = 0; c < 3; ++c) {
        first[c] = weight * lmb_volume_half(probe + 2 * c);
    }
}

/* b |b| of a compact probe's 24 bytes. */
static inline void squares_find(const unsigned char *probe, float square[24])
{
    int8_t share[24];
    memcpy(share, probe + 6, sizeof share);
    for (int k = 0; k < 24; ++k) {
        const int32_t b = share[k];
        square[k] = (float)(b < 0 ? -b * b : b * b);
    }
}

static inline void blend_compact(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    float weight[8], first[3], sum[24];
    weights_store(at, weight);
    for (uint32_t i = 0; i < 8; i += 2) {
        float first_a[3], first_b[3], square_a[24], square_b[24];
        firsts_weigh(corner[i], weight[i], first_a);
        firsts_weigh(corner[i + 1], weight[i + 1], first_b);
        squares_find(corner[i], square_a);
        squares_find(corner[i + 1], square_b);
        for (int c = 0; c < 3; ++c) {
            const float pair = first_a[c] + first_b[c];
            first[c] = i == 0 ? pair : first[c] + pair;
            for (int k = 8 * c; k < 8 * c + 8; ++k) {
                const float of_k = first_a[c] * square_a[k] + first_b[c] * square_b[k];
                sum[k] = i == 0 ? of_k : sum[k] + of_k;
            }
        }
    }
    for (int c = 0; c < 3; ++c) {
        radiance->channel[c].c[0] = first[c] * scale;
        for (int k = 1; k < LMB_SH3_COUNT; ++k) {
            radiance->channel[c].c[k] = sum[8 * c + k - 1] * (lmb_compact_share(k) * scale);
        }
    }
}

static inline lmb_rgb irradiance_corners(const unsigned char *const corner[8], fraction at, float scale,
                                         const lmb_sh3 *kernel)
{
    lmb_sh3_rgb light;
    blend_corners(corner, at, scale, &light);
    return lmb_volume_irradiance_sum(&light, kernel);
}

#include "volume_sample_body.h"

const lmb_volume_kernel lmb_volume_kernel_scalar = LMB_VOLUME_KERNEL("C");
