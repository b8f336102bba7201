#include "lightmap/lightmap_textures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/half_scale.h>

#include "texture/mip_level.h"

/* How much a texel beside the surface counts in a block, which filtering reads less of than of those on it; and one
 * that lies farther off, which it never reads. */
#define BESIDE_WEIGHT 0.25f
#define FAR_WEIGHT 0x1p-10f

/* How much it counts in a mip level: where there is nothing else. */
#define DILATED_COVERAGE 0x1p-10f

/* Errors of light are relative to it, or to this share of the image's mean, as `lambent check` has it. */
#define DARK_SHARE 0.01

static lmb_result out_of_memory(lmb_error *error)
{
    return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for the lightmap's textures");
}

static bool part_fits(const lmb_model *model, const lmb_model_part *part, int first)
{
    return first + part->count <= model->light_count ? part->count % 3 == 0
                                                     : first >= model->light_count && part->low < part->high;
}

bool lmb_lightmap_textures_are_here(lmb_lightmap_format format)
{
    return format != LMB_LIGHTMAP_KTX2_ASTC || lmb_block_format_is_here(LMB_BLOCK_ASTC);
}

/* Light is RGB; one or two numbers are a texture, and more are as many layers. */
static lmb_block_format part_format(const lmb_texture_part *part, lmb_lightmap_format format)
{
    if (format == LMB_LIGHTMAP_KTX2_ASTC) {
        return part->light ? LMB_BLOCK_ASTC_LIGHT : LMB_BLOCK_ASTC;
    }
    return part->light ? LMB_BLOCK_BC6H : part->count == 2 && part->name ? LMB_BLOCK_BC5 : LMB_BLOCK_BC4;
}

static void part_complete(lmb_texture_part *part, lmb_lightmap_format format)
{
    part->format = part_format(part, format);
    const int channels = lmb_block_format_channels(part->format);
    part->layers = (part->count + channels - 1) / channels;
}

bool lmb_lightmap_textures_hold(const lmb_model *model)
{
    bool fit = (model->uses & LMB_MODEL_FOR_TEXTURE) != 0;
    int first = 0, count = 0;
    for (const lmb_model_part *part = model->part; fit && part->count > 0; first += part->count, ++part, ++count) {
        fit = part_fits(model, part, first) && count < LMB_TEXTURE_MOST_PARTS;
    }
    return fit;
}

/* Adds a model's part to the last of ASTC's, or as one by itself. Returns how many there are then. */
static int part_add(const lmb_model_part *from, int first, bool light, bool joined, lmb_texture_part *parts, int count)
{
    if (!joined) {
        parts[count++] = (lmb_texture_part){.name = from->name, .first = first, .light = light};
    }
    lmb_texture_part *const part = &parts[count - 1];
    for (int i = 0; i < from->count; ++i, ++part->count) {
        part->low[part->count] = light ? 0.0f : from->low;
        part->high[part->count] = light ? 1.0f : from->high;
    }
    return count;
}

int lmb_lightmap_textures_parts(const lmb_model *model, lmb_lightmap_format format,
                                lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS])
{
    int first = 0, count = 0;
    for (const lmb_model_part *part = model->part; part->count > 0; first += part->count, ++part) {
        const bool light = first < model->light_count;
        const bool joined = format == LMB_LIGHTMAP_KTX2_ASTC && count > 0 && !light && !parts[count - 1].light;
        count = part_add(part, first, light, joined, parts, count);
        if (joined) {
            parts[count - 1].name = "rest";
        }
    }
    for (int i = 0; i < count; ++i) {
        part_complete(&parts[i], format);
    }
    return count;
}

lmb_texture_part lmb_lightmap_textures_keys(const lmb_lightmap *lightmap)
{
    lmb_texture_part part = {.first = lightmap->model->channel_count, .count = (int)lightmap->key_light_count};
    for (int i = 0; i < part.count; ++i) {
        part.high[i] = 1.0f;
    }
    part_complete(&part, lightmap->settings.format);
    return part;
}

static lmb_block_container container_of(const lmb_lightmap *lightmap)
{
    return lightmap->settings.format == LMB_LIGHTMAP_DDS ? LMB_BLOCK_DDS : LMB_BLOCK_KTX2;
}

void lmb_lightmap_textures_name(const lmb_lightmap *lightmap, const lmb_model *model, const lmb_texture_part *part,
                                int32_t image, char name[LMB_LIGHTMAP_FILE_NAME])
{
    const char *extension = lmb_block_container_name(container_of(lightmap));
    if (!part->name) {
        snprintf(name, LMB_LIGHTMAP_FILE_NAME, "lightmap_%d_" LMB_LIGHTMAP_KEYS_KIND ".%s", (int)image, extension);
    } else if (part->first == 0 && model->irradiance_first && model == lightmap->model) {
        snprintf(name, LMB_LIGHTMAP_FILE_NAME, "lightmap_%d.%s", (int)image, extension);
    } else {
        snprintf(name, LMB_LIGHTMAP_FILE_NAME, "lightmap_%d_%s_%s.%s", (int)image, lmb_lightmap_kind(model), part->name,
                 extension);
    }
}

