/* How the 14 modes of BC6H lay out a block of 4x4 texels of colour in 16 bytes, and the arithmetic that every decoder
 * repeats bit by bit (Khronos Data Format Specification 1.3, chapter "BPTC compressed texture image formats").
 *
 * A block is four values for each channel, the ends of one line in colour space or of two lines (subsets), and an index
 * a texel that says where on its line it lies. Most modes store the first value with all bits and the others as signed
 * differences to it. Unsigned halfs alone: light is not negative. */
#ifndef LMB_BC6H_MODES_H
#define LMB_BC6H_MODES_H

#include <stdbool.h>
#include <stdint.h>

enum { BC6H_TEXELS = 16, BC6H_BYTES = 16, BC6H_MODES = 14, BC6H_ENDS = 4, BC6H_PARTITIONS = 32 };

/* A run of bits of one value, from bit `low` upwards. */
typedef struct bc6h_piece {
    uint8_t value; /* 3 * end + channel */
    uint8_t low;
    uint8_t count; /* 0: the last piece was the one before */
} bc6h_piece;

enum { BC6H_MOST_PIECES = 32 };

typedef struct bc6h_mode {
    uint8_t code, code_bits;
    uint8_t subsets;       /* 1, or 2 with a partition */
    bool differences;      /* ends after the first are relative to it */
    uint8_t bits;          /* of the first end */
    uint8_t other_bits[3]; /* of the others, by channel */
    bc6h_piece piece[BC6H_MOST_PIECES];
} bc6h_mode;

extern const bc6h_mode lmb_bc6h_modes[BC6H_MODES];

/* Bit i is the subset of texel i. */
extern const uint16_t lmb_bc6h_partitions[BC6H_PARTITIONS];

/* The texel of the second subset whose index has one bit less; in the first it is texel 0. */
extern const uint8_t lmb_bc6h_anchors[BC6H_PARTITIONS];

/* What a block says, unpacked. */
typedef struct bc6h_block {
    int mode;                  /* of lmb_bc6h_modes */
    int32_t end[BC6H_ENDS][3]; /* as quantised: differences are resolved */
    int partition;             /* of two subsets */
    uint8_t index[BC6H_TEXELS];
} bc6h_block;

/* Ends must fit the mode, and the anchors' indices their bits. */
void lmb_bc6h_modes_pack(const bc6h_block *block, uint8_t bytes[BC6H_BYTES]);

/* False for the codes that the format reserves: such blocks are black. */
bool lmb_bc6h_modes_unpack(const uint8_t bytes[BC6H_BYTES], bc6h_block *block);

/* A quantised end as 16 bits. */
static inline int32_t bc6h_widen(int32_t end, int bits)
{
    if (bits >= 15 || end == 0) {
        return end;
    }
    return end == (1 << bits) - 1 ? 0xFFFF : ((end << 16) + 0x8000) >> bits;
}

/* How far the line's second end counts, in 64ths. */
static inline int32_t bc6h_weight(int subsets, int index)
{
    static const uint8_t eight[8] = {0, 9, 18, 27, 37, 46, 55, 64};
    static const uint8_t sixteen[16] = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};
    return subsets == 1 ? sixteen[index] : eight[index];
}

/* The bits of the half between two widened ends. */
static inline int32_t bc6h_half(int32_t first, int32_t second, int32_t weight)
{
    return (((first * (64 - weight) + second * weight + 32) >> 6) * 31) >> 6;
}

static inline int bc6h_subset(const bc6h_block *block, int texel)
{
    return lmb_bc6h_modes[block->mode].subsets == 1 ? 0 : lmb_bc6h_partitions[block->partition] >> texel & 1;
}

#endif
