/* Lightmaps on disk: an EXR for each image, and the JSON that says where each node's texels are (docs/formats.md). */
#include "lightmap/lightmap_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/half_scale.h>
#include <lambent/gltf.h>

/* Who reads version 1 alone would lose the key lights of version 2. */
enum { FORMAT_VERSION = 1, FORMAT_VERSION_WITH_KEYS = 2, MAX_FILE_NAME = 32 };

/* The channels of what is seen of key lights. */
static const char *const KEY_NAMES[LMB_KEY_LIGHTS_MOST] = {"key0", "key1", "key2", "key3"};
static const char *const KEY_ATTRIBUTES[LMB_KEY_LIGHTS_MOST] = {"lambent:key0", "lambent:key1", "lambent:key2",
                                                                "lambent:key3"};

static int format_version(const lmb_lightmap *lightmap)
{
    return lightmap->key_light_count > 0 ? FORMAT_VERSION_WITH_KEYS : FORMAT_VERSION;
}

static const char FORMAT_NAME[] = "lambent lightmap";
static const char JSON_NAME[] = "lightmap.json";
static const char UV_LEVEL_NAME[] = "level_uv2.glb";

static void image_file_name(int32_t number, char name[MAX_FILE_NAME])
{
    snprintf(name, MAX_FILE_NAME, "lightmap_%d.exr", (int)number);
}

/* The name of a plane's channel. */
static const char *plane_name(const lmb_model *model, int plane)
{
    return plane < model->channel_count ? model->channel_name[plane] : KEY_NAMES[plane - model->channel_count];
}

static lmb_result out_of_memory(lmb_error *error)
{
    return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory for the lightmap's files");
}

/* Adds a file's size to `*bytes`. */
static lmb_result size_add(const char *path, uint64_t *bytes, lmb_error *error)
{
    FILE *file = fopen(path, "rb");
    long size = -1;
    if (file) {
        if (fseek(file, 0, SEEK_END) == 0) {
            size = ftell(file);
        }
        fclose(file);
    }
    if (size < 0) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be read back", path);
    }
    *bytes += (uint64_t)size;
    return LMB_OK;
}

/* The power of two that light is divided by, so that the image's brightest texel suits fp16. */
static float image_scale(const lmb_lightmap_image *image, const lmb_model *model)
{
    const size_t values = (size_t)model->light_count * (size_t)image->width * (size_t)image->height;
    float brightest = 0.0f;
    for (size_t i = 0; i < values; ++i) {
        brightest = fmaxf(brightest, fabsf(image->plane[i]));
    }
    return lmb_half_scale(brightest);
}

/* The channels of an image, those of light divided by `scale` in `scaled`, which has room for them. Returns how many.
 */
static size_t channels_make(const lmb_lightmap *lightmap, const lmb_lightmap_image *image, float scale, float *scaled,
                            lmb_exr_channel channels[LMB_MODEL_MOST_CHANNELS + LMB_KEY_LIGHTS_MOST])
{
    const lmb_model *model = lightmap->model;
    const size_t texels = (size_t)image->width * (size_t)image->height;
    for (int c = 0; c < lmb_lightmap_plane_count(lightmap); ++c) {
        channels[c] = (lmb_exr_channel){plane_name(model, c), lmb_lightmap_plane(image, c)};
    }
    for (int c = 0; c < model->light_count; ++c, scaled += texels) {
        for (size_t i = 0; i < texels; ++i) {
            scaled[i] = channels[c].values[i] * (1.0f / scale);
        }
        channels[c].values = scaled;
    }
    return (size_t)lmb_lightmap_plane_count(lightmap);
}

enum { PLAIN_ATTRIBUTES = 5, KEY_TEXT_SIZE = 128 };

