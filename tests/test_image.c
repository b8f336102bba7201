/* Reading and writing pictures. Oracles: stb_image for .hdr, OpenEXR's exrheader for what we write, numbers that
 * OpenImageIO and numpy gave for real environments, and files made byte by byte here. */
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include <OpenEXR/ImfCRgbaFile.h>
#include <OpenEXR/openexr.h>
#include <stb_image.h>

#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/image.h>

#include "harness.h"

#define OUT(name) LMB_TEST_OUTPUT_DIR "/image_" name
#define DATA(name) LMB_DATA_DIR "/" name

static bool is_there(const char *path)
{
    return access(path, R_OK) == 0;
}

static lmb_result bytes_read(const void *bytes, size_t size, lmb_image *image, lmb_error *error)
{
    FILE *const file = fopen(OUT("bytes"), "wb"); /* not lmb_file_write: thousands of fsync() take their time */
    CHECK(file && fwrite(bytes, 1, size, file) == size, "cannot write the test's file");
    if (file) {
        fclose(file);
    }
    return lmb_image_read(OUT("bytes"), image, NULL, NULL, error);
}

#define HDR "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"

static void small_hdr_has_its_values(void)
{
    /* 1 x 2 flat: (128, 64, 0) 2^(129 - 136), then exponent 0 = black. */
    static const char FLAT[] = HDR "-Y 2 +X 1\n\x80\x40\x00\x81\xff\xff\xff\x00";
    /* 8 x 1 run length coded: red 10 x 8, green 1..8, blue 0, exponent 136: the mantissas themselves. */
    static const char RUNS[] = HDR "-Y 1 +X 8\n\x02\x02\x00\x08\x88\x0a\x08\x01\x02\x03\x04\x05\x06\x07\x08\x88\x00"
                                   "\x88\x88";
    lmb_image image;
    lmb_error error = {""};
    CHECK(bytes_read(FLAT, sizeof FLAT - 1, &image, &error) == LMB_OK, "%s", error.message);
    if (error.message[0] == '\0') {
        CHECK(image.width == 1 && image.height == 2, "%d x %d", image.width, image.height);
        static const float EXPECTED[6] = {1.0f, 0.5f, 0.0f, 0.0f, 0.0f, 0.0f};
        CHECK(memcmp(image.rgb, EXPECTED, sizeof EXPECTED) == 0, "flat values");
        lmb_image_free(&image);
    }
    CHECK(bytes_read(RUNS, sizeof RUNS - 1, &image, &error) == LMB_OK, "%s", error.message);
    if (error.message[0] == '\0') {
        for (int x = 0; x < 8; ++x) {
            CHECK(image.rgb[3 * x] == 10.0f && image.rgb[3 * x + 1] == (float)(x + 1) && image.rgb[3 * x + 2] == 0.0f,
                  "column %d", x);
        }
        lmb_image_free(&image);
    }
}

/* A picture of 3 x 2 whose red is 1 .. 6 from left to right and top to bottom, in each order that a file can have:
 * X grows to the right, Y upwards, and the axis named first changes from scanline to scanline. */
