/* Choosing among many lights: what is chosen, how often, and that sums over choices are sums over lights. */
#include <math.h>
#include <stdlib.h>

#include "harness.h"
#include "light/light_tree.h"
#include "scenes/level_builder.h"
#include "level_fixture.h"
#include "variates.h"

#define PI 3.14159265358979323846

enum { MOST = 1000, CHOICES = 200000 };

static lmb_vec3 direction_next(uint64_t *state)
{
    const double y = 2.0 * variate_next(state) - 1.0;
    const double turn = 2.0 * PI * variate_next(state);
    const double r = sqrt(1.0 - y * y);
    return (lmb_vec3){(float)(r * cos(turn)), (float)y, (float)(r * sin(turn))};
}

typedef enum lights_kind { PANELS, SPOTS, ONE_PLACE, LIGHTS_KINDS } lights_kind;

static void lights_make(lmb_light_bound *lights, int count, lights_kind kind)
{
    uint64_t state = 7;
    for (int i = 0; i < count; ++i) {
        const bool one_place = kind == ONE_PLACE;
        const float x = one_place ? 1.0f : (float)(20.0 * variate_next(&state));
        const float y = one_place ? 2.0f : (float)(3.0 * variate_next(&state));
        const float z = one_place ? 3.0f : (float)(20.0 * variate_next(&state));
        const float size = kind == PANELS ? (float)variate_next(&state) : 0.0f;
        lights[i] =
            (lmb_light_bound){.low = {x, y, z},
                              .high = {x + size, y + size, z + size},
                              .power = (float)pow(10.0, 4.0 * variate_next(&state) - 2.0),
                              .axis = direction_next(&state),
                              .cos_spread = kind == ONE_PLACE ? -1.0f : 1.0f,
                              .cos_reach = kind == SPOTS ? (float)variate_next(&state) : 0.0f,
                              .range = kind == SPOTS && i % 2 ? (float)(10.0 * variate_next(&state)) : INFINITY};
    }
}

/* Lights that even numbers choose, as often as their probabilities say, which sum to 1 and are never 0; a memo changes
 * nothing. */
static void tree_check(const lmb_light_tree *tree, const lmb_light_query *query, int count, const char *what)
{
    static double frequency[MOST];
    lmb_light_query plain = *query;
    plain.memo = NULL;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        const double probability = lmb_light_tree_probability(tree, query, (uint32_t)i);
        CHECK(probability >= 0.1 / count * 0.999 && probability <= 1.0 + 1e-12, "%s: %d of %d: %g", what, i, count,
              probability);
        CHECK_NEAR(probability, lmb_light_tree_probability(tree, &plain, (uint32_t)i), 0.0, "%s: light %d", what, i);
        sum += probability;
        frequency[i] = 0.0;
    }
    CHECK_NEAR(sum, 1.0, 1e-9, "%s: %d lights", what, count);
    for (int i = 0; i < CHOICES; ++i) {
        double probability;
        const uint32_t light = lmb_light_tree_choose(tree, query, (i + 0.5) / CHOICES, &probability);
        frequency[light] += 1.0 / CHOICES;
        if (i % 1000 == 0) {
            CHECK_NEAR(probability, lmb_light_tree_probability(tree, query, light), 1e-9 * probability, "%s: light %u",
                       what, light);
        }
    }
    /* A light's numbers are two runs, one of the even tenth: each may count one more or less at either end. */
    for (int i = 0; i < count; ++i) {
        const double probability = lmb_light_tree_probability(tree, query, (uint32_t)i);
        CHECK_NEAR(frequency[i], probability, 4.0 / CHOICES, "%s: light %d of %d", what, i, count);
    }
}

static void choices_have_their_probabilities(void)
{
    static const int counts[] = {1, 2, 3, 17, MOST};
    static const lmb_vec3 positions[] = {{0, 0, 0}, {10, 1, 10}, {1, 2, 3}, {1e6f, 0, 0}};
    static const char *const names[LIGHTS_KINDS] = {"panels", "spots", "one place"};
    static lmb_light_bound lights[MOST];
    const lmb_vec3 up = {0.0f, 1.0f, 0.0f};
    for (size_t k = 0; k < LIGHTS_KINDS * sizeof counts / sizeof counts[0]; ++k) {
        const int count = counts[k / LIGHTS_KINDS];
        const lights_kind kind = (lights_kind)(k % LIGHTS_KINDS);
        lights_make(lights, count, kind);
        lmb_light_tree *tree = NULL;
        CHECK(lmb_light_tree_create(lights, (uint32_t)count, kind == PANELS, &tree) == LMB_OK, "%d lights", count);
        for (size_t p = 0; p < sizeof positions / sizeof positions[0] && tree; ++p) {
            const lmb_light_query in_space = {.position = positions[p]};
            lmb_light_memo memo = {.node = {0}};
            const lmb_light_query on_surface = {positions[p], &up, 0.5f, &memo};
            tree_check(tree, &in_space, count, names[kind]);
            tree_check(tree, &on_surface, count, names[kind]);
        }
        lmb_light_tree_destroy(tree);
    }
}

