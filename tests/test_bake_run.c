/* The library's bake: phases in order, warnings, settings as values, what a stopped bake leaves, and the documented
 * example. What its files hold, and what happens to them under signals and full disks, other tests ask of the command.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include <lambent/bake.h>
#include <lambent/baked.h>
#include <lambent/file.h>
#include <lambent/volume.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/bake_run"
#define LEVEL OUTPUT "/room.glb"

/* What a listener saw, and where it is to stop. */
typedef struct heard {
    bool seen[LMB_PHASE_COUNT], finished[LMB_PHASE_COUNT];
    lmb_bake_progress last;
    int reports, faults, warnings;
    char warning[512];
    lmb_bake_phase stop_at; /* LMB_PHASE_COUNT: nowhere */
    double stop_done;
    bool abandons; /* whether it abandons the folder before */
    lmb_bake_folder *folder;
} heard;

/* Phases never go back, shares of one never fall (bounces begin anew with each pass), and once there is a forecast
 * there always is one. */
static bool report_hear(void *context, const lmb_bake_progress *progress)
{
    heard *all = context;
    const lmb_bake_progress *last = &all->last;
    const bool same = all->reports > 0 && progress->phase == last->phase;
    const bool good = progress->phase >= last->phase && progress->phase < LMB_PHASE_COUNT && progress->done >= 0.0 &&
                      progress->done <= 1.0 &&
                      (!same || progress->phase == LMB_PHASE_BOUNCES || progress->done >= last->done) &&
                      (progress->seconds_left >= 0.0) == (progress->phase >= LMB_PHASE_PILOT);
    CHECK(good, "%s %g after %s %g, %g s left", lmb_bake_phase_name(progress->phase), progress->done,
          lmb_bake_phase_name(last->phase), last->done, progress->seconds_left);
    all->seen[progress->phase] = true;
    all->finished[progress->phase] |= progress->done >= 1.0;
    all->last = *progress;
    ++all->reports;
    const bool stops = progress->phase == all->stop_at && progress->done >= all->stop_done;
    if (stops && all->abandons) {
        lmb_bake_folder_abandon(all->folder);
    }
    return !stops;
}

static void warning_hear(void *context, const char *line)
{
    heard *all = context;
    ++all->warnings;
    snprintf(all->warning, sizeof all->warning, "%s", line);
}

static lmb_bake_listener listener_of(heard *all)
{
    return (lmb_bake_listener){report_hear, all, {warning_hear, all}};
}

static lmb_bake_settings small_settings(void)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = LEVEL;
    settings.level.threads = 2;
    settings.spacing = 0.5f;
    settings.min_spacing = 0.25f; /* tried, and with this tolerance no probe is there */
    settings.tolerance = 1e6;
    settings.samples = settings.max_samples = 8;
    settings.lightmaps = true;
    settings.texels_per_m = 4.0f;
    return settings;
}

/* One bake into `directory`, heard by `all`. */
static lmb_result bake_into(const char *directory, const lmb_bake_settings *settings, heard *all,
                            lmb_bake_record *record, lmb_error *error)
{
    lmb_bake_folder *folder;
    lmb_result result = lmb_bake_folder_open(directory, settings->lightmaps, &folder, error);
    if (result == LMB_OK) {
        const lmb_bake_listener listener = listener_of(all);
        all->folder = folder;
        result = lmb_bake_run(settings, folder, &listener, record, error);
        lmb_bake_folder_close(folder);
    }
    return result;
}

static bool room_bake(const char *directory, const lmb_bake_settings *settings, lmb_bake_record *record)
{
    lmb_error error = {{0}};
    heard all = {.stop_at = LMB_PHASE_COUNT};
    const lmb_result result = bake_into(directory, settings, &all, record, &error);
    CHECK(result == LMB_OK, "%s: %s", directory, error.message);
    return result == LMB_OK;
}

