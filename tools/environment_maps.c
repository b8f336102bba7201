#include "environment_maps.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <cjson/cJSON.h>

#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/vector.h>

int cube_picture_height(void)
{
    int height = 0;
    for (int level = 0; level < CUBE_LEVELS; ++level) {
        height += cube_side(level);
    }
    return height;
}

size_t cube_picture_pixel(int level, int index)
{
    const int side = cube_side(level);
    const int x = index / 3 % side, row = index / 3 / side % side, face = index / 3 / side / side;
    int top = 0;
    for (int above = 0; above < level; ++above) {
        top += cube_side(above);
    }
    return (size_t)(top + row) * (size_t)CUBE_PICTURE_WIDTH + (size_t)(face * side + x);
}

static lmb_result map_read(const char *path, cube_map *map, lmb_error *error)
{
    static const char *const names[3] = {"R", "G", "B"};
    float *plane[3] = {NULL, NULL, NULL};
    lmb_exr_header header;
    lmb_result result = lmb_exr_read_channels(path, names, 3, plane, &header, error);
    if (result != LMB_OK) {
        return result;
    }
    if (header.width != CUBE_PICTURE_WIDTH || header.height != cube_picture_height()) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not the size of an environment map", path);
    } else if (!cube_map_allocate(map)) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    for (int level = 0; level < CUBE_LEVELS && result == LMB_OK; ++level) {
        const int side = cube_side(level);
        for (int i = 0; i < CUBE_FACES * side * side * 3; ++i) {
            map->rgb[level][i] = lmb_light_clamped(plane[i % 3][cube_picture_pixel(level, i)]);
        }
    }
    for (int c = 0; c < 3; ++c) {
        free(plane[c]);
    }
    return result;
}

/* Whether it is a list of maps with the levels that are known here. */
static bool json_is_of_maps(const cJSON *json)
{
    const cJSON *levels = cJSON_GetObjectItemCaseSensitive(json, "levels");
    bool good = cJSON_GetArraySize(levels) == CUBE_LEVELS;
    for (int level = 0; good && level < CUBE_LEVELS; ++level) {
        const cJSON *entry = cJSON_GetArrayItem(levels, level);
        const cJSON *side = cJSON_GetObjectItemCaseSensitive(entry, "side");
        const cJSON *roughness = cJSON_GetObjectItemCaseSensitive(entry, "roughness");
        good = cJSON_IsNumber(side) && side->valuedouble == cube_side(level) && cJSON_IsNumber(roughness) &&
               fabs(roughness->valuedouble - (double)cube_roughness(level)) < 1e-6;
    }
    return good && cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(json, "maps")) > 0;
}

static bool json_position(const cJSON *entry, const char *key, lmb_vec3d *position)
{
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(entry, key);
    double at[3];
    for (int i = 0; i < 3; ++i) {
        const cJSON *const number = cJSON_GetArrayItem(list, i);
        if (!cJSON_IsNumber(number)) {
            return false;
        }
        at[i] = number->valuedouble;
    }
    *position = (lmb_vec3d){at[0], at[1], at[2]};
    return true;
}

static lmb_result entry_read(const cJSON *entry, const char *folder, environment_map *map, lmb_error *error)
{
    const char *const image = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(entry, "image"));
    const double far = (double)FLT_MAX;
    map->low = (lmb_vec3d){-far, -far, -far};
    map->high = (lmb_vec3d){far, far, far};
    const cJSON *const box = cJSON_GetObjectItemCaseSensitive(entry, "box");
    const bool has_box = json_position(box, "low", &map->low) && json_position(box, "high", &map->high);
    if (!image || !json_position(entry, "position", &map->position) || (box && !has_box)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "%s/cube_map.json: a map without image or position, or a broken box", folder);
    }
    char *const path = lmb_file_in(folder, image);
    const lmb_result result =
        path ? map_read(path, &map->map, error) : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    free(path);
    return result;
}

static lmb_result json_read(const char *folder, cJSON **json, lmb_error *error)
{
    char *const path = lmb_file_in(folder, "cube_map.json");
    unsigned char *text = NULL;
    size_t size = 0;
    lmb_result result =
        path ? lmb_file_read(path, &text, &size, error) : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    *json = result == LMB_OK ? cJSON_ParseWithLength((const char *)text, size) : NULL;
    if (result == LMB_OK && !json_is_of_maps(*json)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a list of environment maps", path);
    }
    free(text);
    free(path);
    return result;
}

lmb_result environment_maps_read(const char *folder, environment_maps *read, lmb_error *error)
{
    cJSON *json;
    *read = (environment_maps){NULL, 0};
    lmb_result result = json_read(folder, &json, error);
    const cJSON *const maps = cJSON_GetObjectItemCaseSensitive(json, "maps");
    if (result == LMB_OK) {
        read->map = calloc((size_t)cJSON_GetArraySize(maps), sizeof *read->map);
        result = read->map ? LMB_OK : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    for (const cJSON *entry = result == LMB_OK ? maps->child : NULL; entry && result == LMB_OK; entry = entry->next) {
        result = entry_read(entry, folder, &read->map[read->count++], error);
    }
    cJSON_Delete(json);
    if (result != LMB_OK) {
        environment_maps_free(read);
    }
    return result;
}

void environment_maps_free(environment_maps *freed)
{
    for (int i = 0; i < freed->count; ++i) {
        cube_map_free(&freed->map[i].map);
    }
    free(freed->map);
    *freed = (environment_maps){NULL, 0};
}

map_here environment_maps_find(const environment_maps *maps, const lmb_tracer *tracer, lmb_vec3 position)
{
    int nearest = 0, seen = -1;
    float least = FLT_MAX, least_seen = FLT_MAX;
    for (int i = 0; i < maps->count; ++i) {
        const lmb_vec3 at = lmb_scene_from_world(lmb_tracer_scene(tracer), maps->map[i].position);
        const lmb_vec3 way = lmb_vec3_sub(at, position);
        const float squared = lmb_vec3_dot(way, way);
        uint64_t rays = 0;
        if (squared < least) {
            nearest = i;
            least = squared;
        }
        if (squared < least_seen && lmb_rgb_max(lmb_trace_transmittance(tracer, position, at, &rays)) > 0.0f) {
            seen = i;
            least_seen = squared;
        }
    }
    const lmb_scene *const scene = lmb_tracer_scene(tracer);
    const environment_map *const found = &maps->map[seen >= 0 ? seen : nearest];
    return (map_here){&found->map,
                      {lmb_scene_from_world(scene, found->position), lmb_scene_from_world(scene, found->low),
                       lmb_scene_from_world(scene, found->high)}};
}
