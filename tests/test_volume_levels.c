/* Volumes of several levels with cut cells: what comes out of the file is what the probes give in memory
 * (lmb_probes_light), up to the rounding of halfs. */
#include "harness.h"
#include "levels_fixture.h"

#include <lambent/file.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>
#include <lambent/volume_format.h>

#include <stddef.h>

typedef struct packed {
    unsigned char *data;
    size_t size;
    lmb_volume *volume;
} packed;

static packed pack_and_open(const lmb_probes *probes)
{
    packed p = {NULL, 0, NULL};
    const lmb_result result = lmb_pack(probes, &p.data, &p.size, NULL);
    CHECK(result == LMB_OK && lmb_volume_open_memory(p.data, p.size, &p.volume) == LMB_OK, "pack: %d", result);
    if (!p.volume) {
        abort();
    }
    return p;
}

static void close_packed(packed *p)
{
    lmb_volume_close(p->volume);
    free(p->data);
}

static lmb_vec3d random_place(const lmb_volume_info *info, uint64_t *state)
{
    const lmb_vec3d low = info->bounds_min, high = info->bounds_max;
    const double x = fixture_random(state), y = fixture_random(state), z = fixture_random(state);
    return (lmb_vec3d){low.x + x * (high.x - low.x), low.y + y * (high.y - low.y), low.z + z * (high.z - low.z)};
}

/* The finest level that has a cell at a place, and that cell; -1: none has. A place so near to one of a cut cell's
 * planes that rounding chooses its side, or much of a wedge's share, is none. */
static int level_there(const lmb_probes *probes, lmb_vec3d at, lmb_probe_cell *cell)
{
    if (!lmb_probes_cell(probes, at, cell)) {
        return -1;
    }
    const double *const t = cell->fraction;
    const double near = cell->share > 0.0 ? 16.0 : 1.0;
    for (uint32_t i = 0; cell->cut >= 0 && i < probes->cut.cell[cell->cut].plane_count; ++i) {
        const lmb_cell_plane *const plane = &probes->cut.plane[probes->cut.cell[cell->cut].plane_first + i];
        const double along = plane->normal[0] * t[0] + plane->normal[1] * t[1] + plane->normal[2] * t[2];
        if (fabs(along - plane->offset) < near) {
            return -1;
        }
    }
    return (int)cell->level;
}

static void volumes_give_the_light_of_their_probes(void)
{
    enum { PLACES = 20000 };
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        lmb_probes *const probes = levels_make(&levels_recipes[k]);
        packed p = pack_and_open(probes);
        const lmb_volume_info info = lmb_volume_get_info(p.volume);
        CHECK(info.level_count == levels_recipes[k].levels && info.key_light_count == levels_recipes[k].keys, "%d", k);
        uint64_t state = 7;
        int plain[LEVELS_MOST] = {0}, cut[LEVELS_MOST] = {0}, wedges = 0;
        for (int i = 0; i < PLACES; ++i) {
            const lmb_vec3d at = random_place(&info, &state);
            lmb_probe_cell cell;
            const int level = level_there(probes, at, &cell);
            lmb_sh3_rgb light;
            const bool inside = lmb_volume_sample_at(p.volume, at, &light);
            if (level < 0) {
                continue;
            }
            const lmb_sh3_rgb expected = lmb_probes_light(probes, 0, at);
            CHECK(inside, "recipe %d: (%g, %g, %g)", k, at.x, at.y, at.z);
            for (int c = 0; c < 27; ++c) {
                CHECK_NEAR(light.channel[c / 9].c[c % 9], expected.channel[c / 9].c[c % 9], 0x1p-11 + 1e-5,
                           "recipe %d, level %d, %s: (%g, %g, %g), coefficient %d", k, level,
                           cell.cut >= 0 ? "cut" : "plain", at.x, at.y, at.z, c);
            }
            CHECK(lmb_volume_spacing_at(p.volume, at) == ldexpf(levels_recipes[k].spacing, level), "spacing of %d",
                  level);
            ++(cell.cut >= 0 ? cut : plain)[level];
            wedges += cell.share > 0.0;
        }
        CHECK((wedges > 100) == (levels_recipes[k].wedges > 0.0), "recipe %d: %d places in wedges", k, wedges);
        for (uint32_t level = 0; level < levels_recipes[k].levels; ++level) {
            CHECK(plain[level] > 0 && (cut[level] > 0) == (levels_recipes[k].cut > 0.0),
                  "recipe %d, level %u: %d places in plain cells, %d in cut ones", k, level, plain[level], cut[level]);
        }
        close_packed(&p);
        lmb_probes_destroy(probes);
    }
}

