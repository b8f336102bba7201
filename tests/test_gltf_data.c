/* Real and deliberately broken glTF files: loading always returns, what it returns is sound, and known levels are what
 * they are known to be. With --list: one line a file instead, "path: loaded, ..." or "path: message". */
#define _POSIX_C_SOURCE 200809L

#include "harness.h"

#include <dirent.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <lambent/file.h>
#include <lambent/gltf.h>

typedef struct file_list {
    char **paths;
    size_t count;
} file_list;

static int compare_paths(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool has_ending(const char *path, const char *ending)
{
    const size_t length = strlen(path), end = strlen(ending);
    return length >= end && strcmp(path + length - end, ending) == 0;
}

static void add_path(file_list *list, const char *path)
{
    char **const larger = realloc(list->paths, (list->count + 1) * sizeof *larger);
    char *const copy = malloc(strlen(path) + 1);
    if (!larger || !copy) {
        abort();
    }
    list->paths = larger;
    list->paths[list->count++] = strcpy(copy, path);
}

/* All .gltf and .glb files below a folder, and every file of the fuzzers' corpus. */
static void find_levels(const char *folder, file_list *list)
{
    DIR *const directory = opendir(folder);
    const struct dirent *entry;
    while (directory && (entry = readdir(directory))) {
        char path[2048];
        struct stat status;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] == '.' || stat(path, &status) != 0) {
            continue;
        }
        if (S_ISDIR(status.st_mode)) {
            find_levels(path, list);
        } else if (has_ending(path, ".gltf") || has_ending(path, ".glb") || strstr(path, "fuzz/data/")) {
            add_path(list, path);
        }
    }
    if (directory) {
        closedir(directory);
    }
}

static file_list find_all_levels(const char *const *groups, size_t count)
{
    file_list list = {NULL, 0};
    for (size_t i = 0; i < count; ++i) {
        char folder[1024];
        snprintf(folder, sizeof folder, "%s/%s", LMB_DATA_DIR, groups[i]);
        find_levels(folder, &list);
    }
    if (list.count > 1) {
        qsort(list.paths, list.count, sizeof *list.paths, compare_paths);
    }
    return list;
}

static void free_list(file_list *list)
{
    for (size_t i = 0; i < list->count; ++i) {
        free(list->paths[i]);
    }
    free(list->paths);
}

static unsigned long placed_triangles(const lmb_scene *scene)
{
    unsigned long count = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        count += scene->meshes[scene->instances[i].mesh].triangle_count;
    }
    return count;
}

/* What the Khronos validator says about a file, from the report beside it. */
static bool validator_finds_no_error(const char *path, bool *known)
{
    char report[2048];
    unsigned char *bytes = NULL;
    size_t size = 0;
    snprintf(report, sizeof report, "%s.report.json", path);
    *known = lmb_file_read(report, &bytes, &size, NULL) == LMB_OK;
    const bool clean = *known && strstr((const char *)bytes, "\"numErrors\": 0") != NULL;
    free(bytes);
    return clean;
}

/* Files that the validator accepts and Lambent does not, and why. */
static const struct {
    const char *path, *reason;
} refused[] = {
    {"accessor/unknown_type.gltf", "is unknown"},
    {"asset/min_version_valid.gltf", "glTF 2.1, not 2.0"},
    {"buffer/non_relative_uri.gltf", "is not a file's name"},
    {"material/valid.gltf", "TEXCOORD_4"},
    {"root/named_objects.gltf", "neither a uri nor a binary chunk"},
    {"root/unused_objects.gltf", "neither a uri nor a binary chunk"},
};

static bool refusal_is_known(const char *path, const char *message)
{
    for (size_t i = 0; i < sizeof refused / sizeof *refused; ++i) {
        if (has_ending(path, refused[i].path) && strstr(message, refused[i].reason)) {
            return true;
        }
    }
    return false;
}