void lmb_lightmap_textures_picture(const lmb_lightmap *lightmap, int32_t image, char name[LMB_LIGHTMAP_FILE_NAME])
{
    if (lightmap->settings.format == LMB_LIGHTMAP_EXR) {
        lmb_lightmap_file_name(image, NULL, name);
        return;
    }
    lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS];
    lmb_lightmap_textures_parts(lightmap->model, lightmap->settings.format, parts);
    lmb_lightmap_textures_name(lightmap, lightmap->model, &parts[0], image, name);
}

void lmb_lightmap_textures_keys_name(const lmb_lightmap *lightmap, int32_t image, char name[LMB_LIGHTMAP_FILE_NAME])
{
    if (lightmap->settings.format == LMB_LIGHTMAP_EXR) {
        lmb_lightmap_file_name(image, LMB_LIGHTMAP_KEYS_KIND, name);
        return;
    }
    const lmb_texture_part part = lmb_lightmap_textures_keys(lightmap);
    lmb_lightmap_textures_name(lightmap, lightmap->model, &part, image, name);
}

/* Along a side: a level's texels, each s = side / (side >> level) long, are read up to s from a surface and made of
 * what is up to 1.5 s from it, less half a texel; that must be its padding. */
static bool level_is_apart(int32_t side, int32_t level, int32_t padding)
{
    const int64_t texels = side >> level;
    return texels >= 4 && 3 * (int64_t)side <= (2 * (int64_t)padding + 1) * texels;
}

int32_t lmb_lightmap_textures_levels(const lmb_lightmap *lightmap, int32_t image)
{
    const lmb_lightmap_image *of = &lightmap->image[image];
    int32_t levels = 1;
    while (level_is_apart(of->width, levels, lightmap->settings.padding) &&
           level_is_apart(of->height, levels, lightmap->settings.padding)) {
        ++levels;
    }
    return levels;
}

float lmb_lightmap_textures_scale(const lmb_lightmap_image *image, const float *plane, const lmb_texture_part *part)
{
    const size_t texels = (size_t)image->width * (size_t)image->height;
    const float *light = plane + (size_t)part->first * texels;
    float brightest = 0.0f;
    for (size_t i = 0; part->light && i < texels * (size_t)part->count; ++i) {
        brightest = fmaxf(brightest, fabsf(light[i]));
    }
    return lmb_half_scale(brightest);
}

/* The first level of a part, as textures store it: channels that fill its last layer are 0. */
static bool level_load(const lmb_lightmap_image *image, const float *plane, const lmb_texture_part *part, float scale,
                       mip_level *level)
{
    const int planes = part->layers * lmb_block_format_channels(part->format);
    if (!lmb_mip_level_create(image->width, image->height, planes, level)) {
        return false;
    }
    const size_t texels = mip_level_texels(level);
    for (int c = 0; c < part->count; ++c) {
        const float stretch = 1.0f / (part->light ? scale : part->high[c] - part->low[c]);
        const float *from = plane + (size_t)(part->first + c) * texels;
        for (size_t i = 0; i < texels; ++i) {
            level->value[(size_t)c * texels + i] = (from[i] - part->low[c]) * stretch;
        }
    }
    for (size_t i = 0; i < texels; ++i) {
        level->coverage[i] = image->state[i] == LMB_TEXEL_GATHERED  ? 1.0f
                             : image->state[i] == LMB_TEXEL_DILATED ? DILATED_COVERAGE
                                                                    : 0.0f;
    }
    return true;
}

/* Of the texels that are covered. */
static float level_mean(const mip_level *level)
{
    const size_t texels = mip_level_texels(level);
    double sum = 0.0, total = 0.0;
    for (size_t i = 0; i < texels; ++i) {
        for (int p = 0; p < level->planes; ++p) {
            sum += (double)level->coverage[i] * (double)level->value[(size_t)p * texels + i];
            total += (double)level->coverage[i];
        }
    }
    return total > 0.0 ? (float)(sum / total) : 0.0f;
}

/* The largest coverage of a texel and the eight around it. */
static float coverage_around(const mip_level *level, int32_t x, int32_t y)
{
    float largest = 0.0f;
    for (int k = 0; k < 9; ++k) {
        const int32_t column = x + k % 3 - 1, row = y + k / 3 - 1;
        if (column >= 0 && row >= 0 && column < level->width && row < level->height) {
            largest = fmaxf(largest, level->coverage[(size_t)row * (size_t)level->width + (size_t)column]);
        }
    }
    return largest;
}