static void hdr_of_every_pixel_order_is_read(void)
{
    static const struct {
        const char *size;
        unsigned char red[6]; /* as they follow each other in the file */
    } cases[] = {
        {"-Y 2 +X 3", {1, 2, 3, 4, 5, 6}}, {"-Y 2 -X 3", {3, 2, 1, 6, 5, 4}}, {"+Y 2 +X 3", {4, 5, 6, 1, 2, 3}},
        {"+Y 2 -X 3", {6, 5, 4, 3, 2, 1}}, {"+X 3 -Y 2", {1, 4, 2, 5, 3, 6}}, {"+X 3 +Y 2", {4, 1, 5, 2, 6, 3}},
        {"-X 3 -Y 2", {3, 6, 2, 5, 1, 4}}, {"-X 3 +Y 2", {6, 3, 5, 2, 4, 1}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        unsigned char bytes[128];
        size_t size = (size_t)snprintf((char *)bytes, sizeof bytes, HDR "%s\n", cases[i].size);
        for (int k = 0; k < 6; ++k) {
            memcpy(bytes + size, (const unsigned char[4]){cases[i].red[k], 0, 0, 136}, 4); /* the mantissa itself */
            size += 4;
        }
        lmb_image image;
        lmb_error error = {""};
        if (bytes_read(bytes, size, &image, &error) != LMB_OK) {
            CHECK(false, "%s: %s", cases[i].size, error.message);
            continue;
        }
        CHECK(image.width == 3 && image.height == 2, "%s: %d x %d", cases[i].size, image.width, image.height);
        for (int k = 0; k < 6; ++k) {
            CHECK_NEAR(image.rgb[3 * k], k + 1, 0.0, "%s: pixel %d", cases[i].size, k);
        }
        lmb_image_free(&image);
    }
}

static void bad_hdr_is_refused(void)
{
#define LONG_PIXELS "\x02\x02\x00\x08\x88\x0a\x88\x0a\x88\x0a\x88\x0a"
    static const struct {
        const char *what;
        const char *bytes;
        size_t size;
        lmb_result result;
        const char *reason; /* part of the message */
    } cases[] = {
#define CASE(what, bytes, result, reason) {what, bytes, sizeof bytes - 1, result, reason}
        CASE("empty", "", LMB_ERROR_FORMAT, "neither"),
        CASE("png", "\x89PNG\r\n\x1a\n", LMB_ERROR_FORMAT, "neither"),
        CASE("signature only", "#?RADIANCE", LMB_ERROR_FORMAT, "header"),
        CASE("no size", HDR, LMB_ERROR_FORMAT, "header"),
        CASE("bad size", HDR "-Y 2 +X\n", LMB_ERROR_FORMAT, "no picture size"),
        CASE("zero width", HDR "-Y 2 +X 0\n", LMB_ERROR_FORMAT, "no picture size"),
        CASE("negative height", HDR "-Y -2 +X 3\n", LMB_ERROR_FORMAT, "no picture size"),
        CASE("more after the size", HDR "-Y 1 +X 1 2\n\x80\x40\x00\x81", LMB_ERROR_FORMAT, "no picture size"),
        CASE("absurd size", HDR "-Y 99999999 +X 99999999\n", LMB_ERROR_UNSUPPORTED, "too many"),
        CASE("absurd product", HDR "-Y 60000 +X 60000\n", LMB_ERROR_UNSUPPORTED, "too many"),
        CASE("long number", HDR "-Y 1 +X 99999999999999999999\n", LMB_ERROR_FORMAT, "no picture size"),
        CASE("gigabytes from nothing", HDR "-Y 16000 +X 16000\n", LMB_ERROR_FORMAT, "too short"),
        CASE("one axis twice", HDR "-Y 1 +Y 1\n\x80\x40\x00\x81", LMB_ERROR_FORMAT, "no picture size"),
        CASE("no sign", HDR "Y 1 X 1\n\x80\x40\x00\x81", LMB_ERROR_FORMAT, "no picture size"),
        CASE("columns cut", HDR "+X 2 -Y 1\n\x80\x40\x00\x81\x80", LMB_ERROR_FORMAT, "too short"),
        CASE("run past the column", HDR "-X 1 +Y 8\n\x02\x02\x00\x08\x89\x0a\x88\x0a\x88\x0a\x88\x0a", LMB_ERROR_FORMAT,
             "column 0 has a bad run"),
        CASE("XYZE", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x80\x40\x00\x81", LMB_ERROR_UNSUPPORTED,
             "32-bit_rle_xyze"),
        CASE("flat cut", HDR "-Y 2 +X 1\n\x80\x40\x00\x81\x80", LMB_ERROR_FORMAT, "too short"),
        CASE("row of another width", HDR "-Y 1 +X 9\n" LONG_PIXELS, LMB_ERROR_FORMAT, "row 0"),
        CASE("run past the row", HDR "-Y 1 +X 8\n\x02\x02\x00\x08\x89\x0a\x88\x0a\x88\x0a\x88\x0a", LMB_ERROR_FORMAT,
             "row 0 has a bad run"),
        CASE("run of nothing", HDR "-Y 1 +X 8\n\x02\x02\x00\x08\x00\x0a\x88\x0a\x88\x0a\x88\x0a", LMB_ERROR_FORMAT,
             "row 0 has a bad run"),
        CASE("literals past the end", HDR "-Y 1 +X 8\n\x02\x02\x00\x08\x88\x0a\x88\x0a\x88\x0a\x08\x0a",
             LMB_ERROR_FORMAT, "ends in row 0"),
        CASE("second row missing", HDR "-Y 2 +X 8\n" LONG_PIXELS, LMB_ERROR_FORMAT, "too short"),
        CASE("old runs", HDR "-Y 1 +X 2\n\x80\x40\x00\x81\x01\x01\x01\x01", LMB_ERROR_UNSUPPORTED, "old run-length"),
#undef CASE
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_image image = {7, 7, NULL};
        lmb_error error = {""};
        const lmb_result result = bytes_read(cases[i].bytes, cases[i].size, &image, &error);
        CHECK(result == cases[i].result, "%s: result %d, %s", cases[i].what, (int)result, error.message);
        CHECK(strstr(error.message, cases[i].reason) && strstr(error.message, "image_bytes"), "%s: %s", cases[i].what,
              error.message);
        CHECK(image.width == 7 && !image.rgb, "%s: output touched", cases[i].what);
        if (result == LMB_OK) {
            lmb_image_free(&image);
        }
    }
    lmb_image image;
    lmb_error error = {""};
    CHECK(lmb_image_read(OUT("no such file"), &image, NULL, NULL, &error) == LMB_ERROR_IO, "%s", error.message);
    CHECK(strstr(error.message, "no such file"), "%s", error.message);
}

static void hdr_agrees_with_stb(void)
{
    static const char *const names[] = {"tiny/simple-rle.hdr",
                                        "tiny/venice_sunset_256.hdr",
                                        "autumn_field_puresky_1k.hdr",
                                        "evening_road_01_puresky_1k.hdr",
                                        "lobby.hdr",
                                        "night.hdr",
                                        "spiaggia_di_mondello_1k.hdr",
                                        "sunset.hdr"};
    if (!is_there(DATA("envmaps/sunset.hdr"))) {
        test_skip("no environment maps here");
        return;
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char path[1024];
        snprintf(path, sizeof path, DATA("envmaps/%s"), names[i]);
        lmb_image image;
        lmb_error error = {""};
        lmb_latlong_axes axes = LMB_LATLONG_OPENEXR;
        size_t bad = 99;
        if (lmb_image_read(path, &image, &axes, &bad, &error) != LMB_OK) {
            CHECK(false, "%s", error.message);
            continue;
        }
        int width = 0;
        int height = 0;
        int channels = 0;
        float *const expected = stbi_loadf(path, &width, &height, &channels, 3);
        CHECK(expected && width == image.width && height == image.height && bad == 0 && axes == LMB_LATLONG_GLTF,
              "%s: %d x %d, %zu bad", names[i], image.width, image.height, bad);
        if (expected && width == image.width && height == image.height) {
            const size_t size = 3 * sizeof(float) * (size_t)width * (size_t)height;
            CHECK(memcmp(expected, image.rgb, size) == 0, "%s: pixels differ from stb_image's", names[i]);
        }
        stbi_image_free(expected);
        lmb_image_free(&image);
    }
}

/* Mean radiance over the sphere, each row weighted by its solid angle. */
static void mean_over_sphere(const lmb_image *image, double mean[3])
{
    const double pi = 3.14159265358979323846;
    mean[0] = mean[1] = mean[2] = 0.0;
    for (int y = 0; y < image->height; ++y) {
        const double weight = 0.5 * (cos(pi * y / image->height) - cos(pi * (y + 1) / image->height)) / image->width;
        for (int x = 0; x < image->width; ++x) {
            for (int c = 0; c < 3; ++c) {
                mean[c] += weight * (double)image->rgb[3 * ((size_t)y * (size_t)image->width + (size_t)x) + (size_t)c];
            }
        }
    }
}

/* data/references/env_sh.json: `mean` of the file, by OpenImageIO and numpy. */
static bool reference_mean(const char *json, const char *name, double mean[3])
{
    const char *at = strstr(json, name);
    at = at ? strstr(at, "\"mean\"") : NULL;
    at = at ? strchr(at, '[') : NULL;
    return at && sscanf(at, "[ %lf , %lf , %lf", &mean[0], &mean[1], &mean[2]) == 3;
}

static void environments_have_the_published_mean(void)
{
    static const char *const names[] = {"openexr/OrientationLatLong.exr",
                                        "openexr/WavyLinesLatLong.exr",
                                        "blender_dwab/courtyard.exr",
                                        "lobby.hdr",
                                        "night.hdr",
                                        "tiny/venice_sunset_256.hdr"};
    unsigned char *json = NULL;
    size_t size = 0;
    if (lmb_file_read(DATA("references/env_sh.json"), &json, &size, NULL) != LMB_OK) {
        test_skip("no reference numbers here");
        return;
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char path[1024];
        snprintf(path, sizeof path, DATA("envmaps/%s"), names[i]);
        const char *const base = strrchr(path, '/') + 1;
        double expected[3];
        double actual[3];
        lmb_image image;
        lmb_latlong_axes axes;
        lmb_error error = {""};
        if (!reference_mean((const char *)json, base, expected) ||
            lmb_image_read(path, &image, &axes, NULL, &error) != LMB_OK) {
            CHECK(false, "%s: no reference or picture: %s", base, error.message);
            continue;
        }
        CHECK((axes == LMB_LATLONG_OPENEXR) == (strstr(base, "LatLong.exr") != NULL), "%s: axes", base);
        mean_over_sphere(&image, actual);
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(actual[c], expected[c], 2e-4 * fabs(expected[c]), "%s channel %d", base, c);
        }
        lmb_image_free(&image);
    }
    free(json);
}

