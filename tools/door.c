/* Light through a door that moves, blended of a bake with it open and one with it closed:
 *
 *     lambent_door FOLDER
 *
 * writes FOLDER/door_KIND_STATE.glb: two rooms of 4 x 4 x 2.5 m with a doorway of 1 x 2 m between them, a lamp in the
 * first and nothing in the second, and a door that slides along the wall or swings into the second by 90 degrees,
 * closed, half open or open. The door's node is called `door`. At places all over both rooms light is gathered in each
 * state, and the half open one's compared with t x open + (1 - t) x closed, for t = 1/2, and for the t that fits best.
 *
 * One line for each kind, room and t, tabs between: kind, room, t, and relative errors of irradiance over 14 normals:
 * root of the mean square over all places, the median place's and that of the 95th in 100. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/bake_level.h>
#include <lambent/gather_sh3.h>
#include <lambent/vector.h>

#include "command.h"
#include "irradiance_error.h"
#include "level_builder.h"

enum { SIDE = 8, HIGH = 4, PLACES = SIDE * SIDE * HIGH, ROOMS = 2, STATES = 3, SAMPLES = 4096 };
enum { SLIDES, SWINGS, KINDS };
static const char *const kind_names[KINDS] = {"slides", "swings"};
static const char *const state_names[STATES] = {"closed", "half", "open"};
static const char *const room_names[ROOMS] = {"lit", "dark"};

/* [state][room][place] */
typedef struct door_light {
    lmb_sh3_rgb at[STATES][ROOMS][PLACES];
} door_light;

static void rooms_add(lmb_level_builder *builder)
{
    lmb_level_material plaster = lmb_level_material_default();
    plaster.base_color = (lmb_rgb){{0.7f, 0.7f, 0.65f}};
    const int material = lmb_level_builder_add_material(builder, &plaster);
    const int mesh = lmb_level_builder_add_mesh(builder, "rooms");
    lmb_level_box room = lmb_level_box_of((lmb_vec3){-4, 0, -2}, (lmb_vec3){4, 2.5f, 2}, material);
    room.inward = true;
    const lmb_level_box walls[3] = {
        lmb_level_box_of((lmb_vec3){-0.05f, 0, -2}, (lmb_vec3){0.05f, 2.5f, -0.5f}, material),
        lmb_level_box_of((lmb_vec3){-0.05f, 0, 0.5f}, (lmb_vec3){0.05f, 2.5f, 2}, material),
        lmb_level_box_of((lmb_vec3){-0.05f, 2, -0.5f}, (lmb_vec3){0.05f, 2.5f, 0.5f}, material)};
    lmb_level_builder_add_box(builder, mesh, &room);
    for (int i = 0; i < 3; ++i) {
        lmb_level_builder_add_box(builder, mesh, &walls[i]);
    }
    lmb_level_builder_place(builder, "rooms", mesh, (lmb_vec3){0, 0, 0});
    const lmb_level_light lamp = {
        .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.9f, 0.8f}}, .intensity = 10.0f};
    lmb_level_node node = lmb_level_node_default("lamp");
    node.light = lmb_level_builder_add_light(builder, &lamp);
    node.translation = (lmb_vec3){-2.5f, 2.2f, 0.7f};
    lmb_level_builder_add_node(builder, &node);
}

/* `open` from 0 to 1. A door that slides lies on the wall's face and covers more than the doorway; the other turns
 * about an edge of it. */
static void door_add(lmb_level_builder *builder, int kind, float open)
{
    lmb_level_material wood = lmb_level_material_default();
    wood.base_color = (lmb_rgb){{0.5f, 0.3f, 0.15f}};
    const int material = lmb_level_builder_add_material(builder, &wood);
    const int mesh = lmb_level_builder_add_mesh(builder, "door");
    lmb_level_node node = lmb_level_node_default("door");
    node.mesh = mesh;
    if (kind == SLIDES) {
        const lmb_level_box leaf =
            lmb_level_box_of((lmb_vec3){0, 0, -0.05f}, (lmb_vec3){0.04f, 2.05f, 1.05f}, material);
        lmb_level_builder_add_box(builder, mesh, &leaf);
        node.translation = (lmb_vec3){0.05f, 0, -0.5f - open};
    } else {
        const lmb_level_box leaf = lmb_level_box_of((lmb_vec3){-0.02f, 0, 0}, (lmb_vec3){0.02f, 2, 1}, material);
        lmb_level_builder_add_box(builder, mesh, &leaf);
        node.translation = (lmb_vec3){0, 0, -0.5f};
        lmb_level_turn(open * (float)(0.5 * LMB_PI), node.rotation);
    }
    lmb_level_builder_add_node(builder, &node);
}