/* What an image's header says of a key light: its direction and irradiance. */
static void key_text_make(const lmb_key_light *light, char text[KEY_TEXT_SIZE])
{
    snprintf(text, KEY_TEXT_SIZE, "%.9g %.9g %.9g %.9g %.9g %.9g", (double)light->direction.x,
             (double)light->direction.y, (double)light->direction.z, (double)light->irradiance.c[0],
             (double)light->irradiance.c[1], (double)light->irradiance.c[2]);
}

/* Adds how many key lights there are, and what each is; `text` is to outlive them. Returns how many attributes those
 * are. */
static size_t key_attributes_make(const lmb_lightmap *lightmap, char text[LMB_KEY_LIGHTS_MOST][KEY_TEXT_SIZE],
                                  lmb_exr_attribute attributes[1 + LMB_KEY_LIGHTS_MOST])
{
    const uint32_t count = lightmap->key_light_count;
    attributes[0] = (lmb_exr_attribute){"lambent:key_lights", NULL, (float)count};
    for (uint32_t key = 0; key < count; ++key) {
        key_text_make(&lightmap->key_light[key], text[key]);
        attributes[1 + key] = (lmb_exr_attribute){KEY_ATTRIBUTES[key], text[key], 0.0f};
    }
    return count > 0 ? 1 + (size_t)count : 0;
}

static lmb_result image_write(const lmb_lightmap *lightmap, const lmb_lightmap_image *image, const char *path,
                              lmb_error *error)
{
    const lmb_model *model = lightmap->model;
    const size_t texels = (size_t)image->width * (size_t)image->height;
    float *values = malloc(texels * (size_t)model->light_count * sizeof *values);
    if (!values) {
        return out_of_memory(error);
    }
    const float scale = image_scale(image, model);
    lmb_exr_channel channels[LMB_MODEL_MOST_CHANNELS + LMB_KEY_LIGHTS_MOST];
    char key_text[LMB_KEY_LIGHTS_MOST][KEY_TEXT_SIZE];
    lmb_exr_attribute attributes[PLAIN_ATTRIBUTES + 1 + LMB_KEY_LIGHTS_MOST] = {
        {"lambent:format", FORMAT_NAME, 0.0f},   {"lambent:version", NULL, (float)format_version(lightmap)},
        {"lambent:encoding", model->name, 0.0f}, {"lambent:convention", model->convention, 0.0f},
        {"lambent:scale", NULL, scale},
    };
    const size_t key_attributes = key_attributes_make(lightmap, key_text, &attributes[PLAIN_ATTRIBUTES]);
    const lmb_exr_picture picture = {.width = image->width,
                                     .height = image->height,
                                     .channels = channels,
                                     .channel_count = channels_make(lightmap, image, scale, values, channels),
                                     .attributes = attributes,
                                     .attribute_count = PLAIN_ATTRIBUTES + key_attributes};
    size_t overflows = 0;
    const lmb_result result = lmb_exr_write(path, &picture, &overflows, error);
    free(values);
    return result;
}

static bool json_add_pair(cJSON *object, const char *name, double x, double y)
{
    cJSON *array = cJSON_AddArrayToObject(object, name);
    return array && cJSON_AddItemToArray(array, cJSON_CreateNumber(x)) &&
           cJSON_AddItemToArray(array, cJSON_CreateNumber(y));
}

static bool json_add_image(cJSON *images, const lmb_lightmap *lightmap, int32_t number)
{
    char name[MAX_FILE_NAME];
    image_file_name(number, name);
    const lmb_lightmap_image *image = &lightmap->image[number];
    cJSON *object = cJSON_CreateObject();
    return cJSON_AddItemToArray(images, object) && cJSON_AddStringToObject(object, "file", name) &&
           cJSON_AddNumberToObject(object, "width", image->width) &&
           cJSON_AddNumberToObject(object, "height", image->height) &&
           cJSON_AddNumberToObject(object, "scale", (double)image_scale(image, lightmap->model));
}

