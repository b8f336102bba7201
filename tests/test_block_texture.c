/* Block-compressed textures: how far decoded texels are from what was encoded, what does not count, the same bytes for
 * any number of threads, and both kinds of file, read back, byte by byte, and broken. test_texture_sampler has them
 * decoded by others. */
#include <stdlib.h>

#include <lambent/block_texture.h>
#include <lambent/file.h>

#include "harness.h"
#include "texture/bc4.h"
#include "texture/bc6h.h"
#include "texture/block_texture_internal.h"
#include "variates.h"

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/" name

static double between(uint64_t *random, double low, double high)
{
    return low + (high - low) * variate_next(random);
}

/* Kinds of light in a block, and the root mean square of its relative error that is allowed: one number repeated, a
 * gradient of one colour, a gradient whose colour turns, a shadow's edge, two colours with an edge between. */
static const struct {
    const char *name;
    double turn, edge, allowed;
} lights[] = {{"constant", 0.0, 1.0, 0.0003},
              {"gradient", 0.1, 1.0, 0.003},
              {"turning", 0.2, 1.0, 0.01},
              {"edge", 0.1, 4.0, 0.018},
              {"deep edge", 0.0, 300.0, 0.012}};
enum { LIGHTS = sizeof lights / sizeof lights[0] };

static void light_make(int kind, uint64_t *random, bc6h_texels *texels)
{
    double base[3], across[3], down[3];
    for (int c = 0; c < 3; ++c) {
        const double turn = kind == 1 || kind == 3 ? 0.0 : lights[kind].turn;
        base[c] = exp(between(random, -6.0, 6.0) * (c == 0) + (c > 0 ? log(base[0]) + between(random, -1.0, 1.0) : 0));
        across[c] = c == 0 ? between(random, -0.5, 0.5) * lights[kind].turn : across[0];
        down[c] = c == 0 ? between(random, -0.5, 0.5) * lights[kind].turn : down[0];
        across[c] += between(random, -0.25, 0.25) * turn;
    }
    const double angle = between(random, 0.0, 6.28), off = between(random, -1.5, 1.5);
    texels->floor = 1e-3f;
    for (int i = 0; i < BC6H_TEXELS; ++i) {
        const int x = i % 4, y = i / 4;
        const bool lit = (x - 1.5) * cos(angle) + (y - 1.5) * sin(angle) > off;
        texels->weight[i] = 1.0f;
        for (int c = 0; c < 3; ++c) {
            texels->colour[i][c] =
                (float)(base[c] * exp(across[c] * x + down[c] * y) / (lit ? 1.0 : lights[kind].edge));
        }
    }
}

/* The sum that the encoder says it has, worked out from what is decoded. */
static double light_error(const bc6h_texels *texels, float decoded[BC6H_TEXELS][3])
{
    double sum = 0.0;
    for (int i = 0; i < BC6H_TEXELS; ++i) {
        const float *colour = texels->colour[i];
        const double largest = (double)fmaxf(fmaxf(colour[0], colour[1]), colour[2]) + (double)texels->floor;
        for (int c = 0; c < 3; ++c) {
            const double off = ((double)decoded[i][c] - (double)colour[c]) / largest;
            sum += (double)texels->weight[i] * off * off;
        }
    }
    return sum;
}

static void light_comes_back(void)
{
    enum { BLOCKS = 4000 };
    int modes[BC6H_MODES] = {0};
    for (int kind = 0; kind < LIGHTS; ++kind) {
        uint64_t random = 11;
        double sum = 0.0;
        for (int k = 0; k < BLOCKS; ++k) {
            bc6h_texels texels;
            uint8_t bytes[BC6H_BYTES];
            float decoded[BC6H_TEXELS][3];
            bc6h_block block;
            light_make(kind, &random, &texels);
            const float said = lmb_bc6h_encode(&texels, bytes);
            lmb_bc6h_decode(bytes, decoded);
            const double error = light_error(&texels, decoded);
            CHECK_NEAR(said, error, 1e-4 * error + 1e-9, "%s, block %d", lights[kind].name, k);
            modes[lmb_bc6h_modes_unpack(bytes, &block) ? block.mode : 0] += 1;
            sum += error;
        }
        const double rms = sqrt(sum / (3.0 * BC6H_TEXELS * BLOCKS));
        CHECK(rms < lights[kind].allowed, "%s: %.5f", lights[kind].name, rms);
    }
    for (int i = 0; i < BC6H_MODES; ++i) {
        CHECK(modes[i] > 0 || i == 1, "mode %d is never chosen", i);
    }
}

