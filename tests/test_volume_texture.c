/* Volumes as 3D textures, read here as the shader reads them: with weights in floats they are the volume to the bit. */
#include "harness.h"
#include "levels_fixture.h"

#include <lambent/pack.h>
#include <lambent/volume_texture.h>

enum { POSITIONS = 4000, GUARD = 64, GUARD_BYTE = 0xa5 };

/* A volume and its textures, with guards around both. */
typedef struct textured {
    unsigned char *data;
    lmb_volume *volume;
    lmb_volume_texture_layout layout;
    lmb_volume_texture_constants constants;
    unsigned char *texels;
    uint32_t *words;
    double inverse_spacing, wedges; /* share of cut cells with one */
} textured;

static const uint16_t *texels_of(const textured *from)
{
    return (const uint16_t *)(const void *)(from->texels + GUARD);
}

static const uint32_t *words_of(const textured *from)
{
    return from->words + GUARD;
}

static void textures_make(textured *made, const lmb_volume_texture_def *def)
{
    const lmb_result result = lmb_volume_texture_size(made->volume, def, &made->layout);
    CHECK(result == LMB_OK, "%s", lmb_result_text(result));
    const size_t bytes = (size_t)made->layout.texture_bytes + 2 * GUARD, words = made->layout.word_count + 2 * GUARD;
    made->texels = malloc(bytes);
    made->words = malloc(words * sizeof *made->words);
    if (!made->texels || !made->words) {
        abort();
    }
    memset(made->texels, GUARD_BYTE, bytes);
    memset(made->words, GUARD_BYTE, words * sizeof *made->words);
    lmb_volume_texture_fill(made->volume, &made->layout, made->texels + GUARD, made->words + GUARD);
    made->constants = lmb_volume_texture_get_constants(made->volume, &made->layout, (lmb_vec3d){0.0, 0.0, 0.0});
    made->inverse_spacing = 1.0 / (double)lmb_volume_get_info(made->volume).spacing;
    bool guarded = true;
    for (size_t i = 0; i < GUARD; ++i) {
        guarded = guarded && made->texels[i] == GUARD_BYTE && made->texels[bytes - 1 - i] == GUARD_BYTE &&
                  made->words[i] == 0xa5a5a5a5u && made->words[words - 1 - i] == 0xa5a5a5a5u;
    }
    CHECK(guarded, "something was written beside them");
}

static textured textured_make(const levels_recipe *recipe, lmb_volume_form form, const lmb_volume_texture_def *def)
{
    textured made = {.data = NULL, .wedges = recipe->wedges};
    lmb_probes *const probes = levels_make(recipe);
    size_t size;
    if (lmb_pack_as(form, probes, &made.data, &size, NULL) != LMB_OK ||
        lmb_volume_open_memory(made.data, size, &made.volume) != LMB_OK) {
        abort();
    }
    lmb_probes_destroy(probes);
    textures_make(&made, def);
    return made;
}

static void textured_destroy(textured *made)
{
    lmb_volume_close(made->volume);
    free(made->texels);
    free(made->words);
    free(made->data);
}

static float half_value(uint16_t half)
{
    const int exponent = half >> 10 & 31, digits = half & 1023;
    const double size = exponent > 0 ? ldexp(1024.0 + digits, exponent - 25) : ldexp(digits, -24);
    return (float)(half & 0x8000 ? -size : size);
}

static float signed_short(uint32_t bits)
{
    return (float)(int32_t)(bits & 0x8000u ? (int32_t)(bits & 0xffffu) - 65536 : (int32_t)(bits & 0xffffu));
}

/* Where a position is among texels; in a wedge of a cut cell, the other region's, too, and its share. */
typedef struct texel_place {
    uint32_t texel[3], other[3];
    float share;
    float t[3];
    bool there, inside;
} texel_place;

static float above(const uint32_t *plane, const float t[3])
{
    return signed_short(plane[0]) * t[0] + signed_short(plane[0] >> 16) * t[1] + signed_short(plane[1]) * t[2] -
           signed_short(plane[1] >> 16);
}

