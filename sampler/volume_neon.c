/* Sampling by NEON, which every AArch64 has: nothing is asked. Compiled for less it is empty, and the volume is sampled
 * in plain C. Places are found as there; products and sums are rounded one by one, none fused. */
#include "volume_kernel.h"

#if defined(__aarch64__) || defined(_M_ARM64)

#include "volume_locate.h"

#include <arm_neon.h>
#include <string.h>

static inline float32x4_t load_4(const unsigned char *halfs)
{
    return vcvt_f32_f16(vreinterpret_f16_u8(vld1_u8(halfs)));
}

/* Four of the sums, from the k-th on. The plain ones come from the same halfs times 2^-112 and weights times 2^112,
 * which rounds alike. */
static inline float32x4_t blend_4(const unsigned char *const corner[8], size_t k, const float weight[8])
{
    float32x4_t sum = vdupq_n_f32(0.0f);
    for (int i = 0; i < 8; i += 2) {
        const float32x4_t first = vmulq_n_f32(load_4(corner[i] + 2 * k), weight[i]);
        const float32x4_t second = vmulq_n_f32(load_4(corner[i + 1] + 2 * k), weight[i + 1]);
        const float32x4_t pair = vaddq_f32(first, second);
        sum = i == 0 ? pair : vaddq_f32(sum, pair);
    }
    return sum;
}

/* 27 sums in seven registers of four: the last begins at the 23rd, and repeats one. */
static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    enum { LAST = LMB_PROBE_COEFFICIENTS - 4 };
    float weight[8], sum[LMB_PROBE_COEFFICIENTS];
    weights_store(at, weight);
    for (size_t k = 0; k < LAST; k += 4) {
        vst1q_f32(sum + k, vmulq_n_f32(blend_4(corner, k, weight), scale));
    }
    vst1q_f32(sum + LAST, vmulq_n_f32(blend_4(corner, LAST, weight), scale));
    memcpy(radiance, sum, sizeof *radiance);
}

/* b |b| of eight of a compact probe's bytes, four and four. */
static inline float32x4x2_t squares_8(const unsigned char *bytes)
{
    const int16x8_t share = vmovl_s8(vreinterpret_s8_u8(vld1_u8(bytes)));
    const int16x8_t square = vmulq_s16(share, vabsq_s16(share)); /* up to 128^2 */
    const float32x4x2_t squares = {
        {vcvtq_f32_s32(vmovl_s16(vget_low_s16(square))), vcvtq_f32_s32(vmovl_s16(vget_high_s16(square)))}};
    return squares;
}

/* A pair of corners' share of a colour's eight, added to what there is; weights hold the colour's first number. */
static inline void pair_add(const unsigned char *a, const unsigned char *b, float of_a, float of_b, bool is_first,
                            float32x4_t sum[2])
{
    const float32x4x2_t square_a = squares_8(a), square_b = squares_8(b);
    for (int half = 0; half < 2; ++half) {
        const float32x4_t pair =
            vaddq_f32(vmulq_n_f32(square_a.val[half], of_a), vmulq_n_f32(square_b.val[half], of_b));
        sum[half] = is_first ? pair : vaddq_f32(sum[half], pair);
    }
}

static inline void blend_compact(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    float weight[8], first[4];
    float32x4_t firsts = vdupq_n_f32(0.0f), sum[3][2];
    weights_store(at, weight);
    for (int i = 0; i < 8; i += 2) {
        float first_a[4], first_b[4];
        const float32x4_t a = vmulq_n_f32(load_4(corner[i]), weight[i]);
        const float32x4_t b = vmulq_n_f32(load_4(corner[i + 1]), weight[i + 1]);
        const float32x4_t pair = vaddq_f32(a, b);
        firsts = i == 0 ? pair : vaddq_f32(firsts, pair);
        vst1q_f32(first_a, a);
        vst1q_f32(first_b, b);
        for (int c = 0; c < 3; ++c) {
            pair_add(corner[i] + 6 + 8 * c, corner[i + 1] + 6 + 8 * c, first_a[c], first_b[c], i == 0, sum[c]);
        }
    }
    float share[LMB_SH3_COUNT - 1];
    for (int k = 1; k < LMB_SH3_COUNT; ++k) {
        share[k - 1] = lmb_compact_share(k) * scale;
    }
    vst1q_f32(first, vmulq_n_f32(firsts, scale));
    for (int c = 0; c < 3; ++c) {
        float *const to = radiance->channel[c].c;
        to[0] = first[c];
        vst1q_f32(to + 1, vmulq_f32(sum[c][0], vld1q_f32(share)));
        vst1q_f32(to + 5, vmulq_f32(sum[c][1], vld1q_f32(share + 4)));
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

static const lmb_volume_kernel kernel = LMB_VOLUME_KERNEL("NEON");
const lmb_volume_kernel *const lmb_volume_kernel_neon = &kernel;

#else

const lmb_volume_kernel *const lmb_volume_kernel_neon = NULL;

#endif
