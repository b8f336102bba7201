/* The open volume, and the steps of opening one: map the file, verify it, derive what sampling needs. */
#ifndef LMB_VOLUME_INTERNAL_H
#define LMB_VOLUME_INTERNAL_H

#include <float.h>
#include <string.h>

#include <lambent/lattice.h>
#include <lambent/volume.h>
#include <lambent/volume_format.h>

#include "volume_kernel.h"

/* Positions are told in spacings of the finest level from the origin, a point that every level has cells at: a cell's
 * number within its brick is then the last bits of that. Fields of three axes have a fourth one, 0, where kernels read
 * four at once. */
struct lmb_volume {
    const lmb_volume_calls *calls;
    const uint32_t *directory;
    const lmb_volume_brick *bricks;
    const unsigned char *probes;
    uint32_t probe_units; /* from one to the next */
    uint32_t key_count;
    size_t first_entry; /* that blocks counted from the origin have more than the directory: its first block's */
    size_t entry_step[2];
    double inverse_spacing;
    double origin[4];     /* lattice coordinates */
    double first[4];      /* of the box's first point, from the origin */
    double last[4];       /* and of its last one */
    double nearest[4];    /* that counts as inside: a little before the first, as positions in floats round */
    double farthest[4];   /* and a little behind the last */
    int32_t last_cell[4]; /* from the origin; >= 0 even where the box is one point thick */
    float scale;
    const unsigned char *cuts;
    const uint32_t *cut_offsets; /* of records of version 3, in words of 4 bytes; else NULL */
    const unsigned char *locals; /* of header->local_bytes; NULL: none */
    const lmb_volume_header *header;
    void *mapping;     /* NULL when the caller owns the bytes */
    bool is_allocated; /* false when the caller gave the handle's memory */
};

/* The brick at a cell, counted from the origin, and its level; where there is none, one without cells. */
static inline const lmb_volume_brick *lmb_volume_brick_at(const lmb_volume *volume, const uint32_t cell[3],
                                                          uint32_t *level)
{
    const size_t entry = (cell[0] >> 2) + volume->entry_step[0] * (cell[1] >> 2) +
                         volume->entry_step[1] * (cell[2] >> 2) - volume->first_entry;
    const uint32_t word = volume->directory[entry];
    *level = word >> LMB_VOLUME_LEVEL_SHIFT;
    return &volume->bricks[word & ((UINT32_C(1) << LMB_VOLUME_LEVEL_SHIFT) - 1)];
}

/* The probe at a place. */
static inline const unsigned char *lmb_volume_probe_at(const lmb_volume *volume, uint32_t units)
{
    return volume->probes + (size_t)units * LMB_PROBE_UNIT;
}

