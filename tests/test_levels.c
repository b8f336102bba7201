/* The built levels, read back through the glTF loader: what is in them, lightmap layouts without overlap, equal bytes
 * from equal calls, and rooms that are closed. The rays here are brute force, apart from the baker's. */
#include "demo_level.h"
#include "harness.h"
#include "level_blocks.h"
#include "levels.h"
#include "variates.h"

#include <lambent/gltf.h>

#include <stdint.h>
#include <stdlib.h>

typedef lmb_result (*level_writer)(const char *path, lmb_error *error);

static lmb_result write_furnace(const char *path, lmb_error *error)
{
    return lmb_level_furnace(path, 3, 0.5f, (lmb_rgb){{0.25f, 2, 4}}, true, error);
}

static lmb_result write_ground(const char *path, lmb_error *error)
{
    return lmb_level_open_ground(path, 50, 0.4f, error);
}

static lmb_result write_sealed(const char *path, lmb_error *error)
{
    const lmb_two_rooms rooms = lmb_two_rooms_default();
    return lmb_level_two_rooms(path, &rooms, error);
}

static lmb_result write_ajar(const char *path, lmb_error *error)
{
    lmb_two_rooms rooms = lmb_two_rooms_default();
    rooms.wall_m = 0.001f;
    rooms.door_m = 0.3f;
    return lmb_level_two_rooms(path, &rooms, error);
}

static lmb_result write_sphere(const char *path, lmb_error *error)
{
    return lmb_level_sphere_room(path, 2, 6, 0.6f, 100, error);
}

static lmb_result write_quad_light(const char *path, lmb_error *error)
{
    return lmb_level_quad_light(path, 2, 7, error);
}

static lmb_result write_sun_plane(const char *path, lmb_error *error)
{
    return lmb_level_sun_plane(path, 0.5f, (lmb_vec3){1, -2, 2}, 50, error);
}

static const struct {
    const char *name;
    level_writer write;
    uint32_t triangles; /* over all instances */
    uint32_t meshes, instances, lights;
    uint32_t materials; /* of the file; the loader may add its default */
} levels[] = {
    {"furnace", write_furnace, 12, 1, 1, 0, 1},
    {"ground", write_ground, 2, 1, 1, 0, 1},
    {"cornell", lmb_level_cornell, 36, 4, 4, 0, 4},
    {"sealed", write_sealed, 60, 3, 3, 0, 3},
    {"ajar", write_ajar, 84, 3, 3, 0, 3},
    {"sphere", write_sphere, 432, 1, 1, 1, 1},
    {"quad_light", write_quad_light, 4, 2, 2, 0, 2},
    {"sun_plane", write_sun_plane, 2, 1, 1, 1, 1},
    {"demo", lmb_demo_level_write, 802, 7, 8, 1, 10},
    {"object", lmb_demo_object_write, 3388, 2, 2, 0, 1},
};
static const size_t level_count = sizeof levels / sizeof levels[0];

static void path_of(const char *name, const char *kind, char path[512])
{
    snprintf(path, 512, "%s/level_%s%s.glb", LMB_TEST_OUTPUT_DIR, name, kind);
}

static lmb_scene *load(const char *name, level_writer write)
{
    char path[512];
    lmb_scene *scene = NULL;
    lmb_error error = {0};
    path_of(name, "", path);
    lmb_result result = write(path, &error);
    CHECK(result == LMB_OK, "%s: %s", name, error.message);
    result = lmb_gltf_load(path, NULL, &scene, &error);
    CHECK(result == LMB_OK, "%s: %s", name, error.message);
    return result == LMB_OK ? scene : NULL;
}

static void levels_reload(void)
{
    for (size_t i = 0; i < level_count; ++i) {
        lmb_scene *scene = load(levels[i].name, levels[i].write);
        if (!scene) {
            continue;
        }
        uint32_t triangles = 0;
        for (uint32_t k = 0; k < scene->instance_count; ++k) {
            triangles += scene->meshes[scene->instances[k].mesh].triangle_count;
        }
        lmb_error error = {0};
        CHECK(lmb_scene_validate(scene, &error) == LMB_OK, "%s: %s", levels[i].name, error.message);
        CHECK(triangles == levels[i].triangles, "%s: %u", levels[i].name, triangles);
        CHECK(scene->dropped_triangle_count == 0, "%s: %u", levels[i].name, scene->dropped_triangle_count);
        CHECK(scene->mesh_count == levels[i].meshes, "%s: %u", levels[i].name, scene->mesh_count);
        CHECK(scene->instance_count == levels[i].instances, "%s: %u", levels[i].name, scene->instance_count);
        CHECK(scene->light_count == levels[i].lights, "%s: %u", levels[i].name, scene->light_count);
        CHECK(scene->material_count >= levels[i].materials && scene->material_count <= levels[i].materials + 1,
              "%s: %u", levels[i].name, scene->material_count);
        lmb_scene_destroy(scene);
    }
}

