/* Sampling, for a file that compiles it for some instructions and has defined before
 *
 *     typedef ... located;   a position in spacings of the finest level from the origin, within the box
 *     typedef ... fraction;  a position in its cell, 0 to 1 along each axis
 *     static inline bool locate(const lmb_volume *volume, double x, double y, double z, located *at, uint32_t cell[3]);
 *     static inline fraction fraction_find(const located *at, const uint32_t cell[3], uint32_t level);
 *     static inline void fraction_store(fraction at, float t[3]);
 *     static inline uint32_t planes_ask(const lmb_cell_plane plane[2], fraction at);   bit k: it is above plane[k]
 *     static inline void places_find(... as lmb_volume_cut_places ...);
 *     static inline void places_point(const lmb_volume *volume, const uint32_t place[8],
 *                                     const unsigned char *corner[8]);   the probes there
 *     static inline void blend_corners(const unsigned char *const corner[8], fraction at, float scale,
 *                                      lmb_sh3_rgb *radiance);
 *     static inline void blend_compact(... the same ...);   of compact probes
 *     static inline lmb_rgb irradiance_corners(const unsigned char *const corner[8], fraction at, float scale,
 *                                              const lmb_sh3 *kernel);
 *     static inline void weights_store(fraction at, float weight[8]);
 *
 * in which each number comes from the same operations in the same order everywhere: all kernels give the same bits. */
#ifndef LMB_VOLUME_SAMPLE_BODY_H
#define LMB_VOLUME_SAMPLE_BODY_H

#include "sh_internal.h"
#include "volume_cut.h"
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

/* Samples that a batch asks for before it blends the first; as many as the memory can be asked for at once. Those in
 * cut cells know which probes they need only when their records are there, half way. The ring that they wait in is a
 * power of two. */
enum { BATCH_AHEAD = 12, BATCH_CUT_AHEAD = 6, BATCH_RING = 16 };

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

LMB_INLINE bool place_is_cut(const place *at)
{
    return at->inside && (at->brick->cut >> at->cell & 1u);
}

/* The eight corners of a cell that has no ghosts: pairs along x follow each other. `row` is that of the first, `units`
 * go from one probe to the next. */
LMB_INLINE void corners_find(const lmb_volume *volume, const uint32_t *row, uint32_t x, uint32_t units,
                             const unsigned char *corner[8])
{
    const uint32_t along = x * units;
    const size_t next = (size_t)units * LMB_PROBE_UNIT;
    corner[0] = lmb_volume_probe_at(volume, row[0] + along);
    corner[2] = lmb_volume_probe_at(volume, row[1] + along);
    corner[4] = lmb_volume_probe_at(volume, row[LMB_BRICK_POINTS] + along);
    corner[6] = lmb_volume_probe_at(volume, row[LMB_BRICK_POINTS + 1] + along);
    for (int i = 1; i < 8; i += 2) {
        corner[i] = corner[i - 1] + next;
    }
}

/* Asks for the lines that pairs of probes lie in, those of all four before second ones of any. */
LMB_INLINE void pairs_prefetch(const unsigned char *const corner[8], uint32_t units)
{
    const size_t end = 2 * (size_t)units * LMB_PROBE_UNIT - 1;
    for (size_t line = 0; line <= 2; ++line) {
        for (int i = 0; i < 8; i += 2) {
            LMB_PREFETCH(corner[i] + (line < 2 ? line * CACHE_LINE_BYTES : end));
        }
    }
}

/* A cut cell's slot (lmb_volume_cut), or its record of version 3. */
LMB_INLINE const void *cut_find(const lmb_volume *volume, const lmb_volume_brick *brick, uint32_t cell)
{
    if (volume->cut_offsets) {
        return lmb_volume_cut_3_at(volume, brick->cut_first + lmb_volume_cuts_before(brick, cell));
    }
    return lmb_volume_cut_at(volume, lmb_volume_cut_slot(brick, cell));
}

/* The record first, which everything else waits for. Then where the brick's ghosts begin: which of them are wanted only
 * the record tells, but by then the processor knows where in memory they are. Most regions have most corners from the
 * rows, where a plain cell has all. Rows that no cell has points of lead anywhere, which is harmless. */