/* What the modes hold exactly comes back to the bit: two halfs of 16 bits for black and white, and the largest. */
static void halfs_come_back_exactly(void)
{
    static const float values[] = {0.0f, 1.0f, 0.5f, 65504.0f, 0x1p-14f, 0x1p-24f, 1000.0f};
    for (size_t k = 0; k < sizeof values / sizeof values[0]; ++k) {
        bc6h_texels texels = {.floor = 1e-9f};
        uint8_t bytes[BC6H_BYTES];
        float decoded[BC6H_TEXELS][3];
        for (int i = 0; i < BC6H_TEXELS; ++i) {
            texels.weight[i] = 1.0f;
            texels.colour[i][0] = texels.colour[i][1] = texels.colour[i][2] = values[k];
        }
        lmb_bc6h_encode(&texels, bytes);
        lmb_bc6h_decode(bytes, decoded);
        for (int i = 0; i < BC6H_TEXELS; ++i) {
            CHECK(decoded[i][0] == values[k] && decoded[i][1] == values[k] && decoded[i][2] == values[k],
                  "%g comes back as %g, %g, %g", (double)values[k], (double)decoded[i][0], (double)decoded[i][1],
                  (double)decoded[i][2]);
        }
    }
}

/* Unpacking any bits and packing them again gives those bits: nothing of a block is lost or moved. */
static void blocks_pack_as_they_unpack(void)
{
    uint64_t random = 3;
    for (int k = 0; k < 20000; ++k) {
        uint8_t bytes[BC6H_BYTES], again[BC6H_BYTES];
        bc6h_block block;
        for (int i = 0; i < BC6H_BYTES; ++i) {
            bytes[i] = (uint8_t)(256.0 * variate_next(&random));
        }
        if (lmb_bc6h_modes_unpack(bytes, &block)) {
            lmb_bc6h_modes_pack(&block, again);
            CHECK(memcmp(bytes, again, sizeof bytes) == 0, "block %d, mode %d", k, block.mode);
        }
    }
}

/* Texels of weight 0 change nothing for the others, whatever they hold. */
static void what_does_not_count_costs_nothing(void)
{
    uint64_t random = 7;
    for (int k = 0; k < 500; ++k) {
        bc6h_texels texels;
        uint8_t bytes[BC6H_BYTES], with_rubbish[BC6H_BYTES];
        light_make(1, &random, &texels);
        for (int i = 0; i < BC6H_TEXELS; ++i) {
            texels.weight[i] = i % 4 < 2 ? 1.0f : 0.0f;
        }
        const float clean = lmb_bc6h_encode(&texels, bytes);
        for (int i = 0; i < BC6H_TEXELS; ++i) {
            for (int c = 0; c < 3 && i % 4 >= 2; ++c) {
                texels.colour[i][c] = (float)between(&random, 0.0, 60000.0);
            }
        }
        const float dirty = lmb_bc6h_encode(&texels, with_rubbish);
        CHECK_NEAR(dirty, clean, 0.3f * clean + 1e-7f, "block %d", k);
    }
}

static void numbers_come_back(void)
{
    /* Values from `low` to `high`: the error allowed is a share of what eight even steps leave at most, half a step,
     * and the rounding of ends to 255ths. */
    static const double ranges[][2] = {{0.0, 1.0}, {0.3, 0.35}, {0.5, 0.5}, {0.0, 0.0}, {1.0, 1.0}, {0.9, 1.0}};
    uint64_t random = 2;
    for (size_t r = 0; r < sizeof ranges / sizeof ranges[0]; ++r) {
        const double low = ranges[r][0], high = ranges[r][1];
        for (int k = 0; k < 2000; ++k) {
            float value[BC4_TEXELS], weight[BC4_TEXELS], decoded[BC4_TEXELS];
            uint8_t bytes[BC4_BYTES];
            for (int i = 0; i < BC4_TEXELS; ++i) {
                value[i] = (float)between(&random, low, high);
                weight[i] = 1.0f;
            }
            const float said = lmb_bc4_encode(value, weight, bytes);
            lmb_bc4_decode(bytes, decoded);
            double sum = 0.0;
            for (int i = 0; i < BC4_TEXELS; ++i) {
                const double off = (double)decoded[i] - (double)value[i];
                sum += off * off;
            }
            CHECK_NEAR(said, sum, 1e-4 * sum + 1e-9, "[%g, %g], block %d", low, high, k);
            const double step = (high - low) / 7.0, rms = sqrt(sum / BC4_TEXELS);
            CHECK(rms <= 0.5 * step + 0.5 / 255.0, "[%g, %g], block %d: %g", low, high, k, rms);
        }
    }
}

