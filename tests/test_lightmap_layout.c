/* Layouts: what they say about UVs, densities and islands, and the padding that is asked for. */
#include "lightmap_fixture.h"
#include "variates.h"

#include <lambent/file.h>

enum { LINES_MOST = 32, LINE_SIZE = 512 };

/* Keeps what is said. */
typedef struct listener {
    char line[LINES_MOST][LINE_SIZE];
    int count;
} listener;

static void line_keep(void *context, const char *line)
{
    listener *heard = context;
    if (heard->count < LINES_MOST) {
        snprintf(heard->line[heard->count], LINE_SIZE, "%s", line);
    }
    ++heard->count;
}

/* How many lines have both texts. */
static int lines_with(const listener *heard, const char *first, const char *second)
{
    int found = 0;
    for (int i = 0; i < heard->count && i < LINES_MOST; ++i) {
        found += strstr(heard->line[i], first) && strstr(heard->line[i], second);
    }
    return found;
}

static void lines_print(const listener *heard)
{
    for (int i = 0; i < heard->count && i < LINES_MOST; ++i) {
        fprintf(stderr, "     said: %s\n", heard->line[i]);
    }
}

static lmb_lightmap *layout_make(const lmb_scene *scene, float texels_per_m, int32_t size, int32_t padding,
                                 listener *heard)
{
    lmb_lightmap *lightmap = NULL;
    lmb_error error = {""};
    const lmb_lightmap_settings settings = {.texels_per_m = texels_per_m,
                                            .max_image_size = size,
                                            .padding = padding,
                                            .warnings = {heard ? line_keep : NULL, heard}};
    const lmb_result result = lmb_lightmap_create(scene, &settings, &lightmap, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    return lightmap;
}

static void layout_listen(const lmb_scene *scene, float texels_per_m, int32_t size, listener *heard)
{
    memset(heard, 0, sizeof *heard);
    lmb_lightmap_destroy(layout_make(scene, texels_per_m, size, 1, heard));
}

static lmb_scene *scene_load(const char *path, lmb_result written, lmb_error *error)
{
    lmb_scene *scene = NULL;
    CHECK(written == LMB_OK && lmb_gltf_load(path, NULL, &scene, error) == LMB_OK, "%s", error->message);
    return scene;
}

/* Tiles in a row, each a mesh of its own, named tile0, tile1, ... */
static lmb_result write_row(const char *path, int count, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.5f);
    for (int i = 0; i < count; ++i) {
        char name[16];
        snprintf(name, sizeof name, "tile%d", i);
        const int tile = lmb_level_builder_add_mesh(builder, name);
        lmb_level_builder_add_quad(builder, tile, material, (lmb_vec3){-1, 0, 1}, (lmb_vec3){2, 0, 0},
                                   (lmb_vec3){0, 0, -2});
        lmb_level_builder_place(builder, name, tile, (lmb_vec3){3.0f * (float)i, 0, 0});
    }
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void unused_uvs_are_named(void)
{
    static const struct {
        lmb_uv_fault fault;
        const char *says;
    } CASES[] = {
        {LMB_UV_OUT_OF_RANGE, "outside"}, {LMB_UV_DEGENERATE, "without area"}, {LMB_UV_OVERLAPPING, "overlapping"}};
    static listener heard;
    lmb_error error = {""};
    const char *path = OUTPUT("layout_faults.glb");
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; ++i) {
        lmb_scene *scene = scene_load(path, write_row(path, 3, &error), &error);
        if (!scene) {
            return;
        }
        layout_listen(scene, 4.0f, 1024, &heard);
        CHECK(heard.count == 0, "%d lines about good UVs", heard.count);
        uv_break(&scene->meshes[1], CASES[i].fault);
        layout_listen(scene, 4.0f, 1024, &heard);
        CHECK(heard.count == 1 && lines_with(&heard, "'tile1'", CASES[i].says) == 1, "%s: %d lines", CASES[i].says,
              heard.count);
        lines_print(heard.count == 1 ? &(listener){.count = 0} : &heard);
        lmb_scene_destroy(scene);
    }
}

