/* Compressed textures against a decoder that is not ours: what Vulkan, Mesa's software driver where there is no other,
 * samples from blocks of any bits, and from those that the encoders make. */
#include "harness.h"
#include "shader_runner.h"
#include "variates.h"

#include <stdlib.h>

#include <lambent/block_texture.h>

#include "texture/bc6h_modes.h"

enum { GROUP = 64, SEEN = 8 };

static const int vulkan_formats[LMB_BLOCK_BC6H + 1] = {
    [LMB_BLOCK_BC4] = 139, [LMB_BLOCK_BC5] = 141, [LMB_BLOCK_BC6H] = 143};

/* What is sampled of every texel: as fetched, then as filtered; four channels each. NULL: no Vulkan, or a failure. */
static float *texture_sample(const lmb_block_texture *texture, size_t *texels)
{
    size_t starts[LMB_BLOCK_MOST_LEVELS];
    *texels = 0;
    for (int32_t level = 0; level < texture->levels; ++level) {
        starts[level] = lmb_block_texture_level_start(texture, level);
        *texels += (size_t)lmb_block_texture_side(texture->width, level) *
                   (size_t)lmb_block_texture_side(texture->height, level) * (size_t)texture->layers;
    }
    float *const items = calloc(*texels, 4 * sizeof *items), *seen = calloc(*texels, SEEN * sizeof *seen);
    size_t i = 0;
    for (int32_t level = 0; level < texture->levels; ++level) {
        const int32_t width = lmb_block_texture_side(texture->width, level);
        const int32_t height = lmb_block_texture_side(texture->height, level);
        for (int32_t k = 0; k < width * height * texture->layers && items; ++k, ++i) {
            items[4 * i] = (float)(k % width);
            items[4 * i + 1] = (float)(k / width % height);
            items[4 * i + 2] = (float)(k / width / height);
            items[4 * i + 3] = (float)level;
        }
    }
    const shader_texture source = {vulkan_formats[texture->format],
                                   (unsigned)texture->width,
                                   (unsigned)texture->height,
                                   (unsigned)texture->layers,
                                   (unsigned)texture->levels,
                                   0,
                                   texture->data,
                                   texture->size,
                                   starts};
    const shader_floats in = {items, 4 * *texels}, out = {seen, SEEN * *texels};
    const shader_run_result ran =
        items && seen ? shader_run(LMB_SHADER_TEXTURE, (unsigned)((*texels + GROUP - 1) / GROUP), &source, &in, &out)
                      : SHADER_FAILED;
    CHECK(ran != SHADER_FAILED, "%s", LMB_SHADER_TEXTURE);
    if (ran == SHADER_NO_DEVICE) {
        test_skip("no Vulkan device that samples BC textures (Debian: mesa-vulkan-drivers)");
    }
    free(items);
    if (ran != SHADER_RAN) {
        free(seen);
        return NULL;
    }
    return seen;
}

/* One layer of a level, decoded by us: planes of it. */
static void planes_decode(const lmb_block_texture *texture, int32_t level, int32_t layer, float *planes[3])
{
    const size_t texels = (size_t)texture->width * (size_t)texture->height;
    for (int c = 0; c < 3; ++c) {
        planes[c] = calloc(texels, sizeof **planes);
    }
    lmb_block_texture_decode(texture, level, layer, planes);
}

static float filtered(const float *plane, int32_t width, int32_t height, int32_t x, int32_t y)
{
    const int32_t right = x + 1 < width ? x + 1 : x, below = y + 1 < height ? y + 1 : y;
    return 0.25f *
           (plane[y * width + x] + plane[y * width + right] + plane[below * width + x] + plane[below * width + right]);
}

/* Both see the same in every texel: of BC6H to the bit; of the others, whose interpolation is left to the decoder,
 * within `tolerance`. Filtering, in fixed point there, within 1/128 of the range. */
