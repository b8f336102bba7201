/* Pictures: where camera rays go, which side things appear on, what light surfaces and objects show, and bytes that a
 * screen shows. */
#include "camera.h"
#include "constant_volume.h"
#include "half_vector.h"
#include "level_builder.h"
#include "level_fixture.h"
#include "levels.h"
#include "render.h"
#include "tonemap.h"

#include <float.h>
#include <stdlib.h>

#include <lambent/sequence.h>
#include <lambent/specular.h>
#include <lambent/texture.h>

#define OUTPUT(name) LMB_TEST_OUTPUT_DIR "/render_" name

static void camera_rays_hit_the_expected_pixels(void)
{
    /* At the origin, looking along -Z with 90 degrees upright: the picture plane at z = -1 is 2 high, 4 wide. */
    const lmb_camera camera = camera_look_at((lmb_vec3){0, 0, 0}, (lmb_vec3){0, 0, -5}, 90.0f);
    static const struct {
        float x, y;
        lmb_vec3 on_plane;
    } rays[] = {
        {200, 100, {0, 0, -1}}, {0, 0, {-2, 1, -1}},     {400, 0, {2, 1, -1}},
        {0, 200, {-2, -1, -1}}, {400, 200, {2, -1, -1}}, {300, 50, {1, 0.5f, -1}},
    };
    for (size_t i = 0; i < sizeof rays / sizeof rays[0]; ++i) {
        const lmb_vec3 direction = camera_direction(&camera, 400, 200, rays[i].x, rays[i].y);
        const float scale = -1.0f / direction.z;
        CHECK_NEAR(direction.x * scale, rays[i].on_plane.x, 1e-5, "x of pixel %g,%g", (double)rays[i].x,
                   (double)rays[i].y);
        CHECK_NEAR(direction.y * scale, rays[i].on_plane.y, 1e-5, "y of pixel %g,%g", (double)rays[i].x,
                   (double)rays[i].y);
    }
}

static void camera_frame_is_right_handed_everywhere(void)
{
    static const lmb_vec3 targets[] = {{1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {-3, 2, 5}, {1e-6f, -1, 0}};
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; ++i) {
        const lmb_camera camera = camera_look_at((lmb_vec3){0, 0, 0}, targets[i], 60.0f);
        const lmb_vec3 f = camera.forward, r = camera.right, u = camera.up;
        CHECK_NEAR(f.x * r.x + f.y * r.y + f.z * r.z, 0.0, 1e-6, "target %zu: forward.right", i);
        CHECK_NEAR(f.x * u.x + f.y * u.y + f.z * u.z, 0.0, 1e-6, "target %zu: forward.up", i);
        CHECK_NEAR(r.x * r.x + r.y * r.y + r.z * r.z, 1.0, 1e-5, "target %zu: right is unit", i);
        /* right x up looks back at the viewer. */
        CHECK_NEAR(r.y * u.z - r.z * u.y, -f.x, 1e-5, "target %zu: handedness", i);
        CHECK_NEAR(r.z * u.x - r.x * u.z, -f.y, 1e-5, "target %zu: handedness", i);
        CHECK(u.y >= -1e-6f, "target %zu: the picture is not upside down", i);
    }
}

static void tone_curve_rises_to_white(void)
{
    float last = 0.0f;
    for (float light = 0.0f; light < 100.0f; light = light * 1.01f + 1e-4f) {
        const float shown = tone_curve(light);
        CHECK(shown >= last && shown <= 1.0f, "tone of %g is %g after %g", (double)light, (double)shown, (double)last);
        last = shown;
    }
    CHECK(last == 1.0f, "white");
    CHECK_NEAR(tone_curve(0.001f), 0.001, 2e-6, "straight in the dark");
    CHECK(tone_curve(NAN) == 0.0f && tone_curve(-1.0f) == 0.0f && tone_curve(INFINITY) == 1.0f, "no surprises");
}