static uint64_t file_hash(const char *path)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_error error = {{0}};
    const lmb_result result = lmb_file_read(path, &data, &size, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    const uint64_t hash = result == LMB_OK ? lmb_hash(LMB_HASH_SEED, data, size) : 0;
    free(data);
    return hash;
}

static void phases_come_in_order(void)
{
    if (!cornell_make(OUTPUT, LEVEL)) {
        return;
    }
    const lmb_bake_settings settings = small_settings();
    heard all = {.stop_at = LMB_PHASE_COUNT};
    lmb_bake_record record;
    lmb_error error = {{0}};
    CHECK(bake_into(OUTPUT "/order", &settings, &all, &record, &error) == LMB_OK, "%s", error.message);
    for (int phase = 0; phase < LMB_PHASE_COUNT; ++phase) {
        const char *name = lmb_bake_phase_name((lmb_bake_phase)phase);
        CHECK(all.seen[phase] && all.finished[phase], "%s: not finished", name);
        CHECK(lmb_bake_phase_find(name) == (lmb_bake_phase)phase, "%s", name);
    }
    CHECK(lmb_bake_phase_find("no phase") == LMB_PHASE_COUNT, "a phase of no name");
    CHECK(all.last.phase == LMB_PHASE_WRITE && all.last.done == 1.0 && all.last.seconds_left == 0.0, "ends with %s %g",
          lmb_bake_phase_name(all.last.phase), all.last.done);
    CHECK(all.warnings == 0, "%s", all.warning);
    CHECK(record.probes > 0 && record.lightmap.elements > 0 && record.surface_solved && record.images == 1, "%d probes",
          record.probes);
    CHECK(lmb_bake_record_rays(&record) > 0 && lmb_bake_record_error(&record) > 0.0, "no rays");
}

/* Levels of probes: files and record have them, the same for any number of threads, and the record's settings make
 * them again. */
static void levels_are_baked(void)
{
    static const int threads[] = {1, 2, 5};
    uint64_t lmb[4] = {0}, vdb[4] = {0};
    lmb_bake_record record;
    lmb_bake_settings settings = small_settings();
    settings.lightmaps = false;
    settings.spacing = 1.0f;
    settings.min_spacing = 0.25f;
    settings.tolerance = 0.1;
    if (!cornell_make(OUTPUT, LEVEL)) {
        return;
    }
    for (int i = 0; i < 4; ++i) {
        if (i == 3) {
            settings = record.settings;
        }
        settings.level.threads = threads[i % 3];
        if (!room_bake(OUTPUT "/levels", &settings, &record)) {
            return;
        }
        lmb[i] = file_hash(OUTPUT "/levels/probes.lmb");
        vdb[i] = file_hash(OUTPUT "/levels/probes.vdb");
        CHECK(lmb[i] == lmb[0] && vdb[i] == vdb[0], "bake %d", i);
    }
    CHECK(record.level_count > 1 && record.placement.probes_hanging > 0, "%u levels", record.level_count);
    int32_t probes = 0;
    for (uint32_t i = 0; i < record.level_count; ++i) {
        const double spacing = (double)record.level[i].spacing;
        probes += record.level[i].probes;
        CHECK(spacing == ldexp((double)record.level[0].spacing, (int)i) && spacing >= 0.25 && spacing <= 1.0, "%g m",
              spacing);
    }
    CHECK(probes == record.probes, "%d of %d", probes, record.probes);
}

