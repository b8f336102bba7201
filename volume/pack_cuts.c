/* Records of cut cells. Those of a brick lie in slots of one size, so that a cell's is found without a look at a table;
 * records that are larger lie behind the slots. No slot crosses a line of memory, which a sample waits for. */
#include "pack_internal.h"

#include <string.h>

/* Goes through a brick's cut cells. */
typedef struct brick_cuts {
    const lmb_packing *packing;
    const lmb_pack_brick *brick;
    int32_t number; /* of the cell, -1 before the first */
    const lmb_cut_cell *cut;
    uint32_t ghosts, units; /* of its record */
} brick_cuts;

static brick_cuts brick_cuts_of(const lmb_packing *packing, const lmb_pack_brick *brick)
{
    return (brick_cuts){.packing = packing, .brick = brick, .number = -1};
}

/* @return false: there is none left */
static bool brick_cuts_next(brick_cuts *at)
{
    do {
        at->number += 1;
    } while (at->number < 64 && !(at->brick->cut_stored >> at->number & 1u));
    if (at->number == 64) {
        return false;
    }
    at->cut = lmb_pack_cut(at->packing, at->brick, at->number);
    at->ghosts = 0;
    for (uint32_t i = 0; i < 8 * at->cut->region_count; ++i) {
        const int32_t probe = at->packing->probes->cut.corner[at->cut->region_first + i / 8][i % 8];
        at->ghosts += lmb_pack_is_ghost(at->packing, probe);
    }
    const size_t bytes = lmb_volume_cut_bytes(at->cut->region_count, at->cut->plane_count, at->ghosts);
    at->units = (uint32_t)((bytes + LMB_CUT_UNIT - 1) / LMB_CUT_UNIT);
    return true;
}

/* Units of all of a brick's records that do not fit slots, and of the slots. */
static uint64_t brick_units(const lmb_packing *packing, const lmb_pack_brick *brick, uint32_t shift)
{
    brick_cuts at = brick_cuts_of(packing, brick);
    uint64_t units = 0;
    while (brick_cuts_next(&at)) {
        units += (UINT64_C(1) << shift) + (at.units > 1u << shift ? at.units : 0);
    }
    return units;
}

static uint64_t round_up(uint64_t units, uint64_t step)
{
    return (units + step - 1) / step * step;
}

lmb_result lmb_pack_cuts_place(lmb_packing *packing)
{
    uint64_t end = 0;
    for (uint32_t i = 0; i < packing->brick_count; ++i) {
        lmb_pack_brick *const brick = &packing->brick[i];
        if (!brick->cut_stored) {
            continue;
        }
        uint64_t least = UINT64_MAX;
        for (uint32_t shift = 0; shift <= LMB_CUT_SHIFT_MOST; ++shift) {
            const uint64_t units = brick_units(packing, brick, shift);
            brick->cut_shift = units < least ? shift : brick->cut_shift;
            least = units < least ? units : least;
        }
        end = round_up(end, UINT64_C(1) << brick->cut_shift);
        if (end + least > UINT32_MAX) {
            return LMB_ERROR_ARGUMENT;
        }
        brick->cut_first = (uint32_t)end;
        end += least;
    }
    packing->header.cut_bytes = end > 0 ? end * LMB_CUT_UNIT + LMB_CUT_READ_BYTES : 0;
    return LMB_OK;
}

/* `ghost` is the packing's that comes next. @return the one after those of this cell */
static uint32_t record_write(const brick_cuts *at, uint32_t ghost, unsigned char *to)
{
    const lmb_packing *const packing = at->packing;
    const lmb_cut_cells *const cuts = &packing->probes->cut;
    const lmb_cut_cell *const cut = at->cut;
    const lmb_volume_cut head = {(uint8_t)cut->region_count, (uint8_t)cut->plane_count};
    memcpy(to, &head, sizeof head);
    to += sizeof head;
    uint32_t count = 0;
    for (uint32_t i = 0; i < cut->region_count; ++i) {
        lmb_volume_cut_region region = {0, (uint8_t)count};
        for (int k = 0; k < 8; ++k) {
            const bool is_ghost = lmb_pack_is_ghost(packing, cuts->corner[cut->region_first + i][k]);
            region.ghosts |= (uint8_t)(is_ghost << k);
            count += is_ghost;
        }
        memcpy(to, &region, sizeof region);
        to += sizeof region;
    }
    if (cut->plane_count > 0) {
        memcpy(to, &cuts->plane[cut->plane_first], cut->plane_count * sizeof *cuts->plane);
        to += cut->plane_count * sizeof *cuts->plane;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const int16_t number = (int16_t)((int64_t)packing->ghost[ghost + i] - at->brick->ghost_first);
        memcpy(to + i * sizeof number, &number, sizeof number);
    }
    return ghost + count;
}

void lmb_pack_cuts_write(const lmb_packing *packing, unsigned char *to)
{
    for (uint32_t i = 0; i < packing->brick_count; ++i) {
        const lmb_pack_brick *const brick = &packing->brick[i];
        const uint32_t slot_units = 1u << brick->cut_shift;
        uint32_t ghost = brick->ghost_begin;
        brick_cuts at = brick_cuts_of(packing, brick);
        uint32_t slots = 0;
        for (uint64_t cells = brick->cut_stored; cells; cells &= cells - 1) {
            slots += 1;
        }
        uint32_t slot = brick->cut_first, apart = slot + slots * slot_units;
        while (brick_cuts_next(&at)) {
            unsigned char *record = to + (size_t)slot * LMB_CUT_UNIT;
            if (at.units > slot_units) {
                const lmb_volume_cut_apart word = {.record = apart};
                memcpy(record, &word, sizeof word);
                record = to + (size_t)apart * LMB_CUT_UNIT;
                apart += at.units;
            }
            ghost = record_write(&at, ghost, record);
            slot += slot_units;
        }
    }
}