LMB_INLINE void cut_prefetch(const lmb_volume *volume, const void *slot, const place *at, uint32_t units)
{
    const unsigned char *corner[8];
    LMB_PREFETCH(slot);
    LMB_PREFETCH(lmb_volume_probe_at(volume, at->brick->ghost_first * units));
    corners_find(volume, &at->brick->row[at->row], at->x, units, corner);
    pairs_prefetch(corner, units);
}

/* Of a record of version 3. */
LMB_APART void cut_3_corners_find(const lmb_volume *volume, const lmb_volume_cut_3 *cut, fraction at,
                                  const unsigned char *corner[8])
{
    float t[3];
    fraction_store(at, t);
    const uint32_t region = lmb_cell_region(lmb_volume_cut_3_planes(cut), cut->plane_count, t);
    const uint32_t *const probe = lmb_volume_cut_3_corners(cut, region);
    for (int i = 0; i < 8; ++i) {
        corner[i] = lmb_volume_probe_at(volume, probe[i]);
    }
}

/* Those of a region: its ghosts, and else what a plain cell has there. Where there are no ghosts, processors guess
 * that, and go on before the record is there. */
LMB_INLINE void region_corners_find(const lmb_volume *volume, const lmb_volume_cut *cut, const lmb_volume_brick *brick,
                                    uint32_t cell, uint32_t number, const unsigned char *corner[8])
{
    const uint32_t *const row = &brick->row[(cell >> 2 & 3u) + LMB_BRICK_POINTS * (cell >> 4)];
    const uint32_t x = cell & 3u, units = volume->probe_units;
    const lmb_volume_cut_region region = lmb_volume_cut_regions(cut)[number];
    if (region.ghosts == 0) {
        corners_find(volume, row, x, units, corner);
        return;
    }
    uint32_t probe[8];
    places_find(row, x, units, region.ghosts, lmb_volume_cut_ghosts(cut) + region.first, brick->ghost_first, probe);
    places_point(volume, probe, corner);
}

/* Those of the region that the position is in. @return false, and nothing is found: it is in a wedge, which is rare */
LMB_INLINE bool cut_corners_find(const lmb_volume *volume, const void *slot, const lmb_volume_brick *brick,
                                 uint32_t cell, fraction at, const unsigned char *corner[8])
{
    if (volume->cut_offsets) {
        cut_3_corners_find(volume, slot, at, corner);
        return true;
    }
    const lmb_volume_cut *const cut = lmb_volume_cut_record(volume, slot);
    const lmb_cell_plane *const planes = lmb_volume_cut_planes(cut);
    float t[3];
    fraction_store(at, t);
    const uint32_t number = lmb_volume_cut_region_find(planes, cut->plane_count, planes_ask(planes, at), t);
    if (number >= LMB_CELL_REGIONS_MOST) {
        return false;
    }
    region_corners_find(volume, cut, brick, cell, number, corner);
    return true;
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

/* In a wedge of a cut cell: of two regions. Always true. */
LMB_APART bool blend_wedge(const lmb_volume *volume, const void *slot, const lmb_volume_brick *brick, uint32_t cell,
                           fraction at, lmb_sh3_rgb *radiance, float *visibility)
{
    const lmb_volume_cut *const cut = lmb_volume_cut_record(volume, slot);
    const unsigned char *corner[8];
    lmb_sh3_rgb light[2];
    float seen[2][LMB_KEY_LIGHTS_MOST], t[3];
    fraction_store(at, t);
    const lmb_cell_regions in = lmb_cell_regions_at(lmb_volume_cut_planes(cut), cut->plane_count, t);
    for (int i = 0; i < 2; ++i) {
        region_corners_find(volume, cut, brick, cell, in.region[i], corner);
        blend(volume, volume->header->probe_form, corner, at, &light[i], visibility ? seen[i] : NULL);
    }
    for (int channel = 0; channel < 3; ++channel) {
        const float *const first = light[0].channel[channel].c, *const second = light[1].channel[channel].c;
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            radiance->channel[channel].c[k] = first[k] + in.share * (second[k] - first[k]);
        }
    }
    for (int key = 0; visibility && key < LMB_KEY_LIGHTS_MOST; ++key) {
        visibility[key] = seen[0][key] + in.share * (seen[1][key] - seen[0][key]);
    }
    return true;
}

/* In a cell that is cut. What tells its place comes in registers, as in a cell that is not, it would be written for
 * nothing. Always true: a caller that returns this needs no stack, and is faster in cells that are not cut, too. */