/* Whether a light can give a point anything, by its own definition. */
static bool light_gives(const lmb_light_bound *light, const lmb_light_query *query)
{
    const double x = (double)light->low.x - (double)query->position.x;
    const double y = (double)light->low.y - (double)query->position.y;
    const double z = (double)light->low.z - (double)query->position.z;
    const double distance = sqrt(x * x + y * y + z * z);
    const lmb_vec3 axis = light->axis, *n = query->normal;
    const double down = -(x * (double)axis.x + y * (double)axis.y + z * (double)axis.z) / distance;
    const double up = n ? x * (double)n->x + y * (double)n->y + z * (double)n->z : 1.0;
    return distance < (double)light->range && down > (double)light->cos_reach && up > 0.0;
}

/* Clusters share out all lights that can give anything, each to one cluster. */
static void clusters_leave_none_out(void)
{
    static lmb_light_bound lights[MOST];
    lights_make(lights, MOST, SPOTS);
    lmb_light_tree *tree = NULL;
    CHECK(lmb_light_tree_create(lights, MOST, false, &tree) == LMB_OK, "no tree");
    uint64_t state = 5;
    int giving = 0;
    for (int q = 0; q < 4000 && tree; ++q) {
        const lmb_vec3 normal = direction_next(&state);
        const lmb_light_query query = {{(float)(20.0 * variate_next(&state)), (float)(3.0 * variate_next(&state)),
                                        (float)(20.0 * variate_next(&state))},
                                       q % 2 ? &normal : NULL,
                                       0.0f,
                                       NULL};
        uint32_t cluster[LMB_LIGHT_CLUSTERS];
        const int max = 1 + q % LMB_LIGHT_CLUSTERS;
        const int count = lmb_light_tree_split(tree, &query, max, cluster);
        CHECK(count <= max, "%d of %d clusters", count, max);
        static int held[MOST];
        memset(held, 0, sizeof held);
        for (int k = 0; k < count; ++k) {
            const uint32_t *light;
            const uint32_t lights_in = lmb_light_tree_cluster(tree, cluster[k], &light);
            for (uint32_t i = 0; i < lights_in; ++i) {
                ++held[light[i]];
            }
        }
        for (int i = 0; i < MOST; ++i) {
            const bool gives = light_gives(&lights[i], &query);
            giving += gives;
            CHECK(held[i] == 1 || (held[i] == 0 && !gives), "query %d: light %d is in %d clusters", q, i, held[i]);
        }
    }
    CHECK(giving > 1000, "only %d lights gave anything", giving);
    lmb_light_tree_destroy(tree);
}

/* What is near, or shines this way, is chosen more often than by power alone. */
static void better_lights_come_first(void)
{
    lmb_light_bound lights[2] = {
        {.power = 1.0f, .axis = {0, 1, 0}, .cos_spread = -1.0f, .cos_reach = -1.0f, .range = INFINITY},
        {.low = {10, 0, 0},
         .high = {10, 0, 0},
         .power = 1.0f,
         .axis = {0, 1, 0},
         .cos_spread = -1.0f,
         .cos_reach = -1.0f,
         .range = INFINITY}};
    lmb_light_tree *tree = NULL;
    CHECK(lmb_light_tree_create(lights, 2, false, &tree) == LMB_OK, "two lights");
    /* By inverse squares 81 : 1, nine tenths of the time. */
    const lmb_light_query near = {.position = {1, 0, 0}};
    const lmb_light_query between = {.position = {5, 0, 0}};
    const lmb_vec3 away = {1, 0, 0};
    const lmb_light_query turned = {.position = {1, 0, 0}, .normal = &away};
    CHECK_NEAR(lmb_light_tree_probability(tree, &near, 0), 0.9 * 81.0 / 82.0 + 0.05, 1e-6, "near");
    CHECK_NEAR(lmb_light_tree_probability(tree, &between, 0), 0.5, 1e-6, "between");
    CHECK_NEAR(lmb_light_tree_probability(tree, &turned, 0), 0.05, 1e-6, "behind the surface");
    lmb_light_tree_destroy(tree);
    lights[0].cos_spread = 1.0f;
    lights[0].cos_reach = 0.0f;
    CHECK(lmb_light_tree_create(lights, 2, false, &tree) == LMB_OK, "a spot");
    const lmb_light_query below = {.position = {1, -1, 0}};
    CHECK_NEAR(lmb_light_tree_probability(tree, &below, 0), 0.05, 1e-6, "behind the spot");
    lmb_light_tree_destroy(tree);
    CHECK(lmb_light_tree_create(NULL, 0, false, &tree) == LMB_OK && !tree, "no lights have no tree");
}

