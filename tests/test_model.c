/* The table of lighting models: every row keeps its promises, and a lightmap can be stored in any. */
#include <math.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/model.h>
#include <lambent/occlusion.h>
#include <lambent/rnm.h>

#include "harness.h"
#include "lightmap_fixture.h"
#include "variates.h"

/* Light from above and a little from the side, of three colours. */
static lmb_sh3_rgb some_light(void)
{
    lmb_sh3_rgb light;
    for (int c = 0; c < 3; ++c) {
        const lmb_vec3 from = {0.36f, 0.8f, c == 1 ? 0.48f : -0.48f};
        const lmb_sh3 basis = lmb_sh3_basis(from);
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            light.channel[c].c[i] = (float)(c + 1) * basis.c[i] + (i == 0 ? 1.0f : 0.0f);
        }
    }
    return light;
}

static void rows_are_whole(void)
{
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_model *model = lmb_model_at(i);
        CHECK(lmb_model_find(model->name, model->uses) == model &&
                  lmb_model_find(lmb_model_full_name(model), model->uses) == model,
              "%s", model->name);
        CHECK(model->title && !model->encode != !model->encode_light && model->evaluate, "%s", model->name);
        CHECK(model->channel_count > 0 && model->channel_count <= LMB_MODEL_MOST_CHANNELS, "%s: %d", model->name,
              model->channel_count);
        CHECK(model->bytes > 0 && model->bytes <= 2 * model->channel_count, "%s: %d", model->name, model->bytes);
        if (model->uses == 0) {
            CHECK(model->default_uses == 0 && !model->short_name && !model->at_run_time, "%s", model->name);
            continue;
        }
        int channels = 0;
        for (const lmb_model_part *part = model->part; part->count > 0; ++part) {
            channels += part->count;
        }
        CHECK(channels == model->channel_count, "%s: %d", model->name, channels);
        CHECK(model->light_count > 0 && model->light_count <= channels && model->encode, "%s", model->name);
        CHECK((model->default_uses & ~model->uses) == 0, "%s", model->name);
        CHECK(!model->short_name || lmb_model_find(model->short_name, model->uses) == model, "%s", model->name);
        for (int a = 0; a < channels; ++a) {
            for (int b = 0; b < a; ++b) {
                CHECK(strcmp(model->channel_name[a], model->channel_name[b]) != 0, "%s: %s", model->name,
                      model->channel_name[a]);
            }
        }
    }
    CHECK(!lmb_model_find("nothing", 0), "nothing");
    CHECK(lmb_model_default(LMB_MODEL_FOR_LIGHTMAP) == lmb_model_find("hhd", LMB_MODEL_FOR_LIGHTMAP), "lightmaps");
    CHECK(lmb_model_default(LMB_MODEL_FOR_SURFACE) == lmb_model_find("hhd", LMB_MODEL_FOR_SURFACE), "surfaces");
    CHECK(lmb_model_default(LMB_MODEL_FOR_OBJECT) == lmb_model_find("hlsh", LMB_MODEL_FOR_OBJECT), "objects");
}

