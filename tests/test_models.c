/* `lambent models`: its environments, turns and inputs are what they say, its errors those of analysis, its rows and
 * keys what other tools rely on. */
#define _POSIX_C_SOURCE 200809L
#include <stdint.h>

#include <cjson/cJSON.h>

#include <lambent/vector.h>
#include <lambent/exr.h>
#include <lambent/file.h>

#include "command_fixture.h"
#include "models_blend.h"
#include "models_cones.h"
#include "models_spread.h"
#include "sh_oracle.h"

#define OUT(name) LMB_TEST_OUTPUT_DIR "/models_" name

/* A picture of one brightness, and of another in a few pixels. */
static bool sky_write(const char *path, int width, int height, float all, int bright_x, int bright_y, float bright)
{
    float *pixel = malloc((size_t)width * (size_t)height * sizeof *pixel);
    lmb_error error = {""};
    for (int i = 0; i < width * height; ++i) {
        pixel[i] = i == bright_y * width + bright_x ? bright : all;
    }
    const lmb_exr_channel grey = {"Y", pixel};
    const bool good = lmb_exr_write(path, &(lmb_exr_picture){width, height, &grey, 1, NULL, 0}, NULL, &error) == LMB_OK;
    CHECK(good, "%s", error.message);
    free(pixel);
    return good;
}

static models_map *map_read(const char *path)
{
    models_map *map = malloc(sizeof *map);
    lmb_error error = {""};
    CHECK(models_map_read(path, map, &error) == LMB_OK, "%s", error.message);
    return map;
}

/* Averaging keeps all light, whatever the size; directions are those of the environment that a bake takes. */
static void pictures_are_averaged(void)
{
    static const struct {
        int width, height, x, y;
        ovec direction; /* of the bright pixel */
    } table[] = {
        {256, 128, 128, 63, {1, 0, 0}},   /* u = 0.5 */
        {128, 64, 96, 31, {0, 0, 1}},     /* u = 0.75 */
        {64, 32, 0, 0, {0, 1, 0}},        /* row 0 */
        {300, 150, 150, 149, {0, -1, 0}}, /* the last row */
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        if (!sky_write(OUT("spot.exr"), table[i].width, table[i].height, 0.0f, table[i].x, table[i].y, 5.0f)) {
            return;
        }
        models_map *map = map_read(OUT("spot.exr"));
        const double top = cos(ORACLE_PI * table[i].y / table[i].height);
        const double bottom = cos(ORACLE_PI * (table[i].y + 1) / table[i].height);
        double light = 0.0;
        for (int k = 0; k < MODELS_MAP_PIXELS; ++k) {
            light += (double)map->light[k].weight.c[0];
            if (map->light[k].weight.c[0] > 0.0f) {
                const double cosine = ovec_dot(ovec_of(map->light[k].direction), table[i].direction);
                CHECK(cosine > cos(0.13), "%zu: light from %g off", i, acos(cosine));
            }
        }
        CHECK_NEAR(light, 5.0 * 2.0 * ORACLE_PI / table[i].width * (top - bottom), 1e-6 * light, "picture %zu", i);
        free(map);
    }
}

/* The published rotation, as a quaternion's product. */
static ovec turned(ovec v, uint32_t k)
{
    const double u0 = fmod((k + 1) * 0.8191725133961645, 1.0), u1 = fmod((k + 1) * 0.6710436067037893, 1.0);
    const double u2 = fmod((k + 1) * 0.5497004779019703, 1.0), pi = ORACLE_PI;
    const double w = sqrt(u0) * cos(2 * pi * u2);
    const ovec q = {sqrt(1 - u0) * sin(2 * pi * u1), sqrt(1 - u0) * cos(2 * pi * u1), sqrt(u0) * sin(2 * pi * u2)};
    const ovec t = ovec_mix(ovec_cross(q, v), 2.0, v, 0.0);
    return ovec_mix(ovec_mix(v, 1.0, t, w), 1.0, ovec_cross(q, t), 1.0);
}