/* Deterministic, without the library's own generator. */
static float pattern(int channel, int x, int y)
{
    return ldexpf((float)((x * 37 + y * 101 + channel * 53) % 1021 - 510), (x + y + channel) % 9 - 6);
}

static void exr_round_trip_is_exact(void)
{
    enum { WIDTH = 37, HEIGHT = 41, COUNT = 3 };
    static float planes[COUNT][WIDTH * HEIGHT];
    for (int k = 0; k < COUNT; ++k) {
        for (int i = 0; i < WIDTH * HEIGHT; ++i) {
            planes[k][i] = pattern(k, i % WIDTH, i / WIDTH); /* at most 10 bits: exact in fp16 */
        }
    }
    const lmb_exr_channel channels[COUNT] = {{"iz.R", planes[0]}, {"w", planes[1]}, {"dir.X", planes[2]}};
    const lmb_exr_attribute attributes[] = {{"lambent:scale", NULL, 0.25f}, {"lambent:encoding", "hhd", 0.0f}};
    size_t overflows = 99;
    lmb_error error = {""};
    lmb_result result = lmb_exr_write(
        OUT("round.exr"), &(lmb_exr_picture){WIDTH, HEIGHT, channels, COUNT, attributes, 2}, &overflows, &error);
    CHECK(result == LMB_OK && overflows == 0, "%s, %zu overflows", error.message, overflows);
    static const char *const names[] = {"dir.X", "iz.R", "w"};
    static const int plane_of[] = {2, 0, 1};
    float *values[3] = {NULL, NULL, NULL};
    lmb_exr_header header = {0, 0, 0.0f};
    result = lmb_exr_read_channels(OUT("round.exr"), names, 3, values, &header, &error);
    CHECK(result == LMB_OK && header.width == WIDTH && header.height == HEIGHT && header.scale == 0.25f, "%s",
          error.message);
    for (int i = 0; i < 3 && result == LMB_OK; ++i) {
        CHECK(memcmp(values[i], planes[plane_of[i]], sizeof planes[0]) == 0, "channel %s", names[i]);
        free(values[i]);
    }
    const char *const missing[] = {"w", "nothing"};
    float *untouched[2] = {NULL, NULL};
    result = lmb_exr_read_channels(OUT("round.exr"), missing, 2, untouched, &header, &error);
    CHECK(result == LMB_ERROR_FORMAT && strstr(error.message, "'nothing'") && !untouched[0], "%s", error.message);

    unsigned char *first = NULL;
    unsigned char *second = NULL;
    size_t first_size = 0;
    size_t second_size = 0;
    CHECK(lmb_exr_write(OUT("round2.exr"), &(lmb_exr_picture){WIDTH, HEIGHT, channels, COUNT, attributes, 2}, NULL,
                        &error) == LMB_OK,
          "%s", error.message);
    lmb_file_read(OUT("round.exr"), &first, &first_size, &error);
    lmb_file_read(OUT("round2.exr"), &second, &second_size, &error);
    CHECK(first && second && first_size == second_size && memcmp(first, second, first_size) == 0, "bytes repeat");
    free(first);
    free(second);
}

