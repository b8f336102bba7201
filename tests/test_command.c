/* The `lambent` command from outside: exit statuses, JSON keys, files, and the same bytes for any thread count. */
#define _POSIX_C_SOURCE 200809L
#include <signal.h>
#include <sys/stat.h>
#include <time.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/command"
#define LEVEL OUTPUT "/cornell box é.glb" /* a space and a letter beyond ASCII, on purpose */
#define QUOTED "'" LEVEL "'"
#define BAKE_OPTIONS " --spacing 0.25 --samples 16 --lightmaps --texels-per-m 6 --quiet "

static bool level_make(void)
{
    return cornell_make(OUTPUT, LEVEL);
}

static void exit_statuses(void)
{
    static const struct {
        const char *arguments;
        int status;
        const char *says;
    } table[] = {
        {"", 2, "usage"},
        {"--help", 0, "bake"},
        {"--version", 0, "lambent 0."},
        {"frobnicate", 2, "no command 'frobnicate'"},
        {"bake --help", 0, "--spacing"},
        {"bench --help", 0, "--rays"},
        {"bench", 2, "--rays LEVEL"},
        {"bench " OUTPUT " --spacing 1", 2, "unknown option --spacing"},
        {"bench " OUTPUT "/missing", 3, "missing/probes.lmb"},
        {"bench --rays", 2, "--rays"},
        {"bench --rays " OUTPUT "/missing.glb", 3, "missing.glb"},
        {"check --help", 0, "usage"},
        {"render --help", 0, "--camera"},
        {"bake", 2, "LEVEL"},
        {"bake " QUOTED, 2, "-o DIR"},
        {"bake " QUOTED " -o " OUTPUT "/x --spacing -1", 2, "--spacing takes"},
        {"bake " QUOTED " -o " OUTPUT "/x --spacing", 2, "--spacing"},
        {"bake " QUOTED " -o " OUTPUT "/x --quality best", 2, "draft"},
        {"bake " QUOTED " -o " OUTPUT "/x --padding 0", 2, "--padding takes"},
        {"bake " QUOTED " --dry-run --spacing 0.5 --samples 1 --exclude 'no such' ", 0, "no such"},
        {"bake " QUOTED " --dry-run --spacing 0.5 --samples 1 --lightmaps --texels-per-m 3000", 0, "not 3000"},
        {"bake " QUOTED " -o " OUTPUT "/x --estimator guess", 2, "cached or reference"},
        {"bake " QUOTED " -o " OUTPUT "/x --colour", 2, "--colour"},
        {"bake " QUOTED " -o " OUTPUT "/x --light-scale 0", 2, "--light-scale takes"},
        {"bake " QUOTED " -o " OUTPUT "/x --emission-scale x", 2, "--emission-scale takes"},
        {"bake " OUTPUT "/missing.glb -o " OUTPUT "/x", 3, "missing.glb"},
        {"bake " OUTPUT " -o " OUTPUT "/x", 3, "command"},
        {"bake " QUOTED " -o " OUTPUT "/x --env missing.hdr", 3, "missing.hdr"},
        {"bake " QUOTED " -o " OUTPUT "/x --quiet --exclude '*'", 3, "no static triangles"},
        {"bake " QUOTED " -o /dev/null/x --samples 1 --spacing 1", 1, "/dev/null"},
        {"bake " QUOTED " -o " OUTPUT "/x --isa z80", 3, "z80"},
        {"bake " QUOTED " -o " OUTPUT "/x --spacing 0.000001", 3, "too fine"},
        {"info " QUOTED, 3, "cornell"},
        {"info " OUTPUT "/missing.lmb", 3, "missing.lmb"},
        {"info " OUTPUT "/missing.vdb --at 1", 2, "--slices DIR has to go with --at"},
        {"info " OUTPUT "/missing.vdb --slices x --axis w", 2, "--axis takes"},
        {"info " OUTPUT "/missing.vdb --slices x --at nan", 2, "--at takes"},
        {"info " QUOTED " --slices x", 3, "--slices takes a .vdb"},
        {"sample " QUOTED " --at 0,0,0", 3, "cornell"},
        {"sample x.lmb --at 0,0", 2, "--at takes"},
        {"probe " QUOTED " --at 0,1,0 --vertex-normal 0,1,0", 2, "--normal"},
        {"check " QUOTED " " OUTPUT "/missing", 3, "missing"},
        {"render " QUOTED " " OUTPUT "/missing -o x.png", 3, "missing"},
        {"render " QUOTED " " OUTPUT "/missing -o x.png --probes --mode difference", 2, "--probes does not go with"},
    };
    if (!level_make()) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        char command[1024], printed[8192];
        snprintf(command, sizeof command, LMB_COMMAND " %s", table[i].arguments);
        const int status = run(printed, sizeof printed, command);
        CHECK(status == table[i].status, "lambent %s: exits with %d, not %d: %s", table[i].arguments, status,
              table[i].status, printed);
        CHECK(strstr(printed, table[i].says), "lambent %s: does not say '%s' but: %s", table[i].arguments,
              table[i].says, printed);
        CHECK(table[i].status != 3 || (strchr(printed, '\n') && !strchr(strchr(printed, '\n') + 1, '\n')),
              "lambent %s: more than one line: %s", table[i].arguments, printed);
    }
    CHECK(access(OUTPUT "/x", F_OK) != 0, "a failed bake left a folder");
}

