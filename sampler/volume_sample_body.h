/* Sampling, for a file that compiles it for some instructions and has defined before
 *
 *     typedef ... located;   a position in spacings of the finest level from the origin, within the box
 *     typedef ... fraction;  a position in its cell, 0 to 1 along each axis
 *     static inline bool locate(const lmb_volume *volume, double x, double y, double z, located *at, uint32_t cell[3]);
 *     static inline fraction fraction_find(const located *at, const uint32_t cell[3], uint32_t level);
 *     static inline void fraction_store(fraction at, float t[3]);
 *     static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale,
 *                                      lmb_sh3_rgb *radiance);
 *     static inline void blend_compact(... the same ...);   of compact probes
 *     static inline void weights_store(fraction at, float weight[8]);
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
    const lmb_volume_brick *brick;
    uint32_t x, row; /* of the cell in the brick; row is the one of its first corner */
    uint32_t cell;   /* its number */
    fraction t;
    bool inside;
} place;

LMB_INLINE place place_find(const lmb_volume *volume, double x, double y, double z)
{
    place found;
    located at;
    uint32_t cell[3], level;
    found.inside = locate(volume, x, y, z, &at, cell);
    found.brick = lmb_volume_brick_at(volume, cell, &level);
    found.t = fraction_find(&at, cell, level);
    found.x = cell[0] >> level & 3u;
    const uint32_t in_y = cell[1] >> level & 3u, in_z = cell[2] >> level & 3u;
    found.row = in_y + LMB_BRICK_POINTS * in_z;
    found.cell = found.x + 4 * in_y + 16 * in_z;
    return found;
}

/* Most positions: inside, in a cell that nothing cuts. */
LMB_INLINE bool place_is_plain(const place *at)
{
    return at->inside && (at->brick->plain >> at->cell & 1u);
}

/* The eight corners of a plain cell: pairs along x follow each other. `units`: from one probe to the next. */
LMB_INLINE void corners_find(const lmb_volume *volume, const place *at, uint32_t units, const unsigned char *corner[8])
{
    const uint32_t *const row = &at->brick->row[at->row];
    const uint32_t x = at->x * units;
    const size_t next = (size_t)units * LMB_PROBE_UNIT;
    corner[0] = lmb_volume_probe_at(volume, row[0] + x);
    corner[2] = lmb_volume_probe_at(volume, row[1] + x);
    corner[4] = lmb_volume_probe_at(volume, row[LMB_BRICK_POINTS] + x);
    corner[6] = lmb_volume_probe_at(volume, row[LMB_BRICK_POINTS + 1] + x);
    for (int i = 1; i < 8; i += 2) {
        corner[i] = corner[i - 1] + next;
    }
}

/* Those of a cut cell's region that the position is in. */
LMB_INLINE void cut_corners_find(const lmb_volume *volume, const place *at, const unsigned char *corner[8])
{
    const lmb_volume_cut *const cut = lmb_volume_cut_at(volume, at->brick, at->cell);
    float t[3];
    fraction_store(at->t, t);
    const uint32_t region = lmb_cell_region(lmb_volume_cut_planes(cut), cut->plane_count, t);
    const uint32_t *const units = lmb_volume_cut_corners(cut, region);
    for (int i = 0; i < 8; ++i) {
        corner[i] = lmb_volume_probe_at(volume, units[i]);
    }
}

/* `visibility`: of key lights, or NULL. */
LMB_INLINE void blend(const lmb_volume *volume, uint32_t form, const unsigned char *const corner[8], fraction at,
                      lmb_sh3_rgb *radiance, float *visibility)
{
    const size_t coefficient_bytes = form == LMB_VOLUME_COMPACT ? LMB_COMPACT_BYTES : LMB_HALFS_BYTES;
    if (form == LMB_VOLUME_COMPACT) {
        blend_compact(corner, at, volume->scale, radiance);
    } else {
        blend_corners(corner, at, volume->scale, radiance);
    }
    if (!visibility) {
        return;
    }
    float weight[8];
    weights_store(at, weight);
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    for (uint32_t key = 0; key < volume->key_count; ++key) {
        float sum = 0.0f;
        for (uint32_t i = 0; i < 8; ++i) {
            sum += weight[i] * (float)corner[i][coefficient_bytes + key];
        }
        visibility[key] = sum < 255.0f ? sum / 255.0f : 1.0f;
    }
}

/* Any position: outside, NaN, in a cell that is cut, or in none. */
LMB_APART bool sample_any(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance,
                          float *visibility)
{
    const place at = place_find(volume, x, y, z);
    const bool is_number = x == x && y == y && z == z; /* mingw-w64's isnan() narrows, and warns */
    const uint64_t cell = UINT64_C(1) << at.cell;
    const unsigned char *corner[8];
    if (is_number && (at.brick->cut & cell)) {
        cut_corners_find(volume, &at, corner);
    } else if (is_number && (at.brick->plain & cell)) {
        corners_find(volume, &at, volume->probe_units, corner);
    } else {
        memset(radiance, 0, sizeof *radiance);
        if (visibility) {
            memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
        }
        return false;
    }
    blend(volume, volume->header->probe_form, corner, at.t, radiance, visibility);
    return at.inside;
}