/* Words of the regions. @return the share of the second one */
static float region_words(const uint32_t *record, const float t[3], uint32_t word[2])
{
    const uint32_t *const planes = record + 1, *const words = planes + 3 * record[0];
    uint32_t at = record[0] > 0 ? 0 : 128, beside = 0;
    float own = 0.0f;
    while (at < 128) {
        const uint32_t *const plane = planes + 3 * at;
        const int side = above(plane, t) > 0.0f;
        own = fabsf(above(plane, t));
        at = plane[2] >> 8 * side & 255;
        beside = plane[2] >> 8 * (1 - side) & 255;
    }
    if (at < 160) {
        word[0] = word[1] = words[at - 128];
        return 0.0f;
    }
    const uint32_t *const other = planes + 3 * (at - 160);
    const uint32_t low = other[2] & 255, high = other[2] >> 8;
    const float sum = own + fabsf(above(other, t));
    word[0] = words[beside - 128];
    word[1] = words[(low >= 128 && low < 160 ? low : high) - 128];
    return sum > 0.0f ? own / sum : 0.0f;
}

/* As the shader has it, but in double as far as the cell's fractions. */
static texel_place place_find(const textured *from, lmb_vec3d position)
{
    const lmb_volume_texture_constants *const c = &from->constants;
    const double in[3] = {position.x, position.y, position.z};
    texel_place place = {.inside = true};
    uint32_t cell[3], tile[3];
    double at[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double wanted = in[axis] * from->inverse_spacing - (double)c->origin[axis];
        at[axis] = fmin(fmax(wanted, (double)c->first[axis]), (double)c->last[axis]);
        cell[axis] = (uint32_t)fmin(floor(at[axis]), c->last_cell[axis]);
        place.inside = place.inside && fabs(wanted - at[axis]) <= (double)c->slack;
    }
    const uint32_t word = words_of(
        from)[(cell[0] >> 2) + c->entries[0] * (cell[1] >> 2) + c->entries[1] * (cell[2] >> 2) - c->entries[2]];
    const uint32_t level = word >> 27 & 15;
    place.there = level < 15;
    for (int axis = 0; axis < 3; ++axis) {
        tile[axis] = word >> 9 * axis & 511;
        place.t[axis] = (float)(at[axis] / (double)(1u << level) - (cell[axis] >> level));
        cell[axis] = cell[axis] >> level & 3;
        place.texel[axis] = 5 * tile[axis] + cell[axis];
    }
    if (place.there && word >> 31) {
        const uint32_t brick = tile[0] + c->tiles[0] * tile[1] + c->tiles[1] * tile[2];
        const uint32_t own = words_of(from)[c->cells + 64 * brick + cell[0] + 4 * cell[1] + 16 * cell[2]];
        uint32_t region[2] = {UINT32_MAX, UINT32_MAX};
        place.share = own > 1 ? region_words(words_of(from) + own, place.t, region) : 0.0f;
        place.there = own > 0;
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t first = axis == 2 ? c->region_z : 0, brick_own = place.texel[axis];
            place.texel[axis] = region[0] == UINT32_MAX ? brick_own : 2 * (region[0] >> 10 * axis & 1023) + first;
            place.other[axis] = region[1] == UINT32_MAX ? brick_own : 2 * (region[1] >> 10 * axis & 1023) + first;
        }
    }
    place.inside = place.inside && place.there;
    return place;
}

/* A number of the eight texels from one on, blended in the order of the library's kernels. */
static float number_between(const textured *from, const uint32_t texel[3], const float t[3], uint32_t number)
{
    const lmb_volume_texture_layout *const layout = &from->layout;
    const uint16_t *const part = texels_of(from) + number / 4 * layout->part_bytes / 2;
    float weighed[8], sum = 0.0f;
    for (uint32_t i = 0; i < 8; ++i) {
        const uint32_t x = texel[0] + i % 2, y = texel[1] + i / 2 % 2, z = texel[2] + i / 4;
        const float weight = (i & 1 ? t[0] : 1.0f - t[0]) * (i & 2 ? t[1] : 1.0f - t[1]) * (i & 4 ? t[2] : 1.0f - t[2]);
        weighed[i] = weight * half_value(part[4 * (x + layout->width * (y + (size_t)layout->height * z)) + number % 4]);
    }
    for (int i = 0; i < 8; i += 2) {
        sum = i == 0 ? weighed[0] + weighed[1] : sum + (weighed[i] + weighed[i + 1]);
    }
    return sum;
}

