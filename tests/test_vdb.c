/* probes.vdb: what is written comes back, in the same bytes every time, under the names that other tools show. */
#define _POSIX_C_SOURCE 200809L

#include "folder_fixture.h"
#include "harness.h"
#include "probes_fixture.h"

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define FOLDER LMB_TEST_OUTPUT_DIR "/vdb with \xc3\xa9"
#define PATH FOLDER "/probes \xe5\x85\x89.vdb"

static const lmb_vdb_metadata metadata = {"{\"samples\": 64, \"level\": \"caf\xc3\xa9.glb\"}", "0123abcd"};

static void write_probes(const lmb_probes *probes)
{
    lmb_error error = {""};
    const lmb_result result = lmb_vdb_write(PATH, probes, &metadata, &error);
    CHECK(result == LMB_OK, "write: %d, %s", result, error.message);
}

static void check_refused(const char *path, lmb_result expected, const char *reason)
{
    lmb_probes *probes = NULL;
    char *settings = NULL;
    lmb_error error = {""};
    const lmb_result result = lmb_vdb_read(path, &probes, &settings, NULL, &error);
    CHECK(result == expected, "%s: %d, %s", path, result, error.message);
    CHECK(!probes && !settings, "%s: outputs were touched", path);
    CHECK(strstr(error.message, path) && strstr(error.message, reason) && !strchr(error.message, '\n'), "%s: '%s'",
          path, error.message);
    lmb_probes_destroy(probes);
    free(settings);
}