LMB_APART bool blend_cut(const lmb_volume *volume, const void *slot, const lmb_volume_brick *brick, uint32_t cell,
                         fraction at, lmb_sh3_rgb *radiance, float *visibility)
{
    const unsigned char *corner[8];
    if (!cut_corners_find(volume, slot, brick, cell, at, corner)) {
        return blend_wedge(volume, slot, brick, cell, at, radiance, visibility);
    }
    blend(volume, volume->header->probe_form, corner, at, radiance, visibility);
    return true;
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
        const void *const slot = cut_find(volume, at.brick, at.cell);
        cut_prefetch(volume, slot, &at, volume->probe_units);
        if (!cut_corners_find(volume, slot, at.brick, at.cell, at.t, corner)) {
            blend_wedge(volume, slot, at.brick, at.cell, at.t, radiance, visibility);
            return at.inside;
        }
    } else if (is_number && (at.brick->plain & cell)) {
        corners_find(volume, &at.brick->row[at.row], at.x, volume->probe_units, corner);
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
    if (place_is_plain(&at)) {
        const unsigned char *corner[8];
        corners_find(volume, &at.brick->row[at.row], at.x, units, corner);
        blend(volume, form, corner, at.t, radiance, visibility);
        return true;
    }
    if (place_is_cut(&at)) {
        const void *const slot = cut_find(volume, at.brick, at.cell);
        cut_prefetch(volume, slot, &at, units);
        return blend_cut(volume, slot, at.brick, at.cell, at.t, radiance, visibility);
    }
    return sample_any(volume, x, y, z, radiance, visibility);
}

/* A later sample of a batch. */
typedef struct waiting {
    const unsigned char *corner[8]; /* [0] is NULL where the cell is neither plain nor cut, and in wedges */
    const void *cut;                /* as cut_find has it, until its corners are found; then NULL */
    const lmb_volume_brick *brick;
    uint32_t cell;
    fraction t;
} waiting;

/* Irradiance by a kernel of nine numbers. */
LMB_INLINE lmb_rgb blend_irradiance(const lmb_volume *volume, uint32_t form, const unsigned char *const corner[8],
                                    fraction at, const lmb_sh3 *kernel)
{
    if (form == LMB_VOLUME_HALFS) {
        return irradiance_corners(corner, at, volume->scale, kernel);
    }
    lmb_sh3_rgb light;
    blend_compact(corner, at, volume->scale, &light);
    return lmb_volume_irradiance_sum(&light, kernel);
}

LMB_APART bool irradiance_any(const lmb_volume *volume, double x, double y, double z, const lmb_sh3 *kernel,
                              lmb_rgb *irradiance)
{
    lmb_sh3_rgb light;
    const bool inside = sample_any(volume, x, y, z, &light, NULL);
    *irradiance = lmb_volume_irradiance_sum(&light, kernel);
    return inside;
}

LMB_INLINE bool irradiance_one(const lmb_volume *volume, uint32_t form, uint32_t units, double x, double y, double z,
                               const lmb_vec3 *normal, lmb_rgb *irradiance)
{
    const place at = place_find(volume, x, y, z);
    const lmb_sh3 kernel = lmb_sh3_irradiance_kernel(*normal);
    if (!place_is_plain(&at)) {
        return irradiance_any(volume, x, y, z, &kernel, irradiance);
    }
    const unsigned char *corner[8];
    corners_find(volume, &at.brick->row[at.row], at.x, units, corner);
    *irradiance = blend_irradiance(volume, form, corner, at.t, &kernel);
    return true;
}

/* Finds the place of a later sample, and asks for what it needs next: probes, or a cut cell's record. */
LMB_INLINE void waiting_begin(const lmb_volume *volume, uint32_t units, const lmb_vec3d *position, waiting *next)
{
    const place at = place_find(volume, position->x, position->y, position->z);
    next->corner[0] = NULL;
    next->cut = NULL;
    next->t = at.t;
    if (place_is_plain(&at)) {
        corners_find(volume, &at.brick->row[at.row], at.x, units, next->corner);
        pairs_prefetch(next->corner, units);
    } else if (place_is_cut(&at)) {
        next->cut = cut_find(volume, at.brick, at.cell);
        next->brick = at.brick;
        next->cell = at.cell;
        LMB_PREFETCH(next->cut);
    }
}

