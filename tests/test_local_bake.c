/* Local sets of a level's nodes: frames about turned, scaled, mirrored and flat objects, light in a furnace, the same
 * bytes however they are baked, and nodes that are lit by them. */
#define _POSIX_C_SOURCE 200809L
#include <lambent/probe_locals.h>

#include <stdlib.h>

#include <lambent/gltf.h>
#include <lambent/vector.h>

#include "command_fixture.h"
#include "scenes/level_builder.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/local_bake"
#define LEVEL OUTPUT "/furnace.glb"
#define EFFORT " --quiet --spacing 0.5 --samples 256 --lightmaps --texels-per-m 10"

enum { LEFT, RIGHT, FLAT, PLANT, NODES };
static const char *const names[NODES] = {"left", "right", "flat", "plant"};

static int material_add(lmb_level_builder *builder, const char *name, float albedo)
{
    lmb_level_material material = lmb_level_material_default();
    material.name = name;
    material.base_color = (lmb_rgb){{albedo, albedo, albedo}};
    material.emission = (lmb_rgb){{1.0f - albedo, 1.0f - albedo, 1.0f - albedo}};
    return lmb_level_builder_add_material(builder, &material);
}

static lmb_level_node node_of(int which, int mesh, lmb_vec3 at)
{
    lmb_level_node node = lmb_level_node_default(names[which]);
    node.mesh = mesh;
    node.translation = at;
    node.local_set = which != PLANT;
    return node;
}

