/* The suite that judges interpolation: its scenes, its figures by hand-made fields, and rooms whose answer is known. */
#include "leaks_measure.h"
#include "leaks_methods.h"

#include <stdlib.h>

#include <lambent/vector.h>

#include "level_fixture.h"

/* --- scenes ------------------------------------------------------------------------------------------------------ */

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/leaks_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

/* A point of a room, on a grid of its own. */
static lmb_vec3 grid_point(const lmb_leak_scene *scene, const lmb_leak_room *room, int i, int side)
{
    const float x = ((float)(i % side) + 0.37f) / (float)side, y = ((float)(i / side % side) + 0.41f) / (float)side,
                z = ((float)(i / side / side) + 0.33f) / (float)side;
    return lmb_leak_scene_to_world(scene, lmb_vec3_of(room->min.x + x * (room->max.x - room->min.x),
                                                      room->min.y + y * (room->max.y - room->min.y),
                                                      room->min.z + z * (room->max.z - room->min.z)));
}

/* Pairs of points in rooms of different homes that see each other. */
static int pairs_that_see(const lmb_leak_scene *scene, const lmb_tracer *tracer, const lmb_leak_room *room, int a,
                          int b)
{
    enum { SIDE = 4, POINTS = SIDE * SIDE * SIDE };
    int seen = 0;
    for (int i = 0; i < POINTS * POINTS; ++i) {
        const lmb_vec3 from = grid_point(scene, &room[a], i % POINTS, SIDE),
                       to = grid_point(scene, &room[b], i / POINTS, SIDE);
        seen += lmb_leak_scene_room_at(scene, from) == a && lmb_leak_scene_room_at(scene, to) == b &&
                leaks_sees(tracer, from, to);
    }
    return seen;
}

static void rooms_are_sealed_or_open(void)
{
    size_t count;
    const lmb_leak_scene *scenes = lmb_leak_scenes(&count);
    for (size_t i = 0; i < count; ++i) {
        const lmb_leak_scene *scene = &scenes[i];
        lmb_error error = {{0}};
        level_fixture level;
        CHECK(lmb_leak_scene_find(scene->name) == scene, "%s", scene->name);
        if (!level_fixture_open(&level, output_path(scene->name),
                                lmb_leak_scene_write(scene, output_path(scene->name), &error), &error, 2)) {
            continue;
        }
        CHECK(lmb_scene_validate(level.scene, &error) == LMB_OK, "%s: %s", scene->name, error.message);
        lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
        const int rooms = lmb_leak_scene_rooms(scene, room);
        CHECK(rooms >= 2, "%s: %d rooms", scene->name, rooms);
        int seen = 0;
        for (int a = 0; a < rooms; ++a) {
            for (int b = 0; b < a; ++b) {
                seen += room[a].home != room[b].home ? pairs_that_see(scene, level.tracer, room, a, b) : 0;
            }
        }
        CHECK(scene->open ? seen > 0 : seen == 0, "%s: %d pairs see each other", scene->name, seen);
        level_fixture_close(&level);
    }
    CHECK(!lmb_leak_scene_find("nowhere"), "an unknown name");
}

/* Nobody is in the lamp under a ceiling, which is lit from inside. */
static void lamps_are_in_no_room(void)
{
    static const float below_m[] = {0.001f, 0.014f, 0.016f};
    const lmb_leak_scene *scene = lmb_leak_scene_find("floors");
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    const int rooms = lmb_leak_scene_rooms(scene, room);
    for (int i = 0; i < rooms; ++i) {
        for (size_t k = 0; k < sizeof below_m / sizeof below_m[0]; ++k) {
            const lmb_vec3 at = {0.5f * (room[i].min.x + room[i].max.x), room[i].max.y - below_m[k],
                                 0.5f * (room[i].min.z + room[i].max.z)};
            const int found = lmb_leak_scene_room_at(scene, lmb_leak_scene_to_world(scene, at));
            CHECK(found == (k < 2 ? -1 : i), "room %d, %g m below its ceiling: %d", i, (double)below_m[k], found);
        }
    }
}