/* Just above the floor. */
#define PROBE_HEIGHT 1e-4

/* A probe above the floor of punctual_lights_add_up: few lamps leave no noise. */
static void probe_check(const level_fixture *level, double expected, int lamps)
{
    enum { SAMPLES = 8 };
    const lmb_gather_point point = {.position = {0, (float)PROBE_HEIGHT, 0}};
    lmb_gathered found;
    lmb_gather_sh3(&level->transport, &point, SAMPLES, &found);
    const double mean = (double)found.moments.channel[1].c[0] * sqrt(4.0 * PI);
    CHECK_NEAR(mean, expected, 1e-5 * expected, "%d lamps at a probe", lamps);
    CHECK(found.squared_error <= 0.0, "%d lamps: %g", lamps, found.squared_error);
    CHECK(found.rays == (uint64_t)(lamps + SAMPLES), "%d lamps: %llu rays", lamps, (unsigned long long)found.rays);
}

/* A floor under `count` lamps, none of them shadowed: E by lights summed one by one. */
static void punctual_lights_add_up(void)
{
    static const int counts[] = {1, 3, 16, 17, 300};
    for (size_t k = 0; k < sizeof counts / sizeof counts[0]; ++k) {
        lmb_level_builder *builder = lmb_level_builder_create(0.1f);
        lmb_level_material black = lmb_level_material_default();
        black.base_color = (lmb_rgb){{0, 0, 0}};
        const int material = lmb_level_builder_add_material(builder, &black);
        const int floor = lmb_level_builder_add_mesh(builder, "floor");
        lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-50, 0, 50}, (lmb_vec3){100, 0, 0},
                                   (lmb_vec3){0, 0, -100});
        lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
        uint64_t state = 3;
        double expected = 0.0;
        double expected_at_probe = 0.0; /* without cosines */
        for (int i = 0; i < counts[k]; ++i) {
            const lmb_vec3 position = {(float)(40.0 * variate_next(&state) - 20.0), (float)(1.0 + variate_next(&state)),
                                       (float)(40.0 * variate_next(&state) - 20.0)};
            const lmb_level_light lamp = {.name = "lamp",
                                          .type = LMB_LEVEL_LIGHT_POINT,
                                          .color = {{1, 1, 1}},
                                          .intensity = (float)(1.0 + 20.0 * variate_next(&state))};
            lmb_level_node node = lmb_level_node_default("lamp");
            node.light = lmb_level_builder_add_light(builder, &lamp);
            node.translation = position;
            lmb_level_builder_add_node(builder, &node);
            const double squared = (double)position.x * (double)position.x + (double)position.y * (double)position.y +
                                   (double)position.z * (double)position.z;
            expected += (double)lamp.intensity * (double)position.y / pow(squared, 1.5) / PI;
            const double up = (double)position.y - PROBE_HEIGHT;
            expected_at_probe += (double)lamp.intensity / (squared - (double)position.y * (double)position.y + up * up);
        }
        lmb_error error;
        const char *path = LMB_TEST_OUTPUT_DIR "/many_lamps.glb";
        const lmb_result written = lmb_level_builder_write(builder, path, &error);
        lmb_level_builder_destroy(builder);
        level_fixture level;
        if (!level_fixture_open(&level, path, written, &error, 1)) {
            return;
        }
        const lmb_rgb found = traced_irradiance(&level, (lmb_vec3){0, 1e-4f, 0}, (lmb_vec3){0, 1, 0}, 4096);
        const double tolerance = counts[k] <= 16 ? 1e-3 : 0.02; /* looked at whole, or drawn */
        CHECK_NEAR(found.c[1], expected, tolerance * expected, "%d lamps", counts[k]);
        if (counts[k] <= LMB_PUNCTUAL_MAX) {
            probe_check(&level, expected_at_probe, counts[k]);
        }
        level_fixture_close(&level);
    }
}

