/* Seams between charts: closed where a surface goes on, left where it does not. */
#include "hard_level.h"
#include "lightmap_fixture.h"

typedef struct seam_level {
    baked bake;
    bool open;
} seam_level;

/* Two squares of 2 m beside each other at x = 0, nodes of their own, the second turned up by `rise` metres a metre,
 * under a lamp of 1 candela at `lamp`. Between them a wall of that height, none for 0. */
static seam_level seam_level_bake(const char *path, float rise, float wall, lmb_vec3 lamp)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int grey = hard_material(builder, 0.0f, 0.0f);
    const int left = lmb_level_builder_add_mesh(builder, "left"), right = lmb_level_builder_add_mesh(builder, "right");
    lmb_level_builder_add_quad(builder, left, grey, (lmb_vec3){-2, 0, 1}, (lmb_vec3){2, 0, 0}, (lmb_vec3){0, 0, -2});
    lmb_level_builder_add_quad(builder, right, grey, (lmb_vec3){0, 0, 1}, (lmb_vec3){2, 2 * rise, 0},
                               (lmb_vec3){0, 0, -2});
    lmb_level_builder_place(builder, "left", left, (lmb_vec3){0, 0, 0});
    lmb_level_builder_place(builder, "right", right, (lmb_vec3){0, 0, 0});
    if (wall > 0.0f) {
        hard_add_box(builder, "wall", grey, (lmb_vec3){-0.01f, -0.1f, -1.1f}, (lmb_vec3){0.01f, wall, 1.1f}, false);
    }
    hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, 1.0f, lamp);
    lmb_error error = {""};
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    seam_level level = {.open = level_fixture_open(&level.bake.level, path, written, &error, 2)};
    level.open = level.open && lightmap_make(&level.bake, 4.0f, 256) && lightmap_bake(&level.bake, 64);
    return level;
}

static double light_at(const seam_level *level, const char *instance, float u, float v)
{
    const lmb_hit hit = {.instance = hard_instance(level->bake.level.scene, instance), .u = u, .v = v};
    float channel[LMB_MODEL_MOST_CHANNELS];
    CHECK(lmb_lightmap_sample(level->bake.lightmap, &hit, channel), "no lightmap");
    return (double)channel[0];
}

static void charts_meet(void)
{
    seam_level level = seam_level_bake(OUTPUT("seams_meet.glb"), 0.0f, 0.0f, (lmb_vec3){0.5f, 0.6f, 0.2f});
    if (level.open) {
        const lmb_seam_steps *open = &level.bake.lightmap->open, *closed = &level.bake.lightmap->closed;
        CHECK(closed->edges == 1, "%zu edges", closed->edges);
        CHECK(open->median > 0.1 && closed->median < 0.15 * open->median, "median %g, before %g", closed->median,
              open->median);
        CHECK(closed->p95 < 0.15 * open->p95, "p95 %g, before %g", closed->p95, open->p95);
        lmb_seam_steps again;
        CHECK(lmb_lightmap_seam_steps(level.bake.lightmap, level.bake.level.tracer, &again) == LMB_OK, "memory");
        CHECK(again.edges == 1 && again.median == closed->median && again.p95 == closed->p95, "median %g",
              again.median);
        baked_close(&level.bake);
    }
}

/* Where a wall stands on the edge, light stays on its side. */
static void walls_part(void)
{
    seam_level level = seam_level_bake(OUTPUT("seams_wall.glb"), 0.0f, 3.0f, (lmb_vec3){1.0f, 0.5f, 0.0f});
    if (level.open) {
        CHECK(level.bake.lightmap->closed.edges == 0, "%zu edges", level.bake.lightmap->closed.edges);
        CHECK(light_at(&level, "left", 0.99f, 0.005f) < 1e-6, "dark side has %g",
              light_at(&level, "left", 0.99f, 0.005f));
        baked_close(&level.bake);
    }
}

/* Where a surface bends, light has a step of its own. */
static void bends_stay(void)
{
    seam_level level = seam_level_bake(OUTPUT("seams_bend.glb"), 1.0f, 0.0f, (lmb_vec3){-1.0f, 0.5f, 0.0f});
    if (level.open) {
        CHECK(level.bake.lightmap->closed.edges == 0, "%zu edges", level.bake.lightmap->closed.edges);
        baked_close(&level.bake);
    }
}

/* Quads of one mesh have charts of their own; so have the sides of a box, but these bend. */
static void meshes_close_their_own(void)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int grey = hard_material(builder, 0.5f, 0.0f);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    for (int i = 0; i < 4; ++i) {
        lmb_level_builder_add_quad(builder, floor, grey, (lmb_vec3){(float)(i % 2), 0, (float)(i / 2)},
                                   (lmb_vec3){1, 0, 0}, (lmb_vec3){0, 0, -1});
    }
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    hard_add_box(builder, "box", grey, (lmb_vec3){5, 1, 5}, (lmb_vec3){6, 2, 6}, false);
    hard_add_light(builder, LMB_LEVEL_LIGHT_POINT, 1.0f, (lmb_vec3){0.7f, 0.5f, -0.2f});
    lmb_error error = {""};
    const char *path = OUTPUT("seams_mesh.glb");
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    baked bake;
    if (level_fixture_open(&bake.level, path, written, &error, 2)) {
        if (lightmap_make(&bake, 4.0f, 256) && lightmap_bake(&bake, 64)) {
            CHECK(bake.lightmap->closed.edges == 4, "%zu edges", bake.lightmap->closed.edges);
            CHECK(bake.lightmap->closed.median < 0.2 * bake.lightmap->open.median, "median %g, before %g",
                  bake.lightmap->closed.median, bake.lightmap->open.median);
        }
        baked_close(&bake);
    }
}

static const test_case cases[] = {
    {"charts_meet", charts_meet},
    {"walls_part", walls_part},
    {"bends_stay", bends_stay},
    {"meshes_close_their_own", meshes_close_their_own},
};

TEST_MAIN(cases)
