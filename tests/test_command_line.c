/* What programs rely on that run `lambent`: how arguments are read, what is said where, limits, and files that come
 * back edited. */
#define _POSIX_C_SOURCE 200809L
#include <sys/stat.h>

#include <cjson/cJSON.h>

#include <lambent/vdb.h>

#include "command_fixture.h"
#include "probes_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/command_line"
#define LEVEL "room.glb"
#define SMALL " --spacing 0.5 --samples 2 --quiet "
#define IN_OUTPUT "cd " OUTPUT " && "

static bool baked(void)
{
    static bool made;
    lmb_error error = {{0}};
    mkdir(OUTPUT, 0777);
    if (!made) {
        const lmb_result result = lmb_level_cornell(OUTPUT "/" LEVEL, &error);
        CHECK(result == LMB_OK, "%s", error.message);
        made = result == LMB_OK && CHECK_RUN(0, NULL,
                                             IN_OUTPUT LMB_COMMAND " bake " LEVEL " -o b --lightmaps "
                                                                   "--texels-per-m 4" SMALL);
    }
    return made;
}

static void arguments_are_read(void)
{
    static const struct {
        const char *arguments;
        int status;
        const char *says;
    } table[] = {
        {"help", 0, "lambent COMMAND --help"},
        {"help bake", 0, "usage: lambent bake"},
        {"help pack", 0, "usage: lambent pack"},
        {"help frobnicate", 2, "no command 'frobnicate'"},
        {"help bake more", 2, "usage"},
        {"bake --spacing=0.5 --samples=2 --quiet -o=e1 " LEVEL, 0, ""},
        {"bake --spacing=0.5 --samples=2 --quiet -o e2 -- " LEVEL, 0, ""},
        {"bake --spacing=0.5 --samples=2 --quiet -o e3 -- -dash.glb", 0, ""},
        {"bake -o e4 --quiet -- --quiet", 3, "--quiet"},
        {"bake --quiet=yes -o e4 " LEVEL, 2, "no value goes with --quiet"},
        {"bake " LEVEL " -o e4 --lightmaps=", 2, "no value goes with --lightmaps"},
        {"bake --spacing= -o e4 " LEVEL, 2, "--spacing takes"},
        {"info --json=1 b/probes.lmb", 2, "no value goes with --json"},
        {"info -- b/probes.lmb", 0, "run-time volume"},
        {"sample --at=-1,0.5,0 --json -- b/probes.lmb", 0, "sh3"},
        {"check --points=4 --samples=4 --quiet -- " LEVEL " b", 0, "volume_vs_reference"},
        {"render --size=16x9 --quiet -o=e.png -- " LEVEL " b", 0, ""},
        {"render --size=16x9 --probes --mode=lightmap -o e.png " LEVEL " b", 0, "--camera"},
        {"probe --at=0,1,0 --samples=16 -- " LEVEL, 0, "probe at"},
        {"probe --at=0,1,0 --samples=15 " LEVEL, 0, "--samples 15: taking 16, the next multiple of 16"},
        {"bake " LEVEL " -o e5 --spacing 1 --samples 3", 0, "--samples 3: taking 4, the next multiple of 2"},
        {"bake " LEVEL " -o e5 --spacing 1 --samples 2", 0, "MB at most"},
        {"render --size 16x9 --mode reference --samples 17 -o e.png " LEVEL " b", 0, "taking 32"},
        {"render --size 16x9 -o /proc/e.png " LEVEL " missing", 1, "/proc/e.png"},
    };
    if (!baked() || !CHECK_RUN(0, NULL, IN_OUTPUT "cp " LEVEL " ./-dash.glb")) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        CHECK_RUN(table[i].status, table[i].says, IN_OUTPUT LMB_COMMAND " %s", table[i].arguments);
    }
}

