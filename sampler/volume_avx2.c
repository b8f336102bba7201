/* Sampling by AVX2 and F16C, for which CMakeLists.txt compiles this file: not one of its functions may be called before
 * the processor was asked (volume_kernel.c). Compiled for less it is empty, and the volume is sampled in plain C.
 *
 * GCC for Windows leaves the stack at 16 bytes where it keeps registers of 32, and dies of it: not there. */
#include "volume_kernel.h"

#if defined(__AVX2__) && (defined(__F16C__) || defined(_MSC_VER)) &&                                                   \
    !(defined(_WIN32) && defined(__GNUC__) && !defined(__clang__))

#include "volume_internal.h"

#include <immintrin.h>

/* As the one in volume_scalar.c, three axes at once: max and min take their second operand for NaN and between zeros.
 */
static inline bool locate(const lmb_volume *volume, double x, double y, double z, lmb_cell *cell)
{
    const __m256d in = _mm256_setr_pd(x, y, z, 0.0);
    const __m256d at =
        _mm256_sub_pd(_mm256_mul_pd(in, _mm256_broadcast_sd(&volume->inverse_spacing)), _mm256_loadu_pd(volume->min));
    const __m256d clamped = _mm256_min_pd(_mm256_max_pd(at, _mm256_setzero_pd()), _mm256_loadu_pd(volume->last));
    const __m128i last_cell = _mm_loadu_si128((const __m128i *)(const void *)volume->last_cell);
    const __m128i whole = _mm_min_epi32(_mm256_cvttpd_epi32(clamped), last_cell);
    _mm_storeu_ps(cell->t, _mm256_cvtpd_ps(_mm256_sub_pd(clamped, _mm256_cvtepi32_pd(whole))));
    cell->at[0] = (uint32_t)_mm_cvtsi128_si32(whole);
    cell->at[1] = (uint32_t)_mm_extract_epi32(whole, 1);
    cell->at[2] = (uint32_t)_mm_extract_epi32(whole, 2);
    const __m256d above = _mm256_cmp_pd(at, _mm256_loadu_pd(volume->nearest), _CMP_GE_OQ);
    const __m256d below = _mm256_cmp_pd(at, _mm256_loadu_pd(volume->farthest), _CMP_LE_OQ);
    return _mm256_movemask_pd(_mm256_and_pd(above, below)) == 15;
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

static inline __m256 load_8(const uint16_t *halfs)
{
    return _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(const void *)halfs));
}

/* Eight of the sums. The plain ones come from the same halfs times 2^-112 and weights times 2^112, which rounds alike.
 */
static inline __m256 blend_8(const uint16_t *sh, const __m256 weight[8])
{
    __m256 sum = _mm256_setzero_ps();
    for (uint32_t i = 0; i < 8; i += 2) {
        const uint16_t *const a = sh + lmb_brick_corner(i) * LMB_BRICK_COEFFICIENTS;
        const uint16_t *const b = a + LMB_BRICK_COEFFICIENTS;
        const __m256 of_a = _mm256_mul_ps(weight[i], load_8(a)), of_b = _mm256_mul_ps(weight[i + 1], load_8(b));
        sum = _mm256_add_ps(sum, _mm256_add_ps(of_a, of_b));
    }
    return sum;
}

/* 27 sums: three registers of eight, and one of which three are used. The first and the last of a probe come first:
 * they ask for most of the memory that the others lie in. */
static inline void blend_corners(const uint16_t *sh, const float weight[8], float scale, lmb_sh3_rgb *radiance)
{
    __m256 weights[8];
    for (int i = 0; i < 8; ++i) {
        weights[i] = _mm256_broadcast_ss(&weight[i]);
    }
    const __m256 scales = _mm256_set1_ps(scale);
    float *const to = radiance->channel[0].c;
    const __m256 sum_0 = _mm256_mul_ps(blend_8(sh, weights), scales);
    const __m128 sum_24 = _mm256_castps256_ps128(_mm256_mul_ps(blend_8(sh + 24, weights), scales));
    const __m256 sum_8 = _mm256_mul_ps(blend_8(sh + 8, weights), scales);
    const __m256 sum_16 = _mm256_mul_ps(blend_8(sh + 16, weights), scales);
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
