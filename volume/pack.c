#include <lambent/pack.h>

#include "volume_internal.h"

#include <lambent/file.h>
#include <lambent/volume_format.h>

#include <Imath/half.h>
#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(lmb_volume_header) == LMB_VOLUME_HEADER_BYTES, "the header has no padding");
_Static_assert(sizeof(lmb_volume_brick) == LMB_BRICK_BYTES, "a brick has no padding");

/* A probe as it is stored. */
typedef struct packed_probe {
    uint16_t sh[LMB_BRICK_COEFFICIENTS];
    bool has_light;
} packed_probe;

/* Bricks per axis: every cell has one, and a box one point thick still has its points. */
static size_t brick_count_along(int32_t size_points)
{
    const size_t cells = size_points > 1 ? (size_t)size_points - 1 : 1;
    return (cells + LMB_BRICK_CELLS - 1) / LMB_BRICK_CELLS;
}

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

static bool radiance_is_finite(const lmb_grid *grid)
{
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        for (int i = 0; i < LMB_BRICK_COEFFICIENTS; ++i) {
            if (!isfinite(grid->radiance[probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT])) {
                return false;
            }
        }
    }
    return true;
}

/* Converts all probes. A probe that dilation never reaches has no light and is not stored. */
static lmb_result pack_probes(const lmb_grid *grid, packed_probe *packed, lmb_pack_stats *stats, uint64_t *stored_count)
{
    int32_t *const pass = malloc((size_t)grid->probe_count * sizeof *pass);
    int32_t *const order = malloc((size_t)grid->probe_count * sizeof *order);
    lmb_result result = LMB_ERROR_MEMORY;
    if (!pass || !order) {
        goto cleanup;
    }
    int32_t reached;
    lmb_grid_dilation_passes(grid, pass, order, &reached);
    stats->scale = lmb_grid_scale(grid);
    stats->overflow_count = 0;
    for (int32_t probe = 0; probe < grid->probe_count; ++probe) {
        packed[probe].has_light = pass[probe] >= 0;
        if (packed[probe].has_light) {
            stats->overflow_count += pack_probe(&grid->radiance[probe], stats->scale, &packed[probe]);
        }
    }
    *stored_count = (uint64_t)reached;
    result = LMB_OK;
cleanup:
    free(pass);
    free(order);
    return result;
}

/* Calls for the 125 points of the brick whose first point is `first`, relative to the box: number of the lit probe
 * there, or -1. */
static int32_t stored_probe_at(const lmb_grid *grid, const packed_probe *packed, const size_t first[3], size_t point)
{
    const size_t x = first[0] + point % LMB_BRICK_POINTS;
    const size_t y = first[1] + point / LMB_BRICK_POINTS % LMB_BRICK_POINTS;
    const size_t z = first[2] + point / (LMB_BRICK_POINTS * LMB_BRICK_POINTS);
    const size_t size[3] = {(size_t)grid->size[0], (size_t)grid->size[1], (size_t)grid->size[2]};
    if (x >= size[0] || y >= size[1] || z >= size[2]) {
        return -1;
    }
    const int32_t probe = grid->probe_at[x + size[0] * (y + size[1] * z)];
    return probe >= 0 && packed[probe].has_light ? probe : -1;
}

static bool brick_has_light(const lmb_grid *grid, const packed_probe *packed, const size_t first[3])
{
    for (size_t point = 0; point < LMB_BRICK_PROBES; ++point) {
        if (stored_probe_at(grid, packed, first, point) >= 0) {
            return true;
        }
    }
    return false;
}

static bool brick_holds(const lmb_volume_brick *brick, unsigned point)
{
    return brick->probes[point / 64] >> point % 64 & 1u;
}

static void mark_complete_cells(lmb_volume_brick *brick)
{
    for (unsigned cell = 0; cell < 64; ++cell) {
        const unsigned first = cell % 4 + LMB_BRICK_POINTS * (cell / 4 % 4 + LMB_BRICK_POINTS * (cell / 16));
        bool complete = true;
        for (unsigned corner = 0; corner < 8; ++corner) {
            const unsigned x = corner & 1u, y = corner >> 1 & 1u, z = corner >> 2;
            complete = complete && brick_holds(brick, first + x + LMB_BRICK_POINTS * (y + LMB_BRICK_POINTS * z));
        }
        brick->complete_cells |= (uint64_t)complete << cell;
    }
}

static void fill_brick(const lmb_grid *grid, const packed_probe *packed, const size_t first[3], lmb_volume_brick *brick)
{
    memset(brick, 0, sizeof *brick);
    for (size_t point = 0; point < LMB_BRICK_PROBES; ++point) {
        const int32_t probe = stored_probe_at(grid, packed, first, point);
        if (probe >= 0) {
            brick->probes[point / 64] |= UINT64_C(1) << point % 64;
            memcpy(&brick->sh[point * LMB_BRICK_COEFFICIENTS], packed[probe].sh, sizeof packed[probe].sh);
        }
    }
    mark_complete_cells(brick);
}

