/* Records of cut cells: where they are, and which eight probes a position in one has. */
#ifndef LMB_VOLUME_CUT_H
#define LMB_VOLUME_CUT_H

#include "volume_internal.h"

/* How many of the brick's cut cells come before one. */
static inline uint32_t lmb_volume_cuts_before(const lmb_volume_brick *brick, uint32_t cell)
{
    return lmb_volume_bits(brick->cut & ((UINT64_C(1) << cell) - 1));
}

/* Where the slot of a brick's cut cell begins, in LMB_CUT_UNIT bytes, and what is there. */
static inline uint64_t lmb_volume_cut_slot(const lmb_volume_brick *brick, uint32_t cell)
{
    return brick->cut_first + ((uint64_t)lmb_volume_cuts_before(brick, cell) << brick->cut_shift);
}

static inline const void *lmb_volume_cut_at(const lmb_volume *volume, uint64_t units)
{
    return volume->cuts + (size_t)units * LMB_CUT_UNIT;
}

/* The record of a slot, in it or apart. */
static inline const lmb_volume_cut *lmb_volume_cut_record(const lmb_volume *volume, const void *slot)
{
    const lmb_volume_cut *const cut = (const lmb_volume_cut *)slot;
    const lmb_volume_cut_apart *const apart = (const lmb_volume_cut_apart *)slot;
    return cut->region_count > 0 ? cut : (const lmb_volume_cut *)lmb_volume_cut_at(volume, apart->record);
}

/* The parts of a record. */
static inline const lmb_volume_cut_region *lmb_volume_cut_regions(const lmb_volume_cut *cut)
{
    return (const lmb_volume_cut_region *)(cut + 1);
}

static inline const lmb_cell_plane *lmb_volume_cut_planes(const lmb_volume_cut *cut)
{
    return (const lmb_cell_plane *)(lmb_volume_cut_regions(cut) + cut->region_count);
}

static inline const int16_t *lmb_volume_cut_ghosts(const lmb_volume_cut *cut)
{
    return (const int16_t *)(lmb_volume_cut_planes(cut) + cut->plane_count);
}

/* A record of version 3, and its parts. */
static inline const lmb_volume_cut_3 *lmb_volume_cut_3_at(const lmb_volume *volume, uint32_t number)
{
    return (const lmb_volume_cut_3 *)(const void *)(volume->cuts + sizeof(uint32_t) * volume->cut_offsets[number]);
}

static inline const uint32_t *lmb_volume_cut_3_corners(const lmb_volume_cut_3 *cut, uint32_t region)
{
    return (const uint32_t *)(cut + 1) + 8 * region;
}

static inline const lmb_cell_plane *lmb_volume_cut_3_planes(const lmb_volume_cut_3 *cut)
{
    return (const lmb_cell_plane *)lmb_volume_cut_3_corners(cut, cut->region_count);
}

/* What is on a side of a plane: 0 or 1. */
static inline uint32_t lmb_volume_plane_child(const lmb_cell_plane *plane, uint32_t above)
{
    const uint32_t children = plane->child[0] | (uint32_t)plane->child[1] << 8;
    return children >> 8 * above & 255u;
}

/* Whether t is above a plane: 0 or 1. */
static inline uint32_t lmb_volume_plane_side(const lmb_cell_plane *plane, const float t[3])
{
    const float along =
        (float)plane->normal[0] * t[0] + (float)plane->normal[1] * t[1] + (float)plane->normal[2] * t[2];
    return along > (float)plane->offset;
}

/* a where the condition, 0 or 1, is 1. Written so that compilers make no branch of it: processors guess wrong as often
 * as right which side of a plane a position is on, or what is a ghost, and have by then begun another sample's work in
 * vain. */
static inline uint32_t lmb_volume_choose(uint32_t condition, uint32_t a, uint32_t b)
{
    return b ^ ((a ^ b) & (0u - condition));
}

/* The region of lmb_cell_regions_at, of planes of which two may be read whatever the count; from LMB_CELL_REGIONS_MOST
 * on: a wedge. `above`: bit 0 whether t is above the first, bit 1 the second. Most cells have no more. */
static inline uint32_t lmb_volume_cut_region_find(const lmb_cell_plane *plane, uint32_t count, uint32_t above,
                                                  const float t[3])
{
    const uint32_t first = lmb_volume_plane_child(&plane[0], above & 1u);
    const uint32_t second = lmb_volume_plane_child(&plane[1], above >> 1);
    uint32_t at = lmb_volume_choose(count > 0, first, LMB_CELL_REGION);
    at = lmb_volume_choose(at == 1, second, at);
    while (at < LMB_CELL_REGION) {
        at = lmb_volume_plane_child(&plane[at], lmb_volume_plane_side(&plane[at], t));
    }
    return at - LMB_CELL_REGION;
}

/* Byte i: how many of the bits before bit i are set, of eight. */
static inline uint64_t lmb_volume_ranks(uint32_t bits)
{
    const uint64_t spread = bits * UINT64_C(0x0101010101010101) & UINT64_C(0x8040201008040201);
    const uint64_t ones = (spread + UINT64_C(0x7f7f7f7f7f7f7f7f)) >> 7 & UINT64_C(0x0101010101010101);
    return ones * UINT64_C(0x0101010101010100);
}

/* The places of the eight corners that a region has in a cell: where `row` and `x` say a plain cell has them, or the
 * next one of the region's ghosts. A row may begin at a later x: its first places are modulo 2^32. */
static inline void lmb_volume_cut_places(const uint32_t *row, uint32_t x, uint32_t units, uint32_t ghosts,
                                         const int16_t *ghost, uint32_t ghost_first, uint32_t place[8])
{
    static const uint8_t rows[4] = {0, 1, LMB_BRICK_POINTS, LMB_BRICK_POINTS + 1};
    const uint64_t ranks = lmb_volume_ranks(ghosts);
    for (uint32_t i = 0; i < 8; ++i) {
        const uint32_t own = row[rows[i / 2]] + (x + i % 2u) * units;
        const int32_t number = ghost[ranks >> 8 * i & 7u];
        place[i] = lmb_volume_choose(ghosts >> i & 1u, (ghost_first + (uint32_t)number) * units, own);
    }
}

#endif
