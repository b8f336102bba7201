/* Levels of very many instances, through loading, tracing, placement and probes: by a node each, and by one. */
#define _POSIX_C_SOURCE 200809L

#include "hard_level.h"
#include "hard_raw.h"

#include <time.h>

#define WHITE_SKY "#ffffff"

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A hundred thousand boxes of one mesh, in rows, under a sky. */
static void a_node_each(void)
{
    enum { ALONG = 320, ACROSS = 313 };
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int mesh = lmb_level_builder_add_mesh(builder, "box");
    const lmb_level_box box =
        lmb_level_box_of((lmb_vec3){0, 0, 0}, (lmb_vec3){0.5f, 0.5f, 0.5f}, hard_material(builder, 0.5f, 0.0f));
    lmb_level_builder_add_box(builder, mesh, &box);
    for (int i = 0; i < ALONG * ACROSS; ++i) {
        lmb_level_builder_place(builder, "box", mesh, (lmb_vec3){(float)(i % ALONG), 0, (float)(i / ALONG)});
    }
    const char *path = hard_path("many", "glb");
    double at = seconds_now();
    hard_level level = {0};
    if (!hard_write(builder, path)) {
        return;
    }
    const double wrote = seconds_now() - at;
    at = seconds_now();
    if (!level_fixture_load(&level.traced, path, WHITE_SKY, 2)) {
        return;
    }
    const double loaded = seconds_now() - at;
    at = seconds_now();
    CHECK(level.traced.scene->instance_count == ALONG * ACROSS, "%u", level.traced.scene->instance_count);
    if (hard_bake_volume(&level, &(hard_settings){16.0f, 1.0f, 16})) {
        const double placed = seconds_now() - at;
        printf("     %d instances: written in %.2f s, loaded and made ready in %.2f s (%.0f MB), baked in %.2f s\n",
               ALONG * ACROSS, wrote, loaded, 1e-6 * (double)lmb_tracer_bytes(level.traced.tracer), placed);
        const lmb_rgb open = traced_irradiance(&level.traced, (lmb_vec3){100.7f, 0.51f, 100.7f}, hard_up, 256);
        CHECK_NEAR(open.c[0], 1.0, 0.02, "above the boxes");
    }
    hard_close(&level);
}

/* Boxes of one mesh in rows of 1000, 1 m apart, as one node of EXT_mesh_gpu_instancing. */
static bool boxes_write(const char *name, int count)
{
    static const float side[6][3][3] = {
        {{0, 0, 0.5f}, {0.5f, 0, 0}, {0, 0.5f, 0}},     {{0.5f, 0, 0}, {-0.5f, 0, 0}, {0, 0.5f, 0}},
        {{0.5f, 0, 0.5f}, {0, 0, -0.5f}, {0, 0.5f, 0}}, {{0, 0, 0}, {0, 0, 0.5f}, {0, 0.5f, 0}},
        {{0, 0.5f, 0.5f}, {0.5f, 0, 0}, {0, 0, -0.5f}}, {{0, 0, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}},
    };
    float corner[36][3];
    for (int i = 0; i < 6; ++i) {
        const float(*const s)[3] = side[i];
        raw_quad(corner + 6 * i, (lmb_vec3){s[0][0], s[0][1], s[0][2]}, (lmb_vec3){s[1][0], s[1][1], s[1][2]},
                 (lmb_vec3){s[2][0], s[2][1], s[2][2]});
    }
    FILE *const data = fopen(hard_path(name, "bin"), "wb");
    bool good = data && fwrite(corner, sizeof corner, 1, data) == 1;
    for (int i = 0; good && i < count; ++i) {
        const float at[3] = {(float)(i % 1000), 0, (float)(i / 1000)};
        good = fwrite(at, sizeof at, 1, data) == 1;
    }
    good = data && fclose(data) == 0 && good;
    FILE *const file = fopen(hard_path(name, "gltf"), "wb");
    if (file) {
        raw_text(file, "{'asset':{'version':'2.0'},'extensionsUsed':['EXT_mesh_gpu_instancing'],");
        fprintf(file,
                "\"buffers\":[{\"uri\":\"hard_%s.bin\",\"byteLength\":%d}],\"bufferViews\":["
                "{\"buffer\":0,\"byteLength\":432},{\"buffer\":0,\"byteOffset\":432,\"byteLength\":%d}],",
                name, 432 + 12 * count, 12 * count);
        fprintf(file,
                "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":36,\"type\":\"VEC3\"},"
                "{\"bufferView\":1,\"componentType\":5126,\"count\":%d,\"type\":\"VEC3\"}],",
                count);
        raw_text(file, "'materials':[{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1]}}],'meshes':[{'"
                       "primitives':[{'attributes':{'POSITION':0},'material':0}]}],'nodes':[{'name':'boxes','mesh':0,"
                       "'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':1}}}}]}");
        good = fclose(file) == 0 && good;
    }
    CHECK(good && file, "%s", hard_path(name, "gltf"));
    return good && file;
}

/* A million instances under a sky. Sanitizers, which take several times the memory, get a tenth. */
static void a_million_of_one_node(void)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    enum { COUNT = 100000 };
#else
    enum { COUNT = 1000000 };
#endif
    if (!boxes_write("million", COUNT)) {
        return;
    }
    double at = seconds_now();
    hard_level level = {0};
    if (!level_fixture_load(&level.traced, hard_path("million", "gltf"), WHITE_SKY, 2)) {
        return;
    }
    const double loaded = seconds_now() - at;
    at = seconds_now();
    CHECK(level.traced.scene->instance_count == COUNT, "%u", level.traced.scene->instance_count);
    if (hard_bake_volume(&level, &(hard_settings){32.0f, 1.0f, 16})) {
        printf("     %d instances: loaded and made ready in %.2f s (%.0f MB), baked in %.2f s\n", COUNT, loaded,
               1e-6 * (double)lmb_tracer_bytes(level.traced.tracer), seconds_now() - at);
        const lmb_rgb open = traced_irradiance(&level.traced, (lmb_vec3){50.7f, 0.51f, 50.7f}, hard_up, 256);
        CHECK_NEAR(open.c[0], 1.0, 0.02, "above the boxes");
        const lmb_rgb between = traced_irradiance(&level.traced, (lmb_vec3){50.75f, 0.01f, 50.25f}, hard_up, 256);
        CHECK(between.c[0] > 0.05f && between.c[0] < 0.8f, "between the boxes: %g", (double)between.c[0]);
    }
    hard_close(&level);
}

static const test_case cases[] = {
    {"a_node_each", a_node_each},
    {"a_million_of_one_node", a_million_of_one_node},
};

TEST_MAIN(cases)
