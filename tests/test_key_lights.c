/* Key lights: which are chosen, and what is seen of them where analysis knows it. */
#include <stdlib.h>

#include <lambent/exr.h>
#include <lambent/lightmap.h>

#include "floor_fixture.h"
#include "level_fixture.h"

#define PI 3.14159265358979323846
#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/key_lights_" name

static const lmb_vec3 up = {0, 1, 0};

/* A sun of these lux whose light travels along a direction. */
typedef struct sun_case {
    lmb_rgb lux;
    float angle_deg;
    lmb_vec3 along;
} sun_case;

static void sun_add(lmb_level_builder *builder, const sun_case *sun)
{
    const lmb_level_light light = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = sun->lux, .intensity = 1.0f};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &light);
    node.angle_deg = sun->angle_deg;
    lmb_level_look_along(sun->along, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

static void box_add(lmb_level_builder *builder, lmb_vec3 min, lmb_vec3 max, float albedo)
{
    lmb_level_material material = lmb_level_material_default();
    material.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    const int mesh = lmb_level_builder_add_mesh(builder, "box");
    const lmb_level_box box = lmb_level_box_of(min, max, lmb_level_builder_add_material(builder, &material));
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_builder_place(builder, "box", mesh, (lmb_vec3){0, 0, 0});
}

/* A roof of no thickness 3 m above x > 0. */
static void roof_add(lmb_level_builder *builder)
{
    const lmb_level_material material = lmb_level_material_default();
    const int roof = lmb_level_builder_add_mesh(builder, "roof");
    lmb_level_builder_add_quad(builder, roof, lmb_level_builder_add_material(builder, &material), (lmb_vec3){0, 3, -9},
                               (lmb_vec3){9, 0, 0}, (lmb_vec3){0, 0, 18});
    lmb_level_builder_place(builder, "roof", roof, (lmb_vec3){0, 0, 0});
}

/* Writes and opens what was built. */
static bool level_open(level_fixture *level, lmb_level_builder *builder, const char *environment, uint32_t key_lights)
{
    lmb_error error = {{0}};
    const char *path = OUTPUT("level.glb");
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    CHECK(written == LMB_OK, "%s", error.message);
    memset(level, 0, sizeof *level);
    return written == LMB_OK && level_fixture_load_with_keys(level, path, environment, 1, key_lights);
}

static lmb_gathered probe_at(const level_fixture *level, lmb_vec3 position)
{
    const lmb_gather_point point = {.position = scene_position(level, position)};
    lmb_gathered gathered;
    lmb_gather_sh3(&level->transport, &point, 256, &gathered);
    return gathered;
}

/* All there is is the sun: the harmonics hold nothing, and the light is exact for every normal. */
static void sun_under_open_sky(void)
{
    const sun_case sun = {{{3.0f, 2.0f, 1.0f}}, 0.0f, {-3.0f, -4.0f, 0.0f}};
    lmb_level_builder *builder = floor_begin(0.0f, 10);
    sun_add(builder, &sun);
    level_fixture level;
    if (!level_open(&level, builder, NULL, 1)) {
        return;
    }
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    CHECK(lmb_scene_key_lights(level.scene, light) == 1, "one");
    CHECK_NEAR(light[0].direction.x, 0.6, 1e-6, "towards the light");
    CHECK_NEAR(light[0].direction.y, 0.8, 1e-6, "towards the light");
    const lmb_gathered gathered = probe_at(&level, (lmb_vec3){0, 1, 0});
    CHECK(gathered.key_visibility[0] == 1.0f && gathered.key_visibility[1] == 0.0f, "%g",
          (double)gathered.key_visibility[0]);
    CHECK(gathered.squared_length == 0.0 && gathered.squared_light > 0.0, "%g", gathered.squared_length);
    const lmb_vec3 normals[] = {{0, 1, 0}, {1, 0, 0}, {0.8f, -0.6f, 0}, {0, 0, 1}, {-0.6f, -0.8f, 0}};
    const double cosines[] = {0.8, 0.6, 0.0, 0.0, 0.0};
    for (size_t i = 0; i < sizeof normals / sizeof normals[0]; ++i) {
        const lmb_rgb found = lmb_key_light_irradiance(&light[0], 1.0f, normals[i], normals[i]);
        const lmb_rgb traced = traced_irradiance(&level, (lmb_vec3){0, 1, 0}, normals[i], 64);
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(found.c[c], (double)sun.lux.c[c] * cosines[i] / PI, 1e-6, "normal %zu", i);
            CHECK_NEAR(traced.c[c], (double)sun.lux.c[c] * cosines[i] / PI, 1e-6, "traced, normal %zu", i);
        }
    }
    level_fixture_close(&level);
}

