/* Baking a part of a level anew: what lies in a box is a full new bake's, all else the old one's. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/bake.h>
#include <lambent/file.h>
#include <lambent/vdb.h>

#include "command_fixture.h"
#include "run/kept_file.h"
#include "scenes/level_builder.h"
#include "warning_log.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/only"
#define LEVEL OUTPUT "/corridor.glb"
#define SPACING 0.5f

/* The part that is baked anew: one end of the corridor. */
static const lmb_vec3d near_end[2] = {{-13.0, -1.0, -2.0}, {-4.0, 3.0, 2.0}};

/* A corridor along x, 24 x 2 x 2 m, with a lamp near each of its ends and a block near one. */
static float sun;           /* lux, from behind, outside */
static float albedo = 0.5f; /* of all */

static bool corridor_make(float lamp, float block)
{
    lmb_error error = {{0}};
    lmb_level_builder *const builder = lmb_level_builder_create(0.1f);
    lmb_level_material white = lmb_level_material_default();
    white.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    const int material = lmb_level_builder_add_material(builder, &white);
    const int room = lmb_level_builder_add_mesh(builder, "room"), stone = lmb_level_builder_add_mesh(builder, "stone");
    lmb_level_box walls = lmb_level_box_of((lmb_vec3){-12, 0, -1}, (lmb_vec3){12, 2, 1}, material);
    walls.inward = true;
    lmb_level_builder_add_box(builder, room, &walls);
    const lmb_level_box cube = lmb_level_box_of((lmb_vec3){-0.3f, 0, -0.3f}, (lmb_vec3){0.3f, 0.6f, 0.3f}, material);
    lmb_level_builder_add_box(builder, stone, &cube);
    lmb_level_builder_place(builder, "room", room, (lmb_vec3){0, 0, 0});
    lmb_level_node node_of_stone = lmb_level_node_default("stone");
    node_of_stone.mesh = stone;
    node_of_stone.translation = (lmb_vec3){block, 0.03f, 0.1f};
    node_of_stone.local_set = true;
    lmb_level_builder_add_node(builder, &node_of_stone);
    for (int end = 0; end < 2; ++end) {
        const lmb_level_light light = {.name = "lamp",
                                       .type = LMB_LEVEL_LIGHT_POINT,
                                       .color = {{1.0f, 0.8f, 0.6f}},
                                       .intensity = end == 0 ? lamp : 20.0f};
        lmb_level_node node = lmb_level_node_default("lamp");
        node.light = lmb_level_builder_add_light(builder, &light);
        node.translation = (lmb_vec3){end == 0 ? -10.0f : 8.0f, 1.7f, 0.2f};
        lmb_level_builder_add_node(builder, &node);
    }
    if (sun > 0.0f) {
        const lmb_level_light light = {
            .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1.0f, 1.0f, 1.0f}}, .intensity = sun};
        lmb_level_node node = lmb_level_node_default("sun");
        node.light = lmb_level_builder_add_light(builder, &light);
        lmb_level_builder_add_node(builder, &node);
    }
    mkdir(OUTPUT, 0777);
    const lmb_result result = lmb_level_builder_write(builder, LEVEL, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static lmb_bake_settings corridor_settings(bool denoise)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = LEVEL;
    settings.level.threads = 2;
    settings.spacing = SPACING;
    settings.samples = 8;
    settings.max_samples = 32;
    settings.denoise = denoise;
    settings.lightmaps = true;
    settings.texels_per_m = 4.0f;
    return settings;
}

static lmb_result bake_as(const char *directory, const lmb_bake_settings *settings, const lmb_bake_work *work,
                          warning_log *log, lmb_bake_record *record, lmb_error *error)
{
    lmb_bake_folder *folder;
    const lmb_bake_listener listener = {.warnings = {log ? warning_keep : NULL, log}};
    lmb_result result = lmb_bake_folder_open(directory, settings->lightmaps, &folder, error);
    if (result == LMB_OK) {
        result = lmb_bake_run_as(settings, work, folder, &listener, record, error);
        lmb_bake_folder_close(folder);
    }
    return result;
}

/* The bake before the level changed, the whole one after it, and the one of a part, in folders of their own. */
static bool three_bakes(const lmb_bake_settings *settings, float lamp, float block, warning_log *log,
                        lmb_bake_record *part)
{
    static const lmb_bake_work keep = {.again = true, .keep = true}, only = {.only = near_end};
    lmb_error error = {{0}};
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/old " OUTPUT "/new " OUTPUT "/part");
    bool good = corridor_make(20.0f, -8.0f) && bake_as(OUTPUT "/old", settings, &keep, NULL, NULL, &error) == LMB_OK &&
                corridor_make(lamp, block) && bake_as(OUTPUT "/new", settings, &keep, NULL, NULL, &error) == LMB_OK;
    good = good && CHECK_RUN(0, NULL, "cp -r " OUTPUT "/old " OUTPUT "/part") &&
           bake_as(OUTPUT "/part", settings, &only, log, part, &error) == LMB_OK;
    CHECK(good, "%s", error.message);
    return good;
}

