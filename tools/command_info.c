#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/block_texture.h>
#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/model.h>
#include <lambent/lightmap.h>
#include <lambent/local_set.h>
#include <lambent/probe_local.h>
#include <lambent/tiles.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include "command.h"
#include "query.h"
#include "slices.h"

static const char usage[] =
    "usage: lambent info FILE [--json]\n"
    "       lambent info FILE.vdb --slices DIR [--axis x|y|z] [--at M]\n"
    "\n"
    "Says what is in a probes.vdb, a probes.lmb, an index of tiles .lmt, a lightmap .exr of ours, or a KTX2 or DDS of "
    "BC4,\n"
    "BC5, BC6H or ASTC.\n"
    "\n"
    "  --json                one JSON object\n"
    "  --slices DIR          pictures of a plane through the probes too: levels.png, regions.png,\n"
    "                        validity.png and irradiance.png\n"
    "  --axis x|y|z          what the plane is at right angles to (default y)\n"
    "  --at M                where on that axis, metres (default: half way)\n";

typedef struct info_options {
    lmb_shared_arguments shared; /* of one path */
    bool json;
    const char *slices;
    lmb_slice slice;
} info_options;

static void json_add_range(cJSON *json, const char *key, const int32_t value[3])
{
    cJSON_AddItemToObject(json, key, cJSON_CreateIntArray((const int[3]){value[0], value[1], value[2]}, 3));
}

static void json_add_key_lights(cJSON *json, const lmb_key_light *light, uint32_t count)
{
    cJSON *list = cJSON_AddArrayToObject(json, "key_lights");
    for (uint32_t i = 0; i < count; ++i) {
        cJSON_AddItemToArray(list, json_key_light(&light[i]));
    }
}

static cJSON *local_describe(const char *name, int32_t node, int32_t place, const lmb_local_frame *frame)
{
    const int32_t size[3] = {(int32_t)frame->size[0], (int32_t)frame->size[1], (int32_t)frame->size[2]};
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "name", name);
    cJSON_AddNumberToObject(json, "node", node);
    cJSON_AddNumberToObject(json, "place", place);
    json_add_range(json, "size", size);
    cJSON_AddItemToObject(json, "origin", json_position(frame->origin));
    cJSON *steps = cJSON_AddArrayToObject(json, "steps");
    for (int axis = 0; axis < 3; ++axis) {
        cJSON_AddItemToArray(steps, json_vector(frame->step[axis]));
    }
    return json;
}

static cJSON *lmb_describe(const lmb_volume *volume)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "kind", "lambent run-time volume");
    cJSON_AddNumberToObject(json, "version", info.version);
    cJSON_AddNumberToObject(json, "probes", (double)info.probe_count);
    const double spacing = (double)info.spacing;
    const double low[3] = {info.bounds_min.x, info.bounds_min.y, info.bounds_min.z};
    const double high[3] = {info.bounds_max.x, info.bounds_max.y, info.bounds_max.z};
    int32_t first[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = (int32_t)lround(low[axis] / spacing);
        size[axis] = (int32_t)(lround(high[axis] / spacing) - first[axis] + 1);
    }
    cJSON_AddNumberToObject(json, "spacing", spacing);
    json_add_range(json, "lattice_min", first);
    json_add_range(json, "lattice_size", size);
    cJSON_AddItemToObject(json, "bounds_min", json_position(info.bounds_min));
    cJSON_AddItemToObject(json, "bounds_max", json_position(info.bounds_max));
    cJSON_AddNumberToObject(json, "levels", info.level_count);
    cJSON_AddNumberToObject(json, "cut_cells", info.cut_count);
    cJSON_AddBoolToObject(json, "compact", info.is_compact);
    cJSON_AddNumberToObject(json, "bricks", info.brick_count);
    cJSON_AddNumberToObject(json, "scale", (double)info.scale);
    cJSON_AddNumberToObject(json, "bytes", (double)info.file_bytes);
    cJSON_AddNumberToObject(json, "bytes_per_probe",
                            info.probe_count > 0 ? (double)info.file_bytes / (double)info.probe_count : 0.0);
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    json_add_key_lights(json, light, lmb_volume_key_lights(volume, light));
    cJSON *locals = cJSON_AddArrayToObject(json, "local_sets");
    for (uint32_t i = 0; i < lmb_volume_local_set_count(volume); ++i) {
        const lmb_local_set set = lmb_volume_local_set_get(volume, i);
        cJSON_AddItemToArray(locals, local_describe(set.name, set.node, set.place, &set.frame));
    }
    return json;
}

