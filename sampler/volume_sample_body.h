/* Sampling, for a file that compiles it for some instructions and has defined before
 *
 *     static inline bool locate(const lmb_volume *volume, double x, double y, double z, lmb_cell *cell);
 *     static inline void weights_find(const float t[4], float weight[8]);
 *     static inline void blend_corners(const uint16_t *sh, const float weight[8], float scale, lmb_sh3_rgb *radiance);
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

enum { CACHE_LINE_BYTES = 64, PROBE_BYTES = LMB_BRICK_COEFFICIENTS * 2 };

/* A cell by its brick, and the position in it. */
typedef struct place {
    const lmb_volume_brick *brick; /* NULL: there is none */
    uint32_t cell;                 /* its number in the brick */
    float t[4];
    bool inside;
} place;

/* The cell's first corner among the brick's points. */
LMB_INLINE uint32_t place_first(const place *at)
{
    /* lmb_brick_point of x + 4 (y + 4 z) */
    static const uint8_t first[LMB_BRICK_CELLS * LMB_BRICK_CELLS * LMB_BRICK_CELLS] = {
        0,  1,  2,  3,  5,  6,  7,  8,  10, 11, 12, 13, 15, 16, 17, 18, 25, 26, 27, 28, 30, 31,
        32, 33, 35, 36, 37, 38, 40, 41, 42, 43, 50, 51, 52, 53, 55, 56, 57, 58, 60, 61, 62, 63,
        65, 66, 67, 68, 75, 76, 77, 78, 80, 81, 82, 83, 85, 86, 87, 88, 90, 91, 92, 93};
    return first[at->cell];
}

LMB_INLINE place place_find(const lmb_volume *volume, double x, double y, double z)
{
    place found;
    lmb_cell cell;
    found.inside = locate(volume, x, y, z, &cell);
    memcpy(found.t, cell.t, sizeof found.t);
    const size_t entry =
        (cell.at[0] >> 2) + volume->brick_step[0] * (cell.at[1] >> 2) + volume->brick_step[1] * (cell.at[2] >> 2);
    const uint32_t brick = volume->directory[entry];
    found.cell = lmb_brick_cell(cell.at[0] & 3u, cell.at[1] & 3u, cell.at[2] & 3u);
    found.brick = brick == LMB_VOLUME_NO_BRICK ? NULL : lmb_volume_brick_at(volume, brick);
    return found;
}

/* Most positions: inside, with eight probes around them. */
LMB_INLINE bool place_is_plain(const place *at)
{
    return at->inside && at->brick && (at->brick->complete_cells >> at->cell & 1u);
}

/* Gives the weight of missing corners to the others.
 * @return true when no missing corner had any weight to speak of */
static bool reweigh_corners(const place *at, double slack, float weight[8])
{
    const uint32_t first = place_first(at);
    double share[8];
    double held = 0.0;
    double missing = 0.0;
    uint32_t held_count = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        const double x = i & 1u ? (double)at->t[0] : 1.0 - (double)at->t[0];
        const double y = i & 2u ? (double)at->t[1] : 1.0 - (double)at->t[1];
        const double z = i & 4u ? (double)at->t[2] : 1.0 - (double)at->t[2];
        share[i] = x * y * z;
        if (lmb_brick_holds(at->brick, first + lmb_brick_corner(i))) {
            held += share[i];
            ++held_count;
        } else {
            missing += share[i];
            share[i] = -1.0;
        }
    }
    for (uint32_t i = 0; i < 8; ++i) {
        if (share[i] < 0.0) {
            weight[i] = 0.0f;
        } else {
            weight[i] = (float)(held > 0.0 ? share[i] / held : 1.0 / held_count);
        }
    }
    return missing <= 3.0 * slack;
}

LMB_INLINE void blend(const lmb_volume *volume, const place *at, const float weight[8], lmb_sh3_rgb *radiance,
                      float *visibility)
{
    const uint32_t first = place_first(at);
    blend_corners(&at->brick->sh[first * LMB_BRICK_COEFFICIENTS], weight, volume->scale, radiance);
    if (!visibility) {
        return;
    }
    const lmb_brick_visibility *const stored = lmb_volume_brick_visibility(at->brick);
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    for (uint32_t key = 0; volume->keys && key < volume->keys->count; ++key) {
        float sum = 0.0f;
        for (uint32_t i = 0; i < 8; ++i) {
            sum += weight[i] * (float)stored[key].seen[first + lmb_brick_corner(i)];
        }
        visibility[key] = sum < 255.0f ? sum / 255.0f : 1.0f;
    }
}

