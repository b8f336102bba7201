/* What was gathered, kept part by part: going on after an interruption, shards, and files that are broken. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "floor_fixture.h"
#include "level_fixture.h"
#include "run/parts.h"

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/parts_" name

/* Three parts and a bit. */
enum { SIDE = 112, ELEMENTS = SIDE * SIDE, PARTS = 4 };

static void site_find(const void *context, size_t element, lmb_gather_site *site)
{
    (void)context;
    site->point[0] = (lmb_gather_point){
        .position = {0.05f * (float)(element % SIDE) - 2.8f, 1.0f, 0.05f * (float)(element / SIDE) - 2.8f}};
    site->count = 1;
}

static const lmb_gather_list list = {
    .name = "points", .count = ELEMENTS, .most_points = 1, .find_site = site_find, .context = NULL};
static const lmb_gather_effort effort = {.samples = 2, .max_samples = 8, .tolerance = 0.1};

typedef struct parts_fixture {
    level_fixture level;
    lmb_gather_job job;
    lmb_gathered *whole, *parts;
    lmb_gather_stats whole_stats, parts_stats;
} parts_fixture;

static void fixture_close(parts_fixture *fixture)
{
    free(fixture->whole);
    free(fixture->parts);
    level_fixture_close(&fixture->level);
}

static bool fixture_open(parts_fixture *fixture, int threads)
{
    memset(fixture, 0, sizeof *fixture);
    lmb_level_builder *builder = floor_begin(0.5f, 10);
    const lmb_level_light lamp = {
        .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.5f, 0.25f}}, .intensity = 20.0f};
    lmb_level_node node = lmb_level_node_default("lamp");
    node.light = lmb_level_builder_add_light(builder, &lamp);
    node.translation = (lmb_vec3){0.0f, 2.0f, 0.0f};
    lmb_level_builder_add_node(builder, &node);
    lmb_error error = {{0}};
    const lmb_result written = lmb_level_builder_write(builder, OUTPUT("level.glb"), &error);
    lmb_level_builder_destroy(builder);
    if (!level_fixture_open(&fixture->level, OUTPUT("level.glb"), written, &error, threads)) {
        return false;
    }
    fixture->job = lmb_gather_job_all(&fixture->level.transport, &list, &effort);
    fixture->whole = malloc(ELEMENTS * sizeof *fixture->whole);
    fixture->parts = malloc(ELEMENTS * sizeof *fixture->parts);
    const bool good = fixture->whole && fixture->parts &&
                      lmb_parts_gather(NULL, &fixture->job, fixture->level.pool, NULL, fixture->whole,
                                       &fixture->whole_stats, &error) == LMB_OK;
    CHECK(good, "%s", error.message);
    if (!good) {
        fixture_close(fixture);
    }
    return good;
}

static void file_path(const char *folder, int part, char path[512])
{
    snprintf(path, 512, "%s/points-%06d.part", folder, part);
}

static void folder_clear(const char *folder)
{
    for (int part = 0; part < PARTS; ++part) {
        char path[512];
        file_path(folder, part, path);
        unlink(path);
    }
}

static int files_count(const char *folder)
{
    int count = 0;
    for (int part = 0; part < PARTS; ++part) {
        char path[512];
        file_path(folder, part, path);
        count += access(path, R_OK) == 0;
    }
    return count;
}

static void same_is_gathered(const parts_fixture *fixture, const char *how)
{
    const lmb_gather_stats *a = &fixture->whole_stats, *b = &fixture->parts_stats;
    size_t different = 0;
    for (size_t i = 0; i < ELEMENTS; ++i) {
        different += memcmp(&fixture->whole[i].moments, &fixture->parts[i].moments, sizeof(lmb_sh3_rgb)) != 0 ||
                     fixture->whole[i].squared_error != fixture->parts[i].squared_error;
    }
    CHECK(different == 0, "%s: %zu elements differ", how, different);
    CHECK(a->elements == b->elements && a->rays == b->rays && a->samples == b->samples &&
              a->squared_error == b->squared_error,
          "%s: the same stats", how);
}

/* Stops in the second part of four, or at its end. */
static bool stop_later(void *context, const char *phase, double done)
{
    (void)context;
    (void)phase;
    return done <= 0.3;
}