static void warnings_arrive(void)
{
    lmb_error error = {{0}};
    mkdir(OUTPUT, 0777);
    CHECK(lmb_level_open_ground(OUTPUT "/ground.glb", 4.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    lmb_bake_settings settings = small_settings();
    settings.level.path = OUTPUT "/ground.glb";
    settings.lightmaps = false;
    settings.min_spacing = 0.0f;
    settings.estimator = LMB_ESTIMATOR_REFERENCE;
    heard all = {.stop_at = LMB_PHASE_COUNT};
    lmb_bake_record record;
    CHECK(bake_into(OUTPUT "/ground", &settings, &all, &record, &error) == LMB_OK, "%s", error.message);
    CHECK(all.warnings == 1 && strstr(all.warning, "no light of any kind"), "%d warnings: %s", all.warnings,
          all.warning);
    CHECK(!all.seen[LMB_PHASE_LAYOUT] && !all.seen[LMB_PHASE_LEVELS] && !all.seen[LMB_PHASE_SURFACE] &&
              !all.seen[LMB_PHASE_LIGHTMAPS] && all.finished[LMB_PHASE_WRITE],
          "phases that there was nothing to do for");
    CHECK(!record.surface_solved && record.rays[LMB_PHASE_SURFACE] == 0, "surfaces were solved");
    lmb_bake_folder *folder;
    CHECK(lmb_bake_folder_open(OUTPUT "/ground", false, &folder, &error) == LMB_OK, "%s", error.message);
    CHECK(lmb_bake_run(&settings, folder, NULL, NULL, NULL) == LMB_OK, "a bake that nobody listens to");
    lmb_bake_folder_close(folder);
}

/* At the beginning and the end of every phase, with and without what a process does that ends there. */
static void stopped_bakes_leave_the_old(void)
{
    static char before[16384], after[16384];
    const lmb_bake_settings settings = small_settings();
    lmb_bake_record record;
    if (!cornell_make(OUTPUT, LEVEL) || !room_bake(OUTPUT "/stopped", &settings, &record)) {
        return;
    }
    lmb_bake_settings other = settings;
    other.samples = other.max_samples = 16;
    folder_state(OUTPUT "/stopped", before, sizeof before);
    for (int i = 0; i < 4 * LMB_PHASE_COUNT; ++i) {
        heard all = {.stop_at = (lmb_bake_phase)(i / 4), .stop_done = i % 2, .abandons = i % 4 >= 2};
        lmb_error error = {{0}};
        const char *name = lmb_bake_phase_name(all.stop_at);
        const lmb_result result = bake_into(OUTPUT "/stopped", &other, &all, NULL, &error);
        CHECK(result == LMB_ERROR_INTERRUPTED && error.message[0], "%s %g: %s", name, all.stop_done, error.message);
        folder_state(OUTPUT "/stopped", after, sizeof after);
        CHECK(strcmp(before, after) == 0, "stopped at %s %g: before\n%s\nand after\n%s", name, all.stop_done, before,
              after);
    }
}

static void settings_are_values(void)
{
    lmb_bake_settings settings = small_settings();
    settings.seeds[settings.seed_count++] = (lmb_vec3d){0.0, 1.0, 0.9};
    settings.level.exclude[settings.level.exclude_count++] = "no such node*";
    const lmb_bake_settings copy = settings;
    lmb_bake_record record, copied;
    if (!cornell_make(OUTPUT, LEVEL) || !room_bake(OUTPUT "/settings", &settings, &record)) {
        return;
    }
    memset(&settings, 0xff, sizeof settings); /* nothing in the copy points into it */
    if (!room_bake(OUTPUT "/copy", &copy, &copied)) {
        return;
    }
    static const char *const files[] = {"probes.lmb", "probes.vdb", "lightmap/lightmap_0.exr",
                                        "lightmap/lightmap_0_hhd.exr"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; ++i) {
        char first[512], second[512];
        snprintf(first, sizeof first, OUTPUT "/settings/%s", files[i]);
        snprintf(second, sizeof second, OUTPUT "/copy/%s", files[i]);
        CHECK(file_hash(first) == file_hash(second), "%s differs", files[i]);
    }
    /* Those of the record, complete, make the same again. */
    if (room_bake(OUTPUT "/copy", &record.settings, &copied)) {
        CHECK(file_hash(OUTPUT "/settings/probes.vdb") == file_hash(OUTPUT "/copy/probes.vdb"), "another bake");
    }
}

/* Half as dense along a line, where nothing else is asked for. */
static void drafts_are_coarse(void)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    lmb_bake_record whole, draft, asked;
    lmb_error error;
    settings.level.path = LEVEL;
    settings.lightmaps = true;
    if (!cornell_make(OUTPUT, LEVEL)) {
        return;
    }
    CHECK(lmb_bake_plan(&settings, NULL, &whole, &error) == LMB_OK, "medium");
    CHECK(lmb_bake_settings_quality(&settings, "draft"), "draft");
    CHECK(lmb_bake_plan(&settings, NULL, &draft, &error) == LMB_OK, "draft");
    settings.spacing = 0.75f;
    settings.texels_per_m = 3.0f;
    CHECK(lmb_bake_plan(&settings, NULL, &asked, &error) == LMB_OK, "asked");
    CHECK(draft.settings.spacing == 2.0f * whole.settings.spacing, "%g", (double)draft.settings.spacing);
    CHECK(draft.settings.texels_per_m == 0.5f * whole.settings.texels_per_m, "%g", (double)draft.settings.texels_per_m);
    CHECK(asked.settings.spacing == 0.75f && asked.settings.texels_per_m == 3.0f, "as asked");
}

static void qualities_have_names(void)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    const double medium = settings.noise;
    CHECK(lmb_bake_settings_quality(&settings, "draft") && settings.noise > medium, "%g", settings.noise);
    CHECK(lmb_bake_settings_quality(&settings, "high") && settings.noise < medium, "%g", settings.noise);
    CHECK(lmb_bake_settings_quality(&settings, "medium") && settings.noise == medium, "%g", settings.noise);
    CHECK(settings.detail == 1.0f, "%g", (double)settings.detail);
    CHECK(!lmb_bake_settings_quality(&settings, "good") && settings.noise == medium, "%g", settings.noise);
    lmb_estimator estimator = LMB_ESTIMATOR_CACHED;
    CHECK(lmb_estimator_find("reference", &estimator) && estimator == LMB_ESTIMATOR_REFERENCE, "reference");
    CHECK(!lmb_estimator_find("guessed", &estimator) && estimator == LMB_ESTIMATOR_REFERENCE, "guessed");
}