/* 0 and 1 beside a narrow range are exact: the block of six steps has them apart. */
static void extremes_are_exact(void)
{
    const float value[BC4_TEXELS] = {0, 1, 0, 1, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 1, 1};
    float weight[BC4_TEXELS], decoded[BC4_TEXELS];
    uint8_t bytes[BC4_BYTES];
    for (int i = 0; i < BC4_TEXELS; ++i) {
        weight[i] = 1.0f;
    }
    lmb_bc4_encode(value, weight, bytes);
    lmb_bc4_decode(bytes, decoded);
    for (int i = 0; i < BC4_TEXELS; ++i) {
        CHECK_NEAR(decoded[i], value[i], 0.51 / 255.0, "texel %d", i);
    }
}

/* ASTC comes last, and is there where astcenc was. */
static int formats_here(void)
{
    return lmb_block_format_is_here(LMB_BLOCK_ASTC) ? LMB_BLOCK_FORMATS : LMB_BLOCK_ASTC;
}

enum { WIDTH = 100, HEIGHT = 52, LAYERS = 2, LEVELS = 4, MOST = WIDTH * HEIGHT };

/* A texture of light that varies in all directions, each level by itself. */
static bool texture_make(lmb_block_format format, lmb_pool *pool, lmb_block_texture *texture)
{
    static float values[6][MOST];
    const float *planes[6];
    const bool made = lmb_block_texture_create(format, WIDTH, HEIGHT, LAYERS, LEVELS, texture) == LMB_OK;
    CHECK(made, "memory");
    for (int32_t level = 0; level < LEVELS && made; ++level) {
        const int32_t width = lmb_block_texture_side(WIDTH, level);
        for (int p = 0; p < 6; ++p) {
            planes[p] = values[p];
            for (int32_t i = 0; i < width * lmb_block_texture_side(HEIGHT, level); ++i) {
                const double x = (double)(i % width) / width, y = (double)(i / width) / width;
                values[p][i] = (float)(0.5 + 0.4 * sin(9.0 * x + p) * cos(7.0 * y + level));
            }
        }
        const lmb_block_pixels pixels = {.plane = planes, .floor = 0.01f};
        CHECK(lmb_block_texture_encode(texture, level, &pixels, pool) == LMB_OK, "level %d", level);
    }
    return made;
}

static void threads_make_no_difference(void)
{
    for (int format = 0; format < formats_here(); ++format) {
        lmb_block_texture alone, shared;
        lmb_pool *pool;
        CHECK(lmb_pool_create(5, &pool) == LMB_OK, "pool");
        if (texture_make((lmb_block_format)format, NULL, &alone) &&
            texture_make((lmb_block_format)format, pool, &shared)) {
            CHECK(memcmp(alone.data, shared.data, alone.size) == 0, "%s",
                  lmb_block_format_name((lmb_block_format)format));
            lmb_block_texture_free(&shared);
            lmb_block_texture_free(&alone);
        }
        lmb_pool_destroy(pool);
    }
}

static void sizes_are_checked(void)
{
    static const int32_t bad[][4] = {{0, 4, 1, 1}, {4, -1, 1, 1},    {4, 4, 0, 1},   {4, 4, 1, 0},
                                     {4, 4, 1, 4}, {20000, 4, 1, 1}, {4, 4, 9999, 1}};
    lmb_block_texture texture;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        CHECK(lmb_block_texture_create(LMB_BLOCK_BC4, bad[i][0], bad[i][1], bad[i][2], bad[i][3], &texture) ==
                  LMB_ERROR_ARGUMENT,
              "%d x %d, %d layers, %d levels", bad[i][0], bad[i][1], bad[i][2], bad[i][3]);
    }
    CHECK(lmb_block_texture_create(LMB_BLOCK_BC6H, 10, 6, 1, 4, &texture) == LMB_OK, "levels down to one texel");
    /* 3 x 2 blocks of 10 x 6 texels; 2 x 1 of 5 x 3; 1 of 2 x 1; 1 of 1 x 1 */
    CHECK(texture.size == 16 * (6 + 2 + 1 + 1), "%zu bytes", texture.size);
    lmb_block_texture_free(&texture);
}

