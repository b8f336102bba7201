/* Where probes go, and that what they hold is what a point of free space sees. */
#include <stdlib.h>

#include <lambent/probes_bake.h>
#include <lambent/placement.h>

#include "level_fixture.h"
#include "probes/placement_internal.h"
#include "scenes/level_builder.h"
#include "scenes/levels.h"
#include "turned_lattice.h"

#define PI 3.14159265358979323846

static const char *output_path(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/placement_%s.glb", LMB_TEST_OUTPUT_DIR, name);
    return path;
}

static lmb_probes *place(const level_fixture *level, const lmb_placement_settings *settings, lmb_placement_stats *stats)
{
    lmb_error error = {{0}};
    lmb_probes *probes = NULL;
    const lmb_result result = lmb_placement_make(level->tracer, settings, level->pool, &probes, stats, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    CHECK(result != LMB_OK || lmb_probes_validate(probes, &error) == LMB_OK, "%s", error.message);
    return probes;
}

/* Walls on lattice planes: each probe there must see the room as one in the middle does, not half of it. */
static void probes_on_walls_see_the_room(void)
{
    const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
    lmb_error error;
    level_fixture level;
    if (!level_fixture_open(&level, output_path("furnace"),
                            lmb_level_furnace(output_path("furnace"), 4.0f, 0.5f, one, false, &error), &error, 2)) {
        return;
    }
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = 1.0f;
    lmb_placement_stats stats;
    lmb_gather_stats baked;
    lmb_probes *probes = place(&level, &settings, &stats);
    if (probes) {
        CHECK(probes->count == 125 && stats.probes_valid == 125, "%d probes, %d valid", probes->count,
              stats.probes_valid);
        CHECK(lmb_probes_bake(probes, &level.transport, &(lmb_gather_effort){.samples = 1024}, level.pool, NULL,
                              &baked) == LMB_OK,
              "bake");
        for (int32_t i = 0; i < probes->count; ++i) {
            const lmb_vec3 p = lmb_probes_position(probes, i);
            CHECK_NEAR(probes->radiance[0][i].channel[1].c[0], 2.0 * sqrt(PI) * 2.0, 0.2, "probe at %g %g %g",
                       (double)p.x, (double)p.y, (double)p.z);
        }
    }
    lmb_probes_destroy(probes);
    level_fixture_close(&level);
}

static void relocation_is_small_and_inward(void)
{
    const lmb_rgb one = {{1.0f, 1.0f, 1.0f}};
    lmb_error error;
    level_fixture level;
    if (!level_fixture_open(&level, output_path("relocate"),
                            lmb_level_furnace(output_path("relocate"), 4.0f, 0.5f, one, false, &error), &error, 1)) {
        return;
    }
    static const struct {
        lmb_vec3 from, to;
    } table[] = {
        {{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}},      /* free */
        {{-2.0f, 0.3f, 0.2f}, {-1.95f, 0.3f, 0.2f}},   /* on a wall */
        {{-1.98f, 0.3f, 0.2f}, {-1.95f, 0.3f, 0.2f}},  /* almost */
        {{2.0f, -2.0f, 2.0f}, {1.95f, -1.95f, 1.95f}}, /* in a corner */
        {{-2.02f, 0.3f, 0.2f}, {-2.02f, 0.3f, 0.2f}},  /* behind the wall: stays, and is no free space */
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        uint64_t rays = 0;
        const lmb_vec3 moved = lmb_placement_relocate(level.tracer, table[i].from, 1.0f, &rays);
        CHECK_NEAR(moved.x, table[i].to.x, 1e-4, "case %zu", i);
        CHECK_NEAR(moved.y, table[i].to.y, 1e-4, "case %zu", i);
        CHECK_NEAR(moved.z, table[i].to.z, 1e-4, "case %zu", i);
    }
    uint64_t rays = 0;
    CHECK(lmb_placement_is_free(level.tracer, table[0].from, &rays), "the middle");
    CHECK(!lmb_placement_is_free(level.tracer, table[4].from, &rays), "behind a wall");
    level_fixture_close(&level);
}

static void default_spacing_follows_the_size(void)
{
    static const float sizes[] = {0.01f, 0.5f, 4.0f, 556.0f, 10000.0f};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        lmb_scene scene = {.bounds_min = {0.0f, 0.0f, 0.0f}, .bounds_max = {sizes[i], sizes[i], sizes[i]}};
        const double spacing = (double)lmb_placement_default_spacing(&scene);
        const double points = pow((double)sizes[i] / spacing, 3.0);
        CHECK(points > 8000.0 && points <= 32768.0 * 1.001, "%g m: spacing %g, %g points", (double)sizes[i], spacing,
              points);
    }
    const lmb_scene flat = {.bounds_min = {0.0f, 0.0f, 0.0f}, .bounds_max = {100.0f, 0.0f, 100.0f}};
    CHECK(lmb_placement_default_spacing(&flat) > 0.5f, "a flat level: %g",
          (double)lmb_placement_default_spacing(&flat));
}

