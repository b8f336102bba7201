/* Key lights from outside: what the commands say of a level in the sun. */
#define _POSIX_C_SOURCE 200809L

#include <cjson/cJSON.h>

#include "command_fixture.h"
#include "scenes/level_builder.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/command_keys"
#define LEVEL OUTPUT "/yard.glb"
#define PI 3.14159265358979323846

/* Lux of the sun, which comes from (0.6, 0.8, 0), and of a weaker one from (0, 1, 0). */
#define SUN 6.0
#define SECOND_SUN 1.0

/* A white floor with a wall across it: behind the wall, at x < 0, is shadow. */
static bool yard_make(void)
{
    lmb_error error = {{0}};
    mkdir(OUTPUT, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material white = lmb_level_material_default();
    white.base_color = (lmb_rgb){{0.5f, 0.5f, 0.5f}};
    const int material = lmb_level_builder_add_material(builder, &white);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-4, 0, 4}, (lmb_vec3){8, 0, 0},
                               (lmb_vec3){0, 0, -8});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    const int wall = lmb_level_builder_add_mesh(builder, "wall");
    const lmb_level_box box = lmb_level_box_of((lmb_vec3){0, 0, -4}, (lmb_vec3){0.5f, 3, 4}, material);
    lmb_level_builder_add_box(builder, wall, &box);
    lmb_level_builder_place(builder, "wall", wall, (lmb_vec3){0, 0, 0});
    static const lmb_vec3 along[] = {{0.0f, -1.0f, 0.0f}, {-0.6f, -0.8f, 0.0f}};
    static const float lux[] = {(float)SECOND_SUN, (float)SUN};
    for (int i = 0; i < 2; ++i) {
        const lmb_level_light sun = {
            .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1, 1, 1}}, .intensity = lux[i]};
        lmb_level_node node = lmb_level_node_default("sun");
        node.light = lmb_level_builder_add_light(builder, &sun);
        lmb_level_look_along(along[i], node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
    const lmb_result result = lmb_level_builder_write(builder, LEVEL, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static bool yard_bake(int keys)
{
    return CHECK_RUN(0, NULL,
                     LMB_COMMAND " bake " LEVEL " -o " OUTPUT "/b%d --key-lights %d --spacing 0.5 --samples 64 "
                                 "--lightmaps --texels-per-m 4 --quiet",
                     keys, keys);
}

/* The object that a command prints; NULL and a failed check when it prints none. */
static cJSON *answer_of(const char *format, ...)
{
    static char printed[65536];
    char command[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    const int status = run(printed, sizeof printed, command);
    cJSON *json = cJSON_Parse(printed);
    CHECK(status == 0 && json, "%s: %d, %s", command, status, printed);
    return json;
}

static double number_at(const cJSON *json, const char *key, int index, int channel)
{
    const cJSON *item = cJSON_GetArrayItem(cJSON_GetObjectItem(json, key), index);
    return cJSON_GetNumberValue(channel < 0 ? item : cJSON_GetArrayItem(item, channel));
}

/* What a sun of those lux must be in a list of key lights. */
static void check_light(const cJSON *light, double lux, const double direction[3], const char *where)
{
    for (int c = 0; c < 3; ++c) {
        CHECK_NEAR(number_at(light, "irradiance", c, -1), lux / PI, 1e-5, "%s: channel %d", where, c);
        CHECK_NEAR(number_at(light, "direction", c, -1), direction[c], 1e-5, "%s: axis %d", where, c);
    }
}

/* `sh3` has all of the light, `sh3_rest` what key lights leave of it. */
static void check_harmonics(const cJSON *answer, const char *where)
{
    const cJSON *keys = cJSON_GetObjectItem(answer, "key_lights"), *light;
    double apart = 0.0;
    cJSON_ArrayForEach(light, keys)
    {
        apart += cJSON_GetNumberValue(cJSON_GetObjectItem(light, "visibility")) * number_at(light, "irradiance", 0, -1);
    }
    const double l0 = PI * apart * 0.28209479177387814;
    CHECK_NEAR(number_at(answer, "sh3", 0, 0), number_at(answer, "sh3_rest", 0, 0) + l0, 1e-4, "%s", where);
}

static const double first_direction[] = {0.6, 0.8, 0.0}, second_direction[] = {0.0, 1.0, 0.0};

/* In the light and in the shadow, however many suns are apart, irradiance is the traced one. */
static void sample_and_probe(void)
{
    static const struct {
        double x;
        double seen;
    } places[] = {{2.5, 1.0}, {-1.0, 0.0}};
    for (int keys = 0; keys <= 2 && yard_make() && yard_bake(keys); ++keys) {
        for (size_t i = 0; i < sizeof places / sizeof places[0]; ++i) {
            cJSON *sampled =
                answer_of(LMB_COMMAND " sample " OUTPUT "/b%d/probes.lmb --at %g,0.5,0.25 --normal 0,1,0 --json", keys,
                          places[i].x);
            cJSON *probed =
                answer_of(LMB_COMMAND " probe " LEVEL " --key-lights %d --at %g,0.5,0.25 --normal 0,1,0 --json --quiet",
                          keys, places[i].x);
            const cJSON *answers[] = {sampled, probed};
            for (int k = 0; k < 2; ++k) {
                const char *where = k == 0 ? "sample" : "probe";
                const cJSON *lights = cJSON_GetObjectItem(answers[k], "key_lights");
                CHECK(cJSON_GetArraySize(lights) == keys, "%s: %d of %d key lights", where, cJSON_GetArraySize(lights),
                      keys);
                if (keys > 0) {
                    const cJSON *first = cJSON_GetArrayItem(lights, 0);
                    check_light(first, SUN, first_direction, where);
                    CHECK_NEAR(cJSON_GetNumberValue(cJSON_GetObjectItem(first, "visibility")), places[i].seen, 0.003,
                               "%s at %g", where, places[i].x);
                }
                if (keys > 1) {
                    check_light(cJSON_GetArrayItem(lights, 1), SECOND_SUN, second_direction, where);
                }
                check_harmonics(answers[k], where);
            }
            const double traced = number_at(probed, "traced_irradiance", 0, -1);
            const double tolerance = keys == 2 ? 0.02 : 0.2;
            CHECK_NEAR(number_at(sampled, "irradiance", 0, -1), traced, tolerance, "sample, %d apart, at %g", keys,
                       places[i].x);
            CHECK_NEAR(number_at(probed, "irradiance", 0, -1), traced, tolerance, "probe, %d apart, at %g", keys,
                       places[i].x);
            cJSON_Delete(sampled);
            cJSON_Delete(probed);
        }
    }
}

/* `info` and bake.json name them; an EXR has a channel of each. */
static void info_and_record(void)
{
    if (!yard_make() || !yard_bake(2)) {
        return;
    }
    static const char *const commands[] = {LMB_COMMAND " info --json " OUTPUT "/b2/probes.lmb",
                                           LMB_COMMAND " info --json " OUTPUT "/b2/probes.vdb",
                                           "cat " OUTPUT "/b2/bake.json", "cat " OUTPUT "/b2/lightmap/lightmap.json"};
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        cJSON *json = answer_of("%s", commands[i]);
        const cJSON *lights = cJSON_GetObjectItem(json, "key_lights");
        CHECK(cJSON_GetArraySize(lights) == 2, "%s: %d key lights", commands[i], cJSON_GetArraySize(lights));
        check_light(cJSON_GetArrayItem(lights, 0), SUN, first_direction, commands[i]);
        check_light(cJSON_GetArrayItem(lights, 1), SECOND_SUN, second_direction, commands[i]);
        cJSON_Delete(json);
    }
    cJSON *image = answer_of(LMB_COMMAND " info --json " OUTPUT "/b2/lightmap/lightmap_0_keys.exr");
    const cJSON *channels = cJSON_GetObjectItem(image, "channels");
    static const char *const names[] = {"R", "G"};
    for (int i = 0; i < 2; ++i) {
        const cJSON *channel = cJSON_GetObjectItem(channels, names[i]);
        CHECK_NEAR(cJSON_GetNumberValue(cJSON_GetObjectItem(channel, "max")), 1.0, 0.0, "%s", names[i]);
        CHECK_NEAR(cJSON_GetNumberValue(cJSON_GetObjectItem(channel, "min")), 0.0, 0.0, "%s", names[i]);
    }
    cJSON_Delete(image);
    CHECK_RUN(0, "probes.lmb",
              LMB_COMMAND " pack " OUTPUT "/b2/probes.vdb -o " OUTPUT "/packed.lmb && cmp " OUTPUT "/packed.lmb " OUTPUT
                          "/b2/probes.lmb && echo probes.lmb");
}

/* A bake with its suns apart is nearer to the reference than one without, and pictures hold all of the light. */
static void check_and_render(void)
{
    double error[2], bright[2];
    for (int i = 0; i < 2 && yard_make() && yard_bake(2 * i); ++i) {
        cJSON *report =
            answer_of(LMB_COMMAND " check " LEVEL " " OUTPUT "/b%d --points 150 --samples 128 --json --quiet", 2 * i);
        const cJSON *pair = cJSON_GetObjectItem(report, "coincident_probe_vs_reference");
        error[i] = cJSON_GetNumberValue(cJSON_GetObjectItem(pair, "rel_rmse"));
        pair = cJSON_GetObjectItem(report, "lightmap_vs_reference");
        const double lightmap = cJSON_GetNumberValue(cJSON_GetObjectItem(pair, "median"));
        CHECK(lightmap < 0.05, "%d apart: lightmaps are off by %g", 2 * i, lightmap);
        bright[i] = cJSON_GetNumberValue(cJSON_GetObjectItem(report, "reference_mean"));
        cJSON_Delete(report);
        CHECK_RUN(0, NULL,
                  LMB_COMMAND " render " LEVEL " " OUTPUT "/b%d -o " OUTPUT
                              "/shot%d.png --camera 3,2,3 --look 0,0,0 --size 64x48 --exposure 0 --quiet",
                  2 * i, 2 * i);
    }
    CHECK(error[1] < 0.03 && error[0] > 3.0 * error[1], "apart %g, in harmonics %g", error[1], error[0]);
    CHECK_NEAR(bright[1], bright[0], 1e-3 * bright[0], "one reference");
}

/* Visibility too is the same for any number of threads. */
static void threads_give_equal_bytes(void)
{
    bool baked = yard_make();
    for (int threads = 1; baked && threads <= 3; threads += 2) {
        baked = CHECK_RUN(0, NULL,
                          LMB_COMMAND " bake " LEVEL " -o " OUTPUT "/t%d --threads %d --key-lights 2 --spacing 1 "
                                      "--samples 16 --lightmaps --texels-per-m 3 --quiet",
                          threads, threads);
    }
    if (baked) {
        CHECK_RUN(0, NULL, "diff -r --exclude=bake.json " OUTPUT "/t1 " OUTPUT "/t3");
    }
}

/* Daylight's sun is the strongest here: all commands know it as a key light, and a bake says which sky it was under. */
static void daylight_is_an_environment(void)
{
    static const char SKY[] = "preetham:turbidity=3,sun=90/60,ground=0";
    const double to_sun[] = {0.5, 0.8660254037844386, 0.0};
    if (!yard_make() ||
        !CHECK_RUN(0, NULL, LMB_COMMAND " bake " LEVEL " -o " OUTPUT "/sky --env %s --spacing 2 --samples 16 --quiet",
                   SKY)) {
        return;
    }
    cJSON *record = answer_of("cat " OUTPUT "/sky/bake.json");
    cJSON *probed =
        answer_of(LMB_COMMAND " probe " LEVEL
                              " --env %s --bounces 0 --at 3,0.5,0.25 --normal 0,1,0 --samples 4096 --json --quiet",
                  SKY);
    const cJSON *env = cJSON_GetObjectItem(cJSON_GetObjectItem(record, "settings"), "env");
    CHECK(cJSON_IsString(env) && strcmp(env->valuestring, SKY) == 0, "settings.env");
    const cJSON *suns[] = {cJSON_GetArrayItem(cJSON_GetObjectItem(record, "key_lights"), 0),
                           cJSON_GetArrayItem(cJSON_GetObjectItem(probed, "key_lights"), 0)};
    for (int i = 0; i < 2; ++i) {
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(number_at(suns[i], "direction", c, -1), to_sun[c], 1e-6, "axis %d", c);
        }
        const double red = number_at(suns[i], "irradiance", 0, -1), blue = number_at(suns[i], "irradiance", 2, -1);
        CHECK(red > blue && blue > 70.0 / PI && red < 110.0 / PI, "%g to %g", blue, red);
    }
    /* A sky of 31 klx, a sun of 88 at 60 degrees, and the yard's own. */
    const double green = number_at(probed, "traced_irradiance", 1, -1);
    CHECK(green > 90.0 / PI && green < 120.0 / PI, "on the ground: %g", green);
    cJSON_Delete(record);
    cJSON_Delete(probed);
    CHECK_RUN(0, "probe_vs_reference", LMB_COMMAND " check " LEVEL " " OUTPUT "/sky --points 20 --samples 16 --quiet");
    CHECK_RUN(2, "turbidity from 2 to 10",
              LMB_COMMAND " probe " LEVEL " --at 0,1,0 --env preetham:sun=0/9,turbidity=1");
    CHECK_RUN(2, "unknown option 'haze=2'", LMB_COMMAND " bake " LEVEL " -o x --env preetham:sun=0/9,haze=2");
}

static const test_case cases[] = {
    {"sample and probe", sample_and_probe},
    {"info and record", info_and_record},
    {"check and render", check_and_render},
    {"threads give equal bytes", threads_give_equal_bytes},
    {"daylight is an environment", daylight_is_an_environment},
};

TEST_MAIN(cases)