/* Of the volumes: [old, new, part]. */
static bool volumes_read(lmb_probes *probes[3])
{
    static const char *const path[3] = {OUTPUT "/old/probes.vdb", OUTPUT "/new/probes.vdb", OUTPUT "/part/probes.vdb"};
    bool good = true;
    for (int i = 0; i < 3; ++i) {
        lmb_error error = {{0}};
        const lmb_result result = lmb_vdb_read(path[i], &probes[i], NULL, NULL, &error);
        CHECK(result == LMB_OK, "%s", error.message);
        probes[i] = result == LMB_OK ? probes[i] : NULL;
        good = good && result == LMB_OK;
    }
    return good;
}

static void volumes_free(lmb_probes *probes[3])
{
    for (int i = 0; i < 3; ++i) {
        lmb_probes_destroy(probes[i]);
    }
}

/* Baked probes of the part's volume: in the box, `rim` metres from its end, they are the new volume's, and beyond it
 * the old one's. */
static void volume_is_of_both(float rim)
{
    lmb_probes *p[3];
    int inside = 0, outside = 0, wrong = 0, changed = 0;
    if (!volumes_read(p)) {
        volumes_free(p);
        return;
    }
    CHECK(p[0]->count == p[2]->count && p[1]->count == p[2]->count, "%d, %d, %d probes", p[0]->count, p[1]->count,
          p[2]->count);
    for (int32_t i = 0; i < p[2]->count - p[2]->ghost_count && p[0]->count == p[2]->count; ++i) {
        const float x = lmb_probes_position(p[2], i).x;
        const bool is_new = x <= (float)near_end[1].x - rim, is_old = x > (float)near_end[1].x + rim;
        if (p[2]->validity[i] >= LMB_PROBES_MIN_VALIDITY && (is_new || is_old)) {
            const lmb_sh3_rgb *const own = &p[2]->radiance[0][i];
            wrong += memcmp(own, &p[is_new ? 1 : 0]->radiance[0][i], sizeof *own) != 0;
            changed += memcmp(&p[0]->radiance[0][i], &p[1]->radiance[0][i], sizeof *own) != 0;
            inside += is_new;
            outside += is_old;
        }
    }
    CHECK(inside > 50 && outside > 200 && changed > inside, "%d in the box, %d outside, %d changed", inside, outside,
          changed);
    CHECK(wrong == 0, "%d of %d probes are neither's", wrong, inside + outside);
    volumes_free(p);
}

/* What was gathered for a list: each element old or new, and how many are which. */
static void gathered_is_of_both(const lmb_bake_settings *settings, const char *list, uint64_t *taken)
{
    static const char *const folder[3] = {OUTPUT "/old", OUTPUT "/new", OUTPUT "/part"};
    lmb_kept_file file[3];
    lmb_error error = {{0}};
    bool good = true;
    for (int i = 0; i < 3; ++i) {
        const lmb_kept kept = {.read_from = folder[i], .settings = lmb_kept_settings(settings), .suns = LMB_HASH_SEED};
        good = lmb_kept_file_read(&kept, list, &file[i], &error) == LMB_OK && good;
    }
    CHECK(good && file[0].head.count == file[2].head.count, "%s: %s", list, error.message);
    size_t old = 0, other = 0, same = 0;
    for (size_t i = 0; good && i < file[2].head.count; ++i) {
        const size_t at = i * sizeof(lmb_gathered);
        const bool is_old = memcmp(file[2].gathered + at, file[0].gathered + at, sizeof(lmb_gathered)) == 0;
        const bool is_new = memcmp(file[2].gathered + at, file[1].gathered + at, sizeof(lmb_gathered)) == 0;
        old += is_old && !is_new;
        same += is_old && is_new;
        other += !is_old && !is_new;
    }
    CHECK(other == 0 && old > 100, "%s: %zu of neither, %zu old, %zu of both, of %zu", list, other, old, same,
          (size_t)file[2].head.count);
    *taken += old;
    for (int i = 0; i < 3; ++i) {
        free(file[i].data);
    }
}

