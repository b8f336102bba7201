/* Objects that are wound inside out: which they are, which side their texels are on, and lamps that are shut in. */
#include <sys/stat.h>

#include <lambent/file.h>
#include <lambent/placement.h>
#include <lambent/surface.h>

#include "lightmap_fixture.h"

/* What stands on the floor: a block of 1 m, and what else there may be. */
typedef struct stage {
    const char *name;
    bool outward; /* as it should be; else inside out */
    bool single_sided;
    bool without_floor;
    bool lid_missing;
    bool in_rock; /* the block is a hollow in a large one */
    bool mirrored;
    bool emissive;
    bool leafy; /* see-through */
    bool lamp_inside, seed_inside, moving_inside;
    bool joined;     /* one mesh with a box that stands beside it, wound as it should be */
    bool furnished;  /* one mesh with such a box inside */
    float vase;      /* height of a small box's bottom; 0: none. The block's top is at 1 */
    bool turned;     /* what is right */
    bool complained; /* one warning with the block's name */
} stage;

static const stage STAGES[] = {
    {.name = "as it should be", .outward = true},
    {.name = "inside out", .turned = true},
    {.name = "inside out and mirrored", .mirrored = true, .turned = true},
    {.name = "single-sided", .single_sided = true, .complained = true},
    {.name = "single-sided as it should be", .single_sided = true, .outward = true},
    {.name = "a room with a lamp", .lamp_inside = true},
    {.name = "a room with a seed", .seed_inside = true},
    {.name = "a room with something that moves", .moving_inside = true},
    {.name = "a room with a vase", .vase = 0.3f},
    {.name = "a vase sunk into its top", .vase = 0.98f, .turned = true},
    {.name = "nothing around", .without_floor = true},
    {.name = "a hollow in rock", .in_rock = true},
    {.name = "open", .lid_missing = true},
    {.name = "a lamp itself", .emissive = true},
    {.name = "of leaves", .leafy = true},
    {.name = "joined with another", .joined = true, .complained = true},
    {.name = "joined as it should be", .joined = true, .outward = true},
    {.name = "a furnished room", .furnished = true},
    {.name = "a furnished room, joined with another", .furnished = true, .joined = true},
};

static int stage_material(lmb_level_builder *builder, const stage *s)
{
    lmb_level_material material = lmb_level_material_default();
    material.double_sided = !s->single_sided;
    material.alpha_mode = s->leafy ? LMB_LEVEL_BLEND : LMB_LEVEL_OPAQUE;
    material.alpha = s->leafy ? 0.5f : 1.0f;
    material.emission = (lmb_rgb){{s->emissive ? 1.0f : 0.0f, 0.0f, 0.0f}};
    return lmb_level_builder_add_material(builder, &material);
}

static void block_add(lmb_level_builder *builder, const stage *s)
{
    const int material = stage_material(builder, s);
    const int block = lmb_level_builder_add_mesh(builder, "block");
    lmb_level_box box = lmb_level_box_of((lmb_vec3){-0.5f, 0, -0.5f}, (lmb_vec3){0.5f, 1, 0.5f}, material);
    box.inward = !s->outward;
    box.material[3] = s->lid_missing ? LMB_LEVEL_NONE : material;
    lmb_level_builder_add_box(builder, block, &box);
    if (s->joined) {
        box = lmb_level_box_of((lmb_vec3){1, 0, -0.5f}, (lmb_vec3){2, 1, 0.5f}, material);
        lmb_level_builder_add_box(builder, block, &box);
    }
    if (s->furnished) {
        box = lmb_level_box_of((lmb_vec3){-0.2f, 0.2f, -0.2f}, (lmb_vec3){0.2f, 0.4f, 0.2f}, material);
        lmb_level_builder_add_box(builder, block, &box);
    }
    lmb_level_node node = lmb_level_node_default("block");
    node.mesh = block;
    node.scale.x = s->mirrored ? -1.0f : 1.0f;
    lmb_level_builder_add_node(builder, &node);
}

