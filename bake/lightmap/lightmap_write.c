/* Lightmaps to disk: EXRs for each image, and the JSON that says where each node's texels are (docs/formats.md). */
#include "lightmap/lightmap_textures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/exr.h>
#include <lambent/file.h>
#include <lambent/gltf.h>
#include <lambent/half_scale.h>

static const char UV_LEVEL_NAME[] = "level_uv2.glb";
static const char ERROR_KIND[] = "error";

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

/* One file of an image: some of a model's channels. */
typedef struct image_file {
    const lmb_lightmap_image *image;
    const lmb_model *model;
    const float *plane; /* of all the model's channels */
    lmb_lightmap_channels channels;
    int version;
} image_file;

static image_file picture_of(const lmb_lightmap *lightmap, int32_t number)
{
    const lmb_lightmap_image *image = &lightmap->image[number];
    return (image_file){image, lightmap->model, image->plane, lmb_lightmap_picture_channels(),
                        lmb_lightmap_format_version(lightmap)};
}

/* What else a model has: the lightmap's own, -1, or another one. */
static image_file model_of(const lmb_lightmap *lightmap, int32_t number, int other)
{
    const lmb_lightmap_image *image = &lightmap->image[number];
    const lmb_model *model = other < 0 ? lightmap->model : lightmap->settings.other[other];
    return (image_file){image, model, other < 0 ? image->plane : image->other[other],
                        lmb_lightmap_model_channels(model), lmb_lightmap_format_version(lightmap)};
}

/* Whether a model's files are textures. */
static bool in_textures(const lmb_lightmap *lightmap, const lmb_model *model)
{
    return lightmap->settings.format != LMB_LIGHTMAP_EXR && lmb_lightmap_textures_hold(model);
}

/* How many models are written. */
static int model_count(const lmb_lightmap *lightmap)
{
    int count = 1;
    while (count <= LMB_LIGHTMAP_MOST_MODELS && lightmap->settings.other[count - 1]) {
        ++count;
    }
    return count;
}

/* The irradiance that models outside of textures have in the picture they share: of the first of them, by its number
 * as for model_of. NO_PICTURE: none has it there. */
enum { NO_PICTURE = LMB_LIGHTMAP_MOST_MODELS };
static int picture_model(const lmb_lightmap *lightmap, int32_t number)
{
    for (int k = 0; k < model_count(lightmap); ++k) {
        const lmb_model *model = model_of(lightmap, number, k - 1).model;
        if (model->irradiance_first && !in_textures(lightmap, model)) {
            return k - 1;
        }
    }
    return NO_PICTURE;
}

static size_t texels_of(const lmb_lightmap_image *image)
{
    return (size_t)image->width * (size_t)image->height;
}

/* The power of two that light is divided by, so that the brightest texel suits fp16. */
static float file_scale(const image_file *file)
{
    const size_t texels = texels_of(file->image);
    const float *light = file->plane + (size_t)file->channels.first * texels;
    float brightest = 0.0f;
    for (size_t i = 0; file->channels.light_count > 0 && i < (size_t)file->channels.light_count * texels; ++i) {
        brightest = fmaxf(brightest, fabsf(light[i]));
    }
    return lmb_half_scale(brightest);
}

static lmb_result image_write(const image_file *file, const char *path, lmb_error *error)
{
    const lmb_lightmap_channels *which = &file->channels;
    const size_t texels = texels_of(file->image);
    const size_t lights = which->light_count > 0 ? (size_t)which->light_count : 0;
    float *values = malloc((texels * lights + 1) * sizeof *values);
    if (!values) {
        return out_of_memory(error);
    }
    const float scale = file_scale(file);
    lmb_exr_channel channels[LMB_MODEL_MOST_CHANNELS];
    for (int c = 0; c < which->count; ++c) {
        channels[c] = (lmb_exr_channel){which->name[c], file->plane + (size_t)(which->first + c) * texels};
    }
    for (size_t c = 0; c < lights; ++c) {
        float *const scaled = &values[c * texels];
        for (size_t i = 0; i < texels; ++i) {
            scaled[i] = channels[c].values[i] * (1.0f / scale);
        }
        channels[c].values = scaled;
    }
    const lmb_exr_attribute attributes[] = {
        {"lambent:format", LMB_LIGHTMAP_FORMAT_NAME, 0.0f},
        {"lambent:version", NULL, (float)file->version},
        {"lambent:encoding", file->model->name, 0.0f},
        {"lambent:convention", file->model->convention, 0.0f},
        {"lambent:scale", NULL, scale},
    };
    size_t overflows = 0;
    const lmb_exr_picture picture = {file->image->width, file->image->height,
                                     channels,           (size_t)which->count,
                                     attributes,         sizeof attributes / sizeof attributes[0]};
    const lmb_result result = lmb_exr_write(path, &picture, &overflows, error);
    free(values);
    return result;
}

