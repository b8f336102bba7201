#include <lambent/scene.h>
#include <lambent/texture.h>

#include "harness.h"

/* 3 x 2: red, green, blue over black, white, half grey with alpha 51. */
static uint8_t PIXELS[] = {255, 0, 0, 255, 0,   255, 0,   255, 0,   0,   255, 255,
                           0,   0, 0, 255, 255, 255, 255, 255, 128, 128, 128, 51};
static lmb_texture_image IMAGE = {.width = 3, .height = 2, .rgba = PIXELS};

static lmb_scene scene_make(void)
{
    return (lmb_scene){.images = &IMAGE, .image_count = 1};
}

static lmb_texture texture_make(lmb_wrap wrap, bool nearest)
{
    return (lmb_texture){.wrap_u = wrap, .wrap_v = wrap, .nearest = nearest, .transform = {{1, 0, 0}, {0, 1, 0}}};
}

static void srgb_is_the_standard_curve(void)
{
    for (int b = 0; b < 256; ++b) {
        const long double x = (long double)b / 255.0L;
        const long double linear = x <= 0.04045L ? x / 12.92L : powl((x + 0.055L) / 1.055L, 2.4L);
        const float actual = lmb_srgb_to_linear((uint8_t)b);
        CHECK(actual == (float)linear, "byte %d: %.9g, expected %.9g", b, (double)actual, (double)(float)linear);
    }
    CHECK(lmb_srgb_to_linear(0) == 0.0f && lmb_srgb_to_linear(255) == 1.0f, "ends");
}

static void nearest_finds_each_texel(void)
{
    const lmb_scene scene = scene_make();
    static const struct {
        lmb_wrap wrap;
        float u, v;
        int x, y;
    } cases[] = {
        {LMB_WRAP_REPEAT, 0.1f, 0.1f, 0, 0},    {LMB_WRAP_REPEAT, 0.5f, 0.25f, 1, 0},
        {LMB_WRAP_REPEAT, 0.99f, 0.99f, 2, 1},  {LMB_WRAP_REPEAT, 1.1f, 1.6f, 0, 1},
        {LMB_WRAP_REPEAT, -0.1f, -0.1f, 2, 1},  {LMB_WRAP_REPEAT, 1.0f, 1.0f, 0, 0},
        {LMB_WRAP_CLAMP, 1.0f, 1.0f, 2, 1},     {LMB_WRAP_CLAMP, -7.0f, 7.0f, 0, 1},
        {LMB_WRAP_MIRROR, 1.1f, 0.1f, 2, 0},    {LMB_WRAP_MIRROR, 1.9f, 1.9f, 0, 0},
        {LMB_WRAP_MIRROR, -0.1f, -0.6f, 0, 1},  {LMB_WRAP_MIRROR, 1.0f, 1.0f, 2, 1},
        {LMB_WRAP_REPEAT, 1e30f, -1e30f, 0, 0}, {LMB_WRAP_CLAMP, 1e30f, -1e30f, 2, 0},
        {LMB_WRAP_REPEAT, NAN, INFINITY, 0, 0}, {LMB_WRAP_MIRROR, -INFINITY, NAN, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const lmb_texture texture = texture_make(cases[i].wrap, true);
        float rgba[4];
        lmb_texture_sample(&scene, &texture, (lmb_vec2){cases[i].u, cases[i].v}, false, rgba);
        for (int c = 0; c < 4; ++c) {
            const int byte = PIXELS[4 * (3 * cases[i].y + cases[i].x) + c];
            CHECK_NEAR(rgba[c], byte / 255.0, 1e-7, "case %zu (%g, %g) channel %d", i, (double)cases[i].u,
                       (double)cases[i].v, c);
        }
    }
}

static void bilinear_blends_decoded_texels(void)
{
    const lmb_scene scene = scene_make();
    float rgba[4];
    lmb_texture texture = texture_make(LMB_WRAP_CLAMP, false);
    lmb_texture_sample(&scene, &texture, (lmb_vec2){0.5f, 0.25f}, true, rgba);
    CHECK_NEAR(rgba[1], 1.0, 1e-6, "a texel's centre is the texel");
    CHECK_NEAR(rgba[0], 0.0, 1e-6, "a texel's centre is the texel");

    /* Between white (1,1) and grey (2,1): the mean of linear values, not of bytes; alpha is never decoded. */
    lmb_texture_sample(&scene, &texture, (lmb_vec2){2.0f / 3.0f, 0.75f}, true, rgba);
    CHECK_NEAR(rgba[0], 0.5 * (1.0 + pow((128 / 255.0 + 0.055) / 1.055, 2.4)), 1e-6, "half way in linear light");
    CHECK_NEAR(rgba[3], 0.5 * (1.0 + 0.2), 1e-6, "alpha");
    lmb_texture_sample(&scene, &texture, (lmb_vec2){2.0f / 3.0f, 0.75f}, false, rgba);
    CHECK_NEAR(rgba[0], 0.5 * (1.0 + 128 / 255.0), 1e-6, "half way in bytes");

    /* At u = 0 repeat blends the first and the last column; clamp and mirror stay with the first. */
    static const struct {
        lmb_wrap wrap;
        double red, blue;
    } edges[] = {{LMB_WRAP_REPEAT, 0.5, 0.5}, {LMB_WRAP_CLAMP, 1.0, 0.0}, {LMB_WRAP_MIRROR, 1.0, 0.0}};
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; ++i) {
        for (int end = 0; end < 2; ++end) {
            texture = texture_make(LMB_WRAP_CLAMP, false);
            texture.wrap_u = edges[i].wrap;
            const float u = end && edges[i].wrap == LMB_WRAP_REPEAT ? 1.0f : 0.0f;
            lmb_texture_sample(&scene, &texture, (lmb_vec2){u, 0.25f}, true, rgba);
            CHECK_NEAR(rgba[0], edges[i].red, 1e-6, "wrap %d red", (int)edges[i].wrap);
            CHECK_NEAR(rgba[2], edges[i].blue, 1e-6, "wrap %d blue", (int)edges[i].wrap);
        }
    }
}

static void transform_is_applied(void)
{
    const lmb_scene scene = scene_make();
    lmb_texture texture = texture_make(LMB_WRAP_REPEAT, true);
    const float turn[2][3] = {{0.0f, 1.0f, 0.25f}, {1.0f, 0.0f, 0.0f}};
    memcpy(texture.transform, turn, sizeof turn);
    float rgba[4];
    lmb_texture_sample(&scene, &texture, (lmb_vec2){0.75f, 0.6f}, false, rgba); /* (0.85, 0.75): column 2, row 1 */
    CHECK_NEAR(rgba[3], 0.2, 1e-6, "transformed lookup");
}

static void no_image_is_white(void)
{
    const lmb_scene scene = scene_make();
    lmb_texture texture = texture_make(LMB_WRAP_REPEAT, false);
    texture.image = -1;
    float rgba[4] = {0};
    lmb_texture_sample(&scene, &texture, (lmb_vec2){0.3f, 0.3f}, true, rgba);
    for (int c = 0; c < 4; ++c) {
        CHECK(rgba[c] == 1.0f, "channel %d is %g", c, (double)rgba[c]);
    }
}

static const test_case CASES[] = {
    {"srgb is the standard curve", srgb_is_the_standard_curve},
    {"nearest finds each texel", nearest_finds_each_texel},
    {"bilinear blends decoded texels", bilinear_blends_decoded_texels},
    {"transform is applied", transform_is_applied},
    {"no image is white", no_image_is_white},
};

TEST_MAIN(CASES)
