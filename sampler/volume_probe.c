/* Probes one by one: what they hold, and where they are. */
#include <lambent/volume_probe.h>

#include "volume_cut_cell.h"
#include "volume_probe_internal.h"

#include <assert.h>

/* Coefficient k of a compact probe's channel over coefficient 0. */
static float compact_share(const unsigned char *probe, int channel, int k)
{
    int8_t byte;
    memcpy(&byte, probe + 6 + 8 * channel + k - 1, sizeof byte);
    const int b = byte;
    return (float)(b < 0 ? -b * b : b * b) * lmb_compact_share(k);
}

void lmb_volume_probe_read(const lmb_volume *volume, const unsigned char *probe, lmb_sh3_rgb *radiance,
                           float visibility[LMB_KEY_LIGHTS_MOST])
{
    const bool is_compact = volume->header->probe_form == LMB_VOLUME_COMPACT;
    const unsigned char *const seen = lmb_volume_probe_seen(volume, probe);
    for (int c = 0; c < 3; ++c) {
        float *const to = radiance->channel[c].c;
        to[0] = lmb_volume_half(probe + 2 * (is_compact ? c : c * LMB_SH3_COUNT)) * volume->scale;
        for (int k = 1; k < LMB_SH3_COUNT; ++k) {
            to[k] = is_compact ? to[0] * compact_share(probe, c, k)
                               : lmb_volume_half(probe + 2 * (c * LMB_SH3_COUNT + k)) * volume->scale;
        }
    }
    for (uint32_t key = 0; visibility && key < LMB_KEY_LIGHTS_MOST; ++key) {
        visibility[key] = key < volume->key_count ? (float)seen[key] * (1.0f / 255.0f) : 0.0f;
    }
}

void lmb_volume_probe_read_halfs(const lmb_volume *volume, const unsigned char *probe,
                                 uint16_t half[LMB_PROBE_COEFFICIENTS])
{
    if (volume->header->probe_form != LMB_VOLUME_COMPACT) {
        memcpy(half, probe, LMB_PROBE_COEFFICIENTS * sizeof half[0]);
        return;
    }
    for (int c = 0; c < 3; ++c) {
        uint16_t *const to = half + c * LMB_SH3_COUNT;
        memcpy(to, probe + 2 * c, sizeof to[0]);
        for (int k = 1; k < LMB_SH3_COUNT; ++k) {
            to[k] = lmb_volume_half_of(lmb_volume_half(probe + 2 * c) * compact_share(probe, c, k));
        }
    }
}

uint32_t lmb_volume_probe_count(const lmb_volume *volume)
{
    assert(volume);
    return volume->header->stored_count;
}

static const unsigned char *probe_bytes(const lmb_volume *volume, uint32_t index)
{
    assert(volume && index < volume->header->stored_count);
    return lmb_volume_probe_at(volume, index * volume->probe_units);
}

void lmb_volume_get_probe(const lmb_volume *volume, uint32_t index, lmb_sh3_rgb *radiance,
                          float visibility[LMB_KEY_LIGHTS_MOST])
{
    assert(radiance);
    lmb_volume_probe_read(volume, probe_bytes(volume, index), radiance, visibility);
}

void lmb_volume_get_probe_halfs(const lmb_volume *volume, uint32_t index, uint16_t half[27])
{
    assert(half);
    lmb_volume_probe_read_halfs(volume, probe_bytes(volume, index), half);
}

/* A brick in the world. */
typedef struct placed_brick {
    const lmb_volume_brick *brick;
    uint32_t level;
    double spacing;  /* metres, of the level */
    double first[3]; /* of its points, in spacings */
} placed_brick;

static void probe_put(const placed_brick *at, const uint32_t point[3], lmb_volume_probe_kind kind,
                      lmb_volume_probe *probe)
{
    double position[3];
    for (int axis = 0; axis < 3; ++axis) {
        position[axis] = (at->first[axis] + point[axis]) * at->spacing;
    }
    *probe = (lmb_volume_probe){.position = {position[0], position[1], position[2]},
                                .spacing = (float)at->spacing,
                                .level = at->level,
                                .kind = kind};
}