/* What a surface faces, its shading normal cannot light: n_v decides. */
static void vertex_normal_decides(void)
{
    const lmb_key_light light = {{0, 1, 0}, {{2.0f, 1.0f, 0.5f}}};
    const struct {
        lmb_vec3 vertex, shading;
        float visibility;
        double green;
    } cases[] = {
        {{0, 1, 0}, {0, 1, 0}, 1.0f, 1.0},       {{0, 1, 0}, {0.6f, 0.8f, 0}, 0.5f, 0.4},
        {{1, 0, 0}, {0.6f, 0.8f, 0}, 1.0f, 0.0}, {{0.8f, -0.6f, 0}, {0.6f, 0.8f, 0}, 1.0f, 0.0},
        {{0, 1, 0}, {0, -1, 0}, 1.0f, 0.0},      {{0, 1, 0}, {0, 1, 0}, 0.0f, 0.0},
        {{NAN, NAN, NAN}, {0, 1, 0}, 1.0f, 0.0}, {{0, 1, 0}, {NAN, 0, 0}, 1.0f, 0.0},
        {{0, 1, 0}, {0, 1, 0}, NAN, 0.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const lmb_rgb found = lmb_key_light_irradiance(&light, cases[i].visibility, cases[i].vertex, cases[i].shading);
        for (int c = 0; c < 3; ++c) {
            const double expected = cases[i].green * (double)light.irradiance.c[c];
            CHECK_NEAR(found.c[c], expected, 1e-6, "case %zu, channel %d", i, c);
        }
    }
}

/* A probe and a surface behind a pillar, and beside its shadow. */
static void shadow_of_a_pillar(void)
{
    const sun_case sun = {{{5.0f, 5.0f, 5.0f}}, 0.53f, {-1.0f, -1.0f, 0.0f}};
    lmb_level_builder *builder = floor_begin(0.5f, 10);
    sun_add(builder, &sun);
    box_add(builder, (lmb_vec3){2, 0, -1}, (lmb_vec3){3, 8, 1}, 0.5f);
    level_fixture level;
    if (!level_open(&level, builder, NULL, 1)) {
        return;
    }
    CHECK(probe_at(&level, (lmb_vec3){0, 1, 0}).key_visibility[0] == 0.0f, "behind it");
    CHECK(probe_at(&level, (lmb_vec3){0, 1, 3}).key_visibility[0] == 1.0f, "beside it");
    CHECK(probe_at(&level, (lmb_vec3){5, 1, 0}).key_visibility[0] == 1.0f, "before it");
    level_fixture_close(&level);
}

/* Between the parts of it that are apart and the whole nothing is lost, bounces stay in the harmonics. */
static void harmonics_hold_the_rest(void)
{
    const sun_case suns[] = {{{{5.0f, 4.0f, 3.0f}}, 0.0f, {-1.0f, -1.0f, 0.0f}},
                             {{{1.0f, 2.0f, 1.0f}}, 0.0f, {1.0f, -2.0f, 1.0f}}};
    lmb_sh3_rgb whole[3];
    for (uint32_t keys = 0; keys <= 2; ++keys) {
        lmb_level_builder *builder = floor_begin(0.5f, 10);
        sun_add(builder, &suns[1]);
        sun_add(builder, &suns[0]);
        box_add(builder, (lmb_vec3){2, 0, -1}, (lmb_vec3){3, 2, 1}, 0.5f);
        level_fixture level;
        if (!level_open(&level, builder, "#808080", keys)) {
            return;
        }
        const lmb_gathered gathered = probe_at(&level, (lmb_vec3){0.2f, 1, 0.3f});
        lmb_key_light light[LMB_KEY_LIGHTS_MOST];
        CHECK(lmb_scene_key_lights(level.scene, light) == keys, "%u", keys);
        whole[keys] = gathered.moments;
        for (uint32_t i = 0; i < keys; ++i) {
            CHECK_NEAR(light[i].irradiance.c[0], (double)suns[i].lux.c[0] / PI, 1e-6, "the strongest first");
            lmb_key_light_add_to_sh3(&light[i], gathered.key_visibility[i], &whole[keys]);
        }
        level_fixture_close(&level);
    }
    for (int k = 0; k < 27; ++k) {
        const double plain = (double)whole[0].channel[k / 9].c[k % 9];
        CHECK_NEAR(whole[1].channel[k / 9].c[k % 9], plain, 1e-5, "one apart, coefficient %d", k);
        CHECK_NEAR(whole[2].channel[k / 9].c[k % 9], plain, 1e-5, "two apart, coefficient %d", k);
    }
}

/* Share of a narrow disc overhead, of sine `s`, that is seen past a straight edge `x` of its sine to one side. */
static double share_past_edge(double x, double s)
{
    const double k = fmin(fmax(x / s, -1.0), 1.0);
    return 0.5 + (asin(k) + k * sqrt(1.0 - k * k)) / PI;
}

/* A sun overhead, a roof over x > 0: the disc's segment counts. */
static void penumbra_is_a_segment(void)
{
    static const float angles[] = {0.53f, 5.0f};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; ++a) {
        const sun_case sun = {{{7.0f, 7.0f, 7.0f}}, angles[a], {0.0f, -1.0f, 0.0f}};
        lmb_level_builder *builder = floor_begin(0.0f, 10);
        sun_add(builder, &sun);
        roof_add(builder);
        level_fixture level;
        if (!level_open(&level, builder, NULL, 1)) {
            return;
        }
        const double sine = sin(0.5 * (double)angles[a] * PI / 180.0);
        for (int i = -5; i <= 5; ++i) {
            const double x = 0.25 * i * 2.0 * sine; /* of the point, 2 m under the edge */
            const float found = probe_at(&level, (lmb_vec3){(float)x, 1, 0}).key_visibility[0];
            CHECK_NEAR(found, share_past_edge(-x / 2.0, sine), 0.01, "%g degrees, at %g", (double)angles[a], x);
        }
        level_fixture_close(&level);
    }
}

