#include <lambent/pack.h>

#include "pack_internal.h"
#include "volume_internal.h"

#include <lambent/lattice.h>
#include <lambent/probe_local.h>
#include <lambent/vector.h>

#include <Imath/half.h>
#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(lmb_volume_header) == LMB_VOLUME_HEADER_BYTES, "the header has no padding");

/* Room that all numbers of points and bricks have to what an int32_t holds. */
enum { COORDINATES_MOST = INT32_MAX - (LMB_BRICK_CELLS << LMB_VOLUME_LEVELS_MOST) };

static bool radiance_is_finite(const lmb_probes *probes)
{
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        for (int i = 0; i < LMB_PROBE_COEFFICIENTS; ++i) {
            if (!isfinite(probes->radiance[0][probe].channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT])) {
                return false;
            }
        }
    }
    return true;
}

/* Each level has twice the spacing of the one before, and the world's axes. */
static bool levels_are_sane(const lmb_probes *probes)
{
    bool sane = probes->level_count >= 1 && probes->level_count <= LMB_VOLUME_LEVELS_MOST;
    for (uint32_t level = 0; sane && level < probes->level_count; ++level) {
        const lmb_lattice *const lattice = &probes->level[level].lattice;
        sane =
            !lmb_lattice_is_turned(lattice) && lattice->spacing == ldexpf(probes->level[0].lattice.spacing, (int)level);
    }
    return sane;
}

/* The box of all levels that have probes, on the finest lattice. */
static bool box_find(const lmb_probes *probes, lmb_volume_header *header)
{
    for (int axis = 0; axis < 3; ++axis) {
        int64_t low = INT64_MAX, high = INT64_MIN;
        for (uint32_t level = 0; level < probes->level_count; ++level) {
            const lmb_lattice *const lattice = &probes->level[level].lattice;
            const int64_t along = INT64_C(1) << level;
            const int64_t first = lattice->min[axis] * along;
            const int64_t last = ((int64_t)lattice->min[axis] + lattice->size[axis] - 1) * along;
            const bool counts = probes->level[level].count + probes->level[level].ghost_count > 0;
            low = counts && first < low ? first : low;
            high = counts && last > high ? last : high;
        }
        if (low < -COORDINATES_MOST || high > COORDINATES_MOST || high - low >= COORDINATES_MOST) {
            return false;
        }
        header->min[axis] = (int32_t)low;
        header->size[axis] = (int32_t)(high - low + 1);
    }
    return true;
}

/* What can be said of the header from the start. @return false: not what a file holds */
static bool header_begin(const lmb_probes *probes, lmb_volume_form form, lmb_volume_header *header)
{
    *header = (lmb_volume_header){.version = LMB_VOLUME_VERSION,
                                  .header_bytes = LMB_VOLUME_HEADER_BYTES,
                                  .probe_form = form,
                                  .probe_bytes = lmb_volume_probe_bytes(form, probes->key_light_count),
                                  .level_count = probes->level_count,
                                  .key_light_count = probes->key_light_count};
    if (probes->count == 0 || probes->set_count != 1 || !levels_are_sane(probes) ||
        !lmb_probes_key_lights_are_sane(probes) || !lmb_probes_cuts_are_sane(probes) || !radiance_is_finite(probes) ||
        lmb_probes_validate_locals(probes, NULL) != LMB_OK || !box_find(probes, header)) {
        return false;
    }
    memcpy(header->magic, LMB_VOLUME_MAGIC, sizeof header->magic);
    memcpy(header->key_light, probes->key_light, probes->key_light_count * sizeof *probes->key_light);
    header->spacing = probes->level[0].lattice.spacing;
    header->scale = lmb_probes_scale(probes);
    return true;
}

/* Coefficients that even the largest scale does not bring into fp16. */
static uint64_t overflow_count(const lmb_packing *packing)
{
    uint64_t count = 0;
    for (int32_t probe = 0; probe < packing->probes->count; ++probe) {
        const lmb_sh3 *const channel = packing->probes->radiance[0][probe].channel;
        for (int i = 0; i < LMB_PROBE_COEFFICIENTS && packing->slot[probe] != LMB_PACK_NOTHING; ++i) {
            const float value = channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT];
            count += fabsf(value / packing->header.scale) > LMB_HALF_MAX;
        }
    }
    return count;
}

