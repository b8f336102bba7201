/* A volume in tiles gives the bits of the undivided one, while tiles come and go. */
#define _POSIX_C_SOURCE 200809L

#include <lambent/file.h>

#include "harness.h"
#include "levels_fixture.h"
#include "local_fixture.h"
#include "tiles_fixture.h"
#include "variates.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/stat.h>

enum { POSITIONS = 4000, THREADS = 4 };

static void all_set(divided *made)
{
    for (uint32_t i = 0; i < made->count; ++i) {
        lmb_volume *former = made->whole;
        CHECK(lmb_volume_tiles_set(made->tiles, i, made->volume[i], &former) == LMB_OK && !former, "tile %u", i);
    }
}

/* Places within the bounds and beside them, some right at lattice points, so at borders of tiles, or next to them. */
static lmb_vec3d position_make(const lmb_volume_tiles_info *info, uint64_t *state)
{
    const double low[3] = {info->bounds_min.x, info->bounds_min.y, info->bounds_min.z};
    const double high[3] = {info->bounds_max.x, info->bounds_max.y, info->bounds_max.z};
    double at[3];
    for (int axis = 0; axis < 3; ++axis) {
        at[axis] = low[axis] + (1.2 * variate_next(state) - 0.1) * (high[axis] - low[axis]);
        const double kind = variate_next(state);
        if (kind < 0.3) {
            at[axis] = (double)info->spacing * rint(at[axis] / (double)info->spacing);
            at[axis] = kind < 0.1 ? nextafter(at[axis], -1e9) : kind < 0.2 ? nextafter(at[axis], 1e9) : at[axis];
        }
    }
    return (lmb_vec3d){at[0], at[1], at[2]};
}

static void same_bits_of(const divided *made, const char *what)
{
    static lmb_vec3d position[POSITIONS];
    static lmb_vec3 normal[POSITIONS];
    static lmb_sh3_rgb light[2][POSITIONS];
    static float seen[2][POSITIONS][LMB_KEY_LIGHTS_MOST];
    static lmb_rgb irradiance[2][POSITIONS];
    static bool inside[2][POSITIONS];
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(made->tiles);
    uint64_t state = 7;
    int32_t lit = 0;
    for (int i = 0; i < POSITIONS; ++i) {
        position[i] = position_make(&info, &state);
        normal[i] = (lmb_vec3){0.0f, i % 2 ? 0.6f : 1.0f, i % 2 ? 0.8f : 0.0f};
    }
    position[3].x = NAN;
    position[4].y = INFINITY;
    lmb_volume_sample_batch(made->whole, position, POSITIONS, light[0], seen[0], inside[0]);
    lmb_volume_tiles_sample_batch(made->tiles, position, POSITIONS, light[1], seen[1], inside[1]);
    CHECK(memcmp(light[0], light[1], sizeof light[0]) == 0 && memcmp(seen[0], seen[1], sizeof seen[0]) == 0 &&
              memcmp(inside[0], inside[1], sizeof inside[0]) == 0,
          "%s: batches", what);
    lmb_volume_irradiance_batch(made->whole, position, normal, POSITIONS, irradiance[0], inside[0]);
    lmb_volume_tiles_irradiance_batch(made->tiles, position, normal, POSITIONS, irradiance[1], inside[1]);
    CHECK(memcmp(irradiance[0], irradiance[1], sizeof irradiance[0]) == 0 &&
              memcmp(inside[0], inside[1], sizeof inside[0]) == 0,
          "%s: batches of irradiance", what);
    for (int i = 0; i < POSITIONS; ++i) {
        lmb_sh3_rgb one, keyed;
        float of_keys[LMB_KEY_LIGHTS_MOST];
        lmb_rgb on_normal;
        const bool is_inside = lmb_volume_tiles_sample(made->tiles, position[i], &one);
        lmb_volume_tiles_sample_with_keys(made->tiles, position[i], &keyed, of_keys);
        lmb_volume_tiles_irradiance(made->tiles, position[i], normal[i], &on_normal);
        CHECK(is_inside == inside[0][i] && memcmp(&one, &light[0][i], sizeof one) == 0 &&
                  memcmp(&keyed, &light[0][i], sizeof one) == 0 && memcmp(of_keys, seen[0][i], sizeof of_keys) == 0 &&
                  memcmp(&on_normal, &irradiance[0][i], sizeof on_normal) == 0,
              "%s: %.17g %.17g %.17g", what, position[i].x, position[i].y, position[i].z);
        lit += is_inside;
    }
    CHECK(lit > POSITIONS / 20, "%s: %d inside", what, lit);
}