static void test_every_file(void)
{
    static const char *const groups[] = {"scenes", "features", "malformed"};
    file_list list = find_all_levels(groups, 3);
    if (list.count == 0) {
        test_skip("no test data");
    }
    for (size_t i = 0; i < list.count; ++i) {
        const char *const path = list.paths[i];
        const bool malformed = strstr(path, "/malformed/") != NULL;
        lmb_scene *scene = NULL;
        lmb_error error = {""};
        const lmb_result result = lmb_gltf_load(path, NULL, &scene, &error);
        CHECK((result == LMB_OK) == (scene != NULL), "%s", path);
        if (result != LMB_OK) {
            CHECK(result == LMB_ERROR_FORMAT || result == LMB_ERROR_IO || result == LMB_ERROR_UNSUPPORTED, "%s: %d",
                  path, result);
            CHECK(strncmp(error.message, path, strlen(path)) == 0 && strlen(error.message) > strlen(path) + 4, "%s: %s",
                  path, error.message);
            bool known;
            const bool clean = validator_finds_no_error(path, &known);
            CHECK(!clean || refusal_is_known(path, error.message), "the validator accepts it: %s", error.message);
            CHECK(malformed || strstr(path, "Compatibility_04") || strstr(path, "Compatibility_05"), "%s",
                  error.message);
        } else {
            CHECK(lmb_scene_validate(scene, &error) == LMB_OK, "%s", error.message);
        }
        lmb_scene_destroy(scene);
    }
    free_list(&list);
}

typedef struct fact {
    const char *path;
    unsigned long triangles; /* placed, with those that are dropped */
    unsigned long dropped;   /* placed; counted by a program that shares no code with this one */
    uint32_t images;         /* that a material of ours uses */
    uint32_t lights;
    bool lightmap_uvs;
    float low[3], high[3];
    bool rotated; /* the known bounds are those of turned boxes: ours lie inside */
} fact;

static const fact facts[] = {
    {"collisions_cge/level.gltf", 558, 8, 0, 1, false, {-9, -0.1f, -9}, {9, 4, 9}, false},
    {"collisions_cge/level_non_uniform_scale_test.gltf", 558, 8, 0, 1, false, {-9, -0.3f, -9}, {9, 4, 9}, false},
    {"cornell_babylon/cornellBox.glb", 4006, 0, 0, 0, true, {-2, -0.5f, -2.2f}, {2, 3, 2}, true},
    {"cornell_bevy/CornellBox.glb", 36, 0, 0, 0, true, {-556, 0, -559.2f}, {0, 548.8f, 0}, false},
    {"fps_level_cge/example_level.gltf", 2908, 0, 6, 6, false, {-22.5f, -22, -108}, {22.5f, 38.1f, 25.5f}, false},
    {"house_playcanvas/house.glb", 10497, 0, 1, 0, true, {-0.3f, 0, -0.3f}, {0.3f, 0.2f, 0.3f}, false},
    {"irradiance_volume_bevy/IrradianceVolumeExample.glb",
     32,
     0,
     0,
     0,
     false,
     {-20.2f, -0.9f, -20.2f},
     {20.4f, 0, 20.5f},
     false},
    {"kaykit_dungeon/kaykit_dungeon.gltf", 65720, 132, 1, 8, false, {-20.8f, -0.3f, -8.8f}, {24.8f, 5.1f, 8.8f}, true},
    {"living_room_godot/living_room.glb", 5088, 3537, 0, 0, false, {-5, -1.5f, -2.5f}, {5, 4, 12}, false},
    {"map_dutility/dutility.glb", 8115, 12, 0, 0, false, {-10.8f, 0, -24.8f}, {10.8f, 6.3f, 24.8f}, false},
    {"map_turbine/turbine.glb", 3064, 3, 0, 0, false, {-10.4f, 0, -11.6f}, {10.4f, 16, 11.6f}, false},
    {"mixed_lighting_bevy/MixedLightingExample.gltf",
     40898,
     0,
     0,
     1,
     true,
     {-1.6f, 0, -1.6f},
     {1.6f, 0.7f, 1.6f},
     true},
    {"room_r3l/tile-game-room6.glb", 88, 0, 1, 0, true, {-2.2f, -7.5f, -0.5f}, {2, 7.5f, 7.5f}, false},
    {"zdm2_godot/zdm2.glb", 58772, 1134, 0, 0, false, {-33.9f, -12, -29.3f}, {43.3f, 24, 30.3f}, false},
};

