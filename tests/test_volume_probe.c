/* Probes one by one: each is where it says, and holds what was baked there. */
#include "cut_fixture.h"
#include "harness.h"
#include "levels_fixture.h"

#include <lambent/pack.h>
#include <lambent/volume_probe.h>

/* A volume, and all of its probes. */
typedef struct listed {
    unsigned char *data;
    lmb_volume *volume;
    lmb_volume_probe *probe;
    uint32_t count;
} listed;

static listed listed_make(lmb_probes *probes, lmb_volume_form form)
{
    listed made = {.count = 0};
    size_t size;
    if (lmb_pack_as(form, probes, &made.data, &size, NULL) != LMB_OK ||
        lmb_volume_open_memory(made.data, size, &made.volume) != LMB_OK) {
        abort();
    }
    made.count = lmb_volume_probe_count(made.volume);
    made.probe = malloc(made.count * sizeof *made.probe);
    if (!made.probe) {
        abort();
    }
    lmb_volume_get_probes(made.volume, made.probe);
    lmb_probes_destroy(probes);
    return made;
}

static void listed_destroy(listed *made)
{
    lmb_volume_close(made->volume);
    free(made->probe);
    free(made->data);
}

/* The fixture's light is known at every place, of points and, but for a jump, of ghosts. */
static void known_light_is_found(void)
{
    listed made = listed_make(cut_fixture_probes(), LMB_VOLUME_HALFS);
    uint32_t kinds[3] = {0};
    for (uint32_t i = 0; i < made.count; ++i) {
        const lmb_volume_probe *const probe = &made.probe[i];
        ++kinds[probe->kind];
        lmb_sh3_rgb light;
        lmb_volume_get_probe(made.volume, i, &light, NULL);
        CHECK(probe->spacing == (probe->level == 0 ? 0.5f : 1.0f) && probe->level < 2, "probe %u: %g of level %u", i,
              (double)probe->spacing, probe->level);
        /* The corner that the finest level lacks got the light of the coarse cell there. */
        const bool is_missing = probe->position.x == 0.0 && probe->position.y == 0.0 && probe->position.z == 2.0;
        const double more = probe->level == 1 || is_missing ? CUT_FIXTURE_COARSE_MORE : 0.0;
        const double jump = (double)light.channel[0].c[0] - more - cut_fixture_light(0, probe->position);
        for (int k = 0; k < 27 && probe->kind == LMB_VOLUME_PROBE_POINT; ++k) {
            CHECK_NEAR(light.channel[k / 9].c[k % 9], cut_fixture_light(k, probe->position) + more,
                       more > 0.0 ? 0.5 : 0.02, "probe %u, coefficient %d", i, k);
        }
        CHECK(probe->kind != LMB_VOLUME_PROBE_GHOST || fabs(jump / 20.0 - floor(jump / 20.0 + 0.5)) < 0.03,
              "ghost %u: a jump of %g", i, jump);
        CHECK(probe->kind != LMB_VOLUME_PROBE_GHOST || jump > 19.0, "ghost %u: a jump of %g", i, jump);
    }
    CHECK(kinds[LMB_VOLUME_PROBE_NONE] == 0, "%u probes are nowhere", kinds[LMB_VOLUME_PROBE_NONE]);
    CHECK(kinds[LMB_VOLUME_PROBE_GHOST] == 4 + 4 + 1 + 4 + 6 + 6 + 1 + 2 + 2 + 4 + 4, "%u ghosts",
          kinds[LMB_VOLUME_PROBE_GHOST]);
    CHECK(kinds[LMB_VOLUME_PROBE_POINT] >= CUT_FIXTURE_FINE, "%u points", kinds[LMB_VOLUME_PROBE_POINT]);
    listed_destroy(&made);
}

/* Where a probe's own cell is sampled, without cut cells, the volume gives it to the bit. */
static void sampling_gives_the_probe(void)
{
    for (int k = 0; k < 2 * LEVELS_RECIPES; ++k) {
        const levels_recipe *const recipe = &levels_recipes[k / 2];
        if (recipe->cut > 0.0) {
            continue;
        }
        listed made = listed_make(levels_make(recipe), k % 2 ? LMB_VOLUME_COMPACT : LMB_VOLUME_HALFS);
        uint32_t same = 0, of_level[LEVELS_MOST] = {0};
        for (uint32_t i = 0; i < made.count && test_failures < 20; ++i) {
            const lmb_volume_probe *const probe = &made.probe[i];
            lmb_sh3_rgb own, sampled;
            float seen[LMB_KEY_LIGHTS_MOST], seen_sampled[LMB_KEY_LIGHTS_MOST];
            if (lmb_volume_sample_with_keys(made.volume, probe->position, &sampled, seen_sampled) &&
                lmb_volume_spacing_at(made.volume, probe->position) == probe->spacing) {
                lmb_volume_get_probe(made.volume, i, &own, seen);
                for (int c = 0; c < 27; ++c) {
                    CHECK_NEAR(own.channel[c / 9].c[c % 9], sampled.channel[c / 9].c[c % 9], k % 2 ? 1e-6 : 1e-7,
                               "recipe %d, probe %u, coefficient %d", k / 2, i, c);
                }
                for (int key = 0; key < LMB_KEY_LIGHTS_MOST; ++key) {
                    CHECK_NEAR(seen[key], seen_sampled[key], 1e-6, "recipe %d, probe %u, key %d", k / 2, i, key);
                }
                ++same;
                ++of_level[probe->level];
            }
        }
        CHECK(2 * same > made.count, "recipe %d: %u of %u", k / 2, same, made.count);
        for (uint32_t level = 0; level < recipe->levels; ++level) {
            CHECK(of_level[level] > 0, "recipe %d: probes of level %u", k / 2, level);
        }
        listed_destroy(&made);
    }
}

/* In every kind of volume. What no cell has is a gap in a row, which is 0. */
static void halfs_are_the_probe(void)
{
    for (int k = 0; k < 2 * LEVELS_RECIPES; ++k) {
        listed made = listed_make(levels_make(&levels_recipes[k / 2]), k % 2 ? LMB_VOLUME_COMPACT : LMB_VOLUME_HALFS);
        const double scale = (double)lmb_volume_get_info(made.volume).scale;
        for (uint32_t i = 0; i < made.count && test_failures < 20; ++i) {
            lmb_sh3_rgb light;
            uint16_t half[27];
            lmb_volume_get_probe(made.volume, i, &light, NULL);
            lmb_volume_get_probe_halfs(made.volume, i, half);
            const bool is_gap = made.probe[i].kind == LMB_VOLUME_PROBE_NONE;
            for (int c = 0; c < 27; ++c) {
                CHECK(!is_gap || half[c] == 0, "recipe %d: probe %u is nowhere", k / 2, i);
                const int exponent = half[c] >> 10 & 31, digits = half[c] & 1023;
                const double size = exponent > 0 ? ldexp(1024.0 + digits, exponent - 25) : ldexp(digits, -24);
                const double value = scale * (half[c] & 0x8000 ? -size : size),
                             wanted = (double)light.channel[c / 9].c[c % 9];
                CHECK_NEAR(value, wanted, k % 2 ? 0x1p-11 * fabs(wanted) + scale * 0x1p-25 : 0.0,
                           "recipe %d, probe %u, coefficient %d", k / 2, i, c);
            }
        }
        listed_destroy(&made);
    }
}

static const test_case cases[] = {
    {"known_light_is_found", known_light_is_found},
    {"sampling_gives_the_probe", sampling_gives_the_probe},
    {"halfs_are_the_probe", halfs_are_the_probe},
};
TEST_MAIN(cases)