static void a_bake_opens_again(void)
{
    lmb_bake_settings settings = small_settings();
    settings.seeds[settings.seed_count++] = (lmb_vec3d){0.0, 1.0, 0.9};
    settings.level.exclude[settings.level.exclude_count++] = "no such node*";
    settings.level.seed = 7;
    settings.level.bounces = 3;
    settings.level.light_scale = 2.0;
    settings.padding = 2;
    lmb_bake_record record;
    lmb_error error = {{0}};
    lmb_baked baked;
    if (!cornell_make(OUTPUT, LEVEL) || !room_bake(OUTPUT "/again", &settings, &record)) {
        return;
    }
    CHECK(lmb_baked_open(NULL, OUTPUT "/again", 2, NULL, &baked, &error) == LMB_OK, "%s", error.message);
    if (!baked.volume) {
        return;
    }
    const lmb_bake_settings *read = &baked.settings, *used = &record.settings;
    CHECK(strcmp(read->level.path, LEVEL) == 0 && !read->level.environment && !read->level.isa, "%s", read->level.path);
    CHECK(read->level.exclude_count == 1 && strcmp(read->level.exclude[0], "no such node*") == 0, "exclude");
    CHECK(read->level.seed == 7 && read->level.bounces == 3 && read->level.light_scale == 2.0, "level");
    CHECK(read->seed_count == 1 && (float)read->seeds[0].z == (float)used->seeds[0].z && read->spacing == used->spacing,
          "probes");
    CHECK(read->samples == 8 && read->max_samples == 8 && read->tolerance == used->tolerance, "effort");
    CHECK(read->lightmaps && read->texels_per_m == 4.0f && read->padding == 2 &&
              read->max_image_size == used->max_image_size,
          "lightmaps");
    CHECK(baked.lightmap && baked.level.scene->content_hash == record.content_hash, "parts");
    lmb_baked_close(&baked);
}

