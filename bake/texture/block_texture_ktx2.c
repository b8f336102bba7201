/* KTX 2.0 (Khronos, KTX File Format Specification): a header, where each level lies, a description of the texels, some
 * words for people, then the levels, smallest first. */
#include "texture/block_texture_internal.h"

#include <stdlib.h>
#include <string.h>

enum {
    IDENTIFIER = 12,
    HEADER = 80,      /* with the identifier and the index of what follows */
    LEVEL_ENTRY = 24, /* offset, length, length before supercompression */
    DESCRIPTOR = 28,  /* total size, then the basic block without samples */
    SAMPLE = 16
};

/* Where the fields of the header lie. */
enum {
    AT_FORMAT = 12,
    AT_TYPE_SIZE = 16,
    AT_WIDTH = 20,
    AT_HEIGHT = 24,
    AT_DEPTH = 28,
    AT_LAYERS = 32,
    AT_FACES = 36,
    AT_LEVELS = 40,
    AT_SUPERCOMPRESSION = 44,
    AT_DESCRIPTOR = 48,
    AT_WORDS = 56
};

static const unsigned char identifier[IDENTIFIER] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};

/* Key and value, each with its NUL, sorted by key. Row 0 is the top, v = 0, as textures of glTF are. */
static const char words[] = "KTXorientation\0rd\0KTXwriter\0Lambent";
enum { FIRST_WORD = 18, SECOND_WORD = 18 };

static const struct {
    uint32_t vulkan; /* VkFormat */
    uint32_t model;  /* of the data format descriptor */
    uint32_t samples;
    uint32_t sample_type;  /* of the first: float, signed, or neither */
    uint32_t lower, upper; /* what the ends of the range mean */
} formats[LMB_BLOCK_FORMATS] = {
    [LMB_BLOCK_BC4] = {139, 131, 1, 0x00, 0, 0xFFFFFFFFu},
    [LMB_BLOCK_BC5] = {141, 132, 2, 0x00, 0, 0xFFFFFFFFu},
    [LMB_BLOCK_BC6H] = {143, 133, 1, 0x80, 0, 0x3F800000u},
    [LMB_BLOCK_ASTC] = {157, 162, 1, 0x00, 0, 0xFFFFFFFFu},
    [LMB_BLOCK_ASTC_LIGHT] = {1000066000, 162, 1, 0xC0, 0xBF800000u, 0x3F800000u},
};

/* The basic descriptor block (Khronos Data Format Specification 1.3): linear light, Rec. 709 primaries. */
static uint32_t descriptor_write(lmb_block_format format, unsigned char *at)
{
    enum { PRIMARIES_BT709 = 1, TRANSFER_LINEAR = 1, VERSION = 2 };
    const uint32_t samples = formats[format].samples, total = DESCRIPTOR + SAMPLE * samples;
    const uint32_t bits = (uint32_t)(8 * lmb_block_format_bytes(format)) / samples;
    block_put32(at, total);
    block_put32(at + 4, 0);
    block_put32(at + 8, VERSION | (total - 4) << 16);
    block_put32(at + 12, formats[format].model | PRIMARIES_BT709 << 8 | TRANSFER_LINEAR << 16);
    block_put32(at + 16, 3 | 3 << 8); /* blocks of 4 x 4 */
    block_put32(at + 20, (uint32_t)lmb_block_format_bytes(format));
    block_put32(at + 24, 0);
    for (uint32_t i = 0; i < samples; ++i) {
        unsigned char *sample = at + DESCRIPTOR + SAMPLE * i;
        block_put32(sample, i * bits | (bits - 1) << 16 | (i | formats[format].sample_type) << 24);
        block_put32(sample + 4, 0);
        block_put32(sample + 8, formats[format].lower);
        block_put32(sample + 12, formats[format].upper);
    }
    return total;
}

/* Each with its length before it, padded to 4. */
static uint32_t words_write(unsigned char *at)
{
    unsigned char *const start = at;
    const uint32_t length[2] = {FIRST_WORD, SECOND_WORD};
    const char *from = words;
    for (int i = 0; i < 2; ++i) {
        block_put32(at, length[i]);
        memcpy(at + 4, from, length[i]);
        from += length[i];
        at += 4 + (length[i] + 3) / 4 * 4;
    }
    return (uint32_t)(at - start);
}

static size_t aligned(size_t offset, size_t to)
{
    return (offset + to - 1) / to * to;
}

static void header_write(const lmb_block_texture *texture, unsigned char *bytes)
{
    memcpy(bytes, identifier, IDENTIFIER);
    block_put32(bytes + AT_FORMAT, formats[texture->format].vulkan);
    block_put32(bytes + AT_TYPE_SIZE, 1);
    block_put32(bytes + AT_WIDTH, (uint32_t)texture->width);
    block_put32(bytes + AT_HEIGHT, (uint32_t)texture->height);
    block_put32(bytes + AT_LAYERS, texture->layers > 1 ? (uint32_t)texture->layers : 0);
    block_put32(bytes + AT_FACES, 1);
    block_put32(bytes + AT_LEVELS, (uint32_t)texture->levels);
}