/* Trilinear visibility of the probes around a place, each in 255ths. */
static void visibility_is_that_of_the_probes(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        lmb_probes *const probes = levels_make(&levels_recipes[k]);
        packed p = pack_and_open(probes);
        const lmb_volume_info info = lmb_volume_get_info(p.volume);
        uint64_t state = 8;
        for (int i = 0; i < 3000; ++i) {
            const lmb_vec3d at = random_place(&info, &state);
            lmb_probe_cell cell;
            lmb_sh3_rgb light, alone;
            float seen[LMB_KEY_LIGHTS_MOST];
            const bool inside = lmb_volume_sample_with_keys(p.volume, at, &light, seen);
            CHECK(lmb_volume_sample_at(p.volume, at, &alone) == inside && memcmp(&alone, &light, sizeof light) == 0,
                  "the same light, with keys and without");
            if (level_there(probes, at, &cell) < 0) {
                continue;
            }
            const double *const t = cell.fraction;
            for (uint32_t key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
                double expected = 0.0;
                for (int c = 0; c < 8; ++c) {
                    expected += (c & 1 ? t[0] : 1.0 - t[0]) * (c & 2 ? t[1] : 1.0 - t[1]) *
                                (c & 4 ? t[2] : 1.0 - t[2]) *
                                ((1.0 - cell.share) * (double)probes->key_visibility[cell.probe[c]][key] +
                                 cell.share * (double)probes->key_visibility[cell.other[c]][key]);
                }
                CHECK_NEAR(seen[key], expected, 0.5 / 255.0 + 1e-5, "recipe %d, light %u", k, key);
            }
        }
        close_packed(&p);
        lmb_probes_destroy(probes);
    }
}

/* A fine cell that is missing among others, in a block where a coarser one is: it has that one's light. */
static void holes_have_the_light_of_coarser_cells(void)
{
    const lmb_lattice fine = {.spacing = 1.0f, .size = {9, 5, 5}}, coarse = {.spacing = 2.0f, .size = {5, 3, 3}};
    int32_t point[45][3];
    for (int32_t i = 0; i < 45; ++i) {
        memcpy(point[i], (const int32_t[3]){i % 5, i / 5 % 3, i / 15}, sizeof point[i]);
    }
    lmb_probes *probes = NULL;
    CHECK(lmb_probes_create(&probes) == LMB_OK &&
              lmb_probes_add_level(probes, &fine, (const int32_t(*)[3])point, 45) == LMB_OK &&
              lmb_probes_add_level(probes, &coarse, (const int32_t(*)[3])point, 45) == LMB_OK,
          "two levels");
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        const int32_t along = probe < 45 ? 1 : 2;
        probes->validity[probe] = 1.0f;
        for (int axis = 0; axis < 3; ++axis) { /* linear: every interpolation agrees */
            probes->radiance[0][probe].channel[axis].c[0] = (float)(probes->point[probe][axis] * along);
        }
    }
    packed p = pack_and_open(probes);
    uint64_t state = 9;
    for (int i = 0; i < 2000; ++i) {
        const lmb_vec3d at = {8.0 * fixture_random(&state), 4.0 * fixture_random(&state), 4.0 * fixture_random(&state)};
        lmb_sh3_rgb light;
        CHECK(lmb_volume_sample_at(p.volume, at, &light), "(%g, %g, %g)", at.x, at.y, at.z);
        CHECK_NEAR(light.channel[0].c[0], at.x, 0.01, "x at (%g, %g, %g)", at.x, at.y, at.z);
        CHECK_NEAR(light.channel[1].c[0], at.y, 0.01, "y at (%g, %g, %g)", at.x, at.y, at.z);
        CHECK_NEAR(light.channel[2].c[0], at.z, 0.01, "z at (%g, %g, %g)", at.x, at.y, at.z);
    }
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* Light that is nowhere negative: a mean, and above it shares of what it may have, most of them small. */
static void make_plausible(lmb_probes *probes, uint64_t seed)
{
    uint64_t state = seed;
    for (int32_t probe = 0; probe < probes->count; ++probe) {
        for (int i = 0; i < 27; ++i) {
            const int k = i % 9;
            float *const c = probes->radiance[0][probe].channel[i / 9].c;
            const double draw = 2.0 * fixture_random(&state) - 1.0;
            const double most = k < 4 ? sqrt(3.0) : sqrt(5.0);
            c[k] = (float)(k == 0 ? 1.0 + 4.0 * fixture_random(&state) : (double)c[0] * most * draw * draw * draw);
        }
    }
}

