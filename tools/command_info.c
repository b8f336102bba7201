#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/block_texture.h>
#include <lambent/exr.h>
#include <lambent/model.h>
#include <lambent/lightmap.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include "command.h"
#include "query.h"

static const char usage[] =
    "usage: lambent info FILE [--json]\n"
    "\n"
    "Says what is in a probes.vdb, a probes.lmb, a lightmap .exr of ours, or a KTX2 or DDS of BC4,\n"
    "BC5, BC6H or ASTC.\n"
    "\n"
    "  --json                one JSON object\n";

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

static cJSON *lmb_describe(const lmb_volume *volume)
{
    const lmb_volume_info info = lmb_volume_get_info(volume);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "kind", "lambent run-time volume");
    cJSON_AddNumberToObject(json, "version", info.version);
    cJSON_AddNumberToObject(json, "probes", (double)info.probe_count);
    const double spacing = (double)lmb_volume_spacing_at(volume, info.bounds_min);
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
    cJSON_AddNumberToObject(json, "bricks", info.brick_count);
    cJSON_AddNumberToObject(json, "scale", (double)info.scale);
    cJSON_AddNumberToObject(json, "bytes", (double)info.file_bytes);
    cJSON_AddNumberToObject(json, "bytes_per_probe",
                            info.probe_count > 0 ? (double)info.file_bytes / (double)info.probe_count : 0.0);
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    json_add_key_lights(json, light, lmb_volume_key_lights(volume, light));
    return json;
}

static cJSON *vdb_describe(const lmb_probes *probes, const char *settings, const char *scene_hash)
{
    double mean[3] = {0.0, 0.0, 0.0};
    int32_t valid = 0;
    for (int32_t i = 0; i < probes->count; ++i) {
        valid += probes->validity[i] >= LMB_PROBES_MIN_VALIDITY;
        for (int c = 0; c < 3; ++c) {
            mean[c] += (double)probes->radiance[0][i].channel[c].c[0] * 0.28209479177387814 / probes->count;
        }
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "kind", "lambent probe grid");
    cJSON_AddNumberToObject(json, "probes", probes->count);
    cJSON_AddNumberToObject(json, "probes_valid", valid);
    cJSON_AddNumberToObject(json, "spacing", (double)probes->level[0].lattice.spacing);
    json_add_range(json, "lattice_min", probes->level[0].lattice.min);
    json_add_range(json, "lattice_size", probes->level[0].lattice.size);
    cJSON_AddItemToObject(json, "mean_radiance", cJSON_CreateDoubleArray(mean, 3));
    json_add_key_lights(json, probes->key_light, probes->key_light_count);
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

static lmb_result vdb_info(const char *path, cJSON **json, lmb_error *error)
{
    lmb_probes *probes;
    char *settings;
    char *scene_hash;
    const lmb_result result = lmb_vdb_read(path, &probes, &settings, &scene_hash, error);
    if (result != LMB_OK) {
        return result;
    }
    *json = vdb_describe(probes, settings, scene_hash);
    lmb_probes_destroy(probes);
    free(settings);
    free(scene_hash);
    return LMB_OK;
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
static lmb_result file_info(const char *path, cJSON **json, lmb_error *error)
{
    unsigned char magic[4] = {0};
    FILE *file = fopen(path, "rb");
    if (!file) {
        return lmb_error_set(error, LMB_ERROR_IO, "%s: cannot be opened", path);
    }
    const size_t read = fread(magic, 1, sizeof magic, file);
    fclose(file);
    if (read == sizeof magic && memcmp(magic, "\x76\x2f\x31\x01", 4) == 0) {
        return exr_info(path, json, error);
    }
    if (read == sizeof magic && (memcmp(magic, "\xABKTX", 4) == 0 || memcmp(magic, "DDS ", 4) == 0)) {
        return texture_info(path, json, error);
    }
    if (read == sizeof magic && memcmp(magic, " BDV", 4) == 0) {
        return vdb_info(path, json, error);
    }
    return lmb_info(path, json, error);
}

int command_info(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "info", usage);
    const char *path = NULL;
    bool json = false;
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (strcmp(argument, "--json") == 0) {
            json = true;
        } else if (argument[0] != '-' && !path) {
            path = argument;
        } else {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (!arguments.failed && !arguments.help && !path) {
        arguments_error(&arguments, "missing argument", "FILE");
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }
    cJSON *object = NULL;
    lmb_error error = {{0}};
    const lmb_result result = file_info(path, &object, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    if (json) {
        return json_print_line(object);
    }
    for (const cJSON *item = object->child; item; item = item->next) {
        char *text = cJSON_IsString(item) ? NULL : cJSON_PrintUnformatted(item);
        printf("%-16s %s\n", item->string, text ? text : item->valuestring);
        cJSON_free(text);
    }
    cJSON_Delete(object);
    return EXIT_DONE;
}