static void srgb_bytes_round_trip(void)
{
    for (int byte = 0; byte < 256; ++byte) {
        const int again = srgb_of_linear(lmb_srgb_to_linear((uint8_t)byte));
        CHECK(again == byte, "byte %d came back as %d", byte, again);
    }
    CHECK(srgb_of_linear(-1.0f) == 0 && srgb_of_linear(7.0f) == 255 && srgb_of_linear(NAN) == 0, "ends");
}

static void exposure_brings_the_log_average_to_middle_grey(void)
{
    /* Luminances 0.25, 4 and none at all: log-average 1. */
    const float rgb[9] = {0.25f, 0.25f, 0.25f, 4, 4, 4, 0, 0, 0};
    CHECK_NEAR(exp2f(exposure_of_picture(rgb, 3)), 0.18, 1e-4, "exposure");
    CHECK(exposure_of_picture(rgb + 6, 1) == 0.0f, "a dark picture stays as it is");
}

static void difference_colours(void)
{
    const float rgb[15] = {0, 0, 0, 2, 2, 2, -2, -2, -2, 0.5f, 0.5f, 0.5f, -0.5f, -0.5f, -0.5f};
    static const uint8_t expected[15] = {255, 255, 255, 255, 0, 0, 0, 0, 255, 255, 128, 128, 128, 128, 255};
    uint8_t srgb[15];
    picture_difference_colour(rgb, 5, 1.0f, srgb);
    for (int i = 0; i < 15; ++i) {
        CHECK(abs(srgb[i] - expected[i]) <= 1, "pixel %d channel %d is %d", i / 3, i % 3, srgb[i]);
    }
}

static int add_glow(lmb_level_builder *builder, float red, float green, float blue)
{
    lmb_level_material material = lmb_level_material_default();
    material.base_color = (lmb_rgb){{0, 0, 0}};
    material.emission = (lmb_rgb){{red, green, blue}};
    return lmb_level_builder_add_material(builder, &material);
}

static void add_box(lmb_level_builder *builder, const char *name, int material, lmb_vec3 at)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    const float half = 0.5f;
    const lmb_level_box box = lmb_level_box_of((lmb_vec3){-half, -half, -half}, (lmb_vec3){half, half, half}, material);
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_builder_place(builder, name, mesh, at);
}