/* Finds the probes of a cut cell, whose record is there by now, and asks for them. */
LMB_APART void waiting_resolve(const lmb_volume *volume, waiting *next)
{
    const bool found = cut_corners_find(volume, next->cut, next->brick, next->cell, next->t, next->corner);
    next->cut = NULL;
    if (!found) { /* corner[0] is still NULL */
        return;
    }
    for (int i = 0; i < 8; ++i) {
        LMB_PREFETCH(next->corner[i]);
        LMB_PREFETCH(next->corner[i] + volume->probe_units * LMB_PROBE_UNIT - 1);
    }
}

LMB_INLINE bool waiting_finish(const lmb_volume *volume, uint32_t form, const waiting *next, const lmb_vec3d *position,
                               lmb_sh3_rgb *radiance, float *visibility)
{
    if (!next->corner[0]) {
        return sample_any(volume, position->x, position->y, position->z, radiance, visibility);
    }
    blend(volume, form, next->corner, next->t, radiance, visibility);
    return true;
}

LMB_INLINE bool waiting_finish_irradiance(const lmb_volume *volume, uint32_t form, const waiting *next,
                                          const lmb_vec3d *position, lmb_vec3 normal, lmb_rgb *irradiance)
{
    const lmb_sh3 kernel = lmb_sh3_irradiance_kernel(normal);
    if (!next->corner[0]) {
        return irradiance_any(volume, position->x, position->y, position->z, &kernel, irradiance);
    }
    *irradiance = blend_irradiance(volume, form, next->corner, next->t, &kernel);
    return true;
}

/* What a batch is asked for: radiance with visibility or without, or irradiance on normals. */
typedef struct batch_wish {
    const lmb_volume *volume;      /* of all positions, where `each` is NULL */
    const lmb_volume *const *each; /* [position] its volume; NULL: it is outside */
    const lmb_vec3d *position;
    const lmb_vec3 *normal; /* NULL: radiance */
    size_t count;
    lmb_rgb *irradiance;
    lmb_sh3_rgb *radiance;
    float (*visibility)[LMB_KEY_LIGHTS_MOST]; /* or NULL */
    bool *inside;                             /* or NULL */
} batch_wish;

LMB_INLINE const lmb_volume *batch_volume(const batch_wish *wish, size_t i)
{
    return wish->each ? wish->each[i] : wish->volume;
}

LMB_APART bool batch_outside(const batch_wish *wish, size_t i)
{
    if (wish->normal) {
        memset(&wish->irradiance[i], 0, sizeof wish->irradiance[i]);
    } else {
        memset(&wish->radiance[i], 0, sizeof wish->radiance[i]);
    }
    if (wish->visibility) {
        memset(wish->visibility[i], 0, sizeof wish->visibility[i]);
    }
    return false;
}

/* `units`: from a probe to the next, 0 where only the volume knows. */
LMB_INLINE uint32_t units_of(const lmb_volume *volume, uint32_t units)
{
    return units > 0 ? units : volume->probe_units;
}

LMB_INLINE void batch_begin(const batch_wish *wish, uint32_t units, size_t i, waiting *next)
{
    const lmb_volume *const volume = batch_volume(wish, i);
    if (wish->each && !volume) {
        next->cut = NULL;
        return;
    }
    waiting_begin(volume, units_of(volume, units), &wish->position[i], next);
}

LMB_INLINE bool batch_finish(const batch_wish *wish, uint32_t form, size_t i, const waiting *now)
{
    const lmb_volume *const volume = batch_volume(wish, i);
    if (wish->each && !volume) {
        return batch_outside(wish, i);
    }
    return wish->normal
               ? waiting_finish_irradiance(volume, form, now, &wish->position[i], wish->normal[i], &wish->irradiance[i])
               : waiting_finish(volume, form, now, &wish->position[i], &wish->radiance[i],
                                wish->visibility ? wish->visibility[i] : NULL);
}

