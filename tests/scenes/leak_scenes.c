#include "leak_scenes.h"

#include <math.h>
#include <string.h>

#include <lambent/vector.h>

#include "level_blocks.h"

#define HULL_M 0.3f

/* Half of a lamp's thickness. */
#define LAMP_HALF_M 0.015f
#define HALL_HALF_LENGTH_M 4.0f

static const lmb_leak_scene scenes[] = {
    {"wall.1mm", LMB_LEAK_WALL, 0.001f, 0, 0, 10, 10, false, false, false},
    {"wall.20mm", LMB_LEAK_WALL, 0.02f, 0, 0, 10, 10, false, false, true},
    {"wall.200mm", LMB_LEAK_WALL, 0.2f, 0, 0, 10, 10, false, false, false},
    {"wall.lattice", LMB_LEAK_WALL, 0.02f, 0, 0, 10, 10, false, true, false},
    {"wall.bright", LMB_LEAK_WALL, 0.1f, 0, 0, 10000, 10, false, false, false},
    {"turned.1mm", LMB_LEAK_WALL, 0.001f, 30, 0, 10, 10, false, false, true},
    {"turned.200mm", LMB_LEAK_WALL, 0.2f, 30, 0, 10, 10, false, false, false},
    {"tilted.50mm", LMB_LEAK_WALL, 0.05f, 30, 20, 10, 10, false, false, false},
    {"corner", LMB_LEAK_CORNER, 0.1f, 0, 0, 10, 10, false, false, false},
    {"corner.turned", LMB_LEAK_CORNER, 0.1f, 25, 0, 10, 10, false, false, false},
    {"floors", LMB_LEAK_FLOORS, 0.1f, 0, 0, 10, 10, false, false, false},
    {"nested", LMB_LEAK_NESTED, 0.1f, 20, 0, 10, 10, false, false, false},
    {"curved", LMB_LEAK_CURVED, 0.1f, 0, 0, 10, 10, false, false, false},
    {"door", LMB_LEAK_DOOR, 0.2f, 0, 0, 10, 10, true, false, false},
    {"column", LMB_LEAK_COLUMN, 0.5f, 0, 0, 10, 10, true, false, false},
    {"table", LMB_LEAK_TABLE, 0.02f, 0, 0, 10, 10, true, false, false},
    {"fence", LMB_LEAK_FENCE, 0.04f, 0, 0, 10, 10, true, false, false},
};

const lmb_leak_scene *lmb_leak_scenes(size_t *count)
{
    *count = sizeof scenes / sizeof scenes[0];
    return scenes;
}

const lmb_leak_scene *lmb_leak_scene_find(const char *name)
{
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; ++i) {
        if (strcmp(scenes[i].name, name) == 0) {
            return &scenes[i];
        }
    }
    return NULL;
}

/* --- where a scene stands: turned, tilted, and moved off the planes of probes ---------------------------------- */

/* No multiple of a quarter of a metre, so that walls lie within cells of every spacing. */
static lmb_vec3 shift_of(const lmb_leak_scene *scene)
{
    return scene->on_lattice ? lmb_vec3_of(0.0f, 0.0f, 0.0f) : lmb_vec3_of(0.37f, 0.21f, 0.13f);
}

/* Quaternion of the turn, x, y, z, w: about +Z after about +Y. */
static void rotation_of(const lmb_leak_scene *scene, float q[4])
{
    const float half_turn = scene->turn_deg * LMB_PI_F / 360.0f, half_tilt = scene->tilt_deg * LMB_PI_F / 360.0f;
    q[0] = -sinf(half_tilt) * sinf(half_turn);
    q[1] = cosf(half_tilt) * sinf(half_turn);
    q[2] = sinf(half_tilt) * cosf(half_turn);
    q[3] = cosf(half_tilt) * cosf(half_turn);
}

static lmb_vec3 rotated(const float q[4], lmb_vec3 v)
{
    const lmb_vec3 axis = {q[0], q[1], q[2]};
    const lmb_vec3 across = lmb_vec3_add(lmb_vec3_cross(axis, v), lmb_vec3_scale(v, q[3]));
    return lmb_vec3_mad(v, lmb_vec3_cross(axis, across), 2.0f);
}

lmb_vec3 lmb_leak_scene_to_world(const lmb_leak_scene *scene, lmb_vec3 own)
{
    float q[4];
    rotation_of(scene, q);
    return lmb_vec3_add(rotated(q, own), shift_of(scene));
}

