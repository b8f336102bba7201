/* An index of tiles, .lmt: opened, told about, and sampled, first without tiles and then with those of good bakes that
 * it takes, which a hostile index may place and clamp in ways of its own. Each input is also tried with its length and
 * checksum put right. */
#include "fuzz.h"
#include "fuzz_light.h"
#include "fuzz_sealed.h"

#include <string.h>

#include "local_fixture.h"
#include "tiles_fixture.h"

enum { POSITIONS = 32, MOST_TILES = 32, BAKES = 2 };

static const levels_recipe recipes[BAKES] = {
    {.spacing = 0.5f, .levels = 1, .low = -1, .cubes = 4, .cut = 0.3, .keys = 1, .seed = 1},
    {.spacing = 0.3f, .levels = 2, .low = 1, .cubes = 4, .split = 0.3, .holes = 0.2, .cut = 0.1, .seed = 2},
};
static divided bakes[BAKES];

/* Made once: the index that was mutated is another's. */
static void bakes_make(void)
{
    for (int i = 0; i < BAKES && !bakes[i].tiles; ++i) {
        lmb_probes *const probes = levels_make(&recipes[i]);
        uint64_t state = 3;
        local_fixture_add(probes, &state);
        divided_of(probes, i == 0 ? LMB_VOLUME_HALFS : LMB_VOLUME_COMPACT, 1, &bakes[i]);
        lmb_probes_destroy(probes);
    }
}

/* One position by every call; batches come later. */
static void position_use(const lmb_volume_tiles *tiles, lmb_vec3d position, const lmb_sh3_rgb *batched, bool inside)
{
    lmb_sh3_rgb light, keyed;
    lmb_rgb irradiance;
    float seen[LMB_KEY_LIGHTS_MOST];
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(tiles);
    const uint32_t tile = lmb_volume_tiles_find(tiles, position);
    FUZZ_CHECK(tile == LMB_VOLUME_NO_TILE || tile < info.tile_count, "tile %u of %u", tile, info.tile_count);
    const bool is_inside = lmb_volume_tiles_sample(tiles, position, &light);
    FUZZ_CHECK(lmb_volume_tiles_sample_with_keys(tiles, position, &keyed, seen) == is_inside, "with keys");
    lmb_volume_tiles_irradiance(tiles, position, (lmb_vec3){0.0f, 1.0f, 0.0f}, &irradiance);
    FUZZ_CHECK(light_is_finite(&light) && seen_is_a_share(seen) && isfinite(irradiance.c[0]), "tile %u", tile);
    FUZZ_CHECK(!is_inside || (tile != LMB_VOLUME_NO_TILE && lmb_volume_tiles_is_set(tiles, tile)), "tile %u", tile);
    FUZZ_CHECK(inside == is_inside && memcmp(batched, &light, sizeof light) == 0 &&
                   memcmp(&keyed, &light, sizeof light) == 0,
               "tile %u: a batch differs", tile);
}

static void positions_use(const lmb_volume_tiles *tiles, lmb_vec3d low, lmb_vec3d high)
{
    lmb_vec3d position[POSITIONS];
    lmb_sh3_rgb light[POSITIONS];
    float seen[POSITIONS][LMB_KEY_LIGHTS_MOST];
    bool inside[POSITIONS];
    for (int i = 0; i < POSITIONS; ++i) {
        position[i] = fuzz_position(low, high, i);
    }
    lmb_volume_tiles_sample_batch(tiles, position, POSITIONS, light, seen, inside);
    for (int i = 0; i < POSITIONS; ++i) {
        position_use(tiles, position[i], &light[i], inside[i]);
    }
}

/* Offers it the tiles of the bakes. */
static void tiles_set(lmb_volume_tiles *tiles, uint32_t count)
{
    for (uint32_t tile = 0; tile < count && tile < MOST_TILES; ++tile) {
        for (int bake = 0; bake < BAKES; ++bake) {
            for (uint32_t i = 0; i < bakes[bake].count; ++i) {
                lmb_volume *former;
                const lmb_result result = lmb_volume_tiles_set(tiles, tile, bakes[bake].volume[i], &former);
                FUZZ_CHECK(result == LMB_OK || result == LMB_ERROR_FORMAT || result == LMB_ERROR_CHECKSUM, "%s",
                           lmb_result_text(result));
                FUZZ_CHECK((result == LMB_OK) <= lmb_volume_tiles_is_set(tiles, tile), "tile %u is not set", tile);
            }
        }
    }
}

static void index_use(lmb_volume_tiles *tiles)
{
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(tiles);
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    FUZZ_CHECK(lmb_volume_tiles_key_lights(tiles, light) <= LMB_KEY_LIGHTS_MOST, "key lights");
    positions_use(tiles, info.bounds_min, info.bounds_max);
    tiles_set(tiles, info.tile_count);
    positions_use(tiles, info.bounds_min, info.bounds_max);
    for (uint32_t i = 0; i < info.tile_count && i < MOST_TILES; ++i) {
        const lmb_volume_tile tile = lmb_volume_tiles_get(tiles, i);
        FUZZ_CHECK(isfinite(tile.bounds_min.x) && tile.bounds_min.x <= tile.bounds_max.x, "tile %u: its box", i);
        if (lmb_volume_tiles_is_set(tiles, i)) {
            positions_use(tiles, tile.bounds_min, tile.bounds_max);
        }
        lmb_volume_tiles_clear(tiles, i);
    }
}

static void bytes_open(const unsigned char *bytes, size_t size)
{
    lmb_volume_tiles *tiles = NULL;
    const lmb_result result = lmb_volume_tiles_open_memory(bytes, size, &tiles);
    FUZZ_CHECK((result == LMB_OK) == (tiles != NULL), "%s", lmb_result_text(result));
    if (tiles) {
        index_use(tiles);
        lmb_volume_tiles_close(tiles);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bakes_make();
    fuzz_sealed(data, size, bytes_open);
    return 0;
}

void fuzz_seeds(void)
{
    bakes_make();
    for (int i = 0; i < BAKES; ++i) {
        fuzz_seed(bakes[i].index, bakes[i].index_size);
    }
}
