/* Environment maps: which way their faces lie, what is blurred and divided, and the command that writes them. */
#define _POSIX_C_SOURCE 200809L

#include "command_fixture.h"
#include "environment_maps.h"
#include "level_builder.h"
#include "level_fixture.h"

#include <float.h>
#include <stdlib.h>

#include <cjson/cJSON.h>

#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/specular.h>

#define OUTPUT LMB_TEST_OUTPUT_DIR "/cube_map"
#define LEVEL OUTPUT "/level.glb"

/* A small floor. */
static bool level_write(void)
{
    lmb_error error = {""};
    mkdir(OUTPUT, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material white = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &white);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-1, -4, 1}, (lmb_vec3){2, 0, 0},
                               (lmb_vec3){0, 0, -2});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, LEVEL, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static void faces_lie_as_interfaces_take_them(void)
{
    static const struct {
        lmb_vec3 middle, right, down; /* towards rising s and t */
    } faces[CUBE_FACES] = {
        {{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
        {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}},
    };
    for (int face = 0; face < CUBE_FACES; ++face) {
        const lmb_vec3 middle = cube_direction(face, 0.5f, 0.5f);
        CHECK_NEAR(lmb_vec3_dot(middle, faces[face].middle), 1.0, 1e-6, "face %d", face);
        CHECK(lmb_vec3_dot(cube_direction(face, 0.9f, 0.5f), faces[face].right) > 0.5f, "face %d: s", face);
        CHECK(lmb_vec3_dot(cube_direction(face, 0.5f, 0.9f), faces[face].down) > 0.5f, "face %d: t", face);
    }
    for (int i = 0; i < CUBE_FACES * 32 * 32; ++i) {
        const lmb_vec3 direction =
            cube_direction(i / 1024, ((float)(i % 32) + 0.5f) / 32.0f, ((float)(i / 32 % 32) + 0.5f) / 32.0f);
        CHECK(cube_texel(32, direction) == 3 * (size_t)i, "texel %d", i);
    }
}

/* High above the floor. */
static bool sky_map_make(const char *environment, const lmb_sh3_rgb *radiance, cube_map *map)
{
    level_fixture level;
    if (!level_write() || !level_fixture_load(&level, LEVEL, environment, 2)) {
        return false;
    }
    const cube_place place = {{0, 5000, 0}, *radiance};
    const lmb_result result = cube_map_make(&level.transport, &place, 4, level.pool, NULL, map);
    CHECK(result == LMB_OK, "cube_map_make");
    level_fixture_close(&level);
    return result == LMB_OK;
}

static void even_light_divides_to_one(void)
{
    const lmb_sh3_rgb white = {{{{3.5449077f}}, {{3.5449077f}}, {{3.5449077f}}}};
    cube_map map;
    if (!sky_map_make("#ffffff", &white, &map)) {
        return;
    }
    for (int level = 0; level < CUBE_LEVELS; ++level) {
        const int side = cube_side(level), count = CUBE_FACES * side * side * 3;
        float least = FLT_MAX, most = 0.0f;
        for (int i = 0; i < count; ++i) {
            least = fminf(least, map.rgb[level][i]);
            most = fmaxf(most, map.rgb[level][i]);
        }
        CHECK(least > 0.985f && most < 1.015f, "level %d: %g to %g", level, (double)least, (double)most);
    }
    cube_map_free(&map);
}

static void maps_show_what_is_around(void)
{
    enum { WIDTH = 64, HEIGHT = 32 };
    static float pixels[WIDTH * HEIGHT];
    lmb_error error = {""};
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        pixels[i] = i < WIDTH * HEIGHT / 2 ? 1.0f : 0.0f;
    }
    const lmb_exr_channel grey = {"Y", pixels};
    mkdir(OUTPUT, 0777);
    CHECK(lmb_exr_write(OUTPUT "/half.exr", &(lmb_exr_picture){WIDTH, HEIGHT, &grey, 1, NULL, 0}, NULL, &error) ==
              LMB_OK,
          "%s", error.message);
    /* Half of white from above: 1/2 and its linear band. */
    const lmb_sh3 half = {{1.7724539f, -1.5349901f}};
    const lmb_sh3_rgb place = {{half, half, half}};
    cube_map map;
    if (!sky_map_make(OUTPUT "/half.exr", &place, &map)) {
        return;
    }
    static const struct {
        lmb_vec3 direction;
        double shown, tolerance;
    } cases[] = {
        {{0, 1, 0}, 1.0, 0.02}, {{0, -1, 0}, 0.0, 1e-6}, {{1, 0, 0.01f}, 0.5, 0.06}, {{0.01f, 0, -1}, 0.5, 0.06}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        for (int level = 0; level < 3; ++level) {
            const lmb_vec3 direction = lmb_vec3_unit_or(cases[i].direction, cases[i].direction);
            const lmb_rgb divisor = lmb_specular_environment_divisor(&place, cube_roughness(level), direction);
            const float *texel = map.rgb[level] + cube_texel(cube_side(level), direction);
            CHECK_NEAR(texel[1] * divisor.c[1], cases[i].shown, level == 0 ? cases[i].tolerance : 0.2,
                       "direction %zu, level %d", i, level);
        }
    }
    cube_map_free(&map);
}