static void check_bounds(const lmb_scene *scene, const fact *f)
{
    const float low[3] = {scene->bounds_min.x, scene->bounds_min.y, scene->bounds_min.z};
    const float high[3] = {scene->bounds_max.x, scene->bounds_max.y, scene->bounds_max.z};
    for (int axis = 0; axis < 3; ++axis) {
        const double rounding = 0.0501 + 1e-6 * (double)(f->high[axis] - f->low[axis]);
        if (f->rotated) {
            CHECK((double)low[axis] >= (double)f->low[axis] - rounding &&
                      (double)high[axis] <= (double)f->high[axis] + rounding,
                  "%s: axis %d: %g .. %g", f->path, axis, (double)low[axis], (double)high[axis]);
        } else {
            CHECK_NEAR(low[axis], f->low[axis], rounding, "%s: axis %d", f->path, axis);
            CHECK_NEAR(high[axis], f->high[axis], rounding, "%s: axis %d", f->path, axis);
        }
    }
}

static void test_scene_facts(void)
{
    size_t found = 0;
    for (size_t i = 0; i < sizeof facts / sizeof *facts; ++i) {
        const fact *const f = &facts[i];
        char path[1024];
        struct stat status;
        lmb_scene *scene = NULL;
        lmb_error error = {""};
        snprintf(path, sizeof path, "%s/scenes/%s", LMB_DATA_DIR, f->path);
        if (stat(path, &status) != 0) {
            continue;
        }
        ++found;
        CHECK(lmb_gltf_load(path, NULL, &scene, &error) == LMB_OK, "%s", error.message);
        if (!scene) {
            continue;
        }
        bool uvs = false;
        for (uint32_t m = 0; m < scene->mesh_count; ++m) {
            uvs |= scene->meshes[m].uv[1] != NULL;
        }
        CHECK(placed_triangles(scene) == f->triangles - f->dropped, "%s: %lu", f->path, placed_triangles(scene));
        CHECK(scene->light_count == f->lights, "%s: %u lights", f->path, scene->light_count);
        CHECK(f->images == 0 || scene->image_count == f->images, "%s: %u images", f->path, scene->image_count);
        CHECK(uvs == f->lightmap_uvs, "%s: TEXCOORD_1", f->path);
        CHECK(lmb_scene_has_light(scene) == (f->lights > 0 || strstr(f->path, "cornell_bevy")), "%s: light", f->path);
        check_bounds(scene, f);
        lmb_scene_destroy(scene);
    }
    if (found == 0) {
        test_skip("no test data");
    }
}

static lmb_scene *load_feature(const char *name)
{
    char path[1024];
    struct stat status;
    lmb_scene *scene = NULL;
    lmb_error error = {""};
    snprintf(path, sizeof path, "%s/features/%s", LMB_DATA_DIR, name);
    if (stat(path, &status) != 0) {
        test_skip("no test data");
        return NULL;
    }
    CHECK(lmb_gltf_load(path, NULL, &scene, &error) == LMB_OK, "%s", error.message);
    return scene;
}

/* The same box in three containers. */
static void test_containers(void)
{
    static const char *const names[] = {"Box/glTF/Box.gltf", "Box/glTF-Binary/Box.glb", "Box/glTF-Embedded/Box.gltf"};
    lmb_scene *const first = load_feature(names[0]);
    for (size_t i = 1; i < 3 && first; ++i) {
        lmb_scene *const other = load_feature(names[i]);
        if (other) {
            const lmb_mesh *const a = &first->meshes[0], *const b = &other->meshes[0];
            CHECK(a->vertex_count == b->vertex_count && a->triangle_count == 12 && b->triangle_count == 12, "%s",
                  names[i]);
            CHECK(memcmp(a->position, b->position, a->vertex_count * sizeof *a->position) == 0, "%s", names[i]);
            CHECK(memcmp(a->triangle, b->triangle, 12 * sizeof *a->triangle) == 0, "%s", names[i]);
        }
        lmb_scene_destroy(other);
    }
    lmb_scene_destroy(first);
}

