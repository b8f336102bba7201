/* What every build of the sampler must do, with nothing but C and the golden file: the tests that also run for other
 * processors and systems. */
#include "harness.h"

#include <stdlib.h>

#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/version.h>
#include <lambent/volume.h>

static const char golden_path[] = LMB_GOLDEN_DIR "/small.lmb";

/* A copy that malloc has aligned. Aborts when there is none. */
static unsigned char *read_golden(size_t *size)
{
    enum { CAPACITY = 1 << 16 };
    FILE *const file = fopen(golden_path, "rb");
    unsigned char *const data = malloc(CAPACITY);
    if (!file || !data) {
        fprintf(stderr, "%s cannot be read\n", golden_path);
        abort();
    }
    *size = fread(data, 1, CAPACITY, file);
    fclose(file);
    return data;
}

static void test_version(void)
{
    char text[32];
    snprintf(text, sizeof text, "%d.%d.%d", LMB_VERSION_MAJOR, LMB_VERSION_MINOR, LMB_VERSION_PATCH);
    CHECK(lmb_version() == LMB_VERSION, "%d", lmb_version());
    CHECK(strcmp(lmb_version_text(), text) == 0, "'%s', not '%s'", lmb_version_text(), text);
}

/* Mapped, in memory, and with the handle in the caller's memory: the same bits at every position. */
static void test_three_ways_to_open(void)
{
    size_t size;
    unsigned char *const data = read_golden(&size);
    lmb_volume_storage storage;
    lmb_volume *volumes[3] = {NULL, NULL, NULL};
    CHECK(lmb_volume_open_file(golden_path, &volumes[0]) == LMB_OK, "map");
    CHECK(lmb_volume_open_memory(data, size, &volumes[1]) == LMB_OK, "memory");
    CHECK(lmb_volume_open_memory_in(&storage, data, size, &volumes[2]) == LMB_OK, "storage");
    CHECK((void *)volumes[2] == (void *)&storage, "the handle is elsewhere");
    for (int i = 0; i < 1000 && volumes[0] && volumes[1] && volumes[2]; ++i) {
        const lmb_vec3 position = {0.013f * (float)i - 4.0f, 0.01f * (float)(i * 7 % 300) - 0.3f,
                                   0.01f * (float)(i * 11 % 500) + 1.0f};
        lmb_sh3_rgb light[3];
        bool inside[3];
        for (int k = 0; k < 3; ++k) {
            inside[k] = lmb_volume_sample(volumes[k], position, &light[k]);
        }
        CHECK(inside[0] == inside[1] && inside[0] == inside[2], "inside at %d", i);
        CHECK(memcmp(&light[0], &light[1], sizeof light[0]) == 0, "mapped at %d", i);
        CHECK(memcmp(&light[0], &light[2], sizeof light[0]) == 0, "storage at %d", i);
    }
    for (int k = 0; k < 3; ++k) {
        lmb_volume_close(volumes[k]);
    }
    free(data);
}

/* The public batch is the single calls, also where this build has no other kernel. */
static void test_batch(void)
{
    enum { COUNT = 500 };
    static const char *const paths[] = {LMB_GOLDEN_DIR "/small.lmb", LMB_GOLDEN_DIR "/small_keys.lmb"};
    for (int file = 0; file < 2; ++file) {
        lmb_volume *volume = NULL;
        CHECK(lmb_volume_open_file(paths[file], &volume) == LMB_OK, "%s", paths[file]);
        static lmb_vec3d position[COUNT];
        static lmb_sh3_rgb radiance[COUNT];
        static float visibility[COUNT][LMB_KEY_LIGHTS_MOST];
        static bool inside[COUNT];
        for (int i = 0; i < COUNT; ++i) {
            position[i] = (lmb_vec3d){0.026 * i - 4.0, 0.01 * (i * 7 % 300) - 0.3, 0.01 * (i * 11 % 500) + 1.0};
        }
        if (volume) {
            lmb_volume_sample_batch(volume, position, COUNT, radiance, visibility, inside);
            for (int i = 0; i < COUNT; ++i) {
                lmb_sh3_rgb light;
                float seen[LMB_KEY_LIGHTS_MOST];
                const bool single = lmb_volume_sample_with_keys(volume, position[i], &light, seen);
                CHECK(single == inside[i] && memcmp(&light, &radiance[i], sizeof light) == 0 &&
                          memcmp(seen, visibility[i], sizeof seen) == 0,
                      "%s at %d", paths[file], i);
            }
        }
        lmb_volume_close(volume);
    }
}