/* Levels without TEXCOORD_1 are the rule: nothing is said of all, one line of some; of many faults five, and how many
 * more there are. */
static void warnings_do_not_flood(void)
{
    static listener heard;
    lmb_error error = {""};
    const char *path = OUTPUT("layout_many.glb");
    lmb_scene *scene = scene_load(path, write_row(path, 9, &error), &error);
    if (!scene) {
        return;
    }
    uv_break(&scene->meshes[2], LMB_UV_MISSING);
    uv_break(&scene->meshes[3], LMB_UV_MISSING);
    layout_listen(scene, 4.0f, 1024, &heard);
    CHECK(heard.count == 1 && lines_with(&heard, "2 of 9", "'tile2'") == 1, "%d lines", heard.count);
    for (uint32_t m = 0; m < 9; ++m) {
        uv_break(&scene->meshes[m], LMB_UV_MISSING);
    }
    layout_listen(scene, 4.0f, 1024, &heard);
    CHECK(heard.count == 0, "%d lines", heard.count);
    lmb_scene_destroy(scene);

    scene = scene_load(path, write_row(path, 9, &error), &error);
    for (uint32_t m = 0; scene && m < 9; ++m) {
        uv_break(&scene->meshes[m], LMB_UV_OVERLAPPING);
    }
    if (scene) {
        layout_listen(scene, 4.0f, 1024, &heard);
        CHECK(heard.count == 6 && lines_with(&heard, "overlapping", "mesh") == 5 &&
                  lines_with(&heard, "4 more", "") == 1,
              "%d lines", heard.count);
        lmb_scene_destroy(scene);
    }
}

static void densities_that_do_not_fit_are_named(void)
{
    static listener heard;
    static const lmb_uv_fault UVS[] = {LMB_UV_GOOD, LMB_UV_MISSING};
    lmb_error error = {""};
    const char *path = OUTPUT("layout_dense.glb");
    for (size_t i = 0; i < sizeof UVS / sizeof UVS[0]; ++i) {
        lmb_scene *scene = scene_load(path, write_tiles(path, 1.0f, &error), &error);
        if (!scene) {
            return;
        }
        for (uint32_t m = 0; m < scene->mesh_count; ++m) {
            uv_break(&scene->meshes[m], UVS[i]);
        }
        layout_listen(scene, 20.0f, 256, &heard); /* the largest has 8 m: 160 texels */
        CHECK(heard.count == 0, "%d lines", heard.count);
        lines_print(&heard);
        layout_listen(scene, 64.0f, 256, &heard); /* 8 m and 6 m do not fit; tiles of 2 m do */
        CHECK(lines_with(&heard, "'roof'", "64") == 1 && lines_with(&heard, "'large'", "64") == 1 &&
                  lines_with(&heard, "'covered'", "") == 0,
              "%d lines", heard.count);
        /* What it says is what the layout has. */
        lmb_lightmap *lightmap = layout_make(scene, 64.0f, 256, 1, NULL);
        for (uint32_t k = 0; lightmap && k < scene->instance_count; ++k) {
            if (strcmp(scene->instances[k].name, "roof") == 0) {
                char used[32];
                snprintf(used, sizeof used, "gets %.2g", 1.0 / (double)lightmap->region[k].texel_size);
                CHECK(lines_with(&heard, "'roof'", used) == 1, "%s", used);
            }
        }
        lines_print(lines_with(&heard, "'roof'", "64") == 1 ? &(listener){.count = 0} : &heard);
        lmb_lightmap_destroy(lightmap);
        lmb_scene_destroy(scene);
    }
}

