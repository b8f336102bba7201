#include "demo_level.h"

#include "demo_textures.h"
#include "level_blocks.h"

#include <math.h>

static const float gutter_m = 0.3f; /* over two texels at 8 texels per metre */
static const float lux_of_sun = 60;
static const lmb_vec3 sun_direction = {-0.15f, -0.24f, -1};

enum { STEPS = 15 };

typedef struct demo_materials {
    int plaster, red, teal, blue, tiles, wood, brick, lattice, lamp, iron;
} demo_materials;

static int add_textured(lmb_level_builder *builder, const char *name, lmb_rgb tint, int texture, float texture_size_m)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = name;
    material.base_color = tint;
    material.base_color_texture = texture;
    material.texture_size_m = texture_size_m;
    return lmb_level_builder_add_material(builder, &material);
}

static int add_brick(lmb_level_builder *builder)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = "brick";
    material.base_color = (lmb_rgb){{1, 1, 1}};
    material.base_color_texture = lmb_demo_texture_add(builder, LMB_DEMO_BRICK);
    material.normal_texture = lmb_demo_texture_add(builder, LMB_DEMO_BRICK_NORMAL);
    return lmb_level_builder_add_material(builder, &material);
}

static int add_lattice(lmb_level_builder *builder)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = "lattice";
    material.base_color = (lmb_rgb){{0.8f, 0.8f, 0.8f}};
    material.base_color_texture = lmb_demo_texture_add(builder, LMB_DEMO_LATTICE);
    material.alpha_mode = LMB_LEVEL_MASK;
    material.double_sided = true;
    return lmb_level_builder_add_material(builder, &material);
}

static int add_lamp(lmb_level_builder *builder)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = "lamp";
    material.base_color = (lmb_rgb){{0.8f, 0.8f, 0.8f}};
    material.emission = (lmb_rgb){{20, 14, 8}}; /* luminance 15 */
    return lmb_level_builder_add_material(builder, &material);
}

static demo_materials add_materials(lmb_level_builder *builder)
{
    const int plaster = lmb_demo_texture_add(builder, LMB_DEMO_PLASTER);
    const int tiles = lmb_demo_texture_add(builder, LMB_DEMO_TILES);
    const int wood = lmb_demo_texture_add(builder, LMB_DEMO_WOOD);
    return (demo_materials){
        .plaster = add_textured(builder, "plaster", (lmb_rgb){{0.85f, 0.84f, 0.8f}}, plaster, 2),
        .red = add_textured(builder, "red", (lmb_rgb){{0.75f, 0.1f, 0.07f}}, plaster, 2),
        .teal = add_textured(builder, "teal", (lmb_rgb){{0.08f, 0.5f, 0.42f}}, plaster, 2),
        .blue = add_textured(builder, "blue", (lmb_rgb){{0.12f, 0.25f, 0.7f}}, plaster, 2),
        .tiles = add_textured(builder, "tiles", (lmb_rgb){{1, 1, 1}}, tiles, 1),
        .wood = add_textured(builder, "wood", (lmb_rgb){{1, 1, 1}}, wood, 1),
        .brick = add_brick(builder),
        .lattice = add_lattice(builder),
        .lamp = add_lamp(builder),
        .iron = add_textured(builder, "iron", (lmb_rgb){{0.1f, 0.1f, 0.1f}}, LMB_LEVEL_NONE, 1),
    };
}

