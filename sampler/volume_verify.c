#include "volume_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the .lmb file is used in place and is little-endian"
#endif
_Static_assert(sizeof(lmb_volume_header) == LMB_VOLUME_HEADER_BYTES, "the header has no padding");
_Static_assert(sizeof(lmb_volume_keys) == LMB_VOLUME_KEYS_BYTES, "nor have key lights");
_Static_assert(sizeof(lmb_volume_brick) == LMB_BRICK_BYTES, "a brick has no padding");
_Static_assert(sizeof(lmb_brick_visibility) == LMB_BRICK_KEY_BYTES, "nor has what follows it");

/* Of the header with key lights. */
static uint32_t header_bytes(uint32_t version)
{
    return version == LMB_VOLUME_VERSION_WITH_KEYS ? LMB_VOLUME_HEADER_BYTES + LMB_VOLUME_KEYS_BYTES
                                                   : LMB_VOLUME_HEADER_BYTES;
}

/* Magic, version, size and checksum: are these the bytes that were written, and can this library read them? */
static lmb_result check_envelope(const unsigned char *data, size_t size, lmb_volume_header *header)
{
    const size_t magic_size = size < LMB_VOLUME_MAGIC_SIZE ? size : LMB_VOLUME_MAGIC_SIZE;
    if (memcmp(data, LMB_VOLUME_MAGIC, magic_size) != 0) {
        return LMB_ERROR_FORMAT;
    }
    uint32_t version;
    if (size < LMB_VOLUME_MAGIC_SIZE + sizeof version) {
        return LMB_ERROR_TRUNCATED;
    }
    memcpy(&version, data + LMB_VOLUME_MAGIC_SIZE, sizeof version);
    if (version != LMB_VOLUME_VERSION && version != LMB_VOLUME_VERSION_WITH_KEYS) {
        return version > LMB_VOLUME_VERSION_WITH_KEYS ? LMB_ERROR_VERSION : LMB_ERROR_FORMAT;
    }
    if (size < header_bytes(version)) {
        return LMB_ERROR_TRUNCATED;
    }
    memcpy(header, data, sizeof *header);
    if (header->header_bytes != header_bytes(version) || header->file_bytes < header_bytes(version) ||
        header->file_bytes < size) {
        return LMB_ERROR_FORMAT;
    }
    if (header->file_bytes > size) {
        return LMB_ERROR_TRUNCATED;
    }
    const uint64_t checksum =
        lmb_volume_hash(LMB_VOLUME_HASH_SEED, data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    return checksum == header->checksum ? LMB_OK : LMB_ERROR_CHECKSUM;
}

static bool key_light_is_sane(const lmb_key_light *light)
{
    const double x = (double)light->direction.x, y = (double)light->direction.y, z = (double)light->direction.z;
    bool sane = fabs(x * x + y * y + z * z - 1.0) <= 1e-4; /* not of NaN or infinity */
    for (int c = 0; c < 3; ++c) {
        sane = sane && light->irradiance.c[c] >= 0.0f && light->irradiance.c[c] <= FLT_MAX;
    }
    return sane;
}

static bool keys_are_sane(const lmb_volume_keys *keys)
{
    static const lmb_key_light none = {{0.0f, 0.0f, 0.0f}, {{0.0f, 0.0f, 0.0f}}};
    bool sane = keys->count >= 1 && keys->count <= LMB_KEY_LIGHTS_MOST;
    for (size_t i = 0; i < sizeof keys->reserved / sizeof keys->reserved[0]; ++i) {
        sane = sane && keys->reserved[i] == 0;
    }
    for (uint32_t i = 0; i < LMB_KEY_LIGHTS_MOST; ++i) {
        sane = sane && (i < keys->count ? key_light_is_sane(&keys->light[i])
                                        : memcmp(&keys->light[i], &none, sizeof none) == 0);
    }
    return sane;
}

/* Every number of the header by itself; `stride` of bricks with what follows them. */
static bool header_is_sane(const lmb_volume_header *header, size_t stride)
{
    int exponent;
    if (!isfinite(header->spacing) || header->spacing <= 0.0f || !isfinite(header->scale) ||
        frexpf(header->scale, &exponent) != 0.5f || exponent - 1 > LMB_VOLUME_MAX_SCALE_LOG2 ||
        exponent - 1 < -LMB_VOLUME_MAX_SCALE_LOG2) {
        return false;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t first = header->min[axis];
        const int64_t last = first + header->size[axis] - 1;
        if (header->size[axis] < 1 || last > INT32_MAX || !isfinite((float)first * header->spacing) ||
            !isfinite((float)last * header->spacing)) {
            return false;
        }
    }
    for (size_t i = 0; i < sizeof header->reserved / sizeof header->reserved[0]; ++i) {
        if (header->reserved[i] != 0) {
            return false;
        }
    }
    return header->probe_count > 0 && header->brick_count > 0 && header->brick_bytes == stride &&
           header->directory_offset == header->header_bytes;
}

/* Directory and bricks fill the file exactly. Sets bricks_along and *entries. */
static bool plan_layout(const lmb_volume_header *header, lmb_volume *volume, size_t *entries)
{
    uint64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        volume->last_cell[axis] = header->size[axis] > 1 ? header->size[axis] - 2 : 0;
        volume->bricks_along[axis] = lmb_lattice_bricks_along(header->size[axis]);
        count *= volume->bricks_along[axis]; /* below 2^32 * 2^30 before the next test */
        if (count > header->file_bytes / sizeof(uint32_t)) {
            return false;
        }
    }
    const uint64_t end = header->header_bytes + count * sizeof(uint32_t);
    const uint64_t bricks_offset = (end + LMB_VOLUME_ALIGNMENT - 1) / LMB_VOLUME_ALIGNMENT * LMB_VOLUME_ALIGNMENT;
    *entries = (size_t)count;
    return header->bricks_offset == bricks_offset && header->file_bytes >= bricks_offset &&
           header->file_bytes - bricks_offset == header->brick_count * (uint64_t)volume->brick_stride;
}