static void goes_on_after_an_interruption(void)
{
    static const char folder[] = OUTPUT("resume");
    parts_fixture fixture;
    if (!fixture_open(&fixture, 2)) {
        return;
    }
    const char *const from[] = {folder};
    lmb_parts parts = {.key = 7, .read_from = from, .read_count = 1, .write_to = folder, .seconds = 0.0};
    folder_clear(folder);
    const lmb_progress progress = {stop_later, NULL};
    lmb_error error = {{0}};
    CHECK(lmb_parts_gather(&parts, &fixture.job, fixture.level.pool, &progress, fixture.parts, &fixture.parts_stats,
                           &error) == LMB_ERROR_INTERRUPTED,
          "%s", error.message);
    const int kept = files_count(folder);
    CHECK(kept >= 1 && kept < PARTS, "%d parts were kept", kept);
    CHECK(lmb_parts_gather(&parts, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                           &error) == LMB_OK,
          "%s", error.message);
    same_is_gathered(&fixture, "resumed");
    CHECK(files_count(folder) == PARTS, "all are kept");
    parts.read_only = true;
    CHECK(lmb_parts_gather(&parts, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                           &error) == LMB_OK,
          "%s", error.message);
    same_is_gathered(&fixture, "read");
    fixture_close(&fixture);
}

static void shards_are_put_together(void)
{
    static const char *const folders[] = {OUTPUT("shard_0"), OUTPUT("shard_1"), OUTPUT("shard_2")};
    parts_fixture fixture;
    if (!fixture_open(&fixture, 1)) {
        return;
    }
    lmb_error error = {{0}};
    lmb_parts merge = {.key = 9, .read_from = folders, .read_count = 3, .read_only = true};
    for (uint32_t shard = 0; shard < 3; ++shard) {
        folder_clear(folders[shard]);
    }
    for (uint32_t shard = 0; shard < 3; ++shard) {
        CHECK(lmb_parts_gather(&merge, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                               &error) == LMB_ERROR_UNSUPPORTED,
              "shard %u is missing", shard);
        const lmb_parts parts = {
            .key = 9, .write_to = folders[shard], .seconds = 1e9, .shard = shard, .shard_count = 3};
        CHECK(lmb_parts_gather(&parts, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                               &error) == LMB_OK,
              "%s", error.message);
        CHECK(files_count(folders[shard]) == (shard == 0 ? 2 : 1), "%d files", files_count(folders[shard]));
    }
    CHECK(lmb_parts_gather(&merge, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                           &error) == LMB_OK,
          "%s", error.message);
    same_is_gathered(&fixture, "merged");
    merge.key = 10;
    CHECK(lmb_parts_gather(&merge, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                           &error) == LMB_ERROR_UNSUPPORTED,
          "those of other settings are not taken");
    fixture_close(&fixture);
}

/* Changes a byte of a file, or cuts it off there. */
static void file_spoil(const char *path, long at, bool cut)
{
    FILE *const file = fopen(path, "r+b");
    CHECK(file, "%s", path);
    if (file) {
        fseek(file, at, SEEK_SET);
        const int byte = fgetc(file);
        fseek(file, at, SEEK_SET);
        fputc(byte ^ 1, file);
        fclose(file);
        CHECK(!cut || truncate(path, at) == 0, "%s", path);
    }
}

static void broken_parts_are_gathered_anew(void)
{
    static const char folder[] = OUTPUT("broken");
    parts_fixture fixture;
    if (!fixture_open(&fixture, 2)) {
        return;
    }
    const char *const from[] = {folder};
    const lmb_parts parts = {.key = 7, .read_from = from, .read_count = 1, .write_to = folder, .seconds = 0.0};
    folder_clear(folder);
    lmb_error error = {{0}};
    for (int round = 0; round < 2; ++round) {
        CHECK(lmb_parts_gather(&parts, &fixture.job, fixture.level.pool, NULL, fixture.parts, &fixture.parts_stats,
                               &error) == LMB_OK,
              "%s", error.message);
        same_is_gathered(&fixture, round == 0 ? "first" : "mended");
        char path[512];
        file_path(folder, 0, path);
        file_spoil(path, 5, false); /* magic */
        file_path(folder, 1, path);
        file_spoil(path, 5000, false); /* a record */
        file_path(folder, 2, path);
        file_spoil(path, 9999, true);
        file_path(folder, 3, path);
        file_spoil(path, 17, false); /* the first group */
    }
    fixture_close(&fixture);
}

static const test_case cases[] = {
    {"goes on after an interruption", goes_on_after_an_interruption},
    {"shards are put together", shards_are_put_together},
    {"broken parts are gathered anew", broken_parts_are_gathered_anew},
};

TEST_MAIN(cases)