static void values_reload(void)
{
    lmb_scene *furnace = load("furnace", write_furnace);
    if (furnace) {
        const lmb_material *material = &furnace->materials[furnace->meshes[0].material[0]];
        const float emission[3] = {0.25f, 2, 4};
        for (int c = 0; c < 3; ++c) {
            CHECK_NEAR(material->emissive.c[c], emission[c], 1e-6, "channel %d", c);
            CHECK_NEAR(material->base_color[c], 0.5, 1e-7, "channel %d", c);
        }
        CHECK(material->double_sided, "furnace");
        lmb_scene_destroy(furnace);
    }
    lmb_scene *sun = load("sun_plane", write_sun_plane);
    if (sun) {
        CHECK(sun->lights[0].type == LMB_LIGHT_DIRECTIONAL, "type %d", (int)sun->lights[0].type);
        CHECK_NEAR(sun->lights[0].direction.x, 1.0 / 3, 1e-6, "sun");
        CHECK_NEAR(sun->lights[0].direction.y, -2.0 / 3, 1e-6, "sun");
        CHECK_NEAR(sun->lights[0].direction.z, 2.0 / 3, 1e-6, "sun");
        CHECK_NEAR(sun->lights[0].intensity.c[1], 50, 1e-5, "sun");
        lmb_scene_destroy(sun);
    }
    lmb_scene *demo = load("demo", lmb_demo_level_write);
    if (demo) {
        const lmb_mesh *building = &demo->meshes[0];
        CHECK(building->tangent != NULL, "the brick wall is normal-mapped");
        CHECK(demo->seed_point_count == 2, "%u", demo->seed_point_count);
        CHECK(demo->path_point_count == 8, "%u", demo->path_point_count);
        CHECK_NEAR(demo->path_points[7].x, 8.5, 1e-6, "last path point");
        int masked = 0;
        for (uint32_t i = 0; i < demo->material_count; ++i) {
            masked +=
                demo->materials[i].alpha_mode == LMB_ALPHA_MASK && demo->materials[i].base_color_texture.image >= 0;
        }
        CHECK(masked == 1, "%d", masked);
        lmb_scene_destroy(demo);
    }
}

/* --- lightmap layout --------------------------------------------------------------------------------------------- */

static double cross2(lmb_vec2 a, lmb_vec2 b, double x, double y)
{
    return ((double)b.x - (double)a.x) * (y - (double)a.y) - ((double)b.y - (double)a.y) * (x - (double)a.x);
}

static bool covers(const lmb_vec2 corner[3], double x, double y)
{
    const double turn[3] = {cross2(corner[0], corner[1], x, y), cross2(corner[1], corner[2], x, y),
                            cross2(corner[2], corner[0], x, y)};
    return (turn[0] > 0 && turn[1] > 0 && turn[2] > 0) || (turn[0] < 0 && turn[1] < 0 && turn[2] < 0);
}

/* Marks the texel centres strictly inside each triangle. @return how many were covered twice */
static int count_overlap(const lmb_mesh *mesh, int resolution, uint8_t *covered)
{
    int twice = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        lmb_vec2 corner[3];
        double low[2] = {1, 1};
        double high[2] = {0, 0};
        for (int i = 0; i < 3; ++i) {
            corner[i] = mesh->uv[1][mesh->triangle[t][i]];
            low[0] = fmin(low[0], (double)corner[i].x);
            low[1] = fmin(low[1], (double)corner[i].y);
            high[0] = fmax(high[0], (double)corner[i].x);
            high[1] = fmax(high[1], (double)corner[i].y);
        }
        for (int y = (int)(low[1] * resolution); y < resolution && y <= (int)(high[1] * resolution); ++y) {
            for (int x = (int)(low[0] * resolution); x < resolution && x <= (int)(high[0] * resolution); ++x) {
                if (covers(corner, (x + 0.5) / resolution, (y + 0.5) / resolution)) {
                    twice += covered[y * resolution + x];
                    covered[y * resolution + x] = 1;
                }
            }
        }
    }
    return twice;
}

