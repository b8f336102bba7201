/* Boxes of probes: what they say of spacing, tolerance and absence is what is placed. */
#include <stdlib.h>

#include <lambent/bake_phases.h>
#include <lambent/probe_boxes.h>

#include "harness.h"
#include "probes_fixture.h"
#include "scenes/level_builder.h"
#include "warning_log.h"

#define PATH LMB_TEST_OUTPUT_DIR "/placement_boxes.glb"

enum { BOXES_MOST = 3 };

typedef struct volume_box {
    lmb_vec3 min, max;
    lmb_level_volume volume;
} volume_box;

/* A room from 0 to 16 along x and z and 8 along y, that emits evenly, with a lamp of 100 cd at (4, 4, 4) or none. */
static bool room_write(const volume_box *boxes, int count, bool has_lamp)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.5f);
    lmb_level_material wall = lmb_level_material_default();
    wall.emission = (lmb_rgb){{0.01f, 0.01f, 0.01f}};
    const int material = lmb_level_builder_add_material(builder, &wall);
    const int mesh = lmb_level_builder_add_mesh(builder, "room");
    lmb_level_box room = lmb_level_box_of((lmb_vec3){0, 0, 0}, (lmb_vec3){16, 8, 16}, material);
    room.inward = true;
    lmb_level_builder_add_box(builder, mesh, &room);
    lmb_level_builder_place(builder, "room", mesh, (lmb_vec3){0, 0, 0});
    for (int i = 0; i < count; ++i) {
        lmb_level_builder_add_volume(builder, "box", boxes[i].min, boxes[i].max, &boxes[i].volume);
    }
    const lmb_level_light bulb = {
        .name = "bulb", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1, 1, 1}}, .intensity = 100};
    lmb_level_node lamp = lmb_level_node_default("bulb");
    lamp.light = has_lamp ? lmb_level_builder_add_light(builder, &bulb) : LMB_LEVEL_NONE;
    lamp.translation = (lmb_vec3){4, 4, 4};
    lmb_level_builder_add_node(builder, &lamp);
    lmb_error error = {{0}};
    const lmb_result result = lmb_level_builder_write(builder, PATH, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

typedef struct placed {
    lmb_level level;
    bool is_open;
    lmb_bake bake;
    warning_log log;
    lmb_result result;
    lmb_error error;
} placed;

static lmb_bake_settings small_settings(float spacing, float min_spacing)
{
    lmb_bake_settings settings = lmb_bake_settings_default();
    settings.level.path = PATH;
    settings.level.threads = 2;
    settings.spacing = spacing;
    settings.min_spacing = min_spacing;
    return settings;
}

/* What a bake of these settings places in the room. */
static void place(placed *to, const lmb_bake_settings *settings)
{
    *to = (placed){.result = LMB_OK};
    const lmb_warnings warnings = {warning_keep, &to->log};
    to->result = lmb_level_open(&settings->level, &warnings, NULL, &to->level, &to->error);
    to->is_open = to->result == LMB_OK;
    if (!to->is_open) {
        return;
    }
    to->bake = lmb_bake_begin(settings, &to->level, NULL);
    to->result = lmb_bake_place(&to->bake, &to->error);
    to->result = to->result == LMB_OK ? lmb_bake_surface(&to->bake, &to->error) : to->result;
    to->result = to->result == LMB_OK ? lmb_bake_levels(&to->bake, &to->error) : to->result;
    lmb_error invalid = {{0}};
    CHECK(to->result != LMB_OK || lmb_probes_validate(to->bake.probes, &invalid) == LMB_OK, "%s", invalid.message);
}

static void placed_free(placed *from)
{
    if (from->is_open) {
        lmb_bake_end(&from->bake);
        lmb_level_close(&from->level);
    }
}

/* The spacing of the cell around a place, 0 where there is none. */
static double spacing_at(const lmb_probes *probes, lmb_vec3d at)
{
    lmb_probe_cell cell;
    return lmb_probes_cell(probes, at, &cell) ? (double)probes->level[cell.level].lattice.spacing : 0.0;
}

/* Calls for random places of the room. */
static lmb_vec3d place_of(uint64_t *state)
{
    const double x = fixture_random(state), y = fixture_random(state), z = fixture_random(state);
    return (lmb_vec3d){0.05 + 15.9 * x, 0.05 + 7.9 * y, 0.05 + 15.9 * z};
}

/* On an even lattice of 2 m: at random places the cell is no coarser than the box's rule says, and, a cube of the
 * coarsest level away from what wants another, no finer. */
static void spacing_is_the_boxes(void)
{
    const volume_box boxes[BOXES_MOST] = {
        {{0, 0, 0}, {4, 8, 8}, {.spacing = 0.5f}},
        {{8, 0, 0}, {16, 8, 16}, {.spacing = 4.0f, .priority = -1}},
        {{12, 0, 8}, {16, 4, 16}, {.spacing = 1.3f}}, /* rounded down to 1 */
    };
    placed room;
    const lmb_bake_settings settings = small_settings(2.0f, 0.0f);
    if (!room_write(boxes, BOXES_MOST, true)) {
        return;
    }
    place(&room, &settings);
    CHECK(room.result == LMB_OK, "%s", room.error.message);
    uint64_t state = 3;
    int found[4] = {0};
    for (int i = 0; i < 4000 && room.result == LMB_OK; ++i) {
        const lmb_vec3d at = place_of(&state);
        const int32_t box = lmb_scene_probe_box(room.level.scene, (lmb_vec3){(float)at.x, (float)at.y, (float)at.z});
        static const double wanted[4] = {2.0, 0.5, 4.0, 1.0};
        const double spacing = spacing_at(room.bake.probes, at);
        CHECK(spacing > 0.0 && spacing <= wanted[box + 1], "%g %g %g: %g m", at.x, at.y, at.z, spacing);
        found[box + 1] += spacing == wanted[box + 1];
    }
    for (int i = 0; i < 4; ++i) {
        CHECK(found[i] > 100, "rule %d: %d", i, found[i]);
    }
    CHECK(room.bake.record.level_count == 4, "%u levels", room.bake.record.level_count);
    CHECK(room.bake.record.settings.spacing == 2.0f && room.bake.record.settings.min_spacing == 0.0f, "%g, %g",
          (double)room.bake.record.settings.spacing, (double)room.bake.record.settings.min_spacing);
    placed_free(&room);
}

/* A box that lies beneath another one, and one that says what the level says, change nothing. */
static void boxes_beneath_do_not_count(void)
{
    const volume_box boxes[] = {
        {{1, 1, 1}, {3, 3, 3}, {.spacing = 0.25f}},
        {{0, 0, 0}, {4, 4, 4}, {.spacing = 2.0f, .priority = 1}},
    };
    int32_t count[2];
    for (int i = 0; i < 2; ++i) {
        placed room;
        const lmb_bake_settings settings = small_settings(2.0f, 0.0f);
        if (!room_write(boxes, i == 0 ? 0 : 2, false)) {
            return;
        }
        place(&room, &settings);
        CHECK(room.result == LMB_OK, "%s", room.error.message);
        count[i] = room.result == LMB_OK ? room.bake.probes->count : -i;
        placed_free(&room);
    }
    CHECK(count[0] == count[1] && count[0] == 9 * 5 * 9, "%d, %d", count[0], count[1]);
}

/* No cell has a wanted corner there, of an even lattice and of levels; the cells that reach out keep their corners, and
 * these are baked. */
static void excluded_boxes_are_empty(void)
{
    const volume_box boxes[] = {{{5, 0, 0}, {11, 8, 16}, {.exclude = true}}};
    for (int levels = 0; levels < 2; ++levels) {
        placed room;
        lmb_bake_settings settings = small_settings(2.0f, levels ? 0.5f : 0.0f);
        settings.tolerance = 0.02;
        if (!room_write(boxes, 1, true)) {
            return;
        }
        place(&room, &settings);
        CHECK(room.result == LMB_OK, "%s", room.error.message);
        uint64_t state = 9;
        int inside = 0, outside = 0;
        for (int i = 0; i < 4000 && room.result == LMB_OK; ++i) {
            const lmb_vec3d at = place_of(&state);
            const bool has = spacing_at(room.bake.probes, at) > 0.0;
            /* Cells of 2 m with a corner outside reach to 6 and from 10. */
            CHECK(at.x < 6.01 || at.x > 9.99 || !has, "levels %d: %g %g %g", levels, at.x, at.y, at.z);
            CHECK((at.x > 4.99 && at.x < 11.01) || has, "%g %g %g", at.x, at.y, at.z);
            inside += !has;
            outside += has;
        }
        CHECK(inside > 500 && outside > 500, "levels %d: %d, %d of %d", levels, inside, outside,
              room.bake.record.probes);
        CHECK(room.result != LMB_OK || room.bake.record.placement.probes_dilated == 0, "%d dilated",
              room.bake.record.placement.probes_dilated);
        placed_free(&room);
    }
}

static void nothing_is_left(void)
{
    const volume_box boxes[] = {{{-1, -1, -1}, {17, 17, 17}, {.exclude = true}}};
    for (int levels = 0; levels < 2; ++levels) {
        placed room;
        const lmb_bake_settings settings = small_settings(2.0f, levels ? 1.0f : 0.0f);
        if (!room_write(boxes, 1, true)) {
            return;
        }
        place(&room, &settings);
        CHECK(room.result == LMB_ERROR_UNSUPPORTED && strstr(room.error.message, "boxes without probes"), "%d: '%s'",
              (int)room.result, room.error.message);
        placed_free(&room);
    }
}

/* Of a lamp's light: a box with a smaller tolerance is finer, and one with a limit is nowhere finer than that. */
static void tolerance_is_the_boxes(void)
{
    const volume_box plain = {{0, 0, 0}, {8, 8, 8}, {.priority = 0}};
    const lmb_level_volume volumes[] = {{.tolerance = 0.4f}, {.tolerance = 0.005f}, {.min_spacing = 2.0f}};
    double mean[3] = {0};
    for (int v = 0; v < 3; ++v) {
        volume_box box = plain;
        box.volume = volumes[v];
        lmb_bake_settings settings = small_settings(4.0f, 0.5f);
        settings.tolerance = 0.04;
        placed room;
        if (!room_write(&box, 1, true)) {
            return;
        }
        place(&room, &settings);
        CHECK(room.result == LMB_OK, "%s", room.error.message);
        uint64_t state = 21;
        double finest = 4.0;
        for (int i = 0; i < 2000 && room.result == LMB_OK; ++i) {
            const lmb_vec3d any = place_of(&state);
            const lmb_vec3d at = {0.5 * any.x, any.y, 0.5 * any.z};
            const double spacing = spacing_at(room.bake.probes, at);
            mean[v] += spacing / 2000.0;
            finest = fmin(finest, spacing);
        }
        CHECK(v != 2 || finest == 2.0, "%g m", finest);
        placed_free(&room);
    }
    CHECK(mean[1] < 0.7 * mean[0] && mean[2] > 1.999, "%g, %g, %g", mean[0], mean[1], mean[2]);
}

/* Adaptive levels keep to --max-probes by raising tolerances, and boxes by losing their finest levels; both is said. */
static void probes_are_limited(void)
{
    const volume_box boxes[] = {{{0, 0, 0}, {8, 8, 8}, {.spacing = 0.25f}}};
    for (int with_box = 0; with_box < 2; ++with_box) {
        placed room;
        lmb_bake_settings settings = small_settings(2.0f, with_box ? 0.0f : 0.25f);
        settings.tolerance = 0.001;
        settings.max_probes = 3000;
        if (!room_write(boxes, with_box, true)) {
            return;
        }
        place(&room, &settings);
        const lmb_placement_stats *stats = &room.bake.record.placement;
        CHECK(room.result == LMB_OK && room.bake.probes->count <= 3000 && room.bake.probes->count > 900,
              "%d probes: %s", room.bake.record.probes, room.error.message);
        CHECK(with_box ? stats->levels_lost > 0 : stats->tolerance_scale > 1.0, "%g, %u", stats->tolerance_scale,
              stats->levels_lost);
        CHECK(room.log.count == 1 && strstr(room.log.last, "no more than 3000 probes"), "'%s'", room.log.last);
        placed_free(&room);
    }
}

static const test_case cases[] = {
    {"spacing is the boxes'", spacing_is_the_boxes},        {"boxes beneath do not count", boxes_beneath_do_not_count},
    {"excluded boxes are empty", excluded_boxes_are_empty}, {"nothing is left", nothing_is_left},
    {"tolerance is the boxes'", tolerance_is_the_boxes},    {"probes are limited", probes_are_limited},
};

TEST_MAIN(cases)