/* The whole building but for the round things: the hull carved into rooms, then walls and steps put in. */
static void add_building(lmb_level_builder *builder, const demo_materials *m)
{
    const int p = m->plaster;
    lmb_level_block blocks[16 + STEPS] = {
        lmb_level_block_of(true, (lmb_vec3){-0.3f, -0.3f, -0.3f}, (lmb_vec3){10.3f, 6.1f, 8.3f}, LMB_LEVEL_NONE),
        /* west and east room, upper floor */
        {{0, 0, 0}, {4.4f, 2.8f, 8}, false, {m->teal, p, m->tiles, p, p, p}},
        {{4.5f, 0, 0}, {10, 2.8f, 8}, false, {m->brick, p, m->wood, p, p, p}},
        {{0, 3, 0}, {10, 5.8f, 8}, false, {p, m->blue, m->wood, p, p, p}},
        /* doorway, stairwell, windows */
        {{4.4f, 0, 5.2f}, {4.5f, 2.1f, 6.2f}, false, {p, p, m->wood, p, p, p}},
        lmb_level_block_of(false, (lmb_vec3){0, 2.8f, 2.4f}, (lmb_vec3){1, 3, 6}, p),
        lmb_level_block_of(false, (lmb_vec3){7, 0.9f, 8}, (lmb_vec3){9.5f, 2.4f, 8.3f}, p),
        lmb_level_block_of(false, (lmb_vec3){6, 4, 8}, (lmb_vec3){9, 5.3f, 8.3f}, p),
        /* walls of the dark room */
        {{6.95f, 0, 0}, {7, 2.8f, 3.05f}, true, {p, p, p, p, p, m->red}},
        {{7, 0, 3}, {10, 2.8f, 3.05f}, true, {p, p, p, p, p, m->red}},
        /* pillars and a bench */
        lmb_level_block_of(true, (lmb_vec3){3.3f, 3, 3.8f}, (lmb_vec3){3.7f, 5.8f, 4.2f}, p),
        lmb_level_block_of(true, (lmb_vec3){6.3f, 3, 3.8f}, (lmb_vec3){6.7f, 5.8f, 4.2f}, p),
        lmb_level_block_of(true, (lmb_vec3){5, 0, 0.6f}, (lmb_vec3){6.4f, 0.45f, 1.1f}, m->wood),
    };
    size_t count = 13;
    for (int step = 0; step < STEPS; ++step) {
        const float front = (float)(6.45 - 0.27 * step);
        const float back = step == STEPS - 1 ? 2.4f : (float)(6.45 - 0.27 * (step + 1));
        const float top = (float)(0.2 * (step + 1)); /* in double, so that the last ones meet the slab exactly */
        blocks[count++] = (lmb_level_block){{0, 0, back}, {1, top, front}, true, {p, p, p, m->wood, p, p}};
    }
    const int mesh = lmb_level_builder_add_mesh(builder, "building");
    lmb_level_builder_add_blocks(builder, mesh, blocks, count);
    lmb_level_builder_place(builder, "building", mesh, (lmb_vec3){0, 0, 0});
}

/* A screen of holes: before half of the lower window, and as a railing around the stairwell. */
static void add_lattices(lmb_level_builder *builder, const demo_materials *materials)
{
    const struct {
        const char *name;
        lmb_vec3 origin, edge_u, edge_v;
    } screens[] = {
        {"window lattice", {7, 0.9f, 8.15f}, {1.25f, 0, 0}, {0, 1.5f, 0}},
        {"stair railing", {1.03f, 3, 6.03f}, {0, 0, -3.36f}, {0, 0.9f, 0}},
        {"landing railing", {0, 3, 6.03f}, {1.03f, 0, 0}, {0, 0.9f, 0}},
    };
    for (size_t i = 0; i < sizeof screens / sizeof screens[0]; ++i) {
        const int mesh = lmb_level_builder_add_mesh(builder, screens[i].name);
        lmb_level_builder_add_quad(builder, mesh, materials->lattice, (lmb_vec3){0, 0, 0}, screens[i].edge_u,
                                   screens[i].edge_v);
        lmb_level_builder_place(builder, screens[i].name, mesh, screens[i].origin);
    }
}