/* Nor in the roof of the house, over its lamp, nor in a column; but beside them somebody is. */
static void solids_are_in_no_room(void)
{
    static const struct {
        const char *scene;
        lmb_vec3 at;
        int room;
    } table[] = {
        {"nested", {0.0f, 2.25f, 0.0f}, -1}, {"nested", {0.0f, 2.31f, 0.0f}, 1}, {"nested", {0.0f, 2.15f, 0.0f}, 0},
        {"nested", {1.3f, 1.0f, 0.0f}, -1},  {"nested", {1.36f, 1.0f, 0.0f}, 1}, {"column", {0.24f, 1.0f, 0.0f}, -1},
        {"column", {0.26f, 1.0f, 0.0f}, 1},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const lmb_leak_scene *scene = lmb_leak_scene_find(table[i].scene);
        const int found = lmb_leak_scene_room_at(scene, lmb_leak_scene_to_world(scene, table[i].at));
        CHECK(found == table[i].room, "%s, row %zu: %d", table[i].scene, i, found);
    }
}

/* --- figures by hand --------------------------------------------------------------------------------------------- */

typedef struct hand_field {
    double at, step; /* red rises by `step` there on the x axis, */
    double width;    /* within so many metres, */
    double slope;    /* and everywhere by that a metre */
    double red, green;
} hand_field;

static void hand_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    const hand_field *field = state;
    const double beyond = (double)position.x - field->at;
    const double risen = field->width > 0.0 ? fmin(fmax(beyond / field->width, 0.0), 1.0) : beyond > 0.0;
    *radiance = (lmb_sh3_rgb){.channel = {{.c = {0.0f}}}};
    radiance->channel[0].c[0] = (float)(field->red + field->step * risen + field->slope * (double)position.x);
    radiance->channel[1].c[0] = (float)field->green;
}

static const leaks_method by_hand = {.name = "by hand", .sample = hand_sample};

static void a_step_of_known_height_is_found(void)
{
    static const struct {
        const char *what;
        hand_field field;
        double expected, tolerance;
    } table[] = {
        {"a step", {.at = 0.3, .step = 2.0, .slope = 0.5}, 2.0, 1e-4},
        {"a step down", {.at = -1.37, .step = -0.25}, 0.25, 1e-5},
        {"a step on a steep slope", {.at = 1.9, .step = 0.5, .slope = 60.0}, 0.5, 1e-3},
        {"a slope", {.slope = 3.0}, 0.0, 1e-4},
        {"a rise within a millimetre", {.at = 0.3, .step = 2.0, .width = 1e-3}, 0.0, 0.02},
        {"a step beyond the line", {.at = 2.5, .step = 2.0}, 0.0, 1e-5},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const leaks_sampler sampler = {&by_hand, &table[i].field};
        CHECK_NEAR(leaks_step(&sampler, lmb_vec3_of(-2, 0, 0), lmb_vec3_of(2, 0.3f, 0.1f)), table[i].expected,
                   table[i].tolerance, "%s", table[i].what);
    }
}

/* A red room where the light is (4, `foreign`) and a green one where it is (0, 8). */
static size_t hand_points(leaks_point point[6], double foreign)
{
    for (int i = 0; i < 6; ++i) {
        const int home = i % 2;
        point[i] = (leaks_point){.kind = (leaks_kind)(i / 2), .home = home};
        point[i].truth.channel[home].c[0] = home == 0 ? 4.0f : 8.0f;
        point[i].truth.channel[1 - home].c[0] = home == 0 ? (float)foreign : 0.0f;
    }
    return 6;
}

