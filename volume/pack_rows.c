/* Where probes lie in the file: rows of points along x, which bricks share that touch in y or z, and which run on
 * through bricks beside each other. A row that would be longer than LMB_PACK_CHAIN bricks begins anew: longer ones
 * would save few bytes, and spread the rows of a brick over more pages. */
#include "pack_internal.h"

#include <stdlib.h>
#include <string.h>

enum { LMB_PACK_CHAIN = 4 };

uint32_t lmb_pack_source(const lmb_packing *packing, uint32_t level, const int32_t point[3])
{
    const int32_t probe = lmb_probe_index_find(&packing->probes->level[level].index, point);
    if (probe >= 0 && packing->pass[probe] >= 0) {
        return (uint32_t)probe;
    }
    const int32_t corner = lmb_probe_index_find(&packing->corner_at[level], point);
    return corner >= 0  ? (uint32_t)packing->probes->count + (uint32_t)corner
           : probe >= 0 ? (uint32_t)probe
                        : LMB_PACK_NOTHING;
}

/* What finds a brick's row: its x among bricks, its y and z among points. */
static void row_key(const lmb_pack_brick *brick, int32_t row, int32_t key[3])
{
    key[0] = brick->at[0];
    key[1] = brick->at[1] * LMB_BRICK_CELLS + row % LMB_BRICK_POINTS;
    key[2] = brick->at[2] * LMB_BRICK_CELLS + row / LMB_BRICK_POINTS;
}

/* Points of a brick's rows, by bits, that plain cells interpolate, or a cut cell's regions have as their own. */
static void points_needed(const lmb_packing *packing, const lmb_pack_brick *brick, uint32_t points[LMB_BRICK_ROWS])
{
    const lmb_cut_cells *const cuts = &packing->probes->cut;
    memset(points, 0, LMB_BRICK_ROWS * sizeof *points);
    for (int32_t cell = 0; cell < 64; ++cell) {
        const int32_t x = cell % 4, y = cell / 4 % 4, z = cell / 16;
        const bool plain = brick->plain >> cell & 1u, cut = brick->cut_stored >> cell & 1u;
        const lmb_cut_cell *const own = cut ? lmb_pack_cut(packing, brick, cell) : NULL;
        for (int32_t i = 0; (plain || cut) && i < 8; ++i) {
            bool needed = plain;
            for (uint32_t region = 0; own && region < own->region_count; ++region) {
                needed = needed || !lmb_pack_is_ghost(packing, cuts->corner[own->region_first + region][i]);
            }
            const int32_t row = y + (i >> 1 & 1) + LMB_BRICK_POINTS * (z + (i >> 2));
            points[row] |= (uint32_t)needed << (x + (i & 1));
        }
    }
}

static lmb_result row_add(lmb_packing *packing, uint32_t level, const int32_t key[3], uint32_t points)
{
    const int32_t known = lmb_probe_index_find(&packing->row_at[level], key);
    if (known >= 0) {
        packing->row[known].points |= points;
        return LMB_OK;
    }
    void *rows = packing->row;
    const bool has_room = packing->row_count < INT32_MAX / 2 &&
                          lmb_pack_reserve(&rows, sizeof *packing->row, (uint32_t)packing->row_count);
    packing->row = rows;
    if (!has_room) {
        return LMB_ERROR_MEMORY;
    }
    packing->row[packing->row_count] = (lmb_pack_row){.points = points};
    return lmb_probe_index_add(&packing->row_at[level], key, packing->row_count++);
}

static lmb_result rows_find(lmb_packing *packing)
{
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < packing->brick_count; ++i) {
        const lmb_pack_brick *const brick = &packing->brick[i];
        uint32_t points[LMB_BRICK_ROWS];
        points_needed(packing, brick, points);
        for (int32_t row = 0; row < LMB_BRICK_ROWS && result == LMB_OK; ++row) {
            int32_t key[3];
            row_key(brick, row, key);
            result = points[row] ? row_add(packing, brick->level, key, points[row]) : LMB_OK;
        }
    }
    return result;
}

/* The next place in the file gets what is stored there. */
static lmb_result slot_fill(lmb_packing *packing, uint32_t source)
{
    if (packing->header.stored_count >= UINT32_MAX - 1) {
        return LMB_ERROR_ARGUMENT;
    }
    void *stored = packing->stored;
    const bool has_room = lmb_pack_reserve(&stored, sizeof *packing->stored, packing->header.stored_count);
    packing->stored = stored;
    if (!has_room) {
        return LMB_ERROR_MEMORY;
    }
    if (source < (uint32_t)packing->probes->count && packing->slot[source] == LMB_PACK_NOTHING) {
        packing->slot[source] = packing->header.stored_count;
        packing->header.probe_count += 1;
    }
    packing->stored[packing->header.stored_count++] = source;
    return LMB_OK;
}

/* Points `first` to `last` of a row. Between two that are stored there may be some that are not: they are dark. */
static lmb_result slots_fill(lmb_packing *packing, uint32_t level, const int32_t key[3], int32_t first, int32_t last)
{
    lmb_result result = LMB_OK;
    for (int32_t x = first; x <= last && result == LMB_OK; ++x) {
        const int32_t point[3] = {key[0] * LMB_BRICK_CELLS + x, key[1], key[2]};
        result = slot_fill(packing, lmb_pack_source(packing, level, point));
    }
    return result;
}