/* Gives each triangle of a mesh an island of its own in a grid over the unit square. */
static void uv_shatter(lmb_mesh *mesh)
{
    uint32_t side = 1;
    while (side * side < mesh->triangle_count) {
        ++side;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const float cell = 1.0f / (float)side;
        const lmb_vec2 at = {(float)(t % side) * cell, (float)(t / side) * cell};
        static const float CORNER[3][2] = {{0.05f, 0.05f}, {0.95f, 0.05f}, {0.05f, 0.95f}};
        for (int k = 0; k < 3; ++k) {
            mesh->uv[1][mesh->triangle[t][k]] = (lmb_vec2){at.x + CORNER[k][0] * cell, at.y + CORNER[k][1] * cell};
        }
    }
}

/* Two hundred triangles apart from each other: the builder gives each vertices of its own. */
static lmb_result write_shards(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.5f);
    const int shards = lmb_level_builder_add_mesh(builder, "shards");
    for (int i = 0; i < 200; ++i) {
        const float x = (float)(i % 20), z = (float)(i / 20);
        lmb_level_builder_add_triangle(builder, shards, material, (lmb_vec3){x, 0, z}, (lmb_vec3){x, 0, z + 0.9f},
                                       (lmb_vec3){x + 0.9f, 0, z});
    }
    lmb_level_builder_place(builder, "broken glass", shards, (lmb_vec3){0, 0, 0});
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-1, -1, 11}, (lmb_vec3){22, 0, 0},
                               (lmb_vec3){0, 0, -12});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

static void small_islands_are_named(void)
{
    static const struct {
        bool charts;
        float texels_per_m; /* a shard has 0.4 square metres */
        bool said;
    } CASES[] = {{false, 3.0f, true}, {false, 20.0f, false}, {true, 3.0f, true}, {true, 20.0f, false}};
    static listener heard;
    lmb_error error = {""};
    const char *path = OUTPUT("layout_islands.glb");
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; ++i) {
        lmb_scene *scene = scene_load(path, write_shards(path, &error), &error);
        if (!scene) {
            return;
        }
        if (CASES[i].charts) {
            uv_break(&scene->meshes[0], LMB_UV_MISSING);
            uv_break(&scene->meshes[1], LMB_UV_MISSING);
        } else {
            uv_shatter(&scene->meshes[0]);
        }
        layout_listen(scene, CASES[i].texels_per_m, 2048, &heard);
        CHECK(heard.count == CASES[i].said, "case %zu: %d lines", i, heard.count);
        CHECK(!CASES[i].said || (lines_with(&heard, "'broken glass'", "200 of 200") == 1 &&
                                 lines_with(&heard, "--texels-per-m", "TEXCOORD_1") == !CASES[i].charts),
              "case %zu", i);
        lines_print(heard.count == CASES[i].said ? &(listener){.count = 0} : &heard);
        lmb_scene_destroy(scene);
    }
}

/* Which chart each gathered texel of an image is of: 1 + instance * 256 + the way its triangles face along an axis. */
static void charts_mark(const lmb_lightmap *lightmap, uint32_t instance, int32_t *chart)
{
    const lmb_lightmap_region *region = &lightmap->region[instance];
    const lmb_lightmap_image *image = &lightmap->image[region->image];
    const uint32_t mesh_index = lightmap->scene->instances[instance].mesh;
    const lmb_mesh *mesh = &lightmap->scene->meshes[mesh_index];
    uint64_t state = 3;
    for (uint32_t k = 0; k < 60000; ++k) {
        const uint32_t t = k % mesh->triangle_count;
        float u = (float)variate_next(&state), v = (float)variate_next(&state);
        if (u + v > 1.0f) {
            u = 1.0f - u;
            v = 1.0f - v;
        }
        const float weight[3] = {1.0f - u - v, u, v};
        lmb_vec2 at = {0.0f, 0.0f};
        for (int c = 0; c < 3; ++c) {
            const lmb_vec2 corner = lightmap->corner_uv[mesh_index][3 * t + (uint32_t)c];
            at.x += weight[c] * (corner.x * region->scale.x + region->offset.x) * (float)image->width;
            at.y += weight[c] * (corner.y * region->scale.y + region->offset.y) * (float)image->height;
        }
        const float fx = at.x - floorf(at.x), fy = at.y - floorf(at.y);
        if (fx < 2e-3f || fx > 0.998f || fy < 2e-3f || fy > 0.998f) {
            continue; /* so near to the border the texel may be the neighbour's */
        }
        const lmb_vec3 n = mesh->normal[mesh->triangle[t][0]];
        const int32_t way = (int32_t)lroundf(n.x + 3.0f * n.y + 9.0f * n.z) + 20;
        chart[(size_t)at.y * (size_t)image->width + (size_t)at.x] = 1 + (int32_t)instance * 256 + way;
    }
}