static float number_blend(const textured *from, const texel_place *place, uint32_t number)
{
    if (!place->there) {
        return 0.0f;
    }
    const float first = number_between(from, place->texel, place->t, number);
    if (place->share == 0.0f) {
        return first;
    }
    return first + place->share * (number_between(from, place->other, place->t, number) - first);
}

/* The number of a coefficient. */
static uint32_t number_of(uint32_t channel, uint32_t k)
{
    return k < 8 ? 12 * (k / 4) + 4 * channel + k % 4 : 24 + channel;
}

static lmb_vec3d random_position(const lmb_volume *volume, uint64_t *state)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const lmb_vec3d low = info.bounds_min, high = info.bounds_max;
    const double x = 1.1 * fixture_random(state) - 0.05, y = 1.1 * fixture_random(state) - 0.05,
                 z = 1.1 * fixture_random(state) - 0.05;
    const lmb_vec3d at = {low.x + x * (high.x - low.x), low.y + y * (high.y - low.y), low.z + z * (high.z - low.z)};
    return at;
}

/* `tolerance` of light, in scales. */
static void texture_is_the_volume(const textured *made, double tolerance, const char *name)
{
    const uint32_t bands = made->layout.bands, keys = made->constants.key_lights, count = 3 * bands * bands;
    uint64_t state = 9;
    int inside = 0, wedges = 0;
    for (int i = 0; i < POSITIONS && test_failures < 20; ++i) {
        const lmb_vec3d at = random_position(made->volume, &state);
        const texel_place place = place_find(made, at);
        wedges += place.share > 0.0f;
        lmb_sh3_rgb light;
        float seen[LMB_KEY_LIGHTS_MOST];
        const bool is_inside = lmb_volume_sample_with_keys(made->volume, at, &light, seen);
        inside += is_inside;
        CHECK(is_inside == place.inside, "%s at (%g, %g, %g)", name, at.x, at.y, at.z);
        for (uint32_t k = 0; k < 27; ++k) {
            if (k % 9 < bands * bands) {
                const float got = made->constants.scale * number_blend(made, &place, number_of(k / 9, k % 9));
                CHECK_NEAR(got, light.channel[k / 9].c[k % 9], tolerance * (double)made->constants.scale,
                           "%s, coefficient %u at (%g, %g, %g)", name, k, at.x, at.y, at.z);
            }
        }
        for (uint32_t key = 0; key < keys; ++key) {
            CHECK_NEAR(number_blend(made, &place, count + key) / 255.0f, seen[key], 1e-6, "%s, key %u", name, key);
        }
    }
    CHECK(test_failures > 0 || inside > POSITIONS / 4, "%s: %d inside", name, inside);
    CHECK(test_failures > 0 || (wedges > 20) == (made->wedges > 0.0), "%s: %d in wedges", name, wedges);
}

static void halfs_are_the_files_own(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        const lmb_volume_texture_def def = lmb_volume_texture_default();
        textured made = textured_make(&levels_recipes[k], LMB_VOLUME_HALFS, &def);
        char name[32];
        snprintf(name, sizeof name, "recipe %d", k);
        texture_is_the_volume(&made, 0.0, name);
        textured_destroy(&made);
    }
}

static void compact_probes_are_rounded_once(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        const lmb_volume_texture_def def = lmb_volume_texture_default();
        textured made = textured_make(&levels_recipes[k], LMB_VOLUME_COMPACT, &def);
        char name[32];
        snprintf(name, sizeof name, "recipe %d, compact", k);
        texture_is_the_volume(&made, 0x1p-11 * sqrt(5.0), name);
        textured_destroy(&made);
    }
}

static void two_bands_are_the_first_four(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        const lmb_volume_texture_def def = {.bands = 2, .side_most = 256};
        textured made = textured_make(&levels_recipes[k], LMB_VOLUME_HALFS, &def);
        char name[32];
        snprintf(name, sizeof name, "recipe %d, two bands", k);
        CHECK(made.layout.parts == 3u + (levels_recipes[k].keys > 0), "%s: %u parts", name, made.layout.parts);
        texture_is_the_volume(&made, 0.0, name);
        textured_destroy(&made);
    }
}

