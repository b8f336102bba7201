/* Hard cases of light (none, too much, too little, both at once), through the whole pipeline in small. */
#include "hard_level.h"
#include "scenes/levels.h"

#include <float.h>

#define PI 3.14159265358979323846

static lmb_error error;

/* The largest that a set holds of anything. */
static float sh_largest(const lmb_sh3_rgb *radiance)
{
    float largest = 0.0f;
    for (int i = 0; i < 27; ++i) {
        largest = fmaxf(largest, fabsf(radiance->channel[i / 9].c[i % 9]));
    }
    return largest;
}

static void no_light(void)
{
    hard_level level;
    const lmb_rgb none = {{0.0f, 0.0f, 0.0f}};
    const char *path = hard_path("dark", "glb");
    CHECK(lmb_level_furnace(path, 4.0f, 0.5f, none, false, &error) == LMB_OK, "%s", error.message);
    if (!hard_bake(&level, path, NULL, &(hard_settings){1.0f, 2.0f, 16})) {
        return;
    }
    CHECK(!lmb_scene_has_light(level.traced.scene), "has light");
    for (int32_t i = 0; i < level.probes->count; ++i) {
        CHECK(sh_largest(&level.probes->radiance[0][i]) == 0.0f, "probe %d", (int)i);
    }
    CHECK(level.packed.scale == 1.0f && level.packed.overflow_count == 0, "scale %g", (double)level.packed.scale);
    const lmb_rgb sampled = hard_sample(&level, (lmb_vec3){0.3f, 0.2f, 0.1f}, hard_up);
    CHECK(sampled.c[0] == 0.0f && sampled.c[1] == 0.0f && sampled.c[2] == 0.0f, "%g", (double)sampled.c[0]);
    for (int32_t i = 0; i < level.lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &level.lightmap->image[i];
        for (int32_t k = 0; k < image->width * image->height; ++k) {
            CHECK(lmb_lightmap_plane(image, 1)[k] == 0.0f, "texel %d", (int)k);
        }
    }
    hard_close(&level);
}

/* Open ground under a sun of 1e6 lux at noon, and a sealed black room of 2 x 2 x 2 m beside it with a candle of
 * 1e-3 cd in its middle: nothing but the candle's own light is in there, and it must come out as it is. */
static void sun_beside_candle(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int grey = hard_material(builder, 0.5f, 0.0f);
    const int black = hard_material(builder, 0.0f, 0.0f);
    hard_add_floor(builder, "ground", grey, (lmb_vec3){0, 0, 0}, 8.0f);
    hard_add_box(builder, "inside", black, (lmb_vec3){-1, 0.5f, -1}, (lmb_vec3){1, 2.5f, 1}, true);
    hard_add_box(builder, "outside", grey, (lmb_vec3){-1.1f, 0.4f, -1.1f}, (lmb_vec3){1.1f, 2.6f, 1.1f}, false);
    hard_add_light(builder, LMB_LEVEL_LIGHT_DIRECTIONAL, 1e6f, (lmb_vec3){0, 0, 0});
    hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, 1e-3f, (lmb_vec3){0, 1.5f, 0});
    hard_level level;
    const char *path = hard_path("candle", "glb");
    if (!hard_write(builder, path) || !hard_bake(&level, path, NULL, &(hard_settings){0.5f, 2.0f, 64})) {
        return;
    }
    const lmb_rgb sun = traced_irradiance(&level.traced, (lmb_vec3){3, 0.001f, 3}, hard_up, 64);
    CHECK_NEAR(sun.c[0], 1e6 / PI, 1e4 / PI, "in the sun");
    const lmb_rgb candle = traced_irradiance(&level.traced, (lmb_vec3){0, 0.6f, 0}, hard_up, 64);
    CHECK_NEAR(candle.c[0], 1e-3 / (0.9 * 0.9) / PI, 1e-5, "by the candle");
    /* Two lattice points from the candle, and one that is as near as any: SH of a light in one direction, straight. */
    const lmb_rgb stored = hard_sample(&level, (lmb_vec3){0.5f, 1.5f, 0.5f}, (lmb_vec3){-0.7071068f, 0, -0.7071068f});
    const double peak = 1e-3 / 0.5 / PI;
    CHECK_NEAR(stored.c[1], peak * (0.25 + 0.5 + 0.3125), 0.06 * peak, "stored by the candle");
    CHECK(level.packed.scale > 1.0f, "%g", (double)level.packed.scale);
    hard_close(&level);
}