static bool has_keys(const cJSON *json, const char *const *keys, const char *where)
{
    bool all = true;
    for (; *keys; ++keys) {
        const bool has = cJSON_HasObjectItem(json, *keys);
        CHECK(has, "%s: no key '%s'", where, *keys);
        all = all && has;
    }
    return all;
}

static cJSON *file_json(const char *path)
{
    unsigned char *text;
    size_t size;
    lmb_error error;
    const lmb_result result = lmb_file_read(path, &text, &size, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    cJSON *json = result == LMB_OK ? cJSON_ParseWithLength((const char *)text, size) : NULL;
    if (result == LMB_OK) {
        free(text);
    }
    return json;
}

/* bake.json without what may differ from run to run. */
static char *record_text(const char *directory)
{
    static const char *const keys[] = {
        "probes",    "levels", "cells_crossed",       "rays",  "seconds", "threads",  "mrays_per_s", "peak_rss_mb",
        "estimator", "seed",   "estimated_rel_error", "bytes", "files",   "settings", NULL};
    static const char *const phases[] = {"load",      "bvh",   "surface", "place", "probes",
                                         "lightmaps", "write", "total",   NULL};
    static const char *const free_keys[] = {"seconds", "mrays_per_s", "peak_rss_mb", "threads"};
    char path[512];
    snprintf(path, sizeof path, "%s/bake.json", directory);
    cJSON *json = file_json(path);
    has_keys(json, keys, path);
    has_keys(cJSON_GetObjectItem(json, "seconds"), phases, path);
    for (size_t i = 0; i < sizeof free_keys / sizeof free_keys[0]; ++i) {
        cJSON_DeleteItemFromObject(json, free_keys[i]);
    }
    char *text = cJSON_PrintUnformatted(json);
    cJSON_Delete(json);
    return text;
}

static void threads_give_equal_bytes(void)
{
    static const int threads[] = {1, 2, 7};
    char printed[4096];
    if (!level_make()) {
        return;
    }
    for (int i = 0; i < 3; ++i) {
        char command[1024];
        snprintf(command, sizeof command, LMB_COMMAND " bake " QUOTED " -o " OUTPUT "/t%d --threads %d" BAKE_OPTIONS,
                 threads[i], threads[i]);
        CHECK(run(printed, sizeof printed, command) == 0, "%d threads: %s", threads[i], printed);
    }
    char *one = record_text(OUTPUT "/t1");
    for (int i = 1; i < 3; ++i) {
        char command[1024], directory[512];
        snprintf(command, sizeof command, "diff -r --exclude=bake.json " OUTPUT "/t1 " OUTPUT "/t%d", threads[i]);
        CHECK(run(printed, sizeof printed, command) == 0, "%d threads: %s", threads[i], printed);
        snprintf(directory, sizeof directory, OUTPUT "/t%d", threads[i]);
        char *text = record_text(directory);
        CHECK(one && text && strcmp(one, text) == 0, "%d threads: bake.json differs:\n%s\n%s", threads[i], one, text);
        free(text);
    }
    free(one);
}

static bool baked(char *printed, size_t size)
{
    if (!level_make()) {
        return false;
    }
    const int status = run(printed, size, LMB_COMMAND " bake " QUOTED " -o " OUTPUT "/b --force" BAKE_OPTIONS);
    CHECK(status == 0, "%s", printed);
    return status == 0;
}

static void json_outputs(void)
{
    static const struct {
        const char *command;
        const char *keys[20];
    } table[] = {
        {" info --json " OUTPUT "/b/probes.lmb",
         {"kind", "probes", "spacing", "levels", "cut_cells", "compact", "bytes", NULL}},
        {" info --json " OUTPUT "/b/probes.vdb",
         {"kind", "probes", "ghosts", "cut_cells", "levels", "settings", "scene_hash", NULL}},
        {" info --json " OUTPUT "/b/probes.vdb --slices " OUTPUT "/slices --axis x", {"kind", "slices_at", NULL}},
        {" info --json " OUTPUT "/b/lightmap/lightmap_0.exr", {"kind", "width", "height", "channels", NULL}},
        {" sample --json " OUTPUT "/b/probes.lmb --at 0,1,0 --normal 0,1,0",
         {"position", "normal", "irradiance", "sh3", "outside", NULL}},
        {" probe --json " QUOTED " --at 0,1,0 --normal 0,1,0 --samples 64",
         {"position", "sh3", "std_error", "rays", "seconds", "irradiance", "traced_irradiance", NULL}},
        {" check --json --quiet --points 64 --samples 16 " QUOTED " " OUTPUT "/b",
         {"points", "probe_vs_reference", "lightmap_vs_reference", "probe_vs_lightmap", "coincident_probe_vs_lightmap",
          "coincident_probe_vs_reference", "unoccluded_probe_vs_lightmap", "probe_hlsh_vs_reference",
          "volume_vs_reference", "probe_cone_vs_lightmap", "reference_std_error", "leak", NULL}},
    };
    static char printed[65536];
    if (!baked(printed, sizeof printed)) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        char command[1024];
        snprintf(command, sizeof command, LMB_COMMAND "%s", table[i].command);
        CHECK(run(printed, sizeof printed, command) == 0, "%s: %s", table[i].command, printed);
        cJSON *json = cJSON_Parse(printed);
        CHECK(json, "%s: not JSON: %s", table[i].command, printed);
        has_keys(json, table[i].keys, table[i].command);
        cJSON_Delete(json);
    }
}