unsigned char *lmb_block_texture_to_ktx2(const lmb_block_texture *texture, size_t *size)
{
    enum { MOST_BEFORE = 1024 };
    _Static_assert(sizeof words == FIRST_WORD + SECOND_WORD, "lengths of the words");
    const size_t block = lmb_block_format_bytes(texture->format);
    unsigned char *bytes = calloc(MOST_BEFORE + texture->size + block * (size_t)texture->levels, 1);
    if (!bytes) {
        return NULL;
    }
    size_t at = HEADER + LEVEL_ENTRY * (size_t)texture->levels;
    header_write(texture, bytes);
    block_put32(bytes + AT_DESCRIPTOR, (uint32_t)at);
    const uint32_t described = descriptor_write(texture->format, bytes + at);
    block_put32(bytes + AT_DESCRIPTOR + 4, described);
    at += described;
    block_put32(bytes + AT_WORDS, (uint32_t)at);
    const uint32_t said = words_write(bytes + at);
    block_put32(bytes + AT_WORDS + 4, said);
    at += said;
    for (int32_t level = texture->levels - 1; level >= 0; --level) {
        const size_t length = lmb_block_texture_level_size(texture, level);
        unsigned char *entry = bytes + HEADER + LEVEL_ENTRY * (size_t)level;
        at = aligned(at, block);
        block_put64(entry, at);
        block_put64(entry + 8, length);
        block_put64(entry + 16, length);
        memcpy(bytes + at, texture->data + lmb_block_texture_level_start(texture, level), length);
        at += length;
    }
    *size = at;
    return bytes;
}

static bool format_find(uint32_t vulkan, lmb_block_format *format)
{
    for (int i = 0; i < LMB_BLOCK_FORMATS; ++i) {
        if (formats[i].vulkan == vulkan) {
            *format = (lmb_block_format)i;
            return true;
        }
    }
    return false;
}

/* Makes the texture that a header speaks of, without its texels. */
static lmb_result header_read(const unsigned char *bytes, const char *path, lmb_block_texture *texture,
                              lmb_error *error)
{
    lmb_block_format format;
    if (!format_find(block_get32(bytes + AT_FORMAT), &format) || block_get32(bytes + AT_SUPERCOMPRESSION) != 0 ||
        block_get32(bytes + AT_DEPTH) != 0 || block_get32(bytes + AT_FACES) != 1) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: not a plain image of BC4, BC5, BC6H or ASTC of 4x4",
                             path);
    }
    const uint32_t width = block_get32(bytes + AT_WIDTH), height = block_get32(bytes + AT_HEIGHT);
    const uint32_t layers = block_get32(bytes + AT_LAYERS), levels = block_get32(bytes + AT_LEVELS);
    if (width > LMB_BLOCK_MOST_SIDE || height > LMB_BLOCK_MOST_SIDE || layers > LMB_BLOCK_MOST_LAYERS ||
        levels > LMB_BLOCK_MOST_LEVELS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: too large", path);
    }
    const lmb_result made = lmb_block_texture_create(
        format, (int32_t)width, (int32_t)height, layers ? (int32_t)layers : 1, levels ? (int32_t)levels : 1, texture);
    return made == LMB_OK ? LMB_OK
           : made == LMB_ERROR_MEMORY
               ? lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path)
               : lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no image has these sides and levels", path);
}

lmb_result lmb_block_texture_from_ktx2(const unsigned char *bytes, size_t size, const char *path,
                                       lmb_block_texture *texture, lmb_error *error)
{
    if (size < HEADER || memcmp(bytes, identifier, IDENTIFIER) != 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a KTX2 file", path);
    }
    const lmb_result result = header_read(bytes, path, texture, error);
    if (result != LMB_OK) {
        return result;
    }
    bool good = size >= HEADER + LEVEL_ENTRY * (size_t)texture->levels;
    for (int32_t level = 0; level < texture->levels && good; ++level) {
        const unsigned char *entry = bytes + HEADER + LEVEL_ENTRY * (size_t)level;
        const uint64_t start = block_get64(entry), length = block_get64(entry + 8);
        good = length == lmb_block_texture_level_size(texture, level) && start <= size && length <= size - start;
        if (good) {
            memcpy(texture->data + lmb_block_texture_level_start(texture, level), bytes + start, (size_t)length);
        }
    }
    if (!good) {
        lmb_block_texture_free(texture);
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cut off, or its levels have other sizes", path);
    }
    return LMB_OK;
}
