#include "volume_cut.h"
#include "volume_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the .lmb file is used in place and is little-endian"
#endif
_Static_assert(sizeof(lmb_volume_header) == LMB_VOLUME_HEADER_BYTES, "the header has no padding");
_Static_assert(sizeof(lmb_volume_brick) == 128, "a brick's head is two cache lines");
_Static_assert(sizeof(lmb_volume_cut) == 2 && sizeof(lmb_volume_cut_region) == 2 && sizeof(lmb_cell_plane) == 10 &&
                   sizeof(lmb_volume_cut_apart) == 8 && sizeof(lmb_volume_cut_3) == 4,
               "nor has a cut cell any");

/* What files of the library begin with. */
typedef struct envelope {
    unsigned char magic[LMB_VOLUME_MAGIC_SIZE];
    uint32_t version;
    uint32_t header_bytes;
    uint64_t file_bytes;
    uint64_t checksum;
} envelope;
_Static_assert(sizeof(envelope) == LMB_VOLUME_CHECKSUM_START, "what is behind it is in the checksum");

lmb_result lmb_volume_envelope_check(const unsigned char *data, size_t size, const lmb_volume_file_kind *kind)
{
    const size_t magic_bytes = size < LMB_VOLUME_MAGIC_SIZE ? size : LMB_VOLUME_MAGIC_SIZE;
    if (memcmp(data, kind->magic, magic_bytes) != 0) {
        return LMB_ERROR_FORMAT;
    }
    uint32_t version;
    if (size < LMB_VOLUME_MAGIC_SIZE + sizeof version) {
        return LMB_ERROR_TRUNCATED;
    }
    memcpy(&version, data + LMB_VOLUME_MAGIC_SIZE, sizeof version);
    if (version < kind->oldest || version > kind->newest) {
        return LMB_ERROR_VERSION;
    }
    if (size < kind->header_bytes) {
        return LMB_ERROR_TRUNCATED;
    }
    envelope head;
    memcpy(&head, data, sizeof head);
    if (head.header_bytes != kind->header_bytes || head.file_bytes < size) {
        return LMB_ERROR_FORMAT;
    }
    if (head.file_bytes > size) {
        return LMB_ERROR_TRUNCATED;
    }
    const uint64_t checksum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    return checksum == head.checksum ? LMB_OK : LMB_ERROR_CHECKSUM;
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

bool lmb_volume_key_lights_are_sane(const lmb_key_light light[LMB_KEY_LIGHTS_MOST], uint32_t count)
{
    static const lmb_key_light none = {{0.0f, 0.0f, 0.0f}, {{0.0f, 0.0f, 0.0f}}};
    bool sane = count <= LMB_KEY_LIGHTS_MOST;
    for (uint32_t i = 0; i < LMB_KEY_LIGHTS_MOST; ++i) {
        sane = sane && (i < count ? key_light_is_sane(&light[i]) : !memcmp(&light[i], &none, sizeof none));
    }
    return sane;
}

bool lmb_volume_scales_are_sane(float spacing, float scale)
{
    int exponent;
    return isfinite(spacing) && spacing > 0.0f && isfinite(scale) && frexpf(scale, &exponent) == 0.5f &&
           exponent - 1 <= LMB_VOLUME_MAX_SCALE_LOG2 && exponent - 1 >= -LMB_VOLUME_MAX_SCALE_LOG2;
}

/* Every number of the header by itself. */
static bool header_is_sane(const lmb_volume_header *header)
{
    if (!lmb_volume_scales_are_sane(header->spacing, header->scale)) {
        return false;
    }
    for (size_t i = 0; i < sizeof header->reserved / sizeof header->reserved[0]; ++i) {
        if (header->reserved[i] != 0) {
            return false;
        }
    }
    if (header->probe_form >= LMB_VOLUME_FORMS || header->key_light_count > LMB_KEY_LIGHTS_MOST ||
        header->probe_bytes != lmb_volume_probe_bytes(header->probe_form, header->key_light_count)) {
        return false;
    }
    return header->level_count >= 1 && header->level_count <= LMB_VOLUME_LEVELS_MOST && header->probe_count > 0 &&
           header->stored_count > 0 && header->brick_count > 1 &&
           header->stored_count <= UINT32_MAX / (header->probe_bytes / LMB_PROBE_UNIT) &&
           header->brick_count < UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT && header->cut_bytes % 4 == 0 &&
           header->cut_bytes <= header->file_bytes && header->local_bytes <= header->file_bytes &&
           lmb_volume_key_lights_are_sane(header->key_light, header->key_light_count);
}

bool lmb_volume_box_is_sane(const int32_t min[3], const int32_t size[3], uint32_t level_count, float spacing)
{
    const int32_t coarsest = LMB_BRICK_CELLS << (level_count - 1);
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t first = min[axis];
        const int64_t last = first + size[axis] - 1;
        const int64_t origin = (int64_t)lmb_volume_floor_divide(min[axis], coarsest) * coarsest;
        if (last - origin >= INT32_MAX || !isfinite((float)first * spacing) || !isfinite((float)last * spacing)) {
            return false;
        }
    }
    return true;
}