static void figures_by_hand(void)
{
    for (int open = 0; open < 2; ++open) {
        leaks_point point[6];
        leaks_line line = {.from = {-2, 0, 0}, .to = {2, 0, 0}, .home = 1};
        leaks_places places = {.point = point, .point_count = hand_points(point, open ? 0.5 : 0.0)};
        places.line = &line;
        places.line_count = 1;
        places.open = open;
        leaks_home_means(&places);
        CHECK_NEAR(places.home_mean[0], 4.0, 1e-6, "red");
        CHECK_NEAR(places.home_mean[1], 8.0, 1e-6, "green");
        /* Everywhere (5, 2), and 1 more red beyond all points. */
        const hand_field field = {.at = 1.0, .step = 1.0, .red = 5.0, .green = 2.0};
        const leaks_sampler sampler = {&by_hand, &field};
        const leaks_figures figures = leaks_measure(&sampler, &places);
        for (int kind = 0; kind < LEAKS_KINDS; ++kind) {
            const leaks_errors *at = &figures.at[kind];
            CHECK_NEAR(at->leak, 5.0 / 4.0, 1e-6, "red in the green room, %d", open);
            CHECK_NEAR(at->of_own, 5.0 / 8.0, 1e-6, "over its own, %d", open);
            CHECK_NEAR(at->own_mean, -6.0 / 8.0, 1e-6, "green is 2, not 8");
            CHECK_NEAR(at->own_rmse, 6.0 / 8.0, 1e-6, "on all normals");
        }
        CHECK_NEAR(figures.step, 1.0 / 8.0, 1e-5, "over the line's own light");
    }
    leaks_point point[6];
    leaks_places places = {.point = point, .point_count = hand_points(point, 1.5), .open = true};
    leaks_home_means(&places);
    const hand_field field = {.red = 0.0, .green = 2.3};
    const leaks_sampler sampler = {&by_hand, &field};
    CHECK_NEAR(leaks_measure(&sampler, &places).at[LEAKS_10_CM].leak, (2.3 - 1.5) / 8.0, 1e-6, "the excess counts");
}

/* Of four points with the truths 1, 1, 3 and 3 and a light of 2 each is 1, 1, -1 and -1 off: the ratio is 1, and its
 * error 2 / 8. */
static void the_mean_has_a_standard_error(void)
{
    leaks_point point[4] = {{.kind = LEAKS_10_CM}, {.kind = LEAKS_10_CM}, {.kind = LEAKS_10_CM}, {.kind = LEAKS_10_CM}};
    for (int i = 0; i < 4; ++i) {
        point[i].truth.channel[0].c[0] = i < 2 ? 1.0f : 3.0f;
    }
    leaks_places places = {.point = point, .point_count = 4};
    leaks_home_means(&places);
    static const struct {
        double red, mean, error;
    } table[] = {{2.0, 0.0, 0.0}, {2.2, 0.1, 0.275}, {1.0, -0.5, 0.125}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const hand_field field = {.red = table[i].red};
        const leaks_errors at = leaks_measure(&(leaks_sampler){&by_hand, &field}, &places).at[LEAKS_10_CM];
        CHECK_NEAR(at.own_mean, table[i].mean, 1e-6, "red is %g", table[i].red);
        CHECK_NEAR(at.own_std_error, table[i].error, 1e-6, "red is %g", table[i].red);
    }
}

/* --- rooms ------------------------------------------------------------------------------------------------------- */

/* A scene baked with few samples. */
typedef struct room_fixture {
    leaks_level level;
    leaks_places places;
    leaks_field field;
} room_fixture;

static bool room_fixture_open(room_fixture *rooms, const char *name, float spacing, uint32_t points)
{
    lmb_error error = {{0}};
    const lmb_result opened = leaks_level_open(lmb_leak_scene_find(name), output_path(name), 2, &rooms->level, &error);
    CHECK(opened == LMB_OK, "%s: %s", name, error.message);
    if (opened != LMB_OK) {
        return false;
    }
    const lmb_result placed = leaks_places_make(&rooms->level, points, 128, &rooms->places);
    const lmb_result baked =
        placed == LMB_OK ? leaks_field_bake(&rooms->level, spacing, 64, &rooms->field, &error) : placed;
    CHECK(baked == LMB_OK, "%s: %s", name, error.message);
    if (baked != LMB_OK) {
        leaks_places_free(&rooms->places);
        leaks_level_close(&rooms->level);
    }
    return baked == LMB_OK;
}