/* The two kinds of lights are chosen apart, but a strong lamp behind a wall must not hide a weak one either. */
static void strong_lamp_behind_a_wall(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int black = hard_material(builder, 0.0f, 0.0f);
    hard_add_box(builder, "strong", black, (lmb_vec3){-2.05f, 0, -1}, (lmb_vec3){-0.05f, 2, 1}, true);
    hard_add_box(builder, "weak", black, (lmb_vec3){0.05f, 0, -1}, (lmb_vec3){2.05f, 2, 1}, true);
    hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, 1e6f, (lmb_vec3){-1.05f, 1, 0});
    hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, 1.0f, (lmb_vec3){1.05f, 1, 0});
    level_fixture level;
    const char *path = hard_path("lamps", "glb");
    if (!hard_write(builder, path) || !level_fixture_load(&level, path, NULL, 1)) {
        return;
    }
    const lmb_rgb weak = traced_irradiance(&level, (lmb_vec3){1.05f, 0.001f, 0}, hard_up, 1024);
    CHECK_NEAR(weak.c[0], 1.0 / PI, 0.1 / PI, "weak");
    const lmb_rgb strong = traced_irradiance(&level, (lmb_vec3){-1.05f, 0.001f, 0}, hard_up, 1024);
    CHECK_NEAR(strong.c[0], 1e6 / PI, 0.02e6 / PI, "strong");
    level_fixture_close(&level);
}

/* Radiance is emission / (1 - albedo) everywhere: in the volume and on the walls. */
static void white_furnace(void)
{
    hard_level level;
    const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
    const char *path = hard_path("furnace", "glb");
    CHECK(lmb_level_furnace(path, 3.0f, 0.99f, one, false, &error) == LMB_OK, "%s", error.message);
    if (!hard_bake(&level, path, NULL, &(hard_settings){1.0f, 1.0f, 64})) {
        return;
    }
    double probes = 0.0;
    for (int32_t i = 0; i < level.probes->count; ++i) {
        probes += (double)level.probes->radiance[0][i].channel[0].c[0] / (2.0 * sqrt(PI)) / level.probes->count;
    }
    CHECK_NEAR(probes, 100.0, 10.0, "mean of %d probes", (int)level.probes->count);
    double texels = 0.0;
    uint64_t count = 0;
    const lmb_lightmap_image *image = &level.lightmap->image[0];
    for (int32_t k = 0; k < image->width * image->height; ++k) {
        if (image->state[k] == LMB_TEXEL_GATHERED) {
            texels += (double)lmb_lightmap_plane(image, 1)[k];
            ++count;
        }
    }
    CHECK_NEAR(texels / (double)count, 100.0, 10.0, "mean of %d texels", (int)count);
    hard_close(&level);
}

/* A furnace without reflection whose light is at the edge of what float holds: everything stored is in proportion. */
static void extreme_radiance(void)
{
    static const float radiances[] = {1e-30f, 1e-8f, 1e6f, 1e18f, 1e30f};
    for (size_t i = 0; i < sizeof radiances / sizeof radiances[0]; ++i) {
        hard_level level;
        const float r = radiances[i];
        const lmb_rgb emission = {{r, 0.5f * r, 0.25f * r}};
        const char *path = hard_path("extreme", "glb");
        CHECK(lmb_level_furnace(path, 4.0f, 0.0f, emission, false, &error) == LMB_OK, "%s", error.message);
        if (!hard_bake(&level, path, NULL, &(hard_settings){1.0f, 1.0f, 64})) {
            continue;
        }
        const lmb_rgb traced = traced_irradiance(&level.traced, (lmb_vec3){0.3f, 0.2f, 0.1f}, hard_up, 1024);
        CHECK_NEAR(traced.c[1] / r, 0.5, 0.02, "radiance %g, traced", (double)r);
        const lmb_rgb sampled = hard_sample(&level, (lmb_vec3){0.3f, 0.2f, 0.1f}, hard_up);
        /* The scale is at least 2^-96: what is below has no place in a file. */
        if (r > 1e-20f) {
            CHECK_NEAR(sampled.c[0] / r, 1.0, 0.1, "radiance %g, sampled", (double)r);
            CHECK_NEAR(sampled.c[2] / r, 0.25, 0.03, "radiance %g, sampled", (double)r);
        }
        const lmb_rgb texel = hard_texel(&level, "furnace", 0);
        CHECK_NEAR(texel.c[1] / r, 0.5, 0.1, "radiance %g, lightmap", (double)r);
        CHECK(level.packed.overflow_count == 0, "radiance %g: %d", (double)r, (int)level.packed.overflow_count);
        CHECK(r < 1e5f || level.packed.scale > 1.0f, "radiance %g: scale %g", (double)r, (double)level.packed.scale);
        hard_close(&level);
    }
}