/* Exponent 31 is infinity or NaN. */
bool lmb_volume_halfs_are_finite(const unsigned char *data, size_t count)
{
    uint16_t most = 0;
    for (size_t i = 0; i < count; ++i) {
        uint16_t half;
        memcpy(&half, data + i * sizeof half, sizeof half);
        const uint16_t exponent = half & 0x7c00u;
        most = exponent > most ? exponent : most;
    }
    return most < 0x7c00u;
}

static bool probes_are_finite(const lmb_volume *volume)
{
    const size_t count = volume->header->stored_count, stride = volume->header->probe_bytes;
    if (stride == LMB_HALFS_BYTES) {
        return lmb_volume_halfs_are_finite(volume->probes, count * LMB_PROBE_COEFFICIENTS);
    }
    const bool is_compact = volume->header->probe_form == LMB_VOLUME_COMPACT;
    bool finite = true;
    for (size_t i = 0; i < count; ++i) {
        const unsigned char *const probe = volume->probes + i * stride;
        finite &= is_compact ? lmb_volume_halfs_are_finite(probe, 3)
                             : lmb_volume_halfs_are_finite(probe, LMB_PROBE_COEFFICIENTS);
    }
    return finite;
}

/* Every word names a brick, at a level that there is. */
static bool directory_is_sane(const lmb_volume *volume, size_t entries)
{
    const uint32_t number_bits = (UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT) - 1;
    uint32_t most = 0, highest = 0;
    for (size_t i = 0; i < entries; ++i) {
        const uint32_t word = volume->directory[i];
        const uint32_t number = word & number_bits, level = word >> LMB_VOLUME_LEVEL_SHIFT;
        most = number > most ? number : most;
        highest = level > highest ? level : highest;
    }
    return most < volume->header->brick_count && highest < volume->header->level_count;
}

/* Whether a probe begins there. */
static bool place_is_sane(const lmb_volume *volume, uint32_t units)
{
    const uint32_t number = units / volume->probe_units;
    return number * volume->probe_units == units && number < volume->header->stored_count;
}

/* What plain cells interpolate is among the probes. */
static bool rows_are_sane(const lmb_volume *volume, const lmb_volume_brick *brick)
{
    static const uint8_t lowest[32] = {0, 0, 1, 0, 2, 0, 1, 0, 3, 0, 1, 0, 2, 0, 1, 0,
                                       4, 0, 1, 0, 2, 0, 1, 0, 3, 0, 1, 0, 2, 0, 1, 0};
    static const uint8_t highest[32] = {0, 0, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3,
                                        4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4};
    const uint32_t units = volume->probe_units;
    bool sane = true;
    for (uint32_t z = 0; z < LMB_BRICK_POINTS; ++z) {
        for (uint32_t y = 0; y < LMB_BRICK_POINTS; ++y) {
            const uint32_t points = lmb_volume_row_points(brick->plain, y, z);
            const uint32_t row = brick->row[y + LMB_BRICK_POINTS * z];
            const uint32_t first = row + units * lowest[points], last = row + units * highest[points];
            sane &= points == 0 || (first <= last && place_is_sane(volume, first) && place_is_sane(volume, last));
        }
    }
    return sane;
}

