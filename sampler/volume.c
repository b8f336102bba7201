#define _POSIX_C_SOURCE 200809L

#include <lambent/volume.h>

#include <lambent/volume_format.h>

#include <assert.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the .lmb file is used in place and is little-endian"
#endif
_Static_assert(sizeof(lmb_volume_header) == LMB_VOLUME_HEADER_BYTES, "the header has no padding");
_Static_assert(sizeof(lmb_volume_brick) == LMB_BRICK_BYTES, "a brick has no padding");

enum { ROW = LMB_BRICK_POINTS, SLICE = LMB_BRICK_POINTS * LMB_BRICK_POINTS };

/* Halfs read at once from a probe: its 27 and 5 of what follows, so that the loop has a round number of turns. */
enum { LANES = 32 };

struct lmb_volume {
    const uint32_t *directory;
    const lmb_volume_brick *bricks;
    double inverse_spacing;
    double min[3];        /* lattice coordinates */
    double last[3];       /* of the box's last point, relative to min */
    int32_t last_cell[3]; /* >= 0 even where the box is one point thick */
    size_t bricks_along[3];
    double slack; /* lattice units that a float position near a lattice point may be off it */
    float scale;
    lmb_volume_header header;
    void *mapping; /* NULL when the caller owns the memory */
};

/* ---------------------------------------------------------------------------------------------- opening */

