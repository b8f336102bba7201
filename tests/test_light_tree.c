/* Choosing among many lights: what is chosen, how often, and that sums over choices are sums over lights. */
#include <math.h>
#include <stdlib.h>

#include "harness.h"
#include "light_tree.h"
#include "scenes/level_builder.h"
#include "level_fixture.h"

enum { MOST = 1000, CHOICES = 200000 };

/* Numbers without a pattern that the tree could share. */
static double number_next(uint64_t *state)
{
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

static void lights_make(lmb_light_bound *lights, int count, bool one_place)
{
    uint64_t state = 7;
    for (int i = 0; i < count; ++i) {
        const float x = one_place ? 1.0f : (float)(20.0 * number_next(&state));
        const float y = one_place ? 2.0f : (float)(3.0 * number_next(&state));
        const float z = one_place ? 3.0f : (float)(20.0 * number_next(&state));
        const float size = one_place ? 0.0f : (float)number_next(&state);
        const float power = (float)pow(10.0, 4.0 * number_next(&state) - 2.0);
        lights[i] = (lmb_light_bound){{x, y, z}, {x + size, y + size, z + size}, power};
    }
}

/* Probabilities are those of the choices (chi-square), sum to 1, and are never 0. */
static void choices_have_their_probabilities(void)
{
    static const int counts[] = {1, 2, 3, 5, 17, 64, MOST};
    static const lmb_vec3 positions[] = {{0, 0, 0}, {10, 1, 10}, {1, 2, 3}, {1e6f, 0, 0}};
    static lmb_light_bound lights[MOST];
    static double frequency[MOST];
    for (size_t k = 0; k < 2 * sizeof counts / sizeof counts[0]; ++k) {
        const int count = counts[k / 2];
        lights_make(lights, count, k % 2 == 1);
        lmb_light_tree *tree = NULL;
        CHECK(lmb_light_tree_create(lights, (uint32_t)count, &tree) == LMB_OK, "%d lights", count);
        for (size_t p = 0; p < sizeof positions / sizeof positions[0] && tree; ++p) {
            double sum = 0.0;
            for (int i = 0; i < count; ++i) {
                const double probability = lmb_light_tree_probability(tree, positions[p], (uint32_t)i);
                CHECK(probability >= 0.1 / count * 0.999 && probability <= 1.0 + 1e-12, "%d of %d: %g", i, count,
                      probability);
                sum += probability;
                frequency[i] = 0.0;
            }
            CHECK_NEAR(sum, 1.0, 1e-9, "%d lights, place %zu", count, p);
            for (int i = 0; i < CHOICES; ++i) {
                double probability;
                const uint32_t light = lmb_light_tree_choose(tree, positions[p], (i + 0.5) / CHOICES, &probability);
                frequency[light] += 1.0 / CHOICES;
                if (i % 1000 == 0) {
                    CHECK_NEAR(probability, lmb_light_tree_probability(tree, positions[p], light), 1e-9 * probability,
                               "light %u", light);
                }
            }
            /* Even numbers fall into a light's share of them as often as it is wide, but for its ends. */
            for (int i = 0; i < count; ++i) {
                const double probability = lmb_light_tree_probability(tree, positions[p], (uint32_t)i);
                CHECK_NEAR(frequency[i], probability, 4.0 / CHOICES, "light %d of %d, place %zu", i, count, p);
            }
        }
        lmb_light_tree_destroy(tree);
    }
}

/* What is near or strong is chosen more often than by power alone. */
static void near_lights_come_first(void)
{
    const lmb_light_bound lights[2] = {{{0, 0, 0}, {0, 0, 0}, 1.0f}, {{10, 0, 0}, {10, 0, 0}, 1.0f}};
    lmb_light_tree *tree = NULL;
    CHECK(lmb_light_tree_create(lights, 2, &tree) == LMB_OK, "two lights");
    /* By inverse squares 81 : 1, nine tenths of the time. */
    CHECK_NEAR(lmb_light_tree_probability(tree, (lmb_vec3){1, 0, 0}, 0), 0.9 * 81.0 / 82.0 + 0.05, 1e-6, "near");
    CHECK_NEAR(lmb_light_tree_probability(tree, (lmb_vec3){5, 0, 0}, 0), 0.5, 1e-6, "between");
    lmb_light_tree_destroy(tree);
    CHECK(lmb_light_tree_create(NULL, 0, &tree) == LMB_OK && !tree, "no lights have no tree");
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
        for (int i = 0; i < counts[k]; ++i) {
            const lmb_vec3 place = {(float)(40.0 * number_next(&state) - 20.0), (float)(1.0 + number_next(&state)),
                                    (float)(40.0 * number_next(&state) - 20.0)};
            const lmb_level_light lamp = {.name = "lamp",
                                          .type = LMB_LEVEL_LIGHT_POINT,
                                          .color = {{1, 1, 1}},
                                          .intensity = (float)(1.0 + 20.0 * number_next(&state))};
            lmb_level_node node = lmb_level_node_default("lamp");
            node.light = lmb_level_builder_add_light(builder, &lamp);
            node.translation = place;
            lmb_level_builder_add_node(builder, &node);
            const double squared = (double)place.x * (double)place.x + (double)place.y * (double)place.y +
                                   (double)place.z * (double)place.z;
            expected += (double)lamp.intensity * (double)place.y / pow(squared, 1.5) / 3.14159265358979323846;
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
        level_fixture_close(&level);
    }
}

static const test_case cases[] = {
    {"choices_have_their_probabilities", choices_have_their_probabilities},
    {"near_lights_come_first", near_lights_come_first},
    {"punctual_lights_add_up", punctual_lights_add_up},
};

TEST_MAIN(cases)