static void same_bits(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        for (int form = 0; form < LMB_VOLUME_FORMS; ++form) {
            for (int32_t bricks = 1; bricks <= 3; bricks += 2) {
                char what[64];
                divided made;
                snprintf(what, sizeof what, "recipe %d, form %d, %d bricks", k, form, bricks);
                divided_make(&levels_recipes[k], (lmb_volume_form)form, bricks, &made);
                all_set(&made);
                same_bits_of(&made, what);
                divided_free(&made);
            }
        }
    }
}

static bool is_same_set(const lmb_volume *one, uint32_t of_one, const lmb_volume *other, uint32_t of_other)
{
    static lmb_sh3_rgb light[2][LMB_LOCAL_SET_MOST];
    static float seen[2][LMB_LOCAL_SET_MOST][LMB_KEY_LIGHTS_MOST];
    const lmb_local_set set[2] = {lmb_volume_local_set_get(one, of_one), lmb_volume_local_set_get(other, of_other)};
    const uint32_t count = lmb_local_frame_count(&set[0].frame);
    if (strcmp(set[0].name, set[1].name) != 0 || set[0].node != set[1].node || set[0].place != set[1].place ||
        memcmp(&set[0].frame, &set[1].frame, sizeof set[0].frame) != 0) {
        return false;
    }
    lmb_volume_local_set_light(one, of_one, light[0], seen[0]);
    lmb_volume_local_set_light(other, of_other, light[1], seen[1]);
    return memcmp(light[0], light[1], count * sizeof light[0][0]) == 0 &&
           memcmp(seen[0], seen[1], count * sizeof seen[0][0]) == 0;
}

/* Squared metres from a place to a tile. */
static double tile_distance(const divided *made, uint32_t tile, lmb_vec3d place)
{
    const lmb_volume_tile box = lmb_volume_tiles_get(made->tiles, tile);
    const double beyond[3] = {fmax(box.bounds_min.x - place.x, place.x - box.bounds_max.x),
                              fmax(box.bounds_min.y - place.y, place.y - box.bounds_max.y),
                              fmax(box.bounds_min.z - place.z, place.z - box.bounds_max.z)};
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        sum += beyond[axis] > 0.0 ? beyond[axis] * beyond[axis] : 0.0;
    }
    return sum;
}

/* Each set is in one tile, whole: that which is asked where its middle is, or the nearest. */
static void local_sets_of(const divided *made, const char *what)
{
    uint32_t next[TILES_MOST] = {0};
    for (uint32_t i = 0; i < lmb_volume_local_set_count(made->whole); ++i) {
        const lmb_local_frame frame = lmb_volume_local_set_get(made->whole, i).frame;
        const lmb_vec3d first = lmb_local_frame_position(&frame, 0);
        const lmb_vec3d last = lmb_local_frame_position(&frame, lmb_local_frame_count(&frame) - 1);
        const lmb_vec3d middle = {0.5 * (first.x + last.x), 0.5 * (first.y + last.y), 0.5 * (first.z + last.z)};
        uint32_t tile = lmb_volume_tiles_find(made->tiles, middle);
        for (uint32_t k = 0; tile == LMB_VOLUME_NO_TILE && k < made->count; ++k) {
            const bool has_it = next[k] < lmb_volume_local_set_count(made->volume[k]) &&
                                is_same_set(made->whole, i, made->volume[k], next[k]);
            tile = has_it ? k : tile;
        }
        CHECK(tile < made->count && next[tile] < lmb_volume_local_set_count(made->volume[tile]) &&
                  is_same_set(made->whole, i, made->volume[tile], next[tile]),
              "%s: set %u", what, i);
        for (uint32_t k = 0; tile < made->count && k < made->count; ++k) {
            CHECK(tile_distance(made, tile, middle) <= tile_distance(made, k, middle) * (1.0 + 1e-9) + 1e-9,
                  "%s: set %u is in tile %u, and %u is nearer", what, i, tile, k);
        }
        next[tile < made->count ? tile : 0] += 1;
    }
    for (uint32_t k = 0; k < made->count; ++k) {
        const uint32_t count = lmb_volume_local_set_count(made->volume[k]);
        CHECK(next[k] == count, "%s: tile %u has %u sets, not %u", what, k, count, next[k]);
    }
}