/* 64-bit FNV-1a. */
static uint64_t hash_bytes(const unsigned char *data, size_t size)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < size; ++i) {
        hash = (hash ^ data[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
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
    if (version != LMB_VOLUME_VERSION) {
        return version > LMB_VOLUME_VERSION ? LMB_ERROR_VERSION : LMB_ERROR_FORMAT;
    }
    if (size < sizeof *header) {
        return LMB_ERROR_TRUNCATED;
    }
    memcpy(header, data, sizeof *header);
    if (header->header_bytes != LMB_VOLUME_HEADER_BYTES || header->file_bytes < LMB_VOLUME_HEADER_BYTES ||
        header->file_bytes < size) {
        return LMB_ERROR_FORMAT;
    }
    if (header->file_bytes > size) {
        return LMB_ERROR_TRUNCATED;
    }
    const uint64_t checksum = hash_bytes(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    return checksum == header->checksum ? LMB_OK : LMB_ERROR_CHECKSUM;
}

/* Every number of the header by itself. */
static bool header_is_sane(const lmb_volume_header *header)
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
    return header->probe_count > 0 && header->brick_count > 0 && header->brick_bytes == LMB_BRICK_BYTES &&
           header->directory_offset == LMB_VOLUME_HEADER_BYTES;
}

/* Directory and bricks fill the file exactly. Sets bricks_along and *entries. */
static bool plan_layout(const lmb_volume_header *header, lmb_volume *volume, size_t *entries)
{
    uint64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        volume->last_cell[axis] = header->size[axis] > 1 ? header->size[axis] - 2 : 0;
        volume->bricks_along[axis] = (size_t)volume->last_cell[axis] / LMB_BRICK_CELLS + 1;
        count *= volume->bricks_along[axis]; /* below 2^32 * 2^30 before the next test */
        if (count > header->file_bytes / sizeof(uint32_t)) {
            return false;
        }
    }
    const uint64_t end = LMB_VOLUME_HEADER_BYTES + count * sizeof(uint32_t);
    const uint64_t bricks_offset = (end + LMB_VOLUME_ALIGNMENT - 1) / LMB_VOLUME_ALIGNMENT * LMB_VOLUME_ALIGNMENT;
    *entries = (size_t)count;
    return header->bricks_offset == bricks_offset && header->file_bytes >= bricks_offset &&
           header->file_bytes - bricks_offset == header->brick_count * (uint64_t)LMB_BRICK_BYTES;
}

static bool brick_holds(const lmb_volume_brick *brick, uint32_t point)
{
    return brick->probes[point / 64] >> point % 64 & 1u;
}

/* All halfs finite: exponent 31 is infinity or NaN. Those of points without a probe, and the five at the end, are 0. */
static bool brick_halfs_are_sane(const lmb_volume_brick *brick)
{
    uint32_t broken = 0;
    for (uint32_t point = 0; point < LMB_BRICK_PROBES; ++point) {
        const uint32_t allowed = brick_holds(brick, point) ? 0xffffu : 0;
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

static bool complete_cells_are_sane(const lmb_volume_brick *brick)
{
    for (uint32_t cell = 0; cell < 64; ++cell) {
        const uint32_t first = cell % 4 + ROW * (cell / 4 % 4) + SLICE * (cell / 16);
        bool complete = true;
        for (uint32_t corner = 0; corner < 8; ++corner) {
            complete = complete &&
                       brick_holds(brick, first + (corner & 1u) + ROW * (corner >> 1 & 1u) + SLICE * (corner >> 2));
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
        if (!brick_holds(brick, point)) {
            continue;
        }
        const uint32_t local[3] = {point % ROW, point / ROW % ROW, point / SLICE};
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
        const lmb_volume_brick *const brick = &volume->bricks[next++];
        const size_t along_x = volume->bricks_along[0], along_y = volume->bricks_along[1];
        const size_t at[3] = {entry % along_x, entry / along_x % along_y, entry / along_x / along_y};
        if (!brick_halfs_are_sane(brick) || !complete_cells_are_sane(brick) ||
            !count_probes(volume, brick, at, &probe_count)) {
            return false;
        }
    }
    const unsigned char *padding = (const unsigned char *)(volume->directory + entries);
    for (; padding < (const unsigned char *)volume->bricks; ++padding) {
        if (*padding != 0) {
            return false;
        }
    }
    return next == volume->header.brick_count && probe_count == volume->header.probe_count;
}

/* What sampling needs, from a sane header. */
static void derive_constants(lmb_volume *volume)
{
    const lmb_volume_header *const header = &volume->header;
    double farthest = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        volume->min[axis] = header->min[axis];
        volume->last[axis] = header->size[axis] - 1.0;
        farthest = fmax(farthest, fmax(fabs(volume->min[axis]), fabs(volume->min[axis] + volume->last[axis])));
    }
    volume->inverse_spacing = 1.0 / (double)header->spacing;
    volume->scale = header->scale;
    /* Four times the rounding of a float of that size, and never a share of a cell that matters. */
    volume->slack = fmin(farthest * 0x1p-22, 0x1p-6);
}

lmb_result lmb_volume_open_memory(const void *data, size_t size, lmb_volume **volume)
{
    const bool arguments_are_valid = data && volume && (uintptr_t)data % 16 == 0;
    assert(arguments_are_valid);
    if (!arguments_are_valid) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_volume opened = {.mapping = NULL};
    const lmb_result result = check_envelope(data, size, &opened.header);
    if (result != LMB_OK) {
        return result;
    }
    size_t entries;
    if (!header_is_sane(&opened.header) || !plan_layout(&opened.header, &opened, &entries)) {
        return LMB_ERROR_FORMAT;
    }
    const unsigned char *const bytes = data;
    opened.directory = (const uint32_t *)(bytes + LMB_VOLUME_HEADER_BYTES);
    opened.bricks = (const lmb_volume_brick *)(bytes + opened.header.bricks_offset);
    if (!contents_are_sane(&opened, entries)) {
        return LMB_ERROR_FORMAT;
    }
    derive_constants(&opened);
    lmb_volume *const handle = malloc(sizeof *handle);
    if (!handle) {
        return LMB_ERROR_MEMORY;
    }
    *handle = opened;
    *volume = handle;
    return LMB_OK;
}

/* Maps a regular file that is not empty. */
static lmb_result map_file(const char *path, void **mapping, size_t *size)
{
    /* Not blocking: opening a pipe would wait for its other end. */
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        return LMB_ERROR_IO;
    }
    lmb_result result = LMB_ERROR_IO;
    struct stat status;
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        goto cleanup;
    }
    if (status.st_size == 0) {
        result = LMB_ERROR_TRUNCATED;
        goto cleanup;
    }
    if ((uintmax_t)status.st_size > SIZE_MAX) {
        goto cleanup;
    }
    *size = (size_t)status.st_size;
    *mapping = mmap(NULL, *size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    result = *mapping == MAP_FAILED ? LMB_ERROR_IO : LMB_OK;
cleanup:
    close(descriptor);
    return result;
}

lmb_result lmb_volume_open_file(const char *path, lmb_volume **volume)
{
    assert(path && volume);
    if (!path || !volume) {
        return LMB_ERROR_ARGUMENT;
    }
    void *mapping;
    size_t size;
    lmb_result result = map_file(path, &mapping, &size);
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_volume_open_memory(mapping, size, volume);
    if (result != LMB_OK) {
        munmap(mapping, size);
        return result;
    }
    (*volume)->mapping = mapping;
    return LMB_OK;
}

void lmb_volume_close(lmb_volume *volume)
{
    if (volume) {
        if (volume->mapping) {
            munmap(volume->mapping, (size_t)volume->header.file_bytes);
        }
        free(volume);
    }
}

lmb_volume_info lmb_volume_get_info(const lmb_volume *volume)
{
    assert(volume);
    const lmb_volume_header *const header = &volume->header;
    const float spacing = header->spacing;
    return (lmb_volume_info){
        .version = header->version,
        .spacing = spacing,
        .min = {header->min[0], header->min[1], header->min[2]},
        .size = {header->size[0], header->size[1], header->size[2]},
        .probe_count = header->probe_count,
        .brick_count = header->brick_count,
        .bounds_min = {(float)header->min[0] * spacing, (float)header->min[1] * spacing,
                       (float)header->min[2] * spacing},
        .bounds_max = {(float)(header->min[0] + (header->size[0] - 1)) * spacing,
                       (float)(header->min[1] + (header->size[1] - 1)) * spacing,
                       (float)(header->min[2] + (header->size[2] - 1)) * spacing},
        .scale = header->scale,
        .file_bytes = header->file_bytes,
    };
}

/* --------------------------------------------------------------------------------------------- sampling */

/* The cell along one axis and the place in it, 0 to 1. @return false when the position was outside and clamped */
static inline bool locate(const lmb_volume *volume, int axis, double position, int32_t *cell, float *t)
{
    const double last = volume->last[axis];
    const double at = position * volume->inverse_spacing - volume->min[axis];
    const double clamped = at > 0.0 ? (at < last ? at : last) : 0.0;
    const int32_t whole = (int32_t)clamped;
    *cell = whole < volume->last_cell[axis] ? whole : volume->last_cell[axis];
    *t = (float)(clamped - *cell);
    return at >= -volume->slack && at <= last + volume->slack;
}

/* Number of corner `i` (bit 0 is x, 1 is y, 2 is z) among the brick's points, relative to the cell's first. */
static inline uint32_t corner_offset(uint32_t i)
{
    return (i & 1u) + ROW * (i >> 1 & 1u) + SLICE * (i >> 2);
}

/* Gives the weight of missing corners to the others.
 * @return true when no missing corner had any weight to speak of */
static bool reweigh_corners(const lmb_volume_brick *brick, uint32_t first, const float t[3], double slack,
                            float weight[8])
{
    double share[8];
    double held = 0.0;
    double missing = 0.0;
    uint32_t held_count = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        const double x = i & 1u ? (double)t[0] : 1.0 - (double)t[0];
        const double y = i & 2u ? (double)t[1] : 1.0 - (double)t[1];
        const double z = i & 4u ? (double)t[2] : 1.0 - (double)t[2];
        share[i] = x * y * z;
        if (brick_holds(brick, first + corner_offset(i))) {
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

/* The bits of a finite half, moved to their places in a float, are its value times 2^-112 (denormals too). */
static inline float half_bits_as_float(uint16_t half)
{
    const uint32_t bits = (uint32_t)(half & 0x7fffu) << 13 | (uint32_t)(half & 0x8000u) << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Weighted sum over the corners. A weight of 0 is harmless: every stored half is finite. */
static void blend_corners(const lmb_volume_brick *brick, uint32_t first, const float weight[8], float scale,
                          lmb_sh3_rgb *radiance)
{
    float sum[LANES] = {0.0f};
    for (uint32_t i = 0; i < 8; i += 2) {
        const uint16_t *const a = &brick->sh[(first + corner_offset(i)) * LMB_BRICK_COEFFICIENTS];
        const uint16_t *const b = a + LMB_BRICK_COEFFICIENTS;
        const float weight_a = weight[i] * 0x1p112f;
        const float weight_b = weight[i + 1] * 0x1p112f;
        for (int k = 0; k < LANES; ++k) {
            sum[k] += weight_a * half_bits_as_float(a[k]) + weight_b * half_bits_as_float(b[k]);
        }
    }
    for (int k = 0; k < LANES; ++k) {
        sum[k] *= scale;
    }
    memcpy(radiance, sum, sizeof *radiance);
}

/* The one body of both kinds of position. */
static bool sample_at(const lmb_volume *volume, double px, double py, double pz, lmb_sh3_rgb *radiance)
{
    int32_t cell[3];
    float t[3];
    bool inside = locate(volume, 0, px, &cell[0], &t[0]);
    inside &= locate(volume, 1, py, &cell[1], &t[1]);
    inside &= locate(volume, 2, pz, &cell[2], &t[2]);
    const size_t entry =
        (size_t)(cell[0] >> 2) +
        volume->bricks_along[0] * ((size_t)(cell[1] >> 2) + volume->bricks_along[1] * (size_t)(cell[2] >> 2));
    const uint32_t brick_number = volume->directory[entry];
    const bool is_nan = isnan(px) || isnan(py) || isnan(pz);
    if (brick_number == LMB_VOLUME_NO_BRICK || is_nan) {
        *radiance = (lmb_sh3_rgb){{{{0.0f}}}};
        return false;
    }
    const lmb_volume_brick *const brick = &volume->bricks[brick_number];
    const uint32_t x = (uint32_t)cell[0] & 3u, y = (uint32_t)cell[1] & 3u, z = (uint32_t)cell[2] & 3u;
    const uint32_t first = x + ROW * y + SLICE * z;

    const float u[2] = {1.0f - t[0], t[0]}, v[2] = {1.0f - t[1], t[1]}, w[2] = {1.0f - t[2], t[2]};
    float weight[8];
    for (uint32_t i = 0; i < 8; ++i) {
        weight[i] = u[i & 1u] * v[i >> 1 & 1u] * w[i >> 2];
    }
    if (!(brick->complete_cells >> (x + 4 * y + 16 * z) & 1u)) {
        inside &= reweigh_corners(brick, first, t, volume->slack, weight);
    }
    blend_corners(brick, first, weight, volume->scale, radiance);
    return inside;
}

bool lmb_volume_sample(const lmb_volume *volume, lmb_vec3 position, lmb_sh3_rgb *radiance)
{
    assert(volume && radiance);
    return sample_at(volume, (double)position.x, (double)position.y, (double)position.z, radiance);
}

bool lmb_volume_sample_at(const lmb_volume *volume, lmb_vec3d position, lmb_sh3_rgb *radiance)
{
    assert(volume && radiance);
    return sample_at(volume, position.x, position.y, position.z, radiance);
}