/* Turns, the SH3 of every input and the truth, by sums and quadrature of their own. */
static void turns_are_the_published(void)
{
    if (!sky_write(OUT("sky.exr"), 128, 64, 0.4f, 70, 20, 900.0f)) {
        return;
    }
    models_map *map = map_read(OUT("sky.exr"));
    models_turn *turn = malloc(sizeof *turn);
    static lmb_vec3 normal[MODELS_NORMAL_COUNT];
    models_normals(normal);
    for (uint32_t k = 0; k < 4; ++k) {
        models_turn_fill(turn, map, normal, k, 0);
        double whole[9] = {0.0}, upper[9] = {0.0}, i_z = 0.0, at_normal = 0.0;
        const ovec some = ovec_of(normal[700]);
        for (int i = 0; i < MODELS_MAP_PIXELS; ++i) {
            const ovec d = turned(ovec_of(map->light[i].direction), k);
            const double weight = (double)map->light[i].weight.c[1];
            double basis[9];
            oracle_basis(d, basis);
            for (int j = 0; j < 9; ++j) {
                whole[j] += weight * basis[j];
                upper[j] += d.z > 0.0 ? weight * basis[j] : 0.0;
            }
            i_z += weight * fmax(d.z, 0.0) / ORACLE_PI;
            at_normal += d.z > 0.0 ? weight * fmax(ovec_dot(d, some), 0.0) / ORACLE_PI : 0.0;
        }
        double wall[2][9] = {{0.0}}, fitted[9];
        const orule below = oracle_zone((ovec){0, 0, 1}, -1.0, 0.0, 16, 400);
        for (size_t i = 0; i < below.count; ++i) {
            double basis[9];
            oracle_basis(below.nodes[i].direction, basis);
            const double side = below.nodes[i].direction.x > 0.0 ? 1.0 : -1.0;
            for (int j = 0; j < 9; ++j) {
                wall[0][j] += below.nodes[i].weight * basis[j] * 0.5 * i_z;
                wall[1][j] += below.nodes[i].weight * basis[j] * 0.5 * i_z * (1.0 + 0.5 * side);
            }
        }
        oracle_rule_free(below);
        /* The texel's fit has the moments of the light above. */
        const orule above = oracle_zone((ovec){0, 0, 1}, 0.0, 1.0, 8, 16);
        for (int j = 0; j < 9; ++j) {
            fitted[j] = (double)turn->sh3[MODELS_LIGHTMAP].channel[1].c[j];
        }
        for (int j = 0; j < 9; ++j) {
            double moment = 0.0;
            for (size_t i = 0; i < above.count; ++i) {
                double basis[9];
                oracle_basis(above.nodes[i].direction, basis);
                moment += above.nodes[i].weight * basis[j] * oracle_evaluate(fitted, above.nodes[i].direction);
            }
            const double size = 1e-4 * whole[0];
            CHECK_NEAR(moment, upper[j], size, "turn %u, texel, %d", k, j);
            CHECK_NEAR(turn->sh3[MODELS_PROBE].channel[1].c[j], whole[j], size, "turn %u, probe, %d", k, j);
            CHECK_NEAR(turn->sh3[MODELS_PROBE_WALL].channel[1].c[j], upper[j] + wall[0][j], size, "turn %u, wall, %d",
                       k, j);
            CHECK_NEAR(turn->sh3[MODELS_PROBE_WALL31].channel[1].c[j], upper[j] + wall[1][j], size,
                       "turn %u, wall31, %d", k, j);
        }
        oracle_rule_free(above);
        CHECK_NEAR(turn->reference[700].c[1], at_normal, 1e-4 * at_normal, "turn %u", k);
    }
    models_turn_fill(turn, map, normal, 0, 0);
    const float published = turn->sh3[MODELS_PROBE].channel[0].c[2];
    models_turn_fill(turn, map, normal, 0, 7);
    CHECK(fabsf(turn->sh3[MODELS_PROBE].channel[0].c[2] - published) > 1e-3f, "seeds turn alike");
    free(turn);
    free(map);
}

static const models_row *row_find(const models_report *report, const char *name, models_input input)
{
    for (size_t i = 0; i < report->row_count; ++i) {
        if (report->row[i].model == lmb_model_find(name, 0) && report->row[i].input == input) {
            return &report->row[i];
        }
    }
    CHECK(false, "no row %s, %s", name, models_input_name(input));
    return NULL;
}

/* Under a white sky a surface has (1 + t)/2: what clips has it exactly, I_z and what does not clip are 1 and off by
 * sqrt(1/7) of it. The answer is the same for any number of threads. */
