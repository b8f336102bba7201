/* probes.vdb: read, and what was read is sound and can be packed. OpenVDB opens names alone: the bytes go through a
 * file in memory.
 *
 * Changed bytes of a file of ours are refused by their hash before OpenVDB sees them. Those of a file that another
 * program saved are not, and OpenVDB 10 believes them: it takes up to 4 GiB for the length of a name, and writes past
 * the end of a Blosc block's buffer (bloscFromStream). Who fuzzes this target for long finds just that. */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <lambent/pack.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include "probes_fixture.h"

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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int file = -1;
    static char path[64];
    if (file < 0) {
        file = memfd_create("probes.vdb", MFD_CLOEXEC);
        snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    }
    FUZZ_CHECK(file >= 0 && ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == (ssize_t)size, "no file");
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
    return 0;
}

static void seed_of(const lmb_lattice *lattice, double density, uint32_t keys)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/fuzz_seed.vdb";
    const lmb_vdb_metadata metadata = {"{\"samples\": 64}", "0123456789abcdef"};
    lmb_probes *const probes = fixture_random_probes(lattice, density, 0.8, 2.0, 7);
    lmb_error error = {{0}};
    probes->key_light_count = keys;
    for (uint32_t key = 0; key < keys; ++key) {
        probes->key_light[key] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{1.0f, 2.5f, 1e6f}}};
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            probes->key_visibility[probe][key] = (float)(probe % 3) / 2.0f;
        }
    }
    FUZZ_CHECK(lmb_vdb_write(path, probes, &metadata, &error) == LMB_OK, "%s", error.message);
    fuzz_seed_file(path);
    lmb_probes_destroy(probes);
    remove(path);
}

void fuzz_seeds(void)
{
    seed_of(&(lmb_lattice){.spacing = 0.5f, .min = {0, 0, 0}, .size = {2, 2, 2}}, 1.0, 0);
    seed_of(&(lmb_lattice){.spacing = 1.0f, .min = {-3, 5, -9}, .size = {9, 3, 4}}, 0.6, 2);
}
