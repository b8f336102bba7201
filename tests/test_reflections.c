/* What `render --specular` reads of a level and shows: metalness and roughness of textures, and highlights of lamps. */
#define _POSIX_C_SOURCE 200809L
#include "command_fixture.h"

#include <lambent/exr.h>
#include <lambent/specular.h>
#include <lambent/vector.h>

#include "lamps_seen.h"
#include "level_builder.h"
#include "level_fixture.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/reflections"

enum { WIDTH = 32, HEIGHT = 16 };

typedef struct picture {
    bool drawn;
    float rgb[3][WIDTH * HEIGHT];
} picture;

/* A picture of OUTPUT/NAME.glb, baked in OUTPUT/NAME. */
static picture picture_draw(const char *name, const char *options)
{
    static const char *const names[3] = {"R", "G", "B"};
    picture made = {.drawn = false};
    float *plane[3] = {NULL, NULL, NULL};
    char path[512];
    lmb_exr_header header;
    lmb_error error = {""};
    snprintf(path, sizeof path, OUTPUT "/%s.exr", name);
    if (!CHECK_RUN(0, NULL, "cd " OUTPUT " && " LMB_COMMAND " render %s.glb %s -o %s.exr --quiet --size %dx%d %s", name,
                   name, name, (int)WIDTH, (int)HEIGHT, options)) {
        return made;
    }
    const lmb_result result = lmb_exr_read_channels(path, names, 3, plane, &header, &error);
    made.drawn = result == LMB_OK && header.width == WIDTH && header.height == HEIGHT;
    CHECK(made.drawn, "%s", error.message);
    for (int c = 0; c < 3; ++c) {
        if (made.drawn) {
            memcpy(made.rgb[c], plane[c], sizeof made.rgb[c]);
        }
        free(plane[c]);
    }
    return made;
}

/* The mean of the middle half, rows and columns, of the left half of a picture, or the right one. */
static lmb_rgb half_mean(const picture *of, int half)
{
    lmb_rgb mean = {{0.0f, 0.0f, 0.0f}};
    for (int i = 0; i < WIDTH / 4 * (HEIGHT / 2); ++i) {
        const int column = half * WIDTH / 2 + WIDTH / 8 + i % (WIDTH / 4), row = HEIGHT / 4 + i / (WIDTH / 4);
        for (int c = 0; c < 3; ++c) {
            mean.c[c] += of->rgb[c][row * WIDTH + column] / (float)(WIDTH / 4 * (HEIGHT / 2));
        }
    }
    return mean;
}