static void box_place(lmb_level_builder *builder, const char *name, lmb_vec3 min, lmb_vec3 max, bool dynamic)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    const lmb_level_box box = lmb_level_box_of(min, max, plain_material(builder, 0.0f));
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_node node = lmb_level_node_default(name);
    node.mesh = mesh;
    node.dynamic = dynamic;
    lmb_level_builder_add_node(builder, &node);
}

static void lamp_place(lmb_level_builder *builder, lmb_level_light_type type, lmb_vec3 at)
{
    const lmb_level_light light = {"lamp", type, {{1.0f, 1.0f, 1.0f}}, 1.0f, 0.0f, 0.2f, 0.5f};
    lmb_level_node node = lmb_level_node_default("lamp");
    node.light = lmb_level_builder_add_light(builder, &light);
    node.translation = at;
    lmb_level_look_along((lmb_vec3){0.0f, -1.0f, 0.0f}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

static lmb_result stage_write(const char *path, const stage *s, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    if (!s->without_floor) {
        const int floor = lmb_level_builder_add_mesh(builder, "floor");
        lmb_level_builder_add_quad(builder, floor, plain_material(builder, 0.0f), (lmb_vec3){-4, 0, 4},
                                   (lmb_vec3){8, 0, 0}, (lmb_vec3){0, 0, -8});
        lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    }
    block_add(builder, s);
    if (s->in_rock) {
        box_place(builder, "rock", (lmb_vec3){-2, -1, -2}, (lmb_vec3){2, 2, 2}, false);
    }
    if (s->vase > 0.0f) {
        box_place(builder, "vase", (lmb_vec3){-0.1f, s->vase, -0.1f}, (lmb_vec3){0.1f, s->vase + 0.3f, 0.1f}, false);
    }
    if (s->moving_inside) {
        box_place(builder, "cat", (lmb_vec3){-0.1f, 0.2f, -0.1f}, (lmb_vec3){0.1f, 0.4f, 0.1f}, true);
    }
    if (s->lamp_inside) {
        lamp_place(builder, LMB_LEVEL_LIGHT_POINT, (lmb_vec3){0.1f, 0.6f, 0.1f});
    }
    lmb_level_node seed = lmb_level_node_default("seed");
    seed.seed = s->seed_inside;
    seed.translation = (lmb_vec3){0.1f, 0.5f, 0.2f};
    lmb_level_builder_add_node(builder, &seed);
    add_sun(builder, 3.14159265f);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static uint32_t instance_named(const lmb_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (strcmp(scene->instances[i].name, name) == 0) {
            return i;
        }
    }
    CHECK(false, "no node %s", name);
    return 0;
}

/* Counts the lines that are said, and those with a text. */
typedef struct listener {
    const char *text;
    int lines, with_text;
} listener;

static void line_count(void *context, const char *line)
{
    listener *heard = context;
    ++heard->lines;
    heard->with_text += strstr(line, heard->text) != NULL;
}

/* What a ray from above meets, and what placement thinks of a point in front of the block. */
static void check_sides(const level_fixture *level, const stage *s)
{
    lmb_hit hit;
    const uint32_t block = instance_named(level->scene, "block");
    CHECK(lmb_tracer_is_turned(level->tracer, block) == s->turned, "%s: %s", s->name,
          s->turned ? "not turned" : "turned");
    if (s->vase > 0.0f || s->lid_missing || s->in_rock) {
        return;
    }
    CHECK(lmb_trace_nearest(level->tracer, (lmb_vec3){0.2f, 5, 0.1f}, (lmb_vec3){0, -1, 0}, 0.0f, 100.0f, &hit) &&
              hit.instance == block && hit.front == (s->outward || s->turned),
          "%s: the wrong side", s->name);
    const lmb_place place = lmb_trace_place(level->tracer, &hit);
    const float up = s->outward || s->turned ? 1.0f : -1.0f;
    CHECK(place.geometric_normal.y == up && place.shading_normal.y == up, "%s: normals %g and %g", s->name,
          (double)place.geometric_normal.y, (double)place.shading_normal.y);
    uint64_t rays = 0;
    CHECK(!s->turned || (lmb_placement_is_free(level->tracer, (lmb_vec3){0.6f, 0.5f, 0}, &rays) &&
                         !lmb_placement_is_free(level->tracer, (lmb_vec3){0.1f, 0.5f, 0.2f}, &rays)),
          "%s: solid and free space", s->name);
}

static void objects_are_told_from_rooms(void)
{
    for (size_t i = 0; i < sizeof STAGES / sizeof STAGES[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("inside_out.glb");
        level_fixture level;
        if (!level_fixture_open(&level, path, stage_write(path, &STAGES[i], &error), &error, 1)) {
            return;
        }
        check_sides(&level, &STAGES[i]);
        listener heard = {"'block' is wound inside out", 0, 0};
        lmb_tracer_warn(level.tracer, &(lmb_warnings){line_count, &heard});
        CHECK(heard.lines == STAGES[i].complained && heard.with_text == heard.lines, "%s: %d warnings", STAGES[i].name,
              heard.lines);
        level_fixture_close(&level);
    }
}

/* The sun's pi lux from straight above: I_z is 1 on the block's top, and 0 on its sides and bottom. */
static double block_top_light(const lmb_lightmap *lightmap, uint32_t block, double *sides)
{
    const lmb_mesh *mesh = &lightmap->scene->meshes[lightmap->scene->instances[block].mesh];
    double top = 0.0;
    *sides = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        bool is_top = true;
        for (int k = 0; k < 3; ++k) {
            is_top = is_top && mesh->position[mesh->triangle[t][k]].y > 0.99f;
        }
        const double light = (double)sample_irradz(lightmap, block, t, 0.33f, 0.33f).irradiance_z.c[0];
        top += is_top ? 0.5 * light : 0.0;
        *sides += is_top ? 0.0 : light;
    }
    return top;
}

static void texels_are_on_the_side_that_is_seen(void)
{
    static const stage TURNED[] = {{.name = "as it should be", .outward = true},
                                   {.name = "inside out", .turned = true},
                                   {.name = "inside out and mirrored", .mirrored = true, .turned = true}};
    for (size_t i = 0; i < sizeof TURNED / sizeof TURNED[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("inside_out_texels.glb");
        baked bake;
        if (!baked_open(&bake, path, stage_write(path, &TURNED[i], &error), &error,
                        (baked_settings){.texels_per_m = 8.0f, .samples = 8, .threads = 2})) {
            return;
        }
        const uint32_t block = instance_named(bake.level.scene, "block");
        double sides;
        CHECK_NEAR(block_top_light(bake.lightmap, block, &sides), 1.0, 0.01, "%s", TURNED[i].name);
        CHECK_NEAR(sides, 0.0, 0.01, "%s: sides", TURNED[i].name);

        /* The file says so, and gives it back. */
        const char *directory = OUTPUT("inside_out");
        mkdir(directory, 0777);
        uint64_t bytes = 0;
        unsigned char *json = NULL;
        size_t size = 0;
        lmb_lightmap *again = NULL;
        CHECK(lmb_lightmap_write(bake.lightmap, directory, NULL, &bytes, &error) == LMB_OK &&
                  lmb_file_read(OUTPUT("inside_out/lightmap.json"), &json, &size, &error) == LMB_OK &&
                  lmb_lightmap_create(bake.level.scene, &bake.lightmap->settings, &again, &error) == LMB_OK &&
                  lmb_lightmap_read(again, directory, &error) == LMB_OK,
              "%s", error.message);
        CHECK(json && (strstr((const char *)json, "\"side\":\t\"back\"") != NULL) == TURNED[i].turned, "%s: json",
              TURNED[i].name);
        CHECK(again && again->region[block].back == TURNED[i].turned &&
                  bake.lightmap->region[block].back == TURNED[i].turned,
              "%s: read back", TURNED[i].name);
        free(json);
        lmb_lightmap_destroy(again);
        baked_close(&bake);
    }
}

typedef struct lamp_housing {
    float half; /* of its edges; 0: there is none */
    bool lid, glass;
} lamp_housing;

/* A hall of 10 m with a lamp in a small box or behind its ceiling. */
static lmb_result lamp_write(const char *path, lmb_level_light_type type, float at_height, lamp_housing housing,
                             lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(1.0f);
    const int material = plain_material(builder, 0.5f);
    const int hall = lmb_level_builder_add_mesh(builder, "hall");
    lmb_level_box walls = lmb_level_box_of((lmb_vec3){-3, 0, -3}, (lmb_vec3){3, 5, 3}, material);
    walls.inward = true;
    lmb_level_builder_add_box(builder, hall, &walls);
    lmb_level_builder_place(builder, "hall", hall, (lmb_vec3){0, 0, 0});
    lmb_level_material clear = lmb_level_material_default();
    clear.alpha_mode = LMB_LEVEL_BLEND;
    clear.alpha = 0.2f;
    const int housing_material = housing.glass ? lmb_level_builder_add_material(builder, &clear) : material;
    if (housing.half > 0.0f) {
        const float half = housing.half;
        const int mesh = lmb_level_builder_add_mesh(builder, "housing");
        lmb_level_box box =
            lmb_level_box_of((lmb_vec3){-half, -half, -half}, (lmb_vec3){half, half, half}, housing_material);
        box.material[2] = housing.lid ? housing_material : LMB_LEVEL_NONE;
        lmb_level_builder_add_box(builder, mesh, &box);
        lmb_level_builder_place(builder, "housing", mesh, (lmb_vec3){0, at_height, 0});
    }
    lamp_place(builder, type, (lmb_vec3){0, at_height, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void lamps_that_are_shut_in_are_named(void)
{
    static const struct {
        const char *what;
        lmb_level_light_type type;
        float at_height;
        lamp_housing housing;
        const char *says; /* NULL: nothing */
    } CASES[] = {
        {"free", LMB_LEVEL_LIGHT_POINT, 2.0f, {0.0f, false, false}, NULL},
        {"in a box", LMB_LEVEL_LIGHT_POINT, 2.0f, {0.015f, true, false}, "'housing'"},
        {"in an open box", LMB_LEVEL_LIGHT_POINT, 2.0f, {0.015f, false, false}, NULL},
        {"in glass", LMB_LEVEL_LIGHT_POINT, 2.0f, {0.015f, true, true}, NULL},
        {"in a chamber", LMB_LEVEL_LIGHT_POINT, 2.0f, {0.5f, true, false}, NULL},
        {"a spot in an open can", LMB_LEVEL_LIGHT_SPOT, 2.0f, {0.015f, false, false}, NULL},
        {"a spot in a closed can", LMB_LEVEL_LIGHT_SPOT, 2.0f, {0.015f, true, false}, "'housing'"},
        {"a spot above the ceiling", LMB_LEVEL_LIGHT_SPOT, 5.01f, {0.0f, false, false}, "'hall'"},
        {"a spot below the ceiling", LMB_LEVEL_LIGHT_SPOT, 4.99f, {0.0f, false, false}, NULL},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; ++i) {
        lmb_error error = {""};
        const char *path = OUTPUT("inside_out_lamp.glb");
        level_fixture level;
        if (!level_fixture_open(&level, path,
                                lamp_write(path, CASES[i].type, CASES[i].at_height, CASES[i].housing, &error), &error,
                                1)) {
            return;
        }
        listener heard = {CASES[i].says ? CASES[i].says : "light 'lamp'", 0, 0};
        lmb_tracer_warn(level.tracer, &(lmb_warnings){line_count, &heard});
        CHECK(heard.lines == (CASES[i].says != NULL) && heard.with_text == heard.lines, "%s: %d warnings",
              CASES[i].what, heard.lines);
        level_fixture_close(&level);
    }
}

static const test_case CASES[] = {
    {"objects are told from rooms", objects_are_told_from_rooms},
    {"texels are on the side that is seen", texels_are_on_the_side_that_is_seen},
    {"lamps that are shut in are named", lamps_that_are_shut_in_are_named},
};

TEST_MAIN(CASES)