/* What a row gives is what the sampler gives, to the bit. */
static void rows_are_the_sampler(void)
{
    const lmb_sh3_rgb light = some_light();
    const lmb_vec3 n_v = {0.0f, 1.0f, 0.0f}, n = {0.6f, 0.8f, 0.0f};
    const lmb_irradz irradz = lmb_irradz_encode(&light, n_v, 0.3f);
    const lmb_irradz probe_irradz = lmb_irradz_from_probe(&light, n_v, 0.3f);
    const lmb_hlsh_rgb hlsh = lmb_hlsh_rgb_from_sh3(&light, n_v, 0.3f);
    const lmb_hlsh_rgb probe_hlsh = lmb_hlsh_rgb_from_probe(&light, n_v, 0.3f);
    const lmb_rnm rnm = lmb_rnm_from_sh3(&light, n_v);
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(n_v, slope);
    lmb_sh2_rgb sh2;
    for (int c = 0; c < 3; ++c) {
        sh2.channel[c] = lmb_sh3_multiply_cone(&light.channel[c], n_v, 0.3f);
    }
    const struct {
        const char *name;
        lmb_rgb irradiance;
    } expected[] = {{"irradz-hhd", lmb_irradz_evaluate(&irradz, n_v, n)},
                    {"hhd.closed.fitted", lmb_irradz_evaluate(&probe_irradz, n_v, n)},
                    {"hlsh.t1", lmb_hlsh_rgb_evaluate(&hlsh, n_v, n)},
                    {"hlsh.fitted", lmb_hlsh_rgb_evaluate(&probe_hlsh, n_v, n)},
                    {"sh3", lmb_sh3_rgb_irradiance(&light, n)},
                    {"rnm", lmb_rnm_evaluate(&rnm, slope, n)},
                    {"sh2", lmb_sh2_rgb_irradiance(&sh2, n)}};
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; ++i) {
        const lmb_model *model = lmb_model_find(expected[i].name, 0);
        float channel[LMB_MODEL_MOST_CHANNELS];
        lmb_rgb found;
        model->encode(&light, n_v, 0.3f, channel);
        model->evaluate(channel, n_v, &n, 1, &found);
        CHECK(memcmp(&found, &expected[i].irradiance, sizeof found) == 0, "%s: %g, not %g", expected[i].name,
              (double)found.c[0], (double)expected[i].irradiance.c[0]);
        /* The mean of one, twice over, is that one. */
        for (int c = 0; c < model->channel_count; ++c) {
            channel[c] *= 2.0f;
        }
        lmb_model_average(model, channel, 2.0f);
        model->evaluate(channel, n_v, &n, 1, &found);
        CHECK_NEAR(found.c[1], expected[i].irradiance.c[1], 1e-5f * expected[i].irradiance.c[1], "%s",
                   expected[i].name);
    }
}

/* Light of one of several kinds: a sky with a lamp, any coefficients of any size, one lamp near the horizon, none. */
static lmb_sh3_rgb light_of(uint64_t *random, int kind, lmb_vec3 n_v)
{
    lmb_sh3_rgb light = {{{{0.0f}}}};
    const lmb_vec3 off = {(float)variate_next(random) - 0.5f, (float)variate_next(random) - 0.5f,
                          (float)variate_next(random) - 0.5f};
    const float scale = kind == 2 ? (float)pow(2.0, 160.0 * variate_next(random) - 80.0) : 1.0f;
    for (int c = 0; c < 3 && kind != 4; ++c) {
        light.channel[c].c[0] = kind == 0 ? 1.0f + (float)variate_next(random) : 0.0f;
        for (int i = 0; i < LMB_SH3_COUNT && (kind == 1 || kind == 2); ++i) {
            light.channel[c].c[i] = scale * ((float)variate_next(random) - 0.5f);
        }
    }
    const lmb_vec3 across = lmb_vec3_unit_or(lmb_vec3_cross(n_v, off), n_v);
    const float height = kind == 3 ? 1e-3f * (off.x + off.y) : off.x;
    if (kind == 0 || kind == 3) {
        lmb_sh3_rgb_add_light(&light, lmb_vec3_unit_or(lmb_vec3_mad(across, n_v, height), n_v),
                              (lmb_rgb){{1.0f, 0.5f, 0.25f}});
    }
    return light;
}

/* The bake and the game get the same bits of the same SH3, normal and cone, of what lightmaps and probes are lit by. */
static void bake_and_game_agree_to_the_bit(void)
{
    enum { INPUTS = 1000000 };
    const lmb_model *texel = lmb_model_default(LMB_MODEL_FOR_LIGHTMAP);
    const lmb_model *probe = lmb_model_default(LMB_MODEL_FOR_SURFACE);
    uint64_t random = 3;
    int differ[2] = {0, 0};
    for (int k = 0; k < INPUTS; ++k) {
        const lmb_vec3 raw = {(float)variate_next(&random) - 0.5f, (float)variate_next(&random) - 0.5f,
                              (float)variate_next(&random) - 0.5f};
        const lmb_vec3 n_v = lmb_vec3_unit_or(raw, (lmb_vec3){0.0f, 1.0f, 0.0f});
        const lmb_vec3 n = lmb_vec3_unit_or(lmb_vec3_of(raw.y, raw.z + 0.2f, raw.x), n_v);
        const float cone = k % 3 == 0 ? 0.0f : 1.2f * (float)variate_next(&random) - 0.1f;
        const lmb_sh3_rgb light = light_of(&random, k % 5, n_v);
        const lmb_irradz sampled[2] = {lmb_irradz_encode(&light, n_v, cone), lmb_irradz_from_probe(&light, n_v, cone)};
        for (int m = 0; m < 2; ++m) {
            float channel[LMB_MODEL_MOST_CHANNELS];
            lmb_rgb given;
            const lmb_model *model = m == 0 ? texel : probe;
            model->encode(&light, n_v, cone, channel);
            model->evaluate(channel, n_v, &n, 1, &given);
            const lmb_rgb seen = lmb_irradz_evaluate(&sampled[m], n_v, n);
            differ[m] += memcmp(&given, &seen, sizeof seen) != 0;
        }
    }
    CHECK(differ[0] == 0 && differ[1] == 0, "%d texels and %d probes of %d differ", differ[0], differ[1], INPUTS);
}

