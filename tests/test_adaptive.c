/* How many samples an element takes must not depend on what it has found: else rare light is missed for good, and the
 * error estimate does not know. A dark room with a small window under a white sky: a texel's first 64 samples mostly
 * find nothing. */
#include <math.h>
#include <stdio.h>

#include <lambent/surface_solve.h>

#include "gather_fixture.h"
#include "harness.h"
#include "level_builder.h"
#include "level_fixture.h"

/* Of `lambent bake --quality`, for 64 samples at first. */
static const struct quality {
    const char *name;
    double tolerance;
    uint32_t max_samples;
} qualities[] = {{"draft", 0.12, 256}, {"medium", 0.06, 1024}, {"high", 0.03, 4096}};

/* A room of 4 x 2.5 x 4 m that looks inward, with a window of 0.2 m in the wall at -Z, and a roof over the window that
 * leaves only the horizon. */
static lmb_result room_write(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.2f);
    lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int room = lmb_level_builder_add_mesh(builder, "room");
    lmb_level_box box = lmb_level_box_of((lmb_vec3){-2, 0, -2}, (lmb_vec3){2, 2.5f, 2}, material);
    box.inward = true;
    box.material[4] = LMB_LEVEL_NONE;
    lmb_level_builder_add_box(builder, room, &box);
    /* The wall at -Z around the window: x, y in [-0.1, 0.1] x [1.2, 1.4]. */
    static const float frame[4][4] = {
        {-2, 0, 4, 1.2f}, {-2, 1.4f, 4, 1.1f}, {-2, 1.2f, 1.9f, 0.2f}, {0.1f, 1.2f, 1.9f, 0.2f}};
    for (int i = 0; i < 4; ++i) {
        lmb_level_builder_add_quad(builder, room, material, (lmb_vec3){frame[i][0], frame[i][1], -2},
                                   (lmb_vec3){frame[i][2], 0, 0}, (lmb_vec3){0, frame[i][3], 0});
    }
    lmb_level_builder_place(builder, "room", room, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Elements on the floor, a few centimetres apart, in groups as a bake has them. */
enum { GROUPS = 3, ELEMENTS = GROUPS * LMB_GATHER_GROUP, TRUTH_SAMPLES = 16384 };
typedef struct floor_elements {
    lmb_gather_point points[ELEMENTS];
    lmb_gathered gathered[ELEMENTS];
    lmb_gathered truth[ELEMENTS];
} floor_elements;

static void floor_place(floor_elements *at)
{
    for (int i = 0; i < ELEMENTS; ++i) {
        at->points[i] =
            (lmb_gather_point){.position = {0.3f * (float)(i % 8) - 1.0f, 0.001f, 0.15f * (float)(i / 8) - 1.5f},
                               .hemisphere = true,
                               .normal = {0, 1, 0}};
    }
}

/* Of green moments: mean of the first, and how far all are from the truth, squared and summed. */
static void floor_compare(const floor_elements *at, double *mean, double *expected, double *apart, double *length)
{
    *mean = *expected = *apart = *length = 0.0;
    for (int i = 0; i < ELEMENTS; ++i) {
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                const double truth = (double)at->truth[i].moments.channel[c].c[k];
                const double off = (double)at->gathered[i].moments.channel[c].c[k] - truth;
                *apart += off * off;
                *length += truth * truth;
            }
        }
        *mean += (double)at->gathered[i].moments.channel[1].c[0] / ELEMENTS;
        *expected += (double)at->truth[i].moments.channel[1].c[0] / ELEMENTS;
    }
}

/* Every quality has the mean of many samples within 1 % and three standard errors, and an estimate of its error within
 * a factor of 1.5. */
static void qualities_check(const level_fixture *level, const char *estimator)
{
    const lmb_transport *transport = &level->transport;
    static floor_elements at;
    floor_place(&at);
    for (int i = 0; i < ELEMENTS; ++i) {
        lmb_gather_sh3(transport, &at.points[i], TRUTH_SAMPLES, &at.truth[i]);
    }
    lmb_transport other = *transport;
    other.seed = transport->seed + 1; /* the truth's samples are not among those of a quality */
    for (size_t i = 0; i < sizeof qualities / sizeof qualities[0]; ++i) {
        const lmb_gather_effort effort = {
            .samples = 64, .max_samples = qualities[i].max_samples, .tolerance = qualities[i].tolerance};
        double squared_error = 0.0, mean, expected, apart, length;
        const lmb_gather_list list = gather_fixture_list(at.points, ELEMENTS);
        CHECK(gather_fixture_gather(&other, &effort, &list, level->pool, at.gathered) == LMB_OK, "memory");
        for (int k = 0; k < ELEMENTS; ++k) {
            squared_error += at.gathered[k].squared_error + at.truth[k].squared_error;
        }
        floor_compare(&at, &mean, &expected, &apart, &length);
        const double estimated = sqrt(squared_error / length), is = sqrt(apart / length);
        CHECK_NEAR(mean, expected, (0.01 + 3.0 * is / sqrt(ELEMENTS)) * expected, "%s, %s", estimator,
                   qualities[i].name);
        CHECK(estimated < 1.5 * is && estimated > is / 1.5, "%s, %s: estimated %g, is %g", estimator, qualities[i].name,
              estimated, is);
    }
}

static void rare_light_is_found(void)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/adaptive_room.glb";
    lmb_error error = {{0}};
    level_fixture level;
    const lmb_result written = room_write(path, &error);
    CHECK(written == LMB_OK, "%s", error.message);
    if (written != LMB_OK || !level_fixture_load(&level, path, "#ffffff", 2)) {
        return;
    }
    qualities_check(&level, "reference");
    const lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    lmb_surface_light *light;
    lmb_surface_light_stats stats;
    if (lmb_surface_light_solve(&level.transport, &settings, level.pool, &light, &stats, &error) == LMB_OK) {
        level.transport.surface = light;
        qualities_check(&level, "cached");
        lmb_surface_light_destroy(light);
    }
    level_fixture_close(&level);
}

/* An element that none of its group's others tell anything about takes all samples. */
static void alone_takes_all(void)
{
    static const char path[] = LMB_TEST_OUTPUT_DIR "/adaptive_alone.glb";
    lmb_error error = {{0}};
    level_fixture level;
    const lmb_result written = room_write(path, &error);
    if (!level_fixture_open(&level, path, written, &error, 1)) {
        return;
    }
    const lmb_gather_effort effort = {.samples = 64, .max_samples = 512, .tolerance = 0.06};
    const lmb_gather_point point = {.position = {0.0f, 1.0f, 0.0f}};
    const lmb_gather_list list = gather_fixture_list(&point, 1);
    lmb_gathered gathered = {.samples = 0};
    CHECK(gather_fixture_gather(&level.transport, &effort, &list, level.pool, &gathered) == LMB_OK &&
              gathered.samples == 512,
          "%u samples", gathered.samples);
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"rare_light_is_found", rare_light_is_found},
    {"alone_takes_all", alone_takes_all},
};

TEST_MAIN(cases)
