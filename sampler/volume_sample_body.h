/* Sampling, for a file that compiles it for some instructions and has defined before
 *
 *     typedef ... located;   a position in spacings of the finest level from the origin, within the box
 *     static inline bool locate(const lmb_volume *volume, double x, double y, double z, located *at, uint32_t cell[3]);
 *     static inline uint32_t locate_in_brick(const located *at, const uint32_t cell[3], uint32_t level, float t[4]);
 *     static inline void weights_find(const float t[4], float weight[8]);
 *     static inline void blend_corners(const unsigned char *const corner[8], const float weight[8], float scale,
 *                                      lmb_sh3_rgb *radiance);
 *
 * in which each number comes from the same operations in the same order everywhere: all kernels give the same bits. */
#ifndef LMB_VOLUME_SAMPLE_BODY_H
#define LMB_VOLUME_SAMPLE_BODY_H

#include "volume_internal.h"

#include <string.h>

/* Read ahead of use. What a compiler does not know, it leaves out: nothing depends on it. */
#if defined(__GNUC__)
#define LMB_PREFETCH(address) __builtin_prefetch(address)
#else
#define LMB_PREFETCH(address) ((void)(address))
#endif

/* What is inlined in three functions, each of which leaves out what it has no use for; and what is rare, and would cost
 * them registers. */
#if defined(__GNUC__)
#define LMB_INLINE static inline __attribute__((always_inline))
#define LMB_APART static __attribute__((noinline))
#elif defined(_MSC_VER)
#define LMB_INLINE static __forceinline
#define LMB_APART static __declspec(noinline)
#else
#define LMB_INLINE static inline
#define LMB_APART static
#endif

/* Samples that a batch asks for before it blends the first; as many as the memory can be asked for at once. The ring
 * that they wait in is a power of two. */
enum { BATCH_AHEAD = 12, BATCH_RING = 16 };

enum { CACHE_LINE_BYTES = 64 };

/* A cell by its brick, and the position in it. */
typedef struct place {
    const lmb_volume_brick *brick; /* NULL: there is none */
    uint32_t cell;                 /* its number in the brick */
    float t[4];
    bool inside;
} place;

LMB_INLINE place place_find(const lmb_volume *volume, double x, double y, double z)
{
    place found;
    located at;
    uint32_t cell[3], level;
    found.inside = locate(volume, x, y, z, &at, cell);
    found.brick = lmb_volume_brick_at(volume, cell, &level);
    found.cell = locate_in_brick(&at, cell, level, found.t);
    return found;
}

/* Most positions: inside, in a cell that nothing cuts. */
LMB_INLINE bool place_is_plain(const place *at)
{
    return at->inside && at->brick && (at->brick->plain >> at->cell & 1u);
}

/* Of each pair of corners along x the first one's number among the probes; the second follows it. */
LMB_INLINE void pairs_find(const place *at, size_t pair[4])
{
    const uint32_t x = at->cell & 3u;
    const uint32_t *const row = &at->brick->row[(at->cell >> 2 & 3u) + LMB_BRICK_POINTS * (at->cell >> 4)];
    pair[0] = (uint32_t)(row[0] + x);
    pair[1] = (uint32_t)(row[1] + x);
    pair[2] = (uint32_t)(row[LMB_BRICK_POINTS] + x);
    pair[3] = (uint32_t)(row[LMB_BRICK_POINTS + 1] + x);
}

/* The lines that pairs of probes lie in, those of all four before second ones of any. */
LMB_INLINE void pairs_prefetch(const lmb_volume *volume, const size_t pair[4])
{
    for (size_t line = 0; line <= 2; ++line) {
        for (int i = 0; i < 4; ++i) {
            const unsigned char *const probes = volume->probes + pair[i] * LMB_PROBE_BYTES;
            LMB_PREFETCH(probes + (line < 2 ? line * CACHE_LINE_BYTES : 2 * LMB_PROBE_BYTES - 1));
        }
    }
}

/* Shares of key lights that are seen, in 255ths, weighted. */
LMB_INLINE void blend_visibility(const lmb_volume *volume, const size_t corner[8], const float weight[8],
                                 float *visibility)
{
    const uint32_t keys = volume->header->key_light_count;
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    for (uint32_t key = 0; key < keys; ++key) {
        float sum = 0.0f;
        for (uint32_t i = 0; i < 8; ++i) {
            sum += weight[i] * (float)volume->seen[corner[i] * keys + key];
        }
        visibility[key] = sum < 255.0f ? sum / 255.0f : 1.0f;
    }
}

LMB_INLINE void blend_pairs(const lmb_volume *volume, const size_t pair[4], const float t[4], lmb_sh3_rgb *radiance,
                            float *visibility)
{
    const unsigned char *probe[8];
    size_t corner[8];
    float weight[8];
    for (int i = 0; i < 4; ++i) {
        corner[2 * i] = pair[i];
        corner[2 * i + 1] = pair[i] + 1;
        probe[2 * i] = volume->probes + pair[i] * LMB_PROBE_BYTES;
        probe[2 * i + 1] = probe[2 * i] + LMB_PROBE_BYTES;
    }
    weights_find(t, weight);
    blend_corners(probe, weight, volume->scale, radiance);
    if (visibility) {
        blend_visibility(volume, corner, weight, visibility);
    }
}

