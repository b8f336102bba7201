/* probes.vdb: read, and what was read is sound and can be packed. OpenVDB opens names alone: the bytes go through a
 * file in memory. Changed bytes of a file of ours are refused by their hash, so each input is read as another program's
 * too, whose UUID is no hash: then OpenVDB sees what the walk over the file lets through. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <lambent/pack.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include "cut_fixture.h"
#include "local_fixture.h"
#include "probes_fixture.h"
#include "vdb_editor.h"

/* A digit of the UUID, which is its kind: 8 for a hash. */
enum { UUID_KIND_AT = 21 + 14 };

/* A small file of many probes is nothing to pack for each input. */
enum { MOST_PACKED = 20000 };

static void probes_use(const lmb_probes *probes)
{
    lmb_error fault = {{0}};
    FUZZ_CHECK(lmb_probes_validate(probes, &fault) == LMB_OK, "%s", fault.message);
    unsigned char *data = NULL;
    size_t size = 0;
    if (probes->count > MOST_PACKED || lmb_pack(probes, &data, &size, NULL) != LMB_OK) {
        return;
    }
    lmb_volume *volume = NULL;
    const lmb_result result = lmb_volume_open_memory(data, size, &volume);
    FUZZ_CHECK(result == LMB_OK, "what was packed does not open: %s", lmb_result_text(result));
    lmb_volume_close(volume);
    free(data);
}

static void file_try(const char *path)
{
    lmb_probes *probes = NULL;
    char *settings = NULL, *hash = NULL;
    lmb_error error = {{0}};
    const lmb_result result = lmb_vdb_read(path, &probes, &settings, &hash, &error);
    FUZZ_CHECK((result == LMB_OK) == (probes != NULL), "%d", result);
    FUZZ_CHECK(result == LMB_OK || error.message[0] != '\0', "result %d without a message", result);
    if (probes) {
        probes_use(probes);
    }
    lmb_probes_destroy(probes);
    free(settings);
    free(hash);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int file = -1;
    static char path[64];
    if (file < 0) {
        file = memfd_create("probes.vdb", MFD_CLOEXEC);
        snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    }
    FUZZ_CHECK(file >= 0 && ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == (ssize_t)size, "no file");
    file_try(path);
    if (size > UUID_KIND_AT && data[UUID_KIND_AT] == '8') {
        FUZZ_CHECK(pwrite(file, "4", 1, UUID_KIND_AT) == 1, "no file");
        file_try(path);
    }
    return 0;
}

/* Key lights that see this and that. */
static void keys_add(lmb_probes *probes, uint32_t keys)
{
    probes->key_light_count = keys;
    for (uint32_t key = 0; key < keys; ++key) {
        probes->key_light[key] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{1.0f, 2.5f, 1e6f}}};
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            probes->key_visibility[probe][key] = (float)(probe % 3) / 2.0f;
        }
    }
}

/* The file as it was written, or as another tool saved it. */
static void seed_of(lmb_probes *probes, const vdb_editor_compression *saved)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/fuzz_seed.vdb";
    const lmb_vdb_metadata metadata = {"{\"samples\": 64}", "0123456789abcdef"};
    lmb_error error = {{0}};
    FUZZ_CHECK(lmb_vdb_write(path, probes, &metadata, &error) == LMB_OK, "%s", error.message);
    FUZZ_CHECK(!saved || vdb_editor_save(path, *saved), "not saved");
    fuzz_seed_file(path);
    lmb_probes_destroy(probes);
    remove(path);
}

void fuzz_seeds(void)
{
    const lmb_lattice cube = {.spacing = 0.5f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    const lmb_lattice box = {.spacing = 1.0f, .min = {-3, 5, -9}, .size = {9, 3, 4}};
    static const vdb_editor_compression saved[] = {VDB_EDITOR_BLOSC, VDB_EDITOR_ZIP, VDB_EDITOR_MASKS};
    for (size_t i = 0; i < 5; ++i) {
        lmb_probes *const probes =
            i == 0 ? fixture_random_probes(&cube, 1.0, 0.8, 2.0, 7) : fixture_random_probes(&box, 0.6, 0.8, 2.0, 7);
        keys_add(probes, i == 0 ? 0 : 2);
        seed_of(probes, i < 2 ? NULL : &saved[i - 2]);
    }
    seed_of(cut_fixture_probes(), NULL);
    seed_of(cut_fixture_probes(), &saved[0]);
    uint64_t state = 3;
    for (int i = 0; i < 2; ++i) {
        lmb_probes *const probes = fixture_random_probes(&cube, 1.0, 0.8, 2.0, 7);
        keys_add(probes, 1);
        local_fixture_add(probes, &state);
        seed_of(probes, i == 0 ? NULL : &saved[0]);
    }
}