static bool counts_are_sane(uint32_t regions, uint32_t planes)
{
    return regions >= 1 && regions <= LMB_CELL_REGIONS_MOST && planes <= LMB_CELL_PLANES_MOST;
}

/* Files of versions before 5 have no wedges. */
static bool planes_are_sane(const lmb_volume *volume, const lmb_cell_plane *plane, uint32_t planes, uint32_t regions)
{
    const uint32_t first_unknown = volume->header->version < 5 ? LMB_CELL_BLEND : 256;
    bool sane = lmb_cell_planes_are_sane(plane, planes, regions);
    for (uint32_t i = 0; sane && i < planes; ++i) {
        sane = plane[i].child[0] < first_unknown && plane[i].child[1] < first_unknown;
    }
    return sane;
}

/* The record at an offset lies wholly in the file, and names probes and planes that there are. */
static bool cut_3_is_sane(const lmb_volume *volume, uint32_t number)
{
    const uint64_t at = (uint64_t)volume->cut_offsets[number] * sizeof(uint32_t), end = volume->header->cut_bytes;
    if (at + sizeof(lmb_volume_cut_3) > end) {
        return false;
    }
    const lmb_volume_cut_3 *const cut = lmb_volume_cut_3_at(volume, number);
    if (!counts_are_sane(cut->region_count, cut->plane_count) || cut->reserved != 0 ||
        at + lmb_volume_cut_3_bytes(cut->region_count, cut->plane_count) > end) {
        return false;
    }
    bool sane = planes_are_sane(volume, lmb_volume_cut_3_planes(cut), cut->plane_count, cut->region_count);
    for (uint32_t i = 0; i < cut->region_count * 8u; ++i) {
        sane = sane && place_is_sane(volume, lmb_volume_cut_3_corners(cut, 0)[i]);
    }
    return sane;
}

/* Whether a slot or a record, and what may be read behind it, lie in the file. */
static bool cut_has_room(const lmb_volume *volume, uint64_t units, size_t bytes)
{
    return units * LMB_CUT_UNIT + bytes + LMB_CUT_READ_BYTES <= volume->header->cut_bytes;
}

/* All corners of all regions are probes. */
static bool regions_are_sane(const lmb_volume *volume, const lmb_volume_brick *brick, uint32_t cell,
                             const lmb_volume_cut *cut)
{
    const lmb_volume_cut_region *const region = lmb_volume_cut_regions(cut);
    const uint32_t *const row = &brick->row[cell / 4 % 4 + LMB_BRICK_POINTS * (cell / 16)];
    bool sane = true;
    for (uint32_t i = 0; i < cut->region_count; ++i) {
        uint32_t place[8];
        lmb_volume_cut_places(row, cell % 4, volume->probe_units, region[i].ghosts,
                              lmb_volume_cut_ghosts(cut) + region[i].first, brick->ghost_first, place);
        for (int corner = 0; corner < 8; ++corner) {
            sane = sane && place_is_sane(volume, place[corner]);
        }
    }
    return sane;
}

/* The cell's slot and its record lie wholly in the file, and name probes and planes that there are. */
static bool cut_is_sane(const lmb_volume *volume, const lmb_volume_brick *brick, uint32_t cell)
{
    uint64_t at = lmb_volume_cut_slot(brick, cell);
    if (!cut_has_room(volume, at, LMB_CUT_UNIT)) {
        return false;
    }
    const lmb_volume_cut_apart *const apart = (const lmb_volume_cut_apart *)lmb_volume_cut_at(volume, at);
    if (apart->zero == 0) {
        at = apart->record;
    }
    if (!cut_has_room(volume, at, LMB_CUT_UNIT)) {
        return false;
    }
    const lmb_volume_cut *const cut = (const lmb_volume_cut *)lmb_volume_cut_at(volume, at);
    const lmb_volume_cut_region *const region = lmb_volume_cut_regions(cut);
    const uint32_t regions = cut->region_count, planes = cut->plane_count;
    if (!counts_are_sane(regions, planes) || !cut_has_room(volume, at, lmb_volume_cut_bytes(regions, planes, 0))) {
        return false;
    }
    uint32_t ghosts = 0;
    bool sane = planes_are_sane(volume, lmb_volume_cut_planes(cut), planes, regions);
    for (uint32_t i = 0; i < regions; ++i) {
        sane = sane && region[i].first == ghosts;
        ghosts += lmb_volume_bits(region[i].ghosts);
    }
    return sane && cut_has_room(volume, at, lmb_volume_cut_bytes(regions, planes, ghosts)) &&
           regions_are_sane(volume, brick, cell, cut);
}