/* Also where the command has nothing else to do than to print. */
static void output_that_is_not_taken_fails(void)
{
    static const char *const table[] = {
        "--help",
        "help",
        "--version",
        "help check",
        "bake --help",
        "info b/probes.lmb",
        "info --json b/probes.vdb",
        "sample --at 0,1,0 b/probes.lmb",
        "sample --json --at 0,1,0 b/probes.lmb",
        "probe --json --at 0,1,0 --samples 16 " LEVEL,
        "check --json --quiet --points 4 --samples 4 " LEVEL " b",
        "check --quiet --points 4 --samples 4 " LEVEL " b",
        "render --size 16x9 -o f.png " LEVEL " b",
        "bake --dry-run --spacing 0.5 --samples 2 " LEVEL,
        "bake -o f --spacing 0.5 --samples 2 " LEVEL,
        "bake -o g --json-progress --spacing 0.5 --samples 2 " LEVEL,
        "pack -o f.lmb b/probes.vdb",
    };
    if (!baked()) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        CHECK_RUN(1, "lambent: standard output: cannot write: No space left", IN_OUTPUT LMB_COMMAND " %s >/dev/full",
                  table[i]);
        CHECK_RUN(1, "standard output: cannot write", IN_OUTPUT LMB_COMMAND " %s >&-", table[i]);
    }
    CHECK(access(OUTPUT "/g", F_OK) != 0, "a bake whose reports nobody takes went on");
    CHECK_RUN(0, "standard output: cannot write",
              IN_OUTPUT "yes '0 1 0' | head -100000 | { " LMB_COMMAND
                        " sample b/probes.lmb; test $? = 1 || echo wrong >&2; } | head -1");
}

/* Every line is a record, and the last one, alone, is the result or the error. */
static void records_end_with_one(void)
{
    static const struct {
        const char *options;
        int status;
        const char *last;
        const char *warning; /* NULL: none */
    } table[] = {
        {LEVEL " -o r --spacing 0.5 --samples 2", 0, "result", NULL},
        {LEVEL " -o r --spacing 0.5 --samples 2 --quiet", 0, "result", NULL},
        {LEVEL " --dry-run --spacing 0.5 --samples 2", 0, "result", NULL},
        {LEVEL " -o r --spacing 0.5 --samples 3", 0, "result", "--samples 3: taking 4"},
        {LEVEL " -o r --spacing 0.5 --samples 2 --seed-point 0,1,0 --seed-point 9,9,9", 0, "result",
         "seed point at 9,9,9"},
        {"dark.glb -o r --spacing 0.5 --samples 2", 0, "result", "no light of any kind"},
        {"missing.glb -o r", 3, "error", NULL},
        {"\"$(printf 'missing\\377.glb')\" -o r", 3, "error", NULL},
        {LEVEL " -o r --spacing 0.5 --samples 2 --seed-point 9,9,9", 3, "error", NULL},
        {LEVEL " -o r --exclude '*'", 3, "error", "no light of any kind"},
        {LEVEL " -o " LEVEL, 1, "error", NULL},
        {LEVEL " -o r --isa z80", 3, "error", NULL},
    };
    lmb_error error = {{0}};
    if (!baked()) {
        return;
    }
    CHECK(lmb_level_open_ground(OUTPUT "/dark.glb", 4.0f, 0.5f, &error) == LMB_OK, "%s", error.message);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        char command[1024], printed[32768];
        snprintf(command, sizeof command, IN_OUTPUT LMB_COMMAND " bake --json-progress %s 2>/dev/null",
                 table[i].options);
        const int status = run(printed, sizeof printed, command);
        CHECK(status == table[i].status, "%s: exits with %d", table[i].options, status);
        int ends = 0;
        bool warned = false;
        cJSON *json = NULL;
        for (char *line = strtok(printed, "\n"); line; line = strtok(NULL, "\n")) {
            cJSON_Delete(json);
            json = cJSON_Parse(line);
            CHECK(cJSON_IsObject(json), "%s: no record: %s", table[i].options, line);
            ends += cJSON_HasObjectItem(json, "result") || cJSON_HasObjectItem(json, "error");
            const char *warning = cJSON_GetStringValue(cJSON_GetObjectItem(json, "warning"));
            warned = warned || (warning && table[i].warning && strstr(warning, table[i].warning));
            CHECK(!warning || table[i].warning, "%s: %s", table[i].options, line);
            for (const unsigned char *c = (const unsigned char *)line; *c; ++c) {
                CHECK(*c != 0xffu, "%s: no UTF-8: %s", table[i].options, line);
            }
        }
        CHECK(ends == 1 && cJSON_HasObjectItem(json, table[i].last), "%s: %d ends", table[i].options, ends);
        CHECK(warned == (table[i].warning != NULL), "%s: does not warn of %s", table[i].options, table[i].warning);
        if (table[i].status != 0) {
            CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(json, "status")) == table[i].status, "%s: another status",
                  table[i].options);
        }
        cJSON_Delete(json);
    }
}

