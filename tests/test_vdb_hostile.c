/* .vdb files of other programs, whose bytes no hash protects: whatever lengths and counts they claim, they are refused
 * before OpenVDB, which believes them, writes past a buffer. AddressSanitizer sees where one gets through. */
#include "folder_fixture.h"
#include "harness.h"
#include "probes_fixture.h"
#include "vdb_editor.h"

#include <lambent/file.h>
#include <lambent/vdb.h>

#define FOLDER LMB_TEST_OUTPUT_DIR "/vdb_hostile"
#define PATH FOLDER "/probes.vdb"

/* Bytes of the header before the UUID, which has 36. */
enum { UUID_AT = 21, METADATA_AT = UUID_AT + 36 };

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

static bytes file_saved(vdb_editor_compression compression)
{
    static const lmb_vdb_metadata metadata = {"{}", "0123abcd"};
    lmb_error error = {""};
    bytes file = {NULL, 0};
    folder_start(FOLDER);
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {-3, 5, -9}, .size = {9, 3, 4}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 0.6, 0.8, 2.0, 7);
    CHECK(probes && lmb_vdb_write(PATH, probes, &metadata, &error) == LMB_OK && vdb_editor_save(PATH, compression) &&
              lmb_file_read(PATH, &file.data, &file.size, &error) == LMB_OK,
          "%s", error.message);
    lmb_probes_destroy(probes);
    return file;
}

static lmb_result file_try(const bytes *file, lmb_error *error)
{
    lmb_probes *probes = NULL;
    *error = (lmb_error){""};
    FILE *const written = fopen(PATH, "wb");
    CHECK(written && fwrite(file->data, 1, file->size, written) == file->size && fclose(written) == 0, "no file");
    const lmb_result result = lmb_vdb_read(PATH, &probes, NULL, NULL, error);
    CHECK((probes != NULL) == (result == LMB_OK), "result %d", result);
    lmb_probes_destroy(probes);
    return result;
}

static uint64_t number_at(const bytes *file, size_t at, size_t width)
{
    uint64_t number = 0;
    for (size_t i = 0; i < width && at + i < file->size; ++i) {
        number |= (uint64_t)file->data[at + i] << 8 * i;
    }
    return number;
}

/* Where `text` is, with its length before it. */
static size_t find_text(const bytes *file, const char *text)
{
    const size_t length = strlen(text);
    for (size_t at = METADATA_AT; at + 4 + length <= file->size; ++at) {
        if (number_at(file, at, 4) == length && memcmp(file->data + at + 4, text, length) == 0) {
            return at;
        }
    }
    CHECK(false, "no %s", text);
    return 0;
}

/* Where the first Blosc block of a node is, with its length in 64 bits before it, and again in the header. */
static size_t find_block(const bytes *file)
{
    for (size_t at = find_text(file, "Tree_vec3s_5_4_3_HalfFloat"); at + 24 <= file->size; ++at) {
        const uint64_t length = number_at(file, at, 8);
        if (length > 16 && length < 65536 && number_at(file, at + 20, 4) == length && file->data[at + 8] == 2) {
            return at;
        }
    }
    CHECK(false, "no Blosc block");
    return 0;
}

/* Where a grid's positions are, behind its name, type and the empty name of a parent. */
static size_t find_positions(const bytes *file)
{
    return find_text(file, "Tree_vec3s_5_4_3_HalfFloat") + 4 + 26 + 4;
}

/* Where a grid's root is: behind the transform's name and 120 bytes. */
static size_t find_root(const bytes *file)
{
    return find_text(file, "UniformScaleMap") + 4 + 15 + 120;
}

static size_t find_name(const bytes *file)
{
    return find_text(file, "sh_0");
}

static size_t find_type(const bytes *file)
{
    return find_text(file, "Tree_vec3s_5_4_3_HalfFloat");
}

static size_t find_string(const bytes *file)
{
    return find_text(file, "lambent_settings") + 4 + 16 + 4 + 6; /* its type is "string" */
}

static size_t find_metadata(const bytes *file)
{
    (void)file;
    return METADATA_AT;
}

static size_t find_half(const bytes *file)
{
    return find_text(file, "is_saved_as_half_float") + 4 + 22 + 4 + 4 + 4; /* "bool" and a length of 1 */
}

static size_t find_leaf_places(const bytes *file)
{
    return find_text(file, "__delayedload") + 4 + 13 + 4;
}

static size_t find_version(const bytes *file)
{
    (void)file;
    return 8;
}

static size_t find_uuid(const bytes *file)
{
    (void)file;
    return UUID_AT;
}