/* Punctual lights at both ends, and a lamp that is all but at the point that it lights. */
static void extreme_lamps(void)
{
    static const float intensities[] = {1e-30f, 1e30f};
    for (size_t i = 0; i < sizeof intensities / sizeof intensities[0]; ++i) {
        const float r = intensities[i];
        lmb_level_builder *builder = lmb_level_builder_create(0.1f);
        const int grey = hard_material(builder, 0.5f, 0.0f);
        hard_add_box(builder, "room", grey, (lmb_vec3){-2, 0, -2}, (lmb_vec3){2, 3, 2}, true);
        hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, r, (lmb_vec3){0, 1, 0});
        hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, r, (lmb_vec3){1, 1e-6f, 1});
        hard_level level;
        const char *path = hard_path("lamp", "glb");
        if (hard_write(builder, path) && hard_bake(&level, path, NULL, &(hard_settings){1.0f, 1.0f, 16})) {
            hard_close(&level);
        }
    }
}

/* An EXR of 32-bit floats without compression, by hand: Radiance .hdr holds no NaN, and EXRs of ours none either. */
static bool environment_write(const char *path, const float *rgb, int32_t width, int32_t height)
{
    FILE *const file = fopen(path, "wb");
    if (!file) {
        return false;
    }
    static const unsigned char magic[8] = {0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0};
    fwrite(magic, 1, sizeof magic, file);
    static const char *const names[3] = {"B", "G", "R"};
    const int32_t chlist_bytes = 3 * 18 + 1;
    fwrite("channels\0chlist", 1, 16, file);
    fwrite(&chlist_bytes, 4, 1, file);
    for (int c = 0; c < 3; ++c) {
        static const int32_t channel[4] = {2, 0, 1, 1}; /* float, not linear, sampled everywhere */
        fwrite(names[c], 1, 2, file);
        fwrite(channel, 4, 4, file);
    }
    fputc(0, file);
    const int32_t one = 1, four = 4, eight = 8, sixteen = 16;
    const int32_t window[4] = {0, 0, width - 1, height - 1};
    const float unit = 1.0f;
    const float centre[2] = {0.0f, 0.0f};
    fwrite("compression\0compression", 1, 24, file);
    fwrite(&one, 4, 1, file);
    fputc(0, file);
    fwrite("dataWindow\0box2i", 1, 17, file);
    fwrite(&sixteen, 4, 1, file);
    fwrite(window, 4, 4, file);
    fwrite("displayWindow\0box2i", 1, 20, file);
    fwrite(&sixteen, 4, 1, file);
    fwrite(window, 4, 4, file);
    fwrite("lineOrder\0lineOrder", 1, 20, file);
    fwrite(&one, 4, 1, file);
    fputc(0, file);
    fwrite("pixelAspectRatio\0float", 1, 23, file);
    fwrite(&four, 4, 1, file);
    fwrite(&unit, 4, 1, file);
    fwrite("screenWindowCenter\0v2f", 1, 23, file);
    fwrite(&eight, 4, 1, file);
    fwrite(centre, 4, 2, file);
    fwrite("screenWindowWidth\0float", 1, 24, file);
    fwrite(&four, 4, 1, file);
    fwrite(&unit, 4, 1, file);
    fputc(0, file);
    const int32_t row_bytes = 12 * width;
    const uint64_t first = (uint64_t)ftell(file) + 8u * (uint64_t)height;
    for (int32_t y = 0; y < height; ++y) {
        const uint64_t offset = first + (uint64_t)y * (uint64_t)(row_bytes + 8);
        fwrite(&offset, 8, 1, file);
    }
    for (int32_t y = 0; y < height; ++y) {
        fwrite(&y, 4, 1, file);
        fwrite(&row_bytes, 4, 1, file);
        for (int c = 2; c >= 0; --c) {
            for (int32_t x = 0; x < width; ++x) {
                fwrite(&rgb[3 * ((size_t)y * (size_t)width + (size_t)x) + (size_t)c], 4, 1, file);
            }
        }
    }
    return fclose(file) == 0;
}