static lmb_vec3 from_world(const lmb_leak_scene *scene, lmb_vec3 world)
{
    float q[4];
    rotation_of(scene, q);
    q[3] = -q[3];
    return rotated(q, lmb_vec3_sub(world, shift_of(scene)));
}

/* --- what a scene is made of -------------------------------------------------------------------------------------- */

enum { MOST_BLOCKS = 32 };

/* A scene in its own axes. */
typedef struct layout {
    lmb_leak_room room[LMB_LEAK_MOST_ROOMS];
    lmb_vec3 lamp[LMB_LEAK_MOST_ROOMS];   /* the middle of each room's */
    float lamp_half[LMB_LEAK_MOST_ROOMS]; /* of its width */
    int room_count;
    lmb_level_block block[MOST_BLOCKS];
    size_t block_count;
    float radius; /* > 0: a round wall stands there, from the floor to the ceiling of the last room */
} layout;

static void add_block(layout *all, bool solid, lmb_vec3 min, lmb_vec3 max)
{
    all->block[all->block_count++] = lmb_level_block_of(solid, min, max, 0);
}

static void add_room(layout *all, int home, lmb_vec3 min, lmb_vec3 max)
{
    all->room[all->room_count] = (lmb_leak_room){.min = min, .max = max, .home = home};
    all->lamp_half[all->room_count] = 0.3f * lmb_smaller(max.x - min.x, max.z - min.z);
    all->lamp[all->room_count++] = lmb_vec3_of(0.5f * (min.x + max.x), max.y, 0.5f * (min.z + max.z));
}

/* The rooms carved from a hull around them. */
static void carve_rooms(layout *all)
{
    lmb_vec3 low = all->room[0].min, high = all->room[0].max;
    for (int i = 1; i < all->room_count; ++i) {
        low = lmb_vec3_smaller(low, all->room[i].min);
        high = lmb_vec3_larger(high, all->room[i].max);
    }
    const lmb_vec3 hull = {HULL_M, HULL_M, HULL_M};
    add_block(all, true, lmb_vec3_sub(low, hull), lmb_vec3_add(high, hull));
    for (int i = 0; i < all->room_count; ++i) {
        add_block(all, false, all->room[i].min, all->room[i].max);
    }
}

static void lay_out_wall(const lmb_leak_scene *scene, layout *all)
{
    const float half = scene->wall_m / 2;
    add_room(all, 0, lmb_vec3_of(-half - 4, 0, -2), lmb_vec3_of(-half, 3, 2));
    add_room(all, 1, lmb_vec3_of(half, 0, -2), lmb_vec3_of(half + 4, 3, 2));
    carve_rooms(all);
    if (scene->shape == LMB_LEAK_DOOR) {
        add_block(all, false, lmb_vec3_of(-half, 0, -0.5f), lmb_vec3_of(half, 2, 0.5f));
        add_block(all, true, lmb_vec3_of(-0.02f, 0, -0.5f), lmb_vec3_of(0.02f, 2, 0.4f));
    }
}

static void lay_out_corner(const lmb_leak_scene *scene, layout *all)
{
    const float near = scene->wall_m / 2, far = near + 3.5f;
    add_room(all, 0, lmb_vec3_of(-far, 0, -far), lmb_vec3_of(-near, 3, -near));
    add_room(all, 1, lmb_vec3_of(near, 0, -far), lmb_vec3_of(far, 3, -near));
    add_room(all, 1, lmb_vec3_of(-far, 0, near), lmb_vec3_of(-near, 3, far));
    add_room(all, 0, lmb_vec3_of(near, 0, near), lmb_vec3_of(far, 3, far));
    carve_rooms(all);
}

static void lay_out_floors(const lmb_leak_scene *scene, layout *all)
{
    const float half = scene->wall_m / 2;
    add_room(all, 0, lmb_vec3_of(-2, -half - 2.6f, -2), lmb_vec3_of(2, -half, 2));
    add_room(all, 1, lmb_vec3_of(-2, half, -2), lmb_vec3_of(2, half + 2.6f, 2));
    carve_rooms(all);
}

