/* Sampling by AVX-512, for which CMakeLists.txt compiles this file: see volume_avx2.c. Half the instructions of that:
 * so many samples of single calls more are on their way in the processor at once while they wait for memory. */
#include "volume_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) &&                                          \
    !(defined(_WIN32) && defined(__GNUC__) && !defined(__clang__))

#include "volume_locate_avx2.h"

#include <string.h>

static inline __m512 load_16(const unsigned char *halfs)
{
    return _mm512_cvtph_ps(_mm256_loadu_si256((const __m256i *)(const void *)halfs));
}

/* Of two corners. */
static inline __m512 pair_16(const unsigned char *const corner[2], size_t k, const __m512 weight[2])
{
    const __m512 first = _mm512_mul_ps(weight[0], load_16(corner[0] + 2 * k));
    const __m512 second = _mm512_mul_ps(weight[1], load_16(corner[1] + 2 * k));
    return _mm512_add_ps(first, second);
}

static inline __m512 blend_16(const unsigned char *const corner[8], size_t k, const __m512 weight[8])
{
    __m512 sum = pair_16(corner, k, weight);
    for (int i = 2; i < 8; i += 2) {
        sum = _mm512_add_ps(sum, pair_16(corner + i, k, weight + i));
    }
    return sum;
}

/* Each of four weights, all over a register. */
static inline void weights_spread(__m128 half, __m512 weight[4])
{
    const __m512 all = _mm512_broadcast_f32x4(half);
    weight[0] = _mm512_permute_ps(all, _MM_SHUFFLE(0, 0, 0, 0));
    weight[1] = _mm512_permute_ps(all, _MM_SHUFFLE(1, 1, 1, 1));
    weight[2] = _mm512_permute_ps(all, _MM_SHUFFLE(2, 2, 2, 2));
    weight[3] = _mm512_permute_ps(all, _MM_SHUFFLE(3, 3, 3, 3));
}

/* 27 sums in two registers of sixteen: the last begins at the 11th, and repeats five. */
static inline void sums_find(const unsigned char *const corner[8], fraction at, float scale, __m512 sum[2])
{
    __m512 weight[8];
    const weights found = weights_find(at);
    weights_spread(found.low, weight);
    weights_spread(found.high, weight + 4);
    const __m512 scales = _mm512_set1_ps(scale);
    sum[0] = _mm512_mul_ps(blend_16(corner, 0, weight), scales);
    sum[1] = _mm512_mul_ps(blend_16(corner, 11, weight), scales);
}

static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    __m512 sum[2];
    sums_find(corner, at, scale, sum);
    float *const to = radiance->channel[0].c;
    _mm512_storeu_ps(to, sum[0]);
    _mm512_storeu_ps(to + 11, sum[1]);
}

/* lmb_volume_irradiance_sum from registers, the three channels' fours beside each other, their last ones behind. Of the
 * lanes picked, those from 16 on are the second register's, which begins at the 11th number. */
static inline lmb_rgb irradiance_corners(const unsigned char *const corner[8], fraction at, float scale,
                                         const lmb_sh3 *kernel)
{
    enum { G = 16 - 11 };
    const __m512i low_lanes =
        _mm512_setr_epi32(0, 1, 2, 3, 9, 10, 11, 12, 18 + G, 19 + G, 20 + G, 21 + G, 8, 17 + G, 26 + G, 26 + G);
    const __m512i high_lanes =
        _mm512_setr_epi32(4, 5, 6, 7, 13, 14, 15, 16 + G, 22 + G, 23 + G, 24 + G, 25 + G, 8, 8, 8, 8);
    const __m512i first_lanes = _mm512_setr_epi32(0, 4, 8, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0);
    __m512 sum[2];
    sums_find(corner, at, scale, sum);
    const __m512 low_kernel =
        _mm512_mask_blend_ps(0xf000, _mm512_broadcast_f32x4(_mm_loadu_ps(kernel->c)), _mm512_set1_ps(kernel->c[8]));
    const __m512 high_kernel = _mm512_broadcast_f32x4(_mm_loadu_ps(kernel->c + 4));
    const __m512 low = _mm512_mul_ps(_mm512_permutex2var_ps(sum[0], low_lanes, sum[1]), low_kernel);
    const __m512 high = _mm512_mul_ps(_mm512_permutex2var_ps(sum[0], high_lanes, sum[1]), high_kernel);
    const __m512 four = _mm512_add_ps(low, high);
    const __m512 two = _mm512_add_ps(four, _mm512_permute_ps(four, _MM_SHUFFLE(2, 3, 0, 1)));
    const __m512 one = _mm512_add_ps(two, _mm512_permute_ps(two, _MM_SHUFFLE(1, 0, 3, 2)));
    const __m128 most = _mm512_castps512_ps128(_mm512_permutexvar_ps(first_lanes, one));
    const __m128 all = _mm_add_ps(most, _mm512_extractf32x4_ps(low, 3));
    lmb_rgb irradiance;
    float stored[4];
    _mm_storeu_ps(stored, _mm_min_ps(_mm_max_ps(all, _mm_setzero_ps()), _mm_set1_ps(FLT_MAX)));
    memcpy(irradiance.c, stored, sizeof irradiance.c);
    return irradiance;
}

