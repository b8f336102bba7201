/* The volume of one tile: its bricks, and the probes that these name, both in the order that they have in the undivided
 * volume, with numbers of their own. Rows stay whole, as all of their points are taken, and ghosts come no farther from
 * where their bricks count them. */
#include "split_internal.h"

#include <stdlib.h>
#include <string.h>

static int numbers_compare(const void *a, const void *b)
{
    const uint32_t left = *(const uint32_t *)a, right = *(const uint32_t *)b;
    return (left > right) - (left < right);
}

static uint32_t bits_count(uint64_t bits)
{
    uint32_t count = 0;
    for (; bits; bits &= bits - 1) {
        ++count;
    }
    return count;
}

/* ------------------------------------------------------------------------------------------------ bricks */

/* The volume of the tile as far as its box goes. */
static lmb_volume_header tile_header(const lmb_splitting *splitting, const int32_t at[3], lmb_volume_layout *layout)
{
    lmb_volume_header header = *splitting->header;
    lmb_tiles_box(&splitting->tiles, at, header.min, header.size);
    lmb_volume_layout_find(&header, layout);
    return header;
}

/* Goes through a tile's words in the directory of the undivided volume. `to`: its own, or NULL. */
static void blocks_visit(lmb_splitting *splitting, const lmb_volume_layout *tile, uint32_t *to)
{
    const uint32_t number_bits = (UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT) - 1;
    const lmb_volume_layout *const all = &splitting->layout;
    uint64_t from[3];
    for (int axis = 0; axis < 3; ++axis) {
        from[axis] = (uint64_t)((int64_t)tile->block_first[axis] - all->block_first[axis]);
    }
    for (uint64_t i = 0; i < tile->entries; ++i) {
        const uint64_t x = from[0] + i % tile->blocks[0], y = from[1] + i / tile->blocks[0] % tile->blocks[1],
                       z = from[2] + i / tile->blocks[0] / tile->blocks[1];
        const uint32_t word = splitting->directory[x + all->blocks[0] * (y + all->blocks[1] * z)];
        const uint32_t number = word & number_bits;
        if (to && number > 0) {
            const uint32_t *const own = bsearch(&number, splitting->brick_list, splitting->brick_count,
                                                sizeof *splitting->brick_list, numbers_compare);
            to[i] = (word & ~number_bits) | ((uint32_t)(own - splitting->brick_list) + 1);
        } else if (number > 0 && !splitting->brick_taken[number]) {
            splitting->brick_taken[number] = 1;
            splitting->brick_list[splitting->brick_count++] = number;
        }
    }
}

void lmb_split_bricks(lmb_splitting *splitting, const int32_t at[3])
{
    lmb_volume_layout layout;
    tile_header(splitting, at, &layout);
    splitting->brick_count = 0;
    blocks_visit(splitting, &layout, NULL);
    for (uint32_t i = 0; i < splitting->brick_count; ++i) {
        splitting->brick_taken[splitting->brick_list[i]] = 0;
    }
    qsort(splitting->brick_list, splitting->brick_count, sizeof *splitting->brick_list, numbers_compare);
}

/* --------------------------------------------------------------------------------------------- cut cells */

/* Goes through the cut cells of a brick. */
typedef struct brick_cuts {
    const lmb_splitting *splitting;
    const lmb_volume_brick *brick;
    uint64_t left;   /* cells */
    uint32_t slot;   /* of the cell, in LMB_CUT_UNIT bytes */
    uint32_t cell;   /* its number */
    bool is_apart;   /* its record is not in the slot */
    uint32_t ghosts; /* of all of its regions */
    uint32_t units;  /* of its record */
    lmb_volume_cut cut;
    const unsigned char *record;
} brick_cuts;

static brick_cuts brick_cuts_of(const lmb_splitting *splitting, const lmb_volume_brick *brick)
{
    return (brick_cuts){.splitting = splitting,
                        .brick = brick,
                        .left = brick->cut,
                        .slot = brick->cut_first - (1u << brick->cut_shift)};
}