static void max_probes_is_kept(void)
{
    lmb_error error;
    level_fixture level;
    if (!level_fixture_open(&level, output_path("cornell"), lmb_level_cornell(output_path("cornell"), &error), &error,
                            2)) {
        return;
    }
    static const int32_t limits[] = {27, 100, 1000};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; ++i) {
        lmb_placement_settings settings = lmb_placement_settings_default();
        settings.spacing = 0.05f;
        settings.max_probes = limits[i];
        lmb_placement_stats stats;
        lmb_probes *probes = place(&level, &settings, &stats);
        CHECK(probes && probes->count <= limits[i] && probes->count >= limits[i] / 4, "%d probes of %d",
              probes ? probes->count : -1, limits[i]);
        lmb_probes_destroy(probes);
    }
    level_fixture_close(&level);
}

/* Valid probes within one of the two rooms of lmb_level_two_rooms. */
static int32_t valid_count(const lmb_probes *probes, bool right)
{
    int32_t count = 0;
    for (int32_t i = 0; i < probes->count; ++i) {
        const lmb_vec3 p = lmb_probes_position(probes, i);
        const bool in_rooms = fabsf(p.x) < 4.05f && fabsf(p.z) < 2.0f && p.y > 0.0f && p.y < 3.0f;
        count += in_rooms && probes->validity[i] >= LMB_PROBES_MIN_VALIDITY && (p.x > 0.0f) == right;
    }
    return count;
}

/* A seed in one of two sealed rooms leaves the other one out; a doorway lets the flood through. */
static void seeds_choose_the_space(void)
{
    static const float doors[] = {0.0f, 1.0f};
    for (int i = 0; i < 2; ++i) {
        lmb_two_rooms rooms = lmb_two_rooms_default();
        rooms.door_m = doors[i];
        lmb_error error;
        level_fixture level;
        if (!level_fixture_open(&level, output_path("rooms"), lmb_level_two_rooms(output_path("rooms"), &rooms, &error),
                                &error, 2)) {
            return;
        }
        const lmb_vec3d seeds[] = {{-1.0, 1.0, 1.0}, {50.0, 0.0, 0.0}};
        lmb_placement_settings settings = lmb_placement_settings_default();
        settings.spacing = 0.4f;
        lmb_placement_stats stats;
        lmb_probes *all = place(&level, &settings, &stats);
        settings.seeds = seeds;
        settings.seed_count = 2;
        lmb_probes *seeded = place(&level, &settings, &stats);
        if (all && seeded) {
            CHECK(stats.seeds_in_solid, "the seed outside the level");
            CHECK(valid_count(all, true) > 100, "%d", valid_count(all, true));
            CHECK(valid_count(seeded, false) == valid_count(all, false), "the seed's own room");
            CHECK((valid_count(seeded, true) > 100) == (doors[i] > 0.0f), "door %g: %d beyond", (double)doors[i],
                  valid_count(seeded, true));
        }
        lmb_probes_destroy(all);
        lmb_probes_destroy(seeded);
        level_fixture_close(&level);
    }
}

