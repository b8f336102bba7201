/* Dense arrays by AVX2, FMA and F16C: CMakeLists.txt builds this file for them, and bench_dense.c asks the processor.
 */
#include "bench_dense.h"

#if defined(__AVX2__) && defined(__FMA__) && defined(__F16C__)

#include <immintrin.h>

/* Three registers of eight and one of which three are used. */
static inline void store_sums(__m256 a, __m256 b, __m256 c, __m128 d, lmb_sh3_rgb *radiance)
{
    float *const to = radiance->channel[0].c;
    _mm256_storeu_ps(to, a);
    _mm256_storeu_ps(to + 8, b);
    _mm256_storeu_ps(to + 16, c);
    _mm_storel_pi((__m64 *)(void *)(to + 24), d);
    _mm_store_ss(to + 26, _mm_movehl_ps(d, d));
}

static inline void blend_fp32(const float *values, const size_t row[4], const float weight[8], lmb_sh3_rgb *radiance)
{
    __m256 a = _mm256_setzero_ps(), b = a, c = a;
    __m128 d = _mm_setzero_ps();
    for (unsigned i = 0; i < 8; ++i) {
        const float *const at = values + (row[i >> 1] + (i & 1u)) * BENCH_DENSE_FLOATS;
        const __m256 w = _mm256_set1_ps(weight[i]);
        a = _mm256_fmadd_ps(w, _mm256_loadu_ps(at), a);
        b = _mm256_fmadd_ps(w, _mm256_loadu_ps(at + 8), b);
        c = _mm256_fmadd_ps(w, _mm256_loadu_ps(at + 16), c);
        d = _mm_fmadd_ps(_mm256_castps256_ps128(w), _mm_loadu_ps(at + 24), d);
    }
    store_sums(a, b, c, d, radiance);
}

static inline __m256 halfs_load(const uint16_t *at)
{
    return _mm256_cvtph_ps(_mm_load_si128((const __m128i *)(const void *)at));
}

static inline void blend_fp16(const uint16_t *values, const size_t row[4], const float weight[8], lmb_sh3_rgb *radiance)
{
    __m256 a = _mm256_setzero_ps(), b = a, c = a, d = a;
    for (unsigned i = 0; i < 8; ++i) {
        const uint16_t *const at = values + (row[i >> 1] + (i & 1u)) * BENCH_DENSE_HALFS;
        const __m256 w = _mm256_set1_ps(weight[i]);
        a = _mm256_fmadd_ps(w, halfs_load(at), a);
        b = _mm256_fmadd_ps(w, halfs_load(at + 8), b);
        c = _mm256_fmadd_ps(w, halfs_load(at + 16), c);
        d = _mm256_fmadd_ps(w, halfs_load(at + 24), d);
    }
    store_sums(a, b, c, _mm256_castps256_ps128(d), radiance);
}

#include "bench_dense_kernel.h"

static const lmb_bench_dense_kernel kernel = BENCH_DENSE_KERNEL("AVX2, FMA and F16C");
const lmb_bench_dense_kernel *const bench_dense_avx2 = &kernel;

#else

const lmb_bench_dense_kernel *const bench_dense_avx2 = NULL;

#endif
