/* Which cells a file stores, and by which level each block of the directory is sampled. A block belongs to the finest
 * level that has a cell there. */
#include "pack_internal.h"

#include <stdlib.h>
#include <string.h>

bool lmb_pack_reserve(void **array, size_t size, uint32_t count)
{
    if ((count & (count - 1)) != 0) {
        return true;
    }
    void *const grown = realloc(*array, (count > 0 ? 2 * (size_t)count : 1) * size);
    *array = grown ? grown : *array;
    return grown != NULL;
}

int32_t lmb_pack_probe(const lmb_packing *packing, uint32_t level, const int32_t point[3])
{
    const int32_t probe = lmb_probe_index_find(&packing->probes->level[level].index, point);
    return probe >= 0 && packing->pass[probe] >= 0 ? probe : -1;
}

/* ------------------------------------------------------------------------------------------------- bricks */

static lmb_result brick_add(lmb_packing *packing, uint32_t level, const int32_t at[3])
{
    if (lmb_probe_index_find(&packing->brick_at[level], at) >= 0) {
        return LMB_OK;
    }
    void *bricks = packing->brick;
    const bool has_room = lmb_pack_reserve(&bricks, sizeof *packing->brick, packing->brick_count);
    packing->brick = bricks;
    if (!has_room) {
        return LMB_ERROR_MEMORY;
    }
    packing->brick[packing->brick_count] = (lmb_pack_brick){.at = {at[0], at[1], at[2]}, .level = level};
    return lmb_probe_index_add(&packing->brick_at[level], at, (int32_t)packing->brick_count++);
}

/* Blocks of the probes' index begin where bricks do: a brick has its points in one, and in those behind it. */
static lmb_result bricks_collect(lmb_packing *packing)
{
    const lmb_probes *const probes = packing->probes;
    lmb_result result = LMB_OK;
    for (uint32_t level = 0; level < probes->level_count; ++level) {
        const lmb_probe_index *const index = &probes->level[level].index;
        for (uint32_t i = 0; i < index->block_count; ++i) {
            for (int32_t side = 0; side < 8 && result == LMB_OK; ++side) {
                const int32_t *const block = index->block[i].at;
                const int32_t at[3] = {block[0] - (side & 1), block[1] - (side >> 1 & 1), block[2] - (side >> 2)};
                result = brick_add(packing, level, at);
            }
        }
        const lmb_probe_index *const cut = &probes->level[level].cut;
        for (uint32_t i = 0; i < cut->block_count && result == LMB_OK; ++i) {
            result = brick_add(packing, level, cut->block[i].at);
        }
    }
    return result;
}

static int bricks_compare(const void *a, const void *b)
{
    const lmb_pack_brick *const left = a, *const right = b;
    const int64_t keys[4][2] = {{left->level, right->level},
                                {left->at[2], right->at[2]},
                                {left->at[1], right->at[1]},
                                {left->at[0], right->at[0]}};
    int order = 0;
    for (int i = 0; i < 4 && order == 0; ++i) {
        order = (keys[i][0] > keys[i][1]) - (keys[i][0] < keys[i][1]);
    }
    return order;
}

/* Puts them in order, and finds them by it. */
static lmb_result bricks_sort(lmb_packing *packing)
{
    qsort(packing->brick, packing->brick_count, sizeof *packing->brick, bricks_compare);
    lmb_result result = LMB_OK;
    for (uint32_t level = 0; level < packing->probes->level_count; ++level) {
        lmb_probe_index_free(&packing->brick_at[level]);
    }
    for (uint32_t i = 0; i < packing->brick_count && result == LMB_OK; ++i) {
        const lmb_pack_brick *const brick = &packing->brick[i];
        result = lmb_probe_index_add(&packing->brick_at[brick->level], brick->at, (int32_t)i);
    }
    return result;
}

const lmb_pack_brick *lmb_pack_brick_of(const lmb_packing *packing, uint32_t level, const int32_t cell[3],
                                        uint32_t *number)
{
    int32_t at[3];
    *number = 0;
    for (int axis = 0; axis < 3; ++axis) {
        at[axis] = lmb_volume_floor_divide(cell[axis], LMB_BRICK_CELLS);
        *number |= (uint32_t)(cell[axis] - at[axis] * LMB_BRICK_CELLS) << 2 * axis;
    }
    const int32_t brick = lmb_probe_index_find(&packing->brick_at[level], at);
    return brick >= 0 ? &packing->brick[brick] : NULL;
}

