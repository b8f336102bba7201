/* Finding the cell of a position, and the corners' weights, as volume_scalar.c does, by AVX2: three axes at once. */
#ifndef LMB_VOLUME_LOCATE_AVX2_H
#define LMB_VOLUME_LOCATE_AVX2_H

#include "volume_cut.h"
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

/* Normal . t of both planes at once, summed in the order x, y, z. */
static inline uint32_t planes_ask(const lmb_cell_plane plane[2], fraction at)
{
    const __m128 t = _mm_blend_ps(at, _mm_set1_ps(1.0f), 8);
    const __m128i first = _mm_loadl_epi64((const __m128i *)(const void *)&plane[0]);
    const __m128i second = _mm_loadl_epi64((const __m128i *)(const void *)&plane[1]);
    const __m128 a = _mm_mul_ps(_mm_cvtepi32_ps(_mm_cvtepi16_epi32(first)), t);
    const __m128 b = _mm_mul_ps(_mm_cvtepi32_ps(_mm_cvtepi16_epi32(second)), t);
    const __m128 xy = _mm_unpacklo_ps(a, b), z_offset = _mm_unpackhi_ps(a, b);
    const __m128 along = _mm_add_ps(_mm_add_ps(xy, _mm_movehl_ps(xy, xy)), z_offset);
    return (uint32_t)_mm_movemask_ps(_mm_cmpgt_ps(along, _mm_movehl_ps(z_offset, z_offset))) & 3u;
}

/* The places that a plain cell's corners have, in their order. */
static inline __m256i own_places(const uint32_t *row, uint32_t x, uint32_t units)
{
    const __m128i near = _mm_loadl_epi64((const __m128i *)(const void *)row);
    const __m128i far = _mm_loadl_epi64((const __m128i *)(const void *)(row + LMB_BRICK_POINTS));
    const __m256i rows = _mm256_cvtepu32_epi64(_mm_unpacklo_epi64(near, far)); /* and zeros between */
    const __m256i steps = _mm256_set1_epi64x((int64_t)((uint64_t)(units * (x + 1)) << 32 | units * x));
    return _mm256_add_epi32(_mm256_or_si256(rows, _mm256_slli_epi64(rows, 32)), steps);
}

/* Those of eight ghosts. */
static inline __m256i ghost_places(__m128i number, uint32_t ghost_first, uint32_t units)
{
    const __m256i all = _mm256_add_epi32(_mm256_cvtepi16_epi32(number), _mm256_set1_epi32((int32_t)ghost_first));
    return _mm256_mullo_epi32(all, _mm256_set1_epi32((int32_t)units));
}

/* lmb_volume_cut_places, all eight at once. */
static inline void places_find(const uint32_t *row, uint32_t x, uint32_t units, uint32_t ghosts, const int16_t *ghost,
                               uint32_t ghost_first, uint32_t place[8])
{
    const __m256i own = own_places(row, x, units);
    const __m128i all = _mm_loadu_si128((const __m128i *)(const void *)ghost);
#if defined(__AVX512F__) && defined(__AVX512VL__)
    const __m256i found = _mm256_mask_expand_epi32(own, (__mmask8)ghosts, ghost_places(all, ghost_first, units));
#else
    /* Byte pairs of the ghosts in the corners' order. */
    const __m128i ranks = _mm_cvtsi64_si128((int64_t)lmb_volume_ranks(ghosts));
    const __m128i low = _mm_add_epi8(ranks, ranks), high = _mm_add_epi8(low, _mm_set1_epi8(1));
    const __m128i number = _mm_shuffle_epi8(all, _mm_unpacklo_epi8(low, high));
    const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i is_ghost = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int32_t)ghosts), bit), bit);
    const __m256i found = _mm256_blendv_epi8(own, ghost_places(number, ghost_first, units), is_ghost);
#endif
    _mm256_storeu_si256((__m256i *)(void *)place, found);
}

/* lmb_volume_probe_at of all eight. */
static inline void places_point(const lmb_volume *volume, const uint32_t place[8], const unsigned char *corner[8])
{
    _Static_assert(sizeof corner[0] == sizeof(int64_t), "addresses are computed by fours");
    const __m256i first = _mm256_set1_epi64x((int64_t)(intptr_t)volume->probes);
    for (int i = 0; i < 8; i += 4) {
        const __m256i units = _mm256_cvtepu32_epi64(_mm_loadu_si128((const __m128i *)(const void *)(place + i)));
        const __m256i at = _mm256_add_epi64(first, _mm256_slli_epi64(units, LMB_PROBE_UNIT / 2));
        _mm256_storeu_si256((__m256i *)(void *)(corner + i), at);
    }
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