static void limits_fail_a_check(void)
{
    static const struct {
        const char *limits;
        int status;
        const char *says;
    } table[] = {
        {"--fail-above probe_vs_reference=1e9", 0, ""},
        {"--fail-above probe_vs_reference=1e-9", 1, "lambent: check: probe_vs_reference is "},
        {"--fail-above probe_vs_reference.p95=1e-9", 1, "lambent: check: probe_vs_reference.p95 is "},
        {"--fail-above volume_vs_reference.max=1e9 probe_vs_lightmap=1e-9 leak=1e9", 1,
         "lambent: check: probe_vs_lightmap is "},
        {"--fail-above leak=1e9,reference_mean=1e-9", 1, "reference_mean is "},
        {"--fail-above leak=1e9 --json --fail-above=reference_mean=1e-9", 1, "reference_mean is "},
        {"--fail-above leak=-1", 1, "leak is "},
        {"--fail-above leaks=1", 2, "no figure leaks"},
        {"--fail-above leak.p95=1", 2, "no figure leak.p95"},
        {"--fail-above probe_vs_reference.p9=1", 2, "no figure probe_vs_reference.p9"},
        {"--fail-above probe_vs_reference=nan", 2, "not a number"},
        {"--fail-above probe_vs_reference=1%%", 2, "not a number"},
        {"--fail-above probe_vs_reference", 2, "NAME=VALUE"},
        {"--fail-above", 2, "a value must follow"},
    };
    if (!baked()) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        CHECK_RUN(table[i].status, table[i].says,
                  IN_OUTPUT LMB_COMMAND " check " LEVEL " b --points 8 --samples 4 "
                                        "--quiet %s",
                  table[i].limits);
    }
    CHECK_RUN(0, "\ndenoised bake; ", IN_OUTPUT LMB_COMMAND " check " LEVEL " b --points 8 --samples 4 --quiet");
    CHECK_RUN(0, "\"denoised\":\ttrue",
              IN_OUTPUT LMB_COMMAND " check " LEVEL " b --points 8 --samples 4 --quiet --json");
    CHECK_RUN(0, NULL, IN_OUTPUT LMB_COMMAND " bake " LEVEL " -o n --no-denoise" SMALL);
    CHECK_RUN(0, "\nplain bake; ", IN_OUTPUT LMB_COMMAND " check " LEVEL " n --points 8 --samples 4 --quiet");
    CHECK_RUN(3, "bake with --lightmaps", IN_OUTPUT LMB_COMMAND " check " LEVEL " n --fail-above lightmap_leak=1");
}

/* Lightmaps are the same without probes, and the probes of an earlier bake go. */
static void lightmaps_alone(void)
{
    if (!baked()) {
        return;
    }
    CHECK_RUN(2, "--lightmaps has to go with", IN_OUTPUT LMB_COMMAND " bake " LEVEL " -o alone --no-probes" SMALL);
    CHECK_RUN(0, NULL, IN_OUTPUT LMB_COMMAND " bake " LEVEL " -o alone --lightmaps" SMALL);
    CHECK_RUN(0, NULL,
              IN_OUTPUT "rm -rf with_probes && cp -r alone/lightmap with_probes && " LMB_COMMAND " bake " LEVEL
                        " -o alone --lightmaps --no-probes" SMALL);
    CHECK_RUN(0, "",
              IN_OUTPUT "diff -r alone/lightmap with_probes && test ! -e alone/probes.lmb -a ! -e alone/probes.vdb");
    CHECK_RUN(0, "--camera", IN_OUTPUT LMB_COMMAND " render " LEVEL " alone --size 16x9 -o e.png");
    CHECK_RUN(0, "--camera", IN_OUTPUT LMB_COMMAND " render " LEVEL " alone --size 16x9 -o e.png --mode lightmap");
    static const char *const refused[] = {"render --size 16x9 -o e.png --mode probes", "render -o e.png --probes",
                                          "render -o e.png --object-at 0,1,0", "check"};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; ++i) {
        CHECK_RUN(3, "alone: was baked without probes", IN_OUTPUT LMB_COMMAND " %s " LEVEL " alone", refused[i]);
    }
}