/* Texels of all images, by lightmap.json. */
static double image_texels(const char *path)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_error error = {{0}};
    CHECK(lmb_file_read(path, &data, &size, &error) == LMB_OK, "%s", error.message);
    cJSON *json = cJSON_ParseWithLength((const char *)data, size);
    double texels = 0.0;
    const cJSON *image;
    cJSON_ArrayForEach(image, cJSON_GetObjectItem(json, "images"))
    {
        texels += cJSON_GetNumberValue(cJSON_GetObjectItem(image, "width")) *
                  cJSON_GetNumberValue(cJSON_GetObjectItem(image, "height"));
    }
    cJSON_Delete(json);
    free(data);
    return texels;
}

/* The text is bake.json without its files and their hashes. */
static void the_record_is_what_lies_there(void)
{
    const lmb_bake_settings settings = small_settings();
    lmb_bake_record record;
    unsigned char *data;
    size_t size;
    if (!cornell_make(OUTPUT, LEVEL) || !room_bake(OUTPUT "/record", &settings, &record) ||
        lmb_file_read(OUTPUT "/record/bake.json", &data, &size, NULL) != LMB_OK) {
        return;
    }
    char *text = lmb_bake_record_text(&record);
    cJSON *told = cJSON_Parse(text), *there = cJSON_ParseWithLength((const char *)data, size);
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(there, "files")) == 5, "%s", (const char *)data);
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(there, "hashes")) == 5, "%s", (const char *)data);
    cJSON_DeleteItemFromObject(there, "files");
    cJSON_DeleteItemFromObject(there, "hashes");
    CHECK(cJSON_Compare(told, there, true), "told\n%s\nand there\n%s", text, (const char *)data);
    const double used = cJSON_GetNumberValue(cJSON_GetObjectItem(there, "texels_used"));
    const double expected = (double)record.lightmap.elements / image_texels(OUTPUT "/record/lightmap/lightmap.json");
    CHECK(used > 0.0 && used <= 1.0 && fabs(used - expected) < 1e-12, "%.17g of the images, not %.17g", used, expected);
    cJSON_Delete(told);
    cJSON_Delete(there);
    free(text);
    free(data);
}

static void a_plan_writes_nothing(void)
{
    const lmb_bake_settings settings = small_settings();
    heard all = {.stop_at = LMB_PHASE_COUNT};
    const lmb_bake_listener listener = listener_of(&all);
    lmb_bake_record plan, record;
    lmb_error error = {{0}};
    if (!cornell_make(OUTPUT, LEVEL) || !room_bake(OUTPUT "/plan", &settings, &record)) {
        return;
    }
    CHECK(lmb_bake_plan(&settings, &listener, &plan, &error) == LMB_OK, "%s", error.message);
    CHECK(plan.probes == record.probes && plan.texels_covered == record.texels_covered &&
              plan.texels_used == record.texels_used && plan.charts == record.charts &&
              plan.surface.cells == record.surface.cells && plan.expected_seconds > 0.0,
          "%d probes, %g s", plan.probes, plan.expected_seconds);
    CHECK(!all.seen[LMB_PHASE_PROBES] && !all.seen[LMB_PHASE_WRITE], "a plan gathers or writes");
}

static void wrong_calls_are_refused(void)
{
    lmb_bake_settings settings = small_settings();
    lmb_error error = {{0}};
    lmb_bake_folder *folder, *second;
    mkdir(OUTPUT, 0777);
    CHECK(lmb_bake_folder_open(OUTPUT "/wrong", false, &folder, &error) == LMB_OK, "%s", error.message);
    CHECK(lmb_bake_folder_open(OUTPUT "/wrong", false, &second, &error) == LMB_ERROR_WRITE &&
              strstr(error.message, "another bake"),
          "%s", error.message);
    CHECK(lmb_bake_run(&settings, folder, NULL, NULL, &error) == LMB_ERROR_ARGUMENT, "lightmaps into no such folder");
    CHECK(lmb_bake_run(&settings, NULL, NULL, NULL, &error) == LMB_ERROR_ARGUMENT, "no folder");
    settings.lightmaps = false;
    settings.level.path = NULL;
    CHECK(lmb_bake_run(&settings, folder, NULL, NULL, &error) == LMB_ERROR_ARGUMENT, "no level");
    CHECK(lmb_bake_plan(&settings, NULL, NULL, &error) == LMB_ERROR_ARGUMENT, "no level");
    settings.level.path = OUTPUT "/missing.glb";
    CHECK(lmb_bake_run(&settings, folder, NULL, NULL, &error) == LMB_ERROR_IO, "%s", error.message);
    lmb_bake_folder_close(folder);
    CHECK(access(OUTPUT "/wrong", F_OK) != 0, "a folder was left");
}