/* Bytes are within half a step of what they stand for, and a sample's harmonics within half a percent of it. */
static void compact_volumes_are_near(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        lmb_probes *const probes = levels_make(&levels_recipes[k]);
        make_plausible(probes, 31);
        unsigned char *data = NULL;
        size_t size = 0;
        lmb_volume *volume = NULL;
        lmb_pack_stats stats;
        CHECK(lmb_pack_as(LMB_VOLUME_COMPACT, probes, &data, &size, &stats) == LMB_OK &&
                  lmb_volume_open_memory(data, size, &volume) == LMB_OK,
              "recipe %d", k);
        if (!volume) {
            abort();
        }
        packed halfs = pack_and_open(probes);
        const lmb_volume_info info = lmb_volume_get_info(volume);
        CHECK(info.is_compact && !lmb_volume_get_info(halfs.volume).is_compact && stats.flattened_count == 0,
              "%llu flattened", (unsigned long long)stats.flattened_count);
        uint64_t state = 12;
        double error = 0.0, square = 0.0;
        for (int i = 0; i < 4000; ++i) {
            const lmb_vec3d at = random_place(&info, &state);
            lmb_sh3_rgb light, expected;
            float seen[LMB_KEY_LIGHTS_MOST], expected_seen[LMB_KEY_LIGHTS_MOST];
            const bool inside = lmb_volume_sample_with_keys(volume, at, &light, seen);
            CHECK(lmb_volume_sample_with_keys(halfs.volume, at, &expected, expected_seen) == inside, "inside");
            CHECK(memcmp(seen, expected_seen, sizeof seen) == 0, "what is seen of key lights");
            for (int c = 0; c < 27; ++c) {
                const double difference =
                    (double)light.channel[c / 9].c[c % 9] - (double)expected.channel[c / 9].c[c % 9];
                const double half_step = c % 9 == 0 ? 1e-6 : 5.0 * sqrt(5.0) * (0.5 * 253.0 / 16129.0 + 0x1p-11);
                CHECK(fabs(difference) <= half_step, "recipe %d, coefficient %d: off by %g", k, c, difference);
                error += difference * difference;
                square += (double)expected.channel[c / 9].c[c % 9] * (double)expected.channel[c / 9].c[c % 9];
            }
        }
        CHECK(error <= 0.005 * 0.005 * square, "recipe %d: rel. RMSE %g", k, sqrt(error / square));
        lmb_volume_close(volume);
        free(data);
        close_packed(&halfs);
        lmb_probes_destroy(probes);
    }
}

/* More than such light may have: all eight harmonics are made smaller by as much, so that light keeps its direction. */
static void compact_probes_keep_their_direction(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 0.0, 5);
    for (int32_t probe = 0; probe < 8; ++probe) {
        float *const c = probes->radiance[0][probe].channel[1].c;
        c[0] = 1.0f;
        c[1] = -3.0f;
        c[3] = 6.0f;
        c[8] = 1.5f;
    }
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_volume *volume = NULL;
    lmb_pack_stats stats;
    lmb_sh3_rgb light;
    CHECK(lmb_pack_as(LMB_VOLUME_COMPACT, probes, &data, &size, &stats) == LMB_OK &&
              lmb_volume_open_memory(data, size, &volume) == LMB_OK,
          "opened");
    CHECK(stats.flattened_count == 8, "%llu flattened", (unsigned long long)stats.flattened_count);
    CHECK(lmb_volume_sample(volume, (lmb_vec3){0.5f, 0.25f, 0.75f}, &light), "inside");
    const float *const c = light.channel[1].c;
    CHECK_NEAR(c[3], sqrt(3.0), 1e-3, "the largest is all that may be");
    CHECK_NEAR(c[1] / c[3], -0.5, 0.01, "direction");
    CHECK_NEAR(c[8] / c[3], 0.25, 0.01, "shape");
    CHECK(light.channel[0].c[0] == 0.0f && light.channel[0].c[4] == 0.0f, "black");
    lmb_volume_close(volume);
    free(data);
    lmb_probes_destroy(probes);
}