/* A house or a round room in the middle of a larger one. */
static void lay_out_within(const lmb_leak_scene *scene, layout *all)
{
    const bool round = scene->shape == LMB_LEAK_CURVED;
    const float half = round ? 1.5f : 1.25f, height = round ? 3.0f : 2.2f, wall = scene->wall_m;
    add_room(all, 0, lmb_vec3_of(-half, 0, -half), lmb_vec3_of(half, height, half));
    add_room(all, 1, lmb_vec3_of(-3.5f, 0, -3.5f), lmb_vec3_of(3.5f, 3, 3.5f));
    carve_rooms(all);
    if (round) {
        all->radius = all->room[0].radius = half;
        all->lamp[1].x = 2.5f; /* between the round wall and the outer one */
        all->lamp_half[1] = 0.8f;
    } else {
        add_block(all, true, lmb_vec3_of(-half - wall, 0, -half - wall),
                  lmb_vec3_of(half + wall, height + wall, half + wall));
        add_block(all, false, all->room[0].min, all->room[0].max);
    }
}

/* One hall whose halves belong to the two colours. */
static void lay_out_hall(const lmb_leak_scene *scene, layout *all)
{
    const float half = scene->wall_m / 2;
    add_room(all, 0, lmb_vec3_of(-HALL_HALF_LENGTH_M, 0, -2), lmb_vec3_of(0, 3, 2));
    add_room(all, 1, lmb_vec3_of(0, 0, -2), lmb_vec3_of(HALL_HALF_LENGTH_M, 3, 2));
    carve_rooms(all);
    const int bars = scene->shape == LMB_LEAK_FENCE ? 20 : 1;
    for (int i = 0; i < bars; ++i) {
        const float z = (0.5f + (float)i) * 4.0f / (float)bars - 2.0f;
        add_block(all, true, lmb_vec3_of(-half, 0, z - half), lmb_vec3_of(half, 3, z + half));
    }
}

static void lay_out_table(const lmb_leak_scene *scene, layout *all)
{
    const float top = 0.75f;
    const lmb_vec3 low = {-2, 0, -2}, high = {2, 3, 2};
    add_room(all, 0, low, high);
    carve_rooms(all);
    add_block(all, true, lmb_vec3_of(-1, top - scene->wall_m, -0.6f), lmb_vec3_of(1, top, 0.6f));
    all->room[0].min.y = top;
    add_room(all, 1, lmb_vec3_of(-1, 0, -0.6f), lmb_vec3_of(1, top - scene->wall_m, 0.6f));
    all->lamp[1].y = 0.0f;
}

static layout layout_of(const lmb_leak_scene *scene)
{
    layout all = {.room_count = 0};
    switch (scene->shape) {
    case LMB_LEAK_WALL:
    case LMB_LEAK_DOOR:
        lay_out_wall(scene, &all);
        break;
    case LMB_LEAK_CORNER:
        lay_out_corner(scene, &all);
        break;
    case LMB_LEAK_FLOORS:
        lay_out_floors(scene, &all);
        break;
    case LMB_LEAK_NESTED:
    case LMB_LEAK_CURVED:
        lay_out_within(scene, &all);
        break;
    case LMB_LEAK_COLUMN:
    case LMB_LEAK_FENCE:
        lay_out_hall(scene, &all);
        break;
    case LMB_LEAK_TABLE:
        lay_out_table(scene, &all);
        break;
    }
    return all;
}

int lmb_leak_scene_rooms(const lmb_leak_scene *scene, lmb_leak_room room[LMB_LEAK_MOST_ROOMS])
{
    const layout all = layout_of(scene);
    memcpy(room, all.room, sizeof all.room);
    return all.room_count;
}

/* In a house, a column, a bar: the last block that holds the point says what is there. */
static bool is_in_block(const layout *all, lmb_vec3 at)
{
    bool solid = false;
    for (size_t i = 0; i < all->block_count; ++i) {
        const lmb_level_block *block = &all->block[i];
        const bool holds = at.x >= block->min.x && at.x <= block->max.x && at.y >= block->min.y &&
                           at.y <= block->max.y && at.z >= block->min.z && at.z <= block->max.z;
        solid = holds ? block->solid : solid;
    }
    return solid;
}

static bool is_in_lamp(const layout *all, lmb_vec3 at)
{
    bool inside = false;
    for (int i = 0; i < all->room_count && !inside; ++i) {
        const lmb_vec3 from = lmb_vec3_sub(at, all->lamp[i]);
        inside =
            fabsf(from.x) <= all->lamp_half[i] && fabsf(from.y) <= LAMP_HALF_M && fabsf(from.z) <= all->lamp_half[i];
    }
    return inside;
}

