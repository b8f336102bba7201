/* Lightmaps from disk, into a layout that was made again (docs/formats.md). */
#include "lightmap/lightmap_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/exr.h>
#include <lambent/file.h>

#include "lightmap/lightmap_files.h"

static lmb_result out_of_memory(lmb_error *error)
{
    return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for the lightmap's files");
}

static bool json_text_is(const cJSON *object, const char *name, const char *expected)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
    return text && strcmp(text, expected) == 0;
}

static bool json_number_is(const cJSON *object, const char *name, double expected)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(item) && item->valuedouble == expected;
}

/* Compares as floats: the text's last digit is not quite a double's. */
static bool json_pair_is(const cJSON *object, const char *name, float x, float y)
{
    const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, name);
    const cJSON *first = array ? array->child : NULL;
    const cJSON *second = first ? first->next : NULL;
    return cJSON_IsArray(array) && cJSON_IsNumber(first) && cJSON_IsNumber(second) && !second->next &&
           (float)first->valuedouble == x && (float)second->valuedouble == y;
}

static bool json_node_matches(const cJSON *object, const lmb_lightmap *lightmap, uint32_t number)
{
    const lmb_instance *instance = &lightmap->scene->instances[number];
    const lmb_lightmap_region *region = &lightmap->region[number];
    const bool charts = lightmap->corner_uv[instance->mesh] != NULL;
    return json_number_is(object, "node", instance->node) && json_number_is(object, "place", instance->place) &&
           json_number_is(object, "image", region->image) &&
           json_pair_is(object, "offset", region->offset.x, region->offset.y) &&
           json_pair_is(object, "scale", region->scale.x, region->scale.y) &&
           json_pair_is(object, "texel", (float)region->x, (float)region->y) &&
           json_pair_is(object, "texels", (float)region->width, (float)region->height) &&
           json_text_is(object, "uv", charts ? "charts" : "TEXCOORD_1");
}

/* Whether the JSON lists just this lightmap's images and regions. */
static bool json_layout_matches(const cJSON *root, const lmb_lightmap *lightmap)
{
    const cJSON *images = cJSON_GetObjectItemCaseSensitive(root, "images");
    const cJSON *nodes = cJSON_GetObjectItemCaseSensitive(root, "nodes");
    if (!cJSON_IsArray(images) || !cJSON_IsArray(nodes)) {
        return false;
    }
    const cJSON *item = images->child;
    for (int32_t i = 0; i < lightmap->image_count; ++i, item = item->next) {
        char name[LMB_LIGHTMAP_FILE_NAME];
        lmb_lightmap_file_name(i, NULL, name);
        if (!item || (lightmap->model->irradiance_first && !json_text_is(item, "file", name)) ||
            !json_number_is(item, "width", lightmap->image[i].width) ||
            !json_number_is(item, "height", lightmap->image[i].height)) {
            return false;
        }
    }
    if (item) {
        return false;
    }
    item = nodes->child;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        if (lightmap->region[i].image >= 0) {
            if (!item || !json_node_matches(item, lightmap, i)) {
                return false;
            }
            item = item->next;
        }
    }
    return item == NULL;
}

static bool json_key_lights_match(const cJSON *root, const lmb_lightmap *lightmap)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "key_lights");
    return cJSON_GetArraySize(list) == (int)lightmap->key_light_count;
}

/* Of a JSON that matches. */
static void json_sides_take(const cJSON *root, lmb_lightmap *lightmap)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "nodes")->child;
    for (uint32_t i = 0; i < lightmap->scene->instance_count; ++i) {
        if (lightmap->region[i].image >= 0) {
            lightmap->region[i].back = json_text_is(item, "side", "back");
            item = item->next;
        }
    }
}

lmb_result lmb_lightmap_json_check(lmb_lightmap *lightmap, const char *path, const char *text, size_t size,
                                   lmb_error *error)
{
    cJSON *root = cJSON_ParseWithLength(text, size);
    lmb_result result = LMB_OK;
    if (!root || !json_text_is(root, "format", LMB_LIGHTMAP_FORMAT_NAME)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a lightmap's description", path);
    } else if (!json_number_is(root, "version", lmb_lightmap_format_version(lightmap)) ||
               !json_text_is(root, "encoding", lightmap->model->name)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: neither version %d nor encoding '%s'", path,
                               lmb_lightmap_format_version(lightmap), lightmap->model->name);
    } else if (!json_layout_matches(root, lightmap) || !json_key_lights_match(root, lightmap)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT,
                               "%s: describes another layout than this level and these settings have", path);
    } else {
        json_sides_take(root, lightmap);
    }
    cJSON_Delete(root);
    return result;
}