void lmb_pack_halfs(const lmb_sh3_rgb *radiance, float scale, uint16_t half[LMB_PROBE_COEFFICIENTS])
{
    float value[LMB_PROBE_COEFFICIENTS];
    float largest = 0.0f;
    for (int i = 0; i < LMB_PROBE_COEFFICIENTS; ++i) {
        value[i] = radiance->channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] / scale;
        largest = fmaxf(largest, fabsf(value[i]));
    }
    for (int i = 0; i < LMB_PROBE_COEFFICIENTS; ++i) {
        /* Down to exactly the largest half at most: the quotient is at most 1. */
        half[i] = imath_float_to_half(largest > LMB_HALF_MAX ? LMB_HALF_MAX * (value[i] / largest) : value[i]);
    }
}

/* The byte whose square is nearest to a share of the largest there may be, -1 to 1. */
static int8_t compact_byte(float share)
{
    const float size = fminf(fabsf(share), 1.0f);
    int byte = (int)(sqrtf(size) * 127.0f);
    const float below = (float)(byte * byte), above = (float)((byte + 1) * (byte + 1));
    byte += byte < 127 && size * 16129.0f > 0.5f * (below + above);
    return (int8_t)(share < 0.0f ? -byte : byte);
}

/* A colour's shares, all eight made smaller where one is too large. @return whether they were */
static bool write_shares(const float *c, float first, int8_t *to)
{
    float share[LMB_SH3_COUNT] = {0.0f}, largest = 1.0f;
    for (int k = 1; k < LMB_SH3_COUNT; ++k) {
        share[k] = first > 0.0f || first < 0.0f ? c[k] / first / (lmb_compact_share(k) * 16129.0f) : 0.0f;
        largest = fmaxf(largest, fabsf(share[k]));
    }
    for (int k = 1; k < LMB_SH3_COUNT; ++k) {
        to[k - 1] = compact_byte(largest <= FLT_MAX ? share[k] / largest : 0.0f);
    }
    return largest > 1.001f;
}

/* Three halfs and 24 bytes. @return colours that were flattened */
static uint32_t write_compact(const lmb_sh3_rgb *radiance, float scale, unsigned char *to)
{
    uint16_t half[LMB_PROBE_COEFFICIENTS];
    uint32_t flattened = 0;
    lmb_pack_halfs(radiance, scale, half);
    for (int c = 0; c < 3; ++c) {
        int8_t share[LMB_SH3_COUNT - 1];
        const uint16_t first = half[c * LMB_SH3_COUNT];
        flattened += write_shares(radiance->channel[c].c, imath_half_to_float(first) * scale, share);
        memcpy(to + 2 * c, &first, sizeof first);
        memcpy(to + 6 + 8 * c, share, sizeof share);
    }
    return flattened;
}

static void write_halfs(const lmb_sh3_rgb *radiance, float scale, unsigned char *to)
{
    uint16_t half[LMB_PROBE_COEFFICIENTS];
    lmb_pack_halfs(radiance, scale, half);
    memcpy(to, half, sizeof half);
}

uint32_t lmb_pack_probe_write(const lmb_volume_header *header, const lmb_sh3_rgb *light,
                              const float seen[LMB_KEY_LIGHTS_MOST], unsigned char *to)
{
    uint32_t flattened = 0;
    const bool is_compact = header->probe_form == LMB_VOLUME_COMPACT;
    if (is_compact) {
        flattened = write_compact(light, header->scale, to);
    } else {
        write_halfs(light, header->scale, to);
    }
    unsigned char *const keys = to + (is_compact ? LMB_COMPACT_BYTES : LMB_HALFS_BYTES);
    for (uint32_t key = 0; key < header->key_light_count; ++key) {
        keys[key] = (uint8_t)(lmb_saturate(seen[key]) * 255.0f + 0.5f);
    }
    return flattened;
}

static void write_probes(lmb_packing *packing, unsigned char *image)
{
    const lmb_probes *const probes = packing->probes;
    const lmb_volume_header *const header = &packing->header;
    const uint32_t count = (uint32_t)probes->count;
    for (size_t i = 0; i < header->stored_count; ++i) {
        const uint32_t source = packing->stored[i];
        if (source == LMB_PACK_NOTHING) {
            continue;
        }
        const lmb_pack_corner *const corner = source >= count ? &packing->corner[source - count] : NULL;
        const lmb_sh3_rgb *const light = corner ? &corner->light : &probes->radiance[0][source];
        const float *const seen = corner ? corner->seen : probes->key_visibility[source];
        unsigned char *const to = image + packing->layout.probes + i * header->probe_bytes;
        const uint32_t flattened = lmb_pack_probe_write(header, light, seen, to);
        packing->flattened_count += !corner && packing->slot[source] == i ? flattened : 0;
    }
}

