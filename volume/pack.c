#include <lambent/pack.h>

#include "volume_internal.h"

#include <lambent/file.h>
#include <lambent/lattice.h>
#include <lambent/vector.h>

#include <Imath/half.h>
#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(lmb_volume_header) == LMB_VOLUME_HEADER_BYTES, "the header has no padding");
_Static_assert(sizeof(lmb_volume_keys) == LMB_VOLUME_KEYS_BYTES, "nor have key lights");
_Static_assert(sizeof(lmb_volume_brick) == LMB_BRICK_BYTES, "a brick has no padding");
_Static_assert(sizeof(lmb_brick_visibility) == LMB_BRICK_KEY_BYTES, "nor has what follows it");

/* A probe as it is stored. */
typedef struct packed_probe {
    uint16_t sh[LMB_BRICK_COEFFICIENTS];
    uint8_t seen[LMB_KEY_LIGHTS_MOST]; /* of key lights */
    bool has_light;
} packed_probe;

/* @return coefficients that even the scale does not bring into fp16 */
static uint64_t pack_probe(const lmb_sh3_rgb *radiance, float scale, packed_probe *packed)
{
    float value[LMB_BRICK_COEFFICIENTS];
    float largest = 0.0f;
    uint64_t overflow_count = 0;
    for (int i = 0; i < LMB_BRICK_COEFFICIENTS; ++i) {
        value[i] = radiance->channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] / scale;
        largest = fmaxf(largest, fabsf(value[i]));
        overflow_count += fabsf(value[i]) > LMB_HALF_MAX;
    }
    for (int i = 0; i < LMB_BRICK_COEFFICIENTS; ++i) {
        /* Down to exactly the largest half at most: the quotient is at most 1. */
        packed->sh[i] = imath_float_to_half(overflow_count > 0 ? LMB_HALF_MAX * (value[i] / largest) : value[i]);
    }
    return overflow_count;
}

static void pack_visibility(const lmb_probes *probes, int32_t probe, packed_probe *packed)
{
    for (uint32_t key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
        const float seen = key < probes->key_light_count ? probes->key_visibility[probe][key] : 0.0f;
        packed->seen[key] = (uint8_t)(lmb_saturate(seen) * 255.0f + 0.5f);
    }
}

static bool radiance_is_finite(const lmb_probes *probes)
{
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        for (int i = 0; i < LMB_BRICK_COEFFICIENTS; ++i) {
            if (!isfinite(probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT])) {
                return false;
            }
        }
    }
    return true;
}

/* Converts all probes. A probe that dilation never reaches has no light and is not stored. */
static lmb_result pack_probes(const lmb_probes *probes, packed_probe *packed, lmb_pack_stats *stats,
                              uint64_t *stored_count)
{
    int32_t *const pass = malloc((size_t)probes->count * sizeof *pass);
    int32_t *const order = malloc((size_t)probes->count * sizeof *order);
    lmb_result result = LMB_ERROR_MEMORY;
    if (!pass || !order) {
        goto cleanup;
    }
    int32_t reached;
    lmb_probes_dilation_passes(probes, pass, order, &reached);
    stats->scale = lmb_probes_scale(probes);
    stats->overflow_count = 0;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        packed[probe].has_light = pass[probe] >= 0;
        if (packed[probe].has_light) {
            stats->overflow_count += pack_probe(&probes->radiance[0][probe], stats->scale, &packed[probe]);
            pack_visibility(probes, probe, &packed[probe]);
        }
    }
    *stored_count = (uint64_t)reached;
    result = LMB_OK;
cleanup:
    free(pass);
    free(order);
    return result;
}

/* Number of the lit probe at one of the 125 points of the brick whose first point is `first`, or -1. */
static int32_t stored_probe_at(const lmb_probes *probes, const packed_probe *packed, const int32_t first[3],
                               int32_t point)
{
    const lmb_lattice *lattice = &probes->level[0].lattice;
    const int32_t offset[3] = {point % LMB_BRICK_POINTS, point / LMB_BRICK_POINTS % LMB_BRICK_POINTS,
                               point / (LMB_BRICK_POINTS * LMB_BRICK_POINTS)};
    int32_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t end = (int64_t)lattice->min[axis] + lattice->size[axis];
        if (first[axis] + (int64_t)offset[axis] >= end) {
            return -1;
        }
        at[axis] = first[axis] + offset[axis];
    }
    const int32_t probe = lmb_probes_find(probes, 0, at[0], at[1], at[2]);
    return probe >= 0 && packed[probe].has_light ? probe : -1;
}

