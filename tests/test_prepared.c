/* What a bake is prepared with: the same bytes with it as without, and files that are broken, or lie. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/bake.h>
#include <lambent/file.h>

#include "command_fixture.h"
#include "run/bake_key.h"
#include "run/prepared.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/prepared"
#define LEVEL OUTPUT "/room.glb"

/* Levels of probes, cut cells, divided sides of surfaces. */
static lmb_bake_settings room_settings(void)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = LEVEL;
    settings.level.threads = 2;
    settings.spacing = 1.0f;
    settings.min_spacing = 0.25f;
    settings.tolerance = 0.1;
    settings.samples = settings.max_samples = 8;
    settings.seeds[settings.seed_count++] = (lmb_vec3d){0.0, 1.0, 0.9};
    return settings;
}

static lmb_result bake_as(const char *directory, const lmb_bake_settings *settings, const lmb_bake_work *work,
                          lmb_bake_record *record, lmb_error *error)
{
    lmb_bake_folder *folder;
    lmb_result result = lmb_bake_folder_open(directory, settings->lightmaps, &folder, error);
    if (result == LMB_OK) {
        result = lmb_bake_run_as(settings, work, folder, NULL, record, error);
        lmb_bake_folder_close(folder);
    }
    return result;
}

static void bytes_are_the_same(void)
{
    static const char *const names[] = {"levels", "one level", "lightmaps alone", "no bounces", "paths"};
    for (int i = 0; i < 5 && cornell_make(OUTPUT, LEVEL); ++i) {
        lmb_bake_settings settings = room_settings();
        settings.min_spacing = i == 1 ? 0.0f : settings.min_spacing;
        settings.lightmaps = i <= 2;
        settings.texels_per_m = 4.0f;
        settings.no_probes = i == 2;
        settings.level.bounces = i == 3 ? 0 : -1;
        settings.estimator = i == 4 ? LMB_ESTIMATOR_REFERENCE : LMB_ESTIMATOR_CACHED;
        lmb_bake_record whole, taken;
        lmb_error error = {{0}};
        CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/whole " OUTPUT "/ready " OUTPUT "/taken");
        const bool good =
            bake_as(OUTPUT "/whole", &settings, &(lmb_bake_work){.again = true}, &whole, &error) == LMB_OK &&
            bake_as(OUTPUT "/ready", &settings, &(lmb_bake_work){.prepare = true}, NULL, &error) == LMB_OK &&
            bake_as(OUTPUT "/taken", &settings, &(lmb_bake_work){.prepared = OUTPUT "/ready"}, &taken, &error) ==
                LMB_OK;
        CHECK(good, "%s: %s", names[i], error.message);
        if (good) {
            CHECK_RUN(0, NULL,
                      "cd " OUTPUT "/whole && for f in $(ls probes.* lightmap/* 2>/dev/null); do cmp $f "
                      "../taken/$f || exit 1; done");
            for (int phase = 0; phase < LMB_PHASE_COUNT; ++phase) {
                CHECK(whole.rays[phase] == taken.rays[phase], "%s: rays of %s", names[i],
                      lmb_bake_phase_name((lmb_bake_phase)phase));
            }
            CHECK(whole.probes == taken.probes && whole.level_count == taken.level_count &&
                      whole.placement.cells == taken.placement.cells &&
                      (settings.no_probes || whole.regions.cells_cut > 0) &&
                      whole.regions.ghosts == taken.regions.ghosts && whole.surface_bytes == taken.surface_bytes &&
                      whole.surface.passes == taken.surface.passes && whole.settings.spacing == taken.settings.spacing,
                  "%s: the record", names[i]);
        }
    }
}

/* A level that is prepared, and the file of it. */
typedef struct prepared_room {
    lmb_level level;
    lmb_bake_settings settings;
    unsigned char *data;
    size_t size;
} prepared_room;