static bool json_add_node(cJSON *nodes, const lmb_lightmap *lightmap, uint32_t number)
{
    const lmb_instance *instance = &lightmap->scene->instances[number];
    const lmb_lightmap_region *region = &lightmap->region[number];
    cJSON *object = cJSON_CreateObject();
    const bool charts = lightmap->corner_uv[instance->mesh] != NULL;
    return cJSON_AddItemToArray(nodes, object) && cJSON_AddStringToObject(object, "name", instance->name) &&
           cJSON_AddNumberToObject(object, "node", instance->node) &&
           cJSON_AddNumberToObject(object, "place", instance->place) &&
           cJSON_AddNumberToObject(object, "image", region->image) &&
           json_add_pair(object, "offset", (double)region->offset.x, (double)region->offset.y) &&
           json_add_pair(object, "scale", (double)region->scale.x, (double)region->scale.y) &&
           json_add_pair(object, "texel", region->x, region->y) &&
           json_add_pair(object, "texels", region->width, region->height) &&
           cJSON_AddStringToObject(object, "uv", charts ? "charts" : "TEXCOORD_1") &&
           (!region->back || cJSON_AddStringToObject(object, "side", "back"));
}

static bool any_charts(const lmb_lightmap *lightmap)
{
    for (uint32_t m = 0; m < lightmap->scene->mesh_count; ++m) {
        if (lightmap->corner_uv[m]) {
            return true;
        }
    }
    return false;
}

static bool json_add_channels(cJSON *channels, const lmb_model *model)
{
    const char *const *name = model->channel_name;
    bool good = channels != NULL;
    for (const lmb_model_part *part = model->part; good && part->count > 0; name += part->count, ++part) {
        good = cJSON_AddItemToObject(channels, part->name, cJSON_CreateStringArray(name, part->count));
    }
    return good;
}

static bool json_add_key_light(cJSON *list, const char *channel, const lmb_key_light *light)
{
    const float direction[3] = {light->direction.x, light->direction.y, light->direction.z};
    cJSON *object = cJSON_CreateObject();
    return cJSON_AddItemToArray(list, object) && cJSON_AddStringToObject(object, "channel", channel) &&
           cJSON_AddItemToObject(object, "direction", cJSON_CreateFloatArray(direction, 3)) &&
           cJSON_AddItemToObject(object, "irradiance", cJSON_CreateFloatArray(light->irradiance.c, 3));
}

static bool json_add_key_lights(cJSON *root, const lmb_lightmap *lightmap)
{
    cJSON *list = lightmap->key_light_count > 0 ? cJSON_AddArrayToObject(root, "key_lights") : NULL;
    bool good = list || lightmap->key_light_count == 0;
    for (uint32_t key = 0; good && key < lightmap->key_light_count; ++key) {
        good = json_add_key_light(list, KEY_NAMES[key], &lightmap->key_light[key]);
    }
    return good;
}

/* lightmap.json as text, for cJSON_free; NULL when out of memory. */
static char *json_print(const lmb_lightmap *lightmap)
{
    cJSON *root = cJSON_CreateObject();
    bool good =
        cJSON_AddStringToObject(root, "format", FORMAT_NAME) &&
        cJSON_AddNumberToObject(root, "version", format_version(lightmap)) &&
        cJSON_AddStringToObject(root, "encoding", lightmap->model->name) &&
        cJSON_AddNumberToObject(root, "texels_per_m", (double)lightmap->settings.texels_per_m) &&
        cJSON_AddNumberToObject(root, "max_image_size", lightmap->settings.max_image_size) &&
        (lightmap->settings.padding == 1 || cJSON_AddNumberToObject(root, "padding", lightmap->settings.padding)) &&
        (any_charts(lightmap) ? cJSON_AddStringToObject(root, "uv_level", UV_LEVEL_NAME)
                              : cJSON_AddNullToObject(root, "uv_level"));
    good = good && json_add_channels(cJSON_AddObjectToObject(root, "channels"), lightmap->model) &&
           json_add_key_lights(root, lightmap);
    cJSON *images = cJSON_AddArrayToObject(root, "images");
    cJSON *nodes = cJSON_AddArrayToObject(root, "nodes");
    good = good && images && nodes;
    for (int32_t i = 0; good && i < lightmap->image_count; ++i) {
        good = json_add_image(images, lightmap, i);
    }
    for (uint32_t i = 0; good && i < lightmap->scene->instance_count; ++i) {
        good = lightmap->region[i].image < 0 || json_add_node(nodes, lightmap, i);
    }
    char *text = good ? cJSON_Print(root) : NULL;
    cJSON_Delete(root);
    return text;
}