/* What one lamp gives a white surface of this normal (or a small sphere), by KHR_lights_punctual. */
static double lamp_light(const lmb_light *light, lmb_vec3 position, const lmb_vec3 *normal)
{
    const double x = (double)light->position.x - (double)position.x;
    const double y = (double)light->position.y - (double)position.y;
    const double z = (double)light->position.z - (double)position.z;
    const double squared = x * x + y * y + z * z, distance = sqrt(squared);
    double factor = 1.0 / squared;
    if (light->range > 0.0f) {
        factor *= fmax(0.0, fmin(1.0, 1.0 - pow(distance / (double)light->range, 4.0)));
    }
    if (light->type == LMB_LIGHT_SPOT) {
        const lmb_vec3 d = light->direction;
        const double cosine = -(x * (double)d.x + y * (double)d.y + z * (double)d.z) / distance;
        const double scale = 1.0 / fmax(0.001, (double)light->cos_inner - (double)light->cos_outer);
        const double fall = fmax(0.0, fmin(1.0, (cosine - (double)light->cos_outer) * scale));
        factor *= fall * fall;
    }
    if (normal) {
        factor *= fmax(0.0, x * (double)normal->x + y * (double)normal->y + z * (double)normal->z) / distance;
    }
    return (double)light->intensity.c[1] * factor;
}

/* 300 lamps and spots, half of them with a range, over a speck of floor. */
static bool lamps_open(level_fixture *level)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material grey = lmb_level_material_default();
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, lmb_level_builder_add_material(builder, &grey), (lmb_vec3){0, -9, 0},
                               (lmb_vec3){1, 0, 0}, (lmb_vec3){0, 0, -1});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    uint64_t state = 3;
    for (int i = 0; i < 300; ++i) {
        const lmb_level_light lamp = {.name = "lamp",
                                      .type = i % 3 ? LMB_LEVEL_LIGHT_POINT : LMB_LEVEL_LIGHT_SPOT,
                                      .color = {{1, 1, 1}},
                                      .intensity = (float)pow(10.0, 2.0 * variate_next(&state)),
                                      .range_m = i % 2 ? 4.0f : 0.0f,
                                      .inner_angle_rad = 0.2f,
                                      .outer_angle_rad = 0.9f};
        lmb_level_node node = lmb_level_node_default("lamp");
        node.light = lmb_level_builder_add_light(builder, &lamp);
        node.translation = (lmb_vec3){(float)(20.0 * variate_next(&state)), (float)(3.0 * variate_next(&state)),
                                      (float)(20.0 * variate_next(&state))};
        lmb_level_look_along(direction_next(&state), node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
    lmb_error error;
    const char *path = LMB_TEST_OUTPUT_DIR "/lamps.glb";
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    return level_fixture_open(level, path, written, &error, 1);
}

/* The expected sum over the samples is the sum over all lamps, however few are asked for. */
static void few_stand_for_all(void)
{
    enum { TRIES = 4096 };
    static const int most[] = {1, 4, LMB_PUNCTUAL_MAX};
    level_fixture level;
    if (!lamps_open(&level)) {
        return;
    }
    uint64_t state = 9;
    for (int q = 0; q < 60; ++q) {
        const lmb_vec3 normal = direction_next(&state);
        const lmb_punctual_query query = {
            .position = {(float)(20.0 * variate_next(&state)), 1.5f, (float)(20.0 * variate_next(&state))},
            .normal = q % 2 ? &normal : NULL};
        double expected = 0.0;
        for (uint32_t i = 0; i < level.scene->light_count; ++i) {
            expected += lamp_light(&level.scene->lights[i], query.position, query.normal);
        }
        const int max = most[q % 3];
        double sum = 0.0, squares = 0.0;
        for (int t = 0; t < TRIES; ++t) {
            const float choice[2] = {(float)variate_next(&state), (float)variate_next(&state)};
            lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX];
            const int count = lmb_emitters_punctual(level.emitters, &query, choice, max, sample);
            CHECK(count <= max, "%d of %d samples", count, max);
            double found = 0.0;
            for (int i = 0; i < count; ++i) {
                const lmb_vec3 d = sample[i].direction, n = normal;
                found += (double)sample[i].irradiance.c[1] *
                         (query.normal ? (double)(d.x * n.x + d.y * n.y + d.z * n.z) : 1.0);
            }
            sum += found / TRIES;
            squares += found * found / TRIES;
        }
        const double error = sqrt(fmax(squares - sum * sum, 0.0) / TRIES);
        CHECK_NEAR(sum, expected, 4.5 * error + 1e-5 * expected, "query %d, at most %d", q, max);
    }
    level_fixture_close(&level);
}