/* All halfs finite: exponent 31 is infinity or NaN. Those of points without a probe, and the five at the end, are 0. */
static bool brick_halfs_are_sane(const lmb_volume_brick *brick)
{
    uint32_t broken = 0;
    for (uint32_t point = 0; point < LMB_BRICK_PROBES; ++point) {
        const uint32_t allowed = lmb_brick_holds(brick, point) ? 0xffffu : 0;
        for (uint32_t i = 0; i < LMB_BRICK_COEFFICIENTS; ++i) {
            const uint32_t half = brick->sh[point * LMB_BRICK_COEFFICIENTS + i];
            broken |= (half & ~allowed) | (uint32_t)((half & 0x7c00u) == 0x7c00u);
        }
    }
    for (uint32_t i = LMB_BRICK_PROBES * LMB_BRICK_COEFFICIENTS; i < sizeof brick->sh / sizeof brick->sh[0]; ++i) {
        broken |= brick->sh[i];
    }
    return broken == 0;
}

/* What is seen of key lights is 0 at points without a probe, and in the three bytes at the end. */
static bool brick_visibility_is_sane(const lmb_volume *volume, const lmb_volume_brick *brick)
{
    const lmb_brick_visibility *const stored = lmb_volume_brick_visibility(brick);
    bool sane = true;
    for (uint32_t key = 0; volume->keys && key < volume->keys->count; ++key) {
        for (uint32_t point = 0; point < LMB_BRICK_KEY_BYTES; ++point) {
            const bool held = point < LMB_BRICK_PROBES && lmb_brick_holds(brick, point);
            sane = sane && (held || stored[key].seen[point] == 0);
        }
    }
    return sane;
}