/* Rows are shared: a box full of probes stores few of them twice, and heads are small beside them. */
static void full_boxes_are_small(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .min = {-7, 5, 1}, .size = {65, 49, 33}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 5);
    packed p = pack_and_open(probes);
    const double bytes = (double)p.size / probes->count;
    CHECK(lmb_volume_get_info(p.volume).probe_count == (uint64_t)probes->count, "all are stored");
    CHECK(bytes < 60.0, "%.1f bytes a probe", bytes);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* ---------------------------------------------------------------------------------------- broken contents */

static void repair_checksum(unsigned char *data, size_t size)
{
    const uint64_t checksum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    memcpy(data + offsetof(lmb_volume_header, checksum), &checksum, sizeof checksum);
}

static bool samples_are_finite(const lmb_volume *volume)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    uint64_t state = 5;
    bool finite = true;
    for (int i = 0; i < 100; ++i) {
        lmb_sh3_rgb light;
        float seen[LMB_KEY_LIGHTS_MOST];
        lmb_volume_sample_with_keys(volume, random_place(&info, &state), &light, seen);
        for (int k = 0; k < 27; ++k) {
            finite = finite && isfinite(light.channel[k / 9].c[k % 9]);
        }
    }
    return finite;
}

/* Bits of directory, heads and cut cells, one after the other, with the checksum right: refused, or sampled without a
 * bad read and without NaN. */
static void forge_bits(const unsigned char *data, size_t bytes)
{
    lmb_volume_header header;
    lmb_volume_layout layout = {.end = 0};
    memcpy(&header, data, sizeof header);
    CHECK(lmb_volume_layout_find(&header, &layout) && layout.end == bytes, "layout");
    const uint64_t parts[3][2] = {
        {0, layout.probes}, {layout.cut_offsets, layout.end}, {layout.probes, layout.probes + 64}};
    unsigned char *const copy = aligned_alloc(LMB_VOLUME_ALIGNMENT, bytes);
    memcpy(copy, data, bytes);
    int accepted = 0, refused = 0;
    for (int part = 0; part < 3; ++part) {
        for (uint64_t i = parts[part][0]; i < parts[part][1]; i += part == 0 && i >= layout.bricks ? 3 : 1) {
            const unsigned char kept = copy[i];
            copy[i] ^= (unsigned char)(1u << (i * 5 % 8));
            repair_checksum(copy, bytes);
            lmb_volume *volume = NULL;
            if (lmb_volume_open_memory(copy, bytes, &volume) == LMB_OK) {
                CHECK(samples_are_finite(volume), "byte %llu", (unsigned long long)i);
                ++accepted;
            } else {
                ++refused;
            }
            lmb_volume_close(volume);
            copy[i] = kept;
        }
    }
    CHECK(accepted > 0 && refused > 0, "%d accepted, %d refused", accepted, refused);
    free(copy);
}

