/* DDS with the header of Direct3D 10 (Microsoft, "Programming Guide for DDS"): layer by layer, in each the levels,
 * largest first. */
#include "texture/block_texture_internal.h"

#include <stdlib.h>
#include <string.h>

/* The magic number, the header and its extension; what they hold, from the file's start. */
enum {
    HEADER = 4 + 124 + 20,
    AT_SIZE = 4,
    AT_FLAGS = 8,
    AT_HEIGHT = 12,
    AT_WIDTH = 16,
    AT_LINEAR_SIZE = 20,
    AT_LEVELS = 28,
    AT_PIXEL_SIZE = 76,
    AT_PIXEL_FLAGS = 80,
    AT_FOUR_LETTERS = 84,
    AT_CAPS = 108,
    AT_FORMAT = 128,
    AT_DIMENSION = 132,
    AT_MISCELLANEOUS = 136,
    AT_LAYERS = 140
};

enum {
    HAS_CAPS = 0x1,
    HAS_HEIGHT = 0x2,
    HAS_WIDTH = 0x4,
    HAS_PIXELS = 0x1000,
    HAS_LEVELS = 0x20000,
    HAS_LINEAR_SIZE = 0x80000,
    FOUR_LETTERS = 0x4,
    CAPS_COMPLEX = 0x8,
    CAPS_TEXTURE = 0x1000,
    CAPS_LEVELS = 0x400000,
    TWO_DIMENSIONS = 3,
    CUBE = 0x4
};

/* DXGI_FORMAT; 0: it has none. */
static const uint32_t codes[LMB_BLOCK_FORMATS] = {[LMB_BLOCK_BC4] = 80, [LMB_BLOCK_BC5] = 83, [LMB_BLOCK_BC6H] = 95};

static void header_write(const lmb_block_texture *texture, unsigned char *bytes)
{
    const bool levels = texture->levels > 1;
    memcpy(bytes, "DDS ", 4);
    block_put32(bytes + AT_SIZE, 124);
    block_put32(bytes + AT_FLAGS,
                HAS_CAPS | HAS_HEIGHT | HAS_WIDTH | HAS_PIXELS | HAS_LINEAR_SIZE | (levels ? HAS_LEVELS : 0u));
    block_put32(bytes + AT_HEIGHT, (uint32_t)texture->height);
    block_put32(bytes + AT_WIDTH, (uint32_t)texture->width);
    block_put32(bytes + AT_LINEAR_SIZE, (uint32_t)(lmb_block_texture_level_size(texture, 0) / (size_t)texture->layers));
    block_put32(bytes + AT_LEVELS, (uint32_t)texture->levels);
    block_put32(bytes + AT_PIXEL_SIZE, 32);
    block_put32(bytes + AT_PIXEL_FLAGS, FOUR_LETTERS);
    memcpy(bytes + AT_FOUR_LETTERS, "DX10", 4);
    block_put32(bytes + AT_CAPS, CAPS_TEXTURE | (levels ? CAPS_COMPLEX | CAPS_LEVELS : 0u));
    block_put32(bytes + AT_FORMAT, codes[texture->format]);
    block_put32(bytes + AT_DIMENSION, TWO_DIMENSIONS);
    block_put32(bytes + AT_LAYERS, (uint32_t)texture->layers);
}

/* The texels of a layer's level, from the texture's start, and where they lie behind the file's header. */
typedef struct file_part {
    size_t data, file, length;
} file_part;

static file_part part_of(const lmb_block_texture *texture, int32_t layer, int32_t level)
{
    const size_t layers = (size_t)texture->layers;
    const size_t start = lmb_block_texture_level_start(texture, level);
    const size_t length = lmb_block_texture_level_size(texture, level) / layers;
    return (file_part){start + (size_t)layer * length, (size_t)layer * (texture->size / layers) + start / layers,
                       length};
}

unsigned char *lmb_block_texture_to_dds(const lmb_block_texture *texture, size_t *size)
{
    *size = HEADER + texture->size;
    unsigned char *bytes = calloc(*size, 1);
    if (bytes) {
        header_write(texture, bytes);
        for (int32_t i = 0; i < texture->layers * texture->levels; ++i) {
            const file_part part = part_of(texture, i / texture->levels, i % texture->levels);
            memcpy(bytes + HEADER + part.file, texture->data + part.data, part.length);
        }
    }
    return bytes;
}

static bool format_find(uint32_t code, lmb_block_format *format)
{
    for (int i = 0; i < LMB_BLOCK_FORMATS; ++i) {
        if (code > 0 && codes[i] == code) {
            *format = (lmb_block_format)i;
            return true;
        }
    }
    return false;
}

static lmb_result header_read(const unsigned char *bytes, const char *path, lmb_block_texture *texture,
                              lmb_error *error)
{
    lmb_block_format format;
    if (memcmp(bytes + AT_FOUR_LETTERS, "DX10", 4) != 0 || !format_find(block_get32(bytes + AT_FORMAT), &format) ||
        block_get32(bytes + AT_DIMENSION) != TWO_DIMENSIONS || (block_get32(bytes + AT_MISCELLANEOUS) & CUBE)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: not a plain image of BC4, BC5 or BC6H", path);
    }
    const uint32_t width = block_get32(bytes + AT_WIDTH), height = block_get32(bytes + AT_HEIGHT);
    const uint32_t layers = block_get32(bytes + AT_LAYERS), levels = block_get32(bytes + AT_LEVELS);
    if (width > LMB_BLOCK_MOST_SIDE || height > LMB_BLOCK_MOST_SIDE || layers > LMB_BLOCK_MOST_LAYERS ||
        levels > LMB_BLOCK_MOST_LEVELS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: too large", path);
    }
    const lmb_result made = lmb_block_texture_create(format, (int32_t)width, (int32_t)height, (int32_t)layers,
                                                     levels ? (int32_t)levels : 1, texture);
    return made == LMB_OK ? LMB_OK
           : made == LMB_ERROR_MEMORY
               ? lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path)
               : lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no image has these sides and levels", path);
}

lmb_result lmb_block_texture_from_dds(const unsigned char *bytes, size_t size, const char *path,
                                      lmb_block_texture *texture, lmb_error *error)
{
    if (size < HEADER) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cut off, or without the header of Direct3D 10", path);
    }
    const lmb_result result = header_read(bytes, path, texture, error);
    if (result != LMB_OK) {
        return result;
    }
    if (size - HEADER != texture->size) {
        lmb_block_texture_free(texture);
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not as long as its header says", path);
    }
    for (int32_t i = 0; i < texture->layers * texture->levels; ++i) {
        const file_part part = part_of(texture, i / texture->levels, i % texture->levels);
        memcpy(texture->data + part.data, bytes + HEADER + part.file, part.length);
    }
    return LMB_OK;
}