static lmb_result level_write(int kind, int state, const char *path, lmb_error *error)
{
    lmb_level_builder *const builder = lmb_level_builder_create(0.1f);
    rooms_add(builder);
    door_add(builder, kind, 0.5f * (float)state);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Even over a room; none within the leaf, however it stands. */
static lmb_vec3 place_of(int room, int place)
{
    const float x = 0.3f + 3.4f * (float)(place % SIDE) / (SIDE - 1);
    const float z = -1.7f + 3.4f * (float)(place / SIDE % SIDE) / (SIDE - 1);
    const float y = 0.3f + 1.9f * (float)(place / (SIDE * SIDE)) / (HIGH - 1);
    return lmb_vec3_of(room == 0 ? -x : x, y, z);
}

typedef struct gather_work {
    const lmb_transport *transport;
    lmb_sh3_rgb (*light)[PLACES];
} gather_work;

static void gather_task(void *context, size_t task, int worker)
{
    (void)worker;
    const gather_work *work = context;
    const int room = (int)task / PLACES, place = (int)task % PLACES;
    const lmb_gather_point point = {.position = place_of(room, place)};
    lmb_gathered found;
    lmb_gather_sh3(work->transport, &point, SAMPLES, &found);
    work->light[room][place] = found.moments;
}

static lmb_result state_gather(const char *path, lmb_sh3_rgb (*light)[PLACES], lmb_error *error)
{
    lmb_level_settings settings = lmb_level_settings_default();
    settings.path = path;
    lmb_level level;
    lmb_result result = lmb_level_open(&settings, NULL, NULL, &level, error);
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_level_solve(&level, LMB_ESTIMATOR_CACHED, NULL, error);
    if (result == LMB_OK) {
        gather_work work = {&level.transport, light};
        result = lmb_pool_run(level.pool, ROOMS * PLACES, gather_task, &work, "gather", NULL);
    }
    lmb_level_close(&level);
    return result;
}

/* The t for which t open + (1 - t) closed is nearest to the half open door's light in both rooms. */
static float weight_fit(const door_light *light)
{
    double product = 0.0, square = 0.0;
    for (int i = 0; i < ROOMS * PLACES; ++i) {
        const int room = i / PLACES, place = i % PLACES;
        for (int n = 0; n < 3 * LMB_SH3_COUNT; ++n) {
            const double closed = (double)light->at[0][room][place].channel[n % 3].c[n / 3];
            const double more = (double)light->at[2][room][place].channel[n % 3].c[n / 3] - closed;
            product += more * ((double)light->at[1][room][place].channel[n % 3].c[n / 3] - closed);
            square += more * more;
        }
    }
    return (float)(product / square);
}

static lmb_result blend_print(const door_light *light, int kind, float t)
{
    static lmb_sh3_rgb made[PLACES];
    lmb_result result = LMB_OK;
    for (int room = 0; room < ROOMS && result == LMB_OK; ++room) {
        for (int i = 0; i < PLACES; ++i) {
            made[i] = lmb_sh3_rgb_lerp(&light->at[0][room][i], &light->at[2][room][i], t);
        }
        error_summary error;
        result = irradiance_error_find(light->at[1][room], made, PLACES, &error);
        if (result == LMB_OK) {
            printf("%s\t%s\t%.2f\t%.3f\t%.3f\t%.3f\n", kind_names[kind], room_names[room], (double)t, error.rel_rmse,
                   error.median, error.p95);
        }
    }
    return result;
}

static lmb_result kind_measure(const char *folder, int kind, door_light *light, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (int state = 0; state < STATES && result == LMB_OK; ++state) {
        char path[1024];
        const int length =
            snprintf(path, sizeof path, "%s/door_%s_%s.glb", folder, kind_names[kind], state_names[state]);
        if (length >= (int)sizeof path) {
            return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%.100s...: path is too long", folder);
        }
        result = level_write(kind, state, path, error);
        if (result == LMB_OK) {
            result = state_gather(path, light->at[state], error);
        }
    }
    if (result == LMB_OK) {
        result = blend_print(light, kind, 0.5f);
    }
    return result == LMB_OK ? blend_print(light, kind, weight_fit(light)) : result;
}

int main(int count, char **values)
{
    if (count != 2) {
        fputs("usage: lambent_door FOLDER\n", stderr);
        return EXIT_USAGE;
    }
    static door_light light;
    lmb_error error = {{0}};
    lmb_result result = LMB_OK;
    for (int kind = 0; kind < KINDS && result == LMB_OK; ++kind) {
        result = kind_measure(values[1], kind, &light, &error);
    }
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