/* Floor tiles in the sun, stored by every model, written, read back, and evaluated: normalised irradiance of 3 lux. */
static void lightmaps_in_every_model(void)
{
    static const char path[] = OUTPUT("model_tiles.glb");
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    lmb_error error = {{0}};
    baked bake = {.lightmap = NULL};
    if (!level_fixture_open(&bake.level, path, write_tiles(path, 3.0f, &error), &error, 1)) {
        return;
    }
    for (size_t i = 0; i < lmb_model_count(); ++i) {
        const lmb_lightmap_settings settings = {.texels_per_m = 4.0f, .max_image_size = 256, .model = lmb_model_at(i)};
        if (!(settings.model->uses & LMB_MODEL_FOR_LIGHTMAP)) {
            continue;
        }
        lmb_lightmap *read = NULL;
        char folder[256];
        uint64_t bytes = 0;
        snprintf(folder, sizeof folder, OUTPUT("model_%s"), settings.model->name);
        mkdir(folder, 0777);
        CHECK(lmb_lightmap_create(bake.level.scene, &settings, &bake.lightmap, &error) == LMB_OK &&
                  lightmap_bake(&bake, 64) &&
                  lmb_lightmap_write(bake.lightmap, folder, NULL, &bytes, &error) == LMB_OK &&
                  lmb_lightmap_create(bake.level.scene, &settings, &read, &error) == LMB_OK &&
                  lmb_lightmap_read(read, folder, &error) == LMB_OK,
              "%s: %s", settings.model->name, error.message);
        const lmb_hit hit = {.instance = 0, .triangle = 0, .u = 0.3f, .v = 0.3f};
        float channel[LMB_MODEL_MOST_CHANNELS];
        lmb_rgb irradiance = {{0.0f, 0.0f, 0.0f}};
        if (read) {
            CHECK(read->model == settings.model && lmb_lightmap_sample(read, &hit, channel), "%s",
                  settings.model->name);
            read->model->evaluate(channel, up, &up, 1, &irradiance);
        }
        /* A sun at the zenith gives 3 / pi; SH3 as it is, not clipped, its band limit; what is to be
         * compared with, less exactly. The slopes of RNM face it by 1/sqrt3; two bands of it
         * are 3/4. */
        const double share = strcmp(settings.model->name, "rnm") == 0   ? sqrt(1.0 / 3.0)
                             : strcmp(settings.model->name, "sh2") == 0 ? 0.75
                                                                        : 1.0;
        const double expected = 3.0 / 3.14159265 * share;
        CHECK_NEAR(irradiance.c[1], expected, settings.model->at_run_time ? 0.1 : 0.25, "%s", settings.model->name);
        lmb_lightmap_destroy(read);
        lmb_lightmap_destroy(bake.lightmap);
        bake.lightmap = NULL;
    }
    baked_close(&bake);
}

static const test_case cases[] = {
    {"rows_are_whole", rows_are_whole},
    {"rows_are_the_sampler", rows_are_the_sampler},
    {"bake_and_game_agree_to_the_bit", bake_and_game_agree_to_the_bit},
    {"lightmaps_in_every_model", lightmaps_in_every_model},
};

TEST_MAIN(cases)