/* Glowing boxes of 1 m: red at +X, green at +Y, blue at +Z, and a grey one in the middle. */
static lmb_result write_axes(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    add_box(builder, "x", add_glow(builder, 1, 0, 0), (lmb_vec3){3, 0, 0});
    add_box(builder, "y", add_glow(builder, 0, 1, 0), (lmb_vec3){0, 3, 0});
    add_box(builder, "z", add_glow(builder, 0, 0, 1), (lmb_vec3){0, 0, 3});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

enum { WIDTH = 40, HEIGHT = 30 };

static bool draw(const level_fixture *level, const lmb_shader *shader, lmb_camera camera, lmb_render_mode mode,
                 float rgb[3 * WIDTH * HEIGHT], double *reference_mean)
{
    const lmb_render_settings settings = {
        .camera = camera, .mode = mode, .width = WIDTH, .height = HEIGHT, .samples = 64};
    const lmb_result result = render_picture(shader, &settings, level->pool, NULL, rgb, reference_mean);
    CHECK(result == LMB_OK, "%s", lmb_result_text(result));
    return result == LMB_OK;
}

static void axes_appear_where_they_should(void)
{
    lmb_error error = {""};
    level_fixture level;
    constant_volume light;
    const char *path = OUTPUT("axes.glb");
    if (!level_fixture_open(&level, path, write_axes(path, &error), &error, 1)) {
        return;
    }
    if (!constant_volume_make(level.scene, (lmb_rgb){{0, 0, 0}}, &light)) {
        level_fixture_close(&level);
        return;
    }
    const lmb_shader shader = {.transport = &level.transport, .volume = light.volume, .default_texel = 0.1f};
    /* From +Z looking along -Z with 60 degrees at 10 m: 3 m is 7.8 pixels at 30 rows over 11.5 m. */
    static const struct {
        lmb_vec3 from;
        int red[2], green[2], blue[2]; /* pixels; (-1, -1): hidden or in the middle */
    } views[] = {
        {{0, 0, 12}, {26, 15}, {20, 8}, {20, 15}},  /* +X right, +Y up */
        {{0, 0, -8}, {10, 15}, {20, 5}, {20, 15}},  /* +X left */
        {{12, 0, 0}, {20, 15}, {20, 8}, {13, 15}},  /* +Z left */
        {{0, 12, 0}, {26, 15}, {20, 15}, {20, 21}}, /* from above, -Z is up: +Z down */
    };
    static float rgb[3 * WIDTH * HEIGHT];
    for (size_t i = 0; i < sizeof views / sizeof views[0]; ++i) {
        const lmb_camera camera = camera_look_at(views[i].from, (lmb_vec3){0, 0, 0}, 60.0f);
        double mean;
        if (!draw(&level, &shader, camera, RENDER_FINAL, rgb, &mean)) {
            break;
        }
        const int *pixels[3] = {views[i].red, views[i].green, views[i].blue};
        for (int c = 0; c < 3; ++c) {
            const float *pixel = rgb + 3 * (pixels[c][0] + WIDTH * pixels[c][1]);
            for (int k = 0; k < 3; ++k) {
                CHECK_NEAR(pixel[k], k == c ? 1.0 : 0.0, 0.01, "view %zu: channel %d of the box on axis %d", i, k, c);
            }
        }
    }
    constant_volume_close(&light);
    level_fixture_close(&level);
}

/* In a furnace everything has one radiance, L = emission / (1 - albedo), and so does a picture of it. */
static void furnace_looks_the_same_everywhere(void)
{
    lmb_error error = {""};
    level_fixture level;
    constant_volume light;
    const char *path = OUTPUT("furnace.glb");
    const lmb_rgb emission = {{0.5f, 1.0f, 2.0f}};
    const lmb_result written = lmb_level_furnace(path, 4.0f, 0.5f, emission, false, &error);
    if (!level_fixture_open(&level, path, written, &error, 2)) {
        return;
    }
    const lmb_rgb radiance = {{1.0f, 2.0f, 4.0f}};
    if (!constant_volume_make(level.scene, radiance, &light)) {
        level_fixture_close(&level);
        return;
    }
    lmb_render_object sphere;
    const lmb_result opened = render_object_open(NULL, 0.5f, (lmb_vec3d){0, 0, -1}, &sphere, &error);
    CHECK(opened == LMB_OK, "%s", error.message);
    const lmb_shader shader = {.transport = &level.transport,
                               .volume = light.volume,
                               .objects = &sphere,
                               .object_count = opened == LMB_OK ? 1 : 0,
                               .default_texel = 0.1f};
    const lmb_camera camera = camera_look_at((lmb_vec3){0, 0, 1}, (lmb_vec3){0, 0, -1}, 60.0f);
    static const struct {
        lmb_render_mode mode;
        double tolerance;
    } modes[] = {{RENDER_FINAL, 0.003},
                 {RENDER_PROBES, 0.003},
                 {RENDER_LIGHTMAP, 0.003},
                 {RENDER_REFERENCE, 0.35},
                 {RENDER_DIFFERENCE, 0.35}};
    static float rgb[3 * WIDTH * HEIGHT];
    for (size_t m = 0; opened == LMB_OK && m < sizeof modes / sizeof modes[0]; ++m) {
        const lmb_render_mode mode = modes[m].mode;
        double mean = 0.0;
        if (!draw(&level, &shader, camera, mode, rgb, &mean)) {
            break;
        }
        for (int c = 0; c < 3; ++c) {
            /* The wall at the left edge, the sphere in the middle: white paper of albedo 0.8 where it is not paper. */
            const double truth = (double)radiance.c[c];
            const double wall = mode == RENDER_DIFFERENCE ? 0.0 : truth;
            const double ball = mode == RENDER_DIFFERENCE ? 0.0 : mode == RENDER_LIGHTMAP ? truth : 0.8 * truth;
            CHECK_NEAR(rgb[3 * (2 + WIDTH * 15) + c], wall, modes[m].tolerance * truth, "mode %d: wall, channel %d",
                       (int)mode, c);
            CHECK_NEAR(rgb[3 * (20 + WIDTH * 15) + c], ball, modes[m].tolerance * truth, "mode %d: sphere, channel %d",
                       (int)mode, c);
        }
        double sum = 0.0;
        for (int i = 0; i < WIDTH * HEIGHT; ++i) {
            sum += (double)rgb[3 * i + 1] / (WIDTH * HEIGHT);
        }
        if (mode == RENDER_DIFFERENCE) {
            CHECK_NEAR(sum, 0.0, 0.02, "difference, mean of green");
            CHECK(mean > 1.6 && mean < 2.1, "mean luminance of the reference is %g", mean);
        } else if (mode == RENDER_REFERENCE) {
            CHECK(sum > 1.8 && sum < 2.03, "mean of green of the reference is %g", sum);
        }
    }
    if (opened == LMB_OK) {
        render_object_close(&sphere);
    }
    constant_volume_close(&light);
    level_fixture_close(&level);
}

/* Of light that is 1 from everywhere, samples and the table send on the same. */
static void half_vectors_keep_what_the_lobe_keeps(void)
{
    const lmb_sh3_rgb white = {{{{3.5449077f}}, {{3.5449077f}}, {{3.5449077f}}}};
    const lmb_vec3 normal = {0, 0, 1};
    for (int i = 0; i < 12; ++i) {
        const float cosine = 0.1f + 0.3f * (float)(i % 4), roughness = 0.2f + 0.35f * (float)(i / 4);
        const lmb_vec3 view = {sqrtf(1.0f - cosine * cosine), 0, cosine};
        const lmb_specular mirror = {roughness, {{1, 1, 1}}};
        double sum = 0.0;
        enum { SAMPLES = 4096 };
        for (uint32_t k = 0; k < SAMPLES; ++k) {
            float u[2];
            half_vector_sample picked;
            lmb_sequence_2d(3, k, 0, u);
            if (half_vector_pick(roughness, normal, view, u, &picked)) {
                CHECK_NEAR(lmb_vec3_length(picked.towards), 1.0, 1e-5, "a direction");
                sum += picked.arrives / SAMPLES;
            }
        }
        CHECK_NEAR(sum, lmb_specular_area(&white, &mirror, normal, view).c[0], 0.02, "m %g, N.V %g", (double)roughness,
                   (double)cosine);
    }
    CHECK_NEAR(dielectric_reflectance(0.04, 1.0), 0.04, 1e-9, "along the normal");
    CHECK_NEAR(dielectric_reflectance(0.04, 0.0), 1.0, 1e-9, "grazing");
}

/* What a direction is worth is what the half vector that leads there brings, over its density. */
static void half_vectors_respond_as_they_are_picked(void)
{
    const lmb_vec3 normal = {0, 0, 1};
    for (uint32_t k = 0; k < 64; ++k) {
        const float cosine = 0.1f + 0.2f * (float)(k % 5), roughness = 0.1f + 0.2f * (float)(k / 16);
        const lmb_vec3 view = {sqrtf(1.0f - cosine * cosine), 0, cosine};
        float u[2];
        half_vector_sample picked;
        half_vector_response response;
        lmb_sequence_2d(5, k, 0, u);
        if (half_vector_pick(roughness, normal, view, u, &picked)) {
            CHECK(half_vector_respond(roughness, normal, view, picked.towards, &response), "m %g", (double)roughness);
            CHECK_NEAR(response.reflects / response.density / picked.arrives, 1.0, 1e-3, "m %g, N.V %g",
                       (double)roughness, (double)cosine);
            CHECK_NEAR(response.along, picked.along, 1e-5, "the cosine");
        }
    }
}

/* An object that also reflects shows that much more, by probes as by rays. */
static void objects_reflect(void)
{
    lmb_error error = {""};
    level_fixture level;
    constant_volume light;
    const char *path = OUTPUT("mirror.glb");
    const lmb_result written = lmb_level_furnace(path, 4.0f, 0.5f, (lmb_rgb){{0.5f, 1.0f, 2.0f}}, false, &error);
    if (!level_fixture_open(&level, path, written, &error, 2)) {
        return;
    }
    lmb_render_object sphere;
    if (!constant_volume_make(level.scene, (lmb_rgb){{1.0f, 2.0f, 4.0f}}, &light)) {
        level_fixture_close(&level);
        return;
    }
    const lmb_result opened = render_object_open(NULL, 0.5f, (lmb_vec3d){0, 0, -1}, &sphere, &error);
    CHECK(opened == LMB_OK, "%s", error.message);
    const lmb_specular specular = {0.2f, {{0.5f, 0.25f, 0.0f}}};
    const lmb_shader shader = {.transport = &level.transport,
                               .volume = light.volume,
                               .objects = &sphere,
                               .object_count = opened == LMB_OK ? 1 : 0,
                               .specular = &specular,
                               .default_texel = 0.1f,
                               .reference_samples = 1024};
    static const double expected[] = {0.8 + 0.5, 2.0 * (0.8 + 0.25), 4.0 * 0.8};
    for (int k = 0; k < 2 && opened == LMB_OK; ++k) {
        const lmb_light_source source = k == 0 ? SOURCE_PROBES : SOURCE_REFERENCE;
        const lmb_rgb seen = shade_ray(&shader, source, (lmb_vec3){0.02f, 0.02f, 1}, (lmb_vec3){0, 0, -1});
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR((double)seen.c[c] / expected[c], 1.0, k == 0 ? 0.01 : 0.03, "source %d, channel %d", k, c);
        }
    }
    const lmb_rgb wall = shade_ray(&shader, SOURCE_PROBES, (lmb_vec3){0, 1.5f, 1}, (lmb_vec3){0, 0, -1});
    CHECK_NEAR(wall.c[1], 2.0, 0.01, "surfaces do not");
    lmb_shader all = shader;
    all.by_materials = true;
    const lmb_vec3 eye = {0, 1.5f, 1}, ahead = {0, 0, -1};
    const double stored = (double)shade_ray(&all, SOURCE_PROBES, eye, ahead).c[1];
    const double traced = (double)shade_ray(&all, SOURCE_REFERENCE, eye, ahead).c[1];
    CHECK(stored > 2.02 && stored < 2.2, "by their materials they do: %g", stored);
    CHECK_NEAR(stored / traced, 1.0, 0.03, "by probes as by rays");
    if (opened == LMB_OK) {
        render_object_close(&sphere);
    }
    constant_volume_close(&light);
    level_fixture_close(&level);
}

