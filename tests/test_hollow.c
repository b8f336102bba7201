/* Walls and floors that are shells: open where the level hides it, or closed around nothing. What they hide is dark,
 * and must not be what their faces are lit by. */
#include <lambent/placement.h>
#include <lambent/probes_bake.h>
#include <lambent/regions.h>

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "harness.h"
#include "scenes/level_blocks.h"
#include "scenes/level_builder.h"
#include "level_fixture.h"

/* Two rooms beside each other, each of 4 x 3 x 4 m, the wall between them about x = 0. Lattice points at y = 0 and
 * x = 0 lie in the shells. */
#define ROOM_M 4.0f
#define HEIGHT_M 3.0f
#define STONE_M 0.06f  /* tops of the floor's stones */
#define GROOVE_M 0.02f /* what is between them */
#define NICHE_M 0.2f   /* deep */
#define SHEET_X 0.13f  /* off the planes of probes */

typedef enum wall_kind { SHELL, CLOSED, CLOSED_DOUBLE_SIDED, INSIDE_OUT, WALL_KINDS } wall_kind;
static const char *const kind_name[WALL_KINDS] = {"shell", "closed", "closed, double-sided", "inside out"};

typedef struct hollow_scene {
    wall_kind kind;
    float thick_m; /* of the wall between */
} hollow_scene;

/* A box without its top and bottom. */
static void shell_add(lmb_level_builder *builder, int mesh, int material, lmb_vec3 min, lmb_vec3 max)
{
    lmb_level_box box = lmb_level_box_of(min, max, material);
    box.material[2] = box.material[3] = LMB_LEVEL_NONE;
    lmb_level_builder_add_box(builder, mesh, &box);
}

/* Stones in rows along x, grooves between them, with nothing below. */
static void floor_add(lmb_level_builder *builder, int mesh, int material)
{
    const float half = ROOM_M + 0.5f, pitch = 0.7f, groove = 0.14f, rise = STONE_M - GROOVE_M;
    const lmb_vec3 along = {2.0f * half, 0.0f, 0.0f};
    for (float z = -3.5f; z < 3.4f; z += pitch) {
        lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-half, GROOVE_M, z}, (lmb_vec3){0, 0, groove},
                                   along);
        lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-half, GROOVE_M, z + groove},
                                   (lmb_vec3){0, rise, 0}, along);
        lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-half, STONE_M, z + groove},
                                   (lmb_vec3){0, 0, pitch - groove}, along);
        lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-half, STONE_M, z + pitch},
                                   (lmb_vec3){0, -rise, 0}, along);
    }
}

static void walls_add(lmb_level_builder *builder, int mesh, int material)
{
    const float near = 2.0f, far = 2.6f, low = -0.3f, high = HEIGHT_M + 0.3f, end = ROOM_M + 0.6f;
    shell_add(builder, mesh, material, (lmb_vec3){-end, low, -far}, (lmb_vec3){end, high, -near});
    shell_add(builder, mesh, material, (lmb_vec3){-end, low, near}, (lmb_vec3){end, high, far});
    shell_add(builder, mesh, material, (lmb_vec3){-end, low, -near}, (lmb_vec3){-ROOM_M, high, near});
    shell_add(builder, mesh, material, (lmb_vec3){ROOM_M, low, -near}, (lmb_vec3){end, high, near});
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-end, HEIGHT_M, -far}, (lmb_vec3){2 * end, 0, 0},
                               (lmb_vec3){0, 0, 2 * far});
}

static void torch_add(lmb_level_builder *builder, const char *name, lmb_vec3 at)
{
    const lmb_level_light light = {
        .name = name, .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 1.0f, 1.0f}}, .intensity = 100.0f};
    lmb_level_node node = lmb_level_node_default(name);
    node.light = lmb_level_builder_add_light(builder, &light);
    node.translation = at;
    lmb_level_builder_add_node(builder, &node);
}