/* Files of 128 values, zeros and noise: some of them compress to exactly their own length. */
static void small_files_come_back(void)
{
    enum { SIDE = 8, COUNT = SIDE * SIDE, FILES = 300 };
    uint32_t seed = 1;
    int wrong = 0;
    for (int file = 0; file < FILES; ++file) {
        float first[COUNT], second[COUNT];
        for (int i = 0; i < COUNT; ++i) {
            float *const pair[2] = {first, second};
            for (int k = 0; k < 2; ++k) {
                seed = seed * 1664525u + 1013904223u;
                pair[k][i] = (int)(seed >> 24) < file % 100 ? 0.0f : (float)(seed >> 21 & 2047u) / 1024.0f;
            }
        }
        const lmb_exr_channel channels[2] = {{"A", first}, {"B", second}};
        const char *const names[2] = {"A", "B"};
        float *values[2] = {NULL, NULL};
        lmb_exr_header header;
        lmb_error error = {""};
        if (lmb_exr_write(OUT("small.exr"), &(lmb_exr_picture){SIDE, SIDE, channels, 2, NULL, 0}, NULL, &error) !=
                LMB_OK ||
            lmb_exr_read_channels(OUT("small.exr"), names, 2, values, &header, &error) != LMB_OK) {
            CHECK(false, "file %d: %s", file, error.message);
            return;
        }
        wrong += memcmp(first, values[0], sizeof first) != 0 || memcmp(second, values[1], sizeof second) != 0;
        free(values[0]);
        free(values[1]);
    }
    CHECK(wrong == 0, "%d of %d files", wrong, FILES);
}

static void exrheader_reads_what_we_write(void)
{
    const float pixels[6] = {1, 2, 3, 4, 5, 6};
    const lmb_exr_channel channels[] = {{"R", pixels}, {"B", pixels}, {"G", pixels}};
    const lmb_exr_attribute attributes[] = {{"lambent:scale", NULL, 4.0f}, {"lambent:encoding", "sh2", 0.0f}};
    lmb_error error = {""};
    CHECK(lmb_exr_write(OUT("header.exr"), &(lmb_exr_picture){3, 2, channels, 3, attributes, 2}, NULL, &error) ==
              LMB_OK,
          "%s", error.message);
    if (system("command -v exrheader >/dev/null 2>&1") != 0) {
        test_skip("exrheader is not installed");
        return;
    }
    FILE *const pipe = popen("exrheader " OUT("header.exr") " 2>&1", "r");
    char text[8192];
    const size_t length = pipe ? fread(text, 1, sizeof text - 1, pipe) : 0;
    text[length] = '\0';
    CHECK(pipe && pclose(pipe) == 0, "exrheader fails: %s", text);
    static const char *const lines[] = {
        "B, 16-bit floating-point, sampling 1 1\n    G, 16-bit floating-point, sampling 1 1"
        "\n    R, 16-bit floating-point, sampling 1 1",
        "zip, multi-scanline blocks",
        "dataWindow (type box2i): (0 0) - (2 1)",
        "lambent:scale (type float): 4",
        "lambent:encoding (type string): \"sh2\"",
        "scanlineimage"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i) {
        CHECK(strstr(text, lines[i]), "'%s' is not in:\n%s", lines[i], text);
    }
}

/* The nearest fp16 by search among all of them: ties to the even bit pattern. */
static double half_value(unsigned bits)
{
    const unsigned exponent = bits >> 10 & 31;
    const double mantissa = bits & 1023;
    const double size = exponent == 0 ? ldexp(mantissa, -24) : ldexp(mantissa + 1024, (int)exponent - 25);
    return bits & 0x8000 ? -size : size;
}