static void volumes_come_back(void)
{
    if (!baked()) {
        return;
    }
    CHECK_RUN(0, "written   p.lmb", IN_OUTPUT LMB_COMMAND " pack b/probes.vdb -o p.lmb && cmp p.lmb b/probes.lmb");
    CHECK_RUN(0, "", IN_OUTPUT "test -z \"$(" LMB_COMMAND " pack --quiet -o=p.lmb -- b/probes.vdb)\"");
    CHECK_RUN(3, "missing.vdb", IN_OUTPUT LMB_COMMAND " pack missing.vdb -o q.lmb");
    CHECK_RUN(3, "not a .vdb", IN_OUTPUT LMB_COMMAND " pack b/probes.lmb -o q.lmb");
    CHECK_RUN(3, "not a .vdb", IN_OUTPUT LMB_COMMAND " pack " LEVEL " -o q.lmb");
    CHECK_RUN(3, "probes.vdb",
              IN_OUTPUT "head -c 3000 b/probes.vdb >cut/probes.vdb 2>/dev/null || { mkdir -p cut; head -c "
                        "3000 b/probes.vdb >cut/probes.vdb; }; " LMB_COMMAND " pack cut/probes.vdb -o q.lmb");
    CHECK_RUN(0, "tiles     ",
              IN_OUTPUT LMB_COMMAND " pack b/probes.vdb -o t.lmt --tile-size 1 && test -f t_0_0_0.lmb");
    CHECK_RUN(0, "index of tiles", IN_OUTPUT LMB_COMMAND " info t.lmt");
    CHECK_RUN(0, "probe", IN_OUTPUT LMB_COMMAND " info t_0_0_0.lmb");
    CHECK_RUN(2, "a .lmt with --tile-size, not", IN_OUTPUT LMB_COMMAND " pack b/probes.vdb -o q.lmb --tile-size 1");
    CHECK_RUN(2, "a .lmb, not", IN_OUTPUT LMB_COMMAND " pack b/probes.vdb -o q.lmt");
    CHECK_RUN(2, "a .lmb, not", IN_OUTPUT LMB_COMMAND " pack b/probes.vdb -o b/probes.vdb");
    CHECK_RUN(2, "-o FILE.lmb", IN_OUTPUT LMB_COMMAND " pack b/probes.vdb");
    CHECK_RUN(2, "FILE.vdb", IN_OUTPUT LMB_COMMAND " pack -o q.lmb");
    CHECK_RUN(1, "/proc/q.lmb", IN_OUTPUT LMB_COMMAND " pack b/probes.vdb -o /proc/q.lmb");
    CHECK(access(OUTPUT "/q.lmb", F_OK) != 0, "what could not be packed left a file");
}

/* Green irradiance that `sample` gives in the middle of the box. */
static double green_sampled(const char *path)
{
    char command[512], printed[8192];
    snprintf(command, sizeof command, IN_OUTPUT LMB_COMMAND " sample %s --at 0,1,0 --normal 0,1,0 --json", path);
    CHECK(run(printed, sizeof printed, command) == 0, "%s: %s", path, printed);
    cJSON *json = cJSON_Parse(printed);
    const double green = cJSON_GetNumberValue(cJSON_GetArrayItem(cJSON_GetObjectItem(json, "irradiance"), 1));
    cJSON_Delete(json);
    return green;
}