static void check_round_trip(const lmb_lattice *lattice, double density, double magnitude)
{
    lmb_probes *const probes = fixture_random_probes(lattice, density, 0.7, magnitude, 7);
    write_probes(probes);
    lmb_probes *read = NULL;
    char *settings = NULL, *scene_hash = NULL;
    lmb_error error = {""};
    const lmb_result result = lmb_vdb_read(PATH, &read, &settings, &scene_hash, &error);
    CHECK(result == LMB_OK, "read: %d, %s", result, error.message);
    if (result == LMB_OK) {
        CHECK(strcmp(settings, metadata.settings) == 0 && strcmp(scene_hash, metadata.scene_hash) == 0, "'%s', '%s'",
              settings, scene_hash);
        CHECK(read->level[0].lattice.spacing == lattice->spacing &&
                  memcmp(read->level[0].lattice.min, lattice->min, sizeof lattice->min) == 0 &&
                  memcmp(read->level[0].lattice.size, lattice->size, sizeof lattice->size) == 0 &&
                  read->count == probes->count,
              "box or probes differ");
        for (int32_t probe = 0; probe < probes->count && probe < read->count; ++probe) {
            CHECK(memcmp(read->point[probe], probes->point[probe], sizeof probes->point[probe]) == 0, "probe %d",
                  probe);
            CHECK(read->validity[probe] == probes->validity[probe], "validity of probe %d", probe);
            for (int i = 0; i < 27; ++i) {
                const double expected = (double)probes->radiance[0][probe].channel[i / 9].c[i % 9];
                CHECK_NEAR(read->radiance[0][probe].channel[i / 9].c[i % 9], expected,
                           fabs(expected) * 0x1p-11 + magnitude * 1e-6, "probe %d, coefficient %d", probe, i);
            }
        }
    }
    free(settings);
    free(scene_hash);
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

static void test_round_trip(void)
{
    folder_start(FOLDER);
    static const struct {
        lmb_lattice lattice;
        double density;
        double magnitude;
    } cases[] = {
        {{.spacing = 1.0f, .min = {0, 0, 0}, .size = {1, 1, 1}}, 1.0, 1.0},
        {{.spacing = 0.3f, .min = {-9, 3, 5}, .size = {11, 12, 13}}, 0.7, 4.0},
        {{.spacing = 1e-3f, .min = {-2, -2, -2}, .size = {5, 5, 5}}, 1.0, 60000.0},
        {{.spacing = 3.7f, .min = {-2, -2, -2}, .size = {5, 5, 5}}, 1.0, 1e8},
        {{.spacing = 2.0f, .min = {-2, -2, -2}, .size = {5, 5, 5}}, 1.0, 1e-7},
        {{.spacing = 0.5f, .min = {100000, -5, 40}, .size = {40, 3, 40}}, 0.01, 2.0},
        {{.spacing = 1.0f, .min = {4, 4, 4}, .size = {3, 3, 3}}, 0.0, 1.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const int before = test_failures;
        check_round_trip(&cases[i].lattice, cases[i].density, cases[i].magnitude);
        CHECK(test_failures == before, "case %zu", i);
    }
    CHECK(folder_entry_count(FOLDER) == 1, "something was left beside the file");
}

/* An unedited .vdb packs to the same .lmb as the probes that it was written from. */
static void test_pack_of_vdb(void)
{
    const lmb_lattice lattice = {.spacing = 0.3f, .min = {-9, 3, 5}, .size = {11, 12, 13}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 0.7, 0.5, 4.0, 7);
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    write_probes(probes);
    lmb_probes *read = NULL;
    CHECK(lmb_vdb_read(PATH, &read, NULL, NULL, NULL) == LMB_OK, "read");
    unsigned char *a = NULL, *b = NULL;
    size_t size_a = 0, size_b = 0;
    CHECK(lmb_pack(probes, &a, &size_a, NULL) == LMB_OK, "pack");
    CHECK(read && lmb_pack(read, &b, &size_b, NULL) == LMB_OK, "pack what was read");
    CHECK(size_a == size_b && a && b && memcmp(a, b, size_a) == 0, "%zu and %zu bytes differ", size_a, size_b);
    free(a);
    free(b);
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

static void test_equal_bytes(void)
{
    folder_start(FOLDER);
    const lmb_lattice lattice = {.spacing = 0.3f, .min = {-20, 3, 5}, .size = {31, 12, 40}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 0.7, 0.7, 4.0, 7);
    unsigned char *first = NULL, *second = NULL;
    size_t first_size = 0, second_size = 0;
    write_probes(probes);
    CHECK(lmb_file_read(PATH, &first, &first_size, NULL) == LMB_OK, "read");
    /* Other contents in freed memory, so that bytes that nobody set would show. */
    void *dirt[64];
    for (size_t i = 0; i < 64; ++i) {
        dirt[i] = malloc(1000 * (i + 1));
        memset(dirt[i], (int)i * 3 + 1, 1000 * (i + 1));
    }
    for (size_t i = 0; i < 64; ++i) {
        free(dirt[i]);
    }
    write_probes(probes);
    CHECK(lmb_file_read(PATH, &second, &second_size, NULL) == LMB_OK, "read");
    CHECK(first_size == second_size && memcmp(first, second, first_size) == 0, "two writes of the same probes differ");
    CHECK(first_size > 57 && first[21 + 8] == '-' && first[21 + 14] == '8', "the UUID is not of version 8: %.36s",
          (const char *)first + 21);

    probes->radiance[0][5].channel[1].c[3] += 1.0f;
    free(second);
    write_probes(probes);
    CHECK(lmb_file_read(PATH, &second, &second_size, NULL) == LMB_OK, "read");
    CHECK(memcmp(first + 21, second + 21, 36) != 0, "other probes have the same UUID");
    free(first);
    free(second);
    lmb_probes_destroy(probes);
}

/* Every truncation, and changes all over the file, of a small one. */
static void test_damage(void)
{
    folder_start(FOLDER);
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 4.0, 7);
    write_probes(probes);
    lmb_probes_destroy(probes);
    unsigned char *data = NULL;
    size_t bytes = 0;
    CHECK(lmb_file_read(PATH, &data, &bytes, NULL) == LMB_OK, "read");
    for (size_t kept = 0; data && kept < bytes; kept += kept < 400 ? 1 : 997) {
        FILE *const file = fopen(PATH, "wb");
        fwrite(data, 1, kept, file);
        fclose(file);
        check_refused(PATH, LMB_ERROR_FORMAT, "");
    }
    for (size_t i = 0; data && i < bytes; i += i < 100 ? 1 : 1009) {
        if (i == 21 + 14) {
            continue; /* the UUID's version: then it is some other tool's file, and cannot be checked */
        }
        data[i] ^= 0x41;
        FILE *const file = fopen(PATH, "wb");
        fwrite(data, 1, bytes, file);
        fclose(file);
        check_refused(PATH, LMB_ERROR_FORMAT, "");
        data[i] ^= 0x41;
    }
    free(data);
}

static void test_wrong_kind(void)
{
    folder_start(FOLDER);
    check_refused(FOLDER "/missing.vdb", LMB_ERROR_IO, "No such file");
    check_refused(FOLDER, LMB_ERROR_IO, "directory");
    CHECK(lmb_file_write(PATH, "", 0, NULL) == LMB_OK, "write");
    check_refused(PATH, LMB_ERROR_FORMAT, "empty");
    CHECK(lmb_file_write(PATH, "{\"not\": \"a volume\"}", 19, NULL) == LMB_OK, "write");
    check_refused(PATH, LMB_ERROR_FORMAT, "not a .vdb file");
    CHECK(lmb_file_write(PATH, " BDV", 4, NULL) == LMB_OK, "write");
    check_refused(PATH, LMB_ERROR_FORMAT, "cut short");
}

/* Other people's grids may look like ours, but nobody says what signs and units theirs have. */
static void test_foreign(void)
{
    static const struct {
        const char *path;
        const char *reason;
    } cases[] = {
        {LMB_DATA_DIR "/vdb/probes_9xVec3S_half_zip.vdb", "no lambent_version"},
        {LMB_DATA_DIR "/vdb/probes_9xVec3S_mask.vdb", "no lambent_version"},
        {LMB_DATA_DIR "/vdb/probes_9xVec3S_none.vdb", "no lambent_version"},
        {LMB_DATA_DIR "/vdb/probes_9xVec3S_zip.vdb", "no lambent_version"},
        {LMB_DATA_DIR "/vdb/scalar_r_g_b_bool_int_zip.vdb", "no grid sh_0"},
        {LMB_DATA_DIR "/vdb/openusd/smoke_000001.vdb", "no grid sh_0"},
        {LMB_DATA_DIR "/vdb/openusd/densityAndHeat.vdb", "no grid sh_0"},
    };
    if (access(cases[0].path, R_OK) != 0) {
        test_skip("no real .vdb files");
        return;
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        check_refused(cases[i].path, LMB_ERROR_FORMAT, cases[i].reason);
    }
    /* Cut off anywhere, too: these carry no content hash. */
    unsigned char *data = NULL;
    size_t bytes = 0;
    CHECK(lmb_file_read(cases[0].path, &data, &bytes, NULL) == LMB_OK, "read");
    folder_start(FOLDER);
    for (size_t kept = 1; data && kept < bytes; kept += 1 + kept / 5) {
        CHECK(lmb_file_write(PATH, data, kept, NULL) == LMB_OK, "write");
        check_refused(PATH, LMB_ERROR_FORMAT, "");
    }
    free(data);
}

static void test_failed_writes(void)
{
    folder_start(FOLDER);
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {20, 20, 20}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 4.0, 7);
    lmb_error error = {""};
    CHECK(lmb_vdb_write(FOLDER "/missing/a.vdb", probes, &metadata, &error) == LMB_ERROR_WRITE, "no such folder");
    CHECK(strstr(error.message, FOLDER "/missing/a.vdb") && strstr(error.message, "No such file"), "'%s'",
          error.message);

    CHECK(lmb_file_write(PATH, "old", 3, NULL) == LMB_OK, "write");
    /* A limit on the size of files fails the write half-way, as a full disk does. */
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    const struct rlimit lower = {10000, limit.rlim_max};
    void (*const previous)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &lower);
    const lmb_result result = lmb_vdb_write(PATH, probes, &metadata, &error);
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, previous);
    CHECK(result == LMB_ERROR_WRITE, "a full disk: %d", result);
    CHECK(strstr(error.message, PATH ": cannot write: ") && !strchr(error.message, '\n'), "'%s'", error.message);
    CHECK(folder_entry_count(FOLDER) == 1, "%d entries are left", folder_entry_count(FOLDER));
    unsigned char *data = NULL;
    size_t bytes = 0;
    CHECK(lmb_file_read(PATH, &data, &bytes, NULL) == LMB_OK && bytes == 3, "the old contents are gone");
    free(data);

    probes->radiance[0][3].channel[0].c[0] = 3e38f;
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT, "beyond every scale");
    probes->radiance[0][3].channel[0].c[0] = NAN;
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT, "NaN");
    CHECK(folder_entry_count(FOLDER) == 1, "%d entries are left", folder_entry_count(FOLDER));
    lmb_probes_destroy(probes);
}

