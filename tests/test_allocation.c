/* Every allocation fails in turn: the result says so, outputs are untouched, and (under AddressSanitizer) nothing
 * leaks. The linker sends the libraries' allocations here (--wrap). */
#include "allocation_fail.h"
#include "probes_fixture.h"
#include "harness.h"

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/volume.h>

static long failing; /* the allocation of a run that fails */

static const lmb_lattice lattice = {.spacing = 1.0f, .min = {0, 0, 0}, .size = {3, 3, 3}};

static lmb_result create_probes(void)
{
    lmb_probes *probes = NULL;
    const lmb_result result = lmb_probes_create(&probes);
    CHECK((probes != NULL) == (result == LMB_OK), "probes");
    lmb_probes_destroy(probes);
    return result;
}

static lmb_probes *shared_probes;
static unsigned char *shared_image;
static size_t shared_bytes;

static lmb_result add_probes(void)
{
    static const int32_t points[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    const long count = failing;
    allocation_fail_after(-1);
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK, "create");
    allocation_fail_after(count);
    const lmb_result result = lmb_probes_add_level(probes, &lattice, points, 3);
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "the probes are whole");
    CHECK(probes->count == (result == LMB_OK ? 3 : 0), "%d probes", probes->count);
    lmb_probes_destroy(probes);
    return result;
}

static lmb_result add_set(void)
{
    const long count = failing;
    allocation_fail_after(-1);
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 0.5, 1.0, 3);
    allocation_fail_after(count);
    uint32_t set = 7;
    const lmb_result result = lmb_probes_add_set(probes, &set);
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "the probes are whole");
    CHECK(probes->set_count == (result == LMB_OK ? 2 : 1) && set == (result == LMB_OK ? 1 : 7), "set %u of %u", set,
          probes->set_count);
    lmb_probes_destroy(probes);
    return result;
}

static lmb_result dilate(void)
{
    return lmb_probes_dilate(shared_probes);
}

static lmb_result pack(void)
{
    unsigned char *data = NULL;
    size_t bytes = 7;
    lmb_pack_stats stats = {.bytes = 7};
    const lmb_result result = lmb_pack(shared_probes, &data, &bytes, &stats);
    CHECK(result == LMB_OK || (!data && bytes == 7 && stats.bytes == 7), "outputs were touched");
    free(data);
    return result;
}

static lmb_result open_volume(void)
{
    lmb_volume *volume = NULL;
    const lmb_result result = lmb_volume_open_memory(shared_image, shared_bytes, &volume);
    CHECK((volume != NULL) == (result == LMB_OK), "volume");
    lmb_volume_close(volume);
    return result;
}

/* With the caller's memory for the handle no allocation is left that could fail. */
static void test_open_without_allocation(const unsigned char *image, size_t bytes)
{
    lmb_volume_storage storage;
    lmb_volume *volume = NULL;
    lmb_sh3_rgb light;
    allocation_fail_after(0);
    const lmb_result result = lmb_volume_open_memory_in(&storage, image, bytes, &volume);
    const bool inside = result == LMB_OK && lmb_volume_sample(volume, (lmb_vec3){1.0f, 1.0f, 1.0f}, &light);
    CHECK(allocation_count() == 0, "something was allocated");
    allocation_fail_after(-1);
    CHECK(result == LMB_OK && inside, "result %d", result);
    lmb_volume_close(volume);
}

static lmb_result open_file(void)
{
    lmb_volume *volume = NULL;
    const lmb_result result = lmb_volume_open_file(LMB_TEST_OUTPUT_DIR "/allocation.lmb", &volume);
    CHECK((volume != NULL) == (result == LMB_OK), "volume");
    lmb_volume_close(volume);
    return result;
}

static lmb_result read_file(void)
{
    unsigned char *data = NULL;
    size_t bytes = 0;
    const lmb_result result = lmb_file_read(LMB_TEST_OUTPUT_DIR "/allocation.lmb", &data, &bytes, NULL);
    CHECK((data != NULL) == (result == LMB_OK), "data");
    free(data);
    return result;
}

static lmb_result write_file(void)
{
    return lmb_file_write(LMB_TEST_OUTPUT_DIR "/allocation.lmb", shared_image, shared_bytes, NULL);
}

/* /proc says that its files are empty, so that the buffer has to grow. */
static lmb_result read_growing_file(void)
{
    unsigned char *data = NULL;
    size_t bytes = 0;
    const lmb_result result = lmb_file_read("/proc/self/smaps", &data, &bytes, NULL);
    CHECK((data != NULL) == (result == LMB_OK), "data");
    CHECK(result != LMB_OK || bytes > 4096, "%zu bytes", bytes);
    free(data);
    return result;
}

static void test_each(void)
{
    static const struct {
        const char *name;
        lmb_result (*run)(void);
        int least; /* failures seen, at least */
    } runs[] = {
        {"create", create_probes, 2},
        {"add probes", add_probes, 6},
        {"add a set", add_set, 2},
        {"dilate", dilate, 2},
        {"pack", pack, 4},
        {"open", open_volume, 1},
        {"map", open_file, 1},
        {"read", read_file, 1},
        {"write", write_file, 1},
        {"read and grow", read_growing_file, 2},
    };
    shared_probes = fixture_random_probes(&lattice, 1.0, 0.5, 1.0, 3);
    CHECK(lmb_pack(shared_probes, &shared_image, &shared_bytes, NULL) == LMB_OK, "pack");
    CHECK(lmb_file_write(LMB_TEST_OUTPUT_DIR "/allocation.lmb", shared_image, shared_bytes, NULL) == LMB_OK, "write");
    for (size_t i = 0; i < sizeof runs / sizeof runs[0]; ++i) {
        lmb_result result = LMB_ERROR_MEMORY;
        int failed = 0;
        for (; failed < 100 && result == LMB_ERROR_MEMORY; ++failed) {
            failing = failed;
            allocation_fail_after(failing);
            result = runs[i].run();
            allocation_fail_after(-1);
        }
        CHECK(result == LMB_OK, "%s: ends with %d", runs[i].name, result);
        CHECK(failed - 1 >= runs[i].least, "%s: only %d allocations failed", runs[i].name, failed - 1);
    }
    test_open_without_allocation(shared_image, shared_bytes);
    remove(LMB_TEST_OUTPUT_DIR "/allocation.lmb");
    free(shared_image);
    lmb_probes_destroy(shared_probes);
}

static const test_case cases[] = {{"every allocation fails in turn", test_each}};
TEST_MAIN(cases)