/* Sample i begins, i - BATCH_CUT_AHEAD is resolved, i - BATCH_AHEAD is blended. */
LMB_INLINE void batch(uint32_t form, uint32_t units, const batch_wish *wish)
{
    waiting ring[BATCH_RING];
    for (size_t i = 0; i < wish->count + BATCH_AHEAD; ++i) {
        if (i < wish->count) {
            batch_begin(wish, units, i, &ring[i % BATCH_RING]);
        }
        if (i >= BATCH_CUT_AHEAD && i - BATCH_CUT_AHEAD < wish->count && ring[(i - BATCH_CUT_AHEAD) % BATCH_RING].cut) {
            waiting_resolve(batch_volume(wish, i - BATCH_CUT_AHEAD), &ring[(i - BATCH_CUT_AHEAD) % BATCH_RING]);
        }
        if (i < BATCH_AHEAD) {
            continue;
        }
        const size_t k = i - BATCH_AHEAD;
        const bool is_inside = batch_finish(wish, form, k, &ring[k % BATCH_RING]);
        if (wish->inside) {
            wish->inside[k] = is_inside;
        }
    }
}

/* The calls, of probes of a form, at a distance that is known now, or, where it is 0, is the volume's. */
#define LMB_VOLUME_CALLS(what, form, units)                                                                            \
    static bool sample_##what(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance)           \
    {                                                                                                                  \
        return sample_one(volume, form, units_of(volume, units), x, y, z, radiance, NULL);                             \
    }                                                                                                                  \
    static bool sample_with_keys_##what(const lmb_volume *volume, double x, double y, double z, lmb_sh3_rgb *radiance, \
                                        float *visibility)                                                             \
    {                                                                                                                  \
        return sample_one(volume, form, units_of(volume, units), x, y, z, radiance, visibility);                       \
    }                                                                                                                  \
    static void batch_##what(const lmb_volume *volume, const lmb_vec3d *position, size_t count, lmb_sh3_rgb *radiance, \
                             float(*visibility)[LMB_KEY_LIGHTS_MOST], bool *inside)                                    \
    {                                                                                                                  \
        const batch_wish wish = {volume, NULL, position, NULL, count, NULL, radiance, visibility, inside};             \
        batch(form, units, &wish);                                                                                     \
    }                                                                                                                  \
    static bool irradiance_##what(const lmb_volume *volume, double x, double y, double z, const lmb_vec3 *normal,      \
                                  lmb_rgb *irradiance)                                                                 \
    {                                                                                                                  \
        return irradiance_one(volume, form, units_of(volume, units), x, y, z, normal, irradiance);                     \
    }                                                                                                                  \
    static void irradiance_batch_##what(const lmb_volume *volume, const lmb_vec3d *position, const lmb_vec3 *normal,   \
                                        size_t count, lmb_rgb *irradiance, bool *inside)                               \
    {                                                                                                                  \
        const batch_wish wish = {volume, NULL, position, normal, count, irradiance, NULL, NULL, inside};               \
        batch(form, units, &wish);                                                                                     \
    }                                                                                                                  \
    static void batch_of_##what(const lmb_volume_batch *of)                                                            \
    {                                                                                                                  \
        const batch_wish wish = {NULL, of->volume,   of->position,   NULL,      of->count,                             \
                                 NULL, of->radiance, of->visibility, of->inside};                                      \
        batch(form, units, &wish);                                                                                     \
    }                                                                                                                  \
    static void irradiance_batch_of_##what(const lmb_volume *const *volume, const lmb_vec3d *position,                 \
                                           const lmb_vec3 *normal, size_t count, lmb_rgb *irradiance, bool *inside)    \
    {                                                                                                                  \
        const batch_wish wish = {NULL, volume, position, normal, count, irradiance, NULL, NULL, inside};               \
        batch(form, units, &wish);                                                                                     \
    }                                                                                                                  \
    static const lmb_volume_calls calls_##what = {                                                                     \
        sample_##what,   sample_with_keys_##what,   batch_##what, irradiance_##what, irradiance_batch_##what,          \
        batch_of_##what, irradiance_batch_of_##what};

LMB_VOLUME_CALLS(plain, LMB_VOLUME_HALFS, LMB_HALFS_BYTES / LMB_PROBE_UNIT)
LMB_VOLUME_CALLS(keyed, LMB_VOLUME_HALFS, 0)
LMB_VOLUME_CALLS(compact, LMB_VOLUME_COMPACT, 0)

#define LMB_VOLUME_KERNEL(what)                                                                                        \
    {                                                                                                                  \
        what, &calls_plain, &calls_keyed, &calls_compact                                                               \
    }

#endif
