/* Walls that stand on a surface: light on one side of them stays there, whatever the surface's texels straddle. */
#include "lightmap_fixture.h"

#include <lambent/surface.h>
#include <lambent/vector.h>

/* A room of 4 x 2 x 3 m whose floor, ceiling and long sides run on through a wall that stands across it. A lamp hangs
 * on the wall's +x side; the other is sealed, and dark. */
typedef struct divided_room {
    const char *name;
    float wall_x;    /* its middle */
    float wall_m;    /* its thickness; 0: a sheet */
    float turn_deg;  /* of the wall */
    bool own_charts; /* made by the bake */
} divided_room;

static lmb_result room_write(const divided_room *room, const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.3f);
    lmb_level_material grey = lmb_level_material_default();
    grey.double_sided = room->wall_m == 0.0f;
    const int material = lmb_level_builder_add_material(builder, &grey);
    lmb_level_material bright = lmb_level_material_default();
    bright.emission = (lmb_rgb){{20, 20, 20}};
    const int lamp_material = lmb_level_builder_add_material(builder, &bright);
    const int hull = lmb_level_builder_add_mesh(builder, "hull");
    lmb_level_box box = lmb_level_box_of((lmb_vec3){-2, 0, -1.5f}, (lmb_vec3){2, 2, 1.5f}, material);
    box.inward = true;
    lmb_level_builder_add_box(builder, hull, &box);
    lmb_level_builder_place(builder, "hull", hull, (lmb_vec3){0, 0, 0});
    const int wall = lmb_level_builder_add_mesh(builder, "wall");
    if (room->wall_m > 0.0f) {
        box = lmb_level_box_of((lmb_vec3){-0.5f * room->wall_m, -0.1f, -3}, (lmb_vec3){0.5f * room->wall_m, 2.1f, 3},
                               material);
        lmb_level_builder_add_box(builder, wall, &box);
    } else {
        lmb_level_builder_add_quad(builder, wall, material, (lmb_vec3){0, -0.1f, 3}, (lmb_vec3){0, 0, -6},
                                   (lmb_vec3){0, 2.2f, 0});
    }
    lmb_level_node node = lmb_level_node_default("wall");
    node.mesh = wall;
    node.translation = (lmb_vec3){room->wall_x, 0, 0};
    lmb_level_turn(room->turn_deg * 3.14159265f / 180.0f, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    const int lamp = lmb_level_builder_add_mesh(builder, "lamp");
    box = lmb_level_box_of((lmb_vec3){-0.1f, -0.1f, -0.1f}, (lmb_vec3){0.1f, 0.1f, 0.1f}, lamp_material);
    lmb_level_builder_add_box(builder, lamp, &box);
    lmb_level_builder_place(builder, "lamp", lamp, (lmb_vec3){1.2f, 1.4f, 0.3f});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Bakes as lambent bake does, denoised. */
static bool room_bake(const divided_room *room, baked *bake, uint32_t samples)
{
    lmb_error error = {""};
    const char *path = OUTPUT("lightmap_walls.glb");
    if (!level_fixture_open(&bake->level, path, room_write(room, path, &error), &error, 2)) {
        return false;
    }
    for (uint32_t m = 0; room->own_charts && m < bake->level.scene->mesh_count; ++m) {
        uv_break(&bake->level.scene->meshes[m], LMB_UV_MISSING);
    }
    bake->lightmap = NULL;
    lmb_texel_list *list = NULL;
    lmb_gathered *gathered = NULL;
    const lmb_gather_effort effort = {.samples = samples};
    lmb_result result = LMB_ERROR_MEMORY;
    if (lightmap_make(bake, 8.0f, 1024)) {
        result = lmb_texel_list_create(bake->lightmap, &bake->level.transport, &effort, &list);
    }
    if (result == LMB_OK) {
        const lmb_gather_list elements = lmb_texel_list_elements(list);
        gathered = malloc(elements.count * sizeof *gathered);
        const lmb_gather_job job = lmb_gather_job_all(&bake->level.transport, &elements, &effort);
        result =
            gathered ? lmb_gather_elements(&job, bake->level.pool, NULL, gathered, &bake->stats) : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        result = lmb_texel_list_denoise(list, bake->level.pool, NULL, gathered);
    }
    if (result == LMB_OK) {
        result = lmb_texel_list_finish(list, gathered, bake->level.pool, bake->lightmap);
    }
    free(gathered);
    lmb_texel_list_destroy(list);
    CHECK(result == LMB_OK, "%s: %s", room->name, lmb_result_text(result));
    if (result != LMB_OK) {
        baked_close(bake);
    }
    return result == LMB_OK;
}

/* How far a place of the hull is from the wall, in metres: negative on its dark side. In the wall 0. */
static double metres_from_wall(const divided_room *room, lmb_vec3 place)
{
    const double turn = (double)room->turn_deg * 3.14159265358979 / 180.0;
    const double across = ((double)place.x - (double)room->wall_x) * cos(turn) - (double)place.z * sin(turn);
    const double beyond = fabs(across) - 0.5 * (double)room->wall_m;
    return beyond < 0.0 ? 0.0 : across < 0.0 ? -beyond : beyond;
}

/* What the lightmap has on either side. */
typedef struct side_light {
    double dark_most;       /* beyond `reach` of the wall's dark side */
    double lit, lit_traced; /* means over a strip along the wall's foot, of the lightmap and by tracing */
    int lit_count;
} side_light;

static side_light light_beside_wall(const divided_room *room, const baked *bake, uint32_t hull, double reach)
{
    side_light light = {0.0, 0.0, 0.0, 0};
    const double texel = (double)bake->lightmap->region[hull].texel_size;
    for (uint32_t k = 0; k < 12 * 10000; ++k) {
        const float u = ((float)(k % 100) + 0.5f) / 100.0f, v = ((float)(k / 100 % 100) + 0.5f) / 100.0f;
        if (u + v > 1.0f) {
            continue;
        }
        const lmb_hit hit = {.instance = hull, .triangle = k / 10000, .u = u, .v = v};
        const lmb_place place = lmb_trace_place(bake->level.tracer, &hit);
        const double from_wall = metres_from_wall(room, place.position) / texel;
        float channel[LMB_MODEL_MOST_CHANNELS];
        CHECK(lmb_lightmap_sample(bake->lightmap, &hit, channel), "%s: no lightmap", room->name);
        if (from_wall < -reach) {
            light.dark_most = fmax(light.dark_most, (double)channel[0]);
        } else if (from_wall > 0.8 && from_wall < 1.6) {
            const lmb_vec3 over = lmb_vec3_mad(place.position, place.geometric_normal, 1e-4f);
            light.lit += (double)channel[0];
            light.lit_traced += (double)traced_irradiance(&bake->level, over, place.geometric_normal, 64).c[0];
            ++light.lit_count;
        }
    }
    light.lit /= light.lit_count;
    light.lit_traced /= light.lit_count;
    return light;
}

/* Filtering shows the last lit texel up to a texel away along the texels' axes, and up to their diagonal across them:
 * beyond that the dark side has no light, and the lit one has all of its own. */
static void light_stays_on_its_side(void)
{
    static const divided_room rooms[] = {
        {"a sheet", 0.033f, 0.0f, 0.0f, false},
        {"thinner than a texel", 0.033f, 0.05f, 0.0f, false},
        {"thinner than a texel of charts made here", 0.033f, 0.05f, 0.0f, true},
        {"as thick as a texel", 0.033f, 0.12f, 0.0f, false},
        {"thicker than texels", 0.033f, 0.4f, 0.0f, false},
        {"turned", 0.033f, 0.05f, 30.0f, false},
        {"turned, of charts made here", 0.033f, 0.2f, 30.0f, true},
    };
    for (size_t i = 0; i < sizeof rooms / sizeof rooms[0]; ++i) {
        baked bake;
        if (!room_bake(&rooms[i], &bake, 16)) {
            continue;
        }
        uint32_t hull = 0;
        while (hull + 1 < bake.level.scene->instance_count &&
               strcmp(bake.level.scene->instances[hull].name, "hull") != 0) {
            ++hull;
        }
        const double reach = rooms[i].turn_deg == 0.0f ? 1.0 : 1.42;
        const side_light light = light_beside_wall(&rooms[i], &bake, hull, reach);
        CHECK(light.dark_most <= 1e-3 * light.lit_traced, "%s: %g of %g beyond the wall", rooms[i].name,
              light.dark_most, light.lit_traced);
        CHECK_NEAR(light.lit / light.lit_traced, 1.0, 0.05, "%s: the lit side", rooms[i].name);
        baked_close(&bake);
    }
}

static const test_case cases[] = {
    {"light_stays_on_its_side", light_stays_on_its_side},
};

TEST_MAIN(cases)