static bool level_end(lmb_level_builder *builder, const char *path)
{
    lmb_error error = {""};
    const lmb_result result = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static const lmb_rgb copper = {{0.8f, 0.5f, 0.2f}};

/* A floor whose texture has smooth metal on the left and rough plastic on the right, texel by texel what glTF's factors
 * halve. */
static bool floor_make(void)
{
    enum { SIDE = 16 };
    static uint8_t rgba[4 * SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; ++i) {
        const bool metal = i % SIDE < SIDE / 2;
        rgba[4 * i] = 90; /* occlusion: nobody's */
        rgba[4 * i + 1] = metal ? 102 : 255;
        rgba[4 * i + 2] = metal ? 255 : 0;
        rgba[4 * i + 3] = 255;
    }
    mkdir(OUTPUT, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material material = lmb_level_material_default();
    material.base_color = copper;
    material.metallic = 1.0f;
    material.roughness = 0.75f;
    material.metallic_roughness_texture = lmb_level_builder_add_image(builder, "parts", SIDE, SIDE, rgba);
    material.texture_size_m = 8.0f;
    const int mesh = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, mesh, lmb_level_builder_add_material(builder, &material), (lmb_vec3){-4, 0, 4},
                               (lmb_vec3){8, 0, 0}, (lmb_vec3){0, 0, -8});
    lmb_level_builder_place(builder, "floor", mesh, (lmb_vec3){0, 0, 0});
    return level_end(builder, OUTPUT "/floor.glb");
}

/* Under a white sky the metal sends back its own colour of it, and is not diffuse; plastic sends its colour, and some
 * 4 % more of what its roughness keeps. From straight above. */
static void textures_say_what_is_metal(void)
{
    static const char *const modes[] = {"--mode reference --samples 256", "--mode final", "--mode probes"};
    static const lmb_sh3_rgb white = {{{{3.5449077f}}, {{3.5449077f}}, {{3.5449077f}}}};
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    if (!floor_make() || !CHECK_RUN(0, NULL,
                                    "cd " OUTPUT " && " LMB_COMMAND " bake floor.glb -o floor --env '#ffffff' "
                                    "--lightmaps --models sh3 --texels-per-m 1 --spacing 1 --samples 64 --quiet")) {
        return;
    }
    const lmb_specular metal = {0.3f * 0.3f, copper}, plastic = {0.75f * 0.75f, {{0.04f, 0.04f, 0.04f}}};
    const lmb_rgb mirrored = lmb_specular_area(&white, &metal, up, up);
    const lmb_rgb shine = lmb_specular_area(&white, &plastic, up, up);
    for (int i = 0; i < 3; ++i) {
        char options[256];
        snprintf(options, sizeof options, "--specular materials --camera 0,3,0.01 --look 0,0,0 --fov 45 %s %s",
                 modes[i], i == 1 ? "--model sh3" : "");
        const picture drawn = picture_draw("floor", options);
        const lmb_rgb left = half_mean(&drawn, 0), right = half_mean(&drawn, 1);
        /* Harmonics of a hemisphere ring above it, and those of probes have the floor in them. */
        const double tolerance = i == 0 ? 0.03 : i == 1 ? 0.12 : 0.2;
        for (int c = 0; c < 3 && drawn.drawn; ++c) {
            CHECK_NEAR(left.c[c] / mirrored.c[c], 1.0, tolerance, "%s: metal, channel %d", modes[i], c);
            CHECK_NEAR(right.c[c] / (copper.c[c] + shine.c[c]), 1.0, 0.03, "%s: plastic, channel %d", modes[i], c);
        }
    }
}

/* A dark, glossy floor under a lamp, from which a screen hides its right half. */
static bool lamp_make(void)
{
    mkdir(OUTPUT, 0777);
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    lmb_level_material material = lmb_level_material_default();
    material.base_color = lmb_rgb_of(0.05f, 0.05f, 0.05f);
    material.roughness = 0.5f;
    const int dark = lmb_level_builder_add_material(builder, &material);
    const int floor = lmb_level_builder_add_mesh(builder, "floor"),
              screen = lmb_level_builder_add_mesh(builder, "screen");
    lmb_level_builder_add_quad(builder, floor, dark, (lmb_vec3){-4, 0, 4}, (lmb_vec3){8, 0, 0}, (lmb_vec3){0, 0, -8});
    const lmb_level_box wall = lmb_level_box_of((lmb_vec3){0, 0.2f, -4}, (lmb_vec3){0.02f, 3, 4}, dark);
    lmb_level_builder_add_box(builder, screen, &wall);
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    lmb_level_builder_place(builder, "screen", screen, (lmb_vec3){0, 0, 0});
    lmb_level_node node = lmb_level_node_default("lamp");
    node.light = lmb_level_builder_add_light(
        builder, &(lmb_level_light){
                     .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.6f, 0.3f}}, .intensity = 20.0f});
    node.translation = (lmb_vec3){-1.0f, 1.5f, -2.5f};
    lmb_level_builder_add_node(builder, &node);
    return level_end(builder, OUTPUT "/lamp.glb");
}

static double pictures_differ(const picture *a, const picture *b, int c)
{
    double difference = 0.0, sum = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        difference += fabs((double)a->rgb[c][i] - (double)b->rgb[c][i]);
        sum += (double)b->rgb[c][i];
    }
    return difference / sum;
}