/* Columns reach into floor and ceiling, so that no faces coincide. */
static void add_columns_and_lamp(lmb_level_builder *builder, const demo_materials *materials)
{
    const int column = lmb_level_builder_add_mesh(builder, "column");
    lmb_level_builder_add_cylinder(
        builder, column, materials->plaster,
        &(lmb_level_cylinder){.base = {0, -0.05f, 0}, .radius = 0.16f, .height = 2.9f, .segments = 24});
    lmb_level_builder_place(builder, "sunny column", column, (lmb_vec3){7.9f, 0, 5.3f});
    lmb_level_builder_place(builder, "shady column", column, (lmb_vec3){5.8f, 0, 2.8f});
    const int lamp = lmb_level_builder_add_mesh(builder, "lamp");
    lmb_level_builder_add_sphere(builder, lamp, materials->lamp,
                                 &(lmb_level_sphere){.centre = {0, 0, 0}, .radius = 0.3f, .divisions = 5});
    lmb_level_builder_place(builder, "lamp", lamp, (lmb_vec3){2.6f, 2.1f, 3.2f});
    const int cord = lmb_level_builder_add_mesh(builder, "lamp cord");
    lmb_level_builder_add_cylinder(
        builder, cord, materials->iron,
        &(lmb_level_cylinder){.base = {0, 0.25f, 0}, .radius = 0.02f, .height = 0.5f, .segments = 8});
    lmb_level_builder_place(builder, "lamp cord", cord, (lmb_vec3){2.6f, 2.1f, 3.2f});
}

static void add_sun(lmb_level_builder *builder)
{
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1, 0.93f, 0.82f}}, .intensity = lux_of_sun};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    node.translation = (lmb_vec3){9, 4, 12};
    lmb_level_look_along(sun_direction, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

static void add_markers(lmb_level_builder *builder)
{
    static const lmb_vec3 path[] = {
        {8.4f, 1, 6.8f},  {8.1f, 0.9f, 3.9f}, {6.4f, 1, 4},       {5.1f, 1, 5.4f},
        {4.45f, 1, 5.7f}, {2.9f, 1.1f, 5.2f}, {2.3f, 1.3f, 3.4f}, {8.5f, 1, 1.5f},
    };
    static const char *const names[] = {"path 0", "path 1", "path 2", "path 3", "path 4", "path 5", "path 6", "path 7"};
    for (int i = 0; i < (int)(sizeof path / sizeof path[0]); ++i) {
        lmb_level_node node = lmb_level_node_default(names[i]);
        node.translation = path[i];
        node.path = i;
        lmb_level_builder_add_node(builder, &node);
    }
    lmb_level_node sunny = lmb_level_node_default("seed");
    sunny.translation = (lmb_vec3){6, 1.2f, 5.5f};
    sunny.seed = true;
    lmb_level_builder_add_node(builder, &sunny);
    lmb_level_node dark = lmb_level_node_default("dark seed");
    dark.translation = (lmb_vec3){8.5f, 1.2f, 1.5f};
    dark.seed = true;
    lmb_level_builder_add_node(builder, &dark);
}

static void add_cameras(lmb_level_builder *builder)
{
    static const struct {
        const char *name;
        lmb_vec3 eye, target;
        float view_angle_rad;
    } cameras[] = {
        {"overview", {4.8f, 1.9f, 7.7f}, {7.6f, 1, 3.2f}, 1.05f},
        {"colour_wall", {6.5f, 1.5f, 7.2f}, {8.2f, 0.8f, 3.2f}, 0.9f},
        {"dark_room", {9.7f, 1.8f, 2.7f}, {8, 0.9f, 0.9f}, 1.05f},
        {"stairs", {4.1f, 1.7f, 7.6f}, {1, 1.3f, 3.4f}, 1.05f},
        {"upper", {9.4f, 4.7f, 0.7f}, {3.4f, 3.6f, 5.6f}, 1.05f},
    };
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; ++i) {
        const lmb_vec3 eye = cameras[i].eye;
        const lmb_vec3 target = cameras[i].target;
        lmb_level_node node = lmb_level_node_default(cameras[i].name);
        node.camera = lmb_level_builder_add_camera(builder, cameras[i].name, cameras[i].view_angle_rad);
        node.translation = eye;
        lmb_level_look_along((lmb_vec3){target.x - eye.x, target.y - eye.y, target.z - eye.z}, node.rotation);
        lmb_level_builder_add_node(builder, &node);
    }
}

