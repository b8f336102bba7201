/* Sampling by AVX2 and F16C, for which CMakeLists.txt compiles this file: not one of its functions may be called before
 * the processor was asked (volume_kernel.c). Compiled for less it is empty, and the volume is sampled in plain C.
 *
 * GCC for Windows leaves the stack at 16 bytes where it keeps registers of 32, and dies of it: not there. */
#include "volume_kernel.h"

#if defined(__AVX2__) && (defined(__F16C__) || defined(_MSC_VER)) &&                                                   \
    !(defined(_WIN32) && defined(__GNUC__) && !defined(__clang__))

#include "volume_internal.h"

#include <immintrin.h>

/* As the ones in volume_scalar.c, three axes at once: max and min take their second operand for NaN and between zeros.
 */
typedef struct located {
    __m256d at;
    __m128i cell;
} located;

static inline bool locate(const lmb_volume *volume, double x, double y, double z, located *found, uint32_t cell[3])
{
    const __m256d in = _mm256_setr_pd(x, y, z, 0.0);
    const __m256d at = _mm256_sub_pd(_mm256_mul_pd(in, _mm256_broadcast_sd(&volume->inverse_spacing)),
                                     _mm256_loadu_pd(volume->origin));
    found->at = _mm256_min_pd(_mm256_max_pd(at, _mm256_loadu_pd(volume->first)), _mm256_loadu_pd(volume->last));
    const __m128i last_cell = _mm_loadu_si128((const __m128i *)(const void *)volume->last_cell);
    found->cell = _mm_min_epi32(_mm256_cvttpd_epi32(found->at), last_cell);
    cell[0] = (uint32_t)_mm_cvtsi128_si32(found->cell);
    cell[1] = (uint32_t)_mm_extract_epi32(found->cell, 1);
    cell[2] = (uint32_t)_mm_extract_epi32(found->cell, 2);
    const __m256d above = _mm256_cmp_pd(at, _mm256_loadu_pd(volume->nearest), _CMP_GE_OQ);
    const __m256d below = _mm256_cmp_pd(at, _mm256_loadu_pd(volume->farthest), _CMP_LE_OQ);
    return _mm256_movemask_pd(_mm256_and_pd(above, below)) == 15;
}

/* 2^-level as the bits of a double. */
static inline __m256d inverse_of(uint32_t level)
{
    return _mm256_castsi256_pd(_mm256_set1_epi64x((long long)(UINT64_C(1023) - level) << 52));
}

static inline uint32_t locate_in_brick(const located *found, const uint32_t cell[3], uint32_t level, float t[4])
{
    const __m128i of_level = _mm_srl_epi32(found->cell, _mm_cvtsi32_si128((int)level));
    const __m256d scaled = _mm256_mul_pd(found->at, inverse_of(level));
    _mm_storeu_ps(t, _mm256_cvtpd_ps(_mm256_sub_pd(scaled, _mm256_cvtepi32_pd(of_level))));
    return (cell[0] >> level & 3u) | (cell[1] >> level & 3u) << 2 | (cell[2] >> level & 3u) << 4;
}

static inline void weights_find(const float t[4], float weight[8])
{
    const __m128 far = _mm_loadu_ps(t), near = _mm_sub_ps(_mm_set1_ps(1.0f), far);
    const __m128 xy = _mm_unpacklo_ps(near, far), z = _mm_unpackhi_ps(near, far);
    const __m128 u = _mm_movelh_ps(xy, xy), v = _mm_shuffle_ps(xy, xy, _MM_SHUFFLE(3, 3, 2, 2));
    const __m128 uv = _mm_mul_ps(u, v);
    _mm_storeu_ps(weight, _mm_mul_ps(uv, _mm_shuffle_ps(z, z, _MM_SHUFFLE(0, 0, 0, 0))));
    _mm_storeu_ps(weight + 4, _mm_mul_ps(uv, _mm_shuffle_ps(z, z, _MM_SHUFFLE(1, 1, 1, 1))));
}

static inline __m256 load_8(const unsigned char *halfs)
{
    return _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(const void *)halfs));
}

/* Eight of the sums, from the k-th on. The plain ones come from the same halfs times 2^-112 and weights times 2^112,
 * which rounds alike. */
static inline __m256 blend_8(const unsigned char *const corner[8], size_t k, const __m256 weight[8])
{
    __m256 sum = _mm256_setzero_ps();
    for (uint32_t i = 0; i < 8; i += 2) {
        const __m256 of_a = _mm256_mul_ps(weight[i], load_8(corner[i] + 2 * k));
        const __m256 of_b = _mm256_mul_ps(weight[i + 1], load_8(corner[i + 1] + 2 * k));
        sum = _mm256_add_ps(sum, _mm256_add_ps(of_a, of_b));
    }
    return sum;
}

/* 27 sums: three registers of eight, and one of which three are used. The first and the last of a probe come first:
 * they ask for most of the memory that the others lie in. */
static inline void blend_corners(const unsigned char *const corner[8], const float weight[8], float scale,
                                 lmb_sh3_rgb *radiance)
{
    __m256 weights[8];
    for (int i = 0; i < 8; ++i) {
        weights[i] = _mm256_broadcast_ss(&weight[i]);
    }
    const __m256 scales = _mm256_set1_ps(scale);
    float *const to = radiance->channel[0].c;
    const __m256 sum_0 = _mm256_mul_ps(blend_8(corner, 0, weights), scales);
    const __m128 sum_24 = _mm256_castps256_ps128(_mm256_mul_ps(blend_8(corner, 24, weights), scales));
    const __m256 sum_8 = _mm256_mul_ps(blend_8(corner, 8, weights), scales);
    const __m256 sum_16 = _mm256_mul_ps(blend_8(corner, 16, weights), scales);
    _mm256_storeu_ps(to, sum_0);
    _mm256_storeu_ps(to + 8, sum_8);
    _mm256_storeu_ps(to + 16, sum_16);
    _mm_storel_pi((__m64 *)(void *)(to + 24), sum_24);
    _mm_store_ss(to + 26, _mm_movehl_ps(sum_24, sum_24));
}

#include "volume_sample_body.h"

static const lmb_volume_kernel kernel = {"AVX2 and F16C", sample, sample_with_keys, sample_batch};
const lmb_volume_kernel *const lmb_volume_kernel_avx2 = &kernel;

#else

const lmb_volume_kernel *const lmb_volume_kernel_avx2 = NULL;

#endif