/* How much of each key light is seen, as a picture of three channels or four: unused ones are 0. */
static lmb_result keys_write(const lmb_lightmap *lightmap, const lmb_lightmap_image *image, const char *path,
                             lmb_error *error)
{
    enum { MOST_ATTRIBUTES = 3 + LMB_KEY_LIGHTS_MOST, TEXT = 128 };
    static const char *const key_names[LMB_KEY_LIGHTS_MOST] = {"lambent:key0", "lambent:key1", "lambent:key2",
                                                               "lambent:key3"};
    const lmb_lightmap_channels which = lmb_lightmap_key_channels(lightmap);
    lmb_exr_attribute attributes[MOST_ATTRIBUTES] = {
        {"lambent:format", LMB_LIGHTMAP_FORMAT_NAME, 0.0f},
        {"lambent:version", NULL, (float)lmb_lightmap_format_version(lightmap)},
        {"lambent:convention", "R G B A: visibility of key lights 0 to 3, whose directions and irradiances stand here",
         0.0f},
    };
    char text[LMB_KEY_LIGHTS_MOST][TEXT];
    for (int key = 0; key < which.count; ++key) {
        const lmb_key_light *light = &lightmap->key_light[key];
        snprintf(text[key], TEXT, "%.9g %.9g %.9g %.9g %.9g %.9g", (double)light->direction.x,
                 (double)light->direction.y, (double)light->direction.z, (double)light->irradiance.c[0],
                 (double)light->irradiance.c[1], (double)light->irradiance.c[2]);
        attributes[3 + key] = (lmb_exr_attribute){key_names[key], text[key], 0.0f};
    }
    float *const none = calloc(texels_of(image), sizeof *none);
    if (!none) {
        return out_of_memory(error);
    }
    lmb_exr_channel channels[LMB_KEY_LIGHTS_MOST];
    for (int c = 0; c < which.stored; ++c) {
        channels[c] =
            (lmb_exr_channel){which.name[c], c < which.count ? lmb_lightmap_plane(image, which.first + c) : none};
    }
    size_t overflows = 0;
    const lmb_exr_picture picture = {image->width,         image->height, channels,
                                     (size_t)which.stored, attributes,    3 + (size_t)which.count};
    const lmb_result result = lmb_exr_write(path, &picture, &overflows, error);
    free(none);
    return result;
}

static lmb_result error_write(const lmb_lightmap *lightmap, const lmb_lightmap_image *image, const char *path,
                              lmb_error *error)
{
    const lmb_exr_channel channel = {"Y", image->error};
    const lmb_exr_attribute attributes[] = {
        {"lambent:format", LMB_LIGHTMAP_FORMAT_NAME, 0.0f},
        {"lambent:version", NULL, (float)lmb_lightmap_format_version(lightmap)},
        {"lambent:convention", "Y: standard error of what was gathered, relative to it or 1 % of the root mean square",
         0.0f},
    };
    size_t overflows = 0;
    const lmb_exr_picture picture = {
        image->width, image->height, &channel, 1, attributes, sizeof attributes / sizeof attributes[0]};
    return lmb_exr_write(path, &picture, &overflows, error);
}

static bool json_add_pair(cJSON *object, const char *name, double x, double y)
{
    cJSON *array = cJSON_AddArrayToObject(object, name);
    return array && cJSON_AddItemToArray(array, cJSON_CreateNumber(x)) &&
           cJSON_AddItemToArray(array, cJSON_CreateNumber(y));
}