static cJSON *level_describe(const lmb_probes *probes, uint32_t number)
{
    const lmb_probe_level *const level = &probes->level[number];
    uint32_t cut_cells = 0, regions = 0;
    for (uint32_t i = 0; i < probes->cut.count; ++i) {
        cut_cells += probes->cut.cell[i].level == number;
        regions += probes->cut.cell[i].level == number ? probes->cut.cell[i].region_count : 0;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "spacing", (double)level->lattice.spacing);
    json_add_range(json, "lattice_min", level->lattice.min);
    json_add_range(json, "lattice_size", level->lattice.size);
    cJSON_AddNumberToObject(json, "probes", level->count);
    cJSON_AddNumberToObject(json, "ghosts", level->ghost_count);
    cJSON_AddNumberToObject(json, "cut_cells", cut_cells);
    cJSON_AddNumberToObject(json, "cut_regions", regions);
    return json;
}

static cJSON *vdb_describe(const lmb_probes *probes, const char *settings, const char *scene_hash)
{
    const int32_t count = probes->count - probes->ghost_count;
    double mean[3] = {0.0, 0.0, 0.0};
    int32_t valid = 0;
    for (int32_t i = 0; i < count; ++i) {
        valid += probes->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        for (int c = 0; c < 3; ++c) {
            mean[c] += (double)probes->radiance[0][i].channel[c].c[0] * 0.28209479177387814 / count;
        }
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "kind", "lambent probe grid");
    cJSON_AddNumberToObject(json, "probes", count);
    cJSON_AddNumberToObject(json, "probes_valid", valid);
    cJSON_AddNumberToObject(json, "ghosts", probes->ghost_count);
    cJSON_AddNumberToObject(json, "cut_cells", probes->cut.count);
    cJSON_AddNumberToObject(json, "spacing", (double)probes->level[0].lattice.spacing);
    json_add_range(json, "lattice_min", probes->level[0].lattice.min);
    json_add_range(json, "lattice_size", probes->level[0].lattice.size);
    cJSON *levels = cJSON_AddArrayToObject(json, "levels");
    for (uint32_t i = 0; i < probes->level_count; ++i) {
        cJSON_AddItemToArray(levels, level_describe(probes, i));
    }
    cJSON_AddItemToObject(json, "mean_radiance", cJSON_CreateDoubleArray(mean, 3));
    json_add_key_lights(json, probes->key_light, probes->key_light_count);
    cJSON *locals = cJSON_AddArrayToObject(json, "local_sets");
    for (uint32_t i = 0; i < probes->local_count; ++i) {
        const lmb_probe_local *const local = &probes->local[i];
        cJSON_AddItemToArray(locals, local_describe(local->name, local->node, local->place, &local->frame));
    }
    cJSON_AddStringToObject(json, "scene_hash", scene_hash);
    cJSON *parsed = cJSON_Parse(settings);
    cJSON_AddItemToObject(json, "settings", parsed ? parsed : cJSON_CreateString(settings));
    return json;
}

static lmb_result lmb_info(const char *path, cJSON **json, lmb_error *error)
{
    lmb_volume *volume;
    const lmb_result result = lmb_volume_open_file(path, &volume);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
    }
    *json = lmb_describe(volume);
    lmb_volume_close(volume);
    return LMB_OK;
}

static cJSON *tiles_describe(const lmb_volume_tiles *tiles)
{
    const lmb_volume_tiles_info info = lmb_volume_tiles_get_info(tiles);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "kind", "lambent index of tiles");
    cJSON_AddNumberToObject(json, "tiles", info.tile_count);
    cJSON_AddItemToObject(json, "tile_size", json_position(info.tile_size));
    cJSON_AddNumberToObject(json, "spacing", (double)info.spacing);
    cJSON_AddItemToObject(json, "bounds_min", json_position(info.bounds_min));
    cJSON_AddItemToObject(json, "bounds_max", json_position(info.bounds_max));
    cJSON_AddNumberToObject(json, "levels", info.level_count);
    cJSON_AddBoolToObject(json, "compact", info.is_compact);
    cJSON_AddNumberToObject(json, "bytes", (double)info.file_bytes);
    cJSON_AddNumberToObject(json, "bytes_of_tiles", (double)info.tile_bytes);
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    json_add_key_lights(json, light, lmb_volume_tiles_key_lights(tiles, light));
    return json;
}

