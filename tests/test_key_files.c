/* Key lights in files: what is stored comes back, and what is forged is refused. */
#include <stdlib.h>

#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/lightmap.h>
#include <lambent/pack.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>
#include <lambent/volume_format.h>

#include "folder_fixture.h"
#include "lightmap_fixture.h"
#include "probes_fixture.h"

#define FOLDER LMB_TEST_OUTPUT_DIR "/key_files"

static const lmb_lattice lattice = {.spacing = 0.5f, .min = {-2, 3, 1}, .size = {9, 6, 4}};

/* Random probes, dilated, that see `keys` lights by chance. */
static lmb_probes *keyed_probes_of(const lmb_lattice *box, uint32_t keys)
{
    lmb_probes *const probes = fixture_random_probes(box, 0.8, 0.8, 3.0, 11);
    uint64_t state = 5;
    probes->key_light_count = keys;
    for (uint32_t key = 0; key < keys; ++key) {
        const float sine = 0.2f * (float)(key + 1);
        probes->key_light[key] = (lmb_key_light){{sine, sqrtf(1.0f - sine * sine), 0.0f}, {{(float)key, 2.5f, 1e6f}}};
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            const double draw = fixture_random(&state);
            probes->key_visibility[probe][key] = draw < 0.2 ? 0.0f : draw > 0.8 ? 1.0f : (float)draw;
        }
    }
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    lmb_error error = {{0}};
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    return probes;
}

static lmb_probes *keyed_probes(uint32_t keys)
{
    return keyed_probes_of(&lattice, keys);
}