static void local_sets(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        for (int form = 0; form < LMB_VOLUME_FORMS; ++form) {
            char what[64];
            divided made;
            uint64_t state = 3;
            lmb_probes *const probes = levels_make(&levels_recipes[k]);
            local_fixture_add(probes, &state);
            snprintf(what, sizeof what, "local sets, recipe %d, form %d", k, form);
            divided_of(probes, (lmb_volume_form)form, 1, &made);
            lmb_probes_destroy(probes);
            CHECK(lmb_volume_local_set_count(made.whole) == LOCAL_FIXTURE_SETS, "%s: none", what);
            local_sets_of(&made, what);
            all_set(&made);
            same_bits_of(&made, what);
            divided_free(&made);
        }
    }
}

/* What is not set is dark, the rest as it was; a tile of another place or another bake is refused. */
static void closed_and_refused(void)
{
    divided made, other;
    levels_recipe changed = levels_recipes[3];
    divided_make(&levels_recipes[3], LMB_VOLUME_HALFS, 1, &made);
    changed.seed += 1;
    changed.split = 0.6;
    divided_make(&changed, LMB_VOLUME_HALFS, 1, &other);
    CHECK(made.count > 4, "%u tiles", made.count);
    lmb_volume *former;
    CHECK(lmb_volume_tiles_set(made.tiles, 0, made.volume[1], &former) == LMB_ERROR_FORMAT, "another place");
    CHECK(lmb_volume_tiles_set(made.tiles, 0, made.whole, &former) == LMB_ERROR_FORMAT, "the whole");
    const lmb_result stale = lmb_volume_tiles_set(made.tiles, 0, other.volume[0], &former);
    CHECK(stale == LMB_ERROR_CHECKSUM || stale == LMB_ERROR_FORMAT, "another bake: %d", stale);
    all_set(&made);
    CHECK(lmb_volume_tiles_clear(made.tiles, 2) == made.volume[2] && !lmb_volume_tiles_is_set(made.tiles, 2), "clear");
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(made.tiles);
    uint64_t state = 11;
    int dark = 0, lit = 0;
    for (int i = 0; i < POSITIONS; ++i) {
        const lmb_vec3d at = position_make(&info, &state);
        lmb_sh3_rgb light, batched, expected;
        bool batched_inside;
        const bool inside = lmb_volume_tiles_sample(made.tiles, at, &light);
        lmb_volume_tiles_sample_batch(made.tiles, &at, 1, &batched, NULL, &batched_inside);
        bool expected_inside = lmb_volume_sample_at(made.whole, at, &expected);
        if (lmb_volume_tiles_find(made.tiles, at) == 2) {
            memset(&expected, 0, sizeof expected);
            expected_inside = false;
            ++dark;
        }
        lit += inside;
        CHECK(inside == expected_inside && batched_inside == inside && memcmp(&light, &expected, sizeof light) == 0 &&
                  memcmp(&batched, &expected, sizeof light) == 0,
              "position %d", i);
    }
    CHECK(dark > 0 && lit > 0, "%d dark, %d lit", dark, lit);
    divided_free(&made);
    divided_free(&other);
}

/* Threads sample while tiles are cleared, their memory is overwritten when all have left, and they come back. */
typedef struct sharing {
    divided made;
    atomic_bool ends;
    atomic_int wrong, taken;
} sharing;