/* In a cell that is cut: its region's eight probes. */
LMB_APART void blend_cut(const lmb_volume *volume, const place *at, lmb_sh3_rgb *radiance, float *visibility)
{
    const lmb_volume_cut *const cut = lmb_volume_cut_at(volume, at->brick, at->cell);
    const uint32_t region = lmb_cell_region(lmb_volume_cut_planes(cut), cut->plane_count, at->t);
    const uint32_t *const number = lmb_volume_cut_corners(cut, region);
    const unsigned char *probe[8];
    size_t corner[8];
    float weight[8];
    for (int i = 0; i < 8; ++i) {
        corner[i] = number[i];
        probe[i] = volume->probes + corner[i] * LMB_PROBE_BYTES;
        LMB_PREFETCH(probe[i]);
    }
    weights_find(at->t, weight);
    blend_corners(probe, weight, volume->scale, radiance);
    if (visibility) {
        blend_visibility(volume, corner, weight, visibility);
    }
}

/* Any place: outside, in a cell that is cut, or in none. `is_number`: the position's. `visibility` may be NULL. */
LMB_APART bool place_blend(const lmb_volume *volume, const place *at, bool is_number, lmb_sh3_rgb *radiance,
                           float *visibility)
{
    const uint64_t cell = UINT64_C(1) << at->cell;
    if (is_number && at->brick && (at->brick->plain & cell)) {
        size_t pair[4];
        pairs_find(at, pair);
        blend_pairs(volume, pair, at->t, radiance, visibility);
        return at->inside;
    }
    if (is_number && at->brick && (at->brick->cut & cell)) {
        blend_cut(volume, at, radiance, visibility);
        return at->inside;
    }
    memset(radiance, 0, sizeof *radiance);
    if (visibility) {
        memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    }
    return false;
}

LMB_INLINE bool all_numbers(double x, double y, double z)
{
    return x == x && y == y && z == z; /* mingw-w64's isnan() narrows, and warns */
}

/* `visibility` may be NULL. The probes are asked for at once, before the weights are found and the first are added. */
LMB_INLINE bool sample_one(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance,
                           float *visibility)
{
    const place at = place_find(volume, x, y, z);
    if (!place_is_plain(&at)) {
        return place_blend(volume, &at, all_numbers(x, y, z), radiance, visibility);
    }
    size_t pair[4];
    pairs_find(&at, pair);
    pairs_prefetch(volume, pair);
    blend_pairs(volume, pair, at.t, radiance, visibility);
    return true;
}

static bool sample(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance)
{
    return sample_one(volume, x, y, z, radiance, NULL);
}

static bool sample_with_keys(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance,
                             float *visibility)
{
    return sample_one(volume, x, y, z, radiance, visibility);
}

/* A later sample of a batch. */
typedef struct waiting {
    place at;
    size_t pair[4]; /* where the place is plain */
    bool is_plain;
} waiting;

/* Finds the place of a later sample, and asks for what it needs. */
LMB_INLINE void waiting_begin(const lmb_volume *volume, const lmb_vec3d *position, bool with_visibility, waiting *next)
{
    next->at = place_find(volume, position->x, position->y, position->z);
    next->is_plain = place_is_plain(&next->at);
    if (next->is_plain) {
        pairs_find(&next->at, next->pair);
        pairs_prefetch(volume, next->pair);
        for (int i = 0; with_visibility && i < 4; ++i) {
            LMB_PREFETCH(volume->seen + next->pair[i] * volume->header->key_light_count);
        }
    }
}

LMB_INLINE bool waiting_finish(const lmb_volume *volume, const waiting *next, const lmb_vec3d *position,
                               lmb_sh3_rgb *radiance, float *visibility)
{
    if (!next->is_plain) {
        const bool is_number = all_numbers(position->x, position->y, position->z);
        return place_blend(volume, &next->at, is_number, radiance, visibility);
    }
    blend_pairs(volume, next->pair, next->at.t, radiance, visibility);
    return true;
}

static void sample_batch(const lmb_volume *volume, const lmb_vec3d *position, size_t count, lmb_sh3_rgb *radiance,
                         float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)
{
    waiting ring[BATCH_RING];
    const size_t ahead = count < BATCH_AHEAD ? count : BATCH_AHEAD;
    for (size_t i = 0; i < ahead; ++i) {
        waiting_begin(volume, &position[i], visibility != NULL, &ring[i]);
    }
    for (size_t i = 0; i < count; ++i) {
        if (i + ahead < count) {
            waiting_begin(volume, &position[i + ahead], visibility != NULL, &ring[(i + ahead) % BATCH_RING]);
        }
        const bool is_inside = waiting_finish(volume, &ring[i % BATCH_RING], &position[i], &radiance[i],
                                              visibility ? visibility[i] : NULL);
        if (inside) {
            inside[i] = is_inside;
        }
    }
}

#endif
