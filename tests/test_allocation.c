/* Every allocation fails in turn: the result says so, outputs are untouched, and (under AddressSanitizer) nothing
 * leaks. The linker sends the libraries' allocations here (--wrap). */
#include "allocation_fail.h"
#include "harness.h"
#include "local_fixture.h"
#include "tiles_fixture.h"

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/volume.h>
#include <lambent/volume_texture.h>

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

/* A volume with cut cells, a key light and local sets, in eight tiles. */
static divided rich;

static lmb_probes *rich_probes(void)
{
    static const levels_recipe recipe = {
        .spacing = 0.5f, .levels = 1, .low = 0, .cubes = 4, .cut = 0.2, .keys = 1, .seed = 1};
    uint64_t state = 3;
    lmb_probes *const probes = levels_make(&recipe);
    local_fixture_add(probes, &state);
    return probes;
}

static lmb_result add_local(void)
{
    const long count = failing;
    allocation_fail_after(-1);
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 0.5, 1.0, 3);
    const lmb_local_frame frame = local_fixture_frame(0);
    allocation_fail_after(count);
    const lmb_result result = lmb_probes_add_local(probes, "statue", 1, 2, &frame);
    CHECK(lmb_probes_validate(probes, NULL) == LMB_OK, "the probes are whole");
    CHECK(probes->local_count == (result == LMB_OK), "%u sets", probes->local_count);
    lmb_probes_destroy(probes);
    return result;
}

static lmb_result pack_rich(void)
{
    const long count = failing;
    allocation_fail_after(-1);
    lmb_probes *const probes = rich_probes();
    unsigned char *data = NULL;
    size_t bytes = 7;
    allocation_fail_after(count);
    const lmb_result result = lmb_pack_as(LMB_VOLUME_COMPACT, probes, &data, &bytes, NULL);
    CHECK(result == LMB_OK || (!data && bytes == 7), "outputs were touched");
    free(data);
    lmb_probes_destroy(probes);
    return result;
}

static lmb_result tile_count(void *context, const int32_t at[3], const unsigned char *data, size_t size)
{
    (void)at;
    *(uint32_t *)context += size > 0 && data[0] == 0x89;
    return LMB_OK;
}

static lmb_result split(void)
{
    static const int32_t cells[3] = {LMB_BRICK_CELLS, LMB_BRICK_CELLS, LMB_BRICK_CELLS};
    unsigned char *index = NULL;
    size_t size = 7;
    uint32_t count = 0;
    const lmb_split_sink sink = {tile_count, &count};
    const lmb_result result = lmb_split(rich.whole, cells, &sink, &index, &size);
    CHECK(result == LMB_OK ? index && count == rich.count : !index && size == 7, "%u tiles, %zu bytes", count, size);
    free(index);
    return result;
}

static lmb_result open_tiles(void)
{
    lmb_volume_tiles *tiles = NULL;
    const lmb_result result = lmb_volume_tiles_open_memory(rich.index, rich.index_size, &tiles);
    CHECK((tiles != NULL) == (result == LMB_OK), "tiles");
    lmb_volume_tiles_close(tiles);
    return result;
}

/* In the caller's memory: tiles are opened, come, are sampled and go. */
static bool tiles_use(void *memory, size_t bytes, lmb_volume_storage *storage)
{
    lmb_volume_tiles *tiles = NULL;
    bool good = lmb_volume_tiles_open_memory_in(memory, bytes, rich.index, rich.index_size, &tiles) == LMB_OK;
    const lmb_vec3d at = {1.2, 1.3, 1.4};
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    lmb_sh3_rgb light;
    lmb_rgb irradiance;
    float seen[LMB_KEY_LIGHTS_MOST];
    bool inside = false;
    for (uint32_t i = 0; good && i < rich.count; ++i) {
        lmb_volume *volume = NULL, *former = NULL;
        good = lmb_volume_open_memory_in(&storage[i], rich.data[i], rich.size[i], &volume) == LMB_OK &&
               lmb_volume_tiles_set(tiles, i, volume, &former) == LMB_OK;
    }
    if (good) {
        const uint32_t entered = lmb_volume_tiles_enter(tiles);
        lmb_volume_tiles_sample_batch(tiles, &at, 1, &light, NULL, &inside);
        good = inside && lmb_volume_tiles_sample_with_keys(tiles, at, &light, seen) &&
               lmb_volume_tiles_irradiance(tiles, at, up, &irradiance);
        lmb_volume_tiles_leave(tiles, entered);
    }
    for (uint32_t i = 0; good && i < rich.count; ++i) {
        lmb_volume_close(lmb_volume_tiles_clear(tiles, i));
    }
    lmb_volume_tiles_close(tiles);
    return good;
}