static lmb_result json_write(const lmb_lightmap *lightmap, const char *path, lmb_error *error)
{
    char *text = json_print(lightmap);
    if (!text) {
        return out_of_memory(error);
    }
    const lmb_result result = lmb_file_write(path, text, strlen(text), error);
    cJSON_free(text);
    return result;
}

static lmb_result uv_level_write(const lmb_lightmap *lightmap, const char *path, const lmb_gltf_options *options,
                                 lmb_error *error)
{
    const lmb_scene *scene = lightmap->scene;
    lmb_gltf_uv *uvs = calloc((size_t)scene->mesh_count + 1u, sizeof *uvs);
    if (!uvs) {
        return out_of_memory(error);
    }
    size_t count = 0;
    for (uint32_t m = 0; m < scene->mesh_count; ++m) {
        if (lightmap->corner_uv[m]) {
            uvs[count++] = (lmb_gltf_uv){&scene->meshes[m], lightmap->corner_uv[m]};
        }
    }
    const lmb_result result = lmb_gltf_write_with_uvs(scene->path, options, uvs, count, path, error);
    free(uvs);
    return result;
}

/* What file_write writes. */
typedef enum file_kind { FILE_IMAGE, FILE_UV_LEVEL, FILE_JSON } file_kind;

typedef struct file_writer {
    const lmb_lightmap *lightmap;
    const char *directory;
    const lmb_gltf_options *options;
    uint64_t bytes;
    lmb_error *error;
} file_writer;

static lmb_result file_write(file_writer *writer, file_kind kind, int32_t image, const char *name)
{
    char *path = lmb_file_in(writer->directory, name);
    if (!path) {
        return out_of_memory(writer->error);
    }
    lmb_result result;
    switch (kind) {
    case FILE_IMAGE:
        result = image_write(writer->lightmap, &writer->lightmap->image[image], path, writer->error);
        break;
    case FILE_UV_LEVEL:
        result = uv_level_write(writer->lightmap, path, writer->options, writer->error);
        break;
    default:
        result = json_write(writer->lightmap, path, writer->error);
        break;
    }
    if (result == LMB_OK) {
        result = size_add(path, &writer->bytes, writer->error);
    }
    free(path);
    return result;
}