static void mark_complete_cells(lmb_volume_brick *brick)
{
    for (unsigned cell = 0; cell < 64; ++cell) {
        const unsigned first =
            lmb_brick_point(cell % LMB_BRICK_CELLS, cell / LMB_BRICK_CELLS % LMB_BRICK_CELLS, cell / 16);
        bool complete = true;
        for (unsigned corner = 0; corner < 8; ++corner) {
            complete = complete && lmb_brick_holds(brick, first + lmb_brick_corner(corner));
        }
        brick->complete_cells |= (uint64_t)complete << cell;
    }
}

static void fill_brick(const lmb_probes *probes, const packed_probe *packed, const int32_t first[3],
                       lmb_volume_brick *brick)
{
    lmb_brick_visibility *const visibility = (lmb_brick_visibility *)(brick + 1);
    memset(brick, 0, sizeof *brick);
    memset(visibility, 0, probes->key_light_count * sizeof *visibility);
    for (int32_t point = 0; point < LMB_BRICK_PROBES; ++point) {
        const int32_t probe = stored_probe_at(probes, packed, first, point);
        if (probe >= 0) {
            brick->probes[point / 64] |= UINT64_C(1) << point % 64;
            memcpy(&brick->sh[point * LMB_BRICK_COEFFICIENTS], packed[probe].sh, sizeof packed[probe].sh);
            for (uint32_t key = 0; key < probes->key_light_count; ++key) {
                visibility[key].seen[point] = packed[probe].seen[key];
            }
        }
    }
    mark_complete_cells(brick);
}

/* More bricks than lattices of 2^31 points have. */
#define MOST_ENTRIES ((size_t)1 << 31)

/* Where everything lies. */
typedef struct layout {
    size_t header_bytes;
    size_t brick_bytes; /* with what follows it */
    size_t bricks_along[3];
    size_t entries;
    uint32_t brick_count;
    size_t bricks_offset;
    size_t bytes;
} layout;

/* The first point of the brick of a directory entry. */
static void brick_first_point(const lmb_lattice *lattice, const layout *at, size_t entry, int32_t first[3])
{
    const size_t brick[3] = {entry % at->bricks_along[0], entry / at->bricks_along[0] % at->bricks_along[1],
                             entry / at->bricks_along[0] / at->bricks_along[1]};
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = (int32_t)(lattice->min[axis] + (int64_t)(LMB_BRICK_CELLS * brick[axis]));
    }
}

/* The directory has an entry for every brick of the box. */
static bool plan_directory(const lmb_probes *probes, layout *at)
{
    const lmb_lattice *lattice = &probes->level[0].lattice;
    const size_t keys = probes->key_light_count;
    *at = (layout){.header_bytes = LMB_VOLUME_HEADER_BYTES + (keys > 0 ? LMB_VOLUME_KEYS_BYTES : 0),
                   .brick_bytes = LMB_BRICK_BYTES + keys * LMB_BRICK_KEY_BYTES,
                   .entries = 1};
    for (int axis = 0; axis < 3; ++axis) {
        at->bricks_along[axis] = lmb_lattice_bricks_along(lattice->size[axis]);
        if (at->bricks_along[axis] > MOST_ENTRIES / at->entries) {
            return false;
        }
        at->entries *= at->bricks_along[axis];
    }
    return true;
}

/* Marks the bricks that hold a point: along each axis one, or two where they share it. */
static void mark_bricks(const lmb_lattice *lattice, const layout *at, const int32_t point[3], uint8_t *has_light)
{
    size_t first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
        const size_t local = (size_t)((int64_t)point[axis] - lattice->min[axis]);
        const size_t brick = local / LMB_BRICK_CELLS;
        first[axis] = local > 0 && local % LMB_BRICK_CELLS == 0 ? brick - 1 : brick;
        last[axis] = brick < at->bricks_along[axis] ? brick : brick - 1;
    }
    for (size_t z = first[2]; z <= last[2]; ++z) {
        for (size_t y = first[1]; y <= last[1]; ++y) {
            for (size_t x = first[0]; x <= last[0]; ++x) {
                has_light[lmb_lattice_brick(at->bricks_along, x, y, z)] = 1;
            }
        }
    }
}

/* Finds by way of the probes, as few of a large box's bricks hold any. */
static void plan_bricks(const lmb_probes *probes, const packed_probe *packed, uint8_t *has_light, layout *at)
{
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        if (packed[probe].has_light) {
            mark_bricks(&probes->level[0].lattice, at, probes->point[probe], has_light);
        }
    }
    for (size_t entry = 0; entry < at->entries; ++entry) {
        at->brick_count += has_light[entry];
    }
    const size_t end = at->header_bytes + at->entries * sizeof(uint32_t);
    at->bricks_offset = (end + LMB_VOLUME_ALIGNMENT - 1) / LMB_VOLUME_ALIGNMENT * LMB_VOLUME_ALIGNMENT;
    at->bytes = at->bricks_offset + at->brick_count * at->brick_bytes;
}