static bool locals_use(void)
{
    static lmb_sh3_rgb light[LMB_LOCAL_SET_MOST];
    static float seen[LMB_LOCAL_SET_MOST][LMB_KEY_LIGHTS_MOST];
    const uint32_t set = lmb_volume_local_set_find(rich.whole, local_fixture_name[1]);
    const lmb_local_frame frame = lmb_volume_local_set_get(rich.whole, set).frame;
    lmb_sh3_rgb sampled;
    lmb_volume_local_set_light(rich.whole, set, light, seen);
    lmb_local_set_sample(&frame, light, lmb_local_frame_position(&frame, 1), &sampled);
    return set < LOCAL_FIXTURE_SETS && sampled.channel[0].c[0] > 0.0f;
}

static bool textures_use(const lmb_volume_texture_layout *layout, void *texels, uint32_t *words)
{
    lmb_volume_texture_fill(rich.whole, layout, texels, words);
    return lmb_volume_texture_get_constants(rich.whole, layout, (lmb_vec3d){0.0, 0.0, 0.0}).inverse_spacing == 2.0f;
}

/* What a game does with tiles, local sets and textures, once their memory is there. */
static void test_use_without_allocation(void)
{
    const lmb_volume_texture_def def = lmb_volume_texture_default();
    lmb_volume_texture_layout layout;
    size_t bytes = 0;
    CHECK(lmb_volume_tiles_memory(rich.index, rich.index_size, &bytes) == LMB_OK &&
              lmb_volume_texture_size(rich.whole, &def, &layout) == LMB_OK,
          "sizes");
    void *const memory = aligned_alloc(64, (bytes + 63) / 64 * 64), *const texels =
                                                                        malloc((size_t)layout.texture_bytes);
    uint32_t *const words = malloc(layout.word_count * sizeof *words);
    lmb_volume_storage *const storage = malloc(rich.count * sizeof *storage);
    allocation_fail_after(0);
    const bool tiles = tiles_use(memory, bytes, storage), locals = locals_use();
    const bool textures = textures_use(&layout, texels, words);
    const long asked = allocation_count();
    allocation_fail_after(-1);
    CHECK(tiles && locals && textures && asked == 0, "tiles %d, local sets %d, textures %d, %ld allocations", tiles,
          locals, textures, asked);
    free(memory);
    free(texels);
    free(words);
    free(storage);
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
        {"add a local set", add_local, 3},
        {"pack all there is", pack_rich, 8},
        {"split", split, 12},
        {"open tiles", open_tiles, 1},
    };
    shared_probes = fixture_random_probes(&lattice, 1.0, 0.5, 1.0, 3);
    lmb_probes *const probes = rich_probes();
    divided_of(probes, LMB_VOLUME_HALFS, 1, &rich);
    lmb_probes_destroy(probes);
    CHECK(rich.count == 8, "%u tiles", rich.count);
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
    test_use_without_allocation();
    divided_free(&rich);
    remove(LMB_TEST_OUTPUT_DIR "/allocation.lmb");
    free(shared_image);
    lmb_probes_destroy(shared_probes);
}

static const test_case cases[] = {{"every allocation fails in turn", test_each}};
TEST_MAIN(cases)
