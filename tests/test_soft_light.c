/* Suns with an angle and lamps with a radius, against what discs and spheres give by analysis. */
#include <stdlib.h>

#include <lambent/surface_solve.h>

#include "floor_fixture.h"
#include "level_fixture.h"
#include "variates.h"

#define PI 3.14159265358979323846

static const lmb_vec3 up = {0, 1, 0};

/* A light and its extent. */
typedef struct soft_light {
    lmb_level_light light;
    float angle_deg, radius_m;
} soft_light;

static void light_add(lmb_level_builder *builder, const soft_light *soft, lmb_vec3 position, lmb_vec3 along)
{
    lmb_level_node node = lmb_level_node_default("light");
    node.light = lmb_level_builder_add_light(builder, &soft->light);
    node.angle_deg = soft->angle_deg;
    node.radius_m = soft->radius_m;
    node.translation = position;
    lmb_level_look_along(along, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

/* A black roof over x > 0 at a height. */
static void roof_add(lmb_level_builder *builder, float height)
{
    lmb_level_material black = lmb_level_material_default();
    black.base_color = (lmb_rgb){{0, 0, 0}};
    const int roof = lmb_level_builder_add_mesh(builder, "roof");
    lmb_level_builder_add_quad(builder, roof, lmb_level_builder_add_material(builder, &black),
                               (lmb_vec3){0, height, -50}, (lmb_vec3){50, 0, 0}, (lmb_vec3){0, 0, 100});
    lmb_level_builder_place(builder, "roof", roof, (lmb_vec3){0, 0, 0});
}

static bool floor_open(level_fixture *level, lmb_level_builder *builder)
{
    lmb_error error = {{0}};
    const char *path = LMB_TEST_OUTPUT_DIR "/soft.glb";
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 1);
}

static soft_light sun_of(float lux, float angle_deg)
{
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1, 1, 1}}, .intensity = lux};
    return (soft_light){.light = sun, .angle_deg = angle_deg};
}

static soft_light lamp_of(float candela, float radius_m)
{
    const lmb_level_light lamp = {
        .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1, 1, 1}}, .intensity = candela};
    return (soft_light){.light = lamp, .radius_m = radius_m};
}

/* Share of a disc overhead, of sine `s`, that is seen past the edge of a half plane in direction (k, 1, 0): by area of
 * its shadow on the floor, which is what irradiance counts. Its edge is a great circle, an ellipse in the shadow. */
static double share_before_edge(double s, double k)
{
    enum { STEPS = 20000 };
    double area = 0.0;
    for (int i = 0; i < STEPS; ++i) {
        const double z = s * (2.0 * (i + 0.5) / STEPS - 1.0);
        const double half = sqrt(s * s - z * z);
        const double edge = k * sqrt((1.0 - z * z) / (1.0 + k * k));
        area += (fmin(fmax(edge, -half), half) + half) * 2.0 * s / STEPS;
    }
    return area / (PI * s * s);
}

/* A sun overhead, a roof over one half of the floor: in the penumbra counts the disc's segment that is seen. */
static void penumbra_is_a_segment(void)
{
    static const float angles[] = {0.53f, 10.0f, 60.0f};
    for (size_t a = 0; a < sizeof angles / sizeof angles[0]; ++a) {
        lmb_level_builder *builder = floor_begin(0.0f, 50);
        const soft_light sun = sun_of(7.0f, angles[a]);
        roof_add(builder, 2.0f);
        light_add(builder, &sun, (lmb_vec3){0, 0, 0}, (lmb_vec3){0, -1, 0});
        level_fixture level;
        if (!floor_open(&level, builder)) {
            return;
        }
        const double half = 0.5 * (double)angles[a] * PI / 180.0;
        for (int i = -5; i <= 5; ++i) {
            const double x = 0.25 * i * 2.0 * tan(half);
            const double expected = 7.0 / PI * share_before_edge(sin(half), -x / 2.0);
            const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){(float)x, 1e-5f, 0}, up, 16384);
            CHECK_NEAR(found.c[1], expected, 0.01, "%g degrees, at %g", (double)angles[a], x);
        }
        level_fixture_close(&level);
    }
}