static void write_key_lights(const lmb_probes *probes, unsigned char *image)
{
    lmb_volume_keys keys = {.count = probes->key_light_count};
    memcpy(keys.light, probes->key_light, keys.count * sizeof *keys.light);
    memcpy(image + LMB_VOLUME_HEADER_BYTES, &keys, sizeof keys);
}

static void write_header(const lmb_probes *probes, const layout *at, float scale, uint64_t probe_count,
                         unsigned char *image)
{
    const lmb_lattice *lattice = &probes->level[0].lattice;
    lmb_volume_header header = {
        .version = probes->key_light_count > 0 ? LMB_VOLUME_VERSION_WITH_KEYS : LMB_VOLUME_VERSION,
        .header_bytes = (uint32_t)at->header_bytes,
        .file_bytes = at->bytes,
        .spacing = lattice->spacing,
        .scale = scale,
        .min = {lattice->min[0], lattice->min[1], lattice->min[2]},
        .size = {lattice->size[0], lattice->size[1], lattice->size[2]},
        .probe_count = probe_count,
        .brick_count = at->brick_count,
        .brick_bytes = (uint32_t)at->brick_bytes,
        .directory_offset = at->header_bytes,
        .bricks_offset = at->bricks_offset,
    };
    memcpy(header.magic, LMB_VOLUME_MAGIC, sizeof header.magic);
    memcpy(image, &header, sizeof header);
    header.checksum = lmb_hash(LMB_HASH_SEED, image + LMB_VOLUME_CHECKSUM_START, at->bytes - LMB_VOLUME_CHECKSUM_START);
    memcpy(image, &header, sizeof header);
}

static void write_bricks(const lmb_probes *probes, const packed_probe *packed, const uint8_t *has_light,
                         const layout *at, unsigned char *image)
{
    uint32_t *const directory = (uint32_t *)(image + at->header_bytes);
    uint32_t brick = 0;
    for (size_t entry = 0; entry < at->entries; ++entry) {
        directory[entry] = LMB_VOLUME_NO_BRICK;
        if (has_light[entry]) {
            int32_t first[3];
            brick_first_point(&probes->level[0].lattice, at, entry, first);
            unsigned char *const to = image + at->bricks_offset + brick * at->brick_bytes;
            fill_brick(probes, packed, first, (lmb_volume_brick *)to);
            directory[entry] = brick++;
        }
    }
    memset(directory + at->entries, 0, at->bricks_offset - at->header_bytes - at->entries * sizeof *directory);
}

lmb_result lmb_pack(const lmb_probes *probes, unsigned char **data, size_t *size, lmb_pack_stats *stats)
{
    assert(probes && data && size);
    layout at;
    if (probes->count == 0 || probes->level_count != 1 || probes->set_count != 1 ||
        lmb_lattice_is_turned(&probes->level[0].lattice) || probes->key_light_count > LMB_KEY_LIGHTS_MOST ||
        !radiance_is_finite(probes) || !plan_directory(probes, &at)) {
        return LMB_ERROR_ARGUMENT;
    }
    packed_probe *const packed = malloc((size_t)probes->count * sizeof *packed);
    uint8_t *const has_light = calloc(at.entries, 1);
    lmb_pack_stats counted;
    uint64_t stored_count;
    lmb_result result = packed && has_light ? pack_probes(probes, packed, &counted, &stored_count) : LMB_ERROR_MEMORY;
    if (result != LMB_OK) {
        goto cleanup;
    }
    if (stored_count == 0) {
        result = LMB_ERROR_ARGUMENT;
        goto cleanup;
    }
    plan_bricks(probes, packed, has_light, &at);
    unsigned char *const image = aligned_alloc(LMB_VOLUME_ALIGNMENT, at.bytes);
    if (!image) {
        result = LMB_ERROR_MEMORY;
        goto cleanup;
    }
    write_bricks(probes, packed, has_light, &at, image);
    if (probes->key_light_count > 0) {
        write_key_lights(probes, image);
    }
    write_header(probes, &at, counted.scale, stored_count, image);
    counted.bytes = at.bytes;
    if (stats) {
        *stats = counted;
    }
    *data = image;
    *size = at.bytes;
cleanup:
    free(has_light);
    free(packed);
    return result;
}