static void room_fixture_close(room_fixture *rooms)
{
    leaks_field_free(&rooms->field);
    leaks_places_free(&rooms->places);
    leaks_level_close(&rooms->level);
}

static leaks_figures figures_of(const room_fixture *rooms, const char *method)
{
    const leaks_sampler sampler = {leaks_method_find(method), NULL};
    void *state = NULL;
    size_t bytes = 0;
    leaks_figures figures = {.step = -1.0};
    CHECK(sampler.method && sampler.method->prepare(&rooms->field, &state, &bytes) == LMB_OK, "%s", method);
    if (state) {
        figures = leaks_measure(&(leaks_sampler){sampler.method, state}, &rooms->places);
        CHECK(bytes >= rooms->field.packed_bytes, "%s: %zu bytes", method, bytes);
        if (sampler.method->release) {
            sampler.method->release(state);
        }
    }
    return figures;
}

static double worst_leak(const leaks_figures *figures)
{
    return fmax(fabs(figures->at[LEAKS_1_CM].leak),
                fmax(fabs(figures->at[LEAKS_10_CM].leak), fabs(figures->at[LEAKS_ANYWHERE].leak)));
}

/* A sealed room: what leaks through its wall is the interpolation's fault. */
static void sealed_rooms_tell_methods_apart(void)
{
    room_fixture rooms;
    if (!room_fixture_open(&rooms, "turned.200mm", 1.0f, 128)) {
        return;
    }
    size_t at[LEAKS_KINDS] = {0};
    for (size_t i = 0; i < rooms.places.point_count; ++i) {
        const leaks_point *point = &rooms.places.point[i];
        ++at[point->kind];
        CHECK(point->truth.channel[1 - point->home].c[0] == 0.0f, "point %zu: foreign light in the truth", i);
        CHECK(point->truth.channel[point->home].c[0] > 0.0f, "point %zu: no light", i);
    }
    CHECK(at[0] == 128 && at[1] == 128 && at[2] == 512 && rooms.places.line_count == 64, "%zu, %zu, %zu, %zu", at[0],
          at[1], at[2], rooms.places.line_count);
    const leaks_figures trilinear = figures_of(&rooms, "trilinear"), exact = figures_of(&rooms, "masked.exact"),
                        masked = figures_of(&rooms, "masked"), chebyshev = figures_of(&rooms, "chebyshev"),
                        regions = figures_of(&rooms, "regions");
    CHECK(trilinear.at[LEAKS_1_CM].leak > 0.1, "trilinear leaks %g", trilinear.at[LEAKS_1_CM].leak);
    CHECK(worst_leak(&exact) == 0.0, "by rays %g", worst_leak(&exact));
    CHECK(worst_leak(&regions) == 0.0, "regions leak %g", worst_leak(&regions));
    CHECK(worst_leak(&chebyshev) > 0.0 && worst_leak(&chebyshev) < 0.01, "depths %g", worst_leak(&chebyshev));
    CHECK(masked.at[LEAKS_ANYWHERE].leak < trilinear.at[LEAKS_ANYWHERE].leak, "masks %g",
          masked.at[LEAKS_ANYWHERE].leak);
    CHECK(trilinear.step < 1e-3 && regions.step < 1e-3, "steps %g, %g", trilinear.step, regions.step);
    CHECK(masked.step > 0.05, "masks have steps: %g", masked.step);
    CHECK(fabs(regions.at[LEAKS_ANYWHERE].own_mean) < 0.05, "mean of regions %g", regions.at[LEAKS_ANYWHERE].own_mean);
    room_fixture_close(&rooms);
}

/* --- regions ----------------------------------------------------------------------------------------------------- */