/* What the format does not hold is refused, and leaves no file. */
static void test_refused_probes(void)
{
    folder_start(FOLDER);
    const lmb_lattice lattice = {.spacing = 1.0f, .size = {3, 3, 3}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 4.0, 7);
    const lmb_lattice straight = probes->level[0].lattice;
    lmb_error error = {""};
    CHECK(lmb_lattice_turn(&probes->level[0].lattice, (lmb_vec3d){0.0, 0.0, 1.0}, (lmb_vec3d){0.0, 1.0, 0.0}) &&
              lmb_probes_validate(probes, NULL) == LMB_OK,
          "turned");
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT, "a turned lattice");
    CHECK(strstr(error.message, PATH ": ") && strstr(error.message, "turned"), "'%s'", error.message);
    CHECK(folder_entry_count(FOLDER) == 0, "%d entries", folder_entry_count(FOLDER));
    probes->level[0].lattice = straight;
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_OK, "%s", error.message);
    remove(PATH);
    uint32_t set;
    CHECK(lmb_probes_add_set(probes, &set) == LMB_OK, "a set");
    CHECK(lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_ERROR_ARGUMENT, "two sets");
    CHECK(strstr(error.message, PATH ": ") && strstr(error.message, "one set"), "'%s'", error.message);
    CHECK(folder_entry_count(FOLDER) == 0, "%d entries", folder_entry_count(FOLDER));
    lmb_probes_destroy(probes);
}