/* The sides of an empty room are its walls, and a face of sky is far. */
static void sides_are_walls(void)
{
    static const lmb_vec3 low = {-2, -1, -3}, high = {2, 3, 1};
    static const double expected[CUBE_FACES] = {1.5, 2.5, 3, 1, 1, 3};
    lmb_error error = {""};
    mkdir(OUTPUT, 0777);
    for (int open = 0; open < 2; ++open) {
        level_fixture level;
        cube_map map;
        lmb_level_builder *builder = lmb_level_builder_create(0.1f);
        const lmb_level_material white = lmb_level_material_default();
        lmb_level_box box = lmb_level_box_of(low, high, lmb_level_builder_add_material(builder, &white));
        box.inward = true;
        box.material[3] = open ? LMB_LEVEL_NONE : box.material[3];
        const int room = lmb_level_builder_add_mesh(builder, "room");
        lmb_level_builder_add_box(builder, room, &box);
        lmb_level_builder_place(builder, "room", room, (lmb_vec3){0, 0, 0});
        CHECK(lmb_level_builder_write(builder, LEVEL, &error) == LMB_OK, "%s", error.message);
        lmb_level_builder_destroy(builder);
        if (!level_fixture_load(&level, LEVEL, "#ffffff", 2)) {
            return;
        }
        const cube_place place = {.position = {0.5f, 0, 0}};
        const bool made = cube_map_make(&level.transport, &place, 1, level.pool, NULL, &map) == LMB_OK;
        CHECK(made, "cube_map_make");
        for (int face = 0; made && face < CUBE_FACES; ++face) {
            const double side = open && face == 2 ? 3.0 * (double)CUBE_SKY_SIDES : expected[face];
            CHECK_NEAR(map.side[face], side, 1e-5 * side, "face %d, %s", face, open ? "open" : "closed");
        }
        if (made) {
            cube_map_free(&map);
        }
        level_fixture_close(&level);
    }
}

static bool text_replace(const char *path, const char *from, const char *to)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_error error = {""};
    bool good = lmb_file_read(path, &data, &size, &error) == LMB_OK;
    char *found = NULL;
    for (size_t i = 0; good && !found && i + strlen(from) <= size; ++i) {
        found = memcmp(data + i, from, strlen(from)) == 0 ? (char *)data + i : NULL;
    }
    if (found && strlen(from) == strlen(to)) {
        memcpy(found, to, strlen(to));
        good = lmb_file_write(path, data, size, &error) == LMB_OK;
    }
    free(data);
    CHECK(good && found, "%s in %s: %s", from, path, error.message);
    return good && found;
}

/* The sky is as bright as its harmonics say: a map over them is about 1 there, at any roughness. */
static void maps_are_read_back(void)
{
    lmb_error error = {""};
    environment_maps maps;
    CHECK(environment_maps_read(OUTPUT "/nowhere", &maps, &error) == LMB_ERROR_IO, "%s", error.message);
    const lmb_result result = environment_maps_read(OUTPUT "/maps", &maps, &error);
    CHECK(result == LMB_OK && maps.count == 2 && maps.map[1].position.y == 1.0, "%s", error.message);
    CHECK(result != LMB_OK || (maps.map[1].high.y > 100.0 && fabs(maps.map[1].low.y) < 1e-5), "floor %g, sky %g",
          maps.map[1].low.y, maps.map[1].high.y);
    for (int i = 0; i < 4 && result == LMB_OK; ++i) {
        const lmb_rgb up = cube_map_look(&maps.map[1].map, (lmb_vec3){0.1f, 0.99f, 0.1f}, 0.04f * (float)(1 << 2 * i));
        CHECK(up.c[1] > 0.8f && up.c[1] < 1.25f, "level %d: %g", i, (double)up.c[1]);
    }
    environment_maps_free(&maps);
}