/* -------------------------------------------------------------------------------------------------- cells */

/* Cells along an axis, by bits, that are of the level's box. Where all is one point thick, one counts. */
static uint32_t cells_along(const lmb_packing *packing, const lmb_pack_brick *brick, int axis)
{
    const lmb_lattice *const lattice = &packing->probes->level[brick->level].lattice;
    uint32_t cells = 0;
    for (int32_t i = 0; i < LMB_BRICK_CELLS; ++i) {
        const int64_t local = (int64_t)brick->at[axis] * LMB_BRICK_CELLS + i - lattice->min[axis];
        const int64_t count = packing->header.size[axis] > 1 ? (int64_t)lattice->size[axis] - 1 : 1;
        cells |= (uint32_t)(local >= 0 && local < count) << i;
    }
    return cells;
}

static uint64_t cells_in_box(const lmb_packing *packing, const lmb_pack_brick *brick)
{
    const uint32_t x = cells_along(packing, brick, 0), y = cells_along(packing, brick, 1),
                   z = cells_along(packing, brick, 2);
    uint64_t cells = 0;
    for (int i = 0; i < LMB_BRICK_CELLS * LMB_BRICK_CELLS; ++i) {
        if ((y >> i % LMB_BRICK_CELLS & 1u) && (z >> i / LMB_BRICK_CELLS & 1u)) {
            cells |= (uint64_t)x << LMB_BRICK_CELLS * i;
        }
    }
    return cells;
}

/* Of each row of points, by bits, those with light, and those that were baked. */
static void points_find(const lmb_packing *packing, const lmb_pack_brick *brick, uint32_t lit[LMB_BRICK_ROWS],
                        uint32_t baked[LMB_BRICK_ROWS])
{
    for (int32_t row = 0; row < LMB_BRICK_ROWS; ++row) {
        lit[row] = baked[row] = 0;
        for (int32_t x = 0; x < LMB_BRICK_POINTS; ++x) {
            const int32_t point[3] = {brick->at[0] * LMB_BRICK_CELLS + x,
                                      brick->at[1] * LMB_BRICK_CELLS + row % LMB_BRICK_POINTS,
                                      brick->at[2] * LMB_BRICK_CELLS + row / LMB_BRICK_POINTS};
            const int32_t probe = lmb_pack_probe(packing, brick->level, point);
            lit[row] |= (uint32_t)(probe >= 0) << x;
            baked[row] |= (uint32_t)(probe >= 0 && packing->pass[probe] == 0) << x;
        }
    }
}

static void cells_find(const lmb_packing *packing, lmb_pack_brick *brick)
{
    uint32_t lit[LMB_BRICK_ROWS], baked[LMB_BRICK_ROWS];
    points_find(packing, brick, lit, baked);
    const uint64_t in_box = cells_in_box(packing, brick);
    for (int i = 0; i < LMB_BRICK_CELLS * LMB_BRICK_CELLS; ++i) {
        const int row = i % LMB_BRICK_CELLS + LMB_BRICK_POINTS * (i / LMB_BRICK_CELLS);
        const int next = row + LMB_BRICK_POINTS;
        const uint32_t all = lit[row] & lit[row + 1] & lit[next] & lit[next + 1];
        const uint32_t any = baked[row] | baked[row + 1] | baked[next] | baked[next + 1];
        brick->whole |= (uint64_t)(all & all >> 1 & 15u) << LMB_BRICK_CELLS * i;
        brick->touched |= (uint64_t)((any | any >> 1) & 15u) << LMB_BRICK_CELLS * i;
    }
    brick->whole &= in_box;
    brick->touched &= in_box;
}

static void cut_cells_find(lmb_packing *packing)
{
    const lmb_cut_cells *const cut = &packing->probes->cut;
    for (uint32_t i = 0; i < cut->count; ++i) {
        const lmb_cut_cell *const cell = &cut->cell[i];
        uint32_t number;
        const lmb_pack_brick *const brick = lmb_pack_brick_of(packing, cell->level, cell->point, &number);
        packing->brick[brick - packing->brick].cut |= UINT64_C(1) << number;
    }
}

const lmb_cut_cell *lmb_pack_cut(const lmb_packing *packing, const lmb_pack_brick *brick, int32_t number)
{
    const int32_t first[3] = {brick->at[0] * LMB_BRICK_CELLS + number % 4,
                              brick->at[1] * LMB_BRICK_CELLS + number / 4 % 4,
                              brick->at[2] * LMB_BRICK_CELLS + number / 16};
    const int32_t cut = lmb_probe_index_find(&packing->probes->level[brick->level].cut, first);
    return &packing->probes->cut.cell[cut];
}