static int32_t lowest_bit(uint32_t bits)
{
    int32_t bit = 0;
    while (!(bits >> bit & 1u)) {
        ++bit;
    }
    return bit;
}

static int32_t highest_bit(uint32_t bits)
{
    int32_t bit = 0;
    while (bits >> bit > 1u) {
        ++bit;
    }
    return bit;
}

/* Rows of bricks beside each other, from one whose x is a multiple of the chain's length on. */
static lmb_result chain_place(lmb_packing *packing, uint32_t level, const int32_t key[3])
{
    const int32_t first = lmb_volume_floor_divide(key[0], LMB_PACK_CHAIN) * LMB_PACK_CHAIN;
    bool goes_on = false; /* the row before ends with this one's first point */
    lmb_result result = LMB_OK;
    for (int32_t x = first; x < first + LMB_PACK_CHAIN && result == LMB_OK; ++x) {
        const int32_t at[3] = {x, key[1], key[2]};
        const int32_t found = lmb_probe_index_find(&packing->row_at[level], at);
        if (found < 0) {
            goes_on = false;
            continue;
        }
        lmb_pack_row *const row = &packing->row[found];
        const int32_t low = lowest_bit(row->points), high = highest_bit(row->points);
        const bool shares = goes_on && low == 0;
        row->start = (packing->header.stored_count - (uint32_t)low - shares) * lmb_pack_units(packing);
        row->is_placed = true;
        result = slots_fill(packing, level, at, low + shares, high);
        goes_on = high == LMB_BRICK_CELLS;
    }
    return result;
}

static lmb_result brick_rows_place(lmb_packing *packing, lmb_pack_brick *brick)
{
    lmb_result result = LMB_OK;
    for (int32_t row = 0; row < LMB_BRICK_ROWS && result == LMB_OK; ++row) {
        int32_t key[3];
        row_key(brick, row, key);
        const int32_t found = lmb_probe_index_find(&packing->row_at[brick->level], key);
        if (found >= 0 && !packing->row[found].is_placed) {
            result = chain_place(packing, brick->level, key);
        }
        brick->row[row] = found >= 0 ? packing->row[found].start : 0;
    }
    return result;
}

/* A ghost that bricks before have placed is used again where the brick's numbers reach it; else it gets another place.
 */
static lmb_result ghost_place(lmb_packing *packing, const lmb_pack_brick *brick, int32_t probe)
{
    enum { REACH = -(INT16_MIN) };
    const uint32_t known = packing->slot[probe];
    lmb_result result = LMB_OK;
    if (known == LMB_PACK_NOTHING || known + REACH < brick->ghost_first) {
        const uint32_t place = packing->header.stored_count;
        result = slot_fill(packing, (uint32_t)probe);
        packing->slot[probe] = result == LMB_OK ? place : known;
    }
    void *ghosts = packing->ghost;
    const bool has_room = lmb_pack_reserve(&ghosts, sizeof *packing->ghost, packing->ghost_count);
    packing->ghost = ghosts;
    if (!has_room) {
        return LMB_ERROR_MEMORY;
    }
    packing->ghost[packing->ghost_count++] = packing->slot[probe];
    return result;
}

/* Ghosts follow the rows of the first brick that has them. */
static lmb_result brick_ghosts_place(lmb_packing *packing, lmb_pack_brick *brick)
{
    const lmb_cut_cells *const cuts = &packing->probes->cut;
    lmb_result result = LMB_OK;
    brick->ghost_begin = packing->ghost_count;
    brick->ghost_first = brick->cut_stored ? packing->header.stored_count : 0;
    for (int32_t number = 0; number < 64 && brick->cut_stored >> number != 0; ++number) {
        if (!(brick->cut_stored >> number & 1u)) {
            continue;
        }
        const lmb_cut_cell *const cut = lmb_pack_cut(packing, brick, number);
        for (uint32_t i = 0; i < 8 * cut->region_count && result == LMB_OK; ++i) {
            const int32_t probe = cuts->corner[cut->region_first + i / 8][i % 8];
            if (lmb_pack_is_ghost(packing, probe)) {
                result = ghost_place(packing, brick, probe);
            }
        }
        packing->header.cut_count += 1;
    }
    return result;
}

lmb_result lmb_pack_rows(lmb_packing *packing)
{
    packing->slot = malloc((size_t)packing->probes->count * sizeof *packing->slot);
    if (!packing->slot) {
        return LMB_ERROR_MEMORY;
    }
    memset(packing->slot, 0xff, (size_t)packing->probes->count * sizeof *packing->slot);
    lmb_result result = rows_find(packing);
    for (uint32_t i = 0; i < packing->brick_count && result == LMB_OK; ++i) {
        result = brick_rows_place(packing, &packing->brick[i]);
        if (result == LMB_OK) {
            result = brick_ghosts_place(packing, &packing->brick[i]);
        }
    }
    packing->header.brick_count = packing->brick_count + 1;
    return result;
}