/* What a disc of radiance 1 about (cos e, sin e, 0) gives the floor, by a sum over it. */
static double disc_irradiance(double elevation, double half)
{
    enum { RINGS = 400, PARTS = 800 };
    double sum = 0.0;
    for (int i = 0; i < RINGS; ++i) {
        const double theta = half * (i + 0.5) / RINGS;
        for (int k = 0; k < PARTS; ++k) {
            const double phi = 2.0 * PI * (k + 0.5) / PARTS;
            const double y = cos(theta) * sin(elevation) + sin(theta) * sin(phi) * cos(elevation);
            sum += fmax(y, 0.0) * sin(theta);
        }
    }
    return sum * half / RINGS * 2.0 * PI / PARTS;
}

/* Above the horizon a disc gives the lux times the sine of its elevation; on it, half a disc; from below, its rim. */
static void suns_set(void)
{
    static const struct {
        float elevation_deg, angle_deg;
    } suns[] = {{90, 0.53f}, {90, 180}, {30, 20}, {30, 60}, {10, 40}, {0, 20}, {-5, 20}, {-9.5f, 20}, {-10.5f, 20}};
    for (size_t k = 0; k < sizeof suns / sizeof suns[0]; ++k) {
        lmb_level_builder *builder = floor_begin(0.0f, 50);
        const double elevation = (double)suns[k].elevation_deg * PI / 180.0;
        const double half = 0.5 * (double)suns[k].angle_deg * PI / 180.0;
        const soft_light sun = sun_of(10.0f, suns[k].angle_deg);
        light_add(builder, &sun, (lmb_vec3){0, 0, 0}, (lmb_vec3){-(float)cos(elevation), -(float)sin(elevation), 0});
        level_fixture level;
        if (!floor_open(&level, builder)) {
            return;
        }
        double expected = 10.0 / (PI * sin(half) * sin(half)) * disc_irradiance(elevation, half);
        if (elevation >= half) {
            expected = 10.0 * sin(elevation);
        } else if (elevation >= 0.0 && elevation <= 0.0) {
            expected = 10.0 * (half - sin(half) * cos(half)) / (PI * sin(half) * sin(half));
        }
        const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){0, 1e-5f, 0}, up, 16384);
        CHECK_NEAR(found.c[0], expected / PI, 3e-3 * expected / PI + 2e-5, "%g degrees at %g",
                   (double)suns[k].angle_deg, (double)suns[k].elevation_deg);
        level_fixture_close(&level);
    }
}

/* Above the horizon a sphere gives what its middle would: E = pi L (r/d)^2 cos = I cos / d^2. Half of it, half. */
static void spheres_give_their_candela(void)
{
    static const struct {
        float radius, x;
        bool roofed;
    } lamps[] = {{0.01f, 0, false},   {0.5f, 0, false}, {1.9f, 0, false}, {0.5f, 1.5f, false},
                 {1.5f, 2.0f, false}, {0.3f, 0, true},  {1.0f, 0, true}};
    for (size_t k = 0; k < sizeof lamps / sizeof lamps[0]; ++k) {
        lmb_level_builder *builder = floor_begin(0.0f, 50);
        const soft_light lamp = lamp_of(5.0f, lamps[k].radius);
        light_add(builder, &lamp, (lmb_vec3){0, 2, 0}, (lmb_vec3){0, -1, 0});
        if (lamps[k].roofed) {
            roof_add(builder, 0.5f);
        }
        level_fixture level;
        if (!floor_open(&level, builder)) {
            return;
        }
        const double x = (double)lamps[k].x;
        const double expected = 5.0 * 2.0 / pow(4.0 + x * x, 1.5) * (lamps[k].roofed ? 0.5 : 1.0) / PI;
        const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){lamps[k].x, 1e-5f, 0}, up, 16384);
        CHECK_NEAR(found.c[2], expected, 3e-3 * expected, "radius %g, %g aside", (double)lamps[k].radius, x);
        level_fixture_close(&level);
    }
}

/* A lamp that reaches through the floor: inside, light comes from all around with I / (pi r^2); outside, from what is
 * above the floor. Nothing is more than that. */