static lmb_volume_cut_region region_of(const brick_cuts *at, uint32_t number)
{
    lmb_volume_cut_region region;
    memcpy(&region, at->record + sizeof at->cut + number * sizeof region, sizeof region);
    return region;
}

static bool brick_cuts_next(brick_cuts *at)
{
    if (at->left == 0) {
        return false;
    }
    const unsigned char *const cuts = at->splitting->source + at->splitting->layout.cuts;
    for (at->cell = 0; !(at->left >> at->cell & 1u); ++at->cell) {
    }
    at->left &= at->left - 1;
    at->slot += 1u << at->brick->cut_shift;
    at->record = cuts + (size_t)at->slot * LMB_CUT_UNIT;
    memcpy(&at->cut, at->record, sizeof at->cut);
    at->is_apart = at->cut.region_count == 0;
    if (at->is_apart) {
        lmb_volume_cut_apart apart;
        memcpy(&apart, at->record, sizeof apart);
        at->record = cuts + (size_t)apart.record * LMB_CUT_UNIT;
        memcpy(&at->cut, at->record, sizeof at->cut);
    }
    at->ghosts = 0;
    for (uint32_t i = 0; i < at->cut.region_count; ++i) {
        at->ghosts += bits_count(region_of(at, i).ghosts);
    }
    const size_t bytes = lmb_volume_cut_bytes(at->cut.region_count, at->cut.plane_count, at->ghosts);
    at->units = (uint32_t)((bytes + LMB_CUT_UNIT - 1) / LMB_CUT_UNIT);
    return true;
}

/* Where the ghosts' numbers are in the cell's record. */
static size_t ghosts_at(const brick_cuts *at)
{
    return lmb_volume_cut_bytes(at->cut.region_count, at->cut.plane_count, 0);
}

static uint32_t ghost_of(const brick_cuts *at, uint32_t number)
{
    int16_t ghost;
    memcpy(&ghost, at->record + ghosts_at(at) + number * sizeof ghost, sizeof ghost);
    return (uint32_t)(at->brick->ghost_first + (int64_t)ghost);
}

/* Gives a tile's brick the place of its slots. `*end`: of those before it, in LMB_CUT_UNIT bytes. */
static void cuts_place(const lmb_splitting *splitting, const lmb_volume_brick *brick, uint64_t *end, uint32_t *first)
{
    const uint64_t slot = UINT64_C(1) << brick->cut_shift;
    brick_cuts at = brick_cuts_of(splitting, brick);
    *first = 0;
    if (brick->cut == 0) {
        return;
    }
    *end = (*end + slot - 1) / slot * slot;
    *first = (uint32_t)*end;
    while (brick_cuts_next(&at)) {
        *end += slot + (at.is_apart ? at.units : 0);
    }
}

/* `own`: the tile's brick, whose ghosts count from its own ghost_first. */
static void cuts_write(const lmb_splitting *splitting, const lmb_volume_brick *brick, const lmb_volume_brick *own,
                       unsigned char *cuts)
{
    const uint32_t slot_units = 1u << brick->cut_shift;
    brick_cuts at = brick_cuts_of(splitting, brick);
    uint32_t slot = own->cut_first, apart = slot + bits_count(brick->cut) * slot_units;
    for (; brick_cuts_next(&at); slot += slot_units) {
        unsigned char *record = cuts + (size_t)slot * LMB_CUT_UNIT;
        if (at.is_apart) {
            const lmb_volume_cut_apart word = {.record = apart};
            memcpy(record, &word, sizeof word);
            record = cuts + (size_t)apart * LMB_CUT_UNIT;
            apart += at.units;
        }
        memcpy(record, at.record, ghosts_at(&at));
        for (uint32_t i = 0; i < at.ghosts; ++i) {
            const int64_t from = own->ghost_first;
            const int16_t number = (int16_t)(splitting->probe_number[ghost_of(&at, i)] - from);
            memcpy(record + ghosts_at(&at) + i * sizeof number, &number, sizeof number);
        }
    }
}

/* ------------------------------------------------------------------------------------------------ probes */