/* ------------------------------------------------------------------------------------------------- blocks */

/* Cells of a brick in one of its blocks, of 2^level along each axis. */
static uint64_t block_cells(uint32_t level, const uint32_t block[3])
{
    static const uint64_t half_x[2] = {UINT64_C(0x3333333333333333), UINT64_C(0xcccccccccccccccc)};
    static const uint64_t half_y[2] = {UINT64_C(0x00ff00ff00ff00ff), UINT64_C(0xff00ff00ff00ff00)};
    static const uint64_t half_z[2] = {UINT64_C(0x00000000ffffffff), UINT64_C(0xffffffff00000000)};
    if (level == 0) {
        return ~UINT64_C(0);
    }
    if (level == 1) {
        return half_x[block[0]] & half_y[block[1]] & half_z[block[2]];
    }
    const uint32_t shift = level - 2;
    return UINT64_C(1) << ((block[0] >> shift) + 4 * (block[1] >> shift) + 16 * (block[2] >> shift));
}

/* Goes through the blocks of a brick that the directory has. */
typedef void block_visit(lmb_packing *packing, lmb_pack_brick *brick, size_t block, uint64_t cells);

static void blocks_visit(lmb_packing *packing, lmb_pack_brick *brick, block_visit *visit)
{
    const lmb_volume_layout *const layout = &packing->layout;
    uint32_t first[3], end[3];
    int64_t base[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t along = INT64_C(1) << brick->level;
        base[axis] = brick->at[axis] * along - layout->block_first[axis];
        const int64_t last = (int64_t)layout->blocks[axis] - base[axis];
        first[axis] = (uint32_t)(base[axis] < 0 ? (-base[axis] < along ? -base[axis] : along) : 0);
        end[axis] = (uint32_t)(last < 0 ? 0 : last < along ? last : along);
    }
    uint32_t at[3];
    for (at[2] = first[2]; at[2] < end[2]; ++at[2]) {
        for (at[1] = first[1]; at[1] < end[1]; ++at[1]) {
            for (at[0] = first[0]; at[0] < end[0]; ++at[0]) {
                const size_t block =
                    (size_t)(base[0] + at[0]) +
                    layout->blocks[0] * ((size_t)(base[1] + at[1]) + layout->blocks[1] * (size_t)(base[2] + at[2]));
                visit(packing, brick, block, block_cells(brick->level, at));
            }
        }
    }
}

static void block_claim(lmb_packing *packing, lmb_pack_brick *brick, size_t block, uint64_t cells)
{
    if (packing->level_of[block] == LMB_PACK_NO_LEVEL && ((brick->whole | brick->cut) & cells)) {
        packing->level_of[block] = (uint8_t)brick->level;
    }
}

static void block_claim_touched(lmb_packing *packing, lmb_pack_brick *brick, size_t block, uint64_t cells)
{
    if (packing->level_of[block] == LMB_PACK_NO_LEVEL && (brick->touched & cells)) {
        packing->level_of[block] = (uint8_t)brick->level;
    }
}

/* Collects in `plain` the cells that are sampled. */
static void block_collect(lmb_packing *packing, lmb_pack_brick *brick, size_t block, uint64_t cells)
{
    if (packing->level_of[block] == brick->level) {
        brick->plain |= cells;
    }
}

static void block_name(lmb_packing *packing, lmb_pack_brick *brick, size_t block, uint64_t cells)
{
    (void)cells;
    if (packing->level_of[block] == brick->level) {
        const uint32_t number = (uint32_t)(brick - packing->brick) + 1;
        packing->directory[block] = number | brick->level << LMB_VOLUME_LEVEL_SHIFT;
    }
}

void lmb_pack_directory(lmb_packing *packing, uint32_t *directory)
{
    packing->directory = directory;
    memset(directory, 0, (size_t)packing->layout.entries * sizeof *directory);
    for (uint32_t i = 0; i < packing->brick_count; ++i) {
        blocks_visit(packing, &packing->brick[i], block_name);
    }
}