/* Down the middle of a wall, from the middle of the room: squares of half a metre, or no lightmap at all. */
static void density_shows_texels(void)
{
    lmb_error error = {""};
    level_fixture level;
    constant_volume light;
    const char *path = OUTPUT("density.glb");
    const lmb_result written = lmb_level_furnace(path, 4.0f, 0.5f, (lmb_rgb){{1, 1, 1}}, false, &error);
    if (!level_fixture_open(&level, path, written, &error, 2)) {
        return;
    }
    lmb_lightmap *lightmap = NULL;
    const lmb_lightmap_settings settings = {.texels_per_m = 2.0f, .max_image_size = 256};
    CHECK(lmb_lightmap_create(level.scene, &settings, &lightmap, &error) == LMB_OK, "%s", error.message);
    if (lightmap && constant_volume_make(level.scene, (lmb_rgb){{1, 1, 1}}, &light)) {
        const lmb_shader shader = {
            .transport = &level.transport, .volume = light.volume, .lightmap = lightmap, .default_texel = 0.1f};
        const lmb_camera camera = camera_look_at((lmb_vec3){0, 0, 1}, (lmb_vec3){0.1f, 0, -2}, 60.0f);
        static float rgb[3 * WIDTH * HEIGHT];
        double mean = 0.0;
        int changes = 0;
        if (draw(&level, &shader, camera, RENDER_DENSITY, rgb, &mean)) {
            for (int y = 1; y < HEIGHT; ++y) {
                const float above = rgb[3 * (20 + WIDTH * (y - 1))], here = rgb[3 * (20 + WIDTH * y)];
                changes += (above > 0.5f) != (here > 0.5f);
            }
        }
        /* 3.46 m of wall are seen. */
        CHECK(changes >= 5 && changes <= 8, "%d changes down a wall", changes);
        lightmap->region[0].image = -1;
        CHECK(draw(&level, &shader, camera, RENDER_DENSITY, rgb, &mean), "draws");
        CHECK_NEAR(rgb[3 * (20 + WIDTH * 15)], 0.5, 1e-6, "red without a lightmap");
        CHECK_NEAR(rgb[3 * (20 + WIDTH * 15) + 1], 0.1, 1e-6, "red without a lightmap");
        constant_volume_close(&light);
    }
    lmb_lightmap_destroy(lightmap);
    level_fixture_close(&level);
}

