/* Pictures of a plane through probes, whose levels and regions are known. */
#include "cut_fixture.h"
#include "folder_fixture.h"
#include "harness.h"
#include "probes_fixture.h"

#include "slices.h"

#define FOLDER LMB_TEST_OUTPUT_DIR "/slices"

static const uint8_t *pixel_at(const lmb_slice_pictures *pictures, int picture, double right, double down)
{
    const int32_t x = (int32_t)(right * pictures->width), y = (int32_t)(down * pictures->height);
    return &pictures->srgb[picture][3 * ((size_t)y * (size_t)pictures->width + (size_t)x)];
}

static bool same(const uint8_t *a, const uint8_t *b)
{
    return memcmp(a, b, 3) == 0;
}

/* From above, at y = 0.2: x from -2 to 2, z from 0 to 2. */
static void test_from_above(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    lmb_slice_pictures seen;
    CHECK(slice_draw(probes, &(lmb_slice){.axis = 1, .has_at = true, .at = 0.2}, &seen) == LMB_OK, "draw");
    CHECK(seen.at == 0.2 && seen.width == 4 * 96 && seen.height == 2 * 96, "%d x %d at %g", seen.width, seen.height,
          seen.at);
    const uint8_t *const fine = pixel_at(&seen, SLICE_LEVELS, 1.8 / 4.0, 0.6 / 2.0);
    const uint8_t *const coarse = pixel_at(&seen, SLICE_LEVELS, 2.5 / 4.0, 1.5 / 2.0);
    CHECK(!same(fine, coarse), "levels look alike");
    const uint8_t *const none = pixel_at(&seen, SLICE_LEVELS, 1.8 / 4.0, 1.7 / 2.0);
    CHECK(none[0] == 0 && none[1] == 0 && none[2] == 0, "a cell that is not there has a colour");
    CHECK(!same(fine, pixel_at(&seen, SLICE_LEVELS, 0.2 / 4.0, 0.2 / 2.0)), "a cut cell looks like a plain one");
    /* Region 0 and 1 of cell (-4, 0, 0), with x = 1/4 between them, and those of (-2, 0, 0) alike. */
    const uint8_t *const left = pixel_at(&seen, SLICE_REGIONS, 0.06 / 4.0, 0.2 / 2.0);
    const uint8_t *const right = pixel_at(&seen, SLICE_REGIONS, 0.3 / 4.0, 0.2 / 2.0);
    CHECK(!same(left, right), "regions look alike");
    CHECK(same(left, pixel_at(&seen, SLICE_REGIONS, 1.2 / 4.0, 0.2 / 2.0)) &&
              same(right, pixel_at(&seen, SLICE_REGIONS, 1.4 / 4.0, 0.2 / 2.0)),
          "regions of another cell");
    const uint8_t *const whole = pixel_at(&seen, SLICE_REGIONS, 0.7 / 4.0, 0.2 / 2.0);
    CHECK(whole[0] == whole[1] && whole[1] == whole[2], "a cell without planes has no colour");
    slice_free(&seen);
    lmb_probes_destroy(probes);
}

/* The probe that shows is the nearest corner's. */
static void test_validity(void)
{
    const lmb_lattice lattice = {.spacing = 2.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 3);
    for (int32_t probe = 0; probe < 8; ++probe) {
        probes->validity[probe] = (float)probe / 7.0f;
    }
    /* Seen along each axis: columns, rows from the top, and the plane's side pick the bits of the probe. */
    static const struct {
        lmb_slice slice;
        int probe[2][2]; /* [row][column] */
    } cases[] = {
        {{0, true, 0.1}, {{2, 6}, {0, 4}}}, {{0, true, 1.9}, {{3, 7}, {1, 5}}}, {{1, true, 0.1}, {{0, 1}, {4, 5}}},
        {{1, true, 1.9}, {{2, 3}, {6, 7}}}, {{2, true, 0.1}, {{2, 3}, {0, 1}}}, {{2, true, 1.9}, {{6, 7}, {4, 5}}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_slice_pictures seen;
        CHECK(slice_draw(probes, &cases[i].slice, &seen) == LMB_OK, "draw");
        for (int k = 0; k < 4; ++k) {
            const uint8_t *const pixel = pixel_at(&seen, SLICE_VALIDITY, 0.25 + 0.5 * (k % 2), 0.25 + 0.5 * (k / 2));
            const int expected = (int)lrint(255.0 * cases[i].probe[k / 2][k % 2] / 7.0);
            CHECK(pixel[0] == expected && pixel[1] == expected && pixel[2] == expected, "case %zu, %d: %d, not %d", i,
                  k, pixel[0], expected);
        }
        slice_free(&seen);
    }
    lmb_probes_destroy(probes);
}

/* Ghosts are blue; beside the volume all is black; light that is even is one grey. */
static void test_ghosts_and_light(void)
{
    lmb_probes *const probes = cut_fixture_probes();
    for (int32_t i = 0; i < probes->count * 27; ++i) {
        probes->radiance[0][i / 27].channel[i % 27 / 9].c[i % 9] = i % 9 == 0 ? 2.0f : 0.0f;
    }
    lmb_slice_pictures seen;
    CHECK(slice_draw(probes, &(lmb_slice){.axis = 1, .has_at = true, .at = 0.2}, &seen) == LMB_OK, "draw");
    const uint8_t *const ghost = pixel_at(&seen, SLICE_VALIDITY, 0.55 / 4.0, 0.05 / 2.0);
    const uint8_t *const probe = pixel_at(&seen, SLICE_VALIDITY, 2.05 / 4.0, 0.05 / 2.0);
    CHECK(ghost[2] > ghost[0] && probe[0] == 255 && probe[2] == 255, "%d %d, %d %d", ghost[0], ghost[2], probe[0],
          probe[2]);
    const uint8_t *const light = seen.srgb[SLICE_IRRADIANCE];
    bool even = light[0] > 60 && light[0] < 200;
    for (int32_t i = 0; i < 3 * seen.width * seen.height; ++i) {
        const int32_t x = i / 3 % seen.width, y = i / 3 / seen.width;
        const bool is_there = 4 * x / seen.width != 1 || 4 * y / seen.height != 3;
        even = even && (!is_there || light[i] == light[0]);
    }
    CHECK(even, "even light is not one grey, but %d", light[0]);
    CHECK(slice_write(&seen, FOLDER, NULL) == LMB_OK && folder_entry_count(FOLDER) == 4, "written");
    slice_free(&seen);
    CHECK(slice_draw(probes, &(lmb_slice){.axis = 1, .has_at = true, .at = 7.0}, &seen) == LMB_OK, "draw");
    bool black = true;
    for (int32_t i = 0; i < 3 * seen.width * seen.height; ++i) {
        black = black && seen.srgb[SLICE_LEVELS][i] == 0 && seen.srgb[SLICE_IRRADIANCE][i] == 0;
    }
    CHECK(black, "something is seen where no cell is");
    lmb_error error = {""};
    CHECK(slice_write(&seen, FOLDER "/levels.png", &error) == LMB_ERROR_WRITE && strstr(error.message, "levels.png"),
          "'%s'", error.message);
    slice_free(&seen);
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"levels and regions from above", test_from_above},
    {"validity along each axis", test_validity},
    {"ghosts, light and what is not there", test_ghosts_and_light},
};
TEST_MAIN(cases)