/* Where everything lies. */
typedef struct layout {
    size_t bricks_along[3];
    size_t entries;
    uint32_t brick_count;
    size_t bricks_offset;
    size_t bytes;
} layout;

/* The first point of the brick of a directory entry. */
static void brick_first_point(const layout *at, size_t entry, size_t first[3])
{
    first[0] = LMB_BRICK_CELLS * (entry % at->bricks_along[0]);
    first[1] = LMB_BRICK_CELLS * (entry / at->bricks_along[0] % at->bricks_along[1]);
    first[2] = LMB_BRICK_CELLS * (entry / at->bricks_along[0] / at->bricks_along[1]);
}

static layout plan_layout(const lmb_grid *grid, const packed_probe *packed)
{
    layout at = {.entries = 1};
    for (int axis = 0; axis < 3; ++axis) {
        at.bricks_along[axis] = brick_count_along(grid->size[axis]);
        at.entries *= at.bricks_along[axis]; /* fewer than points, so this fits 31 bits, and 32 with the bricks */
    }
    for (size_t entry = 0; entry < at.entries; ++entry) {
        size_t first[3];
        brick_first_point(&at, entry, first);
        at.brick_count += brick_has_light(grid, packed, first);
    }
    const size_t end = LMB_VOLUME_HEADER_BYTES + at.entries * sizeof(uint32_t);
    at.bricks_offset = (end + LMB_VOLUME_ALIGNMENT - 1) / LMB_VOLUME_ALIGNMENT * LMB_VOLUME_ALIGNMENT;
    at.bytes = at.bricks_offset + at.brick_count * sizeof(lmb_volume_brick);
    return at;
}

static void write_header(const lmb_grid *grid, const layout *at, float scale, uint64_t probe_count,
                         unsigned char *image)
{
    lmb_volume_header header = {
        .version = LMB_VOLUME_VERSION,
        .header_bytes = LMB_VOLUME_HEADER_BYTES,
        .file_bytes = at->bytes,
        .spacing = grid->spacing,
        .scale = scale,
        .min = {grid->min[0], grid->min[1], grid->min[2]},
        .size = {grid->size[0], grid->size[1], grid->size[2]},
        .probe_count = probe_count,
        .brick_count = at->brick_count,
        .brick_bytes = LMB_BRICK_BYTES,
        .directory_offset = LMB_VOLUME_HEADER_BYTES,
        .bricks_offset = at->bricks_offset,
    };
    memcpy(header.magic, LMB_VOLUME_MAGIC, sizeof header.magic);
    memcpy(image, &header, sizeof header);
    header.checksum = lmb_hash(LMB_HASH_SEED, image + LMB_VOLUME_CHECKSUM_START, at->bytes - LMB_VOLUME_CHECKSUM_START);
    memcpy(image, &header, sizeof header);
}

static void write_bricks(const lmb_grid *grid, const packed_probe *packed, const layout *at, unsigned char *image)
{
    uint32_t *const directory = (uint32_t *)(image + LMB_VOLUME_HEADER_BYTES);
    lmb_volume_brick *const bricks = (lmb_volume_brick *)(image + at->bricks_offset);
    uint32_t brick = 0;
    for (size_t entry = 0; entry < at->entries; ++entry) {
        size_t first[3];
        brick_first_point(at, entry, first);
        directory[entry] = LMB_VOLUME_NO_BRICK;
        if (brick_has_light(grid, packed, first)) {
            fill_brick(grid, packed, first, &bricks[brick]);
            directory[entry] = brick++;
        }
    }
    memset(directory + at->entries, 0, at->bricks_offset - LMB_VOLUME_HEADER_BYTES - at->entries * sizeof *directory);
}

lmb_result lmb_pack(const lmb_grid *grid, unsigned char **data, size_t *size, lmb_pack_stats *stats)
{
    assert(grid && data && size);
    if (grid->probe_count == 0 || !radiance_is_finite(grid)) {
        return LMB_ERROR_ARGUMENT;
    }
    packed_probe *const packed = malloc((size_t)grid->probe_count * sizeof *packed);
    if (!packed) {
        return LMB_ERROR_MEMORY;
    }
    lmb_pack_stats counted;
    uint64_t stored_count;
    lmb_result result = pack_probes(grid, packed, &counted, &stored_count);
    if (result != LMB_OK) {
        goto cleanup;
    }
    if (stored_count == 0) {
        result = LMB_ERROR_ARGUMENT;
        goto cleanup;
    }
    const layout at = plan_layout(grid, packed);
    unsigned char *const image = aligned_alloc(LMB_VOLUME_ALIGNMENT, at.bytes);
    if (!image) {
        result = LMB_ERROR_MEMORY;
        goto cleanup;
    }
    write_bricks(grid, packed, &at, image);
    write_header(grid, &at, counted.scale, stored_count, image);
    counted.bytes = at.bytes;
    if (stats) {
        *stats = counted;
    }
    *data = image;
    *size = at.bytes;
cleanup:
    free(packed);
    return result;
}