/* A volume that is 10 % brighter than the furnace that the lightmap is of. */
static void mismatch_is_relative(void)
{
    lmb_error error = {""};
    level_fixture level;
    constant_volume light;
    const char *path = OUTPUT("mismatch.glb");
    const lmb_result written = lmb_level_furnace(path, 4.0f, 0.5f, (lmb_rgb){{0.5f, 0.5f, 0.5f}}, false, &error);
    if (!level_fixture_open(&level, path, written, &error, 2)) {
        return;
    }
    lmb_lightmap *lightmap = NULL;
    lmb_gather_stats stats;
    const lmb_lightmap_settings settings = {.texels_per_m = 2.0f, .max_image_size = 256};
    CHECK(lmb_lightmap_create(level.scene, &settings, &lightmap, &error) == LMB_OK &&
              lmb_lightmap_bake(lightmap, &level.transport, &(lmb_gather_effort){.samples = 256}, level.pool, NULL,
                                &stats) == LMB_OK,
          "%s", error.message);
    if (lightmap && constant_volume_make(level.scene, (lmb_rgb){{1.1f, 1.1f, 1.1f}}, &light)) {
        const lmb_shader shader = {
            .transport = &level.transport, .volume = light.volume, .lightmap = lightmap, .default_texel = 0.1f};
        const lmb_camera camera = camera_look_at((lmb_vec3){0, 0, 1}, (lmb_vec3){0.1f, 0, -2}, 60.0f);
        static float rgb[3 * WIDTH * HEIGHT];
        double mean = 0.0, sum = 0.0;
        CHECK(draw(&level, &shader, camera, RENDER_MISMATCH, rgb, &mean), "draws");
        for (int i = 0; i < 3 * WIDTH * HEIGHT; ++i) {
            sum += (double)rgb[i] / (3 * WIDTH * HEIGHT);
        }
        CHECK_NEAR(sum, 0.1, 0.01, "mean mismatch");
        constant_volume_close(&light);
    }
    lmb_lightmap_destroy(lightmap);
    level_fixture_close(&level);
}

