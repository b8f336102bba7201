#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cjson/cJSON.h>

#include <lambent/baked.h>
#include <lambent/exr.h>
#include <lambent/file.h>

#include "command.h"
#include "environment_maps.h"
#include "lamps_seen.h"
#include "query.h"

static const char usage[] =
    "usage: lambent cube LEVEL DIR -o FOLDER [options]\n"
    "\n"
    "Traces environment maps of LEVEL, with the settings of the bake in DIR: at every node whose extras say\n"
    "{\"lambent\": {\"cube_map\": true}}. Each is an EXR of cubes whose levels are blurred for rising roughness, "
    "divided\n"
    "by the area specular of the probes there; cube_map.json lists them, each with a box for what is around it. Key\n"
    "lights and lamps are not in them.\n"
    "\n"
    "  -o FOLDER             where to write; made if it is not there\n"
    "  --at X,Y,Z            a map here too (repeatable, up to 64)\n"
    "  --samples N           rays a texel (default 16)\n"
    "  --threads N           default: all processors\n"
    "  --quiet               no progress and no notes\n";

enum { MOST_PLACES = 64 };

typedef struct cube_options {
    lmb_shared_arguments shared; /* LEVEL, DIR, and the folder that is written */
    lmb_vec3d at[MOST_PLACES];
    int at_count;
    uint32_t samples;
} cube_options;

static bool options_read(lmb_arguments *arguments, cube_options *options)
{
    for (const char *next; (next = arguments_next(arguments));) {
        if (strcmp(next, "--at") == 0 && options->at_count < MOST_PLACES) {
            options->at[options->at_count++] = arguments_position(arguments, next);
        } else if (strcmp(next, "--at") == 0) {
            arguments_error(arguments, "too many", next);
        } else if (strcmp(next, "--samples") == 0) {
            options->samples = (uint32_t)arguments_integer(arguments, next, 1, 1000000);
        } else {
            arguments_shared(arguments, next, &options->shared);
        }
    }
    return arguments_complete(arguments, &options->shared);
}

static void planes_fill(const cube_map *map, float *plane[3])
{
    for (int level = 0; level < CUBE_LEVELS; ++level) {
        const int side = cube_side(level);
        for (int i = 0; i < CUBE_FACES * side * side * 3; ++i) {
            plane[i % 3][cube_picture_pixel(level, i)] = map->rgb[level][i];
        }
    }
}

static lmb_result picture_write(const char *path, const cube_map *map, lmb_error *error)
{
    const size_t pixels = (size_t)CUBE_PICTURE_WIDTH * (size_t)cube_picture_height();
    float *const values = calloc(3 * pixels, sizeof *values);
    if (!values) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    float *plane[3] = {values, values + pixels, values + 2 * pixels};
    planes_fill(map, plane);
    const lmb_exr_channel channels[3] = {{"R", plane[0]}, {"G", plane[1]}, {"B", plane[2]}};
    const lmb_exr_picture picture = {CUBE_PICTURE_WIDTH, cube_picture_height(), channels, 3, NULL, 0};
    const lmb_result result = lmb_exr_write(path, &picture, NULL, error);
    free(values);
    return result;
}

/* What all places share. */
typedef struct cube_run {
    const cube_options *options;
    const lmb_baked *baked;
    const lmb_progress *progress;
    cJSON *maps; /* the list, so far */
} cube_run;