static void *reader_run(void *context)
{
    sharing *const with = context;
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(with->made.tiles);
    uint64_t state = 5;
    while (!atomic_load(&with->ends)) {
        const uint32_t entered = lmb_volume_tiles_enter(with->made.tiles);
        for (int i = 0; i < 200; ++i) {
            const lmb_vec3d at = position_make(&info, &state);
            lmb_sh3_rgb light, expected;
            const bool inside = lmb_volume_tiles_sample(with->made.tiles, at, &light);
            lmb_volume_sample_at(with->made.whole, at, &expected);
            if (inside && memcmp(&light, &expected, sizeof light) != 0) {
                atomic_fetch_add(&with->wrong, 1);
            }
            atomic_fetch_add(&with->taken, inside);
        }
        lmb_volume_tiles_leave(with->made.tiles, entered);
    }
    return NULL;
}

static void readers_and_tiles(void)
{
    static sharing with;
    pthread_t thread[THREADS];
    divided_make(&levels_recipes[3], LMB_VOLUME_HALFS, 1, &with.made);
    all_set(&with.made);
    for (int i = 0; i < THREADS; ++i) {
        CHECK(pthread_create(&thread[i], NULL, reader_run, &with) == 0, "thread %d", i);
    }
    unsigned char *const kept = malloc(with.made.whole_size);
    for (uint32_t round = 0; round < 60; ++round) {
        const uint32_t tile = round * 7 % with.made.count;
        lmb_volume *const old = lmb_volume_tiles_clear(with.made.tiles, tile);
        const uint32_t mark = lmb_volume_tiles_mark(with.made.tiles);
        while (!lmb_volume_tiles_is_quiet(with.made.tiles, mark)) {
            nanosleep(&(struct timespec){.tv_nsec = 10000}, NULL);
        }
        lmb_volume_close(old);
        memcpy(kept, with.made.data[tile], with.made.size[tile]);
        memset(with.made.data[tile], 0xff, with.made.size[tile]);
        memcpy(with.made.data[tile], kept, with.made.size[tile]);
        lmb_volume *former;
        CHECK(lmb_volume_open_memory(with.made.data[tile], with.made.size[tile], &with.made.volume[tile]) == LMB_OK &&
                  lmb_volume_tiles_set(with.made.tiles, tile, with.made.volume[tile], &former) == LMB_OK && !former,
              "round %u", round);
    }
    atomic_store(&with.ends, true);
    for (int i = 0; i < THREADS; ++i) {
        pthread_join(thread[i], NULL);
    }
    CHECK(with.wrong == 0 && with.taken > 1000, "%d wrong of %d", with.wrong, with.taken);
    free(kept);
    divided_free(&with.made);
}

/* Somebody is in: what is cleared after that is not quiet before he has left; who enters later does not matter. */
static void quiet_when_left(void)
{
    divided made;
    divided_make(&levels_recipes[1], LMB_VOLUME_HALFS, 1, &made);
    const uint32_t first = lmb_volume_tiles_enter(made.tiles);
    const uint32_t mark = lmb_volume_tiles_mark(made.tiles);
    CHECK(!lmb_volume_tiles_is_quiet(made.tiles, mark), "one is in");
    const uint32_t second = lmb_volume_tiles_enter(made.tiles);
    lmb_volume_tiles_leave(made.tiles, first);
    CHECK(lmb_volume_tiles_is_quiet(made.tiles, mark) || second == first, "he has left");
    lmb_volume_tiles_leave(made.tiles, second);
    CHECK(lmb_volume_tiles_is_quiet(made.tiles, mark), "all have left");
    divided_free(&made);
}

static lmb_result index_open(const unsigned char *data, size_t size)
{
    lmb_volume_tiles *tiles = NULL;
    const lmb_result result = lmb_volume_tiles_open_memory(data, size, &tiles);
    if (result == LMB_OK) {
        lmb_volume_tiles_find(tiles, (lmb_vec3d){1.0, 2.0, 3.0});
        lmb_volume_tiles_close(tiles);
    }
    return result;
}