static void white_sky(void)
{
    if (!sky_write(OUT("white.exr"), 128, 64, 2.0f, 0, 0, 2.0f)) {
        return;
    }
    models_map *map = map_read(OUT("white.exr"));
    const models_settings settings = {.turns = 5};
    models_report report[2];
    for (int i = 0; i < 2; ++i) {
        lmb_pool *pool = NULL;
        CHECK(lmb_pool_create(1 + 2 * i, &pool) == LMB_OK, "pool");
        CHECK(models_measure(&settings, map, 1, pool, NULL, &report[i]) == LMB_OK, "measure");
        lmb_pool_destroy(pool);
    }
    CHECK(report[0].row_count == report[1].row_count &&
              memcmp(report[0].row, report[1].row, report[0].row_count * sizeof *report[0].row) == 0,
          "threads change errors");
    static const char *const exact[] = {"irradz-hhd", "hlsh.t1", "hhd.closed.gram", "hhd.searched.gram", "sh2",
                                        "sh3.gram",   "h4.gram", "ahd.searched",    "sh2.fit",           "sh3.fit"};
    for (size_t i = 0; i < sizeof exact / sizeof exact[0]; ++i) {
        const models_row *row = row_find(&report[0], exact[i], MODELS_PROBE);
        if (row) {
            /* Pixels are points, and a direction at the horizon takes or leaves one. */
            CHECK(row->luminance.mean < 8e-3 && row->colour.max < 8e-3 && row->median < 8e-3, "%s: %g", exact[i],
                  row->luminance.mean);
        }
    }
    static const char *const flat[] = {"scalar", "sh3.unoccluded", "zh3.unoccluded", "cube.unoccluded"};
    for (size_t i = 0; i < sizeof flat / sizeof flat[0]; ++i) {
        const models_row *row = row_find(&report[0], flat[i], MODELS_PROBE);
        if (row) {
            CHECK_NEAR(row->luminance.mean, sqrt(1.0 / 7.0), 3e-3, "%s", flat[i]);
            CHECK_NEAR(row->colour.mean, sqrt(1.0 / 7.0), 3e-3, "%s in colour", flat[i]);
            CHECK_NEAR(row->median, 1.0 / 3.0, 5e-3, "%s", flat[i]);            /* t = 1/2 */
            CHECK_NEAR(row->share_over_10pct, 9.0 / 11.0, 5e-3, "%s", flat[i]); /* t < 9/11 */
        }
    }
    CHECK(!models_row_exists(lmb_model_find("rnm.light", 0), MODELS_PROBE), "rnm.light of a probe");
    models_report_free(&report[0]);
    models_report_free(&report[1]);
    free(map);
}

/* A model that is linear in the light does not mind what is blended. One that solves does; but two of the same light
 * are that light. */
static void blends_of_linear_models_are_equal(void)
{
    static models_map map[2];
    /* White skies, each with a lamp of its own. */
    const lmb_vec3 lamp[2] = {{0.6f, 0.0f, 0.8f}, {-0.48f, 0.6f, 0.64f}};
    for (int m = 0; m < 2; ++m) {
        for (int i = 0; i < MODELS_MAP_PIXELS; ++i) {
            const double z = 1.0 - (2.0 * i + 1.0) / MODELS_MAP_PIXELS, r = sqrt(1.0 - z * z), turn = 2.399963 * i;
            const lmb_vec3 d = {(float)(r * cos(turn)), (float)(r * sin(turn)), (float)z};
            const float light = lmb_vec3_dot(d, lamp[m]) > 0.9f ? 0.02f : 0.0005f;
            map[m].light[i] = (lmb_directed_light){d, {{light, light, light}}};
        }
    }
    lmb_pool *pool = NULL;
    models_settings settings = models_settings_default();
    settings.turns = 8;
    models_blend_report report;
    if (lmb_pool_create(2, &pool) != LMB_OK || models_blend_measure(&settings, map, 2, pool, NULL, &report) != LMB_OK) {
        CHECK(false, "measures");
        lmb_pool_destroy(pool);
        return;
    }
    for (size_t i = 0; i < report.row_count; ++i) {
        const models_blend_row *row = &report.row[i];
        const bool linear = row->model == lmb_model_find("hlsh.t1", 0) || row->model == lmb_model_find("sh3.gram", 0);
        CHECK(!linear || fabs(row->channels - row->harmonics) < 1e-4 * row->harmonics, "%s: %g and %g",
              row->model->name, row->harmonics, row->channels);
        CHECK(row->model != lmb_model_find("hhd.closed.gram", 0) || row->channels > 1.2 * row->harmonics,
              "HHD: %g and %g", row->harmonics, row->channels);
    }
    CHECK(report.row_count > 5, "%zu rows", report.row_count);
    models_blend_free(&report);
    lmb_pool_destroy(pool);
}

