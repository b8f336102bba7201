/* Skies that change at run time: the basis, its weights, and light that is blended of bakes under it. */
#include <lambent/bake_level.h>
#include <lambent/environment.h>
#include <lambent/exr.h>
#include <lambent/gather_sh3.h>
#include <lambent/sky.h>

#include <stdlib.h>
#include <string.h>

#include "constant_volume.h"
#include "floor_fixture.h"
#include "harness.h"

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/sky_" name

static const double PI = 3.14159265358979323846;

/* A sky of each colour its own, bright on one side, nowhere negative: radiance L in SH3. */
static lmb_sh3_rgb some_sky(void)
{
    lmb_sh3_rgb sky;
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            sky.channel[c].c[k] = k == 0 ? 12.0f : 0.3f * (float)((7 * k + 5 * c) % 9 - 4);
        }
    }
    return sky;
}

static lmb_vec3 direction_of(int index, int count)
{
    const double z = 1.0 - (2.0 * index + 1.0) / count, turn = 2.39996323 * index, flat = sqrt(1.0 - z * z);
    return (lmb_vec3){(float)(flat * cos(turn)), (float)z, (float)(flat * sin(turn))};
}

/* The basis, by its weights, is the sky's harmonics in every direction; and it is light. */
static void weights_make_the_sky(void)
{
    const lmb_sh3_rgb sky = some_sky();
    static const uint32_t counts[] = {LMB_SKY_LINEAR, LMB_SKY_QUADRATIC};
    for (int way = 0; way < 2; ++way) {
        lmb_rgb weight[LMB_SKY_QUADRATIC];
        CHECK(lmb_sky_weights(&sky, counts[way], weight), "%u", counts[way]);
        for (int i = 0; i < 1000; ++i) {
            const lmb_vec3 direction = direction_of(i, 1000);
            const lmb_sh3 basis = lmb_sh3_basis(direction);
            float radiance[LMB_SKY_QUADRATIC];
            lmb_sky_basis(direction, radiance);
            for (int c = 0; c < 3; ++c) {
                double expected = 0.0, found = 0.0;
                for (uint32_t k = 0; k < counts[way]; ++k) {
                    expected += (double)sky.channel[c].c[k] * (double)basis.c[k];
                    found += (double)weight[k].c[c] * (double)radiance[k];
                    CHECK(radiance[k] >= 0.0f && radiance[k] <= 3.00001f, "%u: %g", k, (double)radiance[k]);
                }
                CHECK_NEAR(found, expected, 1e-5, "%u functions, direction %d, channel %d", counts[way], i, c);
            }
        }
    }
    lmb_rgb weight[LMB_SKY_QUADRATIC] = {{{7.0f, 7.0f, 7.0f}}};
    CHECK(!lmb_sky_weights(&sky, 5, weight) && weight[0].c[0] == 7.0f, "no such count");
}

/* What `lambent bake --env sky-basis:K` lights with. */
static void pictures_are_the_basis(void)
{
    for (int k = 0; k < LMB_SKY_QUADRATIC; ++k) {
        char text[32];
        snprintf(text, sizeof text, "sky-basis:%d,set=sky", k);
        lmb_scene scene = {0};
        lmb_error error = {{0}};
        CHECK(lmb_scene_set_environment(&scene, text, &error) == LMB_OK, "%s", error.message);
        const lmb_image *const image = &scene.environment.image;
        if (!image->rgb) {
            CHECK(false, "%s: no picture", text);
            return;
        }
        double sum[LMB_SH3_COUNT] = {0.0};
        for (int i = 0; i < image->width * image->height; ++i) {
            const double polar = PI * (i / image->width + 0.5) / image->height;
            const double turn = 2.0 * PI * (i % image->width + 0.5) / image->width;
            /* row 0 is +Y, u = 0.5 is +X, u = 0.75 is +Z */
            const lmb_sh3 basis = lmb_sh3_basis(
                (lmb_vec3){(float)(-sin(polar) * cos(turn)), (float)cos(polar), (float)(-sin(polar) * sin(turn))});
            const double solid_angle = 2.0 * PI / image->width * PI / image->height * sin(polar);
            for (int n = 0; n < LMB_SH3_COUNT; ++n) {
                sum[n] += (double)image->rgb[3 * i] * (double)basis.c[n] * solid_angle;
            }
        }
        for (int n = 1; n < LMB_SH3_COUNT; ++n) {
            CHECK(n == k ? sum[n] > 0.8 : fabs(sum[n]) < 2e-3, "%s: coefficient %d is %g", text, n, sum[n]);
        }
        CHECK_NEAR(sum[0], 2.0 * sqrt(PI), 2e-3, "%s: its mean is 1", text);
        lmb_image_free(&scene.environment.image);
    }
    static const char *const wrong[] = {"sky-basis:", "sky-basis:9", "sky-basis:-1", "sky-basis:12", "sky-basis:x"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        lmb_error error = {{0}};
        CHECK(lmb_environment_check(wrong[i], &error) == LMB_ERROR_FORMAT, "%s", wrong[i]);
        CHECK(strstr(error.message, "sky-basis:0 to sky-basis:8"), "%s", error.message);
    }
}