static void test_files_that_are_none(void)
{
    lmb_volume *volume = NULL;
    CHECK(lmb_volume_open_file(LMB_GOLDEN_DIR "/missing.lmb", &volume) == LMB_ERROR_IO, "missing");
    CHECK(lmb_volume_open_file(LMB_GOLDEN_DIR, &volume) == LMB_ERROR_IO, "a folder");
    CHECK(lmb_volume_open_file("", &volume) == LMB_ERROR_IO, "no name");
    CHECK(lmb_volume_open_file("\xff\xfe.lmb", &volume) == LMB_ERROR_IO, "not UTF-8, and not there");
    CHECK(lmb_volume_open_file(LMB_GOLDEN_DIR "/small.txt", &volume) == LMB_ERROR_FORMAT, "a text");
    const char *const path = LMB_TEST_OUTPUT_DIR "/empty \xc3\xa9.lmb";
    FILE *const file = fopen(path, "wb");
    if (file) {
        fclose(file);
        const lmb_result result = lmb_volume_open_file(path, &volume);
        /* Windows reads fopen's name in another encoding. */
        CHECK(result == LMB_ERROR_TRUNCATED || result == LMB_ERROR_IO, "an empty file: %d", result);
        remove(path);
    }
    CHECK(!volume, "output untouched");
}

/* Every shorter length, and every byte changed: each is refused, and the caller's storage stays as it was. */
static void test_damage(void)
{
    size_t size;
    unsigned char *const data = read_golden(&size);
    lmb_volume_storage storage, before;
    memset(&storage, 0x5a, sizeof storage);
    before = storage;
    lmb_volume *volume = NULL;
    for (size_t length = 0; length < size; length += length < 512 ? 1 : 97) {
        const lmb_result result = lmb_volume_open_memory_in(&storage, data, length, &volume);
        CHECK(result == LMB_ERROR_TRUNCATED, "%zu bytes: %d", length, result);
    }
    for (size_t at = 0; at < size; at += at < 512 ? 1 : 97) {
        data[at] ^= 0x10;
        const lmb_result result = lmb_volume_open_memory_in(&storage, data, size, &volume);
        CHECK(result != LMB_OK, "byte %zu", at);
        data[at] ^= 0x10;
    }
    CHECK(!volume && memcmp(&storage, &before, sizeof storage) == 0, "outputs were touched");
    free(data);
}

/* Inlined where its arguments are known and called through a pointer that the compiler knows nothing of, an evaluation
 * gives the same bits. */
static void test_inlined_is_called(void)
{
    float (*volatile const call_hlsh)(const lmb_hlsh *, lmb_vec3, lmb_vec3) = lmb_hlsh_evaluate;
    float (*volatile const call_hhd)(const lmb_hhd *, lmb_vec3, lmb_vec3) = lmb_hhd_evaluate;
    lmb_rgb (*volatile const call_bounce)(lmb_rgb, lmb_rgb, lmb_vec3, lmb_vec3) = lmb_self_bounce;
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    for (int i = 0; i < 1000; ++i) {
        const float t = 0.002f * (float)i - 1.0f;
        const lmb_vec3 n = {t, sqrtf(1.0f - t * t) * 0.6f, sqrtf(1.0f - t * t) * 0.8f};
        const lmb_hlsh hlsh = {0.7f + t, 0.3f - t, {0.31f, 0.0f, 0.17f * t}};
        const lmb_hhd hhd = {0.3f + t, 1.7f - t, {0.36f, 0.8f, 0.48f}};
        const lmb_rgb albedo = {{0.1f, 0.5f, 0.9f}}, light = {{1.3f, 0.7f + t, 0.2f}};
        const float hlsh_inlined = lmb_hlsh_evaluate(&hlsh, up, n), hlsh_called = call_hlsh(&hlsh, up, n);
        const float hhd_inlined = lmb_hhd_evaluate(&hhd, up, n), hhd_called = call_hhd(&hhd, up, n);
        const lmb_rgb inlined = lmb_self_bounce(albedo, light, up, n), called = call_bounce(albedo, light, up, n);
        CHECK(memcmp(&hlsh_inlined, &hlsh_called, sizeof hlsh_called) == 0, "HLSH at %d", i);
        CHECK(memcmp(&hhd_inlined, &hhd_called, sizeof hhd_called) == 0, "HHD at %d", i);
        CHECK(memcmp(&inlined, &called, sizeof called) == 0, "bounce at %d", i);
    }
}

static const test_case cases[] = {
    {"version", test_version},
    {"three ways to open", test_three_ways_to_open},
    {"a batch is its single calls", test_batch},
    {"files that are none", test_files_that_are_none},
    {"damage is refused", test_damage},
    {"inlined evaluations are the called ones", test_inlined_is_called},
};
TEST_MAIN(cases)