static bool room_open(prepared_room *room)
{
    static const lmb_bake_work prepare = {.prepare = true, .again = true};
    lmb_error error = {{0}};
    *room = (prepared_room){.settings = room_settings()};
    const bool good = cornell_make(OUTPUT, LEVEL) &&
                      bake_as(OUTPUT "/file", &room->settings, &prepare, NULL, &error) == LMB_OK &&
                      lmb_level_open(&room->settings.level, NULL, NULL, &room->level, &error) == LMB_OK &&
                      lmb_file_read(OUTPUT "/file/" LMB_PREPARED_NAME, &room->data, &room->size, &error) == LMB_OK;
    CHECK(good, "%s", error.message);
    return good;
}

static void room_close(prepared_room *room)
{
    free(room->data);
    lmb_level_close(&room->level);
}

/* Reads a file, and gathers probes by what it says where it is taken. */
static lmb_result file_take(prepared_room *room, const unsigned char *data, size_t size, lmb_error *error)
{
    mkdir(OUTPUT "/changed", 0777);
    if (lmb_file_write(OUTPUT "/changed/" LMB_PREPARED_NAME, data, size, error) != LMB_OK) {
        return LMB_ERROR_WRITE;
    }
    lmb_bake bake = lmb_bake_begin(&room->settings, &room->level, NULL);
    bake.record.key = lmb_bake_key(&room->settings, room->level.scene->content_hash);
    lmb_result result = lmb_bake_prepared_read(&bake, OUTPUT "/changed", error);
    if (result == LMB_OK) {
        result = lmb_bake_probes(&bake, error);
        CHECK(result == LMB_OK, "gathers: %s", error->message);
    }
    lmb_bake_end(&bake);
    lmb_surface_light_destroy(room->level.surface);
    room->level.surface = NULL;
    room->level.transport.surface = NULL;
    return result;
}

static void broken_files_are_refused(void)
{
    prepared_room room;
    lmb_error error = {{0}};
    if (!room_open(&room)) {
        return;
    }
    CHECK(file_take(&room, room.data, room.size, &error) == LMB_OK, "whole: %s", error.message);
    for (size_t i = 0; i < 60; ++i) {
        const size_t size = i < 45 ? i : room.size * (i - 44) / 16;
        const lmb_result result = file_take(&room, room.data, size, &error);
        CHECK(result == LMB_ERROR_TRUNCATED, "%zu of %zu bytes: %s", size, room.size, lmb_result_text(result));
    }
    for (size_t i = 0; i < 60; ++i) {
        const size_t at = i < 40 ? i : room.size * (i - 39) / 21;
        room.data[at] ^= 0x10;
        const lmb_result result = file_take(&room, room.data, room.size, &error);
        CHECK(result != LMB_OK && strstr(error.message, "changed/prepared.bin: "), "byte %zu: %s", at, error.message);
        room.data[at] ^= 0x10;
    }
    room.settings.samples = 9;
    CHECK(file_take(&room, room.data, room.size, &error) == LMB_ERROR_UNSUPPORTED &&
              strstr(error.message, "other settings"),
          "%s", error.message);
    room_close(&room);
}

/* With a checksum that holds: taken or refused, never followed to where nothing is. */
static void lying_files_do_no_harm(void)
{
    enum { HEAD = 40, CHECKSUM = 32, TRIES = 200 };
    prepared_room room;
    lmb_error error = {{0}};
    int taken = 0, refused = 0;
    if (!room_open(&room)) {
        return;
    }
    for (size_t i = 0; i < TRIES; ++i) {
        const size_t at = HEAD + (i < TRIES / 4 ? 4 * i : (room.size - HEAD - 4) * (i - TRIES / 4) / TRIES);
        unsigned char was[4];
        memcpy(was, room.data + at, sizeof was);
        memset(room.data + at, i % 2 == 0 ? 0xff : 0x7f, sizeof was);
        const uint64_t checksum = lmb_hash(LMB_HASH_SEED, room.data + HEAD, room.size - HEAD);
        memcpy(room.data + CHECKSUM, &checksum, sizeof checksum);
        const lmb_result result = file_take(&room, room.data, room.size, &error);
        taken += result == LMB_OK;
        refused += result == LMB_ERROR_FORMAT || result == LMB_ERROR_TRUNCATED;
        memcpy(room.data + at, was, sizeof was);
    }
    CHECK(taken + refused == TRIES && refused > TRIES / 8, "%d taken, %d refused", taken, refused);
    room_close(&room);
}