static void lamps_may_be_larger_than_their_distance(void)
{
    const double radius = 0.5, height = 0.3, candela = 2.0;
    const double radiance = candela / (PI * radius * radius);
    lmb_level_builder *builder = floor_begin(0.0f, 50);
    const soft_light lamp = lamp_of((float)candela, (float)radius);
    light_add(builder, &lamp, (lmb_vec3){0, (float)height, 0}, (lmb_vec3){0, -1, 0});
    level_fixture level;
    if (!floor_open(&level, builder)) {
        return;
    }
    static const float positions[] = {0.0f, 0.2f, 0.39f, 0.41f, 0.6f, 2.0f};
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
        const double x = (double)positions[i], distance = sqrt(x * x + height * height);
        const bool inside = distance < radius;
        const double expected =
            inside ? radiance : radiance * disc_irradiance(asin(height / distance), asin(radius / distance)) / PI;
        const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){positions[i], 1e-5f, 0}, up, 32768);
        CHECK_NEAR(found.c[0], expected, 5e-3 * expected, "at %g", x);
    }
    /* A probe in the very middle, and one beside it. */
    for (int i = 0; i < 2; ++i) {
        const lmb_gather_point point = {.position = {0.1f * (float)i, (float)height, 0}};
        lmb_gathered gathered;
        lmb_gather_sh3(&level.transport, &point, 16384, &gathered);
        const double l00 = (double)gathered.moments.channel[0].c[0];
        CHECK(l00 > 0.5 * radiance * 2.0 * sqrt(PI) && l00 <= 1.001 * radiance * 2.0 * sqrt(PI), "probe %d: %g", i,
              l00);
    }
    level_fixture_close(&level);
}

/* The cones of a spot are about its middle, its range from there. */
static void spots_and_ranges_hold_from_the_middle(void)
{
    static const struct {
        float x, share;
    } positions[] = {{0, 1}, {0.5f, 1}, {2.2f, 0}};
    lmb_level_builder *builder = floor_begin(0.0f, 50);
    soft_light spot = lamp_of(5.0f, 0.2f);
    spot.light.type = LMB_LEVEL_LIGHT_SPOT;
    spot.light.inner_angle_rad = 0.6f;
    spot.light.outer_angle_rad = 0.8f;
    spot.light.range_m = 4.0f;
    light_add(builder, &spot, (lmb_vec3){0, 2, 0}, (lmb_vec3){0, -1, 0});
    level_fixture level;
    if (!floor_open(&level, builder)) {
        return;
    }
    for (size_t i = 0; i < sizeof positions / sizeof positions[0]; ++i) {
        const double squared = 4.0 + (double)(positions[i].x * positions[i].x);
        const double window = 1.0 - squared * squared / 256.0;
        const double expected = (double)positions[i].share * window * 5.0 * 2.0 / pow(squared, 1.5) / PI;
        const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){positions[i].x, 1e-5f, 0}, up, 4096);
        CHECK_NEAR(found.c[0], expected, 5e-3 * expected, "at %g", (double)positions[i].x);
    }
    level_fixture_close(&level);
}

/* Many soft lights, hard ones among them: their sum, whether looked at whole or drawn. */
static void soft_lights_add_up(void)
{
    static const int counts[] = {1, 5, 16, 40};
    for (size_t k = 0; k < sizeof counts / sizeof counts[0]; ++k) {
        lmb_level_builder *builder = floor_begin(0.0f, 50);
        uint64_t state = 5;
        double expected = 0.0;
        for (int i = 0; i < counts[k]; ++i) {
            const lmb_vec3 position = {(float)(8.0 * variate_next(&state) - 4.0), (float)(1.0 + variate_next(&state)),
                                       (float)(8.0 * variate_next(&state) - 4.0)};
            const soft_light lamp =
                lamp_of((float)(1.0 + 20.0 * variate_next(&state)), i % 4 ? (float)variate_next(&state) : 0.0f);
            light_add(builder, &lamp, position, (lmb_vec3){0, -1, 0});
            const double squared = (double)position.x * (double)position.x + (double)position.y * (double)position.y +
                                   (double)position.z * (double)position.z;
            expected += (double)lamp.light.intensity * (double)position.y / pow(squared, 1.5) / PI;
            const soft_light sun = sun_of((float)(0.5 + variate_next(&state)), i % 3 ? 20.0f : 0.0f);
            const double elevation = 0.3 + 1.2 * variate_next(&state);
            light_add(builder, &sun, (lmb_vec3){0, 0, 0},
                      (lmb_vec3){-(float)cos(elevation), -(float)sin(elevation), 0});
            expected += (double)sun.light.intensity * sin(elevation) / PI;
        }
        level_fixture level;
        if (!floor_open(&level, builder)) {
            return;
        }
        const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){0, 1e-4f, 0}, up, 16384);
        CHECK_NEAR(found.c[1], expected, (counts[k] > 16 ? 0.02 : 5e-3) * expected, "%d of each", counts[k]);
        level_fixture_close(&level);
    }
}