static double area3(const lmb_mesh *mesh, uint32_t triangle)
{
    const lmb_vec3 a = mesh->position[mesh->triangle[triangle][0]];
    const lmb_vec3 b = mesh->position[mesh->triangle[triangle][1]];
    const lmb_vec3 c = mesh->position[mesh->triangle[triangle][2]];
    const double u[3] = {(double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z};
    const double v[3] = {(double)c.x - (double)a.x, (double)c.y - (double)a.y, (double)c.z - (double)a.z};
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
}

static void check_layout(const char *level, const lmb_mesh *mesh)
{
    const int resolution = 1024;
    uint8_t *covered = calloc((size_t)resolution * (size_t)resolution, 1);
    CHECK(mesh->uv[1] != NULL, "%s/%s", level, mesh->name);
    if (!covered || !mesh->uv[1]) {
        free(covered);
        return;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        const lmb_vec2 uv = mesh->uv[1][v];
        CHECK(uv.x > 0 && uv.x < 1 && uv.y > 0 && uv.y < 1, "%s/%s: vertex %u at %g %g", level, mesh->name, v,
              (double)uv.x, (double)uv.y);
    }
    const int twice = count_overlap(mesh, resolution, covered);
    CHECK(twice == 0, "%s/%s: %d texels covered twice", level, mesh->name, twice);
    /* Proportional to the world: flat triangles all have the same texel density, curved ones nearly. */
    double least = INFINITY;
    double most = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const lmb_vec2 a = mesh->uv[1][mesh->triangle[t][0]];
        const lmb_vec2 b = mesh->uv[1][mesh->triangle[t][1]];
        const lmb_vec2 c = mesh->uv[1][mesh->triangle[t][2]];
        const double density = fabs(cross2(a, b, (double)c.x, (double)c.y)) / 2 / area3(mesh, t);
        least = fmin(least, density);
        most = fmax(most, density);
    }
    CHECK(least > 0 && most < 2.2 * least, "%s/%s: density from %g to %g", level, mesh->name, least, most);
    free(covered);
}

static void lightmap_layouts_do_not_overlap(void)
{
    for (size_t i = 0; i < level_count; ++i) {
        lmb_scene *scene = load(levels[i].name, levels[i].write);
        for (uint32_t m = 0; scene && m < scene->mesh_count; ++m) {
            check_layout(levels[i].name, &scene->meshes[m]);
        }
        lmb_scene_destroy(scene);
    }
}

/* --- bytes ------------------------------------------------------------------------------------------------------- */

static uint8_t *read_all(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    *size = 0;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        *size = (size_t)ftell(file);
        rewind(file);
        bytes = malloc(*size + 1);
        *size = bytes ? fread(bytes, 1, *size, file) : 0;
    }
    if (file) {
        fclose(file);
    }
    return bytes;
}

static void equal_calls_give_equal_bytes(void)
{
    for (size_t i = 0; i < level_count; ++i) {
        char paths[2][512];
        uint8_t *bytes[2];
        size_t size[2];
        for (int k = 0; k < 2; ++k) {
            path_of(levels[i].name, k == 0 ? "_first" : "_second", paths[k]);
            CHECK(levels[i].write(paths[k], NULL) == LMB_OK, "%s", paths[k]);
            bytes[k] = read_all(paths[k], &size[k]);
        }
        CHECK(bytes[0] && bytes[1] && size[0] > 100 && size[0] == size[1] && memcmp(bytes[0], bytes[1], size[0]) == 0,
              "%s: %zu and %zu bytes", levels[i].name, size[0], size[1]);
        free(bytes[0]);
        free(bytes[1]);
        remove(paths[0]);
        remove(paths[1]);
    }
}

static void unwritable_path_is_an_error(void)
{
    lmb_error error = {0};
    CHECK(lmb_level_cornell("/nonexistent/folder/cornell.glb", &error) == LMB_ERROR_WRITE, "%s", error.message);
    CHECK(strstr(error.message, "/nonexistent/folder/cornell.glb") != NULL, "%s", error.message);
}

/* --- closed rooms ------------------------------------------------------------------------------------------------ */

typedef struct ray {
    double origin[3], direction[3];
} ray;