static void commands_go_with_each_other(void)
{
    if (!cornell_make(OUTPUT, LEVEL)) {
        return;
    }
#define BAKE "cd " OUTPUT " && " LMB_COMMAND " bake " LEVEL " --spacing 0.5 --samples 16 --quiet"
    CHECK_RUN(0, NULL, "cd " OUTPUT " && rm -rf plain once s1 s2 joined");
    CHECK_RUN(0, NULL, BAKE " -o plain");
    CHECK_RUN(0, "prepared", BAKE " --prepare -o once");
    CHECK_RUN(0, NULL, "cd " OUTPUT "/once && mkdir .lambent-parts && touch .lambent-parts/probes-000000.part");
    CHECK_RUN(0, "current", BAKE " --prepare -o once");
    CHECK_RUN(0, NULL, "test -e " OUTPUT "/once/.lambent-parts/probes-000000.part");
    CHECK_RUN(0, "prepared", BAKE " --prepare --force -o once");
    CHECK_RUN(0, "gathered", BAKE " --shard 1/2 --prepared once -o s1");
    CHECK_RUN(0, "gathered", BAKE " --shard 2/2 -o s2");
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && " LMB_COMMAND " merge s1 s2 --prepared once -o joined --quiet && cmp "
              "plain/probes.lmb joined/probes.lmb && cmp plain/probes.vdb joined/probes.vdb");
    CHECK_RUN(3, "other settings", BAKE " --seed 1 --prepared once -o other");
    CHECK_RUN(3, "nowhere/prepared.bin", BAKE " --prepared nowhere -o other");
    CHECK_RUN(2, "--prepared does not go with", BAKE " --prepare --prepared once -o other");
    CHECK_RUN(2, "--shard does not go with", BAKE " --prepare --shard 1/2 -o other");
#undef BAKE
}

/* The jobs of tools/farm/slurm, as Slurm would start them. */
static void jobs_of_slurm_follow_each_other(void)
{
    if (!cornell_make(OUTPUT, LEVEL)) {
        return;
    }
#define JOB                                                                                                            \
    "cd " OUTPUT " && LAMBENT=" LMB_COMMAND " SLURM_ARRAY_TASK_MAX=2 SLURM_ARRAY_TASK_ID=%d " LMB_SLURM " --%s farm"
#define OPTIONS LEVEL " --spacing 0.5 --samples 16"
    CHECK_RUN(0, NULL, "cd " OUTPUT " && rm -rf farm plain && " LMB_COMMAND " bake " OPTIONS " --quiet -o plain");
    CHECK_RUN(0, "prepared", JOB " " OPTIONS, 0, "prepare");
    CHECK_RUN(0, "gathered", JOB " " OPTIONS, 1, "share");
    CHECK_RUN(0, "gathered", JOB " " OPTIONS, 2, "share");
    CHECK_RUN(0, NULL, JOB " 2 && cmp farm/probes.lmb plain/probes.lmb", 0, "merge");
#undef OPTIONS
#undef JOB
}

static const test_case cases[] = {
    {"bytes are the same", bytes_are_the_same},
    {"broken files are refused", broken_files_are_refused},
    {"lying files do no harm", lying_files_do_no_harm},
    {"commands go with each other", commands_go_with_each_other},
    {"jobs of Slurm follow each other", jobs_of_slurm_follow_each_other},
};

TEST_MAIN(cases)
