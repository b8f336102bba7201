/* Finding the cell of a position, and the corners' weights, as volume_scalar.c does, by AVX2: three axes at once. */
#ifndef LMB_VOLUME_LOCATE_AVX2_H
#define LMB_VOLUME_LOCATE_AVX2_H

#include "volume_internal.h"

#include <immintrin.h>

typedef struct located {
    __m256d at;
    __m128i cell;
} located;

typedef __m128 fraction; /* the last is 0 */

/* Max and min take their second operand for NaN and between zeros. */
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

static inline fraction fraction_find(const located *found, const uint32_t cell[3], uint32_t level)
{
    static const double inverse[LMB_VOLUME_LEVELS_MOST] = {0x1p-0,  0x1p-1,  0x1p-2,  0x1p-3,  0x1p-4,
                                                           0x1p-5,  0x1p-6,  0x1p-7,  0x1p-8,  0x1p-9,
                                                           0x1p-10, 0x1p-11, 0x1p-12, 0x1p-13, 0x1p-14};
    (void)cell;
    const __m128i of_level = _mm_srl_epi32(found->cell, _mm_cvtsi32_si128((int)level));
    const __m256d scaled = _mm256_mul_pd(found->at, _mm256_broadcast_sd(&inverse[level]));
    return _mm256_cvtpd_ps(_mm256_sub_pd(scaled, _mm256_cvtepi32_pd(of_level)));
}

static inline void fraction_store(fraction at, float t[3])
{
    float all[4];
    _mm_storeu_ps(all, at);
    t[0] = all[0];
    t[1] = all[1];
    t[2] = all[2];
}

/* Weights of the four corners at the low z, and of those at the high one. */
typedef struct weights {
    __m128 low, high;
} weights;

static inline weights weights_find(fraction far)
{
    const __m128 near = _mm_sub_ps(_mm_set1_ps(1.0f), far);
    const __m128 xy = _mm_unpacklo_ps(near, far), z = _mm_unpackhi_ps(near, far);
    const __m128 u = _mm_movelh_ps(xy, xy), v = _mm_shuffle_ps(xy, xy, _MM_SHUFFLE(3, 3, 2, 2));
    const __m128 uv = _mm_mul_ps(u, v);
    const weights found = {_mm_mul_ps(uv, _mm_shuffle_ps(z, z, _MM_SHUFFLE(0, 0, 0, 0))),
                           _mm_mul_ps(uv, _mm_shuffle_ps(z, z, _MM_SHUFFLE(1, 1, 1, 1)))};
    return found;
}

static inline void weights_store(fraction at, float weight[8])
{
    const weights found = weights_find(at);
    _mm_storeu_ps(weight, found.low);
    _mm_storeu_ps(weight + 4, found.high);
}

/* The halfs of a compact probe; the last of the four is anything. */
static inline __m128 load_firsts(const unsigned char *probe)
{
    return _mm_cvtph_ps(_mm_loadl_epi64((const __m128i *)(const void *)probe));
}

/* Coefficient 0 of red, green and blue. */
static inline void firsts_store(__m128 first, lmb_sh3_rgb *radiance)
{
    _mm_store_ss(&radiance->channel[0].c[0], first);
    _mm_store_ss(&radiance->channel[1].c[0], _mm_permute_ps(first, 1));
    _mm_store_ss(&radiance->channel[2].c[0], _mm_permute_ps(first, 2));
}

/* lmb_compact_share of coefficients 1 to 8. */
#define LMB_COMPACT_SHARES                                                                                             \
    lmb_compact_share(1), lmb_compact_share(2), lmb_compact_share(3), lmb_compact_share(4), lmb_compact_share(5),      \
        lmb_compact_share(6), lmb_compact_share(7), lmb_compact_share(8)

#endif
