/* Bad files of every kind through every command that reads one: exit status 3, one line on standard error that names
 * the file and says what is wrong, within a few seconds and little memory, and no output. */
#define _POSIX_C_SOURCE 200809L
#include <stddef.h>
#include <stdint.h>

#include <lambent/file.h>
#include <lambent/tiles_format.h>
#include <lambent/volume_format.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/bad_files"
#define LEVEL OUTPUT "/room.glb"
#define BAKED OUTPUT "/baked"

/* Address space, in kB: libraries and threads take some 3 GB of it. Sanitizers need more than there is. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIMITED "timeout 120 "
#else
#define LIMITED "ulimit -v 6000000; timeout 20 "
#endif

static bool bake_make(void)
{
    static int made = -1;
    if (made < 0) {
        made =
            cornell_make(OUTPUT, LEVEL) &&
            CHECK_RUN(0, NULL,
                      "rm -rf " BAKED " && " LMB_COMMAND " bake " LEVEL " -o " BAKED
                      " --quiet --spacing 1 --samples 4 --lightmaps --texels-per-m 2") &&
            CHECK_RUN(0, NULL, LMB_COMMAND " pack " BAKED "/probes.vdb -o " OUTPUT "/tiles.lmt --tile-size 4 --quiet");
    }
    return made > 0;
}

/* Runs `lambent` with arguments and checks how it ends. `file` must be in its one line, other than warnings. */
static void bad_check(const char *file, const char *arguments)
{
    char command[2048], printed[8192];
    snprintf(command, sizeof command,
             "cd " OUTPUT " && rm -rf out* && { " LIMITED LMB_COMMAND " %s </dev/null >/dev/null 2>said; status=$?; "
             "grep -v '^lambent: warning: ' said; exit $status; }",
             arguments);
    const int status = run(printed, sizeof printed, command);
    const char *const newline = strchr(printed, '\n');
    CHECK(status == 3, "%s: status %d: %s", arguments, status, printed);
    CHECK(newline && newline[1] == '\0', "%s: not one line: %s", arguments, printed);
    const char *const named = strstr(printed, file);
    CHECK(strncmp(printed, "lambent: ", 9) == 0 && named && strlen(named) > strlen(file) + 4,
          "%s: does not say what is wrong with %s: %s", arguments, file, printed);
    CHECK(access(OUTPUT "/out", F_OK) != 0 && access(OUTPUT "/out.png", F_OK) != 0 &&
              access(OUTPUT "/out.lmb", F_OK) != 0,
          "%s: left something", arguments);
}

static bool file_make(const char *name, const void *bytes, size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, OUTPUT "/%s", name);
    FILE *const file = fopen(path, "wb");
    const bool good = file && fwrite(bytes, 1, size, file) == size;
    const bool closed = file && fclose(file) == 0;
    CHECK(good && closed, "%s cannot be written", path);
    return good && closed;
}

/* A file of the good bake, or the level, cut off or with a byte changed. */
static bool damaged_make(const char *name, const char *of, double share, bool changed)
{
    char path[1024];
    unsigned char *data = NULL;
    size_t size = 0;
    snprintf(path, sizeof path, OUTPUT "/%s", of);
    const bool read = lmb_file_read(path, &data, &size, NULL) == LMB_OK;
    CHECK(read, "%s cannot be read", path);
    const size_t at = (size_t)(share * (double)size);
    bool good = read;
    if (read && changed) {
        data[at] = (unsigned char)(data[at] ^ 0x55);
    }
    good = good && file_make(name, data, changed ? size : at);
    free(data);
    return good;
}

#define GLTF "{\"asset\":{\"version\":\"2.0\"},"
#define GLTF_BUFFER GLTF "\"buffers\":[{\"uri\":\"data:,abcdabcdabcd\",\"byteLength\":12}],"
#define GLTF_REST "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]}"
#define GLTF_URI(uri) GLTF "\"buffers\":[{\"uri\":\"" uri "\",\"byteLength\":1}]}"
#define HDR "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"