/* Every truncation, every flipped bit, and every word replaced with the checksum put right. */
static void hostile_index(void)
{
    static const uint32_t words[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000};
    divided made;
    divided_make(&levels_recipes[1], LMB_VOLUME_HALFS, 1, &made);
    unsigned char *const data = aligned_alloc(64, made.index_size);
    memcpy(data, made.index, made.index_size);
    for (size_t size = 0; size < made.index_size; ++size) {
        CHECK(index_open(data, size) != LMB_OK, "%zu bytes", size);
    }
    for (size_t bit = 0; bit < 8 * made.index_size; ++bit) {
        data[bit / 8] ^= (unsigned char)(1u << bit % 8);
        CHECK(index_open(data, made.index_size) != LMB_OK, "bit %zu", bit);
        data[bit / 8] ^= (unsigned char)(1u << bit % 8);
    }
    int refused = 0;
    for (size_t at = LMB_VOLUME_CHECKSUM_START; at < made.index_size; at += 4) {
        for (size_t k = 0; k < sizeof words / sizeof words[0]; ++k) {
            memcpy(data + at, &words[k], 4);
            const uint64_t sum =
                lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, made.index_size - LMB_VOLUME_CHECKSUM_START);
            memcpy(data + offsetof(lmb_tiles_header, checksum), &sum, sizeof sum);
            refused += index_open(data, made.index_size) != LMB_OK;
            memcpy(data, made.index, made.index_size);
        }
    }
    CHECK(refused > 100, "%d refused", refused);
    free(data);
    divided_free(&made);
}

/* Of version 4, tiles are of that version too; version 3, of other cut cells, is not split. */
static void earlier_versions(void)
{
    static const char *const path[2] = {LMB_GOLDEN_DIR "/levels_3.lmb", LMB_GOLDEN_DIR "/levels_4.lmb"};
    for (uint32_t version = 3; version <= 4; ++version) {
        divided made = {.count = 0};
        const lmb_split_sink sink = {tile_keep, &made};
        CHECK(lmb_volume_open_file(path[version - 3], &made.whole) == LMB_OK, "%s", path[version - 3]);
        if (!made.whole) {
            continue;
        }
        const lmb_result result =
            lmb_split(made.whole, (const int32_t[3]){8, 8, 8}, &sink, &made.index, &made.index_size);
        CHECK(result == (version == 3 ? LMB_ERROR_VERSION : LMB_OK), "version %u: %d", version, result);
        CHECK((made.count > 0) == (version == 4), "version %u: %u tiles", version, made.count);
        for (uint32_t i = 0; i < made.count; ++i) {
            CHECK(lmb_volume_open_memory(made.data[i], made.size[i], &made.volume[i]) == LMB_OK &&
                      lmb_volume_get_info(made.volume[i]).version == version,
                  "tile %u", i);
        }
        divided_free(&made);
    }
}

/* Files as the command names them, for sampler/example/tiles.c: 27 tiles of 2 m, without holes. */
static void files_for_the_example(void)
{
    const char *const stem = LMB_TEST_OUTPUT_DIR "/tiles/probes";
    lmb_error error = {{0}};
    divided made;
    char path[512];
    divided_make(&levels_recipes[0], LMB_VOLUME_HALFS, 1, &made);
    mkdir(LMB_TEST_OUTPUT_DIR "/tiles", 0777);
    for (uint32_t i = 0; i < made.count; ++i) {
        snprintf(path, sizeof path, "%s_%d_%d_%d.lmb", stem, made.at[i][0], made.at[i][1], made.at[i][2]);
        CHECK(lmb_file_write(path, made.data[i], made.size[i], &error) == LMB_OK, "%s", error.message);
    }
    snprintf(path, sizeof path, "%s.lmt", stem);
    CHECK(lmb_file_write(path, made.index, made.index_size, &error) == LMB_OK, "%s", error.message);
    divided_free(&made);
}

static const test_case cases[] = {
    {"the bits of the undivided volume", same_bits},
    {"local sets in one tile each", local_sets},
    {"closed tiles, and those of another volume", closed_and_refused},
    {"readers while tiles come and go", readers_and_tiles},
    {"quiet when all have left", quiet_when_left},
    {"a hostile index", hostile_index},
    {"earlier versions", earlier_versions},
    {"files for the example", files_for_the_example},
};

int main(void)
{
    return test_main(cases, sizeof cases / sizeof cases[0]);
}
