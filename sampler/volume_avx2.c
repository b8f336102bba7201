/* Sampling by AVX2 and F16C, for which CMakeLists.txt compiles this file: not one of its functions may be called before
 * the processor was asked (volume_kernel.c). Compiled for less it is empty, and the volume is sampled in plain C.
 *
 * GCC for Windows leaves the stack at 16 bytes where it keeps registers of 32, and dies of it: not there. */
#include "volume_kernel.h"

#if defined(__AVX2__) && (defined(__F16C__) || defined(_MSC_VER)) &&                                                   \
    !(defined(_WIN32) && defined(__GNUC__) && !defined(__clang__))

#include "volume_locate_avx2.h"

static inline __m256 load_8(const unsigned char *halfs)
{
    return _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(const void *)halfs));
}

/* Of two corners. */
static inline __m256 pair_8(const unsigned char *const corner[2], size_t k, const __m256 weight[2])
{
    const __m256 first = _mm256_mul_ps(weight[0], load_8(corner[0] + 2 * k));
    const __m256 second = _mm256_mul_ps(weight[1], load_8(corner[1] + 2 * k));
    return _mm256_add_ps(first, second);
}

/* Eight of the sums, from the k-th on. The plain ones come from the same halfs times 2^-112 and weights times 2^112,
 * which rounds alike. */
static inline __m256 blend_8(const unsigned char *const corner[8], size_t k, const __m256 weight[8])
{
    __m256 sum = pair_8(corner, k, weight);
    for (int i = 2; i < 8; i += 2) {
        sum = _mm256_add_ps(sum, pair_8(corner + i, k, weight + i));
    }
    return sum;
}

/* Each of four weights, all over a register. */
static inline void weights_spread(__m128 half, __m256 weight[4])
{
    const __m256 all = _mm256_set_m128(half, half);
    weight[0] = _mm256_permute_ps(all, _MM_SHUFFLE(0, 0, 0, 0));
    weight[1] = _mm256_permute_ps(all, _MM_SHUFFLE(1, 1, 1, 1));
    weight[2] = _mm256_permute_ps(all, _MM_SHUFFLE(2, 2, 2, 2));
    weight[3] = _mm256_permute_ps(all, _MM_SHUFFLE(3, 3, 3, 3));
}

/* 27 sums in four registers of eight: the last begins at the 19th, and repeats five. The first and the last of a probe
 * come first: they ask for most of the memory that the others lie in. */
static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    __m256 weight[8];
    const weights found = weights_find(at);
    weights_spread(found.low, weight);
    weights_spread(found.high, weight + 4);
    const __m256 scales = _mm256_set1_ps(scale);
    float *const to = radiance->channel[0].c;
    _mm256_storeu_ps(to, _mm256_mul_ps(blend_8(corner, 0, weight), scales));
    _mm256_storeu_ps(to + 19, _mm256_mul_ps(blend_8(corner, 19, weight), scales));
    _mm256_storeu_ps(to + 8, _mm256_mul_ps(blend_8(corner, 8, weight), scales));
    _mm256_storeu_ps(to + 16, _mm256_mul_ps(blend_8(corner, 16, weight), scales));
}

/* b |b| of eight of a compact probe's bytes. */
static inline __m256 squares_8(const unsigned char *bytes)
{
    const __m256i wide = _mm256_cvtepi8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)bytes));
    const __m256 share = _mm256_cvtepi32_ps(wide);
    return _mm256_mul_ps(share, _mm256_andnot_ps(_mm256_set1_ps(-0.0f), share));
}

/* Red, green and blue, each all over a register. */
static inline void firsts_spread(__m128 first, __m256 all[3])
{
    const __m256 twice = _mm256_set_m128(first, first);
    all[0] = _mm256_permute_ps(twice, _MM_SHUFFLE(0, 0, 0, 0));
    all[1] = _mm256_permute_ps(twice, _MM_SHUFFLE(1, 1, 1, 1));
    all[2] = _mm256_permute_ps(twice, _MM_SHUFFLE(2, 2, 2, 2));
}

static inline void blend_compact(const unsigned char *const corner[8], fraction at, float scale, lmb_sh3_rgb *radiance)
{
    __m256 weight[8], sum[3];
    __m128 first = _mm_setzero_ps();
    const weights found = weights_find(at);
    weights_spread(found.low, weight);
    weights_spread(found.high, weight + 4);
    for (int i = 0; i < 8; i += 2) {
        const __m128 first_a = _mm_mul_ps(_mm256_castps256_ps128(weight[i]), load_firsts(corner[i]));
        const __m128 first_b = _mm_mul_ps(_mm256_castps256_ps128(weight[i + 1]), load_firsts(corner[i + 1]));
        const __m128 pair = _mm_add_ps(first_a, first_b);
        first = i == 0 ? pair : _mm_add_ps(first, pair);
        __m256 all_a[3], all_b[3];
        firsts_spread(first_a, all_a);
        firsts_spread(first_b, all_b);
        for (int c = 0; c < 3; ++c) {
            const __m256 of_a = _mm256_mul_ps(all_a[c], squares_8(corner[i] + 6 + 8 * c));
            const __m256 of_b = _mm256_mul_ps(all_b[c], squares_8(corner[i + 1] + 6 + 8 * c));
            const __m256 of_both = _mm256_add_ps(of_a, of_b);
            sum[c] = i == 0 ? of_both : _mm256_add_ps(sum[c], of_both);
        }
    }
    const __m256 shares = _mm256_mul_ps(_mm256_setr_ps(LMB_COMPACT_SHARES), _mm256_set1_ps(scale));
    firsts_store(_mm_mul_ps(first, _mm_set1_ps(scale)), radiance);
    for (int c = 0; c < 3; ++c) {
        _mm256_storeu_ps(radiance->channel[c].c + 1, _mm256_mul_ps(sum[c], shares));
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

static const lmb_volume_kernel kernel = LMB_VOLUME_KERNEL("AVX2 and F16C");
const lmb_volume_kernel *const lmb_volume_kernel_avx2 = &kernel;

#else

const lmb_volume_kernel *const lmb_volume_kernel_avx2 = NULL;

#endif