/* Through tinted glass the share of the luminance counts, as it is traced. */
static void glass_dims_by_luminance(void)
{
    const sun_case sun = {{{1.0f, 3.0f, 2.0f}}, 0.0f, {0.0f, -1.0f, 0.0f}};
    lmb_level_builder *builder = floor_begin(0.0f, 10);
    sun_add(builder, &sun);
    lmb_level_material glass = lmb_level_material_default();
    glass.base_color = (lmb_rgb){{0.9f, 0.5f, 0.1f}};
    glass.transmission = 1.0f;
    const int pane = lmb_level_builder_add_mesh(builder, "pane");
    lmb_level_builder_add_quad(builder, pane, lmb_level_builder_add_material(builder, &glass), (lmb_vec3){-5, 3, 5},
                               (lmb_vec3){10, 0, 0}, (lmb_vec3){0, 0, -10});
    lmb_level_builder_place(builder, "pane", pane, (lmb_vec3){0, 0, 0});
    level_fixture level;
    if (!level_open(&level, builder, NULL, 1)) {
        return;
    }
    const double seen = (double)probe_at(&level, (lmb_vec3){0, 1, 0}).key_visibility[0];
    const lmb_rgb below = traced_irradiance(&level, (lmb_vec3){0, 1, 0}, up, 16);
    CHECK(seen > 0.1 && seen < 0.9, "%g", seen);
    CHECK_NEAR(seen, (double)lmb_luminance(below) * PI / (double)lmb_luminance(sun.lux), 1e-5, "luminance");
    level_fixture_close(&level);
}

/* A roof over a part of the floor: of each row of texels as many are lit, in all, as its length without the shadow; one
 * holds the edge, and as much of it as lies in the light. */
