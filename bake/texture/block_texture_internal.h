/* What the two kinds of file share. */
#ifndef LMB_BLOCK_TEXTURE_INTERNAL_H
#define LMB_BLOCK_TEXTURE_INTERNAL_H

#include <lambent/block_texture.h>

size_t lmb_block_format_bytes(lmb_block_format format); /* of a block */

/* A whole file in malloc'ed memory; NULL: out of it. */
unsigned char *lmb_block_texture_to_ktx2(const lmb_block_texture *texture, size_t *size);
unsigned char *lmb_block_texture_to_dds(const lmb_block_texture *texture, size_t *size);

/* The inverse, of any bytes. @return LMB_ERROR_FORMAT, _UNSUPPORTED, _MEMORY; messages begin with `path` */
lmb_result lmb_block_texture_from_ktx2(const unsigned char *bytes, size_t size, const char *path,
                                       lmb_block_texture *texture, lmb_error *error);
lmb_result lmb_block_texture_from_dds(const unsigned char *bytes, size_t size, const char *path,
                                      lmb_block_texture *texture, lmb_error *error);

static inline void block_put32(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; ++i) {
        at[i] = (unsigned char)(value >> (8 * i));
    }
}

static inline uint32_t block_get32(const unsigned char *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static inline void block_put64(unsigned char *at, uint64_t value)
{
    block_put32(at, (uint32_t)value);
    block_put32(at + 4, (uint32_t)(value >> 32));
}

static inline uint64_t block_get64(const unsigned char *at)
{
    return (uint64_t)block_get32(at) | (uint64_t)block_get32(at + 4) << 32;
}

#endif