/* A furnace: whatever reflects a share of the light gives off the rest of 1, so that radiance is 1 everywhere. */
static bool furnace_write(void)
{
    lmb_error error = {{0}};
    lmb_level_builder *const builder = lmb_level_builder_create(0.2f);
    const int black = material_add(builder, "black", 0.0f), grey = material_add(builder, "grey", 0.5f);
    const int room = lmb_level_builder_add_mesh(builder, "room"), block = lmb_level_builder_add_mesh(builder, "block");
    const int sheet = lmb_level_builder_add_mesh(builder, "sheet");
    lmb_level_box box = {.min = {-3.0f, 0.0f, -3.0f}, .max = {3.0f, 3.0f, 3.0f}, .inward = true};
    for (int side = 0; side < 6; ++side) {
        box.material[side] = black;
    }
    lmb_level_builder_add_box(builder, room, &box);
    lmb_level_box small = {.min = {-0.2f, 0.0f, -0.3f}, .max = {0.2f, 0.8f, 0.3f}};
    for (int side = 0; side < 6; ++side) {
        small.material[side] = grey;
    }
    lmb_level_builder_add_box(builder, block, &small);
    lmb_level_builder_add_quad(builder, sheet, grey, (lmb_vec3){-0.5f, 0.0f, 0.0f}, (lmb_vec3){1.0f, 0.0f, 0.0f},
                               (lmb_vec3){0.0f, 1.0f, 0.0f});
    lmb_level_builder_place(builder, "room", room, (lmb_vec3){0.0f, 0.0f, 0.0f});
    lmb_level_node left = node_of(LEFT, block, (lmb_vec3){-1.5f, 0.5f, 0.0f});
    lmb_level_turn(0.5f, left.rotation);
    left.scale = (lmb_vec3){1.0f, 2.0f, 0.5f};
    lmb_level_builder_add_node(builder, &left);
    lmb_level_node right = node_of(RIGHT, block, (lmb_vec3){1.5f, 0.5f, 0.0f});
    right.scale = (lmb_vec3){-1.0f, 1.0f, 1.0f};
    right.dynamic = true;
    right.local_size[0] = right.local_size[1] = 3;
    right.local_size[2] = 2;
    lmb_level_builder_add_node(builder, &right);
    lmb_level_node flat = node_of(FLAT, sheet, (lmb_vec3){0.0f, 1.0f, -2.0f});
    lmb_level_turn(-0.3f, flat.rotation);
    lmb_level_builder_add_node(builder, &flat);
    lmb_level_node plant = node_of(PLANT, block, (lmb_vec3){0.0f, 0.5f, 1.5f});
    plant.lit_locally = true;
    lmb_level_builder_add_node(builder, &plant);
    mkdir(OUTPUT, 0777);
    const lmb_result result = lmb_level_builder_write(builder, LEVEL, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static bool bake_make(void)
{
    static bool made;
    if (!made) {
        made = furnace_write() && CHECK_RUN(0, NULL,
                                            "rm -rf " OUTPUT "/whole && " LMB_COMMAND " bake " LEVEL EFFORT
                                            " --threads 2 -o " OUTPUT "/whole");
    }
    return made;
}

static const lmb_instance *instance_find(const lmb_scene *scene, int which, uint32_t *index)
{
    for (*index = 0; *index < scene->instance_count; ++*index) {
        if (strcmp(scene->instances[*index].name, names[which]) == 0) {
            return &scene->instances[*index];
        }
    }
    CHECK(false, "no instance %s", names[which]);
    return NULL;
}

/* The corners of an object reach just from the first probes of its frame to the last. */
static void frame_holds(const lmb_scene *scene, const lmb_instance *instance, const lmb_local_frame *frame)
{
    const lmb_mesh *const mesh = &scene->meshes[instance->mesh];
    for (int axis = 0; axis < 3; ++axis) {
        double low = 1e9, high = -1e9;
        const lmb_vec3 step = frame->step[axis];
        for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
            const lmb_vec3 p = mesh->position[v];
            double along = 0.0;
            for (int r = 0; r < 3; ++r) {
                const double *const m = instance->to_world.m[r];
                const double world = m[0] * (double)p.x + m[1] * (double)p.y + m[2] * (double)p.z + m[3];
                along += (world - (&frame->origin.x)[r]) * (double)(&step.x)[r];
            }
            low = fmin(low, along / (double)lmb_vec3_dot(step, step));
            high = fmax(high, along / (double)lmb_vec3_dot(step, step));
        }
        CHECK_NEAR(low, 0.0, 1e-4, "%s, axis %d", instance->name, axis);
        CHECK_NEAR(high, frame->size[axis] > 1 ? frame->size[axis] - 1.0 : 0.0, 1e-4, "%s, axis %d", instance->name,
                   axis);
    }
}

static void frames_hold_their_objects(void)
{
    static const uint32_t sizes[NODES][3] = {{2, 6, 2}, {3, 3, 2}, {6, 6, 1}, {4, 6, 5}};
    lmb_scene *scene = NULL;
    lmb_error error = {{0}};
    if (!furnace_write()) {
        return;
    }
    CHECK(lmb_gltf_load(LEVEL, NULL, &scene, &error) == LMB_OK, "%s", error.message);
    for (int which = 0; scene && which < NODES; ++which) {
        uint32_t index;
        const lmb_instance *const instance = instance_find(scene, which, &index);
        lmb_local_frame frame;
        if (!instance || !lmb_probe_local_frame(scene, index, &frame)) {
            continue;
        }
        CHECK(lmb_local_frame_is_valid(&frame), "%s", names[which]);
        for (int axis = 0; axis < 3; ++axis) {
            CHECK(frame.size[axis] == sizes[which][axis], "%s, axis %d: %u", names[which], axis, frame.size[axis]);
        }
        frame_holds(scene, instance, &frame);
    }
    lmb_scene_destroy(scene);
}

/* Radiance 1 has 2 sqrt(pi) as coefficient 0 and no others. Samples of the walls' light are noisy, of one probe by some
 * hundredths; their mean is not. */
static void furnace_holds(const char *name, const lmb_sh3_rgb *radiance, uint32_t count)
{
    double mean = 0.0, squared = 0.0;
    for (uint32_t k = 0; k < count; ++k) {
        const float *const c = radiance[k].channel[1].c;
        CHECK_NEAR(c[0] / 3.5449077f, 1.0, 0.1, "%s, probe %u", name, k);
        mean += (double)c[0] / 3.5449077 / count;
        for (int i = 1; i < LMB_SH3_COUNT; ++i) {
            squared += (double)(c[i] * c[i]) / (8.0 * count);
        }
    }
    CHECK_NEAR(mean, 1.0, 0.015, "%s", name);
    CHECK_NEAR(sqrt(squared), 0.0, 0.12, "%s: what is not constant", name);
}

static void light_of_a_furnace_is_constant(void)
{
    static lmb_sh3_rgb radiance[LMB_LOCAL_SET_MOST];
    lmb_volume *volume = NULL;
    if (!bake_make()) {
        return;
    }
    CHECK(lmb_volume_open_file(OUTPUT "/whole/probes.lmb", &volume) == LMB_OK, "opened");
    CHECK(volume && lmb_volume_local_set_count(volume) == NODES, "a set for each");
    for (int which = 0; volume && which < NODES; ++which) {
        const uint32_t index = lmb_volume_local_set_find(volume, names[which]);
        CHECK(index < lmb_volume_local_set_count(volume), "%s", names[which]);
        if (index == lmb_volume_local_set_count(volume)) {
            continue;
        }
        const lmb_local_set set = lmb_volume_local_set_get(volume, index);
        lmb_volume_local_set_light(volume, index, radiance, NULL);
        furnace_holds(names[which], radiance, lmb_local_frame_count(&set.frame));
    }
    lmb_volume_close(volume);
}

static void bytes_are_the_same_however_baked(void)
{
    if (!bake_make()) {
        return;
    }
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && rm -rf one s1 s2 merged && " LMB_COMMAND " bake " LEVEL EFFORT
              " --threads 1 -o one && for k in 1 2; do " LMB_COMMAND " bake " LEVEL EFFORT
              " --shard $k/2 -o s$k || exit 1; done && " LMB_COMMAND " merge s1 s2 -o merged --quiet");
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && for d in one merged; do for f in $(cd whole && echo probes.* lightmap/*); do "
              "cmp whole/$f $d/$f || exit 1; done; done");
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && " LMB_COMMAND " pack whole/probes.vdb -o packed.lmb && cmp packed.lmb "
              "whole/probes.lmb");
}

/* The plant has no texels, and its set lights it as the furnace does. */
static void marked_nodes_are_lit_by_them(void)
{
    if (!bake_make()) {
        return;
    }
    CHECK_RUN(1, NULL, "grep -q '\"plant\"' " OUTPUT "/whole/lightmap/lightmap.json");
    CHECK_RUN(0, NULL, "grep -q '\"left\"' " OUTPUT "/whole/lightmap/lightmap.json");
    CHECK_RUN(0, "\"name\":\"plant\"", LMB_COMMAND " info " OUTPUT "/whole/probes.lmb");
    CHECK_RUN(0, "\"name\":\"plant\"", LMB_COMMAND " info " OUTPUT "/whole/probes.vdb");
    CHECK_RUN(0, "mean radiance", LMB_COMMAND " sample " OUTPUT "/whole/probes.lmb --local-set plant --at 0,0.4,1.5");
    CHECK_RUN(3, "has no local set 'tree'",
              LMB_COMMAND " sample " OUTPUT "/whole/probes.lmb --local-set tree --at 0,0.4,1.5");
    CHECK_RUN(0, "local_set_vs_reference",
              LMB_COMMAND " check " LEVEL " " OUTPUT "/whole --quiet --points 600 --samples 16 --fail-above "
                          "local_set_vs_reference=0.05");
    CHECK_RUN(0, NULL,
              LMB_COMMAND " render " LEVEL " " OUTPUT "/whole --quiet --probes --size 64x48 -o " OUTPUT "/probes.png");
}

/* In a furnace every source gives every object the same light, wherever it stands. */
static void measured_objects_have_no_error(void)
{
    if (!furnace_write()) {
        return;
    }
    static const char *const rows[] = {"standing\tvolume", "standing\tresampled", "standing\tlocal set",
                                       "there\tlocal set", "moved\tvolume",       "moved\tresampled"};
    const char *const output = OUTPUT "/objects.txt";
    CHECK_RUN(0, NULL,
              LMB_LOCAL_SETS " " LEVEL
                             " --quiet --spacing 0.5 --samples 256 --points 16 --truth 64 --places 1 > " OUTPUT
                             "/objects.txt");
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        char line[256];
        snprintf(line, sizeof line, "grep 'all\t%s' %s | awk -F'\t' '{ exit !($4 > 10 && $5 < 0.05 && $6 < 0.05) }'",
                 rows[i], output);
        CHECK(system(line) == 0, "%s", rows[i]);
    }
    CHECK_RUN(3, "no object",
              LMB_LOCAL_SETS " " LEVEL " --quiet --node tree --exclude left --exclude right --exclude flat "
                             "--exclude plant");
}

static const test_case cases[] = {
    {"frames hold their objects", frames_hold_their_objects},
    {"light of a furnace is constant", light_of_a_furnace_is_constant},
    {"bytes are the same however baked", bytes_are_the_same_however_baked},
    {"marked nodes are lit by them", marked_nodes_are_lit_by_them},
    {"measured objects have no error", measured_objects_have_no_error},
};

TEST_MAIN(cases)