/* Two closed rooms of 4 m, and a sheet between them that stretches the level's bounds to 5 km. */
static lmb_result far_rooms_write(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    lmb_level_box box = lmb_level_box_of((lmb_vec3){-2, -2, -2}, (lmb_vec3){2, 2, 2}, material);
    box.inward = true;
    const int room = lmb_level_builder_add_mesh(builder, "room");
    lmb_level_builder_add_box(builder, room, &box);
    lmb_level_builder_place(builder, "room", room, (lmb_vec3){1000, -1000, -1000});
    lmb_level_builder_place(builder, "other", room, (lmb_vec3){-1000, 1000, 1000});
    const int sheet = lmb_level_builder_add_mesh(builder, "sheet");
    lmb_level_builder_add_quad(builder, sheet, material, (lmb_vec3){-2500, -2500, -2500}, (lmb_vec3){2500, 5000, 0},
                               (lmb_vec3){2500, 0, 5000});
    lmb_level_builder_place(builder, "sheet", sheet, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Seeded rooms cost what they take by themselves, in bounds of 10^12 lattice points too; all of these are too many. */
static void rooms_in_vast_bounds(void)
{
    lmb_error error = {{0}};
    level_fixture level;
    if (!level_fixture_open(&level, output_path("vast"), far_rooms_write(output_path("vast"), &error), &error, 2)) {
        return;
    }
    const lmb_vec3d seeds[] = {{1000.2, -1000.0, -1000.0}, {-1000.0, 1000.0, 1000.2}};
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = 0.5f;
    settings.seeds = seeds;
    settings.seed_count = 2;
    lmb_placement_stats stats;
    lmb_probes *probes = place(&level, &settings, &stats);
    if (probes) {
        /* 9 points a side in a room, its walls' among them, and those behind the walls. A wall on a lattice plane lies
         * in the cells above it: in those of 9 x 9 x 9 that are at an end of an axis. */
        CHECK(stats.probes_valid == 2 * 729 && probes->count == 2 * 1331, "%d of %d", stats.probes_valid,
              probes->count);
        CHECK(stats.cells == 2 * 1000 && stats.cells_crossed == 2 * (729 - 343), "%lld cells, %lld crossed",
              (long long)stats.cells, (long long)stats.cells_crossed);
        CHECK(stats.rays < 1000000, "%llu rays", (unsigned long long)stats.rays);
    }
    lmb_probes_destroy(probes);
    settings.seed_count = 0;
    probes = NULL;
    const lmb_result result = lmb_placement_make(level.tracer, &settings, level.pool, &probes, &stats, &error);
    CHECK(result == LMB_ERROR_UNSUPPORTED && !probes && strstr(error.message, "too fine"), "%d: %s", result,
          error.message);
    level_fixture_close(&level);
}

/* A plane of 20 m on y = 0 crosses only the cells that hold it. */
static void crossed_cells_are_counted(void)
{
    lmb_error error;
    level_fixture level;
    if (!level_fixture_open(&level, output_path("plane"),
                            lmb_level_open_ground(output_path("plane"), 19.9f, 0.5f, &error), &error, 1)) {
        return;
    }
    lmb_placement_settings settings = lmb_placement_settings_default();
    settings.spacing = 2.0f;
    lmb_placement_stats stats;
    lmb_probes *probes = place(&level, &settings, &stats);
    CHECK(stats.cells == 100 && stats.cells_crossed == 100, "%lld cells, %lld crossed", (long long)stats.cells,
          (long long)stats.cells_crossed);
    lmb_probes_destroy(probes);
    level_fixture_close(&level);
}

/* A wall in a lattice's axes: y = x - 0.1 from x = 0.6 to 2.9, in five columns of cells, z from 0.25 to 2.75. */
static lmb_result turned_wall_write(const char *path, const lmb_lattice *lattice, const rotation *turn,
                                    lmb_error *error)
{
    static const lmb_vec3d local[3] = {{0.6, 0.5, 0.25}, {2.3, 2.3, 0.0}, {0.0, 0.0, 2.5}};
    lmb_vec3 world[3];
    for (int i = 0; i < 3; ++i) {
        const lmb_vec3d at = rotation_place(turn, (double)lattice->spacing, local[i]);
        world[i] = (lmb_vec3){(float)at.x, (float)at.y, (float)at.z};
    }
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int wall = lmb_level_builder_add_mesh(builder, "wall");
    lmb_level_builder_add_quad(builder, wall, material, world[0], world[1], world[2]);
    lmb_level_builder_place(builder, "wall", wall, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* On a turned lattice too, whose own cells they are. Among all probes of 9 x 9 x 9 cells, and where there are fewer
 * than the wall's box has cells, so that both ways of looking are taken. */
static void crossed_cells_of_a_turned_lattice(void)
{
    enum { SIDE = 10 };
    uint64_t state = 21;
    for (int round = 0; round < 6; ++round) {
        const bool few = round % 2 == 1;
        rotation turn;
        lmb_lattice lattice = turned_lattice(&state, 0.5f, &turn);
        static uint8_t wanted[SIDE * SIDE * SIDE];
        for (int i = 0; i < SIDE * SIDE * SIDE; ++i) { /* the corners of cell (0, 0, 0), 4 from the first */
            const int x = i % SIDE - 4, y = i / SIDE % SIDE - 4, z = i / SIDE / SIDE - 4;
            wanted[i] = !few || (x / 2 == 0 && y / 2 == 0 && z / 2 == 0 && x >= 0 && y >= 0 && z >= 0);
        }
        for (int axis = 0; axis < 3; ++axis) {
            lattice.min[axis] = -4;
            lattice.size[axis] = SIDE;
        }
        lmb_error error = {{0}};
        level_fixture level;
        const char *path = output_path("turned");
        if (!level_fixture_open(&level, path, turned_wall_write(path, &lattice, &turn, &error), &error, 1)) {
            return;
        }
        lmb_probes *grid = fixture_probes(&lattice, wanted);
        grid->origin = level.scene->origin;
        int64_t cells = 0, crossed = 0;
        CHECK(lmb_placement_count_cells(grid, 0, level.tracer, &cells, &crossed) == LMB_OK, "memory");
        CHECK(cells == (few ? 1 : 729) && crossed == (few ? 1 : 15), "round %d: %lld cells, %lld crossed", round,
              (long long)cells, (long long)crossed);
        lmb_probes_destroy(grid);
        level_fixture_close(&level);
    }
}

static const test_case cases[] = {
    {"probes_on_walls_see_the_room", probes_on_walls_see_the_room},
    {"relocation_is_small_and_inward", relocation_is_small_and_inward},
    {"default_spacing_follows_the_size", default_spacing_follows_the_size},
    {"max_probes_is_kept", max_probes_is_kept},
    {"seeds_choose_the_space", seeds_choose_the_space},
    {"rooms_in_vast_bounds", rooms_in_vast_bounds},
    {"crossed_cells_are_counted", crossed_cells_are_counted},
    {"crossed_cells_of_a_turned_lattice", crossed_cells_of_a_turned_lattice},
};

TEST_MAIN(cases)
