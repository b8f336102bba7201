#include "baked.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "bake_settings.h"

/* DIR/NAME in malloc'ed memory. */
static char *path_join(const char *directory, const char *name)
{
    const size_t size = strlen(directory) + strlen(name) + 2;
    char *path = malloc(size);
    if (path) {
        snprintf(path, size, "%s/%s", directory, name);
    }
    return path;
}

static lmb_result json_open(const char *directory, cJSON **json, lmb_error *error)
{
    char *path = path_join(directory, "bake.json");
    unsigned char *text = NULL;
    size_t size;
    lmb_result result =
        path ? lmb_file_read(path, &text, &size, error) : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK) {
        *json = cJSON_ParseWithLength((const char *)text, size);
        if (!cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(*json, "settings"))) {
            result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not the record of a bake", path);
        }
    }
    free(text);
    free(path);
    return result;
}

static lmb_result volume_open(const char *directory, lmb_volume **volume, lmb_error *error)
{
    char *path = path_join(directory, "probes.lmb");
    if (!path) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    lmb_result result = lmb_volume_open_file(path, volume);
    if (result != LMB_OK) {
        lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
    }
    free(path);
    return result;
}

static lmb_result lightmap_open(const char *directory, const cJSON *settings, lmb_baked *opened, lmb_error *error)
{
    if (!cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(settings, "lightmaps"))) {
        return LMB_OK;
    }
    const cJSON *density = cJSON_GetObjectItemCaseSensitive(settings, "texels_per_m");
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(settings, "max_image_size");
    if (!cJSON_IsNumber(density) || !cJSON_IsNumber(size)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s/bake.json: no lightmap settings", directory);
    }
    const cJSON *padding = cJSON_GetObjectItemCaseSensitive(settings, "padding"); /* none: 1 */
    const lmb_lightmap_settings lightmap = {.texels_per_m = (float)density->valuedouble,
                                            .max_image_size = size->valueint,
                                            .padding = cJSON_IsNumber(padding) ? padding->valueint : 0};
    lmb_result result = lmb_lightmap_create(opened->level.scene, &lightmap, &opened->lightmap, error);
    char *path = result == LMB_OK ? path_join(directory, "lightmap") : NULL;
    if (result == LMB_OK) {
        result = path ? lmb_lightmap_read(opened->lightmap, path, error)
                      : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    free(path);
    return result;
}

/* `wanted` says what is not the bake's: path (NULL: the bake's too), threads, view node. */
static lmb_result baked_level_open(const lmb_level_options *wanted, const char *directory, const cJSON *settings,
                                   lmb_level *opened, lmb_error *error)
{
    lmb_level_arguments arguments;
    if (!bake_settings_level(settings, &arguments)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s/bake.json: its settings are not those of a bake", directory);
    }
    arguments.options.path = wanted->path ? wanted->path : arguments.options.path;
    arguments.options.threads = wanted->threads;
    arguments.options.gltf.view_node = wanted->gltf.view_node;
    arguments.options.quiet = true;
    const lmb_result result = level_open(&arguments.options, opened, error);
    if (result != LMB_OK) {
        return result;
    }
    char hash[17];
    hash_text(opened->scene->content_hash, hash);
    const char *baked_hash = cJSON_GetObjectItemCaseSensitive(settings, "content_hash")->valuestring;
    if (strcmp(hash, baked_hash) != 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "%s: not the level that %s was baked from (content %s, baked %.16s): bake again",
                             arguments.options.path, directory, hash, baked_hash);
    }
    /* The patterns lived in this call; nothing reads them after loading. */
    opened->options.gltf = (lmb_gltf_options){0};
    return LMB_OK;
}

lmb_result baked_open(const char *level_path, const char *directory, int threads, const char *view_node,
                      lmb_baked *opened, lmb_error *error)
{
    const lmb_level_options wanted = {.path = level_path, .threads = threads, .gltf = {.view_node = view_node}};
    memset(opened, 0, sizeof *opened);
    lmb_result result = json_open(directory, &opened->json, error);
    const cJSON *settings = cJSON_GetObjectItemCaseSensitive(opened->json, "settings");
    if (result == LMB_OK) {
        result = baked_level_open(&wanted, directory, settings, &opened->level, error);
    }
    if (result == LMB_OK) {
        result = volume_open(directory, &opened->volume, error);
    }
    if (result == LMB_OK) {
        result = lightmap_open(directory, settings, opened, error);
    }
    if (result != LMB_OK) {
        baked_close(opened);
    }
    return result;
}

void baked_close(lmb_baked *closed)
{
    lmb_lightmap_destroy(closed->lightmap);
    lmb_volume_close(closed->volume);
    level_close(&closed->level);
    cJSON_Delete(closed->json);
    memset(closed, 0, sizeof *closed);
}