/* A white sky behind cones: what a cone's own way makes of it is near the truth, ambient occlusion is not; where the
 * cone is the hemisphere they are one. */
static void white_sky_behind_cones(void)
{
    models_map *map = sky_write(OUT("white.exr"), 128, 64, 2.0f, 0, 0, 2.0f) ? map_read(OUT("white.exr")) : NULL;
    const lmb_model *rows[2] = {lmb_model_find("irradz-hhd", 0), lmb_model_find("sh3", 0)};
    const models_settings settings = {.turns = 2, .model = rows, .model_count = 2};
    models_cone_report report = {NULL, 0};
    lmb_pool *pool = NULL;
    if (!map || lmb_pool_create(2, &pool) != LMB_OK ||
        models_cones_measure(&settings, map, 1, pool, NULL, &report) != LMB_OK || report.row_count != 4) {
        CHECK(false, "%zu rows", report.row_count);
        return;
    }
    const models_cone_row *own = &report.row[0], *ao = &report.row[1];
    CHECK(own->method == MODELS_CONE_OWN && ao->method == MODELS_CONE_AO && report.row[3].method == MODELS_CONE_BENT,
          "methods");
    CHECK_NEAR(own->median[0][0], ao->median[0][0], 1e-6, "hemisphere");
    CHECK(own->median[0][0] < 8e-3, "hemisphere: %g", own->median[0][0]);
    for (int k = 1; k < MODELS_CONE_COSINES; ++k) {
        CHECK(own->median[0][k] < 0.5 * ao->median[0][k], "cosine %d: %g, ambient occlusion %g", k, own->median[0][k],
              ao->median[0][k]);
    }
    models_cones_free(&report);
    lmb_pool_destroy(pool);
    free(map);
}

/* Quantiles and shares of errors that are spread evenly over [0, 1], and of none. */
static void spreads(void)
{
    static uint32_t bin[MODELS_BIN_COUNT];
    static models_spread spread;
    CHECK(models_spread_quantile(&spread, 0.5) == 0.0 && models_spread_share_over(&spread, 0.1f) == 0.0, "none");
    memset(bin, 0, sizeof bin);
    for (int i = 0; i < 100000; ++i) {
        ++bin[models_bin_of(((float)i + 0.5f) * 1e-5f)];
    }
    models_spread_add(&spread, bin);
    for (double share = 0.05; share < 1.0; share += 0.1) {
        CHECK_NEAR(models_spread_quantile(&spread, share), share, 1e-3 * share, "share %g", share);
        CHECK_NEAR(models_spread_share_over(&spread, (float)share), 1.0 - share, 1e-3, "above %g", share);
    }
    memset(bin, 0, sizeof bin);
    ++bin[models_bin_of(0.0f)];
    ++bin[models_bin_of(INFINITY)];
    models_spread_add(&spread, bin);
    CHECK(spread.count == 100002 && spread.bin[0] == 1 && spread.bin[MODELS_BIN_COUNT - 1] == 1, "ends");
}