/* What scales the level's light is part of the record, so that check and render find the same level. */
static void scales_are_kept(void)
{
    char printed[4096];
    if (!level_make()) {
        return;
    }
    CHECK(run(printed, sizeof printed,
              LMB_COMMAND " bake " QUOTED " -o " OUTPUT "/scaled --light-scale 0.25 --emission-scale 3 --samples 16 "
                          "--spacing 1 --quiet") == 0,
          "%s", printed);
    cJSON *record = file_json(OUTPUT "/scaled/bake.json");
    const cJSON *settings = cJSON_GetObjectItem(record, "settings");
    CHECK_NEAR(cJSON_GetNumberValue(cJSON_GetObjectItem(settings, "light_scale")), 0.25, 0.0, "bake.json");
    CHECK_NEAR(cJSON_GetNumberValue(cJSON_GetObjectItem(settings, "emission_scale")), 3.0, 0.0, "bake.json");
    cJSON_Delete(record);
    CHECK(run(printed, sizeof printed,
              LMB_COMMAND " check --quiet --points 16 --samples 16 " QUOTED " " OUTPUT "/scaled") == 0,
          "%s", printed);
}

/* Every sampler gives the light of the same probes: fp16 within its rounding, the others within that of floats. */
static void bench_times_samplers_that_agree(void)
{
    static const char *const keys[] = {"name",          "pattern",  "probes", "bytes_per_probe",
                                       "ns_per_sample", "rel_rmse", NULL};
    static const char *const names[] = {"lambent",
                                        "lambent.batch",
                                        "dense.fp32",
                                        "dense.fp32.prefetch",
                                        "dense.fp16",
                                        "dense.fp16.prefetch",
                                        "openvdb",
                                        "lambent.compact",
                                        "lambent.compact.batch",
                                        "lambent.cut",
                                        "lambent.cut.batch",
                                        "lambent.tiles",
                                        "lambent.tiles.batch"};
    enum { NAMES = sizeof names / sizeof names[0] };
    int found[NAMES][2] = {{0}};
    char printed[16384];
    if (!baked(printed, sizeof printed)) {
        return;
    }
    CHECK(run(printed, sizeof printed, LMB_COMMAND " bench --json --repeat 1 --samples 3000 " OUTPUT "/b") == 0, "%s",
          printed);
    cJSON *json = cJSON_Parse(printed);
    CHECK(cJSON_IsString(cJSON_GetObjectItem(json, "machine")), "%s", printed);
    const cJSON *sampler;
    cJSON_ArrayForEach(sampler, cJSON_GetObjectItem(json, "samplers"))
    {
        CHECK(has_keys(sampler, keys, "sampler"), "%s", printed);
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(sampler, "name"));
        const char *pattern = cJSON_GetStringValue(cJSON_GetObjectItem(sampler, "pattern"));
        const double error = cJSON_GetNumberValue(cJSON_GetObjectItem(sampler, "rel_rmse"));
        /* Halfs and floats of one volume; bytes over a mean are allowed half a percent. */
        const double most = strstr(name, "compact") ? 5e-3 : 1e-5;
        CHECK(error >= 0.0 && error < most, "%s, %s: %g", name, pattern, error);
        CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(sampler, "ns_per_sample")) > 0.0, "%s, %s", name, pattern);
        for (int i = 0; i < NAMES; ++i) {
            found[i][strcmp(pattern, "random") == 0] += strcmp(name, names[i]) == 0;
        }
    }
    for (int i = 0; i < NAMES; ++i) {
        CHECK(found[i][0] == 1 && found[i][1] == 1, "%s: %d and %d times", names[i], found[i][0], found[i][1]);
    }
    cJSON_Delete(json);
    CHECK(run(printed, sizeof printed, LMB_COMMAND " bench --repeat 1 --samples 300 " OUTPUT "/b") == 0 &&
              strstr(printed, "dense.fp16.prefetch"),
          "%s", printed);
}