/* Irradiance over pi of an even triangle wholly above the horizon: Lambert's formula, a sum over its edges. */
static double triangle_light(const double corner[3][3], double radiance)
{
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        const double across[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        const double sine = sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
        sum += atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * across[1] / sine;
    }
    return radiance * fabs(sum) / (2.0 * PI);
}

/* A ceiling of 400 panels of many strengths: light on the floor below is the sum of the panels'. */
static void panels_add_up(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int ceiling = lmb_level_builder_add_mesh(builder, "ceiling");
    const lmb_vec3 position = {7.3f, 0.0f, 4.1f};
    uint64_t state = 21;
    double expected = 0.0;
    for (int i = 0; i < 400; ++i) {
        const float radiance = (float)pow(10.0, 2.0 * variate_next(&state));
        const float size = (float)(0.05 + 0.9 * variate_next(&state));
        const float x = (float)(i % 20), z = (float)(i / 20);
        lmb_level_material glow = lmb_level_material_default();
        glow.base_color = (lmb_rgb){{0, 0, 0}};
        glow.emission = (lmb_rgb){{radiance, radiance, radiance}};
        const lmb_vec3 corner[3] = {{x, 2.5f, z}, {x + size, 2.5f, z}, {x, 2.5f, z + size}};
        lmb_level_builder_add_triangle(builder, ceiling, lmb_level_builder_add_material(builder, &glow), corner[0],
                                       corner[1], corner[2]);
        double seen[3][3];
        for (int k = 0; k < 3; ++k) {
            seen[k][0] = (double)corner[k].x - (double)position.x;
            seen[k][1] = (double)corner[k].y - (double)position.y;
            seen[k][2] = (double)corner[k].z - (double)position.z;
        }
        expected += triangle_light((const double(*)[3])seen, (double)radiance);
    }
    lmb_level_builder_place(builder, "ceiling", ceiling, (lmb_vec3){0, 0, 0});
    lmb_error error;
    const char *path = LMB_TEST_OUTPUT_DIR "/panels.glb";
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    level_fixture level;
    if (!level_fixture_open(&level, path, written, &error, 1)) {
        return;
    }
    const lmb_rgb found = traced_irradiance(&level, position, (lmb_vec3){0, 1, 0}, 65536);
    CHECK_NEAR(found.c[1], expected, 0.003 * expected, "400 panels");

    /* The density of a sample is the one of the ray that finds it. */
    for (int i = 0; i < 1000; ++i) {
        const lmb_vec3 normal = direction_next(&state);
        const float point[2] = {(float)variate_next(&state), (float)variate_next(&state)};
        lmb_light_sample sample;
        lmb_hit hit;
        const lmb_triangle_query query = {position, &normal, NULL};
        const float choice = (float)variate_next(&state);
        const lmb_triangle_choices choices = {1, &position, &choice, &point[0], &point[1]};
        lmb_emitters_sample_triangles(level.emitters, &query, &choices, &sample);
        if (sample.density > 0.0f && lmb_trace_nearest(level.tracer, position, sample.direction, 0.0f, 1e30f, &hit)) {
            const float density = lmb_emitters_triangle_density(level.emitters, &query, &hit, sample.direction);
            CHECK_NEAR(density / sample.density, 1.0, 1e-4, "sample %d", i);
        }
    }
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"choices_have_their_probabilities", choices_have_their_probabilities},
    {"clusters_leave_none_out", clusters_leave_none_out},
    {"better_lights_come_first", better_lights_come_first},
    {"punctual_lights_add_up", punctual_lights_add_up},
    {"few_stand_for_all", few_stand_for_all},
    {"panels_add_up", panels_add_up},
};

TEST_MAIN(cases)