/* Any position: outside, NaN, with probes missing around it or all of them. `visibility` may be NULL. */
LMB_APART bool sample_any(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance,
                          float *visibility)
{
    const place at = place_find(volume, x, y, z);
    if (!at.brick || x != x || y != y || z != z) { /* mingw-w64's isnan() narrows, and warns */
        memset(radiance, 0, sizeof *radiance);
        if (visibility) {
            memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
        }
        return false;
    }
    float weight[8];
    bool inside = at.inside;
    weights_find(at.t, weight);
    if (!(at.brick->complete_cells >> at.cell & 1u)) {
        inside &= reweigh_corners(&at, volume->slack, weight);
    }
    blend(volume, &at, weight, radiance, visibility);
    return inside;
}

/* The lines that a cell's probes lie in, those of all four rows before second ones of any. */
LMB_INLINE void probes_prefetch(const place *at)
{
    const unsigned char *const probes = (const unsigned char *)&at->brick->sh[place_first(at) * LMB_BRICK_COEFFICIENTS];
    const size_t up = PROBE_BYTES * LMB_BRICK_POINTS, back = up * LMB_BRICK_POINTS;
    for (size_t line = 0; line <= 2; ++line) {
        const unsigned char *const row = probes + (line < 2 ? line * CACHE_LINE_BYTES : 2 * PROBE_BYTES - 1);
        LMB_PREFETCH(row);
        LMB_PREFETCH(row + up);
        LMB_PREFETCH(row + back);
        LMB_PREFETCH(row + back + up);
    }
}

/* `visibility` may be NULL. The probes are asked for at once, before the weights are found and the first are added. */
LMB_INLINE bool sample_one(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance,
                           float *visibility)
{
    const place at = place_find(volume, x, y, z);
    if (!place_is_plain(&at)) {
        return sample_any(volume, x, y, z, radiance, visibility);
    }
    probes_prefetch(&at);
    float weight[8];
    weights_find(at.t, weight);
    blend(volume, &at, weight, radiance, visibility);
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

/* Finds the place of a later sample, and asks for what it needs. */
LMB_INLINE place place_begin(const lmb_volume *volume, const lmb_vec3d *position, bool with_visibility)
{
    const place at = place_find(volume, position->x, position->y, position->z);
    if (at.brick) {
        LMB_PREFETCH(at.brick);
        probes_prefetch(&at);
        for (uint32_t key = 0; with_visibility && volume->keys && key < volume->keys->count; ++key) {
            const uint8_t *const seen = &lmb_volume_brick_visibility(at.brick)[key].seen[place_first(&at)];
            LMB_PREFETCH(seen);
            LMB_PREFETCH(seen + lmb_brick_corner(7));
        }
    }
    return at;
}

/* Blends at a place that place_begin found for that position. */
LMB_INLINE bool place_finish(const lmb_volume *volume, const place *at, const lmb_vec3d *position,
                             lmb_sh3_rgb *radiance, float *visibility)
{
    if (!place_is_plain(at)) {
        return sample_any(volume, position->x, position->y, position->z, radiance, visibility);
    }
    float weight[8];
    weights_find(at->t, weight);
    blend(volume, at, weight, radiance, visibility);
    return true;
}

static void sample_batch(const lmb_volume *volume, const lmb_vec3d *position, size_t count, lmb_sh3_rgb *radiance,
                         float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)
{
    place ring[BATCH_RING];
    const size_t ahead = count < BATCH_AHEAD ? count : BATCH_AHEAD;
    for (size_t i = 0; i < ahead; ++i) {
        ring[i] = place_begin(volume, &position[i], visibility != NULL);
    }
    for (size_t i = 0; i < count; ++i) {
        if (i + ahead < count) {
            ring[(i + ahead) % BATCH_RING] = place_begin(volume, &position[i + ahead], visibility != NULL);
        }
        const bool is_inside =
            place_finish(volume, &ring[i % BATCH_RING], &position[i], &radiance[i], visibility ? visibility[i] : NULL);
        if (inside) {
            inside[i] = is_inside;
        }
    }
}

#endif
