#include "texture/block_texture_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "texture/astc.h"
#include "texture/bc4.h"
#include "texture/bc6h.h"

enum { SIDE = 4, TEXELS = SIDE * SIDE, MOST_CHANNELS = 3 };

/* The largest finite half. */
#define MOST_LIGHT 65504.0f

/* The share of a block's largest weight from which a texel counts for astcenc, which knows no weights. */
#define ASTC_COUNTS 0.01f

static const struct {
    const char *name;
    int channels;
    size_t bytes;
} formats[LMB_BLOCK_FORMATS] = {
    [LMB_BLOCK_BC4] = {"BC4_UNORM", 1, BC4_BYTES},       [LMB_BLOCK_BC5] = {"BC5_UNORM", 2, 2 * BC4_BYTES},
    [LMB_BLOCK_BC6H] = {"BC6H_UFLOAT", 3, BC6H_BYTES},   [LMB_BLOCK_ASTC] = {"ASTC_4x4_UNORM", 3, 16},
    [LMB_BLOCK_ASTC_LIGHT] = {"ASTC_4x4_SFLOAT", 3, 16},
};

static bool is_astc(lmb_block_format format)
{
    return format == LMB_BLOCK_ASTC || format == LMB_BLOCK_ASTC_LIGHT;
}

bool lmb_block_format_is_here(lmb_block_format format)
{
    return !is_astc(format) || lmb_astc_is_here();
}

const char *lmb_block_format_name(lmb_block_format format)
{
    return formats[format].name;
}

int lmb_block_format_channels(lmb_block_format format)
{
    return formats[format].channels;
}

size_t lmb_block_format_bytes(lmb_block_format format)
{
    return formats[format].bytes;
}

const char *lmb_block_container_name(lmb_block_container container)
{
    return container == LMB_BLOCK_KTX2 ? "ktx2" : "dds";
}

static int32_t blocks_along(int32_t side, int32_t level)
{
    return (lmb_block_texture_side(side, level) + SIDE - 1) / SIDE;
}

static size_t layer_size(const lmb_block_texture *texture, int32_t level)
{
    return formats[texture->format].bytes * (size_t)blocks_along(texture->width, level) *
           (size_t)blocks_along(texture->height, level);
}

size_t lmb_block_texture_level_size(const lmb_block_texture *texture, int32_t level)
{
    return layer_size(texture, level) * (size_t)texture->layers;
}

size_t lmb_block_texture_level_start(const lmb_block_texture *texture, int32_t level)
{
    size_t start = 0;
    for (int32_t k = 0; k < level; ++k) {
        start += lmb_block_texture_level_size(texture, k);
    }
    return start;
}

lmb_result lmb_block_texture_create(lmb_block_format format, int32_t width, int32_t height, int32_t layers,
                                    int32_t levels, lmb_block_texture *texture)
{
    const int32_t longest = width > height ? width : height;
    if (width < 1 || height < 1 || longest > LMB_BLOCK_MOST_SIDE || layers < 1 || layers > LMB_BLOCK_MOST_LAYERS ||
        levels < 1 || levels > LMB_BLOCK_MOST_LEVELS || longest >> (levels - 1) < 1) {
        return LMB_ERROR_ARGUMENT;
    }
    *texture = (lmb_block_texture){format, width, height, layers, levels, NULL, 0};
    texture->size = lmb_block_texture_level_start(texture, levels);
    texture->data = calloc(texture->size, 1);
    return texture->data ? LMB_OK : LMB_ERROR_MEMORY;
}

void lmb_block_texture_free(lmb_block_texture *texture)
{
    free(texture->data);
    memset(texture, 0, sizeof *texture);
}

/* One level at work: a task is a row of blocks of a layer. */
typedef struct level_work {
    lmb_block_texture *texture;
    int32_t level;
    const lmb_block_pixels *pixels;
} level_work;

/* A block's texels; those beyond the image repeat its last ones, and do not count. */
typedef struct block_texels {
    float value[MOST_CHANNELS][TEXELS];
    float weight[TEXELS];
} block_texels;

static float value_clamped(float value, float most)
{
    return value > 0.0f ? value < most ? value : most : 0.0f; /* NaN is 0 */
}