static void lies_are_refused(void)
{
    static const struct {
        const char *what;
        size_t (*find)(const bytes *file);
        size_t beyond, width;
        uint64_t number;
        const char *reason;
    } lies[] = {
        {"a block that is stored, of 4 GiB", find_block, 0, 8, UINT64_C(0) - (UINT64_C(1) << 32), "another length"},
        {"a block of 4 GiB", find_block, 0, 8, UINT64_C(1) << 32, "lies about its length"},
        {"a block of INT64_MIN", find_block, 0, 8, UINT64_C(1) << 63, "another length"},
        {"a block of a byte", find_block, 0, 8, 1, "too short"},
        {"a block of more than its node", find_block, 12, 4, 1 << 20, "lies about its length"},
        {"a block of no contents", find_block, 12, 4, 0, "lies about its length"},
        {"a block that is longer inside", find_block, 20, 4, 1 << 20, "lies about its length"},
        {"a name of 4 GiB", find_name, 0, 4, UINT32_MAX, "cut short"},
        {"a type of 4 GiB", find_type, 0, 4, UINT32_MAX, "cut short"},
        {"a string of 4 GiB", find_string, 0, 4, UINT32_MAX, "cut short"},
        {"2^32 - 1 metadata", find_metadata, 0, 4, UINT32_MAX, ""},
        {"half a half", find_half, 0, 1, 2, "neither true nor false"},
        {"floats for halves", find_half, 0, 1, 0, "damaged"},
        {"2^32 - 1 leaves", find_leaf_places, 0, 4, UINT32_MAX, "cut short"},
        {"a grid that is elsewhere", find_positions, 0, 8, 0, "not where the file says"},
        {"a grid without an end", find_positions, 16, 8, UINT64_MAX, "cut short"},
        {"an unknown compression", find_positions, 24, 4, 8, "unknown way"},
        {"two buffers", find_root, 0, 4, 2, "one buffer"},
        {"2^32 - 1 tiles", find_root, 4 + 12, 4, UINT32_MAX, "damaged"},
        {"2^32 - 1 children", find_root, 4 + 12 + 4, 4, UINT32_MAX, "damaged"},
        {"a child that is askew", find_root, 4 + 12 + 8, 4, 1, "out of place"},
        {"an old version", find_version, 0, 4, 221, "version 221"},
        {"a new version", find_version, 0, 4, 225, "version 225"},
        {"a UUID that begins with a space", find_uuid, 0, 1, ' ', "no UUID"},
    };
    const bytes file = file_saved(VDB_EDITOR_BLOSC);
    lmb_error error;
    CHECK(file.data && file_try(&file, &error) == LMB_OK, "the file itself is refused");
    for (size_t i = 0; file.data && i < sizeof lies / sizeof lies[0]; ++i) {
        const size_t at = lies[i].find(&file) + lies[i].beyond;
        unsigned char before[8];
        memcpy(before, file.data + at, lies[i].width);
        for (size_t k = 0; k < lies[i].width; ++k) {
            file.data[at + k] = (unsigned char)(lies[i].number >> 8 * k);
        }
        const lmb_result result = file_try(&file, &error);
        CHECK(result == LMB_ERROR_FORMAT && strstr(error.message, lies[i].reason), "%s: %d, '%s', not '%s'",
              lies[i].what, result, error.message, lies[i].reason);
        memcpy(file.data + at, before, lies[i].width);
    }
    free(file.data);
}

/* OpenVDB would forget the node: LeakSanitizer sees it. */
static void a_node_that_cannot_be_decompressed_is_refused(void)
{
    static const struct {
        vdb_editor_compression saved;
        unsigned char first; /* byte of a block */
    } forms[] = {{VDB_EDITOR_BLOSC_ALL, 0x02}, {VDB_EDITOR_ZIP, 0x78}};
    enum { BEYOND = 8 + 16 }; /* the block's length, and a header */
    for (size_t form = 0; form < sizeof forms / sizeof forms[0]; ++form) {
        const bytes file = file_saved(forms[form].saved);
        lmb_error error;
        CHECK(file.data && file_try(&file, &error) == LMB_OK, "form %zu: the file itself is refused", form);
        size_t at = find_root(&file);
        while (at + BEYOND + 8 < file.size && (file.data[at + 8] != forms[form].first || number_at(&file, at, 8) < 16 ||
                                               number_at(&file, at, 8) > 65536)) {
            ++at;
        }
        memset(file.data + at + BEYOND, 0xff, 8);
        const lmb_result result = file_try(&file, &error);
        CHECK(result == LMB_ERROR_FORMAT && strstr(error.message, "cannot be decompressed"), "form %zu: %d, '%s'", form,
              result, error.message);
        free(file.data);
    }
}

/* All over the file: what is read is read, and everything else is refused in one line. */
static void flipped_bytes_do_no_harm(void)
{
    static const vdb_editor_compression saved[] = {VDB_EDITOR_BLOSC, VDB_EDITOR_ZIP, VDB_EDITOR_MASKS,
                                                   VDB_EDITOR_BLOSC_ALL};
    static const unsigned char flips[] = {0x01, 0x80, 0xff};
    for (size_t form = 0; form < sizeof saved / sizeof saved[0]; ++form) {
        const bytes file = file_saved(saved[form]);
        int read = 0, refused = 0;
        for (size_t i = 0, at = METADATA_AT; file.data && at < file.size; ++i, at += 1 + file.size / 120) {
            const unsigned char flip = flips[i % sizeof flips];
            lmb_error error;
            file.data[at] ^= flip;
            const lmb_result result = file_try(&file, &error);
            file.data[at] ^= flip;
            CHECK(result == LMB_OK || result == LMB_ERROR_FORMAT || result == LMB_ERROR_VERSION, "byte %zu: %d, %s", at,
                  result, error.message);
            CHECK(result == LMB_OK || (error.message[0] && !strchr(error.message, '\n')), "byte %zu: '%s'", at,
                  error.message);
            read += result == LMB_OK;
            refused += result != LMB_OK;
        }
        printf("     form %zu: %zu bytes, %d files read, %d refused\n", form, file.size, read, refused);
        CHECK(read > 0 && refused > 0, "form %zu: %d read, %d refused", form, read, refused);
        free(file.data);
    }
}

static const test_case cases[] = {
    {"lies are refused", lies_are_refused},
    {"a node that cannot be decompressed is refused", a_node_that_cannot_be_decompressed_is_refused},
    {"flipped bytes do no harm", flipped_bytes_do_no_harm},
};
TEST_MAIN(cases)