/* How many bits are set. */
static inline uint32_t lmb_volume_bits(uint64_t bits)
{
#if defined(__POPCNT__)
    return (uint32_t)__builtin_popcountll(bits);
#else
    bits -= bits >> 1 & UINT64_C(0x5555555555555555);
    bits = (bits & UINT64_C(0x3333333333333333)) + (bits >> 2 & UINT64_C(0x3333333333333333));
    bits = (bits + (bits >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    return (uint32_t)(bits * UINT64_C(0x0101010101010101) >> 56);
#endif
}

/* The points of row y, z that are corners of some cells of a brick: bit x. Bits of the cells, moved to their low and
 * their high ends. */
static inline uint32_t lmb_volume_row_points(uint64_t cells, uint32_t y, uint32_t z)
{
    uint32_t points = 0;
    for (uint32_t side = 0; side < 4; ++side) {
        const uint32_t cell_y = y - (side & 1u), cell_z = z - (side >> 1);
        if (cell_y < LMB_BRICK_CELLS && cell_z < LMB_BRICK_CELLS) {
            const uint32_t four = (uint32_t)(cells >> (4 * (cell_y + 4 * cell_z))) & 15u;
            points |= four | four << 1;
        }
    }
    return points;
}

/* A finite half: its bits, moved to their places in a float, are its value times 2^-112 (denormals too). */
static inline float lmb_volume_half(const unsigned char *at)
{
    uint16_t half;
    float value;
    memcpy(&half, at, sizeof half);
    const uint32_t wide = half, bits = (wide & 0x7fffu) << 13 | (wide & 0x8000u) << 16;
    memcpy(&value, &bits, sizeof value);
    return value * 0x1p112f;
}

/* Irradiance by a kernel (lmb_sh3_irradiance_kernel), never negative nor NaN. Summed so that four lanes may do it: all
 * kernels give the same bits. */
static inline lmb_rgb lmb_volume_irradiance_sum(const lmb_sh3_rgb *light, const lmb_sh3 *kernel)
{
    lmb_rgb irradiance;
    for (int channel = 0; channel < 3; ++channel) {
        const float *const c = light->channel[channel].c;
        float four[4];
        for (int k = 0; k < 4; ++k) {
            four[k] = c[k] * kernel->c[k] + c[k + 4] * kernel->c[k + 4];
        }
        const float sum = ((four[0] + four[1]) + (four[2] + four[3])) + c[8] * kernel->c[8];
        irradiance.c[channel] = sum > 0.0f ? (sum < FLT_MAX ? sum : FLT_MAX) : 0.0f;
    }
    return irradiance;
}

/* Verifies the file in memory wholly and sets header, directory, bricks, probes and what there is of cut cells.
 * Needs no memory.
 * @return LMB_ERROR_FORMAT, _TRUNCATED, _VERSION, _CHECKSUM */
lmb_result lmb_volume_verify(const unsigned char *data, size_t size, lmb_volume *volume);

/* A kind of file: its first LMB_VOLUME_MAGIC_SIZE bytes, its versions, and how long its header is. */
typedef struct lmb_volume_file_kind {
    const char *magic;
    uint32_t oldest, newest;
    size_t header_bytes;
} lmb_volume_file_kind;

/* What can be said of a file before anything else in it is trusted.
 * @return LMB_ERROR_FORMAT, _TRUNCATED, _VERSION, _CHECKSUM */
lmb_result lmb_volume_envelope_check(const unsigned char *data, size_t size, const lmb_volume_file_kind *kind);

/* The point that a volume counts its cells from: a corner of a brick of the coarsest level. */
void lmb_volume_origin(const int32_t min[3], uint32_t level_count, int32_t origin[3]);

/* Spacings that a position may be off a box and count as inside: four times the rounding of a float of the size of its
 * farthest coordinate, and never a share of a cell that matters. */
double lmb_volume_slack(const int32_t min[3], const int32_t size[3]);

/* What sampling needs, of a volume that was verified: its cells counted from an origin, which bricks of the coarsest
 * level begin at and no cell of the box is before, nor INT32_MAX cells behind. */
void lmb_volume_derive(lmb_volume *volume, const int32_t origin[3], double slack);

/* Whether the numbers that a volume and an index of tiles share are right: spacing and scale, and key lights. */
bool lmb_volume_scales_are_sane(float spacing, float scale);
bool lmb_volume_key_lights_are_sane(const lmb_key_light light[LMB_KEY_LIGHTS_MOST], uint32_t count);

/* Whether a box is one in the world, and among cells counted from the origin. */
bool lmb_volume_box_is_sane(const int32_t min[3], const int32_t size[3], uint32_t level_count, float spacing);

/* Whether volume->locals, of header->local_bytes, are what lambent/local_set_format.h says: all of it lies within, and
 * is finite. */
bool lmb_volume_locals_are_sane(const lmb_volume *volume);

/* Whether so many halfs are finite. */
bool lmb_volume_halfs_are_finite(const unsigned char *data, size_t count);

/* Maps a regular file for reading. `path` is UTF-8.
 * @return LMB_ERROR_IO, LMB_ERROR_TRUNCATED (empty) */
lmb_result lmb_volume_map(const char *path, void **mapping, size_t *size);
void lmb_volume_unmap(void *mapping, size_t size);

#endif