static void to_world(const lmb_affine *m, lmb_vec3 p, double out[3])
{
    for (int r = 0; r < 3; ++r) {
        out[r] = m->m[r][0] * (double)p.x + m->m[r][1] * (double)p.y + m->m[r][2] * (double)p.z + m->m[r][3];
    }
}

static double triple(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Distance to a triangle by signed volumes, edges included; INFINITY when missed. */
static double hit_distance(const ray *r, double corner[3][3])
{
    double to[3][3];
    double volume[3];
    for (int i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            to[i][axis] = corner[i][axis] - r->origin[axis];
        }
    }
    for (int i = 0; i < 3; ++i) {
        volume[i] = triple(r->direction, to[(i + 1) % 3], to[(i + 2) % 3]);
    }
    const bool front = volume[0] >= 0 && volume[1] >= 0 && volume[2] >= 0;
    const bool back = volume[0] <= 0 && volume[1] <= 0 && volume[2] <= 0;
    const double sum = volume[0] + volume[1] + volume[2];
    if ((!front && !back) || sum == 0) {
        return INFINITY;
    }
    const double distance = triple(to[0], to[1], to[2]) / sum;
    return distance > 0 ? distance : (double)INFINITY;
}

static double nearest_hit(const lmb_scene *scene, const ray *r)
{
    double nearest = INFINITY;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_mesh *mesh = &scene->meshes[scene->instances[i].mesh];
        for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
            double corner[3][3];
            if (scene->materials[mesh->material[t]].alpha_mode != LMB_ALPHA_OPAQUE) {
                continue;
            }
            for (int k = 0; k < 3; ++k) {
                to_world(&scene->instances[i].to_world, mesh->position[mesh->triangle[t][k]], corner[k]);
            }
            nearest = fmin(nearest, hit_distance(r, corner));
        }
    }
    return nearest;
}

/* Sends rays from within a box; counts those whose first hit lies outside it. */
static int count_escapes(const lmb_scene *scene, lmb_vec3 min, lmb_vec3 max, int rays)
{
    const double low[3] = {(double)min.x, (double)min.y, (double)min.z};
    const double high[3] = {(double)max.x, (double)max.y, (double)max.z};
    uint64_t state = 1;
    int escapes = 0;
    for (int i = 0; i < rays; ++i) {
        ray r;
        for (int axis = 0; axis < 3; ++axis) {
            r.origin[axis] = low[axis] + (high[axis] - low[axis]) * (0.01 + 0.98 * variate_next(&state));
            r.direction[axis] = 2 * variate_next(&state) - 1;
        }
        const double distance = nearest_hit(scene, &r);
        bool outside = !isfinite(distance);
        for (int axis = 0; axis < 3 && !outside; ++axis) {
            const double at = r.origin[axis] + distance * r.direction[axis];
            outside = at < low[axis] - 1e-5 || at > high[axis] + 1e-5;
        }
        escapes += outside;
    }
    return escapes;
}

static void sealed_rooms_let_no_ray_out(void)
{
    lmb_scene *demo = load("demo", lmb_demo_level_write);
    if (demo) {
        const int escapes = count_escapes(demo, lmb_demo_dark_room_min, lmb_demo_dark_room_max, 20000);
        CHECK(escapes == 0, "%d rays left the dark room", escapes);
        /* The test can fail: the sunny room has a window and a door. */
        const int sunny = count_escapes(demo, (lmb_vec3){4.5f, 0, 3.05f}, (lmb_vec3){10, 2.8f, 8}, 2000);
        CHECK(sunny > 20, "only %d rays left the sunny room", sunny);
        lmb_scene_destroy(demo);
    }
    lmb_scene *sealed = load("sealed", write_sealed);
    if (sealed) {
        CHECK(count_escapes(sealed, (lmb_vec3){-4.05f, 0, -2}, (lmb_vec3){-0.05f, 3, 2}, 20000) == 0, "red room");
        CHECK(count_escapes(sealed, (lmb_vec3){0.05f, 0, -2}, (lmb_vec3){4.05f, 3, 2}, 20000) == 0, "green room");
        lmb_scene_destroy(sealed);
    }
    lmb_scene *ajar = load("ajar", write_ajar);
    if (ajar) {
        const int through = count_escapes(ajar, (lmb_vec3){-4, 0, -2}, (lmb_vec3){-0.0005f, 3, 2}, 5000);
        CHECK(through > 10, "only %d rays passed the door", through);
        CHECK(count_escapes(ajar, (lmb_vec3){-4.0005f, 0, -2}, (lmb_vec3){4.0005f, 3, 2}, 5000) == 0, "both rooms");
        lmb_scene_destroy(ajar);
    }
}