/* A cell of 2 m holds a corner of the house, or many facets of the round wall: planes have to be chosen together, and
 * by what lies right beside walls; and where facets meet, which few points are near to. */
static void many_planes_part_two_regions(void)
{
    static const char *const names[] = {"nested", "curved"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        room_fixture rooms;
        if (!room_fixture_open(&rooms, names[i], 2.0f, 1024)) {
            continue;
        }
        const leaks_figures trilinear = figures_of(&rooms, "trilinear"), regions = figures_of(&rooms, "regions");
        CHECK(worst_leak(&trilinear) > 0.3, "%s: trilinear leaks %g", names[i], worst_leak(&trilinear));
        CHECK(worst_leak(&regions) == 0.0, "%s: regions leak %g", names[i], worst_leak(&regions));
        CHECK(regions.step < 1e-3, "%s: a step of %g", names[i], regions.step);
        room_fixture_close(&rooms);
    }
}

/* A door ajar and a column end within cells of half a metre: undivided cells let 7 and 22 % through. */
static void what_ends_divides(void)
{
    static const struct {
        const char *name;
        double most;
    } scenes[] = {{"door", 0.01}, {"column", 0.14}};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; ++i) {
        room_fixture rooms;
        if (!room_fixture_open(&rooms, scenes[i].name, 0.5f, 256)) {
            continue;
        }
        const leaks_figures regions = figures_of(&rooms, "regions");
        CHECK(worst_leak(&regions) < scenes[i].most, "%s leaks %g", scenes[i].name, worst_leak(&regions));
        CHECK(regions.step < 1e-3, "%s: a step of %g", scenes[i].name, regions.step);
        room_fixture_close(&rooms);
    }
}

/* Where light bends within cells of 2 m, levels bring each room's own light back, beside walls too. The few samples of
 * probes and truth here make some 3 % of the mean by themselves. */
static void levels_keep_own_light(void)
{
    room_fixture rooms;
    if (!room_fixture_open(&rooms, "curved", 2.0f, 128)) {
        return;
    }
    const leaks_figures regions = figures_of(&rooms, "regions"), levels = figures_of(&rooms, "levels");
    CHECK(regions.at[LEAKS_1_CM].own_mean > 0.2, "regions alone: %g", regions.at[LEAKS_1_CM].own_mean);
    for (int kind = 0; kind < LEAKS_KINDS; ++kind) {
        CHECK(fabs(levels.at[kind].own_mean) < 0.08, "mean of kind %d: %g", kind, levels.at[kind].own_mean);
        CHECK(levels.at[kind].own_rmse < 0.8 * regions.at[kind].own_rmse, "RMSE of kind %d: %g, regions alone %g", kind,
              levels.at[kind].own_rmse, regions.at[kind].own_rmse);
    }
    CHECK(worst_leak(&levels) == 0.0, "levels leak %g", worst_leak(&levels));
    CHECK(levels.step < 1e-3, "a step of %g", levels.step);
    rooms.field.bake.record.settings.tolerance = 100.0; /* never finer: regions alone */
    const leaks_figures coarse = figures_of(&rooms, "levels");
    CHECK_NEAR(coarse.at[LEAKS_1_CM].own_mean, regions.at[LEAKS_1_CM].own_mean, 0.02, "of a large tolerance");
    room_fixture_close(&rooms);
}

static const test_case cases[] = {
    {"rooms are sealed or open", rooms_are_sealed_or_open},
    {"lamps are in no room", lamps_are_in_no_room},
    {"solids are in no room", solids_are_in_no_room},
    {"a step of known height is found", a_step_of_known_height_is_found},
    {"figures by hand", figures_by_hand},
    {"the mean has a standard error", the_mean_has_a_standard_error},
    {"sealed rooms tell methods apart", sealed_rooms_tell_methods_apart},
    {"many planes part two regions", many_planes_part_two_regions},
    {"what ends divides", what_ends_divides},
    {"levels keep own light", levels_keep_own_light},
};

TEST_MAIN(cases)