static void sampled_as_decoded(const lmb_block_texture *texture, float tolerance)
{
    size_t texels;
    float *const seen = texture_sample(texture, &texels);
    const float *at = seen;
    for (int32_t level = 0; level < texture->levels && seen; ++level) {
        const int32_t width = lmb_block_texture_side(texture->width, level);
        const int32_t height = lmb_block_texture_side(texture->height, level);
        for (int32_t layer = 0; layer < texture->layers; ++layer) {
            float *planes[3];
            planes_decode(texture, level, layer, planes);
            for (int32_t i = 0; i < width * height && test_failures < 20; ++i, at += SEEN) {
                for (int c = 0; c < lmb_block_format_channels(texture->format); ++c) {
                    CHECK_NEAR(at[c], planes[c][i], tolerance, "%s: level %d, layer %d, texel %d, channel %d",
                               lmb_block_format_name(texture->format), level, layer, i, c);
                    const float mean = filtered(planes[c], width, height, i % width, i / width);
                    CHECK_NEAR(at[4 + c], mean, tolerance > 0.0f ? 0.015f : fmaxf(1e-3f * mean, 1e-6f),
                               "%s: level %d, layer %d, filtered at texel %d", lmb_block_format_name(texture->format),
                               level, layer, i);
                }
            }
            for (int c = 0; c < 3; ++c) {
                free(planes[c]);
            }
        }
    }
    free(seen);
}

/* Bits as they come, but each mode of BC6H in turn, the reserved ones too. */
static void any_bits_decode_alike(void)
{
    uint64_t random = 5;
    for (int format = 0; format <= LMB_BLOCK_BC6H; ++format) {
        lmb_block_texture texture;
        CHECK(lmb_block_texture_create((lmb_block_format)format, 256, 128, 2, 3, &texture) == LMB_OK, "memory");
        for (size_t i = 0; i < texture.size; ++i) {
            texture.data[i] = (unsigned char)(256.0 * variate_next(&random));
        }
        for (size_t i = 0; i < texture.size / 16 && format == LMB_BLOCK_BC6H; ++i) {
            unsigned char *const first = &texture.data[16 * i];
            *first = (unsigned char)((*first & 0xE0) | (i % 32));
        }
        sampled_as_decoded(&texture, format == LMB_BLOCK_BC6H ? 0.0f : 1.7f / 255.0f);
        lmb_block_texture_free(&texture);
    }
}

/* Light of four decades with an edge; the other formats' share of it. */
static void what_is_encoded_is_seen(void)
{
    enum { WIDTH = 64, HEIGHT = 32, TEXELS = WIDTH * HEIGHT };
    static float values[3][TEXELS];
    for (int i = 0; i < TEXELS; ++i) {
        const double x = i % WIDTH, y = i / WIDTH;
        const double light = pow(10.0, x / 16.0 - 2.0) * (x + y < 50.0 ? 1.0 : 0.2);
        for (int c = 0; c < 3; ++c) {
            values[c][i] = (float)(light * (1.0 + 0.3 * c + 0.01 * y));
        }
    }
    const float *planes[3] = {values[0], values[1], values[2]};
    const lmb_block_pixels pixels = {.plane = planes, .floor = 0.01f};
    for (int format = 0; format <= LMB_BLOCK_BC6H; ++format) {
        lmb_block_texture texture;
        CHECK(lmb_block_texture_create((lmb_block_format)format, WIDTH, HEIGHT, 1, 1, &texture) == LMB_OK, "memory");
        lmb_block_texture_encode(&texture, 0, &pixels, NULL);
        sampled_as_decoded(&texture, format == LMB_BLOCK_BC6H ? 0.0f : 1.7f / 255.0f);
        lmb_block_texture_free(&texture);
    }
}

static const test_case cases[] = {
    {"any_bits_decode_alike", any_bits_decode_alike},
    {"what_is_encoded_is_seen", what_is_encoded_is_seen},
};

TEST_MAIN(cases)