/* Points of a brick's rows, by bits, that plain cells interpolate, or a cut cell's regions have as their own. */
static void points_needed(const lmb_splitting *splitting, const lmb_volume_brick *brick,
                          uint32_t points[LMB_BRICK_ROWS])
{
    brick_cuts at = brick_cuts_of(splitting, brick);
    uint8_t corners[64] = {0};
    memset(points, 0, LMB_BRICK_ROWS * sizeof *points);
    while (brick_cuts_next(&at)) {
        for (uint32_t i = 0; i < at.cut.region_count; ++i) {
            corners[at.cell] |= (uint8_t)~region_of(&at, i).ghosts;
        }
    }
    for (uint32_t cell = 0; cell < 64; ++cell) {
        const uint32_t needed = brick->plain >> cell & 1u ? 255u : corners[cell];
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t row = cell / 4 % 4 + (i >> 1 & 1u) + LMB_BRICK_POINTS * (cell / 16 + (i >> 2));
            points[row] |= (needed >> i & 1u) << (cell % 4 + (i & 1u));
        }
    }
}

static void probe_take(lmb_splitting *splitting, uint32_t probe)
{
    if (splitting->probe_number[probe] == LMB_SPLIT_NOTHING) {
        splitting->probe_number[probe] = 0;
        splitting->probe_list[splitting->probe_count++] = probe;
    }
}

/* The first and the last point of a row that are needed. */
static void row_ends(uint32_t points, uint32_t *low, uint32_t *high)
{
    for (*low = 0; !(points >> *low & 1u); ++*low) {
    }
    for (*high = *low; points >> *high > 1u; ++*high) {
    }
}

/* @return false: numbers that only go round 2^32 */
static bool brick_probes_take(lmb_splitting *splitting, const lmb_volume_brick *brick)
{
    uint32_t points[LMB_BRICK_ROWS];
    bool good = true;
    points_needed(splitting, brick, points);
    for (uint32_t row = 0; row < LMB_BRICK_ROWS; ++row) {
        if (points[row] == 0) {
            continue;
        }
        uint32_t low, high;
        row_ends(points[row], &low, &high);
        const uint32_t first = (brick->row[row] + low * splitting->units) / splitting->units;
        good = good && (uint64_t)first + (high - low) < splitting->header->stored_count;
        for (uint32_t i = 0; good && i <= high - low; ++i) {
            probe_take(splitting, first + i);
        }
    }
    brick_cuts at = brick_cuts_of(splitting, brick);
    while (brick_cuts_next(&at)) {
        for (uint32_t i = 0; i < at.ghosts; ++i) {
            const uint32_t ghost = ghost_of(&at, i);
            good = good && ghost < splitting->header->stored_count;
            if (good) {
                probe_take(splitting, ghost);
            }
        }
    }
    return good;
}

static bool probes_take(lmb_splitting *splitting)
{
    bool good = true;
    splitting->probe_count = 0;
    for (uint32_t i = 0; i < splitting->brick_count; ++i) {
        good = brick_probes_take(splitting, &splitting->brick[splitting->brick_list[i]]) && good;
    }
    qsort(splitting->probe_list, splitting->probe_count, sizeof *splitting->probe_list, numbers_compare);
    for (uint32_t i = 0; i < splitting->probe_count; ++i) {
        splitting->probe_number[splitting->probe_list[i]] = i;
    }
    return good;
}

static void probes_give_back(lmb_splitting *splitting)
{
    for (uint32_t i = 0; i < splitting->probe_count; ++i) {
        splitting->probe_number[splitting->probe_list[i]] = LMB_SPLIT_NOTHING;
    }
}