static lmb_result scene_write(const hollow_scene *scene, const char *path, lmb_error *error)
{
    lmb_level_builder *const builder = lmb_level_builder_create(0.2f);
    lmb_level_material grey = lmb_level_material_default();
    const int plain = lmb_level_builder_add_material(builder, &grey);
    grey.double_sided = scene->kind >= CLOSED_DOUBLE_SIDED;
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int rooms = lmb_level_builder_add_mesh(builder, "rooms"), wall = lmb_level_builder_add_mesh(builder, "wall");
    const float half = 0.5f * scene->thick_m;
    floor_add(builder, rooms, plain);
    walls_add(builder, rooms, plain);
    const lmb_vec3 low = {-half, -0.3f, -2.3f}, high = {half, HEIGHT_M + 0.3f, 2.3f};
    if (scene->kind == SHELL) {
        shell_add(builder, wall, material, low, high);
    } else {
        lmb_level_box box = lmb_level_box_of(low, high, material);
        box.inward = scene->kind == INSIDE_OUT;
        lmb_level_builder_add_box(builder, wall, &box);
    }
    lmb_level_builder_place(builder, "rooms", rooms, (lmb_vec3){0, 0, 0});
    lmb_level_builder_place(builder, "wall", wall, (lmb_vec3){0, 0, 0});
    torch_add(builder, "torch", (lmb_vec3){-half - 0.5f, 2.2f, 0.3f});
    torch_add(builder, "lamp", (lmb_vec3){2.1f, 1.6f, -0.4f});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Probes every metre, baked with regions and without seeds. */
static lmb_probes *probes_bake(const level_fixture *level)
{
    lmb_placement_settings settings = lmb_placement_settings_default();
    lmb_placement_stats placed;
    lmb_regions_stats stats;
    lmb_probes *probes = NULL;
    lmb_regions *regions = NULL;
    lmb_probe_list list = {.probe = NULL};
    lmb_error error = {{0}};
    settings.spacing = 1.0f;
    lmb_result result = lmb_placement_make(level->tracer, &settings, level->pool, &probes, &placed, &error);
    result = result == LMB_OK ? lmb_regions_make(level->tracer, level->pool, NULL, probes, &regions, &stats) : result;
    result = result == LMB_OK ? lmb_probe_list_create(probes, regions, level->tracer, &list) : result;
    const lmb_gather_list elements = lmb_probe_list_elements(&list);
    lmb_gathered *const gathered = calloc(list.count + 1, sizeof *gathered);
    for (size_t i = 0; i < list.count; ++i) {
        lmb_gather_point point;
        lmb_gather_site site = {.point = &point};
        elements.find_site(elements.context, i, &site);
        lmb_gather_sh3(&level->transport, &point, 128, &gathered[i]);
    }
    result = result == LMB_OK ? lmb_probe_list_finish(&list, gathered, level->pool, probes) : result;
    CHECK(result == LMB_OK, "%s %s", lmb_result_text(result), error.message);
    free(gathered);
    lmb_probe_list_free(&list);
    lmb_regions_destroy(regions);
    return probes;
}

typedef struct errors {
    int count;
    double sum, least, most; /* of probes' light over the truth */
} errors;

/* Light of the probes at a point over what is there. */
static void point_compare(const level_fixture *level, const lmb_probes *probes, lmb_vec3 at, errors *found)
{
    const lmb_vec3d world = {(double)at.x, (double)at.y, (double)at.z};
    const lmb_gather_point point = {.position = lmb_scene_from_world(level->scene, world)};
    lmb_gathered truth;
    lmb_gather_sh3(&level->transport, &point, 256, &truth);
    const double ratio =
        (double)lmb_probes_light(probes, 0, world).channel[0].c[0] / (double)truth.moments.channel[0].c[0];
    found->least = found->count == 0 || ratio < found->least ? ratio : found->least;
    found->most = found->count == 0 || ratio > found->most ? ratio : found->most;
    found->sum += fabs(ratio - 1.0);
    ++found->count;
}

/* Before both faces of the wall, and over the stones and in the grooves of both rooms. */
static void faces_compare(const level_fixture *level, const lmb_probes *probes, float half, errors *wall,
                          errors *ground)
{
    enum { ALONG = 9, UP = 7, ACROSS = 40 };
    const float before = 0.003f;
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < ALONG * UP; ++i) {
            const float z = -1.9f + 3.8f * ((float)(i % ALONG) + 0.5f) / ALONG;
            const float y = 0.1f + 2.8f * ((float)(i / ALONG) + 0.5f) / UP;
            point_compare(level, probes, lmb_vec3_of((float)side * (half + before), y, z), wall);
        }
        for (int i = 0; i < ALONG * ACROSS; ++i) {
            const float z = -1.9f + 3.8f * ((float)(i / ALONG) + 0.5f) / ACROSS;
            const float x = half + 0.1f + 3.6f * ((float)(i % ALONG) + 0.5f) / ALONG;
            const float into = fmodf(z + 3.5f, 0.7f); /* a groove, then a stone */
            if (into > 0.01f && into < 0.69f && fabsf(into - 0.14f) > 0.01f) {
                const float top = into < 0.14f ? GROOVE_M : STONE_M;
                point_compare(level, probes, lmb_vec3_of((float)side * x, top + before, z), ground);
            }
        }
    }
}