/* In a furnace radiance is emission / (1 - albedo) everywhere. */
static void the_example_bakes_a_furnace(void)
{
    lmb_error error = {{0}};
    mkdir(OUTPUT, 0777);
    const lmb_rgb emission = {{0.25f, 1.0f, 2.0f}};
    CHECK(lmb_level_furnace(OUTPUT "/furnace.glb", 4.0f, 0.5f, emission, false, &error) == LMB_OK, "%s", error.message);
    CHECK_RUN(0, "write         100 %, 0 s left", LMB_EXAMPLE " " OUTPUT "/furnace.glb " OUTPUT "/furnace");
    CHECK_RUN(1, "missing.glb", LMB_EXAMPLE " " OUTPUT "/missing.glb " OUTPUT "/furnace");
    CHECK_RUN(2, "usage", LMB_EXAMPLE);
    lmb_volume *volume;
    if (lmb_volume_open_file(OUTPUT "/furnace/probes.lmb", &volume) != LMB_OK) {
        CHECK(false, "the example wrote no volume");
        return;
    }
    lmb_sh3_rgb radiance;
    CHECK(lmb_volume_sample(volume, (lmb_vec3){0.3f, -0.2f, 0.1f}, &radiance), "outside");
    const lmb_rgb irradiance = lmb_sh3_rgb_irradiance(&radiance, (lmb_vec3){0.0f, 1.0f, 0.0f});
    for (int c = 0; c < 3; ++c) {
        CHECK_NEAR(irradiance.c[c], 2.0f * emission.c[c], 0.02f * emission.c[c], "channel %d", c);
    }
    lmb_volume_close(volume);
}

static void the_document_shows_the_example(void)
{
    unsigned char *example = NULL, *document = NULL;
    size_t example_size = 0, document_size = 0;
    lmb_error error = {{0}};
    CHECK(lmb_file_read(LMB_SOURCE_DIR "/bake/example/bake_level.c", &example, &example_size, &error) == LMB_OK &&
              lmb_file_read(LMB_SOURCE_DIR "/docs/baking.md", &document, &document_size, &error) == LMB_OK,
          "%s", error.message);
    if (example && document) {
        const char *shown = strstr((const char *)document, "```c\n");
        CHECK(shown && strncmp(shown + 5, (const char *)example, example_size) == 0 &&
                  strncmp(shown + 5 + example_size, "```\n", 4) == 0,
              "the first C block of docs/baking.md is not bake/example/bake_level.c");
    }
    free(example);
    free(document);
}

static const test_case cases[] = {
    {"phases_come_in_order", phases_come_in_order},
    {"levels_are_baked", levels_are_baked},
    {"warnings_arrive", warnings_arrive},
    {"stopped_bakes_leave_the_old", stopped_bakes_leave_the_old},
    {"settings_are_values", settings_are_values},
    {"drafts_are_coarse", drafts_are_coarse},
    {"qualities_have_names", qualities_have_names},
    {"a_bake_opens_again", a_bake_opens_again},
    {"the_record_is_what_lies_there", the_record_is_what_lies_there},
    {"a_plan_writes_nothing", a_plan_writes_nothing},
    {"wrong_calls_are_refused", wrong_calls_are_refused},
    {"the_example_bakes_a_furnace", the_example_bakes_a_furnace},
    {"the_document_shows_the_example", the_document_shows_the_example},
};

TEST_MAIN(cases)