/* How many of the tile's probes are before one of the undivided volume. */
static uint32_t probes_before(const lmb_splitting *splitting, uint32_t probe)
{
    uint32_t low = 0, high = splitting->probe_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (splitting->probe_list[middle] < probe) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* ----------------------------------------------------------------------------------------------- the file */

/* A brick with the tile's numbers, but for where its slots begin. */
static lmb_volume_brick brick_number(const lmb_splitting *splitting, const lmb_volume_brick *brick)
{
    lmb_volume_brick own = *brick;
    uint32_t points[LMB_BRICK_ROWS];
    points_needed(splitting, brick, points);
    for (uint32_t row = 0; row < LMB_BRICK_ROWS; ++row) {
        uint32_t low, high;
        own.row[row] = 0;
        if (points[row] != 0) {
            row_ends(points[row], &low, &high);
            const uint32_t first = (brick->row[row] + low * splitting->units) / splitting->units;
            own.row[row] = (splitting->probe_number[first] - low) * splitting->units;
        }
    }
    own.ghost_first = brick->cut ? probes_before(splitting, brick->ghost_first) : 0;
    return own;
}

static void bricks_write(const lmb_splitting *splitting, const lmb_volume_layout *layout, unsigned char *image)
{
    lmb_volume_brick *const to = (lmb_volume_brick *)(void *)(image + layout->bricks);
    uint64_t end = 0;
    for (uint32_t i = 0; i < splitting->brick_count; ++i) {
        const lmb_volume_brick *const brick = &splitting->brick[splitting->brick_list[i]];
        to[i + 1] = brick_number(splitting, brick);
        cuts_place(splitting, brick, &end, &to[i + 1].cut_first);
        cuts_write(splitting, brick, &to[i + 1], image + layout->cuts);
    }
}

static void probes_write(const lmb_splitting *splitting, unsigned char *to)
{
    const size_t bytes = splitting->header->probe_bytes;
    const unsigned char *const from = splitting->source + splitting->layout.probes;
    for (uint32_t i = 0; i < splitting->probe_count; ++i) {
        memcpy(to + i * bytes, from + splitting->probe_list[i] * bytes, bytes);
    }
}

static void header_count(const lmb_splitting *splitting, uint32_t number, lmb_volume_header *header)
{
    uint64_t cut_units = 0;
    header->cut_count = 0;
    for (uint32_t i = 0; i < splitting->brick_count; ++i) {
        const lmb_volume_brick *const brick = &splitting->brick[splitting->brick_list[i]];
        uint32_t first;
        cuts_place(splitting, brick, &cut_units, &first);
        header->cut_count += bits_count(brick->cut);
    }
    header->stored_count = splitting->probe_count;
    header->probe_count = splitting->probe_count;
    header->brick_count = splitting->brick_count + 1;
    header->cut_bytes = cut_units > 0 ? cut_units * LMB_CUT_UNIT + LMB_CUT_READ_BYTES : 0;
    header->local_bytes = lmb_split_locals_bytes(splitting, number);
}

lmb_result lmb_split_tile(lmb_splitting *splitting, const lmb_tiles_entry *tile, uint32_t number, unsigned char **data,
                          size_t *size)
{
    lmb_volume_layout layout;
    lmb_volume_header header = tile_header(splitting, tile->at, &layout);
    const bool good = probes_take(splitting);
    header_count(splitting, number, &header);
    lmb_volume_layout_find(&header, &layout);
    unsigned char *const image = good ? aligned_alloc(LMB_VOLUME_ALIGNMENT, (size_t)layout.end) : NULL;
    if (image) {
        memset(image, 0, (size_t)layout.end);
        blocks_visit(splitting, &layout, (uint32_t *)(void *)(image + layout.directory));
        bricks_write(splitting, &layout, image);
        probes_write(splitting, image + layout.probes);
        lmb_split_locals_write(splitting, number, image + layout.locals);
        header.file_bytes = layout.end;
        memcpy(image, &header, sizeof header);
        header.checksum =
            lmb_volume_hash(image + LMB_VOLUME_CHECKSUM_START, (size_t)layout.end - LMB_VOLUME_CHECKSUM_START);
        memcpy(image, &header, sizeof header);
        *data = image;
        *size = (size_t)layout.end;
    }
    probes_give_back(splitting);
    return image ? LMB_OK : good ? LMB_ERROR_MEMORY : LMB_ERROR_FORMAT;
}