static void texels_across_an_edge(void)
{
    const sun_case sun = {{{2.0f, 2.0f, 2.0f}}, 0.0f, {0.0f, -1.0f, 0.0f}};
    lmb_level_builder *builder = floor_begin(0.0f, 10);
    sun_add(builder, &sun);
    box_add(builder, (lmb_vec3){0.3f, 3, -12}, (lmb_vec3){12, 4, 12}, 0.0f);
    level_fixture level;
    if (!level_open(&level, builder, NULL, 1)) {
        return;
    }
    const lmb_lightmap_settings settings = {.texels_per_m = 1.0f, .max_image_size = 256};
    lmb_lightmap *lightmap = NULL;
    lmb_gather_stats stats;
    lmb_error error = {{0}};
    const lmb_gather_effort effort = {.samples = 256};
    CHECK(lmb_lightmap_create(level.scene, &settings, &lightmap, &error) == LMB_OK, "%s", error.message);
    CHECK(lightmap && lmb_lightmap_bake(lightmap, &level.transport, &effort, level.pool, NULL, &stats) == LMB_OK,
          "bake");
    for (int row = 0; lightmap && row < 5; ++row) {
        double lit = 0.0;
        double partial = 0.0, texel = 0.0;
        enum { STEPS = 2000 };
        for (int i = 0; i < STEPS; ++i) {
            const float x = -10.0f + 20.0f * ((float)i + 0.5f) / STEPS, z = -8.0f + 3.0f * (float)row;
            lmb_hit hit;
            float visibility[LMB_KEY_LIGHTS_MOST] = {0.0f};
            CHECK(lmb_trace_nearest(level.tracer, scene_position(&level, (lmb_vec3){x, 0.5f, z}), (lmb_vec3){0, -1, 0},
                                    0.0f, 2.0f, &hit) &&
                      lmb_lightmap_sample_keys(lightmap, &hit, visibility),
                  "at %g", (double)x);
            lit += (double)visibility[0] * 20.0 / STEPS;
            partial += visibility[0] > 1e-3f && visibility[0] < 0.999f ? 20.0 / STEPS : 0.0;
            texel = (double)lightmap->region[hit.instance].texel_size;
        }
        /* Filtering keeps the sum, but for half a texel at the floor's end. */
        CHECK_NEAR(lit, 10.3, 0.03, "row %d", row);
        CHECK(partial > 0.0 && partial <= 2.02 * texel, "%g m beside the edge, texels of %g m, row %d", partial, texel,
              row);
    }
    lmb_lightmap_destroy(lightmap);
    level_fixture_close(&level);
}

/* A light's luminance, or 0 where it may not be kept apart. */
static void strongest_are_chosen(void)
{
    lmb_light lights[6] = {
        {.type = LMB_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {{1, 1, 1}}},
        {.type = LMB_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {{9, 9, 9}}, .angle_rad = 0.5f},
        {.type = LMB_LIGHT_POINT, .direction = {0, -1, 0}, .intensity = {{9, 9, 9}}},
        {.type = LMB_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {{0, 3, 0}}},
        {.type = LMB_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {{9, 9, 9}}, .indirect_only = true},
        {.type = LMB_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {{0, 0, 0}}},
    };
    for (uint32_t most = 0; most <= LMB_KEY_LIGHTS_MOST; ++most) {
        lmb_scene scene = {.lights = lights, .light_count = 6};
        CHECK(lmb_scene_choose_key_lights(&scene, most) == LMB_OK, "%u", most);
        CHECK(scene.key_light_count == (most < 2 ? most : 2), "%u of %u", scene.key_light_count, most);
        CHECK(most < 1 || scene.key_light[0] == 3, "the strongest");
        CHECK(most < 2 || scene.key_light[1] == 0, "the next");
        CHECK(lmb_scene_light_is_key(&scene, 3) == (most > 0) && !lmb_scene_light_is_key(&scene, 2), "asked by number");
    }
}

/* ---------------------------------------------------------------------------------- the sun in a picture */

enum { WIDTH = 256, HEIGHT = 128 };

/* Towards the centre of a pixel, by what lambent/image.h says of .exr without `envmap`: row 0 is +Y, u = 0.5 is +X,
 * u = 0.75 is +Z; turned about +Y, counter-clockwise from above. */