/* Texels of different charts, or of a chart and the image's border, and texels near a chart that hold no light. */
static void padding_check(const lmb_lightmap *lightmap, int32_t padding)
{
    const lmb_lightmap_image *image = &lightmap->image[0];
    int32_t *chart = calloc((size_t)image->width * (size_t)image->height, sizeof *chart);
    for (uint32_t i = 0; chart && i < lightmap->scene->instance_count; ++i) {
        charts_mark(lightmap, i, chart);
    }
    uint64_t near = 0, empty = 0, border = 0;
    for (int32_t at = 0; chart && at < image->width * image->height; ++at) {
        const int32_t x = at % image->width, y = at / image->width;
        for (int32_t dy = -2 * padding; chart[at] != 0 && dy <= 2 * padding; ++dy) {
            for (int32_t dx = -2 * padding; dx <= 2 * padding; ++dx) {
                const bool within = dx >= -padding && dx <= padding && dy >= -padding && dy <= padding;
                const bool inside = x + dx >= 0 && y + dy >= 0 && x + dx < image->width && y + dy < image->height;
                const int32_t other = inside ? (y + dy) * image->width + x + dx : at;
                border += within && !inside;
                near += chart[other] != 0 && chart[other] != chart[at];
                empty += within && image->state[other] == LMB_TEXEL_EMPTY;
            }
        }
    }
    CHECK(near == 0 && empty == 0 && border == 0, "padding %d: %llu too near, %llu empty, %llu at the border",
          (int)padding, (unsigned long long)near, (unsigned long long)empty, (unsigned long long)border);
    free(chart);
}

static void padding_is_as_wide_as_asked(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("layout_padding.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    for (uint32_t m = 0; m < bake.level.scene->mesh_count; ++m) {
        uv_break(&bake.level.scene->meshes[m], LMB_UV_MISSING);
    }
    uint64_t texels_before = 0;
    for (int32_t padding = 1; padding <= 8; padding *= 2) {
        bake.lightmap = layout_make(bake.level.scene, 8.0f, 1024, padding, NULL);
        if (bake.lightmap && lightmap_bake(&bake, 4)) {
            padding_check(bake.lightmap, padding);
            const lmb_lightmap_image *image = &bake.lightmap->image[0];
            const uint64_t texels = (uint64_t)image->width * (uint64_t)image->height;
            CHECK(texels > texels_before, "padding %d: %d x %d", (int)padding, (int)image->width, (int)image->height);
            texels_before = texels;
        }
        lmb_lightmap_destroy(bake.lightmap);
    }
    bake.lightmap = NULL;
    baked_close(&bake);
}