/* A pane of half opacity in front of a glowing box lets half of it through, over black. */
static lmb_result write_pane(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    add_box(builder, "box", add_glow(builder, 1, 1, 1), (lmb_vec3){0, 0, -3});
    lmb_level_material material = lmb_level_material_default();
    material.base_color = (lmb_rgb){{0, 0, 0}};
    material.alpha_mode = LMB_LEVEL_BLEND;
    material.alpha = 0.75f;
    const int mesh = lmb_level_builder_add_mesh(builder, "pane");
    lmb_level_builder_add_quad(builder, mesh, lmb_level_builder_add_material(builder, &material), (lmb_vec3){-5, -5, 0},
                               (lmb_vec3){10, 0, 0}, (lmb_vec3){0, 10, 0});
    lmb_level_builder_place(builder, "pane", mesh, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void panes_let_light_through(void)
{
    lmb_error error = {""};
    level_fixture level;
    constant_volume light;
    const char *path = OUTPUT("pane.glb");
    if (!level_fixture_open(&level, path, write_pane(path, &error), &error, 1)) {
        return;
    }
    if (!constant_volume_make(level.scene, (lmb_rgb){{0, 0, 0}}, &light)) {
        level_fixture_close(&level);
        return;
    }
    const lmb_shader shader = {.transport = &level.transport, .volume = light.volume, .default_texel = 0.1f};
    const lmb_rgb seen = shade_ray(&shader, SOURCE_STORED, (lmb_vec3){0, 0, 5}, (lmb_vec3){0, 0, -1});
    const lmb_rgb beside = shade_ray(&shader, SOURCE_STORED, (lmb_vec3){2, 0, 5}, (lmb_vec3){0, 0, -1});
    CHECK_NEAR(seen.c[1], 0.25, 1e-5, "through the pane");
    CHECK_NEAR(beside.c[1], 0.0, 1e-6, "beside the box: a black sky");
    constant_volume_close(&light);
    level_fixture_close(&level);
}

static void default_camera_stands_inside_a_room(void)
{
    lmb_error error = {""};
    level_fixture level;
    const char *path = OUTPUT("cornell.glb");
    if (!level_fixture_open(&level, path, lmb_level_cornell(path, &error), &error, 1)) {
        return;
    }
    const lmb_camera camera = camera_default(level.tracer, 60.0f);
    const lmb_vec3 low = level.scene->bounds_min, high = level.scene->bounds_max;
    CHECK(camera.position.x > low.x && camera.position.x < high.x && camera.position.y > low.y &&
              camera.position.y < high.y,
          "at %g %g %g", (double)camera.position.x, (double)camera.position.y, (double)camera.position.z);
    lmb_hit hit;
    CHECK(lmb_trace_nearest(level.tracer, camera.position, camera.forward, 0.0f, FLT_MAX, &hit), "sees the level");
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"camera_rays_hit_the_expected_pixels", camera_rays_hit_the_expected_pixels},
    {"camera_frame_is_right_handed_everywhere", camera_frame_is_right_handed_everywhere},
    {"tone_curve_rises_to_white", tone_curve_rises_to_white},
    {"srgb_bytes_round_trip", srgb_bytes_round_trip},
    {"exposure_brings_the_log_average_to_middle_grey", exposure_brings_the_log_average_to_middle_grey},
    {"difference_colours", difference_colours},
    {"axes_appear_where_they_should", axes_appear_where_they_should},
    {"furnace_looks_the_same_everywhere", furnace_looks_the_same_everywhere},
    {"half vectors keep what the lobe keeps", half_vectors_keep_what_the_lobe_keeps},
    {"half vectors respond as they are picked", half_vectors_respond_as_they_are_picked},
    {"objects reflect", objects_reflect},
    {"density shows texels", density_shows_texels},
    {"mismatch is relative", mismatch_is_relative},
    {"panes_let_light_through", panes_let_light_through},
    {"default_camera_stands_inside_a_room", default_camera_stands_inside_a_room},
};

TEST_MAIN(cases)