/* The bench traces what the bake does, and bare Embree takes some time for it. */
static void bench_counts_the_bakes_rays(void)
{
    static const char *const keys[] = {"machine", "threads", "phases",    "rays",       "seconds", "mrays_per_s",
                                       "ratio",   "scaling", "cpu_ratio", "best_ratio", NULL};
    static const char *const phase_keys[] = {"name",  "rays", "recorded", "seconds", "mrays_per_s", "bare_mrays_per_s",
                                             "ratio", "best", NULL};
    char printed[16384];
    if (!baked(printed, sizeof printed)) {
        return;
    }
    CHECK(run(printed, sizeof printed,
              LMB_COMMAND " bench --json --repeat 1 --threads 2 --rays " QUOTED
                          " --spacing 0.25 --samples 16 --texels-per-m 6") == 0,
          "%s", printed);
    cJSON *json = cJSON_Parse(printed);
    CHECK(has_keys(json, keys, "bench"), "%s", printed);
    cJSON *record = file_json(OUTPUT "/b/bake.json");
    const cJSON *baked_rays = cJSON_GetObjectItem(record, "phase_rays");
    const cJSON *phase;
    int phases = 0;
    cJSON_ArrayForEach(phase, cJSON_GetObjectItem(json, "phases"))
    {
        CHECK(has_keys(phase, phase_keys, "phase"), "%s", printed);
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(phase, "name"));
        const double rays = cJSON_GetNumberValue(cJSON_GetObjectItem(phase, "rays"));
        const double counted = cJSON_GetNumberValue(cJSON_GetObjectItem(baked_rays, name));
        /* Lightmaps do not count the rays that look whether a texel lies in a solid. */
        const bool agree = strcmp(name, "lightmaps") == 0 ? rays >= counted : rays == counted;
        CHECK(counted > 0.0 && agree, "%s: %.0f rays, in bake.json %.0f", name, rays, counted);
        const double recorded = cJSON_GetNumberValue(cJSON_GetObjectItem(phase, "recorded"));
        CHECK(recorded > 0.0 && recorded <= rays, "%s: %.0f recorded of %.0f", name, recorded, rays);
        const double ratio = cJSON_GetNumberValue(cJSON_GetObjectItem(phase, "ratio"));
        CHECK(ratio > 0.0 && isfinite(ratio), "%s: %g", name, ratio);
        ++phases;
    }
    CHECK(phases == 4, "%d phases", phases);
    cJSON_Delete(record);
    cJSON_Delete(json);
}