static void forged_bits_do_no_harm(void)
{
    static const levels_recipe recipe = {.spacing = 1.0f,
                                         .levels = 2,
                                         .low = -1,
                                         .cubes = 2,
                                         .split = 0.3,
                                         .cut = 0.2,
                                         .wedges = 0.5,
                                         .keys = 1,
                                         .seed = 3};
    lmb_probes *const probes = levels_make(&recipe);
    packed p = pack_and_open(probes);
    forge_bits(p.data, p.size);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

static void truncate_all(const unsigned char *data, size_t bytes)
{
    for (size_t size = 0; size < bytes; ++size) {
        unsigned char *const copy = malloc(size + 1); /* so that AddressSanitizer sees every read beyond */
        lmb_volume *volume = NULL;
        memcpy(copy, data, size);
        CHECK(lmb_volume_open_memory(copy, size, &volume) == LMB_ERROR_TRUNCATED && !volume, "%zu bytes", size);
        free(copy);
    }
}

static void truncations_are_refused(void)
{
    static const levels_recipe recipe = {.spacing = 1.0f,
                                         .levels = 2,
                                         .low = -1,
                                         .cubes = 1,
                                         .split = 0.5,
                                         .cut = 0.3,
                                         .wedges = 0.8,
                                         .keys = 1,
                                         .seed = 3};
    lmb_probes *const probes = levels_make(&recipe);
    packed p = pack_and_open(probes);
    truncate_all(p.data, p.size);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* ------------------------------------------------------------------------------------------------ versions */

/* tests/golden/levels_N.lmb are these probes, as versions 3, 4 and 5 have them: the last one with wedges. */
static lmb_probes *golden_probes(double wedges)
{
    const levels_recipe recipe = {.spacing = 0.5f,
                                  .levels = 2,
                                  .low = -1,
                                  .cubes = 2,
                                  .split = 0.2,
                                  .holes = 0.1,
                                  .cut = 0.2,
                                  .wedges = wedges,
                                  .keys = 1,
                                  .seed = 5};
    return levels_make(&recipe);
}

/* Only a new version of the format changes them: what is packed now then lies in the tests' output folder. */
static void volumes_pack_to_the_golden_file(void)
{
    lmb_probes *const probes = golden_probes(0.7);
    packed p = pack_and_open(probes);
    unsigned char *golden = NULL;
    size_t size = 0;
    CHECK(lmb_file_read(LMB_GOLDEN_DIR "/levels_5.lmb", &golden, &size, NULL) == LMB_OK, "levels_5.lmb");
    const bool is_same = size == p.size && memcmp(golden, p.data, size) == 0;
    CHECK(is_same, "packed %zu bytes, levels_5.lmb has %zu", p.size, size);
    if (!is_same) {
        lmb_file_write(LMB_TEST_OUTPUT_DIR "/levels_5.lmb", p.data, p.size, NULL);
    }
    free(golden);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* Of files without wedges nothing but the version has changed since version 4. */
static void version_4_has_the_same_bytes(void)
{
    lmb_probes *const probes = golden_probes(0.0);
    packed p = pack_and_open(probes);
    unsigned char *golden = NULL;
    size_t size = 0;
    CHECK(lmb_file_read(LMB_GOLDEN_DIR "/levels_4.lmb", &golden, &size, NULL) == LMB_OK, "levels_4.lmb");
    if (golden) {
        const size_t rest = LMB_VOLUME_CHECKSUM_START;
        uint32_t version;
        memcpy(&version, golden + offsetof(lmb_volume_header, version), sizeof version);
        CHECK(version == 4 && size == p.size && memcmp(golden + rest, p.data + rest, size - rest) == 0,
              "version %u, %zu bytes, of version 5 %zu", version, size, p.size);
    }
    free(golden);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* Exchange files of version 3 are read for ever: these are the same probes. One that is written now, where none can be
 * read, lies in the tests' output folder. */
static void exchange_files_pack_to_the_golden_file(void)
{
    lmb_probes *const probes = golden_probes(0.0);
    lmb_probes *read = NULL;
    lmb_error error = {{0}};
    const lmb_result result = lmb_vdb_read(LMB_GOLDEN_DIR "/levels_3.vdb", &read, NULL, NULL, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    if (result == LMB_OK) {
        packed then = pack_and_open(read), now = pack_and_open(probes);
        CHECK(then.size == now.size && memcmp(then.data, now.data, now.size) == 0, "%zu bytes, %zu of the probes",
              then.size, now.size);
        close_packed(&then);
        close_packed(&now);
    } else {
        static const lmb_vdb_metadata metadata = {"{}", "0"};
        lmb_vdb_write(LMB_TEST_OUTPUT_DIR "/levels_3.vdb", probes, &metadata, NULL);
    }
    lmb_probes_destroy(read);
    lmb_probes_destroy(probes);
}

/* The bits of samples are those of today's. */
static void gives_the_same_light(const char *path, uint32_t version)
{
    lmb_probes *const probes = golden_probes(0.0);
    packed p = pack_and_open(probes);
    lmb_volume *old = NULL;
    CHECK(lmb_volume_open_file(path, &old) == LMB_OK, "%s", path);
    if (old) {
        const lmb_volume_info info = lmb_volume_get_info(old);
        CHECK(info.version == version && info.cut_count > 0 && lmb_volume_get_info(p.volume).version == 5, "versions");
        uint64_t state = 7;
        int inside = 0;
        for (int i = 0; i < 4000; ++i) {
            const lmb_vec3d at = random_place(&info, &state);
            lmb_sh3_rgb a, b, c;
            float a_seen[LMB_KEY_LIGHTS_MOST], b_seen[LMB_KEY_LIGHTS_MOST];
            const bool a_inside = lmb_volume_sample_with_keys(old, at, &a, a_seen);
            const bool b_inside = lmb_volume_sample_with_keys(p.volume, at, &b, b_seen);
            lmb_volume_sample_batch(old, &at, 1, &c, NULL, NULL);
            CHECK(a_inside == b_inside && memcmp(&a, &b, sizeof a) == 0 && memcmp(&a, &c, sizeof a) == 0 &&
                      memcmp(a_seen, b_seen, sizeof a_seen) == 0,
                  "at (%.9g, %.9g, %.9g)", at.x, at.y, at.z);
            inside += a_inside;
        }
        CHECK(inside > 400, "%d inside", inside);
    }
    lmb_volume_close(old);
    close_packed(&p);
    lmb_probes_destroy(probes);
}

/* Files of versions 3 and 4 are read for ever. */
static void version_3_gives_the_same_light(void)
{
    gives_the_same_light(LMB_GOLDEN_DIR "/levels_3.lmb", 3);
}

static void version_4_gives_the_same_light(void)
{
    gives_the_same_light(LMB_GOLDEN_DIR "/levels_4.lmb", 4);
}

static void version_3_is_checked_as_well(void)
{
    unsigned char *data = NULL;
    size_t size = 0;
    CHECK(lmb_file_read(LMB_GOLDEN_DIR "/levels_3.lmb", &data, &size, NULL) == LMB_OK, "levels_3.lmb");
    if (data) {
        forge_bits(data, size);
        truncate_all(data, size);
    }
    free(data);
}

/* Ghosts that bricks far away in the file share are stored once more, as a cell's numbers do not reach that far. */
static void far_ghosts_are_stored_again(void)
{
    const lmb_lattice lattice = {.spacing = 1.0f, .size = {101, 101, 9}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 1.0, 5);
    const int32_t low[3] = {50, 50, 3}, high[3] = {50, 50, 4}, shared[3] = {50, 50, 4};
    int32_t ghost, corner[2][8];
    CHECK(lmb_probes_add_ghosts(probes, 0, &shared, 1, &ghost) == LMB_OK, "a ghost");
    probes->radiance[0][ghost].channel[0].c[0] = 8.0f;
    for (int32_t i = 0; i < 8; ++i) {
        corner[0][i] = lmb_probes_find(probes, 0, 50 + (i & 1), 50 + (i >> 1 & 1), 3 + (i >> 2));
        corner[1][i] = lmb_probes_find(probes, 0, 50 + (i & 1), 50 + (i >> 1 & 1), 4 + (i >> 2));
    }
    corner[0][4] = corner[1][0] = ghost;
    CHECK(lmb_probes_cut(probes, 0, low, NULL, 0, (const int32_t(*)[8]) & corner[0], 1) == LMB_OK &&
              lmb_probes_cut(probes, 0, high, NULL, 0, (const int32_t(*)[8]) & corner[1], 1) == LMB_OK,
          "cut");
    packed p = pack_and_open(probes);
    lmb_volume_header header;
    memcpy(&header, p.data, sizeof header);
    CHECK(header.probe_count == (uint64_t)probes->count, "each probe counts once");
    for (int i = 0; i < 2; ++i) {
        lmb_sh3_rgb light;
        CHECK(lmb_volume_sample(p.volume, (lmb_vec3){50.0f, 50.0f, i == 0 ? 3.99999f : 4.0f}, &light), "inside");
        CHECK_NEAR(light.channel[0].c[0], 8.0, 1e-3, "the ghost, from cell %d", i);
    }
    close_packed(&p);
    lmb_probes_destroy(probes);
}

static const test_case cases[] = {
    {"volumes give the light of their probes", volumes_give_the_light_of_their_probes},
    {"visibility is that of the probes", visibility_is_that_of_the_probes},
    {"holes have the light of coarser cells", holes_have_the_light_of_coarser_cells},
    {"compact volumes are near", compact_volumes_are_near},
    {"compact probes keep their direction", compact_probes_keep_their_direction},
    {"full boxes are small", full_boxes_are_small},
    {"forged bits do no harm", forged_bits_do_no_harm},
    {"truncations are refused", truncations_are_refused},
    {"volumes pack to the golden file", volumes_pack_to_the_golden_file},
    {"exchange files pack to the golden file", exchange_files_pack_to_the_golden_file},
    {"version 3 gives the same light", version_3_gives_the_same_light},
    {"version 4 has the same bytes", version_4_has_the_same_bytes},
    {"version 4 gives the same light", version_4_gives_the_same_light},
    {"version 3 is checked as well", version_3_is_checked_as_well},
    {"far ghosts are stored again", far_ghosts_are_stored_again},
};
TEST_MAIN(cases)