/* 0 is 1, so that settings which do not know of padding make what they always made; and files keep it. */
static void padding_is_kept(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("layout_kept.glb");
    baked bake;
    if (!level_fixture_open(&bake.level, path, lmb_level_cornell(path, &error), &error, 2)) {
        return;
    }
    lmb_lightmap *one = layout_make(bake.level.scene, 8.0f, 1024, 1, NULL);
    lmb_lightmap *none = layout_make(bake.level.scene, 8.0f, 1024, 0, NULL);
    CHECK(one && none && none->settings.padding == 1 &&
              memcmp(one->region, none->region, bake.level.scene->instance_count * sizeof *one->region) == 0,
          "0 is not 1");
    lmb_lightmap_destroy(one);
    lmb_lightmap_destroy(none);
    bake.lightmap = layout_make(bake.level.scene, 8.0f, 1024, 4, NULL);
    lmb_lightmap *again = layout_make(bake.level.scene, 8.0f, 1024, 4, NULL);
    lmb_lightmap *other = layout_make(bake.level.scene, 8.0f, 1024, 1, NULL);
    uint64_t bytes = 0;
    if (bake.lightmap && again && other && lightmap_bake(&bake, 4)) {
        CHECK(lmb_lightmap_write(bake.lightmap, LMB_TEST_OUTPUT_DIR, NULL, &bytes, &error) == LMB_OK &&
                  lmb_lightmap_read(again, LMB_TEST_OUTPUT_DIR, &error) == LMB_OK,
              "%s", error.message);
        CHECK(lmb_lightmap_read(other, LMB_TEST_OUTPUT_DIR, &error) == LMB_ERROR_FORMAT, "another padding was read");
        const size_t texels = (size_t)again->image[0].width * (size_t)again->image[0].height;
        CHECK(memcmp(again->image[0].state, bake.lightmap->image[0].state, texels) == 0, "states");
    }
    lmb_lightmap_destroy(again);
    lmb_lightmap_destroy(other);
    static const int32_t BAD[] = {-1, 65, 16}; /* the last for images of 64 */
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; ++i) {
        const lmb_lightmap_settings settings = {.texels_per_m = 1.0f, .max_image_size = 64, .padding = BAD[i]};
        lmb_lightmap *refused = NULL;
        CHECK(lmb_lightmap_create(bake.level.scene, &settings, &refused, &error) == LMB_ERROR_ARGUMENT && !refused,
              "padding %d", (int)BAD[i]);
    }
    baked_close(&bake);
}

/* Boxes of many sizes in a room, each a mesh of its own; some stand several times. */
static lmb_result write_boxes(const char *path, int count, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.5f);
    uint64_t state = 17;
    for (int i = 0; i < count; ++i) {
        char name[16];
        snprintf(name, sizeof name, "box%d", i);
        const int mesh = lmb_level_builder_add_mesh(builder, name);
        const float x = 0.5f + 2.0f * (float)variate_next(&state), y = 0.5f + 2.0f * (float)variate_next(&state);
        const lmb_level_box box = lmb_level_box_of(
            (lmb_vec3){0, 0, 0}, (lmb_vec3){x, y, 0.5f + 2.0f * (float)variate_next(&state)}, material);
        lmb_level_builder_add_box(builder, mesh, &box);
        for (int k = 0; k <= i % 3; ++k) {
            lmb_level_builder_place(builder, name, mesh, (lmb_vec3){4.0f * (float)i, 0, 4.0f * (float)k});
        }
    }
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* Texels that are used, of the images; and those are no larger than they need to be. */
static void images_are_used(void)
{
    static const struct {
        float texels_per_m, least;
        int32_t size, padding;
    } CASES[] = {{8.0f, 0.6f, 2048, 1}, {16.0f, 0.7f, 2048, 1}, {16.0f, 0.6f, 512, 2}, {32.0f, 0.75f, 1024, 1}};
    lmb_error error = {""};
    const char *path = OUTPUT("layout_boxes.glb");
    lmb_scene *scene = scene_load(path, write_boxes(path, 30, &error), &error);
    for (uint32_t m = 0; scene && m < scene->mesh_count; ++m) {
        uv_break(&scene->meshes[m], LMB_UV_MISSING);
    }
    for (size_t i = 0; scene && i < sizeof CASES / sizeof CASES[0]; ++i) {
        lmb_lightmap *lightmap = layout_make(scene, CASES[i].texels_per_m, CASES[i].size, CASES[i].padding, NULL);
        const double used = lightmap ? lmb_lightmap_texels_used(lightmap) : 0.0;
        CHECK(used >= (double)CASES[i].least && used <= 1.0, "case %zu: %g of the images", i, used);
        CHECK(!lightmap || lightmap->chart_count == 6 * 30, "case %zu: %llu charts", i,
              (unsigned long long)lightmap->chart_count);
        for (int32_t k = 0; lightmap && k < lightmap->image_count; ++k) {
            const lmb_lightmap_image *image = &lightmap->image[k];
            CHECK(image->width % 4 == 0 && image->height % 4 == 0 && image->width <= CASES[i].size &&
                      image->height <= CASES[i].size,
                  "case %zu: image of %d x %d", i, (int)image->width, (int)image->height);
        }
        lmb_lightmap *again = layout_make(scene, CASES[i].texels_per_m, CASES[i].size, CASES[i].padding, NULL);
        CHECK(lightmap && again &&
                  memcmp(lightmap->region, again->region, scene->instance_count * sizeof *again->region) == 0,
              "case %zu: not the same twice", i);
        lmb_lightmap_destroy(again);
        lmb_lightmap_destroy(lightmap);
    }
    lmb_scene_destroy(scene);
}