static void pixel_direction(double column, double row, double rotation, double direction[3])
{
    const double polar = PI * row / HEIGHT, azimuth = 2.0 * PI * (column / WIDTH - 0.5) - rotation;
    direction[0] = sin(polar) * cos(azimuth);
    direction[1] = cos(polar);
    direction[2] = sin(polar) * sin(azimuth);
}

/* Irradiance that a picture gives a normal, not normalised: by a sum over parts of its pixels. */
static void picture_irradiance(const float *rgb, double rotation, const double normal[3], double irradiance[3])
{
    enum { PARTS = 4 };
    irradiance[0] = irradiance[1] = irradiance[2] = 0.0;
    for (int i = 0; i < HEIGHT * PARTS; ++i) {
        const double top = cos(PI * i / (HEIGHT * PARTS)), bottom = cos(PI * (i + 1) / (HEIGHT * PARTS));
        for (int k = 0; k < WIDTH * PARTS; ++k) {
            double direction[3];
            pixel_direction((k + 0.5) / PARTS, (i + 0.5) / PARTS, rotation, direction);
            const double cosine = direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2];
            const float *pixel = &rgb[3 * ((size_t)(i / PARTS) * WIDTH + (size_t)(k / PARTS))];
            for (int c = 0; c < 3 && cosine > 0.0; ++c) {
                irradiance[c] += (double)pixel[c] * cosine * (top - bottom) * 2.0 * PI / (WIDTH * PARTS);
            }
        }
    }
}

/* A sky that is brighter above, with a sun about a pixel: `bright` there, half of that beside it, a tenth less a little
 * around. */
static void picture_write(const char *path, int column, int row, float bright, int radius)
{
    static float plane[3][WIDTH * HEIGHT];
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        const int y = i / WIDTH, across = abs(i % WIDTH - column);
        const int x = across < WIDTH - across ? across : WIDTH - across;
        const int far = x > abs(y - row) ? x : abs(y - row);
        const float sun = far == 0 ? bright : far <= radius ? 0.5f * bright : far == radius + 1 ? 0.02f * bright : 0.0f;
        const float sky = 1.5f - (float)y / HEIGHT;
        plane[0][i] = sky + sun;
        plane[1][i] = sky + 0.9f * sun;
        plane[2][i] = 1.2f * sky + 0.7f * sun;
    }
    const lmb_exr_channel channels[] = {{"B", plane[2]}, {"G", plane[1]}, {"R", plane[0]}};
    lmb_error error = {{0}};
    CHECK(lmb_exr_write(path, &(lmb_exr_picture){WIDTH, HEIGHT, channels, 3, NULL, 0}, NULL, &error) == LMB_OK, "%s",
          error.message);
}

static void scene_free(lmb_scene *scene)
{
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        free(scene->lights[i].name);
    }
    free(scene->lights);
    free(scene->environment.taken);
    lmb_image_free(&scene->environment.image);
}

/* The whole angle, in degrees, of the disc whose second moment is that of the light that was taken out. */
static double taken_angle(const lmb_scene *whole, const lmb_scene *split, double rotation, lmb_vec3 axis)
{
    enum { PARTS = 20 };
    double weights = 0.0, sum = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        const float *p = &whole->environment.image.rgb[3 * i], *q = &split->environment.image.rgb[3 * i];
        const double taken =
            0.2126 * (double)(p[0] - q[0]) + 0.7152 * (double)(p[1] - q[1]) + 0.0722 * (double)(p[2] - q[2]);
        for (int k = 0; k < PARTS * PARTS && taken > 0.0; ++k) {
            double d[3];
            const double row = i / WIDTH + (k / PARTS + 0.5) / PARTS;
            pixel_direction(i % WIDTH + (k % PARTS + 0.5) / PARTS, row, rotation, d);
            const double cosine = d[0] * (double)axis.x + d[1] * (double)axis.y + d[2] * (double)axis.z;
            const double weight = taken * cosine * sin(PI * row / HEIGHT);
            weights += weight;
            sum += weight * (1.0 - cosine * cosine);
        }
    }
    return 2.0 * asin(sqrt(2.0 * sum / weights)) * 180.0 / PI;
}