/* The highlight of a lamp that is in the harmonics alone is where rays have it, and not where the screen hides it. */
static void lamps_have_highlights(void)
{
    static const char view[] = "--specular materials --camera 0,1.5,3.9 --look 0,0,0 --fov 50 --model sh3";
    char options[256];
    if (!lamp_make() || !CHECK_RUN(0, NULL,
                                   "cd " OUTPUT " && " LMB_COMMAND " bake lamp.glb -o lamp --lightmaps --models sh3 "
                                   "--texels-per-m 4 --spacing 0.5 --samples 64 --quiet")) {
        return;
    }
    const picture final = picture_draw("lamp", view);
    snprintf(options, sizeof options, "%s --mode reference --samples 256", view);
    const picture truth = picture_draw("lamp", options);
    if (final.drawn && truth.drawn) {
        for (int c = 0; c < 3; ++c) {
            CHECK(pictures_differ(&final, &truth, c) < 0.03, "channel %d: %g off", c,
                  pictures_differ(&final, &truth, c));
        }
    }
}

/* Ten lamps, each half as bright as the one before, of which every third one is hidden from where the harmonics are. */
static void lamps_are_taken_out(void)
{
    enum { COUNT = 10 };
    static const lmb_vec3 ways[COUNT] = {{1, 0, 0},  {0, 1, 0}, {0, 0, 1},  {-1, 0, 0}, {0, -1, 0},
                                         {0, 0, -1}, {1, 1, 0}, {0, 1, -1}, {-1, 0, 1}, {1, -1, 1}};
    mkdir(OUTPUT, 0777);
    for (int lit = 0; lit < 2; ++lit) {
        lmb_level_builder *builder = lmb_level_builder_create(0.1f);
        const lmb_level_material white = lmb_level_material_default();
        const int material = lmb_level_builder_add_material(builder, &white);
        const int floor = lmb_level_builder_add_mesh(builder, "floor");
        lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-1, -9, 1}, (lmb_vec3){2, 0, 0},
                                   (lmb_vec3){0, 0, -2});
        lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
        lmb_sh3_rgb light = {{{{0}}}};
        for (int i = 0; i < COUNT && lit; ++i) {
            const lmb_vec3 way = lmb_vec3_unit_or(ways[i], ways[i]);
            const lmb_level_light lamp = {
                .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1, 1, 1}}, .intensity = ldexpf(64.0f, -i)};
            lmb_level_node node = lmb_level_node_default("lamp");
            node.light = lmb_level_builder_add_light(builder, &lamp);
            node.translation = lmb_vec3_scale(way, 2.0f);
            lmb_level_builder_add_node(builder, &node);
            const float arrives = i % 3 == 1 ? 0.0f : lamp.intensity / 4.0f;
            lmb_sh3_rgb_add_light(&light, way, lmb_rgb_of(arrives, arrives, arrives));
        }
        level_fixture level;
        if (!level_end(builder, OUTPUT "/ten.glb") || !level_fixture_load(&level, OUTPUT "/ten.glb", "none", 1)) {
            return;
        }
        lamps_seen lamps;
        const float before = light.channel[1].c[0];
        lamps_take(level.transport.emitters, lmb_vec3_of(0, 0, 0), NULL, &light, &lamps);
        CHECK(lamps.present == (lit == 1) && lamps.count == (lit ? LAMPS_MOST : 0), "%u lamps", lamps.count);
        for (uint32_t i = 0; i < lamps.count; ++i) {
            const double given = ldexp(16.0, -(int)i) / 3.14159265;
            CHECK_NEAR(lamps.light[i].irradiance.c[1], given, 1e-4 * given, "lamp %u", i);
            CHECK_NEAR(lmb_vec3_dot(lamps.light[i].direction, lmb_vec3_unit_or(ways[i], ways[i])), 1.0, 1e-5, "%u", i);
        }
        if (lit) {
            CHECK(lamps.visibility[0] > 0.9f && lamps.visibility[1] < 0.2f, "%g of the first, %g of the hidden",
                  (double)lamps.visibility[0], (double)lamps.visibility[1]);
            CHECK(fabsf(light.channel[1].c[0]) < 0.2f * before, "%g of %g left", (double)light.channel[1].c[0],
                  (double)before);
        }
        level_fixture_close(&level);
    }
}

static const test_case cases[] = {
    {"textures say what is metal", textures_say_what_is_metal},
    {"lamps have highlights", lamps_have_highlights},
    {"lamps are taken out", lamps_are_taken_out},
};

TEST_MAIN(cases)
