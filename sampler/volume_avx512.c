/* Sampling by AVX-512, for which CMakeLists.txt compiles this file: see volume_avx2.c. Half the instructions of that:
 * so many samples of single calls more are on their way in the processor at once while they wait for memory. */
#include "volume_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) &&                                          \
    !(defined(_WIN32) && defined(__GNUC__) && !defined(__clang__))

#include "volume_locate_avx2.h"

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
static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    __m512 weight[8];
    const weights found = weights_find(at);
    weights_spread(found.low, weight);
    weights_spread(found.high, weight + 4);
    const __m512 scales = _mm512_set1_ps(scale);
    float *const to = radiance->channel[0].c;
    _mm512_storeu_ps(to, _mm512_mul_ps(blend_16(corner, 0, weight), scales));
    _mm512_storeu_ps(to + 11, _mm512_mul_ps(blend_16(corner, 11, weight), scales));
}

#include "volume_sample_body.h"

static const lmb_volume_kernel kernel = LMB_VOLUME_KERNEL("AVX-512");
const lmb_volume_kernel *const lmb_volume_kernel_avx512 = &kernel;

#else

const lmb_volume_kernel *const lmb_volume_kernel_avx512 = NULL;

#endif
