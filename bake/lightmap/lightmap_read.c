/* Lightmaps from disk, into a layout that was made again (docs/formats.md). */
#include "lightmap/lightmap_internal.h"
#include "lightmap/lightmap_textures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/exr.h>
#include <lambent/file.h>

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
    const bool is_own = json_text_is(root, "encoding", lightmap->model->name);
    for (int32_t i = 0; i < lightmap->image_count; ++i, item = item->next) {
        char name[LMB_LIGHTMAP_FILE_NAME];
        lmb_lightmap_textures_picture(lightmap, i, name);
        if (!item || (is_own && lightmap->model->irradiance_first && !json_text_is(item, "file", name)) ||
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

/* The parts of an image of the lightmap's model in textures; NULL: it is in none. */
static const cJSON *json_parts(const cJSON *image, const lmb_lightmap *lightmap)
{
    const cJSON *models = cJSON_GetObjectItemCaseSensitive(image, "models");
    const cJSON *model = cJSON_GetObjectItemCaseSensitive(models, lightmap->model->name);
    return cJSON_GetObjectItemCaseSensitive(model, "parts");
}

/* Whether the folder has the lightmap's model, as its own or as another one. */
static bool json_has_model(const cJSON *root, const lmb_lightmap *lightmap)
{
    const cJSON *channels = cJSON_GetObjectItemCaseSensitive(root, "channels");
    const cJSON *images = cJSON_GetObjectItemCaseSensitive(root, "images");
    return json_text_is(root, "encoding", lightmap->model->name) ||
           cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(channels, lightmap->model->name)) ||
           cJSON_IsObject(json_parts(cJSON_GetArrayItem(images, 0), lightmap));
}

/* The scales of the light in textures of the lightmap's model, which no texture says itself: [image]. False where one
 * is missing or broken. */
static bool json_scales_take(const cJSON *root, const lmb_lightmap *lightmap, float *scale)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "images")->child;
    const bool is_own = json_text_is(root, "encoding", lightmap->model->name);
    bool good = true;
    for (int32_t i = 0; i < lightmap->image_count; ++i, item = item->next) {
        const cJSON *number = cJSON_GetObjectItemCaseSensitive(item, "scale");
        const cJSON *parts = is_own ? NULL : json_parts(item, lightmap);
        for (const cJSON *part = parts ? parts->child : NULL; part; part = part->next) {
            const cJSON *own = cJSON_GetObjectItemCaseSensitive(part, "scale");
            number = own ? own : number;
        }
        scale[i] = cJSON_IsNumber(number) ? (float)number->valuedouble : 0.0f;
        good = good && scale[i] > 0.0f && isfinite(scale[i]);
    }
    return good;
}

lmb_result lmb_lightmap_json_check(lmb_lightmap *lightmap, const char *path, const char *text, size_t size,
                                   float *scale, lmb_error *error)
{
    cJSON *root = cJSON_ParseWithLength(text, size);
    lmb_result result = LMB_OK;
    if (!root || !json_text_is(root, "format", LMB_LIGHTMAP_FORMAT_NAME)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a lightmap's description", path);
    } else if (!json_number_is(root, "version", lmb_lightmap_format_version(lightmap))) {
        result =
            lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not version %d", path, lmb_lightmap_format_version(lightmap));
    } else if (!json_has_model(root, lightmap)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no texels of the model '%s'", path, lightmap->model->name);
    } else if (!json_layout_matches(root, lightmap) || !json_key_lights_match(root, lightmap)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT,
                               "%s: describes another layout than this level and these settings have", path);
    } else if (!json_scales_take(root, lightmap, scale)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: a broken scale", path);
    } else {
        json_sides_take(root, lightmap);
    }
    cJSON_Delete(root);
    return result;
}

static lmb_result json_read(lmb_lightmap *lightmap, const char *path, float *scale, lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(path, &data, &size, error);
    if (result == LMB_OK) {
        result = lmb_lightmap_json_check(lightmap, path, (const char *)data, size, scale, error);
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

static lmb_result pictures_read(const lmb_lightmap *lightmap, int32_t number, const char *directory, float *plane,
                                lmb_error *error)
{
    const lmb_model *model = lightmap->model;
    lmb_result result = LMB_OK;
    if (model->irradiance_first) {
        result = file_read(lightmap, number, NULL, directory, plane, error);
    }
    if (result == LMB_OK && lmb_lightmap_model_channels(model).count > 0) {
        result = file_read(lightmap, number, lmb_lightmap_kind(model), directory, plane, error);
    }
    if (result == LMB_OK && lightmap->key_light_count > 0) {
        result = file_read(lightmap, number, LMB_LIGHTMAP_KEYS_KIND, directory, plane, error);
    }
    return result;
}

static lmb_result textures_read(const lmb_lightmap *lightmap, int32_t number, float scale, const char *directory,
                                float *plane, lmb_error *error)
{
    lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS + 1];
    int count = lmb_lightmap_textures_parts(lightmap->model, lightmap->settings.format, parts);
    if (lightmap->key_light_count > 0) {
        parts[count++] = lmb_lightmap_textures_keys(lightmap);
    }
    lmb_result result = LMB_OK;
    for (int i = 0; i < count && result == LMB_OK; ++i) {
        char name[LMB_LIGHTMAP_FILE_NAME];
        lmb_lightmap_textures_name(lightmap, lightmap->model, &parts[i], number, name);
        char *path = lmb_file_in(directory, name);
        result = path ? lmb_lightmap_textures_read(&lightmap->image[number], scale, &parts[i], path, plane, error)
                      : out_of_memory(error);
        free(path);
    }
    return result;
}

static lmb_result images_read(const lmb_lightmap *lightmap, const char *directory, const float *scale, float **plane,
                              lmb_error *error)
{
    const size_t planes = (size_t)lmb_lightmap_plane_count(lightmap);
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < lightmap->image_count && result == LMB_OK; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        plane[i] = calloc((size_t)image->width * (size_t)image->height * planes, sizeof **plane);
        result = !plane[i] ? out_of_memory(error)
                 : lightmap->settings.format == LMB_LIGHTMAP_EXR || !lmb_lightmap_textures_hold(lightmap->model)
                     ? pictures_read(lightmap, i, directory, plane[i], error)
                     : textures_read(lightmap, i, scale[i], directory, plane[i], error);
    }
    return result;
}

lmb_result lmb_lightmap_read(lmb_lightmap *lightmap, const char *directory, lmb_error *error)
{
    char *path = lmb_file_in(directory, LMB_LIGHTMAP_JSON_NAME);
    float **plane = calloc((size_t)lightmap->image_count + 1u, sizeof *plane);
    float *scale = calloc((size_t)lightmap->image_count + 1u, sizeof *scale);
    lmb_result result = path && plane && scale ? json_read(lightmap, path, scale, error) : out_of_memory(error);
    if (result == LMB_OK) {
        result = images_read(lightmap, directory, scale, plane, error);
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
    free(scale);
    free(plane);
    free(path);
    return result;
}

lmb_result lmb_lightmap_read_model(lmb_lightmap *lightmap, const lmb_model *model, const char *directory,
                                   lmb_error *error)
{
    const lmb_model *const own = lightmap->model;
    lightmap->model = model;
    const lmb_result result = lmb_lightmap_read(lightmap, directory, error);
    if (result != LMB_OK) {
        lightmap->model = own;
    }
    return result;
}