/* A sky's picture that holds the harmonics themselves. */
static bool picture_write(const lmb_sh3_rgb *sky, const char *path)
{
    enum { WIDTH = 256, HEIGHT = 128 };
    static float pixel[3][WIDTH * HEIGHT];
    float darkest = INFINITY;
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        const double polar = PI * (i / WIDTH + 0.5) / HEIGHT, turn = 2.0 * PI * (i % WIDTH + 0.5) / WIDTH;
        const lmb_vec3 direction = {(float)(-sin(polar) * cos(turn)), (float)cos(polar),
                                    (float)(-sin(polar) * sin(turn))};
        for (int c = 0; c < 3; ++c) {
            pixel[c][i] = lmb_sh3_evaluate(&sky->channel[c], direction);
            darkest = fminf(darkest, pixel[c][i]);
        }
    }
    CHECK(darkest > 0.0f, "the test's sky is light");
    const lmb_exr_channel channels[3] = {{"B", pixel[2]}, {"G", pixel[1]}, {"R", pixel[0]}};
    lmb_error error = {{0}};
    const bool written =
        lmb_exr_write(path, &(lmb_exr_picture){WIDTH, HEIGHT, channels, 3, NULL, 0}, NULL, &error) == LMB_OK;
    CHECK(written, "%s", error.message);
    return written;
}

/* A white floor with a wall on it, and a red one. */
static bool level_write(const char *path)
{
    lmb_level_builder *const builder = floor_begin(0.8f, 10);
    lmb_level_material red = lmb_level_material_default();
    red.base_color = (lmb_rgb){{0.8f, 0.2f, 0.1f}};
    const int mesh = lmb_level_builder_add_mesh(builder, "wall");
    const lmb_level_box box =
        lmb_level_box_of((lmb_vec3){1, 0, -3}, (lmb_vec3){1.2f, 3, 3}, lmb_level_builder_add_material(builder, &red));
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_builder_place(builder, "wall", mesh, (lmb_vec3){0, 0, 0});
    lmb_error error = {{0}};
    const lmb_result result = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static bool light_under(const char *environment, lmb_sh3_rgb *light)
{
    lmb_level_settings settings = lmb_level_settings_default();
    settings.path = OUTPUT("level.glb");
    settings.environment = environment;
    settings.key_lights = 0;
    settings.threads = 1;
    lmb_error error = {{0}};
    lmb_level level;
    lmb_result result = lmb_level_open(&settings, NULL, NULL, &level, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    if (result != LMB_OK) {
        return false;
    }
    result = lmb_level_solve(&level, LMB_ESTIMATOR_CACHED, NULL, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    const lmb_gather_point point = {.position = {0.3f, 0.7f, 0.2f}};
    lmb_gathered gathered = {0};
    lmb_gather_sh3(&level.transport, &point, 8192, &gathered);
    *light = gathered.moments;
    lmb_level_close(&level);
    return result == LMB_OK;
}

/* Light beside a red wall under a sky, made of that under the basis, is that under the sky itself. */
static void light_is_the_sum(void)
{
    const lmb_sh3_rgb sky = some_sky();
    lmb_rgb weight[LMB_SKY_QUADRATIC];
    lmb_sh3_rgb truth, made = {0};
    lmb_sky_weights(&sky, LMB_SKY_QUADRATIC, weight);
    if (!level_write(OUTPUT("level.glb")) || !picture_write(&sky, OUTPUT("sky.exr")) ||
        !light_under(OUTPUT("sky.exr"), &truth)) {
        return;
    }
    for (int k = 0; k < LMB_SKY_QUADRATIC; ++k) {
        char text[32];
        lmb_sh3_rgb part;
        snprintf(text, sizeof text, "sky-basis:%d", k);
        if (!light_under(text, &part)) {
            return;
        }
        for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
            made.channel[i % 3].c[i / 3] += weight[k].c[i % 3] * part.channel[i % 3].c[i / 3];
        }
    }
    for (int c = 0; c < 3; ++c) {
        const double size = (double)truth.channel[c].c[0];
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            CHECK_NEAR(made.channel[c].c[i], truth.channel[c].c[i], 0.01 * size, "channel %d, coefficient %d", c, i);
        }
    }
}

/* Each colour by its own weight, also by less than nothing. */
static void volumes_blend_in_colour(void)
{
    const lmb_scene scene = {.bounds_min = {-2, -2, -2}, .bounds_max = {2, 2, 2}};
    constant_volume one, two;
    if (!constant_volume_make(&scene, (lmb_rgb){{1.0f, 0.5f, 0.25f}}, &one)) {
        return;
    }
    if (constant_volume_make(&scene, (lmb_rgb){{0.5f, 2.0f, 4.0f}}, &two)) {
        const lmb_volume *const volumes[2] = {one.volume, two.volume};
        const lmb_rgb weights[2] = {{{3.0f, 2.0f, 0.0f}}, {{-1.0f, 0.5f, 1.0f}}};
        static const double expected[3] = {2.5, 2.0, 4.0};
        lmb_sh3_rgb light;
        CHECK(lmb_volume_blend_rgb(volumes, weights, 2, (lmb_vec3d){0.3, 0.2, 0.1}, &light), "inside of both");
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(light.channel[c].c[0], expected[c] * 2.0 * sqrt(PI), 1e-2, "channel %d", c);
        }
        CHECK(!lmb_volume_blend_rgb(volumes, weights, 2, (lmb_vec3d){99.0, 0.0, 0.0}, &light), "outside");
        CHECK(!lmb_volume_blend_rgb(volumes, weights, 0, (lmb_vec3d){0.0, 0.0, 0.0}, &light), "no volume");
        CHECK(light.channel[1].c[0] == 0.0f, "no light");
        constant_volume_close(&two);
    }
    constant_volume_close(&one);
}

static const test_case cases[] = {
    {"weights make the sky", weights_make_the_sky},
    {"pictures are the basis", pictures_are_the_basis},
    {"light is the sum", light_is_the_sum},
    {"volumes blend in colour", volumes_blend_in_colour},
};

TEST_MAIN(cases)