lmb_result lmb_lightmap_write(const lmb_lightmap *lightmap, const char *directory, const lmb_gltf_options *options,
                              uint64_t *bytes, lmb_error *error)
{
    file_writer writer = {lightmap, directory, options, 0, error};
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < lightmap->image_count && result == LMB_OK; ++i) {
        char name[MAX_FILE_NAME];
        image_file_name(i, name);
        result = file_write(&writer, FILE_IMAGE, i, name);
    }
    if (result == LMB_OK && any_charts(lightmap)) {
        result = file_write(&writer, FILE_UV_LEVEL, 0, UV_LEVEL_NAME);
    }
    /* Last: who finds it, finds the files that it names. */
    if (result == LMB_OK) {
        result = file_write(&writer, FILE_JSON, 0, JSON_NAME);
    }
    if (result == LMB_OK) {
        *bytes = writer.bytes;
    }
    return result;
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
        char name[MAX_FILE_NAME];
        image_file_name(i, name);
        if (!item || !json_text_is(item, "file", name) || !json_number_is(item, "width", lightmap->image[i].width) ||
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

static lmb_result json_check(lmb_lightmap *lightmap, const char *path, lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size = 0;
    const lmb_result read = lmb_file_read(path, &data, &size, error);
    if (read != LMB_OK) {
        return read;
    }
    cJSON *root = cJSON_ParseWithLength((const char *)data, size);
    free(data);
    lmb_result result = LMB_OK;
    if (!root || !json_text_is(root, "format", FORMAT_NAME)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a lightmap's description", path);
    } else if (!json_number_is(root, "version", format_version(lightmap)) ||
               !json_text_is(root, "encoding", lightmap->model->name)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: neither version %d nor encoding '%s'", path,
                               format_version(lightmap), lightmap->model->name);
    } else if (!json_layout_matches(root, lightmap) || !json_key_lights_match(root, lightmap)) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT,
                               "%s: describes another layout than this level and these settings have", path);
    } else {
        json_sides_take(root, lightmap);
    }
    cJSON_Delete(root);
    return result;
}

/* Reads one image's channels into `plane`, of the image's size. */
static lmb_result image_read(const lmb_lightmap *lightmap, const lmb_lightmap_image *image, const char *path,
                             float *plane, lmb_error *error)
{
    const lmb_model *model = lightmap->model;
    const int planes = lmb_lightmap_plane_count(lightmap);
    const char *names[LMB_MODEL_MOST_CHANNELS + LMB_KEY_LIGHTS_MOST];
    float *values[LMB_MODEL_MOST_CHANNELS + LMB_KEY_LIGHTS_MOST] = {NULL};
    for (int c = 0; c < planes; ++c) {
        names[c] = plane_name(model, c);
    }
    lmb_exr_header header;
    const lmb_result result = lmb_exr_read_channels(path, names, (size_t)planes, values, &header, error);
    if (result != LMB_OK) {
        return result;
    }
    const float scale = header.scale;
    const bool good = header.width == image->width && header.height == image->height && scale > 0.0f && isfinite(scale);
    const size_t count = good ? (size_t)image->width * (size_t)image->height : 0;
    bool finite = true;
    for (int c = 0; c < planes; ++c) {
        for (size_t i = 0; i < count; ++i) {
            const float value = values[c][i] * (c < model->light_count ? scale : 1.0f);
            finite = finite && isfinite(value);
            plane[(size_t)c * count + i] = value;
        }
        free(values[c]);
    }
    if (!good) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not the size that the layout has, or a broken scale", path);
    }
    return finite ? LMB_OK : lmb_error_set(error, LMB_ERROR_FORMAT, "%s: holds NaN or infinity", path);
}

static lmb_result images_read(const lmb_lightmap *lightmap, const char *directory, float **plane, lmb_error *error)
{
    const size_t planes = (size_t)lmb_lightmap_plane_count(lightmap);
    for (int32_t i = 0; i < lightmap->image_count; ++i) {
        const lmb_lightmap_image *image = &lightmap->image[i];
        char name[MAX_FILE_NAME];
        image_file_name(i, name);
        char *path = lmb_file_in(directory, name);
        plane[i] = calloc((size_t)image->width * (size_t)image->height * planes, sizeof **plane);
        const lmb_result result =
            path && plane[i] ? image_read(lightmap, image, path, plane[i], error) : out_of_memory(error);
        free(path);
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

lmb_result lmb_lightmap_read(lmb_lightmap *lightmap, const char *directory, lmb_error *error)
{
    char *path = lmb_file_in(directory, JSON_NAME);
    float **plane = calloc((size_t)lightmap->image_count + 1u, sizeof *plane);
    lmb_result result = path && plane ? json_check(lightmap, path, error) : out_of_memory(error);
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