/* The sun taken out and made a disc, and what is left, light every surface that faces the sun as the whole did. */
static void sun_keeps_its_energy(void)
{
    static const struct {
        int column, row;
        const char *options;
        double rotation, strength;
    } cases[] = {{100, 40, "", 0.0, 1.0},
                 {0, 20, ",rotation=30", PI / 6.0, 1.0},
                 {255, 61, ",strength=2.5", 0.0, 2.5},
                 {33, 10, ",rotation=-100,strength=0.5", -100.0 * PI / 180.0, 0.5}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
        char description[512];
        picture_write(OUTPUT("sun.exr"), cases[k].column, cases[k].row, 5000.0f, 1);
        snprintf(description, sizeof description, "%s%s", OUTPUT("sun.exr"), cases[k].options);
        lmb_scene whole = {0}, split = {0};
        lmb_error error = {{0}};
        CHECK(lmb_scene_set_environment(&whole, description, &error) == LMB_OK &&
                  lmb_scene_set_environment(&split, description, &error) == LMB_OK &&
                  lmb_scene_choose_key_lights(&split, 1) == LMB_OK,
              "%s: %s", description, error.message);
        lmb_key_light light[LMB_KEY_LIGHTS_MOST];
        CHECK(lmb_scene_key_lights(&split, light) == 1 && split.light_count == 1, "case %zu: no sun", k);
        double to_sun[3];
        pixel_direction(cases[k].column + 0.5, cases[k].row + 0.5, cases[k].rotation, to_sun);
        const double *d = to_sun;
        const double along = d[0] * (double)light[0].direction.x + d[1] * (double)light[0].direction.y +
                             d[2] * (double)light[0].direction.z;
        CHECK(along > cos(0.2 * PI / 180.0), "case %zu: %g degrees off", k, acos(along) * 180.0 / PI);
        const double angle = taken_angle(&whole, &split, cases[k].rotation, light[0].direction);
        CHECK(angle > 2.0 && angle < 6.0, "case %zu: %g degrees", k, angle);
        CHECK_NEAR(split.lights[0].angle_rad, angle * PI / 180.0, 1e-3, "case %zu", k);
        for (int n = 0; n < 6; ++n) {
            /* Up to 80 degrees from the sun: the disc is above the horizon. */
            const double tilt = 80.0 * n / 5.0 * PI / 180.0, side = hypot(d[0], d[2]);
            const double normal[3] = {cos(tilt) * d[0] + sin(tilt) * d[2] / side, cos(tilt) * d[1],
                                      cos(tilt) * d[2] - sin(tilt) * d[0] / side};
            double before[3], after[3];
            picture_irradiance(whole.environment.image.rgb, cases[k].rotation, normal, before);
            picture_irradiance(split.environment.image.rgb, cases[k].rotation, normal, after);
            const lmb_vec3 n3 = {(float)normal[0], (float)normal[1], (float)normal[2]};
            const lmb_rgb key = lmb_key_light_irradiance(&light[0], 1.0f, n3, n3);
            for (int c = 0; c < 3; ++c) {
                const double together = after[c] * cases[k].strength + (double)key.c[c] * PI;
                CHECK_NEAR(together, before[c] * cases[k].strength, 2e-5 * before[c] * cases[k].strength,
                           "case %zu, normal %d, channel %d, of which the sun %g", k, n, c, (double)key.c[c] * PI);
            }
        }
        scene_free(&whole);
        scene_free(&split);
    }
}

/* Nothing stands for a sun in an even sky, a wide light, a weak one, or one that a stronger light leaves no room for.
 */