/* Every level rewritten with UVs is the same level with those UVs. */
static void test_rewriting(void)
{
    static const char *const groups[] = {"scenes", "features"};
    file_list list = find_all_levels(groups, 2);
    if (list.count == 0) {
        test_skip("no test data");
    }
    static const char target[] = LMB_TEST_OUTPUT_DIR "/rewritten_data.glb";
    for (size_t i = 0; i < list.count; ++i) {
        lmb_scene *before = NULL, *after = NULL;
        lmb_error error = {""};
        /* Many asset_generator files differ only in a material. */
        if ((strstr(list.paths[i], "asset_generator") && i % 8 != 0) ||
            lmb_gltf_load(list.paths[i], NULL, &before, &error) != LMB_OK) {
            continue;
        }
        lmb_gltf_uv *const uvs = calloc(before->mesh_count + 1u, sizeof *uvs);
        for (uint32_t m = 0; uvs && m < before->mesh_count; ++m) {
            lmb_vec2 *const corners = calloc((size_t)before->meshes[m].triangle_count * 3 + 1, sizeof *corners);
            for (uint32_t c = 0; corners && c < 3 * before->meshes[m].triangle_count; ++c) {
                corners[c] = (lmb_vec2){(float)(c % 5) * 0.25f, (float)(c % 3) * 0.5f};
            }
            uvs[m] = (lmb_gltf_uv){&before->meshes[m], corners};
        }
        CHECK(lmb_gltf_write_with_uvs(list.paths[i], NULL, uvs, before->mesh_count, target, &error) == LMB_OK, "%s",
              error.message);
        CHECK(lmb_gltf_load(target, NULL, &after, &error) == LMB_OK, "%s: %s", list.paths[i], error.message);
        unsigned differences = after ? before->mesh_count != after->mesh_count : 1;
        for (uint32_t m = 0; m < before->mesh_count && differences == 0; ++m) {
            const lmb_mesh *const a = &before->meshes[m], *const b = &after->meshes[m];
            differences += a->triangle_count != b->triangle_count;
            for (uint32_t c = 0; c < 3 * a->triangle_count && differences == 0; ++c) {
                const uint32_t v = a->triangle[c / 3][c % 3], w = b->triangle[c / 3][c % 3];
                differences += memcmp(&a->position[v], &b->position[w], sizeof(lmb_vec3)) != 0;
                differences += b->uv[1][w].x != uvs[m].corner_uv[c].x || b->uv[1][w].y != uvs[m].corner_uv[c].y;
            }
        }
        CHECK(differences == 0, "%s", list.paths[i]);
        for (uint32_t m = 0; uvs && m < before->mesh_count; ++m) {
            free((void *)uvs[m].corner_uv);
        }
        free(uvs);
        lmb_scene_destroy(before);
        lmb_scene_destroy(after);
    }
    remove(target);
    free_list(&list);
}

static int list_files(void)
{
    static const char *const groups[] = {"scenes", "features", "malformed"};
    file_list list = find_all_levels(groups, 3);
    for (size_t i = 0; i < list.count; ++i) {
        lmb_scene *s = NULL;
        lmb_error error = {""};
        const char *const shown = list.paths[i] + strlen(LMB_DATA_DIR) + 1;
        if (lmb_gltf_load(list.paths[i], NULL, &s, &error) == LMB_OK) {
            printf("%s: loaded, %lu triangles placed, %u dropped, %u instances, %u meshes, %u materials, %u images, "
                   "%u lights\n",
                   shown, placed_triangles(s), s->dropped_triangle_count, s->instance_count, s->mesh_count,
                   s->material_count, s->image_count, s->light_count);
            lmb_scene_destroy(s);
        } else {
            printf("%s: refused%s\n", shown, error.message + strlen(list.paths[i]));
        }
    }
    free_list(&list);
    return 0;
}

static const test_case cases[] = {
    {"every file", test_every_file},
    {"scene facts", test_scene_facts},
    {"containers", test_containers},
    {"rewriting", test_rewriting},
};

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--list") == 0) {
        return list_files();
    }
    return test_main(cases, sizeof cases / sizeof *cases);
}