static float texel_weight(const mip_level *level, int32_t x, int32_t y)
{
    const float coverage = level->coverage[(size_t)y * (size_t)level->width + (size_t)x];
    return coverage > 0.0f ? fmaxf(coverage, BESIDE_WEIGHT * coverage_around(level, x, y)) : 0.0f;
}

static bool level_encode(const mip_level *level, int32_t number, float floor, lmb_pool *pool,
                         lmb_block_texture *texture)
{
    const float *plane[LMB_MODEL_MOST_CHANNELS + 2];
    lmb_result result = LMB_ERROR_MEMORY;
    const size_t texels = mip_level_texels(level);
    float *const weight = malloc(texels * sizeof *weight);
    for (int p = 0; p < level->planes; ++p) {
        plane[p] = level->value + (size_t)p * texels;
    }
    for (size_t i = 0; weight && i < texels; ++i) {
        weight[i] = texel_weight(level, (int32_t)(i % (size_t)level->width), (int32_t)(i / (size_t)level->width));
    }
    if (weight) {
        const lmb_block_pixels pixels = {.plane = plane, .weight = weight, .floor = floor};
        result = lmb_block_texture_encode(texture, number, &pixels, pool);
    }
    free(weight);
    return result == LMB_OK;
}

static bool levels_encode(const mip_level *image, lmb_pool *pool, lmb_block_texture *texture)
{
    const float floor = fmaxf((float)(DARK_SHARE * (double)level_mean(image)), 0x1p-24f);
    bool good = level_encode(image, 0, floor, pool, texture);
    for (int32_t number = 1; number < texture->levels && good; ++number) {
        mip_level level;
        good = lmb_mip_level_reduce(image, number, &level);
        if (good) {
            good = level_encode(&level, number, floor, pool, texture);
            lmb_mip_level_free(&level);
        }
    }
    return good;
}

lmb_result lmb_lightmap_textures_write(const lmb_lightmap *lightmap, int32_t image, const float *plane,
                                       const lmb_texture_part *part, const char *path, lmb_error *error)
{
    const lmb_lightmap_image *of = &lightmap->image[image];
    const float scale = lmb_lightmap_textures_scale(of, plane, part);
    mip_level level;
    lmb_block_texture texture;
    if (!level_load(of, plane, part, scale, &level)) {
        return out_of_memory(error);
    }
    lmb_result result = lmb_block_texture_create(part->format, of->width, of->height, part->layers,
                                                 lmb_lightmap_textures_levels(lightmap, image), &texture);
    if (result != LMB_OK) {
        lmb_mip_level_free(&level);
        return result == LMB_ERROR_MEMORY ? out_of_memory(error)
                                          : lmb_error_set(error, result, "%s: no texture has these sides", path);
    }
    result = levels_encode(&level, lightmap->settings.pool, &texture)
                 ? lmb_block_texture_write(&texture, container_of(lightmap), path, error)
                 : out_of_memory(error);
    lmb_block_texture_free(&texture);
    lmb_mip_level_free(&level);
    return result;
}

static lmb_result layers_decode(const lmb_block_texture *texture, float scale, const lmb_texture_part *part,
                                float *plane)
{
    const size_t texels = (size_t)texture->width * (size_t)texture->height;
    const int channels = lmb_block_format_channels(part->format);
    float *const decoded = malloc(texels * (size_t)channels * sizeof *decoded);
    lmb_result result = decoded ? LMB_OK : LMB_ERROR_MEMORY;
    for (int c = 0; c < part->count && result == LMB_OK; ++c) {
        float *of_layer[3];
        for (int k = 0; k < channels; ++k) {
            of_layer[k] = decoded + (size_t)k * texels;
        }
        if (c % channels == 0) {
            result = lmb_block_texture_decode(texture, 0, c / channels, of_layer);
        }
        const float stretch = part->light ? scale : part->high[c] - part->low[c];
        float *const to = plane + (size_t)(part->first + c) * texels;
        for (size_t i = 0; i < texels && result == LMB_OK; ++i) {
            to[i] = part->low[c] + of_layer[c % channels][i] * stretch;
        }
    }
    free(decoded);
    return result;
}

lmb_result lmb_lightmap_textures_read(const lmb_lightmap_image *image, float scale, const lmb_texture_part *part,
                                      const char *path, float *plane, lmb_error *error)
{
    lmb_block_texture texture;
    lmb_block_container container;
    lmb_result result = lmb_block_texture_read(path, &texture, &container, error);
    if (result != LMB_OK) {
        return result;
    }
    const bool good = texture.format == part->format && texture.width == image->width &&
                      texture.height == image->height && texture.layers == part->layers;
    if (!good) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not the texture that the layout has", path);
    } else if (layers_decode(&texture, scale, part, plane) != LMB_OK) {
        result = out_of_memory(error);
    }
    lmb_block_texture_free(&texture);
    return result;
}