static void json_has_its_keys(void)
{
    static const char *const numbers[] = {"numbers", "bytes",     "rel_rmse_mean", "rel_rmse_max",    "median",
                                          "p95",     "ns_encode", "ns_eval",       "share_over_10pct"};
    if (!sky_write(OUT("a sky.exr"), 128, 64, 0.4f, 70, 20, 900.0f) ||
        !CHECK_RUN(0, NULL, "'%s' models '%s' '%s' --turns 1 --json --quiet --html '%s' > '%s'", LMB_COMMAND,
                   OUT("a sky.exr"), OUT("a sky.exr"), OUT("page.html"), OUT("report.json"))) {
        return;
    }
    unsigned char *text = NULL;
    size_t size = 0;
    lmb_error error = {""};
    CHECK(lmb_file_read(OUT("report.json"), &text, &size, &error) == LMB_OK, "%s", error.message);
    cJSON *json = cJSON_Parse((const char *)text);
    free(text);
    const cJSON *models = cJSON_GetObjectItem(json, "models");
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(json, "environments")) == 2, "environments");
    CHECK(cJSON_GetNumberValue(cJSON_GetObjectItem(json, "turns")) == 1.0, "turns");
    CHECK(cJSON_IsString(cJSON_GetObjectItem(json, "machine")), "machine");
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(json, "cones")) > 0, "cones");
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(json, "blends")) > 0, "blends");
    int defaults[MODELS_INPUT_COUNT] = {0};
    const cJSON *row;
    cJSON_ArrayForEach(row, models)
    {
        const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(row, "name"));
        const char *input = cJSON_GetStringValue(cJSON_GetObjectItem(row, "input"));
        for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i) {
            const double number = cJSON_GetNumberValue(cJSON_GetObjectItem(row, numbers[i]));
            CHECK((number > 0.0 || strcmp(numbers[i], "share_over_10pct") == 0) && isfinite(number), "%s, %s: %s is %g",
                  name, input, numbers[i], number);
        }
        for (int i = 0; i < MODELS_INPUT_COUNT; ++i) {
            if (input && strcmp(input, models_input_name((models_input)i)) == 0) {
                defaults[i] += cJSON_IsTrue(cJSON_GetObjectItem(row, "default")) ? 1 : 0;
            }
        }
    }
    for (int i = 0; i < MODELS_INPUT_COUNT; ++i) {
        CHECK(defaults[i] == 1, "%d defaults of %s", defaults[i], models_input_name((models_input)i));
    }
    cJSON_Delete(json);
    /* A page that needs nothing else. */
    CHECK(lmb_file_read(OUT("page.html"), &text, &size, &error) == LMB_OK, "%s", error.message);
    CHECK(text && strstr((char *)text, "<svg") && strstr((char *)text, "base64,iVBOR") &&
              strstr((char *)text, "</html>") && !strstr((char *)text, "http"),
          "page");
    free(text);
}

static void command_refuses(void)
{
    CHECK_RUN(0, "usage: lambent models", "'%s' models --help", LMB_COMMAND);
    CHECK_RUN(2, "ENV", "'%s' models", LMB_COMMAND);
    CHECK_RUN(2, "--turns takes", "'%s' models x.hdr --turns 0", LMB_COMMAND);
    CHECK_RUN(2, "--frob", "'%s' models x.hdr --frob", LMB_COMMAND);
    CHECK_RUN(3, "missing.hdr", "'%s' models '%s'", LMB_COMMAND, OUT("missing.hdr"));
    CHECK(sky_write(OUT("dark.exr"), 128, 64, 0.0f, 0, 0, 0.0f), "dark");
    CHECK_RUN(3, "no light", "'%s' models '%s'", LMB_COMMAND, OUT("dark.exr"));
    CHECK(sky_write(OUT("square.exr"), 64, 64, 1.0f, 0, 0, 1.0f), "square");
    CHECK_RUN(3, "twice as wide", "'%s' models '%s'", LMB_COMMAND, OUT("square.exr"));
    CHECK(sky_write(OUT("white.exr"), 128, 64, 2.0f, 0, 0, 2.0f), "white");
    CHECK_RUN(1, "/dev/null/x", "'%s' models '%s' --turns 1 --html /dev/null/x", LMB_COMMAND, OUT("white.exr"));
    CHECK_RUN(0, "hhd.closed.gram", "'%s' models '%s' --turns 1 --seed 3 --threads 1", LMB_COMMAND, OUT("white.exr"));
}