/* A tile for each wish, each of a mesh of its own, and two of one mesh. */
static lmb_result write_wishes(const char *path, lmb_error *error)
{
    static const struct {
        const char *name;
        bool off;
        float texels_per_m, texel_scale;
    } TILES[] = {{"plain", false, 0, 0},
                 {"own", false, 16, 0},
                 {"twice", false, 0, 2},
                 {"both", false, 16, 0.5f},
                 {"dark", true, 0, 0}};
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.5f);
    for (size_t i = 0; i < sizeof TILES / sizeof TILES[0]; ++i) {
        lmb_level_node node = lmb_level_node_default(TILES[i].name);
        node.mesh = lmb_level_builder_add_mesh(builder, TILES[i].name);
        lmb_level_builder_add_quad(builder, node.mesh, material, (lmb_vec3){-2, 0, 2}, (lmb_vec3){4, 0, 0},
                                   (lmb_vec3){0, 0, -4});
        node.translation = (lmb_vec3){6.0f * (float)i, 0, 0};
        node.no_lightmap = TILES[i].off;
        node.texels_per_m = TILES[i].texels_per_m;
        node.texel_scale = TILES[i].texel_scale;
        lmb_level_builder_add_node(builder, &node);
        if (i == 0) {
            node.name = "sharing";
            node.texels_per_m = 8;
            node.translation = (lmb_vec3){0, 0, 6};
            lmb_level_builder_add_node(builder, &node);
        }
    }
    add_sun(builder, 1.0f);
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* At 4 texels a metre, with the mesh's own UVs and with charts, of which nodes with one mesh share the densest. */
static void nodes_have_their_density(void)
{
    static const struct {
        const char *name;
        double own, charts; /* texels a metre; 0: no lightmap */
    } EXPECTED[] = {{"plain", 4, 8}, {"sharing", 8, 8}, {"own", 16, 16},
                    {"twice", 8, 8}, {"both", 8, 8},    {"dark", 0, 0}};
    enum { COUNT = sizeof EXPECTED / sizeof EXPECTED[0] };
    lmb_error error = {""};
    const char *path = OUTPUT("layout_wishes.glb");
    lmb_scene *scene = scene_load(path, write_wishes(path, &error), &error);
    for (int charts = 0; scene && charts < 2; ++charts) {
        for (uint32_t m = 0; charts && m < scene->mesh_count; ++m) {
            uv_break(&scene->meshes[m], LMB_UV_MISSING);
        }
        lmb_lightmap *lightmap = layout_make(scene, 4.0f, 1024, 1, NULL);
        CHECK(scene->instance_count == COUNT, "%u nodes", scene->instance_count);
        for (uint32_t i = 0; lightmap && i < scene->instance_count && i < COUNT; ++i) {
            const double wanted = charts ? EXPECTED[i].charts : EXPECTED[i].own;
            const lmb_lightmap_region *region = &lightmap->region[i];
            CHECK(strcmp(scene->instances[i].name, EXPECTED[i].name) == 0, "%s", scene->instances[i].name);
            CHECK((region->image >= 0) == (wanted > 0.0), "%s: image %d", EXPECTED[i].name, (int)region->image);
            if (wanted > 0.0) {
                CHECK_NEAR((double)region->texel_size * wanted, 1.0, 0.1, "%s, charts %d", EXPECTED[i].name, charts);
            }
        }
        lmb_lightmap_destroy(lightmap);
    }
    lmb_scene_destroy(scene);
}