/* Eight values a cell err beside a torch and in shadows: by a tenth in the mean, and in the shadow of a stone by a
 * factor of more than two, but never towards the dark of what is behind. */
static void errors_check(const hollow_scene *scene, const char *where, const errors *found)
{
    CHECK(found->sum < 0.11 * found->count && found->least > 0.5 && found->most < 2.6,
          "%s, %g m: %s: off by %g in the mean of %d points, from %g to %g", kind_name[scene->kind],
          (double)scene->thick_m, where, found->sum / found->count, found->count, found->least, found->most);
}

static void faces_are_lit_by_what_is_before_them(void)
{
    for (int i = 0; i < 2 * WALL_KINDS; ++i) {
        const hollow_scene scene = {.kind = (wall_kind)(i % WALL_KINDS), .thick_m = i < WALL_KINDS ? 0.2f : 0.4f};
        const char *const path = LMB_TEST_OUTPUT_DIR "/hollow.glb";
        lmb_error error = {{0}};
        level_fixture level;
        if (!level_fixture_open(&level, path, scene_write(&scene, path, &error), &error, 2)) {
            return;
        }
        lmb_probes *const probes = probes_bake(&level);
        errors wall = {.count = 0}, ground = {.count = 0};
        faces_compare(&level, probes, 0.5f * scene.thick_m, &wall, &ground);
        errors_check(&scene, "wall", &wall);
        errors_check(&scene, "floor", &ground);
        lmb_probes_destroy(probes);
        level_fixture_close(&level);
    }
}