/* The command takes the marked nodes, and --at. */
static void command_writes_maps(void)
{
    lmb_error error = {""};
    mkdir(OUTPUT, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material white = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &white);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-2, 0, 2}, (lmb_vec3){4, 0, 0},
                               (lmb_vec3){0, 0, -4});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    lmb_level_node node = lmb_level_node_default("mirror ball");
    node.translation = (lmb_vec3){1, 0.5f, -1};
    node.cube_map = true;
    lmb_level_builder_add_node(builder, &node);
    CHECK(lmb_level_builder_write(builder, LEVEL, &error) == LMB_OK, "%s", error.message);
    lmb_level_builder_destroy(builder);
    if (!CHECK_RUN(0, NULL,
                   LMB_COMMAND " bake " LEVEL " -o " OUTPUT "/bake --env '#808080' --spacing 1 --samples 8 "
                               "--quiet") ||
        !CHECK_RUN(0, NULL,
                   LMB_COMMAND " cube " LEVEL " " OUTPUT "/bake -o " OUTPUT "/maps --at 0,1,0 --samples 2 "
                               "--quiet")) {
        return;
    }
    char printed[4096];
    run(printed, sizeof printed, "cat " OUTPUT "/maps/cube_map.json");
    cJSON *json = cJSON_Parse(printed);
    const cJSON *maps = cJSON_GetObjectItem(json, "maps"), *first = cJSON_GetArrayItem(maps, 0);
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(first, "name"));
    CHECK(cJSON_GetArraySize(maps) == 2 && name && strcmp(name, "mirror ball") == 0, "%s", printed);
    CHECK_NEAR(cJSON_GetNumberValue(cJSON_GetArrayItem(cJSON_GetObjectItem(first, "position"), 1)), 0.5, 1e-6, "y");
    CHECK(cJSON_GetArraySize(cJSON_GetObjectItem(json, "levels")) == CUBE_LEVELS, "levels");
    cJSON_Delete(json);
    CHECK_RUN(0, "height           248", LMB_COMMAND " info " OUTPUT "/maps/cube_map_1.exr");
    CHECK_RUN(0, NULL,
              LMB_COMMAND " cube " LEVEL " " OUTPUT "/bake -o " OUTPUT "/maps1 --at 0,1,0 --samples 2 "
                          "--threads 1 --quiet && cmp " OUTPUT "/maps/cube_map_0.exr " OUTPUT "/maps1/cube_map_0.exr");
    maps_are_read_back();
    CHECK_RUN(0, NULL,
              LMB_COMMAND " render " LEVEL " " OUTPUT "/bake -o " OUTPUT "/a.png --size 32x18 --specular materials "
                          "--maps " OUTPUT "/maps --quiet");
    CHECK_RUN(3, "cube_map.json",
              LMB_COMMAND " render " LEVEL " " OUTPUT "/bake -o " OUTPUT "/a.png --maps " OUTPUT
                          "/bake --specular materials --quiet");
    CHECK_RUN(2, "missing option", LMB_COMMAND " cube " LEVEL " " OUTPUT "/bake");
    if (text_replace(OUTPUT "/maps/cube_map.json", "\"low\"", "\"lew\"")) {
        CHECK_RUN(3, "a broken box",
                  LMB_COMMAND " render " LEVEL " " OUTPUT "/bake -o " OUTPUT "/a.png --maps " OUTPUT
                              "/maps --specular materials --quiet");
    }
    if (text_replace(LEVEL, "cube_map", "cube_mop")) {
        CHECK_RUN(3, NULL, LMB_COMMAND " cube " LEVEL " " OUTPUT "/bake -o " OUTPUT "/maps --quiet");
    }
}

static const test_case cases[] = {
    {"faces lie as interfaces take them", faces_lie_as_interfaces_take_them},
    {"even light divides to one", even_light_divides_to_one},
    {"maps show what is around", maps_show_what_is_around},
    {"sides are walls", sides_are_walls},
    {"command writes maps", command_writes_maps},
};

TEST_MAIN(cases)