static double half_nearest(double value)
{
    unsigned low = 0;
    unsigned high = 0x7bff;
    const double size = fabs(value);
    while (high - low > 1) {
        const unsigned middle = (low + high) / 2;
        if (half_value(middle) <= size) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const double below = size - half_value(low);
    const double above = half_value(high) - size;
    const unsigned nearest = below < above || (below == above && low % 2 == 0) ? low : high;
    return copysign(half_value(nearest), value);
}

static void exr_values_are_rounded_and_clamped(void)
{
    const float values[] = {0.1f,     -0.1f,   1e-8f,    3e-8f,  2.98023224e-8f, 6e-5f,    6.1035e-5f,
                            65504.0f, 65505.f, -65519.f, 1e30f,  -1e30f,         INFINITY, -0.0f,
                            2049.0f,  2051.0f, 1.0f / 3, 1e-45f, 999.9f,         6.10e-5f};
    enum { COUNT = sizeof values / sizeof values[0] };
    const lmb_exr_channel channel = {"Y", values};
    size_t overflows = 0;
    lmb_error error = {""};
    CHECK(lmb_exr_write(OUT("half.exr"), &(lmb_exr_picture){COUNT, 1, &channel, 1, NULL, 0}, &overflows, &error) ==
              LMB_OK,
          "%s", error.message);
    CHECK(overflows == 5, "%zu overflows", overflows);
    const char *const name = "Y";
    float *read = NULL;
    lmb_exr_header header = {0, 0, 0.0f};
    if (lmb_exr_read_channels(OUT("half.exr"), &name, 1, &read, &header, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        return;
    }
    CHECK(header.scale == 1.0f, "no attribute: scale %g", (double)header.scale);
    for (int i = 0; i < COUNT; ++i) {
        const double clamped = fmax(-65504.0, fmin(65504.0, (double)values[i]));
        CHECK((double)read[i] == half_nearest(clamped), "%.9g came back as %.9g", (double)values[i], (double)read[i]);
    }
    free(read);

    lmb_image image;
    size_t bad = 0;
    CHECK(lmb_image_read(OUT("half.exr"), &image, NULL, &bad, &error) == LMB_OK, "%s", error.message);
    CHECK(bad == 3, "%zu negative pixels", bad);
    CHECK(image.rgb[3] == 0.0f && image.rgb[0] == image.rgb[2] && image.rgb[0] > 0.0f, "Y three times, negatives 0");
    lmb_image_free(&image);

    const float wrong[] = {1.0f, NAN};
    const lmb_exr_channel bad_channel = {"w", wrong};
    CHECK(lmb_exr_write(OUT("nan.exr"), &(lmb_exr_picture){2, 1, &bad_channel, 1, NULL, 0}, NULL, &error) ==
              LMB_ERROR_ARGUMENT,
          "NaN");
    CHECK(strstr(error.message, "'w'") && !is_there(OUT("nan.exr")), "%s", error.message);
    CHECK(lmb_exr_write(OUT("no/such/folder.exr"), &(lmb_exr_picture){1, 1, &channel, 1, NULL, 0}, NULL, &error) ==
              LMB_ERROR_WRITE,
          "folder");
}

enum { ODD_WIDTH = 46, ODD_HEIGHT = 70 };
static uint32_t odd_red[ODD_WIDTH * ODD_HEIGHT];
static uint16_t odd_green[ODD_WIDTH * ODD_HEIGHT];
static float odd_blue[ODD_WIDTH * ODD_HEIGHT];

static void odd_picture_make(void)
{
    for (uint32_t i = 0; i < ODD_WIDTH * ODD_HEIGHT; ++i) {
        odd_red[i] = i * 5 % 4093;
        odd_green[i] = (uint16_t)(0x3c00 + (i % 1024 < 512 ? i % 1024 : 1023 - i % 1024)); /* 1 .. 1.5 */
        odd_blue[i] = 0.25f * (float)(i % 1000); /* survives PXR24's 24 bits */
    }
}

typedef struct odd_layout {
    exr_compression_t compression;
    bool tiled;
    exr_envmap_t envmap; /* EXR_ENVMAP_LAST_TYPE: no such attribute */
    int sampling;        /* of R, in x and y */
} odd_layout;

/* The odd picture's R (uint), G (half), B (float) in any layout that the library can write, with its own packing. */
static bool odd_picture_write(const char *path, odd_layout layout)
{
    exr_context_t context = NULL;
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    const int tile = 16;
    bool good = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &settings) == 0;
    good = good && exr_add_part(context, NULL, layout.tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, NULL) == 0;
    good = good && exr_initialize_required_attr_simple(context, 0, ODD_WIDTH, ODD_HEIGHT, layout.compression) == 0;
    good = good && exr_add_channel(context, 0, "R", EXR_PIXEL_UINT, EXR_PERCEPTUALLY_LINEAR, layout.sampling,
                                   layout.sampling) == 0;
    good = good && exr_add_channel(context, 0, "G", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LINEAR, 1, 1) == 0;
    good = good && exr_add_channel(context, 0, "B", EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1) == 0;
    if (layout.envmap != EXR_ENVMAP_LAST_TYPE) {
        good = good && exr_attr_set_envmap(context, 0, "envmap", layout.envmap) == 0;
    }
    if (layout.tiled) {
        good = good && exr_set_tile_descriptor(context, 0, 16, 16, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN) == 0;
    }
    good = good && exr_write_header(context) == 0;
    int32_t lines = tile;
    if (!layout.tiled) {
        good = good && exr_get_scanlines_per_chunk(context, 0, &lines) == 0;
    }
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    bool first = true;
    for (int y = 0; y < ODD_HEIGHT && good; y += lines) {
        for (int x = 0; x < ODD_WIDTH && good; x += layout.tiled ? tile : ODD_WIDTH) {
            exr_chunk_info_t chunk;
            good = (layout.tiled ? exr_write_tile_chunk_info(context, 0, x / tile, y / tile, 0, 0, &chunk)
                                 : exr_write_scanline_chunk_info(context, 0, y, &chunk)) == 0;
            good = good && (first ? exr_encoding_initialize(context, 0, &chunk, &encoder)
                                  : exr_encoding_update(context, 0, &chunk, &encoder)) == 0;
            const size_t at = (size_t)y * ODD_WIDTH + (size_t)x;
            for (int c = 0; c < 3 && good; ++c) { /* in the file's order: B, G, R */
                const void *const from[3] = {odd_blue + at, odd_green + at, odd_red + at};
                encoder.channels[c].encode_from_ptr = from[c];
                encoder.channels[c].user_pixel_stride = c == 1 ? 2 : 4;
                encoder.channels[c].user_line_stride = ODD_WIDTH * encoder.channels[c].user_pixel_stride;
            }
            good = good && (!first || exr_encoding_choose_default_routines(context, 0, &encoder) == 0);
            good = good && exr_encoding_run(context, 0, &encoder) == 0;
            first = false;
        }
    }
    exr_encoding_destroy(context, &encoder);
    return exr_finish(&context) == 0 && good;
}

static void every_layout_of_exr_is_read(void)
{
    static const char *const compressions[] = {"NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A"};
    odd_picture_make();
    for (int k = 0; k < 8; ++k) {
        for (int tiled = 0; tiled < 2; ++tiled) {
            const char *const path = OUT("layout.exr");
            const odd_layout layout = {(exr_compression_t)k, tiled, EXR_ENVMAP_LAST_TYPE, 1};
            if (!odd_picture_write(path, layout)) {
                CHECK(false, "the library does not write %s", compressions[k]);
                continue;
            }
            lmb_image image;
            lmb_error error = {""};
            if (lmb_image_read(path, &image, NULL, NULL, &error) != LMB_OK) {
                CHECK(false, "%s, tiled %d: %s", compressions[k], tiled, error.message);
                continue;
            }
            CHECK(image.width == ODD_WIDTH && image.height == ODD_HEIGHT, "%d x %d", image.width, image.height);
            int wrong = 0;
            const double green_error = k >= 6 ? 0.02 : 0.0; /* B44 is lossy for halfs */
            for (int i = 0; i < ODD_WIDTH * ODD_HEIGHT; ++i) {
                const float *const rgb = image.rgb + 3 * i;
                wrong += rgb[0] != (float)odd_red[i] || rgb[2] != odd_blue[i] ||
                         !(fabs((double)rgb[1] - half_value(odd_green[i])) <= green_error);
            }
            CHECK(wrong == 0, "%s, tiled %d: %d pixels are wrong", compressions[k], tiled, wrong);
            lmb_image_free(&image);
        }
    }
}

/* 64-bit LCG (Knuth's MMIX); only the high bits are used. */
static uint32_t random_next(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*state >> 33);
}