static void plain_put(const lmb_volume *volume, const placed_brick *at, lmb_volume_probe *probe)
{
    for (uint32_t row = 0; row < LMB_BRICK_ROWS; ++row) {
        const uint32_t y = row % LMB_BRICK_POINTS, z = row / LMB_BRICK_POINTS;
        const uint32_t points = lmb_volume_row_points(at->brick->plain, y, z);
        for (uint32_t x = 0; x < LMB_BRICK_POINTS; ++x) {
            if (points >> x & 1u) {
                const uint32_t place = at->brick->row[row] + x * volume->probe_units;
                probe_put(at, (const uint32_t[3]){x, y, z}, LMB_VOLUME_PROBE_POINT,
                          &probe[place / volume->probe_units]);
            }
        }
    }
}

/* The probes of a cut cell's regions. What is a point to some cell is no ghost to another. */
static void cut_put(const lmb_volume *volume, const placed_brick *at, uint32_t cell, lmb_volume_probe *probe)
{
    const lmb_volume_cut_cell cut = lmb_volume_cut_cell_of(volume, at->brick, cell);
    for (uint32_t i = 0; i < 8 * cut.region_count; ++i) {
        uint32_t place[8];
        const uint32_t ghosts = lmb_volume_cut_cell_places(volume, &cut, i / 8, place);
        const uint32_t point[3] = {cell % 4 + i % 2, cell / 4 % 4 + i / 2 % 2, cell / 16 + i / 4 % 2};
        lmb_volume_probe *const to = &probe[place[i % 8] / volume->probe_units];
        const bool is_ghost = ghosts >> i % 8 & 1u;
        if (!is_ghost || to->kind == LMB_VOLUME_PROBE_NONE) {
            probe_put(at, point, is_ghost ? LMB_VOLUME_PROBE_GHOST : LMB_VOLUME_PROBE_POINT, to);
        }
    }
}

static void brick_put(const lmb_volume *volume, const placed_brick *at, lmb_volume_probe *probe)
{
    plain_put(volume, at, probe);
    for (uint32_t cell = 0; cell < 64; ++cell) {
        if (at->brick->cut >> cell & 1u) {
            cut_put(volume, at, cell, probe);
        }
    }
}

/* Whether a block before this one along an axis names the same brick, which was seen there. */
static bool was_seen(const lmb_volume *volume, const uint32_t block[3], size_t entry)
{
    const size_t step[3] = {1, volume->entry_step[0], volume->entry_step[1]};
    bool seen = false;
    for (int axis = 0; axis < 3; ++axis) {
        seen = seen || (block[axis] > 0 && volume->directory[entry - step[axis]] == volume->directory[entry]);
    }
    return seen;
}

void lmb_volume_get_probes(const lmb_volume *volume, lmb_volume_probe *probe)
{
    assert(volume && probe);
    lmb_volume_layout layout;
    lmb_volume_layout_find(volume->header, &layout);
    memset(probe, 0, volume->header->stored_count * sizeof *probe);
    for (size_t entry = 0; entry < (size_t)layout.entries; ++entry) {
        const uint32_t block[3] = {(uint32_t)(entry % layout.blocks[0]),
                                   (uint32_t)(entry / layout.blocks[0] % layout.blocks[1]),
                                   (uint32_t)(entry / layout.blocks[0] / layout.blocks[1])};
        const uint32_t word = volume->directory[entry];
        if (was_seen(volume, block, entry)) {
            continue;
        }
        placed_brick at = {.brick = &volume->bricks[word & ((UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT) - 1)],
                           .level = word >> LMB_VOLUME_LEVEL_SHIFT};
        at.spacing = ldexp((double)volume->header->spacing, (int)at.level);
        for (int axis = 0; axis < 3; ++axis) {
            const int32_t along = layout.block_first[axis] + (int32_t)block[axis];
            at.first[axis] = LMB_BRICK_CELLS * lmb_volume_floor_divide(along, (int32_t)1 << at.level);
        }
        brick_put(volume, &at, probe);
    }
}