static void a_lamp_changes(void)
{
    const lmb_bake_settings settings = corridor_settings(false);
    lmb_bake_record part;
    warning_log log = {0};
    uint64_t taken = 0;
    if (!three_bakes(&settings, 50.0f, -8.0f, &log, &part)) {
        return;
    }
    volume_is_of_both(0.0f);
    gathered_is_of_both(&settings, "probes", &taken);
    gathered_is_of_both(&settings, "lightmaps", &taken);
    CHECK(part.is_part && part.taken == taken, "%llu taken, %llu are the old bake's", (unsigned long long)part.taken,
          (unsigned long long)taken);
    CHECK(log.count == 1 && strstr(log.last, "(lights): what lies outside"), "%d: %s", log.count, log.last);
}

/* Denoising looks eight spacings far. */
static void denoising_has_a_rim(void)
{
    const lmb_bake_settings settings = corridor_settings(true);
    lmb_bake_record part;
    if (three_bakes(&settings, 50.0f, -8.0f, NULL, &part)) {
        volume_is_of_both(8.0f * SPACING);
    }
}

/* What stands elsewhere is baked anew wherever it is, and said. */
static void a_block_moves(void)
{
    const lmb_bake_settings settings = corridor_settings(false);
    lmb_bake_record part;
    warning_log log = {0};
    if (three_bakes(&settings, 20.0f, -6.4f, &log, &part)) {
        volume_is_of_both(0.0f);
        CHECK(part.taken > 1000, "%llu taken", (unsigned long long)part.taken);
    }
    if (three_bakes(&settings, 20.0f, 4.0f, &log, &part)) {
        CHECK(log.count > 0 && strstr(log.last, "outside of the box stand elsewhere"), "%d: %s", log.count, log.last);
    }
}

/* The file's head has one sun, for all probes. */
static void another_sun_is_everywhere(void)
{
    static const lmb_bake_work keep = {.again = true, .keep = true}, only = {.only = near_end};
    lmb_bake_settings settings = corridor_settings(false);
    lmb_bake_record part;
    lmb_error error = {{0}};
    warning_log log = {0};
    settings.spacing = 1.0f;
    settings.lightmaps = false;
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/sun");
    for (int i = 0; i < 2; ++i) {
        sun = 100.0f * (float)(i + 1);
        const bool good = corridor_make(20.0f, -8.0f) &&
                          bake_as(OUTPUT "/sun", &settings, i == 0 ? &keep : &only, &log, &part, &error) == LMB_OK;
        CHECK(good, "%s", error.message);
    }
    CHECK(!part.is_part && part.taken == 0 && log.count == 2 && strstr(log.last, "(lights): all is baked anew"),
          "%d: %s", log.count, log.last);
    CHECK(bake_as(OUTPUT "/sun", &settings, &(lmb_bake_work){.resume = true}, NULL, &part, &error) == LMB_OK &&
              part.is_current,
          "a whole bake");
    sun = 0.0f;
}

/* What a bake says of a level that is not what it was. */
static void changes_are_named(void)
{
    static const struct {
        float lamp, block, albedo;
        const char *environment, *says; /* NULL: nothing */
    } table[] = {
        {20.0f, -8.0f, 0.5f, NULL, NULL},
        {20.0f, -8.0f, 0.5f, NULL, NULL},
        {21.0f, -8.0f, 0.5f, NULL, "(lights): all is baked anew"},
        {21.0f, -7.0f, 0.5f, NULL, "(geometry): all is baked anew"},
        {21.0f, -7.0f, 0.6f, NULL, "(materials): all is baked anew"},
        {21.0f, -7.0f, 0.6f, "#123456", "(environment): all is baked anew"},
        {20.0f, -8.0f, 0.5f, NULL, "(geometry, materials, lights, environment): all is baked anew"},
    };
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/changes");
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        static const lmb_bake_work all = {.again = true};
        lmb_bake_settings settings = corridor_settings(false);
        lmb_error error = {{0}};
        warning_log log = {0};
        settings.spacing = 2.0f;
        settings.samples = settings.max_samples = 2;
        settings.lightmaps = false;
        settings.level.environment = table[i].environment;
        albedo = table[i].albedo;
        const bool good = corridor_make(table[i].lamp, table[i].block) &&
                          bake_as(OUTPUT "/changes", &settings, &all, &log, NULL, &error) == LMB_OK;
        CHECK(good, "%s", error.message);
        CHECK(table[i].says ? log.count == 1 && strstr(log.last, table[i].says) : log.count == 0, "%zu: %s", i,
              log.last);
    }
    albedo = 0.5f;
}