/* From the sunny side no light leaves the house but through the windows. */
static void only_windows_open_the_house(void)
{
    lmb_scene *demo = load("demo", lmb_demo_level_write);
    uint64_t state = 7;
    int lost = 0;
    int through_windows = 0;
    for (int i = 0; demo && i < 20000; ++i) {
        ray r;
        const double low[3] = {4.6, 0.1, 3.2};
        const double size[3] = {5.3, 2.6, 4.7};
        for (int axis = 0; axis < 3; ++axis) {
            r.origin[axis] = low[axis] + size[axis] * variate_next(&state);
            r.direction[axis] = 2 * variate_next(&state) - 1;
        }
        if (isfinite(nearest_hit(demo, &r))) {
            continue;
        }
        const double to_window = (8.3 - r.origin[2]) / r.direction[2];
        const double x = r.origin[0] + to_window * r.direction[0];
        const double y = r.origin[1] + to_window * r.direction[1];
        const bool window = to_window > 0 && x > 7 && x < 9.5 && y > 0.9 && y < 2.4;
        through_windows += window;
        lost += !window;
    }
    CHECK(lost == 0, "%d rays left through walls", lost);
    CHECK(!demo || through_windows > 100, "%d rays left through the window", through_windows);
    lmb_scene_destroy(demo);
}

/* --- blocks ------------------------------------------------------------------------------------------------------ */

static lmb_result write_blocks(const char *path, lmb_error *error)
{
    lmb_level_builder *builder = lmb_level_builder_create(0.1f);
    const lmb_level_material grey = lmb_level_material_default();
    const int material = lmb_level_builder_add_material(builder, &grey);
    const lmb_level_block blocks[] = {
        lmb_level_block_of(true, (lmb_vec3){0, 0, 0}, (lmb_vec3){4, 4, 4}, material),
        lmb_level_block_of(false, (lmb_vec3){1, 1, 1}, (lmb_vec3){3, 3, 3}, material),
        lmb_level_block_of(true, (lmb_vec3){2, 2, 2}, (lmb_vec3){3, 3, 3}, material),
    };
    const int mesh = lmb_level_builder_add_mesh(builder, "blocks");
    lmb_level_builder_add_blocks(builder, mesh, blocks, sizeof blocks / sizeof blocks[0]);
    lmb_level_builder_place(builder, "blocks", mesh, (lmb_vec3){0, 0, 0});
    const lmb_result result = lmb_level_builder_write(builder, path, error);
    lmb_level_builder_destroy(builder);
    return result;
}

/* A hollow cube with a smaller cube in its corner: area 96 + 24, volume of the solid 64 - 8 + 1, by divergence. */
static void blocks_keep_only_the_surface(void)
{
    lmb_scene *scene = load("blocks", write_blocks);
    double area = 0;
    double volume = 0;
    for (uint32_t t = 0; scene && t < scene->meshes[0].triangle_count; ++t) {
        const lmb_mesh *mesh = &scene->meshes[0];
        double corner[3][3];
        for (int k = 0; k < 3; ++k) {
            to_world(&scene->instances[0].to_world, mesh->position[mesh->triangle[t][k]], corner[k]);
        }
        area += area3(mesh, t);
        volume += triple(corner[0], corner[1], corner[2]) / 6;
    }
    CHECK_NEAR(area, 120, 1e-4, "blocks");
    CHECK_NEAR(volume, 57, 1e-4, "blocks");
    lmb_scene_destroy(scene);
}

static const test_case cases[] = {
    {"levels reload", levels_reload},
    {"values reload", values_reload},
    {"lightmap layouts do not overlap", lightmap_layouts_do_not_overlap},
    {"equal calls give equal bytes", equal_calls_give_equal_bytes},
    {"an unwritable path is an error", unwritable_path_is_an_error},
    {"sealed rooms let no ray out", sealed_rooms_let_no_ray_out},
    {"only windows open the house", only_windows_open_the_house},
    {"blocks keep only the surface", blocks_keep_only_the_surface},
};

TEST_MAIN(cases)
