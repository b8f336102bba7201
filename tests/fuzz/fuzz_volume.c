/* .lmb files: opened, and, where that is allowed, sampled all over. Bytes as they come hardly get past the checksum, so
 * that each input is also tried with its length and checksum put right. */
#include "fuzz.h"
#include "fuzz_light.h"
#include "fuzz_sealed.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/local_set.h>
#include <lambent/pack.h>
#include <lambent/volume.h>
#include <lambent/volume_format.h>
#include <lambent/volume_probe.h>
#include <lambent/volume_texture.h>

#include "cut_fixture.h"
#include "local_fixture.h"

enum { POSITIONS = 24, MOST_SETS = 8, BYTES_MOST = 1 << 24 /* of what is made of an input */ };

static bool halfs_are_finite(const uint16_t *half, size_t count)
{
    bool finite = true;
    for (size_t i = 0; i < count; ++i) {
        finite = finite && (half[i] & 0x7c00u) != 0x7c00u;
    }
    return finite;
}

static void textures_use(const lmb_volume *volume)
{
    const lmb_volume_texture_def def = lmb_volume_texture_default();
    lmb_volume_texture_layout layout;
    if (lmb_volume_texture_size(volume, &def, &layout) != LMB_OK || layout.texture_bytes > BYTES_MOST) {
        return;
    }
    uint16_t *const texels = malloc((size_t)layout.texture_bytes);
    uint32_t *const words = malloc(layout.word_count * sizeof *words);
    if (texels && words) {
        lmb_volume_texture_fill(volume, &layout, texels, words);
        FUZZ_CHECK(halfs_are_finite(texels, (size_t)layout.texture_bytes / sizeof *texels), "a texel is not finite");
    }
    free(texels);
    free(words);
}

static void probes_use(const lmb_volume *volume)
{
    const uint32_t count = lmb_volume_probe_count(volume);
    lmb_volume_probe *const probe = count < BYTES_MOST / sizeof *probe ? malloc(count * sizeof *probe) : NULL;
    if (probe) {
        lmb_volume_get_probes(volume, probe);
        for (uint32_t i = 0; i < count; ++i) {
            lmb_sh3_rgb light;
            float seen[LMB_KEY_LIGHTS_MOST];
            lmb_volume_get_probe(volume, i, &light, seen);
            FUZZ_CHECK(light_is_finite(&light) && seen_is_a_share(seen), "probe %u", i);
            FUZZ_CHECK(isfinite(probe[i].position.x), "probe %u is nowhere", i);
        }
    }
    free(probe);
}

/* The first local sets, and what a name finds. */
static void locals_use(const lmb_volume *volume)
{
    static lmb_sh3_rgb light[LMB_LOCAL_SET_MOST];
    static float seen[LMB_LOCAL_SET_MOST][LMB_KEY_LIGHTS_MOST];
    const uint32_t count = lmb_volume_local_set_count(volume);
    for (uint32_t i = 0; i < count && i < MOST_SETS; ++i) {
        const lmb_local_set set = lmb_volume_local_set_get(volume, i);
        FUZZ_CHECK(lmb_local_frame_is_valid(&set.frame), "set %u: its frame", i);
        FUZZ_CHECK(lmb_volume_local_set_find(volume, set.name) <= i, "set %u: '%s' is not found", i, set.name);
        lmb_volume_local_set_light(volume, i, light, seen);
        for (uint32_t k = 0; k < lmb_local_frame_count(&set.frame); ++k) {
            FUZZ_CHECK(light_is_finite(&light[k]) && seen_is_a_share(seen[k]), "set %u: probe %u", i, k);
        }
    }
    FUZZ_CHECK(lmb_volume_local_set_find(volume, "nobody's name") <= count, "beyond the sets");
}

static void volume_use(const lmb_volume *volume)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    lmb_vec3d position[POSITIONS];
    lmb_sh3_rgb many[POSITIONS];
    float seen[POSITIONS][LMB_KEY_LIGHTS_MOST];
    bool inside[POSITIONS];
    for (int i = 0; i < POSITIONS; ++i) {
        position[i] = fuzz_position(info.bounds_min, info.bounds_max, i);
    }
    lmb_volume_sample_batch(volume, position, POSITIONS, many, seen, inside);
    for (int i = 0; i < POSITIONS; ++i) {
        lmb_sh3_rgb one;
        float one_seen[LMB_KEY_LIGHTS_MOST];
        const bool is_inside = lmb_volume_sample_with_keys(volume, position[i], &one, one_seen);
        FUZZ_CHECK(light_is_finite(&one) && seen_is_a_share(one_seen), "position %d", i);
        FUZZ_CHECK(is_inside == inside[i] && memcmp(&one, &many[i], sizeof one) == 0 &&
                       memcmp(one_seen, seen[i], sizeof one_seen) == 0,
                   "position %d: a batch differs", i);
        lmb_volume_spacing_at(volume, position[i]);
    }
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    FUZZ_CHECK(lmb_volume_key_lights(volume, light) <= LMB_KEY_LIGHTS_MOST, "key lights");
    locals_use(volume);
}

static void bytes_open(const unsigned char *bytes, size_t size)
{
    lmb_volume_storage storage;
    lmb_volume *volume = NULL;
    const lmb_result result = lmb_volume_open_memory_in(&storage, bytes, size, &volume);
    FUZZ_CHECK((result == LMB_OK) == (volume != NULL), "%s", lmb_result_text(result));
    if (volume) {
        volume_use(volume);
        textures_use(volume);
        probes_use(volume);
        lmb_volume_close(volume);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_sealed(data, size, bytes_open);
    return 0;
}

static void seed_pack(lmb_probes *probes, lmb_volume_form form)
{
    unsigned char *data = NULL;
    size_t size = 0;
    FUZZ_CHECK(lmb_pack_as(form, probes, &data, &size, NULL) == LMB_OK, "not packed");
    fuzz_seed(data, size);
    free(data);
    lmb_probes_destroy(probes);
}

static lmb_probes *probes_with_sets(void)
{
    const lmb_lattice lattice = {.spacing = 0.5f, .min = {0, 0, 0}, .size = {2, 2, 2}};
    lmb_probes *const probes = fixture_random_probes(&lattice, 1.0, 1.0, 2.0, 7);
    uint64_t state = 3;
    probes->key_light_count = 1;
    probes->key_light[0] = (lmb_key_light){{0.0f, 1.0f, 0.0f}, {{2.0f, 1.0f, 0.5f}}};
    local_fixture_add(probes, &state);
    return probes;
}

/* Files of earlier versions, and what the writer makes: cut cells and local sets, in both forms of probes. */
void fuzz_seeds(void)
{
    fuzz_seed_file(LMB_GOLDEN_DIR "/small.lmb");
    fuzz_seed_file(LMB_GOLDEN_DIR "/small_keys.lmb");
    fuzz_seed_file(LMB_GOLDEN_DIR "/levels_3.lmb");
    fuzz_seed_file(LMB_GOLDEN_DIR "/levels_4.lmb");
    fuzz_seed_file(LMB_GOLDEN_DIR "/levels_5.lmb");
    static const lmb_volume_form forms[] = {LMB_VOLUME_HALFS, LMB_VOLUME_COMPACT};
    for (size_t i = 0; i < 2; ++i) {
        seed_pack(cut_fixture_probes(), forms[i]);
        seed_pack(probes_with_sets(), forms[i]);
    }
}