/* On real environments the figures that are known of the papers' models come out (docs/testing.md). */
static void real_environments(void)
{
    static const char *const files[] = {"autumn_field_puresky_1k.hdr",
                                        "evening_road_01_puresky_1k.hdr",
                                        "lobby.hdr",
                                        "night.hdr",
                                        "spiaggia_di_mondello_1k.hdr",
                                        "sunset.hdr"};
    enum { MAPS = sizeof files / sizeof files[0] };
    static const struct {
        const char *name;
        models_input input;
        double least, most;
    } table[] = {
        {"sh3.gram", MODELS_LIGHTMAP, 0.0, 0.0292},
        {"hhd.closed.gram", MODELS_LIGHTMAP, 0.0611, 0.0649},
        {"hhd.closed.gram", MODELS_PROBE, 0.131, 0.139},
        {"hhd.closed.gram", MODELS_PROBE_WALL, 0.1155, 0.1225},
        {"hlsh.t1", MODELS_LIGHTMAP, 0.0989, 0.105},
        {"hlsh.t1", MODELS_PROBE, 0.1416, 0.1504},
        {"hlsh.t1", MODELS_PROBE_WALL, 0.132, 0.140},
        {"sh2", MODELS_LIGHTMAP, 0.1446, 0.1534},
        {"sh2", MODELS_PROBE, 0.1746, 0.1854},
        {"sh2", MODELS_PROBE_WALL, 0.1746, 0.1854},
        {"sh2.fit", MODELS_LIGHTMAP, 0.0968, 0.1028},
        {"sh3.fit", MODELS_LIGHTMAP, 0.0, 0.0279},
        {"ahd.shipped", MODELS_PROBE, 0.516, 0.548},
        {"ahd.shipped", MODELS_PROBE_WALL, 0.2037, 0.2163},
        {"sh3.unoccluded", MODELS_PROBE, 0.4093, 0.4347},
        {"sh3.unoccluded", MODELS_PROBE_WALL, 0.1785, 0.1895},
        {"rnm", MODELS_LIGHTMAP, 0.2677, 0.2843},
        {"rnm.light", MODELS_LIGHTMAP, 0.2677, 0.2843},
        {"scalar", MODELS_LIGHTMAP, 0.5578, 0.5922},
        {"hhd.searched.gram", MODELS_LIGHTMAP, 0.0, 0.0585},
        {"hhd.searched.gram", MODELS_PROBE, 0.0, 0.1375},
        {"hhd.searched.gram", MODELS_PROBE_WALL, 0.0, 0.1195},
        {"ahd.searched", MODELS_LIGHTMAP, 0.0, 0.0585},
        {"ahd.searched", MODELS_PROBE, 0.0, 0.1365},
        {"ahd.searched", MODELS_PROBE_WALL, 0.0, 0.1185},
    };
    models_map *maps = malloc(MAPS * sizeof *maps);
    lmb_error error;
    for (int i = 0; i < MAPS; ++i) {
        char path[512];
        snprintf(path, sizeof path, "%s/envmaps/%s", LMB_DATA_DIR, files[i]);
        if (models_map_read(path, &maps[i], &error) != LMB_OK) {
            test_skip("no real environments");
            free(maps);
            return;
        }
    }
    models_settings settings = models_settings_default();
    models_report report;
    lmb_pool *pool = NULL;
    const lmb_model *rows[16];
    size_t count = 0;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const lmb_model *model = lmb_model_find(table[i].name, 0);
        if (count == 0 || rows[count - 1] != model) {
            rows[count++] = model;
        }
    }
    settings.model = rows;
    settings.model_count = count;
    if (lmb_pool_create(0, &pool) == LMB_OK && models_measure(&settings, maps, MAPS, pool, NULL, &report) == LMB_OK) {
        for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
            const models_row *row = row_find(&report, table[i].name, table[i].input);
            CHECK(row && row->luminance.mean >= table[i].least && row->luminance.mean <= table[i].most,
                  "%s, %s: %.4f, not %.4f to %.4f", table[i].name, models_input_name(table[i].input),
                  row ? row->luminance.mean : 0.0, table[i].least, table[i].most);
        }
        models_report_free(&report);
    }
    lmb_pool_destroy(pool);
    free(maps);
}

static const test_case cases[] = {
    {"pictures_are_averaged", pictures_are_averaged},
    {"turns_are_the_published", turns_are_the_published},
    {"white_sky", white_sky},
    {"blends_of_linear_models_are_equal", blends_of_linear_models_are_equal},
    {"white_sky_behind_cones", white_sky_behind_cones},
    {"spreads", spreads},
    {"json_has_its_keys", json_has_its_keys},
    {"command_refuses", command_refuses},
    {"real_environments", real_environments},
};

TEST_MAIN(cases)