static bool same_light(const lmb_key_light *a, const lmb_key_light *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* At a probe its own, in 255ths; halfway between two probes their mean. */
static void volume_round_trip(void)
{
    for (uint32_t keys = 0; keys <= LMB_KEY_LIGHTS_MOST; ++keys) {
        lmb_probes *const probes = keyed_probes(keys);
        unsigned char *data = NULL;
        size_t size = 0;
        lmb_volume *volume = NULL;
        CHECK(lmb_pack(probes, &data, &size, NULL) == LMB_OK && lmb_volume_open_memory(data, size, &volume) == LMB_OK,
              "%u lights", keys);
        if (!volume) {
            return;
        }
        const lmb_volume_info info = lmb_volume_get_info(volume);
        CHECK(info.version == LMB_VOLUME_VERSION && info.key_light_count == keys, "version %u", info.version);
        lmb_key_light light[LMB_KEY_LIGHTS_MOST];
        CHECK(lmb_volume_key_lights(volume, light) == keys, "%u lights", keys);
        for (uint32_t key = 0; key < keys; ++key) {
            CHECK(same_light(&light[key], &probes->key_light[key]), "light %u of %u", key, keys);
        }
        for (int32_t probe = 0; probe < probes->count; ++probe) {
            const int32_t *const point = probes->point[probe];
            const int32_t next = lmb_probes_find(probes, 0, point[0] + 1, point[1], point[2]);
            const lmb_vec3d at = lmb_lattice_position(&lattice, point);
            const lmb_vec3d between = {at.x + 0.25, at.y, at.z};
            lmb_sh3_rgb radiance, plain;
            float seen[LMB_KEY_LIGHTS_MOST], seen_between[LMB_KEY_LIGHTS_MOST];
            const bool inside = lmb_volume_sample_with_keys(volume, at, &radiance, seen);
            CHECK(lmb_volume_sample_at(volume, at, &plain) == inside && memcmp(&plain, &radiance, sizeof plain) == 0,
                  "the same radiance, with keys and without");
            lmb_volume_sample_with_keys(volume, between, &radiance, seen_between);
            for (uint32_t key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
                const double own = (double)probes->key_visibility[probe][key];
                CHECK_NEAR(seen[key], own, 0.5 / 255.0 + 1e-6, "probe %d, light %u of %u", probe, key, keys);
                CHECK(key < keys || seen[key] == 0.0f, "light %u of %u", key, keys);
                if (next >= 0) {
                    const double mean = 0.5 * (own + (double)probes->key_visibility[next][key]);
                    CHECK_NEAR(seen_between[key], mean, 0.5 / 255.0 + 1e-6, "past probe %d, light %u", probe, key);
                }
            }
        }
        float seen[LMB_KEY_LIGHTS_MOST];
        lmb_sh3_rgb radiance;
        CHECK(!lmb_volume_sample_with_keys(volume, (lmb_vec3d){NAN, 0.0, 0.0}, &radiance, seen), "nowhere");
        for (uint32_t key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
            CHECK(seen[key] == 0.0f, "light %u is seen from nowhere", key);
        }
        lmb_volume_close(volume);
        free(data);
        lmb_probes_destroy(probes);
    }
}

static void repair_checksum(unsigned char *data, size_t size)
{
    const uint64_t checksum = lmb_volume_hash(data + LMB_VOLUME_CHECKSUM_START, size - LMB_VOLUME_CHECKSUM_START);
    memcpy(data + offsetof(lmb_volume_header, checksum), &checksum, sizeof checksum);
}

/* A word of a file with two key lights set to a value, the checksum right. */
static void forged_volumes_are_refused(void)
{
    enum { KEYS = offsetof(lmb_volume_header, key_light_count), LIGHT = offsetof(lmb_volume_header, key_light) };
    const struct {
        const char *name;
        size_t offset;
        uint32_t value;
        lmb_result expected;
    } forgeries[] = {
        {"as it was", KEYS, 2, LMB_OK},
        {"no key lights", KEYS, 0, LMB_ERROR_FORMAT},
        {"fewer key lights", KEYS, 1, LMB_ERROR_FORMAT},
        {"more key lights", KEYS, 3, LMB_ERROR_FORMAT},
        {"five key lights", KEYS, 5, LMB_ERROR_FORMAT},
        {"key lights without number", KEYS, UINT32_MAX, LMB_ERROR_FORMAT},
        {"no direction", LIGHT + 4, 0, LMB_ERROR_FORMAT},
        {"direction NaN", LIGHT, 0x7fc00000, LMB_ERROR_FORMAT},
        {"direction infinite", LIGHT, 0x7f800000, LMB_ERROR_FORMAT},
        {"irradiance negative", LIGHT + 16, 0xbf800000, LMB_ERROR_FORMAT},
        {"irradiance NaN", LIGHT + 24 + 20, 0x7fc00000, LMB_ERROR_FORMAT},
        {"irradiance infinite", LIGHT + 12, 0x7f800000, LMB_ERROR_FORMAT},
        {"irradiance FLT_MAX", LIGHT + 12, 0x7f7fffff, LMB_OK},
        {"a light beyond the count", LIGHT + 2 * 24 + 4, 0x3f800000, LMB_ERROR_FORMAT},
    };
    lmb_probes *const probes = keyed_probes(2);
    unsigned char *data = NULL;
    size_t size = 0;
    CHECK(lmb_pack(probes, &data, &size, NULL) == LMB_OK, "pack");
    lmb_probes_destroy(probes);
    unsigned char *const copy = aligned_alloc(LMB_VOLUME_ALIGNMENT, size);
    for (size_t i = 0; i < sizeof forgeries / sizeof forgeries[0]; ++i) {
        memcpy(copy, data, size);
        memcpy(copy + forgeries[i].offset, &forgeries[i].value, sizeof forgeries[i].value);
        repair_checksum(copy, size);
        lmb_volume *volume = NULL;
        const lmb_result result = lmb_volume_open_memory(copy, size, &volume);
        CHECK(result == forgeries[i].expected, "%s: %d", forgeries[i].name, result);
        lmb_volume_close(volume);
    }
    for (size_t cut = 0; cut < size; cut += cut < (size_t)LMB_VOLUME_HEADER_BYTES + 64 ? 1 : 997) {
        lmb_volume *volume = NULL;
        memcpy(copy, data, cut);
        CHECK(lmb_volume_open_memory(copy, cut, &volume) != LMB_OK && !volume, "cut at %zu", cut);
    }
    free(copy);
    free(data);
}

/* A .vdb gives back what it was given, and packs to the same volume. */
static void vdb_round_trip(void)
{
    static const lmb_vdb_metadata metadata = {"{}", "0"};
    const char *path = FOLDER "/keys.vdb";
    folder_start(FOLDER);
    for (uint32_t keys = 0; keys <= LMB_KEY_LIGHTS_MOST; keys += 2) {
        lmb_probes *const probes = keyed_probes(keys);
        lmb_probes *read = NULL;
        lmb_error error = {{0}};
        CHECK(lmb_vdb_write(path, probes, &metadata, &error) == LMB_OK &&
                  lmb_vdb_read(path, &read, NULL, NULL, &error) == LMB_OK,
              "%s", error.message);
        unsigned char *a = NULL, *b = NULL;
        size_t a_size = 0, b_size = 0;
        if (read) {
            CHECK(read->key_light_count == keys && read->count == probes->count, "%u lights", read->key_light_count);
            for (uint32_t key = 0; key < keys; ++key) {
                CHECK(same_light(&read->key_light[key], &probes->key_light[key]), "light %u", key);
            }
            CHECK(memcmp(read->key_visibility, probes->key_visibility,
                         (size_t)probes->count * sizeof *probes->key_visibility) == 0,
                  "visibility of %u lights", keys);
            CHECK(lmb_pack(probes, &a, &a_size, NULL) == LMB_OK && lmb_pack(read, &b, &b_size, NULL) == LMB_OK &&
                      a_size == b_size && memcmp(a, b, a_size) == 0,
                  "another volume");
        }
        free(a);
        free(b);
        lmb_probes_destroy(read);
        lmb_probes_destroy(probes);
    }
}

/* The same probes always pack to the bytes of tests/golden/small_keys.lmb; what is packed now lies in the tests' output
 * folder if not. */
static void golden_file(void)
{
    static const lmb_lattice box = {.spacing = 0.5f, .min = {-1, 2, 0}, .size = {3, 3, 3}};
    lmb_probes *const probes = keyed_probes_of(&box, 2);
    unsigned char *data = NULL, *golden = NULL;
    size_t size = 0, golden_size = 0;
    CHECK(lmb_pack(probes, &data, &size, NULL) == LMB_OK, "pack");
    CHECK(lmb_file_read(LMB_GOLDEN_DIR "/small_keys.lmb", &golden, &golden_size, NULL) == LMB_OK, "small_keys.lmb");
    const bool same = size == golden_size && memcmp(data, golden, size) == 0;
    CHECK(same, "packed %zu bytes, small_keys.lmb has %zu", size, golden_size);
    if (!same) {
        lmb_file_write(LMB_TEST_OUTPUT_DIR "/small_keys.lmb", data, size, NULL);
    }
    free(data);
    free(golden);
    lmb_probes_destroy(probes);
}

static void broken_key_lights_are_no_probes(void)
{
    static const lmb_key_light broken[] = {{{0, 0, 0}, {{1, 1, 1}}},
                                           {{0, 2, 0}, {{1, 1, 1}}},
                                           {{0, NAN, 0}, {{1, 1, 1}}},
                                           {{0, 1, 0}, {{1, -1, 1}}},
                                           {{0, 1, 0}, {{1, INFINITY, 1}}}};
    lmb_error error = {{0}};
    lmb_probes *const probes = keyed_probes(1);
    const lmb_key_light whole = probes->key_light[0];
    for (size_t i = 0; i < sizeof broken / sizeof broken[0]; ++i) {
        probes->key_light[0] = broken[i];
        unsigned char *data = NULL;
        size_t size = 0;
        CHECK(lmb_probes_validate(probes, &error) == LMB_ERROR_FORMAT, "light %zu", i);
        CHECK(lmb_pack(probes, &data, &size, NULL) == LMB_ERROR_ARGUMENT && !data, "packs light %zu", i);
    }
    probes->key_light[0] = whole;
    static const float visibilities[] = {-0.1f, 1.1f, NAN};
    for (size_t i = 0; i < sizeof visibilities / sizeof visibilities[0]; ++i) {
        probes->key_visibility[3][0] = visibilities[i];
        CHECK(lmb_probes_validate(probes, &error) == LMB_ERROR_FORMAT, "visibility %g", (double)visibilities[i]);
    }
    probes->key_visibility[3][0] = 0.5f;
    probes->key_visibility[3][1] = 0.5f;
    CHECK(lmb_probes_validate(probes, &error) == LMB_ERROR_FORMAT, "of a light that there is not");
    probes->key_visibility[3][1] = 0.0f;
    CHECK(lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    probes->key_light_count = 5;
    CHECK(lmb_probes_validate(probes, &error) == LMB_ERROR_FORMAT, "five lights");
    lmb_probes_destroy(probes);
}

/* Probes that were not baked see what those around them see. */
static void visibility_is_dilated(void)
{
    static const lmb_lattice line = {.spacing = 1.0f, .size = {4, 1, 1}};
    lmb_probes *const probes = fixture_probes(&line, NULL);
    probes->key_light_count = 1;
    probes->key_light[0] = (lmb_key_light){{0, 1, 0}, {{1, 1, 1}}};
    static const float validity[] = {1.0f, 0.0f, 0.0f, 1.0f}, seen[] = {0.25f, 0.9f, 0.9f, 1.0f};
    static const float expected[] = {0.25f, 0.25f, 1.0f, 1.0f};
    for (int i = 0; i < 4; ++i) {
        probes->validity[i] = validity[i];
        probes->key_visibility[i][0] = seen[i];
    }
    CHECK(lmb_probes_dilate(probes) == LMB_OK, "dilate");
    for (int i = 0; i < 4; ++i) {
        CHECK_NEAR(probes->key_visibility[i][0], expected[i], 1e-6, "probe %d", i);
    }
    lmb_probes_destroy(probes);
}

/* Lightmaps with a key light are written and read, and those who know none of it do not take them. */
static void lightmap_round_trip(void)
{
    lmb_error error = {{0}};
    const char *path = FOLDER "/tiles.glb";
    folder_start(FOLDER);
    baked bake = {.lightmap = NULL};
    const lmb_result written = write_tiles(path, 3.0f, &error);
    CHECK(written == LMB_OK, "%s", error.message);
    if (written != LMB_OK || !level_fixture_load_with_keys(&bake.level, path, NULL, 1, 1)) {
        return;
    }
    lmb_lightmap *read = NULL;
    uint64_t bytes = 0;
    const lmb_gltf_options options = {.light_scale = 1.0, .emission_scale = 1.0};
    if (lightmap_make(&bake, 4.0f, 256) && lightmap_bake(&bake, 64)) {
        CHECK(bake.lightmap->key_light_count == 1, "one key light");
        CHECK(lmb_lightmap_write(bake.lightmap, FOLDER, &options, &bytes, &error) == LMB_OK, "%s", error.message);
        CHECK(lmb_lightmap_create(bake.level.scene, &bake.lightmap->settings, &read, &error) == LMB_OK &&
                  lmb_lightmap_read(read, FOLDER, &error) == LMB_OK,
              "%s", error.message);
    }
    for (int32_t i = 0; read && i < read->image_count; ++i) {
        const lmb_lightmap_image *a = &bake.lightmap->image[i], *b = &read->image[i];
        const int key = bake.lightmap->model->channel_count;
        size_t lit = 0, dark = 0;
        for (size_t k = 0; k < (size_t)a->width * (size_t)a->height; ++k) {
            const float seen = lmb_lightmap_plane(a, key)[k];
            CHECK_NEAR(lmb_lightmap_plane(b, key)[k], seen, 0x1p-11, "texel %zu of image %d", k, i);
            lit += a->state[k] != LMB_TEXEL_EMPTY && seen == 1.0f;
            dark += a->state[k] != LMB_TEXEL_EMPTY && seen == 0.0f;
        }
        CHECK(lit > 0 && dark > 0, "%zu lit, %zu in the roof's shadow", lit, dark);
    }
    if (read) {
        bake.level.scene->key_light_count = 0;
        lmb_lightmap *plain = NULL;
        CHECK(lmb_lightmap_create(bake.level.scene, &read->settings, &plain, &error) == LMB_OK &&
                  lmb_lightmap_read(plain, FOLDER, &error) == LMB_ERROR_FORMAT,
              "read without its key light");
        lmb_lightmap_destroy(plain);
    }
    lmb_lightmap_destroy(read);
    baked_close(&bake);
}

static const test_case cases[] = {
    {"a volume gives back what it was given", volume_round_trip},
    {"forged volumes are refused", forged_volumes_are_refused},
    {"a .vdb gives back what it was given", vdb_round_trip},
    {"the golden file", golden_file},
    {"broken key lights are no probes", broken_key_lights_are_no_probes},
    {"visibility is dilated", visibility_is_dilated},
    {"a lightmap gives back what it was given", lightmap_round_trip},
};

TEST_MAIN(cases)