LMB_INLINE bool sample_one(const lmb_volume *volume, uint32_t form, uint32_t units, double x, double y, double z,
                           lmb_sh3_rgb *radiance, float *visibility)
{
    const place at = place_find(volume, x, y, z);
    if (!place_is_plain(&at)) {
        return sample_any(volume, x, y, z, radiance, visibility);
    }
    const unsigned char *corner[8];
    corners_find(volume, &at, units, corner);
    blend(volume, form, corner, at.t, radiance, visibility);
    return true;
}

/* A later sample of a batch. */
typedef struct waiting {
    const unsigned char
        *corner[4]; /* the first ones of pairs along x, where the cell is plain; [0] is NULL elsewhere */
    fraction t;
} waiting;

/* Finds the place of a later sample, and asks for what it needs: the lines that pairs of probes lie in, those of all
 * four before second ones of any. */
LMB_INLINE void waiting_begin(const lmb_volume *volume, uint32_t units, const lmb_vec3d *position, waiting *next)
{
    const place at = place_find(volume, position->x, position->y, position->z);
    next->corner[0] = NULL;
    next->t = at.t;
    if (!place_is_plain(&at)) {
        return;
    }
    const unsigned char *corner[8];
    corners_find(volume, &at, units, corner);
    const size_t end = 2 * (size_t)units * LMB_PROBE_UNIT - 1;
    for (size_t line = 0; line <= 2; ++line) {
        for (int i = 0; i < 4; ++i) {
            LMB_PREFETCH(corner[2 * i] + (line < 2 ? line * CACHE_LINE_BYTES : end));
        }
    }
    for (int i = 0; i < 4; ++i) {
        next->corner[i] = corner[2 * i];
    }
}

LMB_INLINE bool waiting_finish(const lmb_volume *volume, uint32_t form, uint32_t units, const waiting *next,
                               const lmb_vec3d *position, lmb_sh3_rgb *radiance, float *visibility)
{
    if (!next->corner[0]) {
        return sample_any(volume, position->x, position->y, position->z, radiance, visibility);
    }
    const unsigned char *corner[8];
    for (int i = 0; i < 8; ++i) {
        corner[i] = next->corner[i / 2] + (size_t)(i % 2) * units * LMB_PROBE_UNIT;
    }
    blend(volume, form, corner, next->t, radiance, visibility);
    return true;
}

LMB_INLINE void batch(const lmb_volume *volume, uint32_t form, uint32_t units, const lmb_vec3d *position, size_t count,
                      lmb_sh3_rgb *radiance, float (*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)
{
    waiting ring[BATCH_RING];
    const size_t ahead = count < BATCH_AHEAD ? count : BATCH_AHEAD;
    for (size_t i = 0; i < ahead; ++i) {
        waiting_begin(volume, units, &position[i], &ring[i]);
    }
    for (size_t i = 0; i < count; ++i) {
        if (i + ahead < count) {
            waiting_begin(volume, units, &position[i + ahead], &ring[(i + ahead) % BATCH_RING]);
        }
        const bool is_inside = waiting_finish(volume, form, units, &ring[i % BATCH_RING], &position[i], &radiance[i],
                                              visibility ? visibility[i] : NULL);
        if (inside) {
            inside[i] = is_inside;
        }
    }
}

/* The calls, of probes of a form, at a distance that is known now, or is the volume's. */
#define LMB_VOLUME_CALLS(what, form, units)                                                                            \
    static bool sample_##what(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance)           \
    {                                                                                                                  \
        return sample_one(volume, form, units, x, y, z, radiance, NULL);                                               \
    }                                                                                                                  \
    static bool sample_with_keys_##what(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance, \
                                        float *visibility)                                                             \
    {                                                                                                                  \
        return sample_one(volume, form, units, x, y, z, radiance, visibility);                                         \
    }                                                                                                                  \
    static void batch_##what(const lmb_volume *volume, const lmb_vec3d *position, size_t count, lmb_sh3_rgb *radiance, \
                             float(*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)                                    \
    {                                                                                                                  \
        batch(volume, form, units, position, count, radiance, visibility, inside);                                     \
    }

LMB_VOLUME_CALLS(plain, LMB_VOLUME_HALFS, LMB_HALFS_BYTES / LMB_PROBE_UNIT)
LMB_VOLUME_CALLS(keyed, LMB_VOLUME_HALFS, volume->probe_units)
LMB_VOLUME_CALLS(compact, LMB_VOLUME_COMPACT, volume->probe_units)

#define LMB_VOLUME_KERNEL(what)                                                                                        \
    {                                                                                                                  \
        .name = what, .plain = {sample_plain, sample_with_keys_plain, batch_plain},                                    \
        .keyed = {sample_keyed, sample_with_keys_keyed, batch_keyed},                                                  \
        .compact = {sample_compact, sample_with_keys_compact, batch_compact},                                          \
    }

#endif