static lmb_result json_read(lmb_lightmap *lightmap, const char *path, lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(path, &data, &size, error);
    if (result == LMB_OK) {
        result = lmb_lightmap_json_check(lightmap, path, (const char *)data, size, error);
        free(data);
    }
    return result;
}

/* Reads some of an image's planes into `plane`, which has room for all of them. */
static lmb_result channels_read(const lmb_lightmap_image *image, const lmb_lightmap_channels *which, const char *path,
                                float *plane, lmb_error *error)
{
    float *values[LMB_MODEL_MOST_CHANNELS] = {NULL};
    lmb_exr_header header;
    const lmb_result result = lmb_exr_read_channels(path, which->name, (size_t)which->stored, values, &header, error);
    if (result != LMB_OK) {
        return result;
    }
    const float scale = header.scale;
    const bool good = header.width == image->width && header.height == image->height && scale > 0.0f && isfinite(scale);
    const size_t count = good ? (size_t)image->width * (size_t)image->height : 0;
    bool finite = true;
    for (int c = 0; c < which->stored; ++c) {
        for (size_t i = 0; c < which->count && i < count; ++i) {
            const float value = values[c][i] * (c < which->light_count ? scale : 1.0f);
            finite = finite && isfinite(value);
            plane[(size_t)(which->first + c) * count + i] = value;
        }
        free(values[c]);
    }
    if (!good) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not the size that the layout has, or a broken scale", path);
    }
    return finite ? LMB_OK : lmb_error_set(error, LMB_ERROR_FORMAT, "%s: holds NaN or infinity", path);
}

static lmb_lightmap_channels kind_channels(const lmb_lightmap *lightmap, const char *kind)
{
    return !kind                                       ? lmb_lightmap_picture_channels()
           : strcmp(kind, LMB_LIGHTMAP_KEYS_KIND) == 0 ? lmb_lightmap_key_channels(lightmap)
                                                       : lmb_lightmap_model_channels(lightmap->model);
}

/* The picture (`kind` NULL), the model's own file, or that of key lights. */
static lmb_result file_read(const lmb_lightmap *lightmap, int32_t number, const char *kind, const char *directory,
                            float *plane, lmb_error *error)
{
    const lmb_lightmap_channels which = kind_channels(lightmap, kind);
    char name[LMB_LIGHTMAP_FILE_NAME];
    lmb_lightmap_file_name(number, kind, name);
    char *path = lmb_file_in(directory, name);
    const lmb_result result =
        path ? channels_read(&lightmap->image[number], &which, path, plane, error) : out_of_memory(error);
    free(path);
    return result;
}

static lmb_result images_read(const lmb_lightmap *lightmap, const char *directory, float **plane, lmb_error *error)
{
    const lmb_model *model = lightmap->model;
    const size_t planes = (size_t)lmb_lightmap_plane_count(lightmap);
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < lightmap->image_count && result == LMB_OK; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        plane[i] = calloc((size_t)image->width * (size_t)image->height * planes, sizeof **plane);
        result = plane[i] ? LMB_OK : out_of_memory(error);
        if (result == LMB_OK && model->irradiance_first) {
            result = file_read(lightmap, i, NULL, directory, plane[i], error);
        }
        if (result == LMB_OK && lmb_lightmap_model_channels(model).count > 0) {
            result = file_read(lightmap, i, lmb_lightmap_kind(model), directory, plane[i], error);
        }
        if (result == LMB_OK && lightmap->key_light_count > 0) {
            result = file_read(lightmap, i, LMB_LIGHTMAP_KEYS_KIND, directory, plane[i], error);
        }
    }
    return result;
}

lmb_result lmb_lightmap_read(lmb_lightmap *lightmap, const char *directory, lmb_error *error)
{
    char *path = lmb_file_in(directory, LMB_LIGHTMAP_JSON_NAME);
    float **plane = calloc((size_t)lightmap->image_count + 1u, sizeof *plane);
    lmb_result result = path && plane ? json_read(lightmap, path, error) : out_of_memory(error);
    if (result == LMB_OK) {
        result = images_read(lightmap, directory, plane, error);
    }
    if (result == LMB_OK && lmb_lightmap_mark(lightmap) != LMB_OK) {
        result = out_of_memory(error);
    }
    for (int32_t i = 0; plane && i < lightmap->image_count; ++i) {
        if (result == LMB_OK) {
            free(lightmap->image[i].plane);
            lightmap->image[i].plane = plane[i];
        } else {
            free(plane[i]);
        }
    }
    free(plane);
    free(path);
    return result;
}