static void edited_volumes_give_edited_light(void)
{
    lmb_error error = {{0}};
    lmb_probes *probes;
    if (!baked()) {
        return;
    }
    if (lmb_vdb_read(OUTPUT "/b/probes.vdb", &probes, NULL, NULL, &error) != LMB_OK) {
        CHECK(false, "%s", error.message);
        return;
    }
    for (int32_t i = 0; i < probes->count; ++i) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            probes->radiance[0][i].channel[1].c[k] *= 2.0f;
        }
    }
    const lmb_vdb_metadata metadata = {"{}", "0"};
    CHECK(lmb_vdb_write(OUTPUT "/edited.vdb", probes, &metadata, &error) == LMB_OK, "%s", error.message);
    CHECK_RUN(0, NULL, IN_OUTPUT LMB_COMMAND " pack edited.vdb -o edited.lmb");
    const double green = green_sampled("b/probes.lmb");
    CHECK(green > 0.0, "%g", green);
    CHECK_NEAR(green_sampled("edited.lmb"), 2.0 * green, 2e-3 * green, "twice the green");
    lmb_probes_destroy(probes);
    probes = fixture_probes(&(lmb_lattice){.spacing = 1.0f, .size = {2, 2, 2}}, NULL); /* of validity 0 */
    CHECK(lmb_vdb_write(OUTPUT "/edited.vdb", probes, &metadata, &error) == LMB_OK, "%s", error.message);
    CHECK_RUN(3, "edited.vdb: no probe has light", IN_OUTPUT LMB_COMMAND " pack edited.vdb -o edited.lmb");
    lmb_probes_destroy(probes);
}

/* A floor of 4 m, seeds and cameras as glTF text. Base64 of 4 corners and 6 indices. */
static bool marked_level_write(void)
{
    FILE *file = fopen(OUTPUT "/marked.gltf", "w");
    CHECK(file, "cannot write");
    if (!file) {
        return false;
    }
    fputs(
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0,1,2,3,4,5]}],"
        "\"nodes\":["
        "{\"name\":\"floor\",\"mesh\":0},"
        "{\"name\":\"Start\",\"translation\":[0,0.25,0],\"extras\":{\"lambent\":{\"seed\":true}}},"
        "{\"name\":\"Far\",\"translation\":[90,0.25,0],\"extras\":{\"lambent\":{\"seed\":true}}},"
        "{\"name\":\"Above\",\"camera\":0,\"translation\":[0,3,0],\"rotation\":[-0.70710678,0,0,0.70710678]},"
        "{\"name\":\"Door\",\"translation\":[0,3,0],\"rotation\":[-0.70710678,0,0,0.70710678]},"
        "{\"name\":\"Flat\",\"scale\":[0,0,0]}],"
        "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1.0471976,\"znear\":0.1}}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\","
        "\"min\":[-2,0,-2],\"max\":[2,0,2]},{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12}],"
        "\"buffers\":[{\"byteLength\":60,\"uri\":\"data:application/octet-stream;base64,"
        "AAAAwAAAAAAAAADAAAAAwAAAAAAAAABAAAAAQAAAAAAAAABAAAAAQAAAAAAAAADAAAABAAIAAAACAAMA\"}]}",
        file);
    fclose(file);
    return true;
}

static void seeds_are_named(void)
{
#define MARKED IN_OUTPUT LMB_COMMAND " bake marked.gltf -o m --force --spacing 0.5 --samples 2 --env '#ffffff' "
    if (!baked() || !marked_level_write()) {
        return;
    }
    CHECK_RUN(0, "warning: marked.gltf: seed node 'Far' at 90,0.25,0 lies outside the level's bounds: ignored", MARKED);
    CHECK_RUN(0, "warning: marked.gltf: seed point at 0,7,0 lies outside the level's bounds: ignored",
              MARKED "--seed-point 0,7,0");
    CHECK_RUN(3,
              "lambent: marked.gltf: no seed lies in free space: seed point at 8,8,8 lies outside the level's bounds; "
              "seed node 'Far' at 90,0.25,0 lies outside the level's bounds\n",
              MARKED "--exclude Start --seed-point 8,8,8");
    CHECK_RUN(3, "; so do 1 more", MARKED "--exclude Start --seed-point 8,8,8 --seed-point 9,9,9");
    /* The short block of the box stands about x 0.33, z 0.37 and is 0.6 m high. */
    CHECK_RUN(3, "seed point at 0.33,0.3,0.37 lies in a solid",
              IN_OUTPUT LMB_COMMAND " bake " LEVEL " -o m --spacing 0.1 --samples 2 --seed-point 0.33,0.3,0.37");
#undef MARKED
}