static const struct {
    const char *name, *text;
} texts[] = {
    {"empty", ""},
    {"one_byte", "x"},
    {"words.txt", "This is no level, no picture and no volume, but it is long enough to have been one of them.\n"
                  "This is no level, no picture and no volume, but it is long enough to have been one of them.\n"},
    {"no_level.json", "{}"},
    {"accessor_of_4_gb.gltf", GLTF_BUFFER
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":12}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
     "\"count\":357913941,\"type\":\"VEC3\"}]," GLTF_REST},
    {"accessor_of_nothing.gltf",
     GLTF "\"accessors\":[{\"componentType\":5126,\"count\":357913941,\"type\":\"VEC3\"}]," GLTF_REST},
    {"sparse_of_4_gb.gltf", GLTF_BUFFER
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":12}],\"accessors\":[{\"componentType\":5126,\"count\":357913941,"
     "\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5125},\"values\":"
     "{\"bufferView\":0}}}]," GLTF_REST},
    {"buffer_of_4_gb.gltf", GLTF "\"buffers\":[{\"uri\":\"data:,abcd\",\"byteLength\":4294967295}]}"},
    {"large_picture.gltf", GLTF_BUFFER
     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":12}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
     "\"count\":1,\"type\":\"VEC3\"}],\"images\":[{\"uri\":\"data:image/"
     "png;base64,iVBORw0KGgoAAAANSUhEUgAAfQAAAH0ACAAAAABjcmNf\"}],"
     "\"textures\":[{\"source\":0}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],"
     "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}],\"nodes\":[{\"mesh\":0}]}"},
    {"above.gltf", GLTF_URI("../room.glb")},
    {"absolute.gltf", GLTF_URI("/etc/passwd")},
    {"scheme.gltf", GLTF_URI("file:///etc/passwd")},
    {"encoded.gltf", GLTF_URI("%2e%2e%2froom.glb")},
    {"missing_buffer.gltf", GLTF_URI("nowhere.bin")},
    {"newer.gltf", "{\"asset\":{\"version\":\"3.0\"}}"},
    {"required.gltf", GLTF "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}"},
    {"large.hdr", HDR "-Y 32000 +X 64000\n"},
    {"larger.hdr", HDR "-Y 999999999 +X 999999999\n"},
    {"short.hdr", HDR "-Y 64 +X 128\nabcd"},
    {"square.hdr", HDR "-Y 1 +X 1\nabcd"},
};

/* JSON that nests deeper than any reader's stack. */
static bool deep_make(const char *name, const char *head)
{
    enum { DEPTH = 100000 };
    const size_t length = strlen(head);
    char *const text = malloc(length + 2 * DEPTH + 1);
    if (!text) {
        return false;
    }
    memcpy(text, head, length);
    memset(text + length, '[', DEPTH);
    memset(text + length + DEPTH, ']', DEPTH);
    text[length + 2 * DEPTH] = '}';
    const bool good = file_make(name, text, length + 2 * DEPTH + 1);
    free(text);
    return good;
}

/* An EXR header that promises a picture of 60000 x 30000 in some hundred bytes. */
static bool large_exr_make(void)
{
#define TEXT(text) text "\0"
    static const char head[] = "\x76\x2f\x31\x01\x02\0\0\0" TEXT("channels")
        TEXT("chlist") "\x37\0\0\0" TEXT("B") "\1\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0" TEXT(
            "G") "\1\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0" TEXT("R") "\1\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0"
                                                              "\0" TEXT("compression") TEXT(
                                                                  "compression") "\1\0\0\0\3" TEXT("dataWindow")
                                                                  TEXT(
                                                                      "box2i") "\x10\0\0\0"
                                                                               "\0\0\0\0\0\0\0\0\x5f\xea\0\0\x2f\x75\0"
                                                                               "\0" TEXT("displayWindow")
                                                                                   TEXT(
                                                                                       "box2i") "\x10\0\0\0"
                                                                                                "\0\0\0\0\0\0\0\0\x5f"
                                                                                                "\xea\0\0\x2f\x75\0"
                                                                                                "\0" TEXT("lineOrder")
                                                                                                    TEXT("lineOrder") "\1\0\0\0\0" TEXT(
                                                                                                        "pixelAspectRat"
                                                                                                        "io")
                                                                                                        TEXT("float") "\4\0\0\0\0\0\x80\x3f" TEXT(
                                                                                                            "screenWind"
                                                                                                            "owCenter")
                                                                                                            TEXT("v2f") "\x8\0\0\0\0\0\0\0\0\0\0\0" TEXT(
                                                                                                                "screen"
                                                                                                                "Window"
                                                                                                                "Width")
                                                                                                                TEXT(
                                                                                                                    "fl"
                                                                                                                    "oa"
                                                                                                                    "t") "\4\0\0\0\0\0\x80\x3f"
                                                                                                                         "\0";
#undef TEXT
    return file_make("large.exr", head, sizeof head - 1);
}