static bool complete_cells_are_sane(const lmb_volume_brick *brick)
{
    for (uint32_t cell = 0; cell < 64; ++cell) {
        const uint32_t first =
            lmb_brick_point(cell % LMB_BRICK_CELLS, cell / LMB_BRICK_CELLS % LMB_BRICK_CELLS, cell / 16);
        bool complete = true;
        for (uint32_t corner = 0; corner < 8; ++corner) {
            complete = complete && lmb_brick_holds(brick, first + lmb_brick_corner(corner));
        }
        if (complete != (brick->complete_cells >> cell & 1u)) {
            return false;
        }
    }
    return true;
}

/* Probes of the brick that lie in the box, each counted by one brick only: the one that it is not the far border of,
 * unless the box ends there. @return false when a probe lies outside the box */
static bool count_probes(const lmb_volume *volume, const lmb_volume_brick *brick, const size_t at[3], uint64_t *count)
{
    for (uint32_t point = 0; point < LMB_BRICK_PROBES; ++point) {
        if (!lmb_brick_holds(brick, point)) {
            continue;
        }
        const uint32_t local[3] = {point % LMB_BRICK_POINTS, point / LMB_BRICK_POINTS % LMB_BRICK_POINTS,
                                   point / (LMB_BRICK_POINTS * LMB_BRICK_POINTS)};
        bool owned = true;
        for (int axis = 0; axis < 3; ++axis) {
            if (at[axis] * LMB_BRICK_CELLS + local[axis] >= (size_t)volume->header.size[axis]) {
                return false;
            }
            owned = owned && (local[axis] < LMB_BRICK_CELLS || at[axis] + 1 == volume->bricks_along[axis]);
        }
        *count += owned;
    }
    return brick->probes[1] >> (LMB_BRICK_PROBES - 64) == 0;
}

/* The n-th entry that names a brick names brick n; each brick is sane; the header counted right. */
static bool contents_are_sane(const lmb_volume *volume, size_t entries)
{
    uint32_t next = 0;
    uint64_t probe_count = 0;
    for (size_t entry = 0; entry < entries; ++entry) {
        if (volume->directory[entry] == LMB_VOLUME_NO_BRICK) {
            continue;
        }
        if (volume->directory[entry] != next || next == volume->header.brick_count) {
            return false;
        }
        const lmb_volume_brick *const brick = lmb_volume_brick_at(volume, next++);
        const size_t along_x = volume->bricks_along[0], along_y = volume->bricks_along[1];
        const size_t at[3] = {entry % along_x, entry / along_x % along_y, entry / along_x / along_y};
        if (!brick_halfs_are_sane(brick) || !brick_visibility_is_sane(volume, brick) ||
            !complete_cells_are_sane(brick) || !count_probes(volume, brick, at, &probe_count)) {
            return false;
        }
    }
    const unsigned char *padding = (const unsigned char *)(volume->directory + entries);
    for (; padding < volume->bricks; ++padding) {
        if (*padding != 0) {
            return false;
        }
    }
    return next == volume->header.brick_count && probe_count == volume->header.probe_count;
}

lmb_result lmb_volume_verify(const unsigned char *data, size_t size, lmb_volume *volume)
{
    const lmb_result result = check_envelope(data, size, &volume->header);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_volume_header *const header = &volume->header;
    const bool with_keys = header->version == LMB_VOLUME_VERSION_WITH_KEYS;
    volume->keys = with_keys ? (const lmb_volume_keys *)(data + LMB_VOLUME_HEADER_BYTES) : NULL;
    if (volume->keys && !keys_are_sane(volume->keys)) {
        return LMB_ERROR_FORMAT;
    }
    volume->brick_stride = LMB_BRICK_BYTES + (volume->keys ? volume->keys->count * (size_t)LMB_BRICK_KEY_BYTES : 0);
    size_t entries;
    if (!header_is_sane(header, volume->brick_stride) || !plan_layout(header, volume, &entries)) {
        return LMB_ERROR_FORMAT;
    }
    volume->directory = (const uint32_t *)(data + header->directory_offset);
    volume->bricks = data + header->bricks_offset;
    return contents_are_sane(volume, entries) ? LMB_OK : LMB_ERROR_FORMAT;
}