/* Fine probes where the lattice throws its shadows, coarse ones on the upper floor, none in the dark room. */
static void add_volumes(lmb_level_builder *builder)
{
    lmb_level_builder_add_volume(builder, "lattice's shadows", (lmb_vec3){5, 0, 5}, (lmb_vec3){10, 2.8f, 8},
                                 &(lmb_level_volume){.spacing = 0.25f});
    lmb_level_builder_add_volume(builder, "upper floor", (lmb_vec3){0, 3, 0}, (lmb_vec3){10, 5.8f, 8},
                                 &(lmb_level_volume){.spacing = 1.0f, .priority = -1});
    lmb_level_builder_add_volume(builder, "nobody gets in", lmb_demo_dark_room_min, lmb_demo_dark_room_max,
                                 &(lmb_level_volume){.exclude = true, .priority = 1});
}

static lmb_result level_write(const char *path, bool has_volumes, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(gutter_m);
    const demo_materials materials = add_materials(builder);
    add_building(builder, &materials);
    add_lattices(builder, &materials);
    add_columns_and_lamp(builder, &materials);
    add_sun(builder);
    add_markers(builder);
    add_cameras(builder);
    if (has_volumes) {
        add_volumes(builder);
    }
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

lmb_result lmb_demo_level_write(const char *path, lmb_error *error)
{
    return level_write(path, false, error);
}

lmb_result lmb_demo_level_write_with_volumes(const char *path, lmb_error *error)
{
    return level_write(path, true, error);
}

typedef struct torus {
    double ring_radius, tube_radius;
} torus;

static lmb_level_point torus_point(const void *context, double u, double v)
{
    const torus *shape = context;
    const double turn = 2 * 3.14159265358979323846;
    const double around = u < 1 ? turn * u : 0; /* the seam meets to the bit */
    const double tube = v < 1 ? turn * v : 0;
    const double out[3] = {sin(around) * cos(tube), sin(tube), cos(around) * cos(tube)};
    return (lmb_level_point){
        {(float)(shape->ring_radius * sin(around) + shape->tube_radius * out[0]), (float)(shape->tube_radius * out[1]),
         (float)(shape->ring_radius * cos(around) + shape->tube_radius * out[2])},
        {(float)out[0], (float)out[1], (float)out[2]},
        {(float)cos(around), 0, (float)-sin(around)},
    };
}

lmb_result lmb_demo_object_write(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.02f);
    lmb_level_material material = lmb_level_material_default();
    material.name = "clay";
    material.base_color = (lmb_rgb){{0.8f, 0.8f, 0.8f}};
    const int clay = lmb_level_builder_add_material(builder, &material);
    const int body = lmb_level_builder_add_mesh(builder, "body");
    lmb_level_builder_add_cylinder(
        builder, body, clay,
        &(lmb_level_cylinder){.base = {0, -0.2f, 0}, .radius = 0.11f, .height = 0.08f, .segments = 32});
    lmb_level_builder_add_sphere(builder, body, clay,
                                 &(lmb_level_sphere){.centre = {0, 0.04f, 0}, .radius = 0.16f, .divisions = 12});
    lmb_level_builder_place(builder, "body", body, (lmb_vec3){0, 0, 0});
    const torus shape = {0.2, 0.03};
    const lmb_level_patch ring = {48, 16, 1.26f, 0.19f, torus_point, &shape};
    const int ring_mesh = lmb_level_builder_add_mesh(builder, "ring");
    lmb_level_builder_add_patch(builder, ring_mesh, clay, &ring);
    lmb_level_node node = lmb_level_node_default("ring");
    node.mesh = ring_mesh;
    node.translation = (lmb_vec3){0, 0.04f, 0};
    lmb_level_look_along((lmb_vec3){0, 0.4f, -1}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}