int lmb_leak_scene_room_at(const lmb_leak_scene *scene, lmb_vec3 world)
{
    const lmb_vec3 at = from_world(scene, world);
    const layout all = layout_of(scene);
    const bool is_free = !is_in_block(&all, at) && !is_in_lamp(&all, at);
    for (int i = 0; i < all.room_count && is_free; ++i) {
        const lmb_leak_room *room = &all.room[i];
        const float x = at.x - 0.5f * (room->min.x + room->max.x), z = at.z - 0.5f * (room->min.z + room->max.z);
        if (at.x > room->min.x && at.x < room->max.x && at.y > room->min.y && at.y < room->max.y &&
            at.z > room->min.z && at.z < room->max.z &&
            (room->radius == 0.0f || x * x + z * z < room->radius * room->radius)) {
            return i;
        }
    }
    return -1;
}

/* --- writing ----------------------------------------------------------------------------------------------------- */

/* An upright round surface around the origin: seen from outside, or, turning the other way, from inside. */
typedef struct round_wall {
    double radius, low, high;
    bool inward;
} round_wall;

static lmb_level_point round_point(const void *context, double u, double v)
{
    const round_wall *wall = context;
    const double angle = (wall->inward ? 2.0 : -2.0) * LMB_PI * u;
    const float x = (float)cos(angle), z = (float)sin(angle), side = wall->inward ? -1.0f : 1.0f;
    const float radius = (float)wall->radius;
    return (lmb_level_point){{radius * x, (float)(wall->low + v * (wall->high - wall->low)), radius * z},
                             {side * x, 0, side * z},
                             {side * z, 0, -side * x}};
}

static void add_round_wall(lmb_level_builder *builder, int mesh, int material, const layout *all, float wall_m)
{
    enum { SEGMENTS = 24 };
    for (int inward = 0; inward < 2; ++inward) {
        /* A little into floor and ceiling, so that there is no crack. */
        const round_wall wall = {.radius = (double)(all->radius + (inward ? 0.0f : wall_m)),
                                 .low = -0.05,
                                 .high = (double)all->room[1].max.y + 0.05,
                                 .inward = inward};
        lmb_level_builder_add_patch(builder, mesh, material,
                                    &(lmb_level_patch){.columns = SEGMENTS,
                                                       .rows = 1,
                                                       .width_m = 2.0f * LMB_PI_F * (float)wall.radius,
                                                       .height_m = 3.1f,
                                                       .surface = round_point,
                                                       .context = &wall});
    }
}

/* A panel half in the ceiling, or the floor, that shines and reflects nothing. No gap behind it is a room of its own.
 */
static void add_lamp(lmb_level_builder *builder, int mesh, const layout *all, int i, const float radiance[2])
{
    const int home = all->room[i].home;
    lmb_level_material shining = lmb_level_material_default();
    shining.name = home == 0 ? "red lamp" : "green lamp";
    shining.base_color = lmb_rgb_of(0, 0, 0);
    shining.emission.c[home] = radiance[home];
    const lmb_vec3 half = {all->lamp_half[i], LAMP_HALF_M, all->lamp_half[i]}, middle = all->lamp[i];
    const lmb_level_box box = lmb_level_box_of(lmb_vec3_sub(middle, half), lmb_vec3_add(middle, half),
                                               lmb_level_builder_add_material(builder, &shining));
    lmb_level_builder_add_box(builder, mesh, &box);
}

lmb_result lmb_leak_scene_write(const lmb_leak_scene *scene, const char *path, lmb_error *error)
{
    const layout all = layout_of(scene);
    lmb_level_builder *const builder = lmb_level_builder_create(0.1f);
    lmb_level_material grey = lmb_level_material_default();
    grey.name = "grey";
    const int material = lmb_level_builder_add_material(builder, &grey); /* 0, which the blocks have */
    const int mesh = lmb_level_builder_add_mesh(builder, scene->name);
    lmb_level_builder_add_blocks(builder, mesh, all.block, all.block_count);
    if (all.radius > 0.0f) {
        add_round_wall(builder, mesh, material, &all, scene->wall_m);
    }
    const float radiance[2] = {scene->red, scene->green};
    for (int i = 0; i < all.room_count; ++i) {
        add_lamp(builder, mesh, &all, i, radiance);
    }
    lmb_level_node node = lmb_level_node_default(scene->name);
    node.mesh = mesh;
    node.translation = shift_of(scene);
    rotation_of(scene, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}
