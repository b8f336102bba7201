/* Whole files: read back what was written, never leave half of one, name what failed. */
#define _POSIX_C_SOURCE 200809L

#include "folder_fixture.h"
#include "harness.h"

#include <lambent/file.h>

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define FOLDER LMB_TEST_OUTPUT_DIR "/file"

static bool holds(const char *path, const void *expected, size_t size)
{
    unsigned char *data = NULL;
    size_t read_size = 0;
    const bool same = lmb_file_read(path, &data, &read_size, NULL) == LMB_OK && read_size == size &&
                      (size == 0 || memcmp(data, expected, size) == 0) && data[size] == 0;
    free(data);
    return same;
}

static void test_hash_vectors(void)
{
    /* From the authors' own test vectors, isthe.com/chongo/tech/comp/fnv. */
    static const struct {
        const char *text;
        uint64_t hash;
    } cases[] = {
        {"", UINT64_C(0xcbf29ce484222325)},
        {"a", UINT64_C(0xaf63dc4c8601ec8c)},
        {"b", UINT64_C(0xaf63df4c8601f1a5)},
        {"foobar", UINT64_C(0x85944171f73967e8)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const size_t length = strlen(cases[i].text);
        const uint64_t hash = lmb_hash(LMB_HASH_SEED, cases[i].text, length);
        CHECK(hash == cases[i].hash, "'%s' gives %016llx", cases[i].text, (unsigned long long)hash);
        const size_t half = length / 2;
        const uint64_t continued =
            lmb_hash(lmb_hash(LMB_HASH_SEED, cases[i].text, half), cases[i].text + half, length - half);
        CHECK(continued == hash, "'%s' in two pieces", cases[i].text);
    }
}

static void test_round_trip(void)
{
    folder_start(FOLDER);
    static const size_t sizes[] = {0, 1, 4094, 4095, 4096, 4097, 100000};
    unsigned char *const data = malloc(100000);
    for (size_t i = 0; i < 100000; ++i) {
        data[i] = (unsigned char)(i * 37 ^ i >> 8);
    }
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        lmb_error error = {""};
        CHECK(lmb_file_write(FOLDER "/data", data, sizes[i], &error) == LMB_OK, "%zu bytes: %s", sizes[i],
              error.message);
        CHECK(holds(FOLDER "/data", data, sizes[i]), "%zu bytes", sizes[i]);
        CHECK(folder_entry_count(FOLDER) == 1, "%zu bytes: something was left beside the file", sizes[i]);
    }
    free(data);
}

static void test_names(void)
{
    folder_start(FOLDER);
    char longest[256];
    memset(longest, 'n', 255);
    longest[255] = '\0';
    const char *const names[] = {"with spaces", "\xc3\xa9t\xc3\xa9 \xe5\x85\x89", "-dash", longest};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        char path[2048];
        snprintf(path, sizeof path, FOLDER "/%s", names[i]);
        CHECK(lmb_file_write(path, names[i], strlen(names[i]), NULL) == LMB_OK, "name '%s'", names[i]);
        CHECK(holds(path, names[i], strlen(names[i])), "name '%s'", names[i]);
    }
    CHECK(folder_entry_count(FOLDER) == 4, "%d entries", folder_entry_count(FOLDER));

    char *const beside = lmb_file_temporary_path("a/b/c");
    CHECK(beside && strncmp(beside, "a/b/", 4) == 0 && !strchr(beside + 4, '/'), "%s is not beside a/b/c", beside);
    free(beside);
    char *const here = lmb_file_temporary_path("c");
    CHECK(here && !strchr(here, '/'), "%s is not beside c", here);
    free(here);
}

/* A failure says which file in one line. */
static void check_failure(lmb_result result, lmb_result expected, const lmb_error *error, const char *path)
{
    CHECK(result == expected, "%s: result is %d", path, result);
    CHECK(strstr(error->message, path), "'%s' does not name %s", error->message, path);
    CHECK(!strchr(error->message, '\n'), "'%s' is more than a line", error->message);
}

/* A failing write keeps the old contents and leaves nothing else. */
static void check_failed_write(lmb_result result, const lmb_error *error, const char *path)
{
    check_failure(result, LMB_ERROR_WRITE, error, path);
}

static void test_full_disk(void)
{
    folder_start(FOLDER);
    CHECK(lmb_file_write(FOLDER "/data", "old", 3, NULL) == LMB_OK, "first write");
    /* A limit on the size of files fails a write half-way, as a full disk does. */
    static const unsigned char zeros[100000];
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    const struct rlimit lower = {10000, limit.rlim_max};
    void (*const previous)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &lower);
    lmb_error error = {""};
    const lmb_result result = lmb_file_write(FOLDER "/data", zeros, sizeof zeros, &error);
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, previous);
    check_failed_write(result, &error, FOLDER "/data");
    CHECK(holds(FOLDER "/data", "old", 3), "the old contents are gone");
    CHECK(folder_entry_count(FOLDER) == 1, "%d entries", folder_entry_count(FOLDER));
}

