/* Sets of lights baked together: the same bytes as by themselves, one placement, and light that adds up. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/volume.h>

#include "command_fixture.h"
#include "floor_fixture.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/bake_sets"
#define LEVEL OUTPUT "/level.glb"
#define EFFORT " --quiet --env '#405060,set=sky' --spacing 2 --samples 64 --lightmaps --texels-per-m 1"
#define LEVELS " --min-spacing 0.5"

enum { SETS = 3 };
static const char *const names[SETS] = {"base", "lamp", "sky"};

/* A floor under a sky, a sun that names no set, and a lamp behind a wall. */
static bool level_make(void)
{
    lmb_level_builder *const builder = floor_begin(0.5f, 4.0f);
    const lmb_level_light lamp = {
        .name = "lamp", .type = LMB_LEVEL_LIGHT_POINT, .color = {{1.0f, 0.5f, 0.25f}}, .intensity = 5.0f};
    const lmb_level_light sun = {
        .name = "sun", .type = LMB_LEVEL_LIGHT_DIRECTIONAL, .color = {{1.0f, 1.0f, 0.9f}}, .intensity = 3.0f};
    lmb_level_node node = lmb_level_node_default("lamp");
    node.light = lmb_level_builder_add_light(builder, &lamp);
    node.light_set = "lamp";
    node.translation = (lmb_vec3){1.0f, 1.0f, 0.5f};
    lmb_level_builder_add_node(builder, &node);
    node = lmb_level_node_default("sun");
    node.light = lmb_level_builder_add_light(builder, &sun);
    lmb_level_look_along((lmb_vec3){0.3f, -1.0f, 0.2f}, node.rotation);
    lmb_level_builder_add_node(builder, &node);
    const lmb_level_material wall = lmb_level_material_default();
    const int mesh = lmb_level_builder_add_mesh(builder, "wall");
    const lmb_level_box box =
        lmb_level_box_of((lmb_vec3){0, 0, -2}, (lmb_vec3){0.2f, 2, 2}, lmb_level_builder_add_material(builder, &wall));
    lmb_level_builder_add_box(builder, mesh, &box);
    node = lmb_level_node_default("wall");
    node.mesh = mesh;
    node.local_size[0] = node.local_size[1] = node.local_size[2] = 2;
    node.local_set = true;
    lmb_level_builder_add_node(builder, &node);
    mkdir(OUTPUT, 0777);
    lmb_error error = {{0}};
    const lmb_result result = lmb_level_builder_write(builder, LEVEL, &error);
    lmb_level_builder_destroy(builder);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

static bool sets_make(void)
{
    static bool made;
    if (!made) {
        made = level_make();
        CHECK_RUN(0, NULL,
                  "rm -rf " OUTPUT "/all && " LMB_COMMAND " bake " LEVEL EFFORT LEVELS
                  " --light-sets all --threads 2 -o " OUTPUT "/all");
    }
    return made;
}

/* Files of a set in `all` and what was baked for it elsewhere. */
static void files_are_the_same(const char *set, const char *other)
{
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && for f in $(cd all/%s && echo probes.* lightmap/*); do cmp all/%s/$f %s/$f || exit 1; "
              "done",
              set, set, other);
}

static void each_is_as_by_itself(void)
{
    if (!sets_make()) {
        return;
    }
    for (int i = 0; i < SETS; ++i) {
        CHECK_RUN(0, NULL,
                  "rm -rf " OUTPUT "/one && " LMB_COMMAND " bake " LEVEL EFFORT LEVELS
                  " --light-set %s --placed-by-all --threads 1 -o " OUTPUT "/one",
                  names[i]);
        files_are_the_same(names[i], "one");
    }
    CHECK_RUN(1, NULL, "ls " OUTPUT "/all | grep -vx 'base\\|lamp\\|sky'");
}

/* Where levels do not depend on light, placement by all is placement: probes.vdb and bake.json, which hold the
 * settings, alone tell. */
static void even_lattices_need_no_option(void)
{
    if (!sets_make()) {
        return;
    }
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && rm -rf even alone && " LMB_COMMAND " bake " LEVEL EFFORT
              " --light-sets lamp,base -o even && " LMB_COMMAND " bake " LEVEL EFFORT
              " --light-set lamp -o alone && for f in $(cd alone && echo probes.lmb lightmap/*); do "
              "cmp even/lamp/$f alone/$f || exit 1; done && test ! -e even/sky");
}

static void pieces_make_the_same(void)
{
    if (!sets_make()) {
        return;
    }
    CHECK_RUN(0, NULL,
              "cd " OUTPUT " && rm -rf s1 s2 merged && for k in 1 2; do " LMB_COMMAND " bake " LEVEL EFFORT LEVELS
              " --light-sets lamp --shard $k/2 -o s$k || exit 1; done && " LMB_COMMAND
              " merge s1/lamp s2/lamp -o merged --quiet");
    files_are_the_same("lamp", "merged");
    CHECK_RUN(0, "current", LMB_COMMAND " bake " LEVEL EFFORT LEVELS " --light-sets all -o " OUTPUT "/all");
    CHECK_RUN(0, "\"placed_by_all\":true", "tr -d ' \\t\\n' < " OUTPUT "/all/sky/bake.json");
}

typedef struct open_volumes {
    lmb_volume *volume[SETS];
} open_volumes;

static bool volumes_open(open_volumes *open)
{
    bool good = sets_make();
    for (int i = 0; i < SETS; ++i) {
        char path[512];
        snprintf(path, sizeof path, OUTPUT "/all/%s/probes.lmb", names[i]);
        open->volume[i] = NULL;
        good = good && lmb_volume_open_file(path, &open->volume[i]) == LMB_OK;
    }
    CHECK(good, "opened");
    return good;
}

static void volumes_close(open_volumes *open)
{
    for (int i = 0; i < SETS; ++i) {
        lmb_volume_close(open->volume[i]);
    }
}

static lmb_vec3d place_of(int i)
{
    return (lmb_vec3d){-1.8 + 0.37 * (i % 10), 0.15 + 0.31 * (i / 10 % 5), -1.6 + 0.41 * (i / 50)};
}

/* One placement: the same probes and cells, so that a blend is one of probes. */
static void volumes_have_the_same_probes(void)
{
    open_volumes open;
    if (volumes_open(&open)) {
        for (int i = 1; i < SETS; ++i) {
            const lmb_volume_info a = lmb_volume_get_info(open.volume[0]), b = lmb_volume_get_info(open.volume[i]);
            CHECK(a.probe_count == b.probe_count && a.probe_count > 0, "%s", names[i]);
            for (int k = 0; k < 200; ++k) {
                const lmb_vec3d at = place_of(k);
                CHECK(lmb_volume_spacing_at(open.volume[0], at) == lmb_volume_spacing_at(open.volume[i], at),
                      "%s, place %d", names[i], k);
            }
        }
    }
    volumes_close(&open);
}

/* Blending is linear in the weights but for rounding. */
static void weights_are_linear(void)
{
    static const float weight[3][SETS] = {{0.25f, 1.5f, 0.5f}, {2.0f, 0.0f, 0.125f}, {0.0f, 3.0f, 1.0f}};
    open_volumes open;
    if (volumes_open(&open)) {
        const lmb_volume *const volumes[SETS] = {open.volume[0], open.volume[1], open.volume[2]};
        for (int i = 0; i < 600; ++i) {
            const float *const w = weight[i / 200];
            lmb_sh3_rgb own[SETS], blend;
            for (int k = 0; k < SETS; ++k) {
                lmb_volume_sample_at(volumes[k], place_of(i % 200), &own[k]);
            }
            lmb_volume_blend(volumes, w, SETS, place_of(i % 200), &blend);
            for (int c = 0; c < 3 * LMB_SH3_COUNT; ++c) {
                double sum = 0.0, size = 0.0;
                for (int k = 0; k < SETS; ++k) {
                    const double part = (double)w[k] * (double)own[k].channel[c / LMB_SH3_COUNT].c[c % LMB_SH3_COUNT];
                    sum += part;
                    size += fabs(part);
                }
                CHECK_NEAR(blend.channel[c / LMB_SH3_COUNT].c[c % LMB_SH3_COUNT], sum, 1e-6 * size + 1e-12,
                           "place %d, number %d", i, c);
            }
        }
    }
    volumes_close(&open);
}

/* All weights 1: the bake of all lights, but for noise, which is of other samples. */
static void sum_is_the_whole(void)
{
    open_volumes open;
    lmb_volume *whole = NULL;
    if (volumes_open(&open)) {
        CHECK_RUN(0, NULL,
                  "rm -rf " OUTPUT "/whole && " LMB_COMMAND " bake " LEVEL EFFORT LEVELS " -o " OUTPUT "/whole");
        CHECK(lmb_volume_open_file(OUTPUT "/whole/probes.lmb", &whole) == LMB_OK, "opened");
        CHECK(whole && lmb_volume_get_info(whole).probe_count == lmb_volume_get_info(open.volume[0]).probe_count,
              "placed alike");
        const lmb_volume *const volumes[SETS] = {open.volume[0], open.volume[1], open.volume[2]};
        const float ones[SETS] = {1.0f, 1.0f, 1.0f};
        double off = 0.0, light = 0.0;
        for (int i = 0; whole && i < 200; ++i) {
            lmb_sh3_rgb sum, all;
            lmb_volume_blend(volumes, ones, SETS, place_of(i), &sum);
            lmb_volume_sample_at(whole, place_of(i), &all);
            for (int c = 0; c < 3; ++c) {
                const double less = (double)sum.channel[c].c[0] - (double)all.channel[c].c[0];
                off += less * less;
                light += (double)all.channel[c].c[0] * (double)all.channel[c].c[0];
            }
        }
        CHECK(light > 0.0 && sqrt(off / light) < 0.03, "%g", sqrt(off / light));
        lmb_key_light key[LMB_KEY_LIGHTS_MOST];
        for (int i = 0; i < SETS; ++i) {
            CHECK(lmb_volume_key_lights(open.volume[i], key) == (i == 0), "the sun is in the set that has it: %s",
                  names[i]);
        }
    }
    lmb_volume_close(whole);
    volumes_close(&open);
}

static void mistakes_are_told(void)
{
    if (!level_make()) {
        return;
    }
    CHECK_RUN(0, NULL, "rm -rf " OUTPUT "/wrong");
    CHECK_RUN(3, "no light is of the set 'lamps'",
              LMB_COMMAND " bake " LEVEL EFFORT " --light-sets lamp,lamps -o " OUTPUT "/wrong");
    CHECK_RUN(3, "no light is of the set ''",
              LMB_COMMAND " bake " LEVEL EFFORT " --light-sets lamp,,sky -o " OUTPUT "/wrong");
    CHECK_RUN(0, NULL, "test ! -e " OUTPUT "/wrong");
    CHECK_RUN(2, "--light-sets does not go with",
              LMB_COMMAND " bake " LEVEL " --light-sets all --light-set lamp -o " OUTPUT "/wrong");
    CHECK_RUN(2, "--light-sets does not go with", LMB_COMMAND " bake " LEVEL " --light-sets all --dry-run");
}

static const test_case cases[] = {
    {"each is as by itself", each_is_as_by_itself}, {"even lattices need no option", even_lattices_need_no_option},
    {"pieces make the same", pieces_make_the_same}, {"volumes have the same probes", volumes_have_the_same_probes},
    {"weights are linear", weights_are_linear},     {"sum is the whole", sum_is_the_whole},
    {"mistakes are told", mistakes_are_told},
};

TEST_MAIN(cases)