/* Half RGBA by OpenEXR's C++ library, through its C face: all compressions, DWA too, which the C library cannot write.
 * A smooth picture, for DWA loses what is not. */
enum { SMOOTH_WIDTH = 96, SMOOTH_HEIGHT = 300 }; /* more rows than a chunk of DWAB has */
static float smooth_value(int channel, int x, int y)
{
    return (float)(channel + 1) * (0.5f + (float)x / SMOOTH_WIDTH + 0.25f * (float)y / SMOOTH_HEIGHT);
}

static bool smooth_write(const char *path, int compression)
{
    static ImfRgba pixels[SMOOTH_WIDTH * SMOOTH_HEIGHT];
    for (int i = 0; i < SMOOTH_WIDTH * SMOOTH_HEIGHT; ++i) {
        ImfFloatToHalf(smooth_value(0, i % SMOOTH_WIDTH, i / SMOOTH_WIDTH), &pixels[i].r);
        ImfFloatToHalf(smooth_value(1, i % SMOOTH_WIDTH, i / SMOOTH_WIDTH), &pixels[i].g);
        ImfFloatToHalf(smooth_value(2, i % SMOOTH_WIDTH, i / SMOOTH_WIDTH), &pixels[i].b);
        ImfFloatToHalf(1.0f, &pixels[i].a);
    }
    ImfHeader *const header = ImfNewHeader();
    ImfHeaderSetDisplayWindow(header, -5, -7, SMOOTH_WIDTH - 6, SMOOTH_HEIGHT - 8);
    ImfHeaderSetDataWindow(header, -5, -7, SMOOTH_WIDTH - 6, SMOOTH_HEIGHT - 8);
    ImfHeaderSetCompression(header, compression);
    ImfOutputFile *const file = ImfOpenOutputFile(path, header, IMF_WRITE_RGBA);
    const ImfRgba *const origin = pixels + 7 * SMOOTH_WIDTH + 5;
    const bool good =
        file && ImfOutputSetFrameBuffer(file, origin, 1, SMOOTH_WIDTH) && ImfOutputWritePixels(file, SMOOTH_HEIGHT);
    ImfDeleteHeader(header);
    return file && ImfCloseOutputFile(file) && good;
}