static lmb_result tiles_info(const char *path, cJSON **json, lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_volume_tiles *tiles;
    lmb_result result = lmb_file_read(path, &data, &size, error);
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_volume_tiles_open_memory(data, size, &tiles);
    if (result == LMB_OK) {
        *json = tiles_describe(tiles);
        lmb_volume_tiles_close(tiles);
    } else {
        lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
    }
    free(data);
    return result;
}

static lmb_result vdb_info(const info_options *options, cJSON **json, lmb_error *error)
{
    lmb_probes *probes;
    char *settings;
    char *scene_hash;
    lmb_result result = lmb_vdb_read(options->shared.path[0], &probes, &settings, &scene_hash, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_slice_pictures pictures = {0};
    if (options->slices) {
        result = slice_draw(probes, &options->slice, &pictures);
        result = result == LMB_OK
                     ? slice_write(&pictures, options->slices, error)
                     : lmb_error_set(error, result, "%s: out of memory for pictures", options->shared.path[0]);
    }
    if (result == LMB_OK) {
        *json = vdb_describe(probes, settings, scene_hash);
        if (options->slices) {
            cJSON_AddNumberToObject(*json, "slices_at", pictures.at);
        }
    }
    slice_free(&pictures);
    lmb_probes_destroy(probes);
    free(settings);
    free(scene_hash);
    return result;
}

static cJSON *channel_describe(const float *values, size_t count)
{
    double low = INFINITY, high = -INFINITY, sum = 0.0;
    for (size_t i = 0; i < count; ++i) {
        low = fmin(low, (double)values[i]);
        high = fmax(high, (double)values[i]);
        sum += (double)values[i];
    }
    cJSON *channel = cJSON_CreateObject();
    cJSON_AddNumberToObject(channel, "min", low);
    cJSON_AddNumberToObject(channel, "mean", sum / (double)count);
    cJSON_AddNumberToObject(channel, "max", high);
    return channel;
}

/* Any EXR, but one of ours has a scale. */
static lmb_result exr_info(const char *path, cJSON **json, lmb_error *error)
{
    lmb_exr_name listed[LMB_MODEL_MOST_CHANNELS];
    const char *names[LMB_MODEL_MOST_CHANNELS];
    float *values[LMB_MODEL_MOST_CHANNELS];
    lmb_exr_header header;
    size_t channel_count = 0;
    lmb_result result = lmb_exr_list_channels(path, listed, LMB_MODEL_MOST_CHANNELS, &channel_count, error);
    const size_t shown = channel_count < LMB_MODEL_MOST_CHANNELS ? channel_count : LMB_MODEL_MOST_CHANNELS;
    for (size_t k = 0; result == LMB_OK && k < shown; ++k) {
        names[k] = listed[k].text;
    }
    if (result == LMB_OK) {
        result = lmb_exr_read_channels(path, names, shown, values, &header, error);
    }
    if (result != LMB_OK) {
        return result;
    }
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "kind", "OpenEXR image");
    cJSON_AddNumberToObject(object, "width", header.width);
    cJSON_AddNumberToObject(object, "height", header.height);
    cJSON_AddNumberToObject(object, "scale", (double)header.scale);
    cJSON *channels = cJSON_AddObjectToObject(object, "channels");
    for (size_t k = 0; k < shown; ++k) {
        cJSON_AddItemToObject(channels, names[k],
                              channel_describe(values[k], (size_t)header.width * (size_t)header.height));
        free(values[k]);
    }
    *json = object;
    return LMB_OK;
}

/* The channels of each layer, of the first level. */
static lmb_result layers_describe(const lmb_block_texture *texture, cJSON *list, lmb_error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    const size_t texels = (size_t)texture->width * (size_t)texture->height;
    const int channels = lmb_block_format_channels(texture->format);
    float *const values = malloc(texels * sizeof *values * (size_t)channels);
    if (!values) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    float *plane[3];
    for (int c = 0; c < channels; ++c) {
        plane[c] = values + (size_t)c * texels;
    }
    for (int32_t layer = 0; layer < texture->layers; ++layer) {
        cJSON *object = cJSON_CreateObject();
        const lmb_result result = lmb_block_texture_decode(texture, 0, layer, plane);
        for (int c = 0; c < channels && result == LMB_OK; ++c) {
            cJSON_AddItemToObject(object, names[c], channel_describe(plane[c], texels));
        }
        cJSON_AddItemToArray(list, object);
    }
    free(values);
    return LMB_OK;
}

