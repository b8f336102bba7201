#include "levels.h"

#include "level_builder.h"

/* All the small levels keep a fiftieth of their size between lightmap rectangles. */
static const float gutter_share = 0.02f;

static int add_diffuse(lmb_level_builder *builder, const char *name, float red, float green, float blue)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = name;
    material.base_color = (lmb_rgb){{red, green, blue}};
    return lmb_level_builder_add_material(builder, &material);
}

/* A lamp that reflects nothing. */
static int add_lamp(lmb_level_builder *builder, const char *name, float red, float green, float blue)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = name;
    material.base_color = (lmb_rgb){{0, 0, 0}};
    material.emission = (lmb_rgb){{red, green, blue}};
    return lmb_level_builder_add_material(builder, &material);
}

static lmb_result finish(lmb_level_builder *builder, const char *path, lmb_error *error)
{
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

lmb_result lmb_level_furnace(const char *path, float size_m, float albedo, lmb_rgb emission, bool double_sided,
                             lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(size_m * gutter_share);
    lmb_level_material material = lmb_level_material_default();
    material.name = "glowing";
    material.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    material.emission = emission;
    material.double_sided = double_sided;
    const float half = size_m / 2;
    lmb_level_box box = lmb_level_box_of((lmb_vec3){-half, -half, -half}, (lmb_vec3){half, half, half},
                                         lmb_level_builder_add_material(builder, &material));
    box.inward = true;
    const int mesh = lmb_level_builder_add_mesh(builder, "furnace");
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_builder_place(builder, "furnace", mesh, (lmb_vec3){0, 0, 0});
    return finish(builder, path, error);
}

static void add_ground(lmb_level_builder *builder, float size_m, float albedo)
{
    const int material = add_diffuse(builder, "ground", albedo, albedo, albedo);
    const int mesh = lmb_level_builder_add_mesh(builder, "ground");
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-size_m / 2, 0, size_m / 2},
                               (lmb_vec3){size_m, 0, 0}, (lmb_vec3){0, 0, -size_m});
    lmb_level_builder_place(builder, "ground", mesh, (lmb_vec3){0, 0, 0});
}

lmb_result lmb_level_open_ground(const char *path, float size_m, float albedo, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(size_m * gutter_share);
    add_ground(builder, size_m, albedo);
    return finish(builder, path, error);
}

/* A block that stands on the floor, turned about +Y. */
static void place_block(lmb_level_builder *builder, const char *name, int material, lmb_vec3 size, lmb_vec3 position,
                        float angle_rad)
{
    const int mesh = lmb_level_builder_add_mesh(builder, name);
    lmb_level_box box =
        lmb_level_box_of((lmb_vec3){-size.x / 2, 0, -size.z / 2}, (lmb_vec3){size.x / 2, size.y, size.z / 2}, material);
    lmb_level_builder_add_box(builder, mesh, &box);
    lmb_level_node node = lmb_level_node_default(name);
    node.mesh = mesh;
    node.translation = position;
    lmb_level_turn(angle_rad, node.rotation);
    lmb_level_builder_add_node(builder, &node);
}

lmb_result lmb_level_cornell(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(2 * gutter_share);
    const int white = add_diffuse(builder, "white", 0.73f, 0.73f, 0.73f);
    const int red = add_diffuse(builder, "red", 0.63f, 0.06f, 0.05f);
    const int green = add_diffuse(builder, "green", 0.14f, 0.45f, 0.09f);
    const int lamp = add_lamp(builder, "lamp", 15, 15, 15);
    const lmb_level_box walls = {{-1, 0, -1}, {1, 2, 1}, {red, green, white, white, white, LMB_LEVEL_NONE}, true};
    const int room = lmb_level_builder_add_mesh(builder, "room");
    lmb_level_builder_add_box(builder, room, &walls);
    lmb_level_builder_place(builder, "room", room, (lmb_vec3){0, 0, 0});
    const int light = lmb_level_builder_add_mesh(builder, "lamp");
    lmb_level_builder_add_quad(builder, light, lamp, (lmb_vec3){-0.25f, 0, -0.25f}, (lmb_vec3){0.5f, 0, 0},
                               (lmb_vec3){0, 0, 0.5f});
    lmb_level_builder_place(builder, "lamp", light, (lmb_vec3){0, 1.98f, 0});
    place_block(builder, "tall", white, (lmb_vec3){0.6f, 1.2f, 0.6f}, (lmb_vec3){-0.35f, 0, -0.3f}, 0.3f);
    place_block(builder, "short", white, (lmb_vec3){0.6f, 0.6f, 0.6f}, (lmb_vec3){0.35f, 0, 0.35f}, -0.3f);
    return finish(builder, path, error);
}