static const char *const COMPRESSIONS[] = {"NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
enum { COMPRESSION_COUNT = sizeof COMPRESSIONS / sizeof COMPRESSIONS[0] };

static void every_compression_of_exr_is_read(void)
{
    for (int k = 0; k < COMPRESSION_COUNT; ++k) {
        lmb_image image;
        lmb_error error = {""};
        CHECK(smooth_write(OUT("smooth.exr"), k), "the library does not write %s", COMPRESSIONS[k]);
        if (lmb_image_read(OUT("smooth.exr"), &image, NULL, NULL, &error) != LMB_OK) {
            CHECK(false, "%s: %s", COMPRESSIONS[k], error.message);
            continue;
        }
        CHECK(image.width == SMOOTH_WIDTH && image.height == SMOOTH_HEIGHT, "%s", COMPRESSIONS[k]);
        double worst = 0.0;
        for (int i = 0; i < 3 * SMOOTH_WIDTH * SMOOTH_HEIGHT; ++i) {
            const double truth = (double)smooth_value(i % 3, i / 3 % SMOOTH_WIDTH, i / 3 / SMOOTH_WIDTH);
            worst = fmax(worst, fabs((double)image.rgb[i] - truth) / truth);
        }
        /* Half of fp16's step; B44 and DWA lose more. */
        CHECK(worst <= (k >= 6 ? 0.03 : 0x1p-11), "%s: off by %g of the value", COMPRESSIONS[k], worst);
        lmb_image_free(&image);
    }
}

/* Bytes from the middle of the file on are pixels: whatever is wrong with them is the file's fault. */
static void damaged_pixels_are_bad_input(void)
{
    uint64_t state = 777;
    for (int k = 0; k < COMPRESSION_COUNT; ++k) {
        unsigned char *bytes = NULL;
        size_t size = 0;
        CHECK(smooth_write(OUT("smooth.exr"), k), "the library does not write %s", COMPRESSIONS[k]);
        if (lmb_file_read(OUT("smooth.exr"), &bytes, &size, NULL) != LMB_OK) {
            CHECK(false, "%s", COMPRESSIONS[k]);
            continue;
        }
        int refused = 0;
        for (int i = 0; i < 90; ++i) {
            const bool cut = i < 30;
            const size_t length = cut ? size / 2 + random_next(&state) % (size - size / 2) : size;
            const size_t offset = size / 2 + random_next(&state) % (size - size / 2);
            const unsigned char saved = bytes[offset];
            bytes[offset] = cut ? saved : (unsigned char)random_next(&state);
            lmb_image image;
            lmb_error error = {""};
            const lmb_result result = bytes_read(bytes, length, &image, &error);
            bytes[offset] = saved;
            CHECK(result == LMB_ERROR_FORMAT || (result == LMB_OK && !cut),
                  "%s: %zu of %zu bytes, one wrong at %zu: %d, %s", COMPRESSIONS[k], length, size, offset, (int)result,
                  error.message);
            refused += result != LMB_OK;
            if (result == LMB_OK) {
                lmb_image_free(&image);
            }
        }
        CHECK(refused >= 30, "%s: %d refused", COMPRESSIONS[k], refused);
        free(bytes);
    }
}

static void layers_of_exr_are_read(void)
{
    static const float red[2] = {1.0f, 2.0f}, green[2] = {3.0f, 4.0f}, blue[2] = {5.0f, 6.0f}, other[2] = {7.0f, 8.0f};
    static const struct {
        const char *what;
        lmb_exr_channel channels[6];
        size_t count;
        const char *refused; /* part of the message; NULL: read as red, green, blue */
    } cases[] = {
        {"Blender's",
         {{"ViewLayer.Combined.R", red},
          {"ViewLayer.Combined.G", green},
          {"ViewLayer.Combined.B", blue},
          {"ViewLayer.Diffuse.R", other},
          {"ViewLayer.Diffuse.G", other},
          {"ViewLayer.Diffuse.B", other}},
         6,
         NULL},
        {"the first view layer",
         {{"Far.Combined.R", red},
          {"Far.Combined.G", green},
          {"Far.Combined.B", blue},
          {"Near.Combined.R", other},
          {"Near.Combined.G", other},
          {"Near.Combined.B", other}},
         6,
         NULL},
        {"the only one",
         {{"sky.R", red}, {"sky.G", green}, {"sky.B", blue}, {"sky.A", other}, {"depth.Z", other}},
         5,
         NULL},
        {"plain beside a layer",
         {{"R", red}, {"G", green}, {"B", blue}, {"a.R", other}, {"a.G", other}, {"a.B", other}},
         6,
         NULL},
        {"two that may be meant",
         {{"a.R", red}, {"a.G", green}, {"a.B", blue}, {"b.R", other}, {"b.G", other}, {"b.B", other}},
         6,
         "2 layers"},
        {"a layer without blue", {{"a.R", red}, {"a.G", green}, {"b.B", blue}}, 3, "neither channels"},
        {"almost Combined", {{"aCombined.R", red}, {"aCombined.G", green}, {"bCombined.R", other}}, 3, "neither"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_image image;
        lmb_error error = {""};
        CHECK(lmb_exr_write(OUT("layers.exr"), &(lmb_exr_picture){2, 1, cases[i].channels, cases[i].count, NULL, 0},
                            NULL, &error) == LMB_OK,
              "%s", error.message);
        const lmb_result result = lmb_image_read(OUT("layers.exr"), &image, NULL, NULL, &error);
        if (cases[i].refused) {
            CHECK(result == LMB_ERROR_UNSUPPORTED && strstr(error.message, cases[i].refused), "%s: %d, %s",
                  cases[i].what, (int)result, error.message);
            continue;
        }
        CHECK(result == LMB_OK, "%s: %s", cases[i].what, error.message);
        for (int k = 0; k < 6 && result == LMB_OK; ++k) {
            const float *const planes[3] = {red, green, blue};
            CHECK_NEAR(image.rgb[k], planes[k % 3][k / 3], 0.0, "%s: value %d", cases[i].what, k);
        }
        if (result == LMB_OK) {
            lmb_image_free(&image);
        }
    }
}

static void unsupported_exr_is_named(void)
{
    odd_picture_make();
    static const struct {
        const char *what;
        exr_envmap_t envmap;
        int sampling;
        const char *reason;
    } cases[] = {{"cube", EXR_ENVMAP_CUBE, 1, "cube-map"},
                 {"subsampled", EXR_ENVMAP_LAST_TYPE, 2, "'R' is subsampled"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_image image = {7, 7, NULL};
        lmb_error error = {""};
        const odd_layout layout = {EXR_COMPRESSION_ZIP, false, cases[i].envmap, cases[i].sampling};
        (void)odd_picture_write(OUT("odd.exr"), layout);
        CHECK(lmb_image_read(OUT("odd.exr"), &image, NULL, NULL, &error) == LMB_ERROR_UNSUPPORTED, "%s: %s",
              cases[i].what, error.message);
        CHECK(strstr(error.message, cases[i].reason), "%s: %s", cases[i].what, error.message);
        CHECK(image.width == 7, "output touched");
    }
    const float pixel = 1.0f;
    const lmb_exr_channel other = {"Z", &pixel};
    lmb_image image;
    lmb_error error = {""};
    CHECK(lmb_exr_write(OUT("odd.exr"), &(lmb_exr_picture){1, 1, &other, 1, NULL, 0}, NULL, &error) == LMB_OK, "%s",
          error.message);
    CHECK(lmb_image_read(OUT("odd.exr"), &image, NULL, NULL, &error) == LMB_ERROR_UNSUPPORTED &&
              strstr(error.message, "neither channels"),
          "%s", error.message);
}

/* Every file of the folder: read, or refused for a reason that names the file. */
static int folder_read(const char *folder, int *refused)
{
    DIR *const directory = opendir(folder);
    int count = 0;
    *refused = 0;
    for (const struct dirent *entry = directory ? readdir(directory) : NULL; entry; entry = readdir(directory)) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        const char *const dot = strrchr(entry->d_name, '.');
        if (!dot || (strcmp(dot, ".exr") != 0 && strcmp(dot, ".hdr") != 0)) {
            continue;
        }
        ++count;
        lmb_image image;
        lmb_error error = {""};
        size_t bad = 0;
        const lmb_result result = lmb_image_read(path, &image, NULL, &bad, &error);
        if (result == LMB_OK) {
            for (size_t i = 0; i < 3 * (size_t)image.width * (size_t)image.height; ++i) {
                if (!(image.rgb[i] >= 0.0f && image.rgb[i] < INFINITY)) {
                    CHECK(false, "%s: value %zu is %g", path, i, (double)image.rgb[i]);
                    break;
                }
            }
            lmb_image_free(&image);
        } else {
            ++*refused;
            CHECK(strstr(error.message, entry->d_name) && result == LMB_ERROR_UNSUPPORTED, "%d: %s", (int)result,
                  error.message);
        }
        printf("     %s: %s (%zu bad pixels)\n", entry->d_name, result == LMB_OK ? "read" : error.message, bad);
    }
    if (directory) {
        closedir(directory);
    }
    return count;
}

static void real_files_are_read_or_refused_by_name(void)
{
    static const struct {
        const char *folder;
        int count, refused;
    } cases[] = {{DATA("malformed/exr_odd"), 10, 1}, /* WideFloatRange: G alone */
                 {DATA("envmaps"), 6, 0},
                 {DATA("envmaps/tiny"), 2, 0},
                 {DATA("envmaps/openexr"), 3, 1}, /* the cube */
                 {DATA("envmaps/blender_dwab"), 1, 0}};
    if (!is_there(DATA("envmaps/openexr/OrientationCube.exr"))) {
        test_skip("no test data here");
        return;
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        int refused = 0;
        const int count = folder_read(cases[i].folder, &refused);
        CHECK(count == cases[i].count && refused == cases[i].refused, "%s: %d files, %d refused", cases[i].folder,
              count, refused);
    }
}

/* Reads what may be anything: must return, and leave nothing behind. */
static bool anything_read(const unsigned char *bytes, size_t size)
{
    lmb_image image;
    lmb_error error = {""};
    const lmb_result result = bytes_read(bytes, size, &image, &error);
    if (result == LMB_OK) {
        lmb_image_free(&image);
    } else {
        CHECK(error.message[0] != '\0', "result %d without a reason", (int)result);
    }
    return result == LMB_OK;
}

static void file_torture(const char *path, int cuts, int corruptions)
{
    unsigned char *bytes = NULL;
    size_t size = 0;
    if (lmb_file_read(path, &bytes, &size, NULL) != LMB_OK) {
        CHECK(false, "%s: cannot be read", path);
        return;
    }
    uint64_t state = 12345;
    for (int i = 0; i < cuts; ++i) {
        const size_t length = i < 64 ? (size_t)i * 8 % size : random_next(&state) % size;
        unsigned char *const copy = malloc(length > 0 ? length : 1);
        if (copy) {
            memcpy(copy, bytes, length);
            CHECK(!anything_read(copy, length), "%s: cut to %zu of %zu bytes and read", path, length, size);
        }
        free(copy);
    }
    for (int i = 0; i < corruptions; ++i) {
        unsigned char saved[4];
        size_t offset[4];
        for (int k = 0; k < 4; ++k) {
            offset[k] = random_next(&state) % (i % 2 == 0 && size > 400 ? 400 : size); /* half of them in the header */
            saved[k] = bytes[offset[k]];
            bytes[offset[k]] = (unsigned char)random_next(&state);
        }
        anything_read(bytes, size);
        for (int k = 3; k >= 0; --k) {
            bytes[offset[k]] = saved[k];
        }
    }
    free(bytes);
}

static void damaged_exr_does_no_harm(void)
{
    odd_picture_make();
    for (int k = 0; k < 8; ++k) {
        for (int tiled = 0; tiled < 2; ++tiled) {
            const odd_layout layout = {(exr_compression_t)k, tiled, EXR_ENVMAP_LATLONG, 1};
            (void)odd_picture_write(OUT("torture.exr"), layout);
            file_torture(OUT("torture.exr"), 80, 150);
        }
    }
    for (int k = 8; k < COMPRESSION_COUNT; ++k) {
        CHECK(smooth_write(OUT("torture.exr"), k), "the library does not write %s", COMPRESSIONS[k]);
        file_torture(OUT("torture.exr"), 60, 100);
    }
}

static void damaged_hdr_does_no_harm(void)
{
    if (!is_there(DATA("envmaps/tiny/venice_sunset_256.hdr"))) {
        test_skip("no environment maps here");
        return;
    }
    file_torture(DATA("envmaps/tiny/venice_sunset_256.hdr"), 200, 200);
    file_torture(DATA("envmaps/tiny/simple-rle.hdr"), 76, 500);
}

static void png_is_what_was_given(void)
{
    enum { WIDTH = 5, HEIGHT = 3 };
    uint8_t pixels[3 * WIDTH * HEIGHT];
    for (size_t i = 0; i < sizeof pixels; ++i) {
        pixels[i] = (uint8_t)(i * 29);
    }
    lmb_error error = {""};
    CHECK(lmb_png_write(OUT("out.png"), WIDTH, HEIGHT, pixels, &error) == LMB_OK, "%s", error.message);
    int width = 0;
    int height = 0;
    int channels = 0;
    stbi_uc *const read = stbi_load(OUT("out.png"), &width, &height, &channels, 0);
    CHECK(read && width == WIDTH && height == HEIGHT && channels == 3, "%d x %d x %d", width, height, channels);
    CHECK(read && memcmp(read, pixels, sizeof pixels) == 0, "pixels");
    stbi_image_free(read);
    CHECK(lmb_png_write(OUT("no/such/folder.png"), WIDTH, HEIGHT, pixels, &error) == LMB_ERROR_WRITE, "folder");
    CHECK(strstr(error.message, "folder.png"), "%s", error.message);
}

static const test_case CASES[] = {
    {"small hdr has its values", small_hdr_has_its_values},
    {"hdr of every pixel order is read", hdr_of_every_pixel_order_is_read},
    {"bad hdr is refused", bad_hdr_is_refused},
    {"hdr agrees with stb", hdr_agrees_with_stb},
    {"environments have the published mean", environments_have_the_published_mean},
    {"exr round trip is exact", exr_round_trip_is_exact},
    {"small files come back", small_files_come_back},
    {"exrheader reads what we write", exrheader_reads_what_we_write},
    {"exr values are rounded and clamped", exr_values_are_rounded_and_clamped},
    {"every layout of exr is read", every_layout_of_exr_is_read},
    {"every compression of exr is read", every_compression_of_exr_is_read},
    {"damaged pixels are bad input", damaged_pixels_are_bad_input},
    {"layers of exr are read", layers_of_exr_are_read},
    {"unsupported exr is named", unsupported_exr_is_named},
    {"real files are read or refused by name", real_files_are_read_or_refused_by_name},
    {"damaged exr does no harm", damaged_exr_does_no_harm},
    {"damaged hdr does no harm", damaged_hdr_does_no_harm},
    {"png is what was given", png_is_what_was_given},
};

TEST_MAIN(CASES)