static void parts_have_room_for_key_lights(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        const lmb_volume_texture_def def = lmb_volume_texture_default();
        textured made = textured_make(&levels_recipes[k], LMB_VOLUME_HALFS, &def);
        CHECK(made.layout.parts == 7u + (levels_recipes[k].keys > 1), "recipe %d: %u parts", k, made.layout.parts);
        textured_destroy(&made);
    }
}

/* The smallest side that a volume fits in, and one that it does not. */
static void small_sides_are_kept(void)
{
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        lmb_volume_texture_def def = lmb_volume_texture_default();
        textured made = textured_make(&levels_recipes[k], LMB_VOLUME_HALFS, &def);
        lmb_volume_texture_layout layout = {.parts = 77};
        lmb_result result = LMB_ERROR_UNSUPPORTED;
        for (def.side_most = LMB_VOLUME_TEXTURE_SIDE_LEAST; result != LMB_OK && def.side_most < 256; ++def.side_most) {
            CHECK(layout.parts == 77, "recipe %d, side %u: written", k, def.side_most - 1);
            result = lmb_volume_texture_size(made.volume, &def, &layout);
            CHECK(result == LMB_OK || result == LMB_ERROR_UNSUPPORTED, "recipe %d, side %u: %s", k, def.side_most,
                  lmb_result_text(result));
        }
        CHECK(result == LMB_OK && layout.width < def.side_most && layout.height < def.side_most &&
                  layout.depth < def.side_most,
              "recipe %d: %u x %u x %u of a side of %u", k, layout.width, layout.height, layout.depth,
              def.side_most - 1);
        --def.side_most;
        free(made.texels);
        free(made.words);
        textures_make(&made, &def);
        texture_is_the_volume(&made, 0.0, "small side");
        textured_destroy(&made);
    }
}

static void version_3_is_read(void)
{
    textured made = {.data = NULL};
    const lmb_volume_texture_def def = lmb_volume_texture_default();
    CHECK(lmb_volume_open_file(LMB_GOLDEN_DIR "/levels_3.lmb", &made.volume) == LMB_OK, "levels_3.lmb");
    if (made.volume) {
        textures_make(&made, &def);
        CHECK(made.layout.regions > 0, "%u regions", made.layout.regions);
        texture_is_the_volume(&made, 0.0, "version 3");
        textured_destroy(&made);
    }
}

/* Filters weigh in 256ths: each axis is then out by at most 1/512 of the way between two texels, which differ by 2 here
 * at most, where light is from -1 to 1. */
static void weights_of_filters_are_near(void)
{
    double worst = 0.0;
    for (int k = 0; k < LEVELS_RECIPES; ++k) {
        const lmb_volume_texture_def def = lmb_volume_texture_default();
        textured made = textured_make(&levels_recipes[k], LMB_VOLUME_HALFS, &def);
        uint64_t state = 5;
        for (int i = 0; i < POSITIONS; ++i) {
            const lmb_vec3d at = random_position(made.volume, &state);
            texel_place place = place_find(&made, at);
            lmb_sh3_rgb light;
            lmb_volume_sample_at(made.volume, at, &light);
            for (int axis = 0; axis < 3; ++axis) {
                place.t[axis] = rintf(256.0f * fminf(fmaxf(place.t[axis], 0x1p-12f), 1.0f - 0x1p-12f)) / 256.0f;
            }
            for (uint32_t n = 0; n < 27; ++n) {
                const float got = made.constants.scale * number_blend(&made, &place, number_of(n / 9, n % 9));
                worst = fmax(worst, fabs((double)got - (double)light.channel[n / 9].c[n % 9]));
            }
        }
        textured_destroy(&made);
    }
    CHECK(worst <= 3.0 * 2.0 / 512.0 && worst > 1e-4, "an error of %g", worst);
}

static const test_case cases[] = {
    {"halfs_are_the_files_own", halfs_are_the_files_own},
    {"compact_probes_are_rounded_once", compact_probes_are_rounded_once},
    {"two_bands_are_the_first_four", two_bands_are_the_first_four},
    {"parts_have_room_for_key_lights", parts_have_room_for_key_lights},
    {"small_sides_are_kept", small_sides_are_kept},
    {"version_3_is_read", version_3_is_read},
    {"weights_of_filters_are_near", weights_of_filters_are_near},
};
TEST_MAIN(cases)