lmb_two_rooms lmb_two_rooms_default(void)
{
    return (lmb_two_rooms){.wall_m = 0.1f, .albedo = 0.5f, .red_radiance = 10, .green_radiance = 10};
}

enum { ROOM_LENGTH_M = 4, ROOM_HEIGHT_M = 3, ROOM_HALF_DEPTH_M = 2, DOOR_HEIGHT_M = 2 };

/* One side of the wall around the doorway, as seen from inside the room: `facing` is the sign of its normal's x. */
static void add_wall_around_door(lmb_level_builder *builder, int mesh, int material, float x, float half_door,
                                 int facing)
{
    const struct {
        float y0, y1, z0, z1;
    } pieces[] = {
        {0, DOOR_HEIGHT_M, -ROOM_HALF_DEPTH_M, -half_door},
        {0, DOOR_HEIGHT_M, half_door, ROOM_HALF_DEPTH_M},
        {DOOR_HEIGHT_M, ROOM_HEIGHT_M, -ROOM_HALF_DEPTH_M, -half_door},
        {DOOR_HEIGHT_M, ROOM_HEIGHT_M, -half_door, half_door},
        {DOOR_HEIGHT_M, ROOM_HEIGHT_M, half_door, ROOM_HALF_DEPTH_M},
    };
    const int face = facing > 0 ? 1 : 0;
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; ++i) {
        lmb_level_box piece = lmb_level_box_of((lmb_vec3){x, pieces[i].y0, pieces[i].z0},
                                               (lmb_vec3){x, pieces[i].y1, pieces[i].z1}, LMB_LEVEL_NONE);
        piece.material[face] = material;
        lmb_level_builder_add_box(builder, mesh, &piece);
    }
}

/* The passage through the wall: jambs, lintel and threshold look into it. */
static void add_passage(lmb_level_builder *builder, int mesh, int material, float half_wall, float half_door)
{
    const lmb_level_box passage = {{-half_wall, 0, -half_door},
                                   {half_wall, DOOR_HEIGHT_M, half_door},
                                   {LMB_LEVEL_NONE, LMB_LEVEL_NONE, material, material, material, material},
                                   true};
    lmb_level_builder_add_box(builder, mesh, &passage);
}

static void add_hull(lmb_level_builder *builder, const lmb_two_rooms *rooms)
{
    const int grey = add_diffuse(builder, "grey", rooms->albedo, rooms->albedo, rooms->albedo);
    const float near_x = rooms->wall_m / 2;
    const float far_x = near_x + ROOM_LENGTH_M;
    const float hull_m = 0.3f;
    const bool door = rooms->door_m > 0;
    const int hull = lmb_level_builder_add_mesh(builder, "hull");
    lmb_level_box left = lmb_level_box_of((lmb_vec3){-far_x, 0, -ROOM_HALF_DEPTH_M},
                                          (lmb_vec3){-near_x, ROOM_HEIGHT_M, ROOM_HALF_DEPTH_M}, grey);
    lmb_level_box right = lmb_level_box_of((lmb_vec3){near_x, 0, -ROOM_HALF_DEPTH_M},
                                           (lmb_vec3){far_x, ROOM_HEIGHT_M, ROOM_HALF_DEPTH_M}, grey);
    const lmb_level_box outside =
        lmb_level_box_of((lmb_vec3){-far_x - hull_m, -hull_m, -ROOM_HALF_DEPTH_M - hull_m},
                         (lmb_vec3){far_x + hull_m, ROOM_HEIGHT_M + hull_m, ROOM_HALF_DEPTH_M + hull_m}, grey);
    left.inward = true;
    right.inward = true;
    left.material[1] = door ? LMB_LEVEL_NONE : grey;
    right.material[0] = door ? LMB_LEVEL_NONE : grey;
    lmb_level_builder_add_box(builder, hull, &left);
    lmb_level_builder_add_box(builder, hull, &right);
    lmb_level_builder_add_box(builder, hull, &outside);
    if (door) {
        add_wall_around_door(builder, hull, grey, -near_x, rooms->door_m / 2, -1);
        add_wall_around_door(builder, hull, grey, near_x, rooms->door_m / 2, 1);
        add_passage(builder, hull, grey, near_x, rooms->door_m / 2);
    }
    lmb_level_builder_place(builder, "hull", hull, (lmb_vec3){0, 0, 0});
}