static const char *path_of(lmb_block_container container)
{
    return container == LMB_BLOCK_KTX2 ? OUTPUT("block.ktx2") : OUTPUT("block.dds");
}

static void files_read_back(void)
{
    lmb_error error = {""};
    for (int i = 0; i < 2 * formats_here(); ++i) {
        const lmb_block_container container = (lmb_block_container)(i % 2);
        if (container == LMB_BLOCK_DDS && i / 2 >= LMB_BLOCK_ASTC) {
            continue; /* DDS has none */
        }
        lmb_block_texture written, read;
        lmb_block_container found;
        if (!texture_make((lmb_block_format)(i / 2), NULL, &written)) {
            return;
        }
        CHECK(lmb_block_texture_write(&written, container, path_of(container), &error) == LMB_OK, "%s", error.message);
        const lmb_result result = lmb_block_texture_read(path_of(container), &read, &found, &error);
        CHECK(result == LMB_OK, "%s", error.message);
        if (result == LMB_OK) {
            CHECK(found == container && read.format == written.format && read.width == WIDTH && read.height == HEIGHT &&
                      read.layers == LAYERS && read.levels == LEVELS,
                  "%s: %s of %d x %d", path_of(container), lmb_block_format_name(read.format), read.width, read.height);
            CHECK(read.size == written.size && memcmp(read.data, written.data, read.size) == 0, "%s",
                  path_of(container));
            lmb_block_texture_free(&read);
        }
        lmb_block_texture_free(&written);
    }
}

static uint64_t number_at(const unsigned char *bytes, size_t at, int count)
{
    uint64_t number = 0;
    for (int i = 0; i < count; ++i) {
        number |= (uint64_t)bytes[at + (size_t)i] << (8 * i);
    }
    return number;
}

/* The fields of a KTX2 file by the numbers of its specification, and the rules that the Khronos validator asks for:
 * levels stored smallest first, each at a multiple of its block, none overlapping. */
static void ktx2_is_as_specified(void)
{
    static const struct {
        uint64_t vulkan, model, samples, bytes;
    } expected[LMB_BLOCK_FORMATS] = {
        {139, 131, 1, 8}, {141, 132, 2, 16}, {143, 133, 1, 16}, {157, 162, 1, 16}, {1000066000, 162, 1, 16}};
    lmb_error error = {""};
    for (int f = 0; f < formats_here(); ++f) {
        lmb_block_texture texture;
        unsigned char *bytes = NULL;
        size_t size = 0;
        if (!texture_make((lmb_block_format)f, NULL, &texture) ||
            lmb_block_texture_write(&texture, LMB_BLOCK_KTX2, OUTPUT("spec.ktx2"), &error) != LMB_OK ||
            lmb_file_read(OUTPUT("spec.ktx2"), &bytes, &size, &error) != LMB_OK) {
            CHECK(false, "%s", error.message);
            return;
        }
        CHECK(memcmp(bytes, "\xABKTX 20\xBB\r\n\x1A\n", 12) == 0, "identifier");
        const uint64_t fields[] = {expected[f].vulkan, 1, WIDTH, HEIGHT, 0, LAYERS, 1, LEVELS, 0};
        for (size_t i = 0; i < sizeof fields / sizeof fields[0]; ++i) {
            CHECK(number_at(bytes, 12 + 4 * i, 4) == fields[i], "header field %zu is %llu", i,
                  (unsigned long long)number_at(bytes, 12 + 4 * i, 4));
        }
        const size_t dfd = number_at(bytes, 48, 4), words = number_at(bytes, 56, 4);
        CHECK(dfd == 80 + 24 * LEVELS && number_at(bytes, 52, 4) == 28 + 16 * expected[f].samples, "descriptor");
        CHECK(number_at(bytes, dfd, 4) == number_at(bytes, 52, 4) && number_at(bytes, dfd + 8, 2) == 2 &&
                  number_at(bytes, dfd + 10, 2) == 24 + 16 * expected[f].samples,
              "descriptor's sizes");
        CHECK(bytes[dfd + 12] == expected[f].model && bytes[dfd + 13] == 1 && bytes[dfd + 14] == 1 &&
                  number_at(bytes, dfd + 16, 4) == 0x0303 && bytes[dfd + 20] == expected[f].bytes,
              "descriptor's contents");
        CHECK(words == dfd + number_at(bytes, 52, 4) && words % 4 == 0 &&
                  memcmp(bytes + words + 4, "KTXorientation\0rd", 17) == 0,
              "words");
        uint64_t end = words + number_at(bytes, 60, 4);
        for (int level = LEVELS - 1; level >= 0; --level) {
            const uint64_t start = number_at(bytes, 80 + 24 * (size_t)level, 8);
            const uint64_t length = number_at(bytes, 80 + 24 * (size_t)level + 8, 8);
            CHECK(start % expected[f].bytes == 0 && start >= end && start < end + expected[f].bytes, "level %d", level);
            CHECK(length == lmb_block_texture_level_size(&texture, level) &&
                      length == number_at(bytes, 80 + 24 * (size_t)level + 16, 8),
                  "level %d", level);
            end = start + length;
        }
        CHECK(end == size, "%zu bytes", size);
        free(bytes);
        lmb_block_texture_free(&texture);
    }
}