/* Traces one map and writes it. */
static lmb_result place_make(const cube_run *run, int index, const char *name, lmb_vec3d position, lmb_error *error)
{
    const cube_options *options = run->options;
    const lmb_level *level = &run->baked->level;
    char image[32], path[4096];
    cube_map map;
    cube_place place = {.position = lmb_scene_from_world(level->scene, position)};
    snprintf(image, sizeof image, "cube_map_%d.exr", index);
    snprintf(path, sizeof path, "%s/%s", options->shared.output, image);
    if (!lmb_volume_sample_at(run->baked->volume, position, &place.radiance)) {
        char line[LMB_ERROR_MESSAGE_SIZE];
        snprintf(line, sizeof line, "%s is outside of the baked volume: divided by the nearest probes", name);
        console_warning(line, options->shared.quiet);
    }
    lamps_seen lamps;
    lamps_take(level->transport.emitters, place.position, NULL, &place.radiance, &lamps);
    lmb_result result = cube_map_make(&level->transport, &place, options->samples, level->pool, run->progress, &map);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "cube: %s", lmb_result_text(result));
    }
    result = picture_write(path, &map, error);
    cube_map_free(&map);
    const float *const side = map.side;
    const lmb_vec3d at = position;
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddStringToObject(entry, "name", name);
    cJSON_AddItemToObject(entry, "position", json_position(position));
    cJSON_AddStringToObject(entry, "image", image);
    cJSON *const box = cJSON_AddObjectToObject(entry, "box");
    cJSON_AddItemToObject(
        box, "low", json_position((lmb_vec3d){at.x - (double)side[1], at.y - (double)side[3], at.z - (double)side[5]}));
    cJSON_AddItemToObject(
        box, "high",
        json_position((lmb_vec3d){at.x + (double)side[0], at.y + (double)side[2], at.z + (double)side[4]}));
    cJSON_AddItemToArray(run->maps, entry);
    return result;
}

static lmb_result list_write(const char *folder, cJSON *maps, lmb_error *error)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/cube_map.json", folder);
    cJSON *json = cJSON_CreateObject();
    cJSON *levels = cJSON_AddArrayToObject(json, "levels");
    int top = 0;
    for (int level = 0; level < CUBE_LEVELS; ++level) {
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddNumberToObject(entry, "side", cube_side(level));
        cJSON_AddNumberToObject(entry, "y", top);
        cJSON_AddNumberToObject(entry, "roughness", 0.05 * (1 << level));
        cJSON_AddItemToArray(levels, entry);
        top += cube_side(level);
    }
    cJSON_AddItemToObject(json, "maps", maps);
    char *const text = cJSON_Print(json);
    const lmb_result result = text ? lmb_file_write(path, text, strlen(text), error)
                                   : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    cJSON_free(text);
    cJSON_Delete(json);
    return result;
}

static lmb_result maps_make(const cube_options *options, lmb_baked *baked, lmb_error *error)
{
    const lmb_scene *scene = baked->level.scene;
    const int marked = (int)scene->cube_point_count, count = marked + options->at_count;
    if (count == 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no node is marked \"cube_map\", and there is no --at",
                             scene->path);
    }
    lmb_console console;
    const lmb_progress progress = console_progress(&console, options->shared.quiet, false);
    const cube_run run = {options, baked, &progress, cJSON_CreateArray()};
    lmb_result result = lmb_level_solve(&baked->level, baked->settings.estimator, &progress, error);
    for (int i = 0; i < count && result == LMB_OK; ++i) {
        const lmb_vec3d position =
            i < marked ? lmb_scene_to_world(scene, scene->cube_points[i]) : options->at[i - marked];
        result = place_make(&run, i, i < marked ? scene->cube_names[i] : "--at", position, error);
    }
    console_finish(&console);
    if (result != LMB_OK) {
        cJSON_Delete(run.maps);
        return result;
    }
    return list_write(options->shared.output, run.maps, error);
}

int command_cube(int count, char **values)
{
    cube_options options = {.samples = 16,
                            .shared = {.path_name = {"LEVEL", "DIR"},
                                       .output_name = "FOLDER",
                                       .takes = ARGUMENTS_THREADS | ARGUMENTS_QUIET}};
    lmb_arguments arguments = arguments_begin(count, values, "cube", usage);
    if (!options_read(&arguments, &options)) {
        return arguments_status(&arguments);
    }
    lmb_error error = {""};
    lmb_baked baked;
    lmb_result result = LMB_OK;
    if (mkdir(options.shared.output, 0777) != 0 && errno != EEXIST) {
        result = lmb_error_set(&error, LMB_ERROR_WRITE, "%s: %s", options.shared.output, strerror(errno));
    }
    if (result == LMB_OK) {
        result = lmb_baked_open(options.shared.path[0], options.shared.path[1], options.shared.threads, NULL, &baked,
                                &error);
    }
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    result = lmb_baked_need_probes(&baked, options.shared.path[1], &error);
    if (result == LMB_OK) {
        result = maps_make(&options, &baked, &error);
    }
    lmb_baked_close(&baked);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