static void commands_say_what_is_wrong(void)
{
#define BAKE "cd " OUTPUT " && " LMB_COMMAND " bake " LEVEL " --spacing 1 --samples 8 --no-denoise --quiet"
#define BOX " --only=-4,3,2,-13,-1,-2"
    if (!corridor_make(20.0f, -8.0f)) {
        return;
    }
    CHECK_RUN(0, NULL, BAKE " -o plain --force && " BAKE " -o kept --force --keep-gathered --threads 1");
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && cmp plain/probes.lmb kept/probes.lmb && cmp plain/probes.vdb kept/probes.vdb "
              "&& test ! -e plain/gathered-probes.bin");
    CHECK_RUN(0, NULL, BAKE " -o again --force --keep-gathered --threads 3");
    CHECK_RUN(0, NULL, "cd " OUTPUT " && cmp kept/gathered-probes.bin again/gathered-probes.bin");
    CHECK_RUN(0, "current", BAKE " -o kept --keep-gathered");
    CHECK_RUN(0, "current", BAKE BOX " -o kept");
    CHECK_RUN(0, "written",
              LMB_COMMAND " bake " LEVEL " --spacing 1 --samples 8 --no-denoise --keep-gathered -o " OUTPUT "/plain");
    CHECK_RUN(0, NULL, "test -e " OUTPUT "/plain/gathered-probes.bin");
    CHECK_RUN(0, NULL, BAKE " -o plain --force && test ! -e " OUTPUT "/plain/gathered-probes.bin");
    /* Another level: the box is baked once, the whole always. */
    if (corridor_make(60.0f, -8.0f)) {
        CHECK_RUN(3, "holds no gathered probes", BAKE BOX " -o plain");
        CHECK_RUN(0, "corridor.glb: changed since it was baked into plain (lights): all is baked anew",
                  "cd " OUTPUT " && " LMB_COMMAND " bake " LEVEL " --spacing 1 --samples 8 --no-denoise -o plain");
        CHECK_RUN(3, "other settings", BAKE BOX " --seed 1 -o kept");
        CHECK_RUN(0, NULL, BAKE BOX " -o kept && grep -q '\"only\"' " OUTPUT "/kept/bake.json");
        CHECK_RUN(0, "current", BAKE BOX " -o kept");
        CHECK_RUN(0, NULL, BAKE " -o kept --keep-gathered && ! grep -q '\"only\"' " OUTPUT "/kept/bake.json");
    }
    if (corridor_make(30.0f, -8.0f)) {
        CHECK_RUN(0, NULL, "cd " OUTPUT " && truncate -s 100000 kept/gathered-probes.bin && cp -r kept before");
        CHECK_RUN(3, "gathered-probes.bin: ", BAKE BOX " -o kept");
        CHECK_RUN(0, NULL,
                  "cd " OUTPUT " && printf 'xxxx' | dd of=again/gathered-probes.bin bs=1 seek=90000 "
                  "conv=notrunc 2> /dev/null");
        CHECK_RUN(3, "gathered-probes.bin: ", BAKE BOX " -o again");
        CHECK_RUN(0, NULL, "cd " OUTPUT " && diff -r kept before && rm -r before");
    }
    /* A disk that is full, to begin with. */
    CHECK_RUN(0, NULL, BAKE " -o full --force && cp -r full before");
    CHECK_RUN(1, "full/gathered-probes.bin: cannot be written",
              "trap '' XFSZ; ulimit -f 60; " BAKE " --force --keep-gathered -o full");
    CHECK_RUN(0, NULL, "cd " OUTPUT " && diff -r full before && rm -r before");
    CHECK_RUN(0, NULL, "cd " OUTPUT " && rm -rf s1 s2 && " BAKE " --shard 1/2 -o s1 && " BAKE " --shard 2/2 -o s2");
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && " BAKE " --force --keep-gathered -o full && " LMB_COMMAND
              " merge s1 s2 -o both --keep-gathered --quiet && cmp full/gathered-probes.bin "
              "both/gathered-probes.bin");
    CHECK_RUN(2, "two corners", BAKE " --only 1,2,3,4,5 -o other");
    CHECK_RUN(2, "--shard does not go with", BAKE BOX " --shard 1/2 -o other");
    CHECK_RUN(2, "lambent merge", BAKE " --keep-gathered --shard 1/2 -o other");
#undef BOX
#undef BAKE
}

static const test_case cases[] = {
    {"a lamp changes", a_lamp_changes},       {"denoising has a rim", denoising_has_a_rim},
    {"a block moves", a_block_moves},         {"another sun is everywhere", another_sun_is_everywhere},
    {"changes are named", changes_are_named}, {"commands say what is wrong", commands_say_what_is_wrong},
};

TEST_MAIN(cases)
