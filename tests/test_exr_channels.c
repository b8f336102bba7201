/* Some of an EXR's channels: whichever are asked for come as they were written, of files with any number of others. */
#include <lambent/exr.h>
#include <lambent/image.h>

#include <stdlib.h>

#include "harness.h"

enum { WIDTH = 38, HEIGHT = 19, PIXELS = WIDTH * HEIGHT, MOST = 6 };
#define FILE_PATH LMB_TEST_OUTPUT_DIR "/exr_channels.exr"

static const char *const names[MOST] = {"A", "B", "G", "R", "Y", "Z"};
static float planes[MOST][PIXELS];

/* Halves hold whole numbers up to 2048. */
static float value_of(size_t channel, size_t pixel)
{
    return (float)(300 * channel + pixel % 256);
}

static bool file_make(size_t first, size_t count)
{
    lmb_exr_channel channels[MOST];
    for (size_t c = 0; c < count; ++c) {
        for (size_t i = 0; i < PIXELS; ++i) {
            planes[first + c][i] = value_of(first + c, i);
        }
        channels[c] = (lmb_exr_channel){names[first + c], planes[first + c]};
    }
    const lmb_exr_picture picture = {WIDTH, HEIGHT, channels, count, NULL, 0};
    lmb_error error = {""};
    const lmb_result result = lmb_exr_write(FILE_PATH, &picture, NULL, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

/* Reads those channels of the first `count` whose bit is set. */
static void subset_check(size_t count, unsigned subset)
{
    const char *wanted[MOST] = {NULL};
    size_t channel[MOST], wanted_count = 0;
    float *values[MOST];
    lmb_exr_header header;
    lmb_error error = {""};
    for (size_t c = 0; c < count; ++c) {
        if (subset >> c & 1u) {
            channel[wanted_count] = c;
            wanted[wanted_count++] = names[c];
        }
    }
    const lmb_result result = lmb_exr_read_channels(FILE_PATH, wanted, wanted_count, values, &header, &error);
    CHECK(result == LMB_OK, "%#x of %zu: %s", subset, count, error.message);
    for (size_t k = 0; k < wanted_count && result == LMB_OK; ++k) {
        size_t wrong = 0;
        for (size_t i = 0; i < PIXELS; ++i) {
            wrong += values[k][i] != value_of(channel[k], i);
        }
        CHECK(wrong == 0, "%#x of %zu: %zu pixels of '%s'", subset, count, wrong, wanted[k]);
        free(values[k]);
    }
}

static void any_of_any(void)
{
    for (size_t count = 1; count <= MOST; ++count) {
        if (file_make(0, count)) {
            for (unsigned subset = 1; subset < 1u << count; ++subset) {
                subset_check(count, subset);
            }
        }
    }
    remove(FILE_PATH);
}

/* A picture takes R, G and B, or Y, of whatever there is. */
static void pictures_take_their_own(void)
{
    static const struct {
        size_t first, count; /* of `names` */
        size_t rgb[3];
    } table[] = {
        {0, 4, {3, 2, 1}}, /* with alpha */
        {1, 3, {3, 2, 1}}, {0, 6, {3, 2, 1}}, {4, 1, {4, 4, 4}}, {3, 3, {4, 4, 4}}, {2, 4, {4, 4, 4}},
    };
    for (size_t t = 0; t < sizeof table / sizeof table[0]; ++t) {
        lmb_image image = {0, 0, NULL};
        lmb_error error = {""};
        const bool read = file_make(table[t].first, table[t].count) &&
                          lmb_image_read(FILE_PATH, &image, NULL, NULL, &error) == LMB_OK;
        CHECK(read, "row %zu: %s", t, error.message);
        size_t wrong = 0;
        for (size_t i = 0; read && i < (size_t)PIXELS * 3; ++i) {
            wrong += image.rgb[i] != value_of(table[t].rgb[i % 3], i / 3);
        }
        CHECK(wrong == 0, "row %zu: %zu values", t, wrong);
        lmb_image_free(&image);
    }
    remove(FILE_PATH);
}

static const test_case cases[] = {
    {"any channels of any number", any_of_any},
    {"pictures take their own", pictures_take_their_own},
};
TEST_MAIN(cases)