/* A sky of 1 with pixels that are no light: they count as black. With a huge one, which must not end in infinity. */
static void broken_environment(void)
{
    static const float odd[] = {1.0f, NAN, -5.0f, INFINITY, 1e10f, 1e30f, FLT_MAX};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; ++i) {
        enum { WIDTH = 32, HEIGHT = 16 };
        float pixels[3 * WIDTH * HEIGHT];
        for (int k = 0; k < 3 * WIDTH * HEIGHT; ++k) {
            pixels[k] = 1.0f;
        }
        pixels[3 * (2 * WIDTH + 5) + 1] = odd[i];
        char sky[512];
        snprintf(sky, sizeof sky, "%s", hard_path("sky", "exr"));
        CHECK(environment_write(sky, pixels, WIDTH, HEIGHT), "%s", sky);
        const char *path = hard_path("under_sky", "glb");
        CHECK(lmb_level_open_ground(path, 4.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
        hard_level level;
        if (!hard_bake(&level, path, sky, &(hard_settings){1.0f, 1.0f, 64})) {
            CHECK(false, "pixel of %g", (double)odd[i]);
            continue;
        }
        const lmb_rgb up = traced_irradiance(&level.traced, (lmb_vec3){0, 0.01f, 0}, hard_up, 1024);
        if (!(odd[i] > 1.0f) || isinf(odd[i])) {
            CHECK_NEAR(up.c[0], 1.0, 0.02, "pixel of %g", (double)odd[i]);
            CHECK_NEAR(up.c[1], 1.0, 0.03, "pixel of %g", (double)odd[i]);
            const lmb_rgb texel = hard_texel(&level, "ground", 0);
            CHECK_NEAR(texel.c[1], 1.0, 0.15, "pixel of %g", (double)odd[i]);
        } else {
            /* Solid angle of a pixel of row 2 over pi, times how high it stands. */
            const double theta = PI * 2.5 / HEIGHT;
            const double share = 2.0 * PI / WIDTH * (cos(PI * 2 / HEIGHT) - cos(PI * 3 / HEIGHT)) * cos(theta) / PI;
            CHECK_NEAR((double)up.c[1] / (double)odd[i] / share, 1.0, 0.05, "pixel of %g", (double)odd[i]);
        }
        hard_close(&level);
    }
}

/* More light than float holds: what is lost is lost whole, and nothing else breaks. */
static void light_beyond_float(void)
{
    const float pixels[6] = {FLT_MAX, 1.0f, FLT_MAX, 1e20f, FLT_MAX, 1.0f};
    char sky[512];
    snprintf(sky, sizeof sky, "%s", hard_path("bright", "exr"));
    CHECK(environment_write(sky, pixels, 2, 1), "%s", sky);
    strcat(sky, ",strength=1e30");
    const char *path = hard_path("under_bright", "glb");
    CHECK(lmb_level_open_ground(path, 4.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    hard_level level;
    if (hard_bake(&level, path, sky, &(hard_settings){1.0f, 1.0f, 64})) {
        hard_close(&level);
    }
}

static const test_case cases[] = {
    {"no_light", no_light},
    {"sun_beside_candle", sun_beside_candle},
    {"strong_lamp_behind_a_wall", strong_lamp_behind_a_wall},
    {"white_furnace", white_furnace},
    {"extreme_radiance", extreme_radiance},
    {"extreme_lamps", extreme_lamps},
    {"broken_environment", broken_environment},
    {"light_beyond_float", light_beyond_float},
};

TEST_MAIN(cases)