static lmb_result texture_info(const char *path, cJSON **json, lmb_error *error)
{
    lmb_block_texture texture;
    lmb_block_container container;
    lmb_result result = lmb_block_texture_read(path, &texture, &container, error);
    if (result != LMB_OK) {
        return result;
    }
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "kind", container == LMB_BLOCK_KTX2 ? "KTX2 texture" : "DDS texture");
    cJSON_AddStringToObject(object, "format", lmb_block_format_name(texture.format));
    cJSON_AddNumberToObject(object, "width", texture.width);
    cJSON_AddNumberToObject(object, "height", texture.height);
    cJSON_AddNumberToObject(object, "levels", texture.levels);
    cJSON_AddNumberToObject(object, "bytes", (double)texture.size);
    result = layers_describe(&texture, cJSON_AddArrayToObject(object, "layers"), error);
    lmb_block_texture_free(&texture);
    if (result != LMB_OK) {
        cJSON_Delete(object);
        return result;
    }
    *json = object;
    return LMB_OK;
}

/* Told apart by content: OpenEXR, KTX2, DDS and OpenVDB have their magic numbers, the rest is for lmb_volume_open to
 * judge. */
static lmb_result file_info(const info_options *options, cJSON **json, lmb_error *error)
{
    const char *const path = options->shared.path[0];
    unsigned char magic[4] = {0};
    FILE *file = fopen(path, "rb");
    if (!file) {
        return lmb_error_set(error, LMB_ERROR_IO, "%s: cannot be opened", path);
    }
    const size_t read = fread(magic, 1, sizeof magic, file);
    fclose(file);
    if (read == sizeof magic && memcmp(magic, " BDV", 4) == 0) {
        return vdb_info(options, json, error);
    }
    if (options->slices) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: --slices takes a .vdb", path);
    }
    if (read == sizeof magic && memcmp(magic, "\x76\x2f\x31\x01", 4) == 0) {
        return exr_info(path, json, error);
    }
    if (read == sizeof magic && (memcmp(magic, "\xABKTX", 4) == 0 || memcmp(magic, "DDS ", 4) == 0)) {
        return texture_info(path, json, error);
    }
    if (read == sizeof magic && memcmp(magic, "\x89LMT", 4) == 0) {
        return tiles_info(path, json, error);
    }
    return lmb_info(path, json, error);
}

static void axis_read(lmb_arguments *arguments, const char *option, lmb_slice *slice)
{
    const char *const text = arguments_text(arguments, option);
    if (!arguments->failed && (strlen(text) != 1 || text[0] < 'x' || text[0] > 'z')) {
        arguments_error(arguments, "--axis takes x, y or z, not", text);
    }
    slice->axis = arguments->failed ? 0 : text[0] - 'x';
}

static void options_read(lmb_arguments *arguments, info_options *options)
{
    const char *of_slices = NULL; /* an option that says nothing without --slices */
    for (const char *argument; (argument = arguments_next(arguments));) {
        if (strcmp(argument, "--json") == 0) {
            options->json = true;
        } else if (strcmp(argument, "--slices") == 0) {
            options->slices = arguments_text(arguments, argument);
        } else if (strcmp(argument, "--axis") == 0) {
            axis_read(arguments, of_slices = argument, &options->slice);
        } else if (strcmp(argument, "--at") == 0) {
            options->slice.at = arguments_number(arguments, of_slices = argument, -1e9, 1e9);
            options->slice.has_at = true;
        } else {
            arguments_shared(arguments, argument, &options->shared);
        }
    }
    if (arguments_complete(arguments, &options->shared) && of_slices && !options->slices) {
        arguments_error(arguments, "--slices DIR has to go with", of_slices);
    }
}

/* A line for each item; for each element of an array of objects. */
static void text_print(const cJSON *object)
{
    for (const cJSON *item = object->child; item; item = item->next) {
        const bool is_list = cJSON_IsArray(item) && cJSON_IsObject(item->child);
        for (const cJSON *line = is_list ? item->child : item; line; line = is_list ? line->next : NULL) {
            char *text = cJSON_IsString(line) ? NULL : cJSON_PrintUnformatted(line);
            printf("%-16s %s\n", item->string, text ? text : line->valuestring);
            cJSON_free(text);
        }
    }
}

int command_info(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "info", usage);
    info_options options = {.shared = {.path_name = {"FILE"}}, .slice = {.axis = 1}};
    options_read(&arguments, &options);
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    cJSON *object = NULL;
    lmb_error error = {{0}};
    const lmb_result result = file_info(&options, &object, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    if (options.json) {
        return json_print_line(object);
    }
    text_print(object);
    cJSON_Delete(object);
    return EXIT_DONE;
}