/* What OpenVDB's own tool reads from the file. */
static void test_vdb_print(void)
{
    if (access("/usr/bin/vdb_print", X_OK) != 0) {
        test_skip("vdb_print is not installed");
        return;
    }
    folder_start(FOLDER);
    const lmb_lattice lattice = {.spacing = 0.25f, .min = {-9, 3, 5}, .size = {4, 5, 6}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 1e6, 7);
    write_probes(probes);
    lmb_probes_destroy(probes);
    CHECK(system("/usr/bin/vdb_print -l -m '" PATH "' > '" FOLDER "/printed' 2>&1") == 0, "vdb_print");
    unsigned char *text = NULL;
    size_t bytes = 0;
    CHECK(lmb_file_read(FOLDER "/printed", &text, &bytes, NULL) == LMB_OK, "read");
    static const char *const expected[] = {
        "Name: sh_0",
        "Name: sh_4",
        "Name: sh_8",
        "Name: validity",
        "Tree_vec3s_5_4_3",
        "Tree_float_5_4_3",
        "lambent_version: 3",
        "lambent_levels: 1",
        "lambent_scale: 32",
        "lambent_spacing: 0.25",
        "lambent_min: [-9, 3, 5]",
        "lambent_size: [4, 5, 6]",
        "lambent_basis: 00 1-1 10 11 2-2 2-1 20 21 22",
        "Condon-Shortley",
        "radiance",
        "is_saved_as_half_float: true",
        "voxel size: 0.25",
        "[-9, 3, 5] -> [-6, 7, 10]",
        "lambent_scene_hash: 0123abcd",
        "\"samples\": 64",
        "Number of active voxels:       120",
    };
    for (size_t i = 0; text && i < sizeof expected / sizeof expected[0]; ++i) {
        CHECK(strstr((const char *)text, expected[i]), "vdb_print does not show '%s'", expected[i]);
    }
    free(text);
}

static const test_case cases[] = {
    {"round trip", test_round_trip},
    {"an unedited file packs to the same bytes", test_pack_of_vdb},
    {"equal probes give equal bytes", test_equal_bytes},
    {"damaged and truncated files", test_damage},
    {"other kinds of file", test_wrong_kind},
    {"other people's volumes", test_foreign},
    {"writes that fail", test_failed_writes},
    {"what the format does not hold is refused", test_refused_probes},
    {"vdb_print shows names and metadata", test_vdb_print},
};
TEST_MAIN(cases)