/* A node without a lightmap is in no file of it, and is a surface like others. */
static void nodes_without_lightmap_cast_shadows(void)
{
    lmb_error error = {""};
    const char *path = OUTPUT("layout_none.glb");
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const int material = plain_material(builder, 0.0f);
    const int floor = lmb_level_builder_add_mesh(builder, "floor");
    lmb_level_builder_add_quad(builder, floor, material, (lmb_vec3){-2, 0, 2}, (lmb_vec3){4, 0, 0},
                               (lmb_vec3){0, 0, -4});
    lmb_level_builder_place(builder, "floor", floor, (lmb_vec3){0, 0, 0});
    lmb_level_node roof = lmb_level_node_default("roof");
    roof.mesh = floor;
    roof.translation = (lmb_vec3){0, 1, 0};
    roof.no_lightmap = true;
    lmb_level_builder_add_node(builder, &roof);
    add_sun(builder, 3.0f);
    const lmb_result written = lmb_level_builder_write(builder, path, &error);
    lmb_level_builder_destroy(builder);
    baked bake;
    if (!baked_open(&bake, path, written, &error, (baked_settings){4.0f, 8, 2})) {
        return;
    }
    CHECK(bake.lightmap->region[0].image == 0 && bake.lightmap->region[1].image == -1, "regions");
    CHECK_NEAR(sample_irradz(bake.lightmap, 0, 0, 0.3f, 0.3f).irradiance_z.c[0], 0.0, 0.0, "under the roof");
    uint64_t bytes = 0;
    unsigned char *text = NULL;
    size_t size = 0;
    CHECK(lmb_lightmap_write(bake.lightmap, LMB_TEST_OUTPUT_DIR, NULL, &bytes, &error) == LMB_OK &&
              lmb_lightmap_read(bake.lightmap, LMB_TEST_OUTPUT_DIR, &error) == LMB_OK &&
              lmb_file_read(LMB_TEST_OUTPUT_DIR "/lightmap.json", &text, &size, &error) == LMB_OK,
          "%s", error.message);
    CHECK(text && strstr((const char *)text, "\"floor\"") && !strstr((const char *)text, "\"roof\""), "%s",
          text ? (const char *)text : "");
    free(text);
    baked_close(&bake);
}

static const test_case CASES[] = {
    {"unused UVs are named", unused_uvs_are_named},
    {"warnings do not flood", warnings_do_not_flood},
    {"densities that do not fit are named", densities_that_do_not_fit_are_named},
    {"small islands are named", small_islands_are_named},
    {"padding is as wide as asked", padding_is_as_wide_as_asked},
    {"padding is kept", padding_is_kept},
    {"images are used", images_are_used},
    {"nodes have their density", nodes_have_their_density},
    {"nodes without a lightmap cast shadows", nodes_without_lightmap_cast_shadows},
};

TEST_MAIN(CASES)