/* JSON progress: phases in order, none going back, time left once there is a forecast; then the result. */
static void progress_runs_forward(void)
{
    static const char *const keys[] = {"phase", "done", "seconds", "seconds_left", "total_seconds", "total_done", NULL};
    static const char *const result_keys[] = {"directory",   "probes",  "texels", "samples",     "rays",
                                              "mrays_per_s", "seconds", "bytes",  "peak_rss_mb", "estimated_rel_error",
                                              NULL};
    char printed[65536];
    if (!level_make()) {
        return;
    }
    CHECK(run(printed, sizeof printed,
              LMB_COMMAND " bake " QUOTED " -o " OUTPUT "/p --force --json-progress" BAKE_OPTIONS) == 0,
          "%s", printed);
    char phase[64] = "";
    double done = 0.0, total_seconds = 0.0, total_done = 0.0, left = -1.0;
    int phases = 0, results = 0;
    for (char *line = strtok(printed, "\n"); line; line = strtok(NULL, "\n")) {
        cJSON *json = cJSON_Parse(line);
        CHECK(results == 0, "after the result: %s", line);
        if (cJSON_HasObjectItem(json, "result")) {
            has_keys(cJSON_GetObjectItem(json, "result"), result_keys, line);
            ++results;
            cJSON_Delete(json);
            continue;
        }
        CHECK(has_keys(json, keys, line), "%s", line);
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(json, "phase"));
        if (name && strcmp(name, phase) != 0) {
            snprintf(phase, sizeof phase, "%s", name);
            done = 0.0;
            ++phases;
        }
        CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(json, "done")) >= done, "%s", line);
        CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(json, "total_seconds")) >= total_seconds, "%s", line);
        CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(json, "total_done")) >= total_done, "%s", line);
        done = cJSON_GetNumberValue(cJSON_GetObjectItem(json, "done"));
        total_seconds = cJSON_GetNumberValue(cJSON_GetObjectItem(json, "total_seconds"));
        total_done = cJSON_GetNumberValue(cJSON_GetObjectItem(json, "total_done"));
        left = cJSON_GetNumberValue(cJSON_GetObjectItem(json, "seconds_left"));
        cJSON_Delete(json);
    }
    CHECK(results == 1, "%d results", results);
    CHECK(phases == 11 && strcmp(phase, "write") == 0, "%d phases, the last %s", phases, phase);
    CHECK(done == 1.0 && left >= 0.0 && total_done > 0.0 && total_done <= 1.0, "%g done, %g left, %g in all", done,
          left, total_done);
}

static void many_points_on_standard_input(void)
{
    char printed[8192];
    if (!baked(printed, sizeof printed)) {
        return;
    }
    const char *good =
        "printf '0 1 0\\n\\n0 1 0 0 1 0\\n0 1 0 0 1 0 0.5\\n0 1 0 0 1 0 0 0 1 0\\n9 9 9\\n' | " LMB_COMMAND
        " sample --json " OUTPUT "/b/probes.lmb";
    CHECK(run(printed, sizeof printed, good) == 0, "%s", printed);
    int lines = 0;
    for (const char *at = printed; (at = strchr(at, '\n')); ++at) {
        ++lines;
    }
    CHECK(lines == 5, "%d lines: %s", lines, printed);
    CHECK(strstr(printed, "\"outside\":true"), "%s", printed);
    const char *bad = "printf '0 1 0\\n0 1\\n' | " LMB_COMMAND " sample " OUTPUT "/b/probes.lmb";
    CHECK(run(printed, sizeof printed, bad) == 3, "%s", printed);
    CHECK(strstr(printed, "standard input:2:"), "%s", printed);
}