static void what_is_no_sun(void)
{
    static const struct {
        const char *name;
        float bright;
        int radius;
    } cases[] = {{"even", 0.0f, 0}, {"wide", 50.0f, 6}, {"weak", 30.0f, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        picture_write(OUTPUT("no_sun.exr"), 100, 40, cases[i].bright, cases[i].radius);
        lmb_scene scene = {0};
        lmb_error error = {{0}};
        CHECK(lmb_scene_set_environment(&scene, OUTPUT("no_sun.exr"), &error) == LMB_OK &&
                  lmb_scene_choose_key_lights(&scene, 4) == LMB_OK,
              "%s", error.message);
        CHECK(scene.key_light_count == 0 && scene.light_count == 0 && scene.environment.taken_count == 0, "%s",
              cases[i].name);
        scene_free(&scene);
    }
    static float tiny[8 * 4];
    for (int i = 0; i < 8 * 4; ++i) {
        tiny[i] = i == 11 ? 1000.0f : 1.0f;
    }
    const lmb_exr_channel grey = {"Y", tiny};
    lmb_scene small = {0};
    lmb_error error = {{0}};
    CHECK(lmb_exr_write(OUTPUT("tiny.exr"), &(lmb_exr_picture){8, 4, &grey, 1, NULL, 0}, NULL, &error) == LMB_OK &&
              lmb_scene_set_environment(&small, OUTPUT("tiny.exr"), &error) == LMB_OK &&
              lmb_scene_choose_key_lights(&small, 4) == LMB_OK,
          "%s", error.message);
    CHECK(small.key_light_count == 0 && small.light_count == 0, "one pixel of 45 degrees");
    scene_free(&small);
    lmb_scene scene = {.lights = calloc(1, sizeof(lmb_light)), .light_count = 1};
    scene.lights[0] =
        (lmb_light){.type = LMB_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .intensity = {{1e4f, 1e4f, 1e4f}}};
    picture_write(OUTPUT("no_sun.exr"), 100, 40, 5000.0f, 1);
    CHECK(lmb_scene_set_environment(&scene, OUTPUT("no_sun.exr"), &error) == LMB_OK &&
              lmb_scene_choose_key_lights(&scene, 1) == LMB_OK,
          "%s", error.message);
    CHECK(scene.key_light_count == 1 && scene.key_light[0] == 0 && scene.light_count == 1, "the stronger light alone");
    CHECK(scene.environment.taken_count == 0, "and the picture is whole");
    scene_free(&scene);
}

/* Traced, the split picture lights a floor as the whole does; who looks at the sky sees the sun. */
static void traced_as_the_whole(void)
{
    picture_write(OUTPUT("sun.exr"), 100, 40, 5000.0f, 1);
    lmb_rgb floor[2], seen[2];
    double to_sun[3];
    pixel_direction(100.5, 40.5, 0.0, to_sun);
    for (uint32_t keys = 0; keys < 2; ++keys) {
        level_fixture level;
        if (!level_open(&level, floor_begin(0.5f, 10), OUTPUT("sun.exr"), keys)) {
            return;
        }
        floor[keys] = traced_irradiance(&level, (lmb_vec3){0, 0.01f, 0}, up, 1 << 16);
        seen[keys] = lmb_emitters_environment_shown(level.emitters,
                                                    (lmb_vec3){(float)to_sun[0], (float)to_sun[1], (float)to_sun[2]});
        if (keys == 1) {
            const lmb_gathered gathered = probe_at(&level, (lmb_vec3){0, 1, 0});
            CHECK(gathered.key_visibility[0] == 1.0f, "%g", (double)gathered.key_visibility[0]);
        }
        level_fixture_close(&level);
    }
    for (int c = 0; c < 3; ++c) {
        CHECK_NEAR(floor[1].c[c], floor[0].c[c], 0.004 * (double)floor[0].c[c], "channel %d", c);
        CHECK(seen[1].c[c] == seen[0].c[c] && seen[1].c[c] > 3000.0f, "seen %g, was %g", (double)seen[1].c[c],
              (double)seen[0].c[c]);
    }
}

static const test_case cases[] = {
    {"the sun under an open sky", sun_under_open_sky},
    {"the vertex normal decides", vertex_normal_decides},
    {"the shadow of a pillar", shadow_of_a_pillar},
    {"harmonics hold the rest", harmonics_hold_the_rest},
    {"a penumbra is a segment", penumbra_is_a_segment},
    {"glass dims by luminance", glass_dims_by_luminance},
    {"texels across a shadow's edge", texels_across_an_edge},
    {"the strongest are chosen", strongest_are_chosen},
    {"a picture's sun keeps its energy", sun_keeps_its_energy},
    {"what is no sun", what_is_no_sun},
    {"traced as the whole picture", traced_as_the_whole},
};

TEST_MAIN(cases)