/* A PNG header that promises 32000 x 32000 pixels of grey. */
static bool large_png_make(void)
{
    static const char head[] = "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x7d\0\0\0\x7d\0\x08\0\0\0\0crc";
    return file_make("large.png", head, sizeof head);
}

/* A volume or an index of tiles with one word of its header changed, and the checksum put right. */
static bool forged_make(const char *name, const char *of, size_t at, uint32_t word)
{
    _Static_assert(offsetof(lmb_tiles_header, version) == offsetof(lmb_volume_header, version) &&
                       offsetof(lmb_tiles_header, checksum) == offsetof(lmb_volume_header, checksum),
                   "both begin alike");
    unsigned char *data = NULL;
    size_t size = 0;
    bool good = lmb_file_read(of, &data, &size, NULL) == LMB_OK && size > LMB_VOLUME_CHECKSUM_START;
    CHECK(good, "%s cannot be read", of);
    if (good) {
        memcpy(data + at, &word, sizeof word);
        const uint64_t sum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
        memcpy(data + offsetof(lmb_volume_header, checksum), &sum, sizeof sum);
        good = file_make(name, data, size);
    }
    free(data);
    return good;
}

static bool forgeries_make(void)
{
    return forged_make("newer.lmb", BAKED "/probes.lmb", offsetof(lmb_volume_header, version), 1000) &&
           forged_make("newer.lmt", OUTPUT "/tiles.lmt", offsetof(lmb_tiles_header, version), 1000) &&
           forged_make("many_tiles.lmt", OUTPUT "/tiles.lmt", offsetof(lmb_tiles_header, tile_count), UINT32_MAX) &&
           forged_make("small_tiles.lmt", OUTPUT "/tiles.lmt", offsetof(lmb_tiles_header, tile_cells), 0) &&
           forged_make("large_grid.lmt", OUTPUT "/tiles.lmt", offsetof(lmb_tiles_header, size), INT32_MAX);
}

static const struct {
    const char *name, *of;
    double share;
    bool changed;
} damages[] = {
    {"cut.glb", "room.glb", 0.5, false},
    {"cut_in_header.glb", "room.glb", 0.002, false},
    {"changed.lmb", "baked/probes.lmb", 0.5, true},
    {"cut.lmb", "baked/probes.lmb", 0.5, false},
    {"cut_in_header.lmb", "baked/probes.lmb", 0.002, false},
    {"changed.lmt", "tiles.lmt", 0.5, true},
    {"cut.lmt", "tiles.lmt", 0.5, false},
    {"cut_in_header.lmt", "tiles.lmt", 0.02, false},
    {"changed.vdb", "baked/probes.vdb", 0.9, true},
    {"cut.vdb", "baked/probes.vdb", 0.5, false},
    {"cut_in_header.vdb", "baked/probes.vdb", 0.002, false},
    {"cut.exr", "baked/lightmap/lightmap_0.exr", 0.7, false},
    {"cut_in_header.exr", "baked/lightmap/lightmap_0.exr", 0.01, false},
};

static bool files_make(void)
{
    static int made = -1;
    if (made >= 0) {
        return made > 0;
    }
    bool good = bake_make();
    for (size_t i = 0; i < sizeof texts / sizeof texts[0] && good; ++i) {
        good = file_make(texts[i].name, texts[i].text, strlen(texts[i].text));
    }
    for (size_t i = 0; i < sizeof damages / sizeof damages[0] && good; ++i) {
        good = damaged_make(damages[i].name, damages[i].of, damages[i].share, damages[i].changed);
    }
    good =
        good && deep_make("deep.gltf", GLTF "\"extras\":") && large_exr_make() && large_png_make() && forgeries_make();
    made = good;
    return good;
}