static void pictures(void)
{
    char printed[8192];
    if (!baked(printed, sizeof printed)) {
        return;
    }
    CHECK(run(printed, sizeof printed,
              LMB_COMMAND " render " QUOTED " " OUTPUT "/b -o " OUTPUT "/shot.png --size 64x36 --quiet"
                          " --object-at 0,0.5,0") == 0,
          "%s", printed);
    CHECK(run(printed, sizeof printed,
              LMB_COMMAND " render " QUOTED " " OUTPUT "/b -o " OUTPUT "/shot.exr --size 64x36 --quiet"
                          " --mode reference --samples 4") == 0,
          "%s", printed);
    CHECK(run(printed, sizeof printed, "file " OUTPUT "/shot.png || true") == 0, "%s", printed);
    CHECK(access(OUTPUT "/shot.exr", R_OK) == 0, "no EXR");
}

/* Lightmaps of another model are drawn and measured where the bake has them, and refused in a line where not. */
static void other_models(void)
{
    const char *const options = " --size 32x18 --quiet --mode lightmap";
    if (!level_make()) {
        return;
    }
    CHECK_RUN(0, NULL, LMB_COMMAND " bake " QUOTED " -o " OUTPUT "/m --models rnm,sh2" BAKE_OPTIONS);
    CHECK_RUN(0, NULL, LMB_COMMAND " render " QUOTED " " OUTPUT "/m -o " OUTPUT "/own.exr %s", options);
    CHECK_RUN(0, NULL, LMB_COMMAND " render " QUOTED " " OUTPUT "/m -o " OUTPUT "/rnm.exr --model rnm %s", options);
    CHECK_RUN(1, NULL, "cmp -s " OUTPUT "/own.exr " OUTPUT "/rnm.exr");
    CHECK_RUN(0, "lightmap_vs_reference",
              LMB_COMMAND " check " QUOTED " " OUTPUT "/m --model sh2 --points 20 --samples 16 --quiet");
    CHECK_RUN(3, "no texels of the model 'hlsh'",
              LMB_COMMAND " render " QUOTED " " OUTPUT "/m -o " OUTPUT "/none.exr --model hlsh %s", options);
    CHECK_RUN(2, "no lightmap has the model", LMB_COMMAND " check " QUOTED " " OUTPUT "/m --model frob");
}

/* The level must be the one that was baked. */
static void another_level_is_refused(void)
{
    char printed[8192];
    lmb_error error;
    if (!baked(printed, sizeof printed)) {
        return;
    }
    CHECK(lmb_level_open_ground(OUTPUT "/other.glb", 4.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    CHECK(run(printed, sizeof printed, LMB_COMMAND " check " OUTPUT "/other.glb " OUTPUT "/b") == 3, "%s", printed);
    CHECK(strstr(printed, "bake again"), "%s", printed);
}

static void interruption_writes_nothing(void)
{
    if (!level_make()) {
        return;
    }
    char printed[4096];
    const int status = run(printed, sizeof printed,
                           "timeout --signal=INT --preserve-status 5 " LMB_COMMAND " bake " QUOTED " -o " OUTPUT
                           "/interrupted --spacing 0.05 --samples 100000 --quiet");
    CHECK(status == 4, "exits with %d: %s", status, printed);
    CHECK(access(OUTPUT "/interrupted", F_OK) != 0, "an interrupted bake left a folder");
}

static void example_runs(void)
{
    char printed[8192];
    if (!baked(printed, sizeof printed)) {
        return;
    }
    CHECK(run(printed, sizeof printed, LMB_EXAMPLE " " OUTPUT "/b/probes.lmb") == 0, "%s", printed);
    CHECK(strstr(printed, "inside") && strstr(printed, "HHD"), "%s", printed);
    CHECK(run(printed, sizeof printed, LMB_EXAMPLE " " OUTPUT "/missing.lmb") == 1, "%s", printed);
}

static const test_case cases[] = {
    {"exit_statuses", exit_statuses},
    {"threads_give_equal_bytes", threads_give_equal_bytes},
    {"json_outputs", json_outputs},
    {"scales_are_kept", scales_are_kept},
    {"bench_times_samplers_that_agree", bench_times_samplers_that_agree},
    {"bench_counts_the_bakes_rays", bench_counts_the_bakes_rays},
    {"progress_runs_forward", progress_runs_forward},
    {"many_points_on_standard_input", many_points_on_standard_input},
    {"pictures", pictures},
    {"other_models", other_models},
    {"another_level_is_refused", another_level_is_refused},
    {"interruption_writes_nothing", interruption_writes_nothing},
    {"example_runs", example_runs},
};

TEST_MAIN(cases)