/* The scale of light; else a pair for each channel. */
static bool json_add_ranges(cJSON *object, const lmb_texture_part *part, double scale)
{
    if (part->light) {
        return cJSON_AddNumberToObject(object, "scale", scale) != NULL;
    }
    cJSON *list = cJSON_AddArrayToObject(object, "ranges");
    bool good = list != NULL;
    for (int c = 0; c < part->count && good; ++c) {
        const double range[2] = {(double)part->low[c], (double)part->high[c]};
        good = cJSON_AddItemToArray(list, cJSON_CreateDoubleArray(range, 2));
    }
    return good;
}

/* Of one image, the textures of a model's parts. */
static bool json_add_textures(cJSON *files, const lmb_lightmap *lightmap, int32_t number, int other)
{
    const image_file file = model_of(lightmap, number, other);
    lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS];
    const int count = lmb_lightmap_textures_parts(file.model, lightmap->settings.format, parts);
    cJSON *object = cJSON_AddObjectToObject(files, file.model->name);
    cJSON *list = cJSON_AddObjectToObject(object, "parts");
    bool good = list != NULL;
    for (int i = 0; good && i < count; ++i) {
        char name[LMB_LIGHTMAP_FILE_NAME];
        lmb_lightmap_textures_name(lightmap, file.model, &parts[i], number, name);
        const float scale = lmb_lightmap_textures_scale(file.image, file.plane, &parts[i]);
        cJSON *part = cJSON_AddObjectToObject(list, parts[i].name);
        good = part && cJSON_AddStringToObject(part, "file", name) &&
               cJSON_AddStringToObject(part, "format", lmb_block_format_name(parts[i].format)) &&
               json_add_ranges(part, &parts[i], (double)scale);
    }
    return good;
}

/* Of one image, the file of a model: of the lightmap's own, -1, or another one. */
static bool json_add_file(cJSON *files, const lmb_lightmap *lightmap, int32_t number, int other)
{
    const image_file file = model_of(lightmap, number, other);
    if (in_textures(lightmap, file.model)) {
        return json_add_textures(files, lightmap, number, other);
    }
    char name[LMB_LIGHTMAP_FILE_NAME];
    const bool has_own = file.channels.count > 0;
    lmb_lightmap_file_name(number, has_own ? lmb_lightmap_kind(file.model) : NULL, name);
    cJSON *object = cJSON_AddObjectToObject(files, file.model->name);
    bool good = object && cJSON_AddStringToObject(object, "file", name) &&
                (file.channels.light_count <= 0 || cJSON_AddNumberToObject(object, "scale", (double)file_scale(&file)));
    if (good && file.model->irradiance_first && in_textures(lightmap, lightmap->model)) {
        lmb_lightmap_file_name(number, NULL, name);
        good = cJSON_AddStringToObject(object, "picture", name);
    }
    return good;
}