/* What reads which kind; %s is the file. */
enum { LEVELS = 1, PICTURES = 2, VOLUMES = 4, GRIDS = 8, INDEXES = 16, CHANNELS = 32, HEIGHTS = 64, ANY = 127 };
static const struct {
    int kinds;
    const char *arguments;
} readers[] = {
    {LEVELS, "bake %s -o out --quiet"},
    {LEVELS, "render room.glb baked -o out.png --quiet --object %s"},
    {0, "check %s baked --points 4 --quiet"},
    {0, "render %s baked -o out.png --quiet"},
    {0, "probe %s --at 0,1,0 --samples 64 --quiet"},
    {PICTURES, "bake room.glb -o out --quiet --env %s"},
    {PICTURES, "models %s --turns 1 --quiet"},
    {VOLUMES | GRIDS | INDEXES | CHANNELS, "info %s"},
    {HEIGHTS, "ssbump %s -o out.png --quiet"},
    {GRIDS, "pack %s -o out.lmb"},
    {VOLUMES, "sample %s --at 0,0,0"},
};

/* ANY: every one of them. */
static void readers_refuse(const char *file, int kinds)
{
    for (size_t i = 0; i < sizeof readers / sizeof readers[0]; ++i) {
        char arguments[1024];
        snprintf(arguments, sizeof arguments, readers[i].arguments, file);
        if (kinds == ANY || (kinds & readers[i].kinds) != 0) {
            bad_check(file, arguments);
        }
    }
}

static int kinds_of(const char *file)
{
    static const struct {
        const char *ending;
        int kinds;
    } table[] = {{".gltf", LEVELS}, {".glb", LEVELS}, {".hdr", PICTURES}, {".exr", PICTURES | CHANNELS},
                 {".lmb", VOLUMES}, {".vdb", GRIDS},  {".lmt", INDEXES},  {".png", HEIGHTS}};
    const char *const dot = strrchr(file, '.');
    for (size_t i = 0; dot && i < sizeof table / sizeof table[0]; ++i) {
        if (strcmp(dot, table[i].ending) == 0) {
            return table[i].kinds;
        }
    }
    return ANY;
}

static void texts_are_refused(void)
{
    for (size_t i = 0; i < sizeof texts / sizeof texts[0] && files_make(); ++i) {
        readers_refuse(texts[i].name, kinds_of(texts[i].name));
    }
}

static void damaged_files_are_refused(void)
{
    for (size_t i = 0; i < sizeof damages / sizeof damages[0] && files_make(); ++i) {
        readers_refuse(damages[i].name, kinds_of(damages[i].name));
    }
}

static void odd_files_are_refused(void)
{
    static const char *const odd[] = {
        "deep.gltf",       "large.exr",      "large.png", "newer.lmb", "newer.lmt", "many_tiles.lmt",
        "small_tiles.lmt", "large_grid.lmt", "nowhere",   "/dev/zero", "."};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0] && files_make(); ++i) {
        readers_refuse(odd[i], kinds_of(odd[i]));
    }
}

/* A good file is a bad one for who reads another kind. */
static void good_files_of_another_kind_are_refused(void)
{
    static const struct {
        const char *file;
        int wrong;
    } table[] = {
        {"room.glb", PICTURES | GRIDS | VOLUMES},  {"baked/probes.lmb", LEVELS | PICTURES},
        {"baked/probes.vdb", LEVELS | PICTURES},   {"tiles.lmt", LEVELS | PICTURES},
        {"baked/lightmap/lightmap_0.exr", LEVELS},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0] && files_make(); ++i) {
        readers_refuse(table[i].file, table[i].wrong);
    }
    if (files_make()) {
        bad_check("baked/probes.lmb", "pack baked/probes.lmb -o out.lmb");
        bad_check("baked/probes.vdb", "sample baked/probes.vdb --at 0,0,0");
        bad_check("tiles.lmt", "pack tiles.lmt -o out.lmb");
        bad_check("baked/lightmap/lightmap_0.exr", "sample baked/lightmap/lightmap_0.exr --at 0,0,0");
    }
}