/* However few are asked for, the mean over choices and points is the sum over all lights. */
static void few_stand_for_all(void)
{
    enum { TRIES = 100000, LIGHTS = 40 };
    lmb_level_builder *builder = floor_begin(0.0f, 50);
    uint64_t state = 11;
    double expected = 0.0;
    for (int i = 0; i < LIGHTS; ++i) {
        const lmb_vec3 position = {(float)(6.0 * variate_next(&state) - 3.0), 1.5f,
                                   (float)(6.0 * variate_next(&state) - 3.0)};
        const soft_light lamp = lamp_of(1.0f + (float)(i % 7), 0.1f * (float)(i % 10));
        light_add(builder, &lamp, position, (lmb_vec3){0, -1, 0});
        const double squared = 2.25 + (double)position.x * (double)position.x + (double)position.z * (double)position.z;
        expected += (double)lamp.light.intensity * 1.5 / pow(squared, 1.5);
    }
    level_fixture level;
    if (!floor_open(&level, builder)) {
        return;
    }
    CHECK(lmb_emitters_punctual_are_soft(level.emitters, false) &&
              !lmb_emitters_punctual_are_few(level.emitters, false),
          "soft");
    double sum = 0.0, squares = 0.0;
    for (int t = 0; t < TRIES; ++t) {
        const float choice[2] = {(float)variate_next(&state), (float)variate_next(&state)};
        const lmb_punctual_query query = {.normal = &up,
                                          .point = {(float)variate_next(&state), (float)variate_next(&state)}};
        lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX];
        const int count = lmb_emitters_punctual(level.emitters, &query, choice, 1, sample);
        const double found =
            count > 0 ? (double)sample[0].irradiance.c[0] * fmax((double)sample[0].direction.y, 0.0) : 0.0;
        sum += found / TRIES;
        squares += found * found / TRIES;
    }
    CHECK_NEAR(sum, expected, 4.0 * sqrt((squares - sum * sum) / TRIES), "one of %d", LIGHTS);
    level_fixture_close(&level);
}

/* A floor in penumbra, seen from above: both estimators find what a sum over it gives. */
static void both_estimators_reflect_penumbrae(void)
{
    lmb_level_builder *builder = floor_begin(0.5f, 50);
    const soft_light sun = sun_of(4.0f, 30.0f), lamp = lamp_of(3.0f, 0.4f);
    light_add(builder, &sun, (lmb_vec3){0, 0, 0}, (lmb_vec3){0.5f, -1, 0});
    light_add(builder, &lamp, (lmb_vec3){0.5f, 1, 0}, (lmb_vec3){0, -1, 0});
    roof_add(builder, 2.0f);
    level_fixture level;
    if (!floor_open(&level, builder)) {
        return;
    }
    const lmb_vec3 position = {0.2f, 0.3f, 0.1f}, down = {0, -1, 0};
    const lmb_rgb traced = traced_irradiance(&level, position, down, 65536);
    lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    settings.samples = 64;
    lmb_surface_light *light = NULL;
    lmb_surface_light_stats stats;
    lmb_error error = {{0}};
    CHECK(lmb_surface_light_solve(&level.transport, &settings, level.pool, &light, &stats, &error) == LMB_OK, "%s",
          error.message);
    level.transport.surface = light;
    const lmb_rgb cached = traced_irradiance(&level, position, down, 65536);
    CHECK(traced.c[0] > 0.1f, "%g", (double)traced.c[0]);
    CHECK_NEAR(cached.c[0], traced.c[0], 0.01 * (double)traced.c[0], "cached");
    lmb_surface_light_destroy(light);
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"penumbra_is_a_segment", penumbra_is_a_segment},
    {"suns_set", suns_set},
    {"spheres_give_their_candela", spheres_give_their_candela},
    {"lamps_may_be_larger_than_their_distance", lamps_may_be_larger_than_their_distance},
    {"spots_and_ranges_hold_from_the_middle", spots_and_ranges_hold_from_the_middle},
    {"soft_lights_add_up", soft_lights_add_up},
    {"few_stand_for_all", few_stand_for_all},
    {"both_estimators_reflect_penumbrae", both_estimators_reflect_penumbrae},
};

TEST_MAIN(cases)
