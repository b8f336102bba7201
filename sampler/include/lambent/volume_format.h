/* The layout of a .lmb file, version 5, as C structs: for those who write one. docs/formats.md is normative and says
 * what every field means and what must hold; everything is little-endian, and the structs have no padding of their own.
 *
 *     header | directory | heads of bricks | probes, with what is seen of key lights | cut cells
 *     | local sets (lambent/local_set_format.h)
 *
 * each part from the next multiple of 64 on. A brick is 4 x 4 x 4 cells of one level. The directory has a word for each
 * 4 x 4 x 4 cells of the finest level, which names the brick that is there. A brick's head says which of its cells are
 * there, and for each of its 25 rows of points along x where they are among the probes: rows are shared by the bricks
 * that touch there, and run on through bricks beside each other. */
#ifndef LAMBENT_VOLUME_FORMAT_H
#define LAMBENT_VOLUME_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <lambent/cell.h>
#include <lambent/key_light.h>

#ifdef __cplusplus
extern "C" {
#endif

/* As PNG's: the first byte is no text, the line ends show a transfer that meddled with them. */
#define LMB_VOLUME_MAGIC "\x89LMB\r\n\x1a\n"

enum {
    LMB_VOLUME_MAGIC_SIZE = 8,
    LMB_VOLUME_VERSION = 5,
    LMB_VOLUME_VERSION_OLDEST = 3, /* that is read: its cut cells are lmb_volume_cut_3 */
    LMB_VOLUME_HEADER_BYTES = 256,
    LMB_VOLUME_CHECKSUM_START = 32, /* the checksum covers everything from here to the end */
    LMB_VOLUME_ALIGNMENT = 64,      /* of every part, in the file */
    LMB_VOLUME_MAX_SCALE_LOG2 = 96, /* scale is 2^-96 .. 2^96: 65504 * 2^96 is still a float */
    LMB_VOLUME_LEVELS_MOST = 15,
    LMB_VOLUME_LEVEL_SHIFT = 28, /* a word of the directory: level above, number of the brick below */
    LMB_BRICK_CELLS = 4,         /* along an axis */
    LMB_BRICK_POINTS = 5,
    LMB_BRICK_ROWS = 25,         /* of points along x: y + 5 z */
    LMB_PROBE_COEFFICIENTS = 27, /* red 0..8, green 0..8, blue 0..8 */
    LMB_PROBE_UNIT = 2,          /* bytes that places of probes are counted in */
    LMB_PROBE_READ_BYTES = 64,   /* that may be read from the last probe on */
    LMB_CUT_UNIT = 16,           /* bytes that cut cells' slots and records begin at multiples of */
    LMB_CUT_SHIFT_MOST = 2,      /* slots are 16, 32 or 64 bytes */
    LMB_CUT_READ_BYTES = 64      /* that may be read from the end of the last cut cell on */
};

/* The file's checksum. Eight hashes of every eighth word each, so that processors multiply several at once; every step
 * is one to one in the word and in the hash, so that no change of a single word is missed. What is missing of the last
 * 64 bytes counts as zeros. */
static inline uint64_t lmb_volume_hash_step(uint64_t hash, uint64_t word)
{
    const uint64_t product = (hash ^ word) * UINT64_C(0x9e3779b97f4a7c15);
    return product << 29 | product >> 35;
}

static inline uint64_t lmb_volume_hash(const void *data, size_t size)
{
    enum { LANES = 8 };
    const unsigned char *const bytes = (const unsigned char *)data;
    uint64_t lane[LANES], word[LANES];
    for (int i = 0; i < LANES; ++i) {
        lane[i] = UINT64_C(0xcbf29ce484222325) + (uint64_t)i;
    }
    for (size_t at = 0; at < size; at += sizeof word) {
        if (size - at < sizeof word) {
            memset(word, 0, sizeof word);
        }
        memcpy(word, bytes + at, size - at < sizeof word ? size - at : sizeof word);
        for (int i = 0; i < LANES; ++i) {
            lane[i] = lmb_volume_hash_step(lane[i], word[i]);
        }
    }
    uint64_t hash = size;
    for (int i = 0; i < LANES; ++i) {
        hash = lmb_volume_hash_step(hash, lane[i]);
    }
    return hash ^ hash >> 32;
}

typedef struct lmb_volume_header {
    unsigned char magic[LMB_VOLUME_MAGIC_SIZE];
    uint32_t version;
    uint32_t header_bytes;
    uint64_t file_bytes;
    uint64_t checksum;     /* lmb_volume_hash */
    float spacing;         /* metres, of the finest level; each next one has twice that */
    float scale;           /* radiance = stored half * scale */
    int32_t min[3];        /* the box of all levels on the finest lattice: first point, */
    int32_t size[3];       /* points per axis */
    uint64_t probe_count;  /* that were baked, or stand for one that was, without copies */
    uint32_t stored_count; /* in the array */
    uint32_t brick_count;  /* the first one is no brick: all 0, what blocks without a brick name */
    uint32_t level_count;
    uint32_t key_light_count;
    uint32_t probe_bytes; /* of a probe in the array: lmb_volume_probe_bytes */
    uint32_t cut_count;   /* cut cells */
    uint64_t cut_bytes;   /* of all of them, with what may be read behind */
    uint32_t probe_form;  /* lmb_volume_form */
    uint32_t reserved[11];
    uint64_t local_bytes;                         /* of local sets; 0: there are none */
    lmb_key_light key_light[LMB_KEY_LIGHTS_MOST]; /* those beyond the count are 0 */
} lmb_volume_header;

/* Bit x + 4 (y + 4 z) of a mask is a cell. A cell is plain, cut, or not there. Cut cells have slots of one size in the
 * order of their bits. */
typedef struct lmb_volume_brick {
    uint64_t plain; /* its eight corners are interpolated */
    uint64_t cut;
    uint32_t
        row[LMB_BRICK_ROWS]; /* [y + 5 z] place of the probe at x = 0 in units, modulo 2^32: where the row begins at
                                a later x, there may be none before it. 0 where no cell has a point of the row */
    uint32_t cut_first;      /* where the slots of its cut cells begin, in LMB_CUT_UNIT bytes from the first brick's;
                                version 3: number of its first cut cell among all */
    uint32_t ghost_first;    /* number of the probe that its cut cells count their ghosts from */
    uint32_t cut_shift;      /* a slot has LMB_CUT_UNIT << cut_shift bytes */
} lmb_volume_brick;

/* How the coefficients of a probe are stored. */
typedef enum lmb_volume_form {
    LMB_VOLUME_HALFS,   /* 27 halfs: red 0..8, green 0..8, blue 0..8 */
    LMB_VOLUME_COMPACT, /* three halfs: coefficient 0 of red, green and blue; then 24 signed bytes: red 1..8,
                           green 1..8, blue 1..8, each a share of its colour's 0 (lmb_compact_share) */
    LMB_VOLUME_FORMS
} lmb_volume_form;

enum { LMB_HALFS_BYTES = 54, LMB_COMPACT_BYTES = 30 };

/* A probe: its coefficients, then a byte for each key light: what is seen of it, in 255ths; one that is 0 makes them
 * even. */
static inline uint32_t lmb_volume_probe_bytes(uint32_t form, uint32_t key_lights)
{
    return (form == LMB_VOLUME_COMPACT ? LMB_COMPACT_BYTES : LMB_HALFS_BYTES) + (key_lights + 1) / 2 * 2;
}

/* Coefficient k = 1..8 over coefficient 0 is b |b| times this. Light that is nowhere negative has shares of up to
 * sqrt(3) in band 1 and sqrt(5) in band 2: then b is +-127. Squares are close together where most shares are. */
static inline float lmb_compact_share(int k)
{
    return k < 4 ? 1.0738726e-4f : 1.3863636e-4f; /* sqrt(3) / 127^2, sqrt(5) / 127^2 */
}

/* A cut cell's record: this, then its regions, then its planes (lmb_cell_plane), then its ghosts, region by region and
 * corner by corner: int16_t each, numbers of probes from the brick's ghost_first. It lies in the cell's slot; where the
 * slot is too small, that holds a lmb_volume_cut_apart. Behind the last there are LMB_CUT_READ_BYTES of 0. */
typedef struct lmb_volume_cut {
    uint8_t region_count; /* 1 to LMB_CELL_REGIONS_MOST */
    uint8_t plane_count;  /* 0 to LMB_CELL_PLANES_MOST */
} lmb_volume_cut;

typedef struct lmb_volume_cut_region {
    uint8_t ghosts; /* bit i: corner i is a ghost; the others are where a plain cell has them */
    uint8_t first;  /* of its ghosts, among the cell's: how many the regions before have */
} lmb_volume_cut_region;

typedef struct lmb_volume_cut_apart {
    uint16_t zero;
    uint16_t reserved;
    uint32_t record; /* where it begins, in LMB_CUT_UNIT bytes from the first brick's slots */
} lmb_volume_cut_apart;

static inline size_t lmb_volume_cut_bytes(uint32_t regions, uint32_t planes, uint32_t ghosts)
{
    return sizeof(lmb_volume_cut) + regions * sizeof(lmb_volume_cut_region) + planes * sizeof(lmb_cell_plane) +
           ghosts * sizeof(int16_t);
}

/* A cut cell of version 3: this, then places of 8 probes (uint32_t, in units) for each region, corner by corner, then
 * its planes, then zeros up to a multiple of 4 bytes. */
typedef struct lmb_volume_cut_3 {
    uint8_t region_count;
    uint8_t plane_count;
    uint16_t reserved;
} lmb_volume_cut_3;

static inline size_t lmb_volume_cut_3_bytes(uint32_t regions, uint32_t planes)
{
    return (sizeof(lmb_volume_cut_3) + regions * 8 * sizeof(uint32_t) + planes * sizeof(lmb_cell_plane) + 3) / 4 * 4;
}

/* Where everything lies, in bytes. */
typedef struct lmb_volume_layout {
    int32_t block_first[3]; /* 4 x 4 x 4 cells of the finest level, which begin at multiples of 4: the box's first, */
    uint32_t blocks[3];     /* how many along each axis */
    uint64_t entries;       /* of the directory: x + blocks[0] (y + blocks[1] z) */
    uint64_t directory, bricks, probes, cut_offsets, cuts, locals, end;
} lmb_volume_layout;

/* The quotient of a division by a positive number, rounded down. */
static inline int32_t lmb_volume_floor_divide(int32_t a, int32_t b)
{
    return a / b - (a % b < 0);
}

/* From box and counts of a header.
 * @return false: the box is none, or the directory would have more than 2^31 words */
static inline bool lmb_volume_layout_find(const lmb_volume_header *header, lmb_volume_layout *layout)
{
    layout->entries = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const int64_t first = header->min[axis];
        const int64_t last = first + header->size[axis] - 1;
        if (header->size[axis] < 1 || last > INT32_MAX) {
            return false;
        }
        const int64_t last_cell = header->size[axis] > 1 ? last - 1 : first;
        layout->block_first[axis] = lmb_volume_floor_divide((int32_t)first, LMB_BRICK_CELLS);
        layout->blocks[axis] =
            (uint32_t)(lmb_volume_floor_divide((int32_t)last_cell, LMB_BRICK_CELLS) - layout->block_first[axis] + 1);
        if (layout->blocks[axis] > (UINT64_C(1) << 31) / layout->entries) {
            return false;
        }
        layout->entries *= layout->blocks[axis];
    }
    const uint64_t size[] = {LMB_VOLUME_HEADER_BYTES,
                             layout->entries * sizeof(uint32_t),
                             (uint64_t)header->brick_count * sizeof(lmb_volume_brick),
                             (uint64_t)header->stored_count * header->probe_bytes + LMB_PROBE_READ_BYTES,
                             header->version == 3 ? (uint64_t)header->cut_count * sizeof(uint32_t) : 0,
                             header->cut_bytes,
                             header->local_bytes};
    uint64_t *const place[] = {&layout->directory, &layout->bricks, &layout->probes, &layout->cut_offsets,
                               &layout->cuts,      &layout->locals, &layout->end};
    uint64_t at = 0;
    for (size_t i = 0; i < sizeof size / sizeof size[0]; ++i) {
        at = (at + size[i] + LMB_VOLUME_ALIGNMENT - 1) / LMB_VOLUME_ALIGNMENT * LMB_VOLUME_ALIGNMENT;
        *place[i] = at;
    }
    return true;
}

#ifdef __cplusplus
}
#endif

#endif
