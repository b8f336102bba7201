/* Sets of lights: how a level names them, and that their light adds up to all of it. */
#include <lambent/bake_level.h>
#include <lambent/gather_sh3.h>
#include <lambent/light_sets.h>

#include <string.h>

#include "constant_volume.h"
#include "floor_fixture.h"
#include "harness.h"

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/light_sets_" name

/* A floor with a lamp of the set "lamp", a glowing box of "sign", a sun and another lamp that name none. */
static bool level_write(const char *path)
{
    lmb_level_builder *const builder = floor_begin(0.5f, 20);
    const lmb_level_light lamp = {
        .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.5f, 0.25f}}, .intensity = 20.0f};
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1.0f, 1.0f, 0.9f}}, .intensity = 3.0f};
    const int lights[3] = {lmb_level_builder_add_light(builder, &lamp), lmb_level_builder_add_light(builder, &sun),
                           lmb_level_builder_add_light(builder, &lamp)};
    static const char *const names[3] = {"lamp", NULL, NULL};
    for (int i = 0; i < 3; ++i) {
        lmb_level_node node = lmb_level_node_default("light");
        node.light = lights[i];
        node.light_set = names[i];
        node.translation = (lmb_vec3){(float)i - 1.0f, 2.0f, 0.5f};
        lmb_level_look_along((lmb_vec3){0.3f, -1.0f, 0.2f}, node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
    lmb_level_material sign = lmb_level_material_default();
    sign.emission = (lmb_rgb){{0.2f, 2.0f, 0.4f}};
    sign.light_set = "sign";
    const int mesh = lmb_level_builder_add_mesh(builder, "sign");
    const lmb_level_box box = lmb_level_box_of((lmb_vec3){1, 1, 1}, (lmb_vec3){2, 1.5f, 1.1f},
                                               lmb_level_builder_add_material(builder, &sign));
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_builder_place(builder, "sign", mesh, (lmb_vec3){0, 0, 0});
    lmb_error error = {{0}};
    const lmb_result result = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static bool level_open(const char *environment, lmb_level *level)
{
    lmb_level_settings settings = lmb_level_settings_default();
    settings.path = OUTPUT("level.glb");
    settings.environment = environment;
    settings.threads = 1;
    lmb_error error = {{0}};
    const lmb_result result =
        level_write(settings.path) ? lmb_level_open(&settings, NULL, NULL, level, &error) : LMB_ERROR_IO;
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static lmb_gathered light_at(const lmb_level *level, lmb_vec3 position)
{
    const lmb_gather_point point = {.position = position};
    lmb_gathered gathered;
    lmb_gather_sh3(&level->transport, &point, 4096, &gathered);
    return gathered;
}

static void names_are_read(void)
{
    lmb_level level;
    if (!level_open("#808080,set=sky", &level)) {
        return;
    }
    CHECK(level.scene->light_set_count == 3, "%u", level.scene->light_set_count);
    uint32_t found;
    const char *const names[] = {"lamp", "sign", "sky"};
    for (size_t i = 0; i < 3; ++i) {
        CHECK(lmb_scene_light_set(level.scene, names[i], &found) == LMB_OK && found <= 3, "%s is there", names[i]);
        CHECK(lmb_scene_light_set_is_used(level.scene, found), "%s gives light", names[i]);
    }
    CHECK(level.scene->light_set_count == 3, "asking for a set that is there makes none");
    CHECK(lmb_scene_light_set(level.scene, "no name", &found) == LMB_ERROR_ARGUMENT, "a blank");
    CHECK(lmb_scene_light_set(level.scene, "", &found) == LMB_ERROR_ARGUMENT, "no letter");
    CHECK(lmb_scene_light_set(level.scene, "dark", &found) == LMB_OK && found == 4, "a new one");
    CHECK(!lmb_scene_light_set_is_used(level.scene, found), "nothing is in it");
    lmb_level_close(&level);
}

/* Light is additive: by the solved light and by paths, direct and bounced. */
static void sets_add_up(lmb_estimator estimator)
{
    lmb_level level;
    if (!level_open("#808080,set=sky", &level)) {
        return;
    }
    const lmb_vec3 position = {0.3f, 0.7f, 0.2f};
    lmb_error error = {{0}};
    double sum[3] = {0.0, 0.0, 0.0}, most = 0.0;
    for (uint32_t set = 0; set <= level.scene->light_set_count; ++set) {
        CHECK(lmb_level_show_light_set(&level, set, &error) == LMB_OK, "%s", error.message);
        CHECK(lmb_level_solve(&level, estimator, NULL, &error) == LMB_OK, "%s", error.message);
        CHECK(level.scene->key_light_count == (set == 0), "the sun is kept apart where it shines");
        const lmb_gathered part = light_at(&level, position);
        for (int c = 0; c < 3; ++c) {
            sum[c] += (double)part.moments.channel[c].c[0];
        }
        most = fmax(most, (double)part.moments.channel[1].c[0]);
    }
    CHECK(lmb_level_show_light_set(&level, LMB_LIGHT_SETS_ALL, &error) == LMB_OK, "%s", error.message);
    CHECK(lmb_level_solve(&level, estimator, NULL, &error) == LMB_OK, "%s", error.message);
    CHECK(level.scene->key_light_count == 1, "as it was");
    const lmb_gathered whole = light_at(&level, position);
    CHECK(most < 0.9 * sum[1], "no set is all of it");
    for (int c = 0; c < 3; ++c) {
        const double all = (double)whole.moments.channel[c].c[0];
        CHECK_NEAR(sum[c], all, 0.01 * all, "channel %d", c);
    }
    lmb_level_close(&level);
}

/* What is not in the set is dark, exactly. */
static void others_are_dark(void)
{
    lmb_level level;
    if (!level_open(NULL, &level)) {
        return;
    }
    lmb_error error = {{0}};
    uint32_t none;
    CHECK(lmb_scene_light_set(level.scene, "dark", &none) == LMB_OK, "a set without lights");
    CHECK(lmb_level_show_light_set(&level, none, &error) == LMB_OK, "%s", error.message);
    CHECK(lmb_level_solve(&level, LMB_ESTIMATOR_CACHED, NULL, &error) == LMB_OK, "%s", error.message);
    const lmb_gathered dark = light_at(&level, (lmb_vec3){0.3f, 0.7f, 0.2f});
    CHECK(dark.squared_light == 0.0, "%g", dark.squared_light);
    lmb_level_close(&level);
}

/* Weights make the light exactly linear. */
static void volumes_blend(void)
{
    const lmb_scene scene = {.bounds_min = {-2, -2, -2}, .bounds_max = {2, 2, 2}};
    constant_volume lamp, sky;
    if (!constant_volume_make(&scene, (lmb_rgb){{1.0f, 0.5f, 0.25f}}, &lamp)) {
        return;
    }
    if (constant_volume_make(&scene, (lmb_rgb){{0.0f, 2.0f, 4.0f}}, &sky)) {
        const lmb_volume *const volumes[2] = {lamp.volume, sky.volume};
        const float weights[3][2] = {{1.0f, 1.0f}, {0.0f, 0.5f}, {2.0f, 0.0f}};
        const float green[3] = {2.5f, 1.0f, 1.0f};
        for (int i = 0; i < 3; ++i) {
            lmb_sh3_rgb light;
            CHECK(lmb_volume_blend(volumes, weights[i], 2, (lmb_vec3d){0.3, 0.2, 0.1}, &light), "inside of both");
            CHECK_NEAR(light.channel[1].c[0], (double)green[i] * 3.54490770, 1e-2, "weights %d", i);
            CHECK(!lmb_volume_blend(volumes, weights[i], 2, (lmb_vec3d){99.0, 0.0, 0.0}, &light), "outside");
        }
        lmb_sh3_rgb none;
        CHECK(!lmb_volume_blend(volumes, weights[0], 0, (lmb_vec3d){0.0, 0.0, 0.0}, &none), "no volume");
        CHECK(none.channel[1].c[0] == 0.0f, "no light");
        constant_volume_close(&sky);
    }
    constant_volume_close(&lamp);
}

/* A level is opened with one of its sets alone. */
static void a_level_shows_one(void)
{
    static const struct {
        const char *set;
        lmb_result result;
        uint32_t keys;
        bool lit;
    } cases[] = {{"base", LMB_OK, 1, true},
                 {"lamp", LMB_OK, 0, true},
                 {"sign", LMB_OK, 0, true},
                 {"lamps", LMB_ERROR_UNSUPPORTED, 0, false}};
    if (!level_write(OUTPUT("level.glb"))) {
        return;
    }
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        lmb_level_settings settings = lmb_level_settings_default();
        settings.path = OUTPUT("level.glb");
        settings.light_set = cases[i].set;
        settings.threads = 1;
        lmb_error error = {{0}};
        lmb_level level;
        const lmb_result result = lmb_level_open(&settings, NULL, NULL, &level, &error);
        CHECK(result == cases[i].result, "%s: %s", cases[i].set, error.message);
        if (result == LMB_OK) {
            CHECK(level.scene->key_light_count == cases[i].keys, "%s: %u suns", cases[i].set,
                  level.scene->key_light_count);
            CHECK((light_at(&level, (lmb_vec3){0.3f, 0.7f, 0.2f}).squared_light > 0.0) == cases[i].lit, "%s",
                  cases[i].set);
            lmb_level_close(&level);
        } else {
            CHECK(strstr(error.message, "there are sign, lamp and 'base'"), "%s", error.message);
        }
    }
}

static void solved_sets_add_up(void)
{
    sets_add_up(LMB_ESTIMATOR_CACHED);
}

static void traced_sets_add_up(void)
{
    sets_add_up(LMB_ESTIMATOR_REFERENCE);
}

static const test_case cases[] = {
    {"names are read", names_are_read},         {"solved sets add up", solved_sets_add_up},
    {"traced sets add up", traced_sets_add_up}, {"others are dark", others_are_dark},
    {"a level shows one", a_level_shows_one},   {"volumes blend", volumes_blend},
};

TEST_MAIN(cases)