static void pictures_from_camera_nodes(void)
{
#define PICTURE IN_OUTPUT LMB_COMMAND " render marked.gltf m --size 32x18 --exposure 0 -o "
    if (!baked() || !marked_level_write() ||
        !CHECK_RUN(0, NULL, IN_OUTPUT LMB_COMMAND " bake marked.gltf -o m --env '#ffffff'" SMALL)) {
        return;
    }
    CHECK_RUN(0, "", PICTURE "c1.exr --camera 0,3,0 --look 0,0,0 --fov 60");
    CHECK_RUN(0, "--camera-node 'Above'", PICTURE "c2.exr --camera-node Above");
    CHECK_RUN(0, "", PICTURE "c3.exr --camera-node Door");
    CHECK_RUN(0, "", PICTURE "c4.exr --camera-node Above --fov 30");
    /* The node looks straight down with its +Y towards -Z, as the built-in camera has it. */
    CHECK_RUN(0, NULL, IN_OUTPUT "cmp c1.exr c2.exr && cmp c2.exr c3.exr && ! cmp -s c2.exr c4.exr");
    CHECK_RUN(3, "no node is called 'Below'; its cameras: Above", PICTURE "c5.exr --camera-node Below");
    CHECK_RUN(3, "'Flat' is scaled to nothing", PICTURE "c5.exr --camera-node Flat");
    CHECK_RUN(2, "does not go with --look", PICTURE "c5.exr --camera-node Above --look 0,0,0");
    CHECK(access(OUTPUT "/c5.exr", F_OK) != 0, "a picture without a camera");
#undef PICTURE
}

/* Address space runs out somewhere: in loading, in Embree, in what follows. Sanitizers take too much of it to try. */
static void missing_memory_is_one_line(void)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    test_skip("sanitizers take more address space than is left");
#else
    lmb_error error = {{0}};
    if (!baked()) {
        return;
    }
    CHECK(lmb_level_sphere_room(OUTPUT "/sphere.glb", 4.0f, 40, 0.5f, 10.0f, &error) == LMB_OK, "%s", error.message);
    int failed = 0;
    for (int megabytes = 150; megabytes < 420; megabytes += 30) {
        char command[512], printed[4096];
        snprintf(command, sizeof command,
                 IN_OUTPUT "ulimit -c 0; ulimit -v %d; " LMB_COMMAND " bake sphere.glb -o v" SMALL, 1024 * megabytes);
        const int status = run(printed, sizeof printed, command);
        const char *end = strchr(printed, '\n');
        failed += status == 1;
        CHECK(status == 0 || (status == 1 && strncmp(printed, "lambent: ", 9) == 0 && end && end[1] == '\0' &&
                              strstr(printed, "memory")),
              "%d MB: exits with %d: %s", megabytes, status, printed);
    }
    CHECK(failed > 0, "no limit was low enough");
#endif
}

static const test_case cases[] = {
    {"arguments_are_read", arguments_are_read},
    {"output_that_is_not_taken_fails", output_that_is_not_taken_fails},
    {"records_end_with_one", records_end_with_one},
    {"limits_fail_a_check", limits_fail_a_check},
    {"lightmaps_alone", lightmaps_alone},
    {"volumes_come_back", volumes_come_back},
    {"edited_volumes_give_edited_light", edited_volumes_give_edited_light},
    {"seeds_are_named", seeds_are_named},
    {"pictures_from_camera_nodes", pictures_from_camera_nodes},
    {"missing_memory_is_one_line", missing_memory_is_one_line},
};

TEST_MAIN(cases)