static void texels_load(const level_work *work, int32_t layer, int32_t column, int32_t row, block_texels *texels)
{
    const int channels = formats[work->texture->format].channels;
    const bool light = work->texture->format == LMB_BLOCK_BC6H || work->texture->format == LMB_BLOCK_ASTC_LIGHT;
    const float most = light ? MOST_LIGHT : 1.0f;
    const int32_t width = lmb_block_texture_side(work->texture->width, work->level);
    const int32_t height = lmb_block_texture_side(work->texture->height, work->level);
    for (int i = 0; i < TEXELS; ++i) {
        const int32_t x = SIDE * column + i % SIDE, y = SIDE * row + i / SIDE;
        const bool inside = x < width && y < height;
        const size_t at = (size_t)(y < height ? y : height - 1) * (size_t)width + (size_t)(x < width ? x : width - 1);
        texels->weight[i] = !inside ? 0.0f : work->pixels->weight ? work->pixels->weight[at] : 1.0f;
        for (int c = 0; c < channels; ++c) {
            texels->value[c][i] = value_clamped(work->pixels->plane[layer * channels + c][at], most);
        }
    }
}

static void block_encode(const level_work *work, const block_texels *texels, unsigned char *bytes)
{
    if (work->texture->format != LMB_BLOCK_BC6H) {
        for (int c = 0; c < formats[work->texture->format].channels; ++c) {
            lmb_bc4_encode(texels->value[c], texels->weight, bytes + c * BC4_BYTES);
        }
        return;
    }
    bc6h_texels light = {.floor = work->pixels->floor};
    for (int i = 0; i < TEXELS; ++i) {
        light.weight[i] = texels->weight[i];
        for (int c = 0; c < 3; ++c) {
            light.colour[i][c] = texels->value[c][i];
        }
    }
    lmb_bc6h_encode(&light, bytes);
}

static void row_task(void *context, size_t task, int worker)
{
    (void)worker;
    const level_work *work = context;
    const lmb_block_texture *texture = work->texture;
    const int32_t rows = blocks_along(texture->height, work->level);
    const int32_t columns = blocks_along(texture->width, work->level);
    const int32_t layer = (int32_t)task / rows, row = (int32_t)task % rows;
    const size_t bytes = formats[texture->format].bytes;
    unsigned char *at = texture->data + lmb_block_texture_level_start(texture, work->level) +
                        (size_t)layer * layer_size(texture, work->level) + (size_t)row * (size_t)columns * bytes;
    for (int32_t column = 0; column < columns; ++column, at += bytes) {
        block_texels texels;
        texels_load(work, layer, column, row, &texels);
        block_encode(work, &texels, at);
    }
}

/* astcenc counts all texels alike: those that hardly count are the mean of the others of their block. */
static void texels_even(block_texels *texels)
{
    float total = 0.0f, sum[MOST_CHANNELS] = {0.0f}, most = 0.0f;
    for (int i = 0; i < TEXELS; ++i) {
        most = texels->weight[i] > most ? texels->weight[i] : most;
        total += texels->weight[i];
        for (int c = 0; c < MOST_CHANNELS; ++c) {
            sum[c] += texels->weight[i] * texels->value[c][i];
        }
    }
    for (int i = 0; i < TEXELS; ++i) {
        for (int c = 0; c < MOST_CHANNELS && texels->weight[i] < ASTC_COUNTS * most; ++c) {
            texels->value[c][i] = sum[c] / total;
        }
    }
}

static lmb_result astc_layer_encode(const level_work *work, int32_t layer, lmb_pool *pool)
{
    const lmb_block_texture *texture = work->texture;
    const int32_t columns = blocks_along(texture->width, work->level),
                  rows = blocks_along(texture->height, work->level);
    astc_image image = {SIDE * columns, SIDE * rows, texture->format == LMB_BLOCK_ASTC_LIGHT, NULL};
    image.rgba = calloc((size_t)(columns * rows) * TEXELS, 4 * sizeof *image.rgba);
    for (int32_t block = 0; block < columns * rows && image.rgba; ++block) {
        block_texels texels;
        texels_load(work, layer, block % columns, block / columns, &texels);
        texels_even(&texels);
        for (int i = 0; i < TEXELS; ++i) {
            const int32_t x = SIDE * (block % columns) + i % SIDE, y = SIDE * (block / columns) + i / SIDE;
            float *const texel = &image.rgba[4 * ((size_t)y * (size_t)image.width + (size_t)x)];
            for (int c = 0; c < MOST_CHANNELS; ++c) {
                texel[c] = texels.value[c][i];
            }
            texel[MOST_CHANNELS] = 1.0f;
        }
    }
    unsigned char *to = texture->data + lmb_block_texture_level_start(texture, work->level) +
                        (size_t)layer * layer_size(texture, work->level);
    const bool good = image.rgba && lmb_astc_encode(&image, pool, to);
    free(image.rgba);
    return good ? LMB_OK : LMB_ERROR_MEMORY;
}