/* b |b| of sixteen of a compact probe's bytes, and of eight. */
static inline __m512 squares_16(const unsigned char *bytes)
{
    const __m512i wide = _mm512_cvtepi8_epi32(_mm_loadu_si128((const __m128i *)(const void *)bytes));
    const __m512 share = _mm512_cvtepi32_ps(wide);
    return _mm512_mul_ps(share, _mm512_abs_ps(share));
}

static inline __m256 squares_8(const unsigned char *bytes)
{
    const __m256i wide = _mm256_cvtepi8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)bytes));
    const __m256 share = _mm256_cvtepi32_ps(wide);
    return _mm256_mul_ps(share, _mm256_andnot_ps(_mm256_set1_ps(-0.0f), share));
}

/* Red and green in one register, blue in another. */
static inline void blend_compact(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    const __m512i two = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
    const __m256i third = _mm256_set1_epi32(2);
    __m512 weight[8], red_green = _mm512_setzero_ps();
    __m256 blue = _mm256_setzero_ps();
    __m128 first = _mm_setzero_ps();
    const weights found = weights_find(at);
    weights_spread(found.low, weight);
    weights_spread(found.high, weight + 4);
    for (int i = 0; i < 8; i += 2) {
        const __m128 first_a = _mm_mul_ps(_mm512_castps512_ps128(weight[i]), load_firsts(corner[i]));
        const __m128 first_b = _mm_mul_ps(_mm512_castps512_ps128(weight[i + 1]), load_firsts(corner[i + 1]));
        const __m128 pair = _mm_add_ps(first_a, first_b);
        first = i == 0 ? pair : _mm_add_ps(first, pair);
        const __m512 two_a =
            _mm512_mul_ps(_mm512_permutexvar_ps(two, _mm512_castps128_ps512(first_a)), squares_16(corner[i] + 6));
        const __m512 two_b =
            _mm512_mul_ps(_mm512_permutexvar_ps(two, _mm512_castps128_ps512(first_b)), squares_16(corner[i + 1] + 6));
        const __m256 third_a =
            _mm256_mul_ps(_mm256_permutevar8x32_ps(_mm256_castps128_ps256(first_a), third), squares_8(corner[i] + 22));
        const __m256 third_b = _mm256_mul_ps(_mm256_permutevar8x32_ps(_mm256_castps128_ps256(first_b), third),
                                             squares_8(corner[i + 1] + 22));
        const __m512 two_both = _mm512_add_ps(two_a, two_b);
        const __m256 third_both = _mm256_add_ps(third_a, third_b);
        red_green = i == 0 ? two_both : _mm512_add_ps(red_green, two_both);
        blue = i == 0 ? third_both : _mm256_add_ps(blue, third_both);
    }
    const __m256 shares = _mm256_mul_ps(_mm256_setr_ps(LMB_COMPACT_SHARES), _mm256_set1_ps(scale));
    firsts_store(_mm_mul_ps(first, _mm_set1_ps(scale)), radiance);
    _mm256_storeu_ps(radiance->channel[0].c + 1, _mm256_mul_ps(_mm512_castps512_ps256(red_green), shares));
    _mm256_storeu_ps(radiance->channel[1].c + 1, _mm256_mul_ps(_mm512_extractf32x8_ps(red_green, 1), shares));
    _mm256_storeu_ps(radiance->channel[2].c + 1, _mm256_mul_ps(blue, shares));
}

#include "volume_sample_body.h"

static const lmb_volume_kernel kernel = LMB_VOLUME_KERNEL("AVX-512");
const lmb_volume_kernel *const lmb_volume_kernel_avx512 = &kernel;

#else

const lmb_volume_kernel *const lmb_volume_kernel_avx512 = NULL;

#endif