static void write_bricks(const lmb_packing *packing, unsigned char *image)
{
    lmb_volume_brick *const heads = (lmb_volume_brick *)(image + packing->layout.bricks);
    for (uint32_t i = 0; i < packing->brick_count; ++i) {
        const lmb_pack_brick *const brick = &packing->brick[i];
        heads[i + 1] = (lmb_volume_brick){.plain = brick->plain,
                                          .cut = brick->cut_stored,
                                          .cut_first = brick->cut_first,
                                          .ghost_first = brick->ghost_first,
                                          .cut_shift = brick->cut_shift};
        memcpy(heads[i + 1].row, brick->row, sizeof brick->row);
    }
}

static lmb_result image_make(lmb_packing *packing, unsigned char **data)
{
    lmb_volume_header *const header = &packing->header;
    header->local_bytes = lmb_pack_locals_bytes(packing->probes, header);
    if (header->local_bytes > UINT32_MAX || !lmb_volume_layout_find(header, &packing->layout) ||
        packing->layout.end > SIZE_MAX || header->brick_count >= UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT ||
        header->stored_count > UINT32_MAX / lmb_pack_units(packing)) {
        return LMB_ERROR_ARGUMENT;
    }
    unsigned char *const image = aligned_alloc(LMB_VOLUME_ALIGNMENT, (size_t)packing->layout.end);
    if (!image) {
        return LMB_ERROR_MEMORY;
    }
    memset(image, 0, (size_t)packing->layout.end);
    lmb_pack_directory(packing, (uint32_t *)(image + packing->layout.directory));
    write_bricks(packing, image);
    lmb_pack_cuts_write(packing, image + packing->layout.cuts);
    write_probes(packing, image);
    lmb_pack_locals_write(packing->probes, header, image + packing->layout.locals);
    header->file_bytes = packing->layout.end;
    memcpy(image, header, sizeof *header);
    header->checksum =
        lmb_volume_hash(image + LMB_VOLUME_CHECKSUM_START, (size_t)packing->layout.end - LMB_VOLUME_CHECKSUM_START);
    memcpy(image, header, sizeof *header);
    *data = image;
    return LMB_OK;
}

static lmb_result packing_begin(lmb_packing *packing)
{
    const size_t count = (size_t)packing->probes->count;
    packing->pass = malloc(count * sizeof *packing->pass);
    packing->level_of = malloc((size_t)packing->layout.entries);
    int32_t *const order = malloc(count * sizeof *order);
    const bool good = packing->pass && packing->level_of && order;
    if (good) {
        int32_t reached;
        lmb_probes_dilation_passes(packing->probes, packing->pass, order, &reached);
    }
    free(order);
    return good ? LMB_OK : LMB_ERROR_MEMORY;
}

static void packing_free(lmb_packing *packing)
{
    for (uint32_t level = 0; level < LMB_VOLUME_LEVELS_MOST; ++level) {
        lmb_probe_index_free(&packing->brick_at[level]);
        lmb_probe_index_free(&packing->corner_at[level]);
        lmb_probe_index_free(&packing->row_at[level]);
    }
    free(packing->pass);
    free(packing->level_of);
    free(packing->brick);
    free(packing->corner);
    free(packing->row);
    free(packing->stored);
    free(packing->slot);
    free(packing->ghost);
}

lmb_result lmb_pack(const lmb_probes *probes, unsigned char **data, size_t *size, lmb_pack_stats *stats)
{
    return lmb_pack_as(LMB_VOLUME_HALFS, probes, data, size, stats);
}

lmb_result lmb_pack_as(lmb_volume_form form, const lmb_probes *probes, unsigned char **data, size_t *size,
                       lmb_pack_stats *stats)
{
    assert(probes && data && size);
    lmb_packing packing = {.probes = probes};
    if (!header_begin(probes, form, &packing.header) || !lmb_volume_layout_find(&packing.header, &packing.layout)) {
        return LMB_ERROR_ARGUMENT;
    }
    lmb_result result = packing_begin(&packing);
    if (result == LMB_OK) {
        result = lmb_pack_cells(&packing);
    }
    if (result == LMB_OK) {
        lmb_pack_corners(&packing);
        result = lmb_pack_drop(&packing);
    }
    if (result == LMB_OK) {
        result = lmb_pack_rows(&packing);
    }
    if (result == LMB_OK) {
        result = lmb_pack_cuts_place(&packing);
    }
    if (result == LMB_OK) {
        result = image_make(&packing, data);
    }
    if (result == LMB_OK) {
        *size = (size_t)packing.layout.end;
    }
    if (result == LMB_OK && stats) {
        *stats = (lmb_pack_stats){packing.header.scale, overflow_count(&packing), packing.layout.end,
                                  packing.flattened_count};
    }
    packing_free(&packing);
    return result;
}