/* What a brick says of its cut cells; `number`: of those of the bricks before. */
static bool cuts_are_sane(const lmb_volume *volume, const lmb_volume_brick *brick, uint64_t number)
{
    if (volume->cut_offsets) {
        return brick->cut_first == number && brick->ghost_first == 0 && brick->cut_shift == 0;
    }
    bool sane = brick->cut_shift <= LMB_CUT_SHIFT_MOST &&
                (brick->cut != 0 || (brick->cut_first == 0 && brick->ghost_first == 0 && brick->cut_shift == 0));
    for (uint32_t cell = 0; sane && cell < 64 && brick->cut >> cell != 0; ++cell) {
        sane = !(brick->cut >> cell & 1u) || cut_is_sane(volume, brick, cell);
    }
    return sane;
}

static bool bricks_are_sane(const lmb_volume *volume)
{
    static const lmb_volume_brick none;
    uint64_t cut_count = 0;
    bool sane = memcmp(volume->bricks, &none, sizeof none) == 0;
    for (uint32_t i = 1; sane && i < volume->header->brick_count; ++i) {
        const lmb_volume_brick *const brick = &volume->bricks[i];
        sane = (brick->plain & brick->cut) == 0 && (brick->plain | brick->cut) != 0 && rows_are_sane(volume, brick) &&
               cuts_are_sane(volume, brick, cut_count);
        cut_count += lmb_volume_bits(brick->cut);
    }
    sane = sane && cut_count == volume->header->cut_count;
    for (uint32_t i = 0; sane && volume->cut_offsets && i < volume->header->cut_count; ++i) {
        sane = cut_3_is_sane(volume, i);
    }
    return sane;
}

lmb_result lmb_volume_verify(const unsigned char *data, size_t size, lmb_volume *volume)
{
    static const lmb_volume_file_kind kind = {LMB_VOLUME_MAGIC, LMB_VOLUME_VERSION_OLDEST, LMB_VOLUME_VERSION,
                                              sizeof(lmb_volume_header)};
    const lmb_result result = lmb_volume_envelope_check(data, size, &kind);
    if (result != LMB_OK) {
        return result;
    }
    const lmb_volume_header *const header = volume->header = (const lmb_volume_header *)data;
    lmb_volume_layout layout;
    if (!header_is_sane(header) || !lmb_volume_layout_find(header, &layout) || layout.end != size ||
        !lmb_volume_box_is_sane(header->min, header->size, header->level_count, header->spacing)) {
        return LMB_ERROR_FORMAT;
    }
    volume->directory = (const uint32_t *)(data + layout.directory);
    volume->bricks = (const lmb_volume_brick *)(data + layout.bricks);
    volume->probes = data + layout.probes;
    volume->probe_units = header->probe_bytes / LMB_PROBE_UNIT;
    volume->key_count = header->key_light_count;
    volume->cut_offsets = header->version == 3 ? (const uint32_t *)(data + layout.cut_offsets) : NULL;
    volume->cuts = data + layout.cuts;
    volume->locals = header->local_bytes > 0 ? data + layout.locals : NULL;
    volume->entry_step[0] = layout.blocks[0];
    volume->entry_step[1] = (size_t)layout.blocks[0] * layout.blocks[1];
    const bool sane = directory_is_sane(volume, (size_t)layout.entries) && bricks_are_sane(volume) &&
                      probes_are_finite(volume) && lmb_volume_locals_are_sane(volume);
    return sane ? LMB_OK : LMB_ERROR_FORMAT;
}