lmb_result lmb_level_two_rooms(const char *path, const lmb_two_rooms *rooms, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(ROOM_LENGTH_M * gutter_share);
    const float lamp_x = rooms->wall_m / 2 + (float)ROOM_LENGTH_M / 2;
    const struct {
        const char *name;
        float x;
        int material;
    } lamps[] = {
        {"red lamp", -lamp_x, add_lamp(builder, "red lamp", rooms->red_radiance, 0, 0)},
        {"green lamp", lamp_x, add_lamp(builder, "green lamp", 0, rooms->green_radiance, 0)},
    };
    add_hull(builder, rooms);
    for (size_t i = 0; i < sizeof lamps / sizeof lamps[0]; ++i) {
        const int mesh = lmb_level_builder_add_mesh(builder, lamps[i].name);
        const lmb_level_box box =
            lmb_level_box_of((lmb_vec3){-0.3f, -0.05f, -0.3f}, (lmb_vec3){0.3f, 0.05f, 0.3f}, lamps[i].material);
        lmb_level_builder_add_box(builder, mesh, &box);
        lmb_level_builder_place(builder, lamps[i].name, mesh, (lmb_vec3){lamps[i].x, 2.5f, 0});
    }
    return finish(builder, path, error);
}

lmb_result lmb_level_sphere_room(const char *path, float radius_m, int divisions, float albedo, float intensity_cd,
                                 lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(radius_m * gutter_share);
    const int material = add_diffuse(builder, "wall", albedo, albedo, albedo);
    const int mesh = lmb_level_builder_add_mesh(builder, "sphere");
    lmb_level_builder_add_sphere(
        builder, mesh, material,
        &(lmb_level_sphere){.centre = {0, 0, 0}, .radius = radius_m, .divisions = divisions, .inward = true});
    lmb_level_builder_place(builder, "sphere", mesh, (lmb_vec3){0, 0, 0});
    const lmb_level_light light = {
        .name = "bulb", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1, 1, 1}}, .intensity = intensity_cd};
    lmb_level_node node = lmb_level_node_default("bulb");
    node.light = lmb_level_builder_add_light(builder, &light);
    lmb_level_builder_add_node(builder, &node);
    return finish(builder, path, error);
}

lmb_result lmb_level_quad_light(const char *path, float height_m, float radiance, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(10 * gutter_share);
    add_ground(builder, 10, 0.5f);
    const int material = add_lamp(builder, "lamp", radiance, radiance, radiance);
    const int mesh = lmb_level_builder_add_mesh(builder, "lamp");
    lmb_level_builder_add_quad(builder, mesh, material, (lmb_vec3){-0.5f, 0, -0.5f}, (lmb_vec3){1, 0, 0},
                               (lmb_vec3){0, 0, 1});
    lmb_level_builder_place(builder, "lamp", mesh, (lmb_vec3){0, height_m, 0});
    return finish(builder, path, error);
}

lmb_result lmb_level_sun_plane(const char *path, float albedo, lmb_vec3 direction, float lux, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(20 * gutter_share);
    add_ground(builder, 20, albedo);
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1, 1, 1}}, .intensity = lux};
    lmb_level_node node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    lmb_level_look_along(direction, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    return finish(builder, path, error);
}
