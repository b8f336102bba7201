/* Boxes that say how probes stand: where nodes put them, what they say, and which one counts. */
#define FOLDER LMB_TEST_OUTPUT_DIR "/probe_boxes"
#include "gltf_fixture.h"

#include <lambent/probe_boxes.h>

#include "warning_log.h"

/* Four corners, of the box from (0, 0, 0) to (4, 2, 6). */
#define CORNERS                                                                                                        \
    HEAD "'buffers':[{'uri':'corners.bin','byteLength':48}],'bufferViews':[{'buffer':0,'byteLength':48}],"             \
         "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'}],"                                \
         "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"

static lmb_scene *load(const char *text, warning_log *log)
{
    static const float corners[12] = {0, 0, 0, 4, 0, 0, 0, 2, 0, 0, 0, 6};
    CHECK(write_bytes("corners.bin", corners, sizeof corners), "corners.bin");
    *log = (warning_log){0};
    const lmb_gltf_options options = {.warnings = {warning_keep, log}};
    lmb_scene *scene = NULL;
    CHECK(load_text_with("boxes", text, &options, &scene) == LMB_OK, "%s", error.message);
    return scene;
}

static void test_places(void)
{
    /* A mesh that is moved and scaled by the node above; a cube that is turned by 45 degrees about Y; one that is
     * skewed by a scale above a turn. */
    warning_log log;
    lmb_scene *const scene =
        load(CORNERS "'nodes':[{'children':[1],'translation':[10,0,0],'scale':[1,2,1]},"
                     "{'name':'hall','mesh':0,'extras':{'lambent':{'volume':{}}}},"
                     "{'name':'turned','translation':[0,5,0],'rotation':[0,0.3826834323650898,0,0.9238795325112867],"
                     "'scale':[2,1,1],'extras':{'lambent':{'volume':{'exclude':true}}}},"
                     "{'scale':[3,1,1],'children':[4]},"
                     "{'rotation':[0,0.3826834323650898,0,0.9238795325112867],'translation':[0,-5,0],"
                     "'extras':{'lambent':'{\\\"volume\\\":{\\\"exclude\\\":1}}'}}]}",
             &log);
    if (!scene) {
        return;
    }
    CHECK(log.count == 0, "%s", log.last);
    CHECK(scene->instance_count == 0 && scene->mesh_count == 0, "%u surfaces", scene->instance_count);
    CHECK(scene->probe_box_count == 3, "%u boxes", scene->probe_box_count);
    static const struct {
        lmb_vec3 at;
        int32_t box;
    } cases[] = {
        {{10.1f, 0.1f, 0.1f}, 0},
        {{13.9f, 3.9f, 5.9f}, 0},
        {{10.0f, 0.0f, 6.0f}, 0},
        {{14.1f, 3.9f, 5.9f}, -1},
        {{13.9f, 4.1f, 5.9f}, -1},
        {{9.9f, 0.1f, 0.1f}, -1},
        /* turned: along (1, 0, -1) it reaches 2, along (1, 0, 1) 1 */
        {{1.4f, 5.0f, -1.4f}, 1},
        {{1.45f, 5.0f, -1.45f}, -1},
        {{0.7f, 5.9f, 0.7f}, 1},
        {{0.75f, 5.9f, 0.75f}, -1},
        {{0.0f, 3.9f, 0.0f}, -1},
        /* skewed: the corners of the turned cube, at sqrt(2), three times as far along x */
        {{4.2f, -5.0f, 0.0f}, 2},
        {{4.3f, -5.0f, 0.0f}, -1},
        {{0.0f, -5.0f, 1.4f}, 2},
        {{0.0f, -5.0f, 1.45f}, -1},
        {{3.0f, -5.0f, 0.9f}, -1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        CHECK(lmb_scene_probe_box(scene, cases[i].at) == cases[i].box, "case %zu: box %d", i,
              lmb_scene_probe_box(scene, cases[i].at));
    }
    CHECK(strcmp(scene->probe_boxes[0].name, "hall") == 0 && strcmp(scene->probe_boxes[2].name, "node 4") == 0,
          "'%s', '%s'", scene->probe_boxes[0].name, scene->probe_boxes[2].name);
    CHECK(!scene->probe_boxes[0].exclude && scene->probe_boxes[1].exclude && scene->probe_boxes[2].exclude, "exclude");
    for (int k = 0; k < 9; ++k) { /* from_world is the inverse */
        double product = 0.0;
        for (int i = 0; i < 3; ++i) {
            product += scene->probe_boxes[2].to_world.m[k / 3][i] * scene->probe_boxes[2].from_world.m[i][k % 3];
        }
        CHECK_NEAR(product, k / 3 == k % 3 ? 1.0 : 0.0, 1e-12, "element %d", k);
    }
    lmb_scene_destroy(scene);
}

/* Far from the world's origin boxes count from the scene's, as all positions do. */
static void test_far(void)
{
    warning_log log;
    lmb_scene *const scene =
        load(CORNERS "'nodes':[{'mesh':0,'translation':[4000000,0,0]},"
                     "{'translation':[4000000.5,0,0],'extras':{'lambent':{'volume':{'spacing':1}}}}]}",
             &log);
    if (!scene) {
        return;
    }
    CHECK(scene->probe_box_count == 1 && scene->origin.x > 3e6, "origin %g", scene->origin.x);
    CHECK(lmb_scene_probe_box(scene, lmb_scene_from_world(scene, (lmb_vec3d){4000001.4, 0.9, 0.9})) == 0, "inside");
    CHECK(lmb_scene_probe_box(scene, lmb_scene_from_world(scene, (lmb_vec3d){4000001.6, 0.9, 0.9})) == -1, "outside");
    lmb_scene_destroy(scene);
}

static void test_values(void)
{
    static const struct {
        const char *volume, *warned;
        float spacing, min_spacing, tolerance;
        bool exclude;
        double priority;
    } cases[] = {
        {"{}", NULL, 0, 0, 0, false, 0},
        {"{'spacing':0.5,'min_spacing':0.125,'tolerance':0.25,'priority':-2}", NULL, 0.5f, 0.125f, 0.25f, false, -2},
        {"{'exclude':true,'priority':1.5}", NULL, 0, 0, 0, true, 1.5},
        {"{'exclude':0}", NULL, 0, 0, 0, false, 0},
        {"{'exclude':'yes'}", "lambent.volume.exclude is neither", 0, 0, 0, false, 0},
        {"{'spacing':0,'tolerance':1}", "lambent.volume.spacing is not", 0, 0, 1, false, 0},
        {"{'min_spacing':-1}", "lambent.volume.min_spacing is not", 0, 0, 0, false, 0},
        {"{'tolerance':'fine'}", "lambent.volume.tolerance is not", 0, 0, 0, false, 0},
        {"{'priority':[1]}", "lambent.volume.priority is not a number", 0, 0, 0, false, 0},
        {"{'spacings':1}", "lambent.volume.spacings is unknown", 0, 0, 0, false, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[512];
        snprintf(text, sizeof text, HEAD "'nodes':[{'extras':{'lambent':{'volume':%s}}}]}", cases[i].volume);
        warning_log log;
        lmb_scene *const scene = load(text, &log);
        CHECK(log.count == (cases[i].warned ? 1 : 0) && (!cases[i].warned || strstr(log.last, cases[i].warned)),
              "%s: %d warnings, '%s'", cases[i].volume, log.count, log.last);
        CHECK(scene && scene->probe_box_count == 1, "%s: no box", cases[i].volume);
        const lmb_probe_box box = scene && scene->probe_box_count == 1 ? scene->probe_boxes[0] : (lmb_probe_box){0};
        CHECK(box.spacing == cases[i].spacing && box.min_spacing == cases[i].min_spacing &&
                  box.tolerance == cases[i].tolerance && box.exclude == cases[i].exclude &&
                  box.priority == cases[i].priority,
              "%s: %g %g %g %d %g", cases[i].volume, (double)box.spacing, (double)box.min_spacing,
              (double)box.tolerance, box.exclude, box.priority);
        lmb_scene_destroy(scene);
    }
}

/* No box, with a warning. */
static void test_no_boxes(void)
{
    static const struct {
        const char *node, *warned;
    } cases[] = {
        {"{'extras':{'lambent':{'volume':true}}}", "lambent.volume is not an object"},
        {"{'scale':[1,0,1],'extras':{'lambent':{'volume':{}}}}", "flat box"},
        {"{'name':'far','translation':[1e17,0,0],'scale':[1,1,0],'extras':{'lambent':{'volume':{}}}}", "node 'far'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char text[512];
        snprintf(text, sizeof text, HEAD "'nodes':[%s]}", cases[i].node);
        warning_log log;
        lmb_scene *const scene = load(text, &log);
        CHECK(scene && scene->probe_box_count == 0 && strstr(log.last, cases[i].warned), "%s: %u, '%s'", cases[i].node,
              scene ? scene->probe_box_count : 0, log.last);
        lmb_scene_destroy(scene);
    }
}

static void test_priorities(void)
{
    warning_log log;
    /* Cubes about (0, 0, 0) of half 1, 2, 3, 4; priorities 0, 0, 5, -1. Hidden ones count too, excluded ones do not. */
    lmb_scene *const scene =
        load(HEAD "'extensionsUsed':['KHR_node_visibility'],'nodes':[{'extras':{'lambent':{'volume':{}}}},"
                  "{'scale':[2,2,2],'extras':{'lambent':{'volume':{}}}},"
                  "{'scale':[3,1,1],'extras':{'lambent':{'volume':{'priority':5}}}},"
                  "{'scale':[4,4,4],'extras':{'lambent':{'volume':{'priority':-1}}},"
                  "'extensions':{'KHR_node_visibility':{'visible':false}}}]}",
             &log);
    if (!scene) {
        return;
    }
    static const struct {
        lmb_vec3 at;
        int32_t box;
    } cases[] = {{{0, 0, 0}, 2}, {{2.5f, 0, 0}, 2}, {{0, 1.5f, 0}, 1}, {{0, 0, 3.5f}, 3}, {{0, 5, 0}, -1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        CHECK(lmb_scene_probe_box(scene, cases[i].at) == cases[i].box, "case %zu: %d", i,
              lmb_scene_probe_box(scene, cases[i].at));
    }
    lmb_scene_destroy(scene);
}

/* The cube from -1 to 1 of a node that stands at (10, 0, 0), turned by 45 degrees about Y and twice as wide along its
 * X. */
static void test_touching(void)
{
    warning_log log;
    lmb_scene *const scene =
        load(HEAD "'nodes':[{'translation':[10,0,0],'rotation':[0,0.3826834323650898,0,0.9238795325112867],"
                  "'scale':[2,1,1],'extras':{'lambent':{'volume':{}}}}]}",
             &log);
    if (!scene) {
        return;
    }
    /* Its corners lie at 10 + (x, z) with x = (+-2 +- 1) / sqrt 2 and z likewise: from -2.12 to 2.12, on the diagonal
     * from (-, +) to (+, -). */
    static const struct {
        double low[3], high[3];
        bool touches, held;
    } cases[] = {
        {{9.9, -0.1, -0.1}, {10.1, 0.1, 0.1}, true, true},
        {{9.0, -1.0, -0.1}, {11.0, 1.0, 0.1}, true, true},   /* 1.1 / sqrt 2 across at most; faces may be shared */
        {{5.0, -5.0, -5.0}, {15.0, 5.0, 5.0}, true, false},  /* all around it */
        {{11.0, -0.1, 1.0}, {12.0, 0.1, 2.0}, false, false}, /* its bounds, but not it: beside a slanted face */
        {{10.6, -0.1, 0.6}, {12.0, 0.1, 2.0}, true, false},  /* a corner pokes in: 1.2 / sqrt 2 < 1 */
        {{10.0, 1.0, -0.1}, {10.5, 2.0, 0.1}, false, false}, /* on its lid */
        {{10.0, 0.99, -0.1}, {10.5, 2.0, 0.1}, true, false},
        {{12.2, -1.0, -3.0}, {13.0, 1.0, 3.0}, false, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const lmb_probe_box *const box = &scene->probe_boxes[0];
        CHECK(lmb_probe_box_touches(box, cases[i].low, cases[i].high) == cases[i].touches, "case %zu", i);
        CHECK(lmb_probe_box_holds(box, cases[i].low, cases[i].high) == cases[i].held, "case %zu", i);
    }
    lmb_scene_destroy(scene);
}

static const test_case cases[] = {
    {"places", test_places},     {"far from the origin", test_far}, {"values", test_values},
    {"no boxes", test_no_boxes}, {"priorities", test_priorities},   {"touching", test_touching},
};
TEST_MAIN(cases)