/* One file of a good bake replaced by a bad one. */
static void bad_bakes_are_refused(void)
{
    static const struct {
        const char *file, *by, *named;
    } table[] = {
        {"bake.json", "empty", "bake.json"},
        {"bake.json", "words.txt", "bake.json"},
        {"bake.json", "no_level.json", "bake.json"},
        {"bake.json", "deep.json", "bake.json"},
        {"probes.lmb", "empty", "probes.lmb"},
        {"probes.lmb", "cut.lmb", "probes.lmb"},
        {"probes.lmb", "changed.lmb", "probes.lmb"},
        {"probes.lmb", "newer.lmb", "probes.lmb"},
        {"lightmap/lightmap.json", "no_level.json", "lightmap.json"},
        {"lightmap/lightmap.json", "deep.json", "lightmap.json"},
        {"lightmap/lightmap_0.exr", "cut.exr", "lightmap_0.exr"},
        {"lightmap/lightmap_0.exr", "cut_in_header.exr", "lightmap_0.exr"},
        {"lightmap/lightmap_0.exr", "large.exr", "lightmap_0.exr"},
        {"lightmap/lightmap_0.exr", "words.txt", "lightmap_0.exr"},
        {"lightmap/lightmap_0.exr", "baked/probes.lmb", "lightmap_0.exr"},
    };
    if (!files_make() || !deep_make("deep.json", "{\"settings\":")) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        CHECK_RUN(0, NULL, "cd " OUTPUT " && rm -rf bad && cp -r baked bad && cp %s bad/%s", table[i].by,
                  table[i].file);
        bad_check(table[i].named,
                  i % 2 == 0 ? "check room.glb bad --points 4 --quiet" : "render room.glb bad -o out.png --quiet");
    }
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/bad");
}

/* Lines on standard input that are none. */
static void bad_lines_are_refused(void)
{
    static const char *const lines[] = {"x", "1 2", "1 2 3 4", "1 2 3 0 0 0", "1 2 3 nan nan nan", "1 2 3 0 1 0 0 9"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0] && bake_make(); ++i) {
        CHECK_RUN(3, "standard input:2: ", "printf '1 1 1\\n%s\\n' | " LMB_COMMAND " sample " BAKED "/probes.lmb",
                  lines[i]);
    }
}

/* The corpora of real data, each file as a level, and pictures as such: whatever they hold, it is read or refused. */
static void real_data_is_read_or_refused(void)
{
    static char printed[65536];
    if (access(LMB_DATA_DIR "/malformed", R_OK) != 0) {
        test_skip("no real data");
        return;
    }
    const int status = run(
        printed, sizeof printed,
        "try() { " LMB_COMMAND " \"$@\" >/dev/null 2>" OUTPUT "/said; s=$?; "
        "[ $s = 0 ] || { [ $s = 3 ] && [ $(wc -l <" OUTPUT "/said) = 1 ] && grep -qF \"$2: \" " OUTPUT "/said; } || "
        "{ echo \"$*: status $s\"; cat " OUTPUT "/said; }; }; "
        "find " LMB_DATA_DIR "/malformed -type f ! -name LICENSE | LC_ALL=C sort | while read f; do "
        "try bake \"$f\" -o " OUTPUT "/real --dry-run --quiet; "
        "case $f in *.exr) try info \"$f\" ;; *.png) try ssbump \"$f\" -o " OUTPUT "/real.png --quiet ;; esac; done");
    CHECK(status == 0 && printed[0] == '\0', "%s", printed);
}

static const test_case cases[] = {
    {"texts_are_refused", texts_are_refused},
    {"damaged_files_are_refused", damaged_files_are_refused},
    {"odd_files_are_refused", odd_files_are_refused},
    {"good_files_of_another_kind_are_refused", good_files_of_another_kind_are_refused},
    {"bad_bakes_are_refused", bad_bakes_are_refused},
    {"bad_lines_are_refused", bad_lines_are_refused},
    {"real_data_is_read_or_refused", real_data_is_read_or_refused},
};
TEST_MAIN(cases)
