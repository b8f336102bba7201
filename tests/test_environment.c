/* Descriptions of environments: values, options, hash, refusals. */
#include <stdint.h>
#include <stdlib.h>

#include <lambent/environment.h>
#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/scene.h>

#include "harness.h"

#define OUT(name) LMB_TEST_OUTPUT_DIR "/environment_" name

static const float PIXELS[4 * 2] = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f};
static const double PI = 3.14159265358979323846;

static void pictures_write(void)
{
    const lmb_exr_channel grey = {"Y", PIXELS};
    static const char HDR[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x81\x10\x20\x80\x82";
    lmb_error error = {""};
    CHECK(lmb_exr_write(OUT("a,b.exr"), &(lmb_exr_picture){4, 2, &grey, 1, NULL, 0}, NULL, &error) == LMB_OK, "%s",
          error.message);
    CHECK(lmb_file_write(OUT("sky.hdr"), HDR, sizeof HDR - 1, &error) == LMB_OK, "%s", error.message);
}

static void constant_colours(void)
{
    static const struct {
        const char *text;
        double rgb[3];
        double rotation_deg, strength;
    } cases[] = {
        {"#ffffff", {1.0, 1.0, 1.0}, 0.0, 1.0},
        {"#000000", {0.0, 0.0, 0.0}, 0.0, 1.0},
        {"#FF8000", {1.0, 0.21586050011389926, 0.0}, 0.0, 1.0},
        {"#0a3bFf,strength=2.5", {0.0030352698354883752, 0.043735029256973465, 1.0}, 0.0, 2.5},
        {"#ffffff,strength=1e3,rotation=-90", {1.0, 1.0, 1.0}, -90.0, 1000.0},
        {"#ffffff,rotation=450,strength=0", {1.0, 1.0, 1.0}, 90.0, 0.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_scene scene = {0};
        lmb_error error = {""};
        CHECK(lmb_scene_set_environment(&scene, cases[i].text, &error) == LMB_OK, "%s: %s", cases[i].text,
              error.message);
        const lmb_environment *const e = &scene.environment;
        CHECK(e->present && !e->image.rgb, "%s", cases[i].text);
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(e->constant.c[c], cases[i].rgb[c], 1e-7, "%s channel %d", cases[i].text, c);
        }
        CHECK_NEAR(e->rotation_rad, cases[i].rotation_deg * PI / 180.0, 1e-6, "%s", cases[i].text);
        CHECK_NEAR(e->strength, cases[i].strength, 1e-6, "%s", cases[i].text);
    }
}

static void pictures_and_none(void)
{
    pictures_write();
    lmb_scene scene = {.content_hash = LMB_HASH_SEED};
    lmb_error error = {""};
    CHECK(lmb_scene_set_environment(&scene, OUT("a,b.exr") ",rotation=30", &error) == LMB_OK, "%s", error.message);
    const lmb_environment *const e = &scene.environment;
    CHECK(e->present && e->image.width == 4 && e->image.height == 2 && e->axes == LMB_LATLONG_GLTF, "exr");
    CHECK(e->image.rgb && e->image.rgb[3 * 5] == 6.0f && e->image.rgb[3 * 5 + 2] == 6.0f, "last pixel");
    CHECK_NEAR(e->rotation_rad, PI / 6.0, 1e-6, "rotation");

    /* The old picture is freed (AddressSanitizer would tell), the new one has the file's values. */
    CHECK(lmb_scene_set_environment(&scene, OUT("sky.hdr"), &error) == LMB_OK, "%s", error.message);
    CHECK(e->image.width == 2 && e->image.height == 1 && e->rotation_rad == 0.0f && e->strength == 1.0f, "hdr");
    CHECK(e->image.rgb && e->image.rgb[0] == 1.0f && e->image.rgb[5] == 2.0f, "values");

    const uint64_t hash = scene.content_hash;
    CHECK(lmb_scene_set_environment(&scene, OUT("sky.hdr") ",rotation=x", &error) == LMB_ERROR_FORMAT, "bad option");
    CHECK(e->image.width == 2 && e->image.rgb && scene.content_hash == hash, "a failure leaves the scene alone");

    CHECK(lmb_scene_set_environment(&scene, "none", &error) == LMB_OK, "%s", error.message);
    CHECK(!e->present && !e->image.rgb && scene.content_hash == hash, "none");
    lmb_image_free(&scene.environment.image);
}

static uint64_t hash_of(const char *text)
{
    lmb_scene scene = {.content_hash = LMB_HASH_SEED};
    lmb_error error = {""};
    CHECK(lmb_scene_set_environment(&scene, text, &error) == LMB_OK, "%s: %s", text, error.message);
    lmb_image_free(&scene.environment.image);
    return scene.content_hash;
}

static void hash_tells_environments_apart(void)
{
    pictures_write();
    static const char *const texts[] = {"none",
                                        "#ffffff",
                                        "#fffffe",
                                        "#ffffff,strength=2",
                                        "#ffffff,rotation=2",
                                        OUT("sky.hdr"),
                                        OUT("sky.hdr") ",rotation=90",
                                        OUT("sky.hdr") ",strength=90",
                                        OUT("a,b.exr")};
    enum { COUNT = sizeof texts / sizeof texts[0] };
    for (size_t i = 0; i < COUNT; ++i) {
        for (size_t j = 0; j < i; ++j) {
            CHECK(hash_of(texts[i]) != hash_of(texts[j]), "'%s' and '%s'", texts[i], texts[j]);
        }
    }
    CHECK(hash_of("#ffffff,strength=1.0") == hash_of("#ffffff,rotation=0"), "defaults spelt out are the same");
    CHECK(hash_of(OUT("sky.hdr") ",rotation=360") == hash_of(OUT("sky.hdr")), "a whole turn is none");
}

static void bad_descriptions_are_refused(void)
{
    static const struct {
        const char *text;
        lmb_result result;
        const char *reason;
    } cases[] = {
        {"", LMB_ERROR_FORMAT, "names no picture"},
        {",rotation=3", LMB_ERROR_FORMAT, "names no picture"},
        {"#fff", LMB_ERROR_FORMAT, "#rrggbb"},
        {"#12345g", LMB_ERROR_FORMAT, "#rrggbb"},
        {"#1234567", LMB_ERROR_FORMAT, "#rrggbb"},
        {"#ffffff,rotation=", LMB_ERROR_FORMAT, "rotation="},
        {"#ffffff,rotation=nan", LMB_ERROR_FORMAT, "rotation=nan"},
        {"#ffffff,strength=inf", LMB_ERROR_FORMAT, "strength=inf"},
        {"#ffffff,strength=-1", LMB_ERROR_FORMAT, "strength=-1"},
        {"#ffffff,strength=0x10", LMB_ERROR_FORMAT, "strength=0x10"},
        {"#ffffff,strength=1e999", LMB_ERROR_FORMAT, "strength=1e999"},
        {"#ffffff,strength= 1", LMB_ERROR_FORMAT, "strength= 1"},
        {"#ffffff,strength=1e", LMB_ERROR_FORMAT, "strength=1e"},
        {"#ffffff,strength=1,strength=1", LMB_ERROR_FORMAT, "twice"},
        {"#ffffff,exposure=1", LMB_ERROR_FORMAT, "exposure"},
        {OUT("nowhere.hdr"), LMB_ERROR_IO, "nowhere.hdr"},
        {LMB_TEST_OUTPUT_DIR, LMB_ERROR_IO, LMB_TEST_OUTPUT_DIR},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_scene scene = {.content_hash = 5};
        lmb_error error = {""};
        const lmb_result result = lmb_scene_set_environment(&scene, cases[i].text, &error);
        CHECK(result == cases[i].result && strstr(error.message, cases[i].reason), "'%s': %d, %s", cases[i].text,
              (int)result, error.message);
        CHECK(!scene.environment.present && scene.content_hash == 5, "'%s': scene touched", cases[i].text);
    }
}

/* Black pictures of a shape. */
static void only_equirectangular_shapes_are_taken(void)
{
    static const struct {
        int32_t width, height;
        const char *refused; /* part of the message; NULL: taken */
    } cases[] = {
        {2, 1, NULL},
        {4, 2, NULL},
        {1000, 500, NULL},
        {1001, 500, NULL}, /* an odd side */
        {1000, 501, NULL},
        {1024, 510, NULL}, /* within 1 % */
        {255, 128, NULL},
        {1024, 500, "twice as wide as high, not 1024 x 500"},
        {3, 2, "not 3 x 2"},
        {8, 2, "not 8 x 2"},
        {1, 1, "one face of a cube"},
        {256, 256, "1 : 1 is one face of a cube"},
        {256, 192, "4 : 3 is a horizontal cross"},
        {192, 256, "3 : 4 is a vertical cross"},
        {384, 64, "6 : 1 is a strip"},
        {64, 384, "1 : 6 is a strip"},
        {100, 200, "1 : 2"},
        {640, 360, "not 640 x 360"},
    };
    static float black[1024 * 1024];
    const lmb_exr_channel grey = {"Y", black};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_scene scene = {.content_hash = 5};
        lmb_error error = {""};
        CHECK(lmb_exr_write(OUT("shape.exr"), &(lmb_exr_picture){cases[i].width, cases[i].height, &grey, 1, NULL, 0},
                            NULL, &error) == LMB_OK,
              "%s", error.message);
        const lmb_result result = lmb_scene_set_environment(&scene, OUT("shape.exr"), &error);
        if (cases[i].refused) {
            CHECK(result == LMB_ERROR_UNSUPPORTED && strstr(error.message, cases[i].refused) &&
                      strstr(error.message, "shape.exr"),
                  "%d x %d: %d, %s", (int)cases[i].width, (int)cases[i].height, (int)result, error.message);
            CHECK(!scene.environment.present && scene.content_hash == 5, "scene touched");
        } else {
            CHECK(result == LMB_OK && scene.environment.image.width == cases[i].width, "%s", error.message);
        }
        lmb_image_free(&scene.environment.image);
    }
}

static const test_case CASES[] = {
    {"constant colours", constant_colours},
    {"pictures and none", pictures_and_none},
    {"hash tells environments apart", hash_tells_environments_apart},
    {"bad descriptions are refused", bad_descriptions_are_refused},
    {"only equirectangular shapes are taken", only_equirectangular_shapes_are_taken},
};

TEST_MAIN(CASES)