/* A sheet that is seen from one side alone stands between a lit room and a dark one. */
static lmb_result sheet_write(const char *path, float turn, lmb_error *error)
{
    lmb_level_builder *const builder = lmb_level_builder_create(0.2f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int rooms = lmb_level_builder_add_mesh(builder, "rooms"),
              sheet = lmb_level_builder_add_mesh(builder, "sheet");
    lmb_level_box box = lmb_level_box_of((lmb_vec3){-2, 0.07f, -2}, (lmb_vec3){2, 2.9f, 2}, material);
    box.inward = true;
    lmb_level_builder_add_box(builder, rooms, &box);
    lmb_level_builder_add_quad(builder, sheet, material, (lmb_vec3){0, -0.5f, -5}, (lmb_vec3){0, 0, 10},
                               (lmb_vec3){0, 4, 0});
    lmb_level_builder_place(builder, "rooms", rooms, (lmb_vec3){0, 0, 0});
    lmb_level_node node = lmb_level_node_default("sheet");
    node.mesh = sheet;
    node.translation = (lmb_vec3){SHEET_X, 0, 0};
    lmb_level_turn(turn, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    torch_add(builder, "torch", (lmb_vec3){-1.2f, 1.6f, 0.3f});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void what_lies_on_a_sheet_is_before_it(void)
{
    static const float turns[] = {0.0f, 0.1f, -0.2f, 0.35f, -0.7f};
    for (size_t i = 0; i < sizeof turns / sizeof turns[0]; ++i) {
        const char *const path = LMB_TEST_OUTPUT_DIR "/hollow_sheet.glb";
        lmb_error error = {{0}};
        level_fixture level;
        if (!level_fixture_open(&level, path, sheet_write(path, turns[i], &error), &error, 2)) {
            return;
        }
        lmb_probes *const probes = probes_bake(&level);
        errors sheet = {.count = 0};
        for (int k = 0; k < 400; ++k) {
            const double along = -1.5 + 3.0 * (k % 20 + 0.5) / 20.0, before = 2e-6;
            const double cosine = cos((double)turns[i]), sine = sin((double)turns[i]);
            const lmb_vec3 at = {(float)((double)SHEET_X + sine * along - cosine * before),
                                 (float)(0.2 + 2.6 * (k / 20 + 0.5) / 20.0), (float)(cosine * along + sine * before)};
            point_compare(&level, probes, at, &sheet);
        }
        CHECK(sheet.least > 0.4, "turned by %g: down to %g of the light", (double)turns[i], sheet.least);
        lmb_probes_destroy(probes);
        level_fixture_close(&level);
    }
}

/* A torch on a bracket hangs before a niche in the wall of a room, with a board across it: light in the niche and on
 * the bracket differs by a factor of a thousand, within one cell. */
static lmb_result niche_write(const char *path, lmb_vec3 shift, lmb_error *error)
{
    lmb_level_builder *const builder = lmb_level_builder_create(0.2f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const int room = lmb_level_builder_add_mesh(builder, "room");
    const lmb_level_block blocks[] = {
        lmb_level_block_of(true, (lmb_vec3){-3, -1, -3}, (lmb_vec3){3, 4, 3}, material),
        lmb_level_block_of(false, (lmb_vec3){-2, 0, -2}, (lmb_vec3){2, 3, 2}, material),
        lmb_level_block_of(false, (lmb_vec3){-0.4f, 1.2f, -2.0f - NICHE_M}, (lmb_vec3){0.4f, 2.2f, -2}, material),
        lmb_level_block_of(true, (lmb_vec3){-0.5f, 1.55f, -2.1f}, (lmb_vec3){0.5f, 1.7f, -2.0f}, material),
        lmb_level_block_of(true, (lmb_vec3){0.07f, 1.72f, -2.0f}, (lmb_vec3){0.13f, 1.84f, -1.65f}, material)};
    lmb_level_builder_add_blocks(builder, room, blocks, sizeof blocks / sizeof blocks[0]);
    lmb_level_builder_place(builder, "room", room, shift);
    torch_add(builder, "torch", lmb_vec3_add(shift, (lmb_vec3){0.1f, 1.9f, -1.7f}));
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void a_niche_by_a_torch_is_not_black(void)
{
    static const lmb_vec3 shifts[] = {{0.33f, 0.33f, 0.0f}, {0.66f, 0.33f, 0.0f}}; /* off the planes of probes */
    for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; ++i) {
        const lmb_vec3 shift = shifts[i];
        const char *const path = LMB_TEST_OUTPUT_DIR "/hollow_niche.glb";
        lmb_error error = {{0}};
        level_fixture level;
        if (!level_fixture_open(&level, path, niche_write(path, shift, &error), &error, 2)) {
            return;
        }
        lmb_probes *const probes = probes_bake(&level);
        errors niche = {.count = 0};
        for (int k = 0; k < 100; ++k) {
            const lmb_vec3 at = {-0.38f + 0.76f * ((float)(k % 10) + 0.5f) / 10.0f,
                                 1.22f + 0.96f * ((float)(k / 10) + 0.5f) / 10.0f, -2.0f - NICHE_M + 0.003f};
            point_compare(&level, probes, lmb_vec3_add(shift, at), &niche);
        }
        CHECK(niche.least > 0.2, "niche moved by %g, %g: down to %g of the light", (double)shift.x, (double)shift.y,
              niche.least);
        lmb_probes_destroy(probes);
        level_fixture_close(&level);
    }
}

static const test_case cases[] = {
    {"faces are lit by what is before them", faces_are_lit_by_what_is_before_them},
    {"what lies on a sheet is before it", what_lies_on_a_sheet_is_before_it},
    {"a niche by a torch is not black", a_niche_by_a_torch_is_not_black},
};

TEST_MAIN(cases)