static lmb_result parse(lmb_block_container container, const unsigned char *bytes, size_t size,
                        lmb_block_texture *texture, lmb_error *error)
{
    return container == LMB_BLOCK_KTX2 ? lmb_block_texture_from_ktx2(bytes, size, "file", texture, error)
                                       : lmb_block_texture_from_dds(bytes, size, "file", texture, error);
}

/* A buffer that ends where the file does, so that reading on is a fault under the sanitizers. */
static void truncations_are_refused(lmb_block_container container, const unsigned char *bytes, size_t size)
{
    lmb_error error = {""};
    lmb_block_texture read;
    for (size_t length = 0; length < size; length += length < 400 ? 1 : 17) {
        unsigned char *part = malloc(length + 1);
        CHECK(part, "memory");
        if (part) {
            memcpy(part + 1, bytes, length);
            CHECK(parse(container, part + 1, length, &read, &error) != LMB_OK, "%zu of %zu bytes", length, size);
        }
        free(part);
    }
}

/* Every truncation, and every bit of the header changed, is refused or read without a fault; nothing is left behind. */
static void broken_files_are_refused(void)
{
    lmb_error error = {""};
    for (int k = 0; k < 2; ++k) {
        const lmb_block_container container = (lmb_block_container)k;
        lmb_block_texture texture, read;
        lmb_block_container found;
        if (!texture_make(LMB_BLOCK_BC4, NULL, &texture)) {
            return;
        }
        size_t size = 0;
        unsigned char *bytes = container == LMB_BLOCK_KTX2 ? lmb_block_texture_to_ktx2(&texture, &size)
                                                           : lmb_block_texture_to_dds(&texture, &size);
        CHECK(bytes, "memory");
        truncations_are_refused(container, bytes, bytes ? size : 0);
        for (size_t bit = 0; bit < 8 * 200 && bytes; ++bit) {
            bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
            if (parse(container, bytes, size, &read, &error) == LMB_OK) {
                lmb_block_texture_free(&read);
            }
            bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
        }
        CHECK(lmb_block_texture_read(OUTPUT("nowhere"), &read, &found, &error) == LMB_ERROR_IO, "no file");
        free(bytes);
        lmb_block_texture_free(&texture);
    }
}

static const test_case cases[] = {
    {"light_comes_back", light_comes_back},
    {"halfs_come_back_exactly", halfs_come_back_exactly},
    {"blocks_pack_as_they_unpack", blocks_pack_as_they_unpack},
    {"what_does_not_count_costs_nothing", what_does_not_count_costs_nothing},
    {"numbers_come_back", numbers_come_back},
    {"extremes_are_exact", extremes_are_exact},
    {"threads_make_no_difference", threads_make_no_difference},
    {"sizes_are_checked", sizes_are_checked},
    {"files_read_back", files_read_back},
    {"ktx2_is_as_specified", ktx2_is_as_specified},
    {"broken_files_are_refused", broken_files_are_refused},
};

TEST_MAIN(cases)