static lmb_result astc_layer_decode(const lmb_block_texture *texture, int32_t level, const unsigned char *from,
                                    float *const *plane)
{
    const int32_t width = lmb_block_texture_side(texture->width, level);
    const int32_t height = lmb_block_texture_side(texture->height, level);
    astc_image image = {width, height, texture->format == LMB_BLOCK_ASTC_LIGHT, NULL};
    const size_t texels = (size_t)width * (size_t)height;
    image.rgba = malloc(texels * 4 * sizeof *image.rgba);
    const bool good = image.rgba && lmb_astc_decode(from, &image);
    for (size_t i = 0; i < texels && good; ++i) {
        for (int c = 0; c < MOST_CHANNELS; ++c) {
            plane[c][i] = value_clamped(image.rgba[4 * i + (size_t)c], MOST_LIGHT);
        }
    }
    free(image.rgba);
    return good ? LMB_OK : LMB_ERROR_MEMORY;
}

lmb_result lmb_block_texture_encode(lmb_block_texture *texture, int32_t level, const lmb_block_pixels *pixels,
                                    lmb_pool *pool)
{
    level_work work = {texture, level, pixels};
    if (!lmb_block_format_is_here(texture->format)) {
        return LMB_ERROR_UNSUPPORTED;
    }
    if (is_astc(texture->format)) {
        lmb_result result = LMB_OK;
        for (int32_t layer = 0; layer < texture->layers && result == LMB_OK; ++layer) {
            result = astc_layer_encode(&work, layer, pool);
        }
        return result;
    }
    const size_t tasks = (size_t)texture->layers * (size_t)blocks_along(texture->height, level);
    if (pool) {
        return lmb_pool_run(pool, tasks, row_task, &work, "textures", NULL);
    }
    for (size_t task = 0; task < tasks; ++task) {
        row_task(&work, task, 0);
    }
    return LMB_OK;
}

static void block_decode(lmb_block_format format, const unsigned char *bytes, float value[MOST_CHANNELS][TEXELS])
{
    if (format != LMB_BLOCK_BC6H) {
        for (int c = 0; c < formats[format].channels; ++c) {
            lmb_bc4_decode(bytes + c * BC4_BYTES, value[c]);
        }
        return;
    }
    float colour[TEXELS][3];
    lmb_bc6h_decode(bytes, colour);
    for (int i = 0; i < TEXELS; ++i) {
        for (int c = 0; c < 3; ++c) {
            value[c][i] = colour[i][c];
        }
    }
}

lmb_result lmb_block_texture_decode(const lmb_block_texture *texture, int32_t level, int32_t layer, float *const *plane)
{
    const int32_t width = lmb_block_texture_side(texture->width, level);
    const int32_t height = lmb_block_texture_side(texture->height, level);
    const int32_t columns = blocks_along(texture->width, level);
    const unsigned char *at =
        texture->data + lmb_block_texture_level_start(texture, level) + (size_t)layer * layer_size(texture, level);
    if (!lmb_block_format_is_here(texture->format)) {
        return LMB_ERROR_UNSUPPORTED;
    }
    if (is_astc(texture->format)) {
        return astc_layer_decode(texture, level, at, plane);
    }
    for (int32_t block = 0; block < columns * blocks_along(texture->height, level); ++block) {
        float value[MOST_CHANNELS][TEXELS];
        block_decode(texture->format, at, value);
        at += formats[texture->format].bytes;
        for (int i = 0; i < TEXELS; ++i) {
            const int32_t x = SIDE * (block % columns) + i % SIDE, y = SIDE * (block / columns) + i / SIDE;
            for (int c = 0; c < formats[texture->format].channels && x < width && y < height; ++c) {
                plane[c][(size_t)y * (size_t)width + (size_t)x] = value[c][i];
            }
        }
    }
    return LMB_OK;
}

lmb_result lmb_block_texture_write(const lmb_block_texture *texture, lmb_block_container container, const char *path,
                                   lmb_error *error)
{
    if (container == LMB_BLOCK_DDS && is_astc(texture->format)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: DDS has no ASTC", path);
    }
    size_t size;
    unsigned char *bytes = container == LMB_BLOCK_KTX2 ? lmb_block_texture_to_ktx2(texture, &size)
                                                       : lmb_block_texture_to_dds(texture, &size);
    const lmb_result result = bytes ? lmb_file_write(path, bytes, size, error)
                                    : lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    free(bytes);
    return result;
}

lmb_result lmb_block_texture_read(const char *path, lmb_block_texture *texture, lmb_block_container *container,
                                  lmb_error *error)
{
    unsigned char *bytes = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(path, &bytes, &size, error);
    if (result != LMB_OK) {
        return result;
    }
    const bool dds = size >= 4 && memcmp(bytes, "DDS ", 4) == 0;
    *container = dds ? LMB_BLOCK_DDS : LMB_BLOCK_KTX2;
    result = dds ? lmb_block_texture_from_dds(bytes, size, path, texture, error)
                 : lmb_block_texture_from_ktx2(bytes, size, path, texture, error);
    free(bytes);
    return result;
}