static bool json_add_image(cJSON *images, const lmb_lightmap *lightmap, int32_t number)
{
    char name[LMB_LIGHTMAP_FILE_NAME];
    lmb_lightmap_textures_picture(lightmap, number, name);
    const lmb_lightmap_image *image = &lightmap->image[number];
    const image_file picture = picture_of(lightmap, number);
    cJSON *object = cJSON_CreateObject();
    bool good = cJSON_AddItemToArray(images, object) &&
                (!lightmap->model->irradiance_first || cJSON_AddStringToObject(object, "file", name)) &&
                cJSON_AddNumberToObject(object, "width", image->width) &&
                cJSON_AddNumberToObject(object, "height", image->height) &&
                cJSON_AddNumberToObject(object, "scale", (double)file_scale(&picture));
    cJSON *files = good ? cJSON_AddObjectToObject(object, "models") : NULL;
    good = files != NULL;
    for (int k = 0; good && k < model_count(lightmap); ++k) {
        good = json_add_file(files, lightmap, number, k - 1);
    }
    if (good && lightmap->key_light_count > 0) {
        lmb_lightmap_textures_keys_name(lightmap, number, name);
        good = cJSON_AddStringToObject(object, "key_lights", name);
    }
    if (good && image->error) {
        lmb_lightmap_file_name(number, ERROR_KIND, name);
        good = cJSON_AddStringToObject(object, "error", name);
    }
    return good;
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

/* By parts, the names of a model's channels: the first three of irradiance in the picture, all others in the model's
 * own file. */
static bool json_add_channels(cJSON *models, const lmb_model *model)
{
    const lmb_lightmap_channels picture = lmb_lightmap_picture_channels(), own = lmb_lightmap_model_channels(model);
    cJSON *parts = cJSON_AddObjectToObject(models, model->name);
    bool good = parts != NULL;
    int first = 0;
    for (const lmb_model_part *part = model->part; good && part->count > 0; first += part->count, ++part) {
        const char *const *name = first < own.first ? &picture.name[first] : &own.name[first - own.first];
        good = cJSON_AddItemToObject(parts, part->name, cJSON_CreateStringArray(name, part->count));
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
    const lmb_lightmap_channels which = lmb_lightmap_key_channels(lightmap);
    cJSON *list = which.count > 0 ? cJSON_AddArrayToObject(root, "key_lights") : NULL;
    bool good = list || which.count == 0;
    for (int key = 0; good && key < which.count; ++key) {
        good = json_add_key_light(list, which.name[key], &lightmap->key_light[key]);
    }
    return good;
}

/* lightmap.json as text, for cJSON_free; NULL when out of memory. */
static char *json_print(const lmb_lightmap *lightmap)
{
    cJSON *root = cJSON_CreateObject();
    bool good =
        cJSON_AddStringToObject(root, "format", LMB_LIGHTMAP_FORMAT_NAME) &&
        cJSON_AddNumberToObject(root, "version", lmb_lightmap_format_version(lightmap)) &&
        cJSON_AddStringToObject(root, "encoding", lightmap->model->name) &&
        (lightmap->settings.format == LMB_LIGHTMAP_EXR ||
         cJSON_AddStringToObject(root, "image_format", lmb_lightmap_format_name(lightmap->settings.format))) &&
        cJSON_AddNumberToObject(root, "texels_per_m", (double)lightmap->settings.texels_per_m) &&
        cJSON_AddNumberToObject(root, "max_image_size", lightmap->settings.max_image_size) &&
        (lightmap->settings.padding == 1 || cJSON_AddNumberToObject(root, "padding", lightmap->settings.padding)) &&
        (any_charts(lightmap) ? cJSON_AddStringToObject(root, "uv_level", UV_LEVEL_NAME)
                              : cJSON_AddNullToObject(root, "uv_level"));
    cJSON *channels = cJSON_AddObjectToObject(root, "channels");
    good = good && channels;
    for (int k = 0; good && k < model_count(lightmap); ++k) {
        const lmb_model *model = k == 0 ? lightmap->model : lightmap->settings.other[k - 1];
        good = in_textures(lightmap, model) || json_add_channels(channels, model);
    }
    good = good && json_add_key_lights(root, lightmap);
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

typedef struct file_writer {
    const lmb_lightmap *lightmap;
    const char *directory;
    uint64_t bytes;
    lmb_error *error;
} file_writer;

/* The path of a file to be written; NULL: out of memory. */
static char *file_begin(file_writer *writer, const char *name)
{
    char *path = lmb_file_in(writer->directory, name);
    if (!path) {
        out_of_memory(writer->error);
    }
    return path;
}

/* Counts what was written there, if it was. */
static lmb_result file_end(file_writer *writer, lmb_result result, char *path)
{
    if (result == LMB_OK) {
        result = size_add(path, &writer->bytes, writer->error);
    }
    free(path);
    return result;
}

static lmb_result planes_write(file_writer *writer, const image_file *file, const char *name)
{
    char *path = file_begin(writer, name);
    return path ? file_end(writer, image_write(file, path, writer->error), path) : LMB_ERROR_MEMORY;
}

static lmb_result texture_write(file_writer *writer, int32_t number, const lmb_model *model, const float *plane,
                                const lmb_texture_part *part)
{
    char name[LMB_LIGHTMAP_FILE_NAME];
    lmb_lightmap_textures_name(writer->lightmap, model, part, number, name);
    char *path = file_begin(writer, name);
    return path
               ? file_end(writer,
                          lmb_lightmap_textures_write(writer->lightmap, number, plane, part, path, writer->error), path)
               : LMB_ERROR_MEMORY;
}

/* What an image has of a model: the lightmap's own, -1, or another one. */
static lmb_result model_write(file_writer *writer, int32_t number, int other)
{
    const image_file file = model_of(writer->lightmap, number, other);
    if (!in_textures(writer->lightmap, file.model)) {
        char name[LMB_LIGHTMAP_FILE_NAME];
        lmb_lightmap_file_name(number, lmb_lightmap_kind(file.model), name);
        return file.channels.count > 0 ? planes_write(writer, &file, name) : LMB_OK;
    }
    lmb_texture_part parts[LMB_TEXTURE_MOST_PARTS];
    const int count = lmb_lightmap_textures_parts(file.model, writer->lightmap->settings.format, parts);
    lmb_result result = LMB_OK;
    for (int i = 0; i < count && result == LMB_OK; ++i) {
        result = texture_write(writer, number, file.model, file.plane, &parts[i]);
    }
    return result;
}

static lmb_result key_file_write(file_writer *writer, int32_t number)
{
    const lmb_lightmap *lightmap = writer->lightmap;
    const lmb_lightmap_image *image = &lightmap->image[number];
    if (lightmap->settings.format != LMB_LIGHTMAP_EXR) {
        const lmb_texture_part part = lmb_lightmap_textures_keys(lightmap);
        return texture_write(writer, number, lightmap->model, image->plane, &part);
    }
    char name[LMB_LIGHTMAP_FILE_NAME];
    lmb_lightmap_file_name(number, LMB_LIGHTMAP_KEYS_KIND, name);
    char *path = file_begin(writer, name);
    return path ? file_end(writer, keys_write(lightmap, image, path, writer->error), path) : LMB_ERROR_MEMORY;
}

/* An image's picture, models, key lights and error. */
static lmb_result image_files_write(file_writer *writer, int32_t number)
{
    const lmb_lightmap *lightmap = writer->lightmap;
    char name[LMB_LIGHTMAP_FILE_NAME];
    lmb_lightmap_file_name(number, NULL, name);
    const int owner = picture_model(lightmap, number);
    lmb_result result = LMB_OK;
    if (owner != NO_PICTURE) {
        image_file picture = model_of(lightmap, number, owner);
        picture.channels = lmb_lightmap_picture_channels();
        result = planes_write(writer, &picture, name);
    }
    for (int k = 0; result == LMB_OK && k < model_count(lightmap); ++k) {
        result = model_write(writer, number, k - 1);
    }
    if (result == LMB_OK && lightmap->key_light_count > 0) {
        result = key_file_write(writer, number);
    }
    if (result == LMB_OK && lightmap->image[number].error) {
        lmb_lightmap_file_name(number, ERROR_KIND, name);
        char *path = file_begin(writer, name);
        result = path ? file_end(writer, error_write(lightmap, &lightmap->image[number], path, writer->error), path)
                      : LMB_ERROR_MEMORY;
    }
    return result;
}

lmb_result lmb_lightmap_write(const lmb_lightmap *lightmap, const char *directory, const lmb_gltf_options *options,
                              uint64_t *bytes, lmb_error *error)
{
    file_writer writer = {lightmap, directory, 0, error};
    lmb_result result = LMB_OK;
    for (int32_t i = 0; i < lightmap->image_count && result == LMB_OK; ++i) {
        result = image_files_write(&writer, i);
    }
    if (result == LMB_OK && any_charts(lightmap)) {
        char *path = file_begin(&writer, UV_LEVEL_NAME);
        result = path ? file_end(&writer, uv_level_write(lightmap, path, options, error), path) : LMB_ERROR_MEMORY;
    }
    /* Last: who finds it, finds the files that it names. */
    if (result == LMB_OK) {
        char *path = file_begin(&writer, LMB_LIGHTMAP_JSON_NAME);
        result = path ? file_end(&writer, json_write(lightmap, path, error), path) : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        *bytes = writer.bytes;
    }
    return result;
}