/* Bricks are in the order of levels: the finest claims a block first. */
static void blocks_claim(lmb_packing *packing)
{
    memset(packing->level_of, LMB_PACK_NO_LEVEL, (size_t)packing->layout.entries);
    block_visit *const visits[] = {block_claim, block_claim_touched, block_collect};
    for (int i = 0; i < 3; ++i) {
        for (uint32_t k = 0; k < packing->brick_count; ++k) {
            blocks_visit(packing, &packing->brick[k], visits[i]);
        }
    }
}

/* ------------------------------------------------------------------------------------------ what is stored */

static bool coarser_cell_is_there(const lmb_packing *packing, uint32_t level, const int32_t cell[3])
{
    bool there = false;
    for (uint32_t coarser = level + 1; !there && coarser < packing->probes->level_count; ++coarser) {
        int32_t at[3];
        uint32_t number;
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = lmb_volume_floor_divide(cell[axis], INT32_C(1) << (coarser - level));
        }
        const lmb_pack_brick *const brick = lmb_pack_brick_of(packing, coarser, at, &number);
        there = brick && ((brick->whole | brick->cut) >> number & 1u);
    }
    return there;
}

static lmb_result corner_want(lmb_packing *packing, uint32_t level, const int32_t point[3], bool of_coarser)
{
    const int32_t known = lmb_probe_index_find(&packing->corner_at[level], point);
    if (known >= 0) {
        packing->corner[known].of_coarser |= of_coarser;
        return LMB_OK;
    }
    void *corners = packing->corner;
    const bool has_room = packing->corner_count < INT32_MAX / 2 &&
                          lmb_pack_reserve(&corners, sizeof *packing->corner, (uint32_t)packing->corner_count);
    packing->corner = corners;
    if (!has_room) {
        return LMB_ERROR_MEMORY;
    }
    packing->corner[packing->corner_count] =
        (lmb_pack_corner){.point = {point[0], point[1], point[2]}, .level = level, .of_coarser = of_coarser};
    return lmb_probe_index_add(&packing->corner_at[level], point, packing->corner_count++);
}

/* Stores a cell though corners are missing: one was baked, or a coarser cell has light here. */
static lmb_result cell_complete(lmb_packing *packing, lmb_pack_brick *brick, uint32_t number)
{
    const uint64_t bit = UINT64_C(1) << number;
    int32_t cell[3];
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = brick->at[axis] * LMB_BRICK_CELLS + (int32_t)(number >> 2 * axis & 3u);
    }
    const bool of_coarser = !(brick->touched & bit);
    if (of_coarser && !coarser_cell_is_there(packing, brick->level, cell)) {
        return LMB_OK;
    }
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < 8 && result == LMB_OK; ++i) {
        const int32_t point[3] = {cell[0] + (i & 1), cell[1] + (i >> 1 & 1), cell[2] + (i >> 2)};
        if (lmb_pack_probe(packing, brick->level, point) < 0) {
            result = corner_want(packing, brick->level, point, of_coarser);
        }
    }
    brick->plain |= bit;
    return result;
}

static lmb_result brick_finish(lmb_packing *packing, lmb_pack_brick *brick)
{
    const uint64_t sampled = brick->plain;
    brick->cut_stored = sampled & brick->cut;
    brick->plain = sampled & brick->whole & ~brick->cut;
    const uint64_t rest = sampled & ~brick->plain & ~brick->cut;
    lmb_result result = LMB_OK;
    for (uint32_t number = 0; number < 64 && rest >> number != 0 && result == LMB_OK; ++number) {
        if (rest >> number & 1u) {
            result = cell_complete(packing, brick, number);
        }
    }
    return result;
}

lmb_result lmb_pack_drop(lmb_packing *packing)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < packing->brick_count; ++i) {
        if (packing->brick[i].plain || packing->brick[i].cut_stored) {
            packing->brick[kept++] = packing->brick[i];
        }
    }
    packing->brick_count = kept;
    return kept > 0 ? bricks_sort(packing) : LMB_ERROR_ARGUMENT;
}

lmb_result lmb_pack_cells(lmb_packing *packing)
{
    lmb_result result = bricks_collect(packing);
    if (result == LMB_OK) {
        result = bricks_sort(packing);
    }
    if (result == LMB_OK) {
        cut_cells_find(packing);
    }
    for (uint32_t i = 0; result == LMB_OK && i < packing->brick_count; ++i) {
        cells_find(packing, &packing->brick[i]);
    }
    if (result == LMB_OK) {
        blocks_claim(packing);
    }
    for (uint32_t i = 0; result == LMB_OK && i < packing->brick_count; ++i) {
        result = brick_finish(packing, &packing->brick[i]);
    }
    return result;
}