static void test_unwritable(void)
{
    folder_start(FOLDER);
    lmb_error error = {""};
    check_failed_write(lmb_file_write(FOLDER "/missing/data", "x", 1, &error), &error, FOLDER "/missing/data");
    CHECK(lmb_file_write(FOLDER "/plain", "x", 1, NULL) == LMB_OK, "plain file");
    check_failed_write(lmb_file_write(FOLDER "/plain/data", "x", 1, &error), &error, FOLDER "/plain/data");
    mkdir(FOLDER "/folder", 0777);
    check_failed_write(lmb_file_write(FOLDER "/folder", "x", 1, &error), &error, FOLDER "/folder");
    CHECK(folder_entry_count(FOLDER) == 2, "%d entries", folder_entry_count(FOLDER));
    rmdir(FOLDER "/folder");
    /* A device is not replaced by a file, whoever asks. */
    check_failed_write(lmb_file_write("/dev/null", "x", 1, &error), &error, "/dev/null");
    struct stat status;
    CHECK(stat("/dev/null", &status) == 0 && S_ISCHR(status.st_mode), "/dev/null is no device any more");
}

static void test_unreadable(void)
{
    folder_start(FOLDER);
    static const char *const paths[] = {FOLDER "/missing", FOLDER, FOLDER "/missing/data", ""};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; ++i) {
        unsigned char *data = (unsigned char *)1;
        size_t size = 77;
        lmb_error error = {""};
        check_failure(lmb_file_read(paths[i], &data, &size, &error), LMB_ERROR_IO, &error, paths[i]);
        CHECK(data == (unsigned char *)1 && size == 77, "'%s': outputs were touched", paths[i]);
    }
}

static void test_error_lines(void)
{
    lmb_error error;
    CHECK(lmb_error_set(NULL, LMB_ERROR_IO, "%s", "x") == LMB_ERROR_IO, "NULL");
    CHECK(lmb_error_set(&error, LMB_ERROR_FORMAT, "a\nb\tc\x7f%d", 5) == LMB_ERROR_FORMAT, "result");
    CHECK(strcmp(error.message, "a?b?c?5") == 0, "'%s'", error.message);

    /* Cut at any byte of a two-byte letter, what remains is still UTF-8. */
    for (int start = 0; start < 2; ++start) {
        char text[2 * LMB_ERROR_MESSAGE_SIZE] = "x";
        for (int i = 0; i < LMB_ERROR_MESSAGE_SIZE - 10; ++i) {
            strcpy(text + start + 2 * i, "\xc3\xa9");
        }
        lmb_error_set(&error, LMB_ERROR_IO, "%s", text);
        const size_t length = strlen(error.message);
        CHECK(length >= LMB_ERROR_MESSAGE_SIZE - 2, "%zu bytes remain", length);
        CHECK((length - (size_t)start) % 2 == 0, "start %d: the last letter is split", start);
    }
}

/* A device has no end, and a file of a few blocks may say that it is as large as a disk. */
static void test_endless(void)
{
    folder_start(FOLDER);
    static const struct {
        const char *path;
        lmb_result result;
    } table[] = {{"/dev/zero", LMB_ERROR_IO}, {"/dev/null", LMB_ERROR_IO}, {FOLDER "/sparse", LMB_ERROR_UNSUPPORTED}};
    FILE *const file = fopen(FOLDER "/sparse", "wb");
    CHECK(file && fclose(file) == 0 && truncate(FOLDER "/sparse", (off_t)5 << 30) == 0, "no sparse file");
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        unsigned char *data = NULL;
        size_t size = 7;
        lmb_error error = {""};
        const lmb_result result = lmb_file_read(table[i].path, &data, &size, &error);
        CHECK(result == table[i].result && !data && size == 7, "%s: %d", table[i].path, result);
        CHECK(strncmp(error.message, table[i].path, strlen(table[i].path)) == 0, "%s", error.message);
        free(data);
    }
    remove(FOLDER "/sparse");
}

static void test_paths_beside(void)
{
    static const struct {
        const char *path, *name, *beside;
    } paths[] = {{"level.gltf", "a.bin", "a.bin"},
                 {"in/level.gltf", "a.bin", "in/a.bin"},
                 {"/in/level.gltf", "b/a.bin", "/in/b/a.bin"},
                 {"in/level.gltf", "/a.bin", "/a.bin"},
                 {"/level.gltf", "", "/"},
                 {"in/", "a", "in/a"}};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; ++i) {
        char *const beside = lmb_file_path_beside(paths[i].path, paths[i].name);
        CHECK(beside && strcmp(beside, paths[i].beside) == 0, "%s, %s: %s", paths[i].path, paths[i].name, beside);
        free(beside);
    }
}

static const test_case cases[] = {
    {"FNV-1a vectors", test_hash_vectors},
    {"files come back as written", test_round_trip},
    {"long, spaced and Unicode names", test_names},
    {"a write that fails half-way", test_full_disk},
    {"places that cannot be written", test_unwritable},
    {"places that cannot be read", test_unreadable},
    {"files without an end", test_endless},
    {"paths beside others", test_paths_beside},
    {"error lines", test_error_lines},
};
TEST_MAIN(cases)
