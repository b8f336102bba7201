/* The layout of a .lmb file, versions 1 and 2, as C structs: for those who write one. docs/formats.md is normative and
 * says what every field means and what must hold; everything is little-endian, and the structs have no padding of their
 * own.
 *
 *     header | key lights | directory: one 32-bit brick number per brick of the box | zeros up to 64 | bricks
 *
 * A brick is 4 x 4 x 4 cells with all their corners, 5 x 5 x 5 lattice points: neighbours repeat the border that they
 * share, so that an interpolation never leaves its brick. Version 2 has key lights, and behind each brick their
 * visibility; version 1 has neither. */
#ifndef LAMBENT_VOLUME_FORMAT_H
#define LAMBENT_VOLUME_FORMAT_H

#include <stddef.h>
#include <stdint.h>

#include <lambent/key_light.h>

#ifdef __cplusplus
extern "C" {
#endif

/* As PNG's: the first byte is no text, the line ends show a transfer that meddled with them. */
#define LMB_VOLUME_MAGIC "\x89LMB\r\n\x1a\n"
#define LMB_VOLUME_NO_BRICK UINT32_C(0xffffffff)

enum {
    LMB_VOLUME_MAGIC_SIZE = 8,
    LMB_VOLUME_VERSION = 1, /* of files without key lights */
    LMB_VOLUME_VERSION_WITH_KEYS = 2,
    LMB_VOLUME_HEADER_BYTES = 128,
    LMB_VOLUME_KEYS_BYTES = 128,
    LMB_VOLUME_CHECKSUM_START = 32, /* the checksum covers everything from here to the end */
    LMB_VOLUME_ALIGNMENT = 64,      /* of the bricks, in the file */
    LMB_VOLUME_MAX_SCALE_LOG2 = 96, /* scale is 2^-96 .. 2^96: 65504 * 2^96 is still a float */
    LMB_BRICK_CELLS = 4,            /* along an axis */
    LMB_BRICK_POINTS = 5,
    LMB_BRICK_PROBES = 125,
    LMB_BRICK_COEFFICIENTS = 27, /* of a probe: red 0..8, green 0..8, blue 0..8 */
    LMB_BRICK_BYTES = 6784,
    LMB_BRICK_KEY_BYTES = 128 /* of each key light: 125 points and 3 zeros */
};

/* 64-bit FNV-1a, the file's checksum: from LMB_VOLUME_HASH_SEED, or on from an earlier result. */
#define LMB_VOLUME_HASH_SEED UINT64_C(0xcbf29ce484222325)
static inline uint64_t lmb_volume_hash(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)data;
    for (size_t i = 0; i < size; ++i) {
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

typedef struct lmb_volume_header {
    unsigned char magic[LMB_VOLUME_MAGIC_SIZE];
    uint32_t version;
    uint32_t header_bytes;
    uint64_t file_bytes;
    uint64_t checksum; /* FNV-1a, 64 bits */
    float spacing;     /* metres */
    float scale;       /* radiance = stored half * scale */
    int32_t min[3];    /* lattice coordinates of the box's first point */
    int32_t size[3];   /* lattice points per axis */
    uint64_t probe_count;
    uint32_t brick_count;
    uint32_t brick_bytes;
    uint64_t directory_offset;
    uint64_t bricks_offset;
    uint32_t reserved[8]; /* 0 */
} lmb_volume_header;

/* Follows the header in version 2. */
typedef struct lmb_volume_keys {
    uint32_t count;                           /* 1 to 4 */
    uint32_t reserved[7];                     /* 0 */
    lmb_key_light light[LMB_KEY_LIGHTS_MOST]; /* those beyond `count` are 0 */
} lmb_volume_keys;

typedef struct lmb_volume_brick {
    uint64_t complete_cells; /* bit x + 4 (y + 4 z): all eight corners of the cell hold probes */
    uint64_t probes[2];      /* bit x + 5 (y + 5 z): the point holds a probe */
    uint16_t sh[LMB_BRICK_PROBES * LMB_BRICK_COEFFICIENTS + 5]; /* halfs, probe by probe; the last five are 0, so that
                                                                   32 may be read from any probe on */
} lmb_volume_brick;

/* Follows a brick in version 2, once for each key light: what of it is seen from each point, in 255ths. */
typedef struct lmb_brick_visibility {
    uint8_t seen[LMB_BRICK_KEY_BYTES];
} lmb_brick_visibility;

#ifdef __cplusplus
}
#endif

#endif
