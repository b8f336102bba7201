#include <lambent/baked.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>
#include <lambent/tile_files.h>

#include "run/bake_settings_internal.h"

static lmb_result json_open(const char *directory, cJSON **json, lmb_error *error)
{
    char *path = lmb_file_in(directory, "bake.json");
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
    char *const path = lmb_file_in(directory, "probes.lmb"), *const index = lmb_file_in(directory, "probes.lmt");
    lmb_result result = path && index ? lmb_volume_open_file(path, volume) : LMB_ERROR_MEMORY;
    if (result == LMB_ERROR_IO && lmb_tile_files_is_index(index)) {
        lmb_error_set(error, result, "%s: is wanted undivided, not in tiles: lambent pack probes.vdb makes it", path);
    } else if (result != LMB_OK) {
        lmb_error_set(error, result, "%s: %s", path ? path : directory, lmb_result_text(result));
    }
    free(index);
    free(path);
    return result;
}

static lmb_result lightmap_open(const char *directory, lmb_baked *opened, lmb_error *error)
{
    const lmb_bake_settings *settings = &opened->settings;
    if (!settings->lightmaps) {
        return LMB_OK;
    }
    if (!(settings->texels_per_m > 0.0f) || settings->max_image_size <= 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s/bake.json: no lightmap settings", directory);
    }
    const lmb_lightmap_settings lightmap = {.texels_per_m = settings->texels_per_m,
                                            .max_image_size = settings->max_image_size,
                                            .padding = settings->padding,
                                            .format = settings->lightmap_format,
                                            .pool = opened->level.pool};
    lmb_result result = lmb_lightmap_create(opened->level.scene, &lightmap, &opened->lightmap, error);
    char *path = result == LMB_OK ? lmb_file_in(directory, "lightmap") : NULL;
    if (result == LMB_OK) {
        result = path ? lmb_lightmap_read(opened->lightmap, path, error)
                      : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    free(path);
    return result;
}

/* Refuses a level that is not the one baked. */
static lmb_result content_check(const lmb_baked *opened, const char *directory, lmb_error *error)
{
    char hash[17];
    lmb_bake_settings_hash_text(opened->level.scene->content_hash, hash);
    const cJSON *settings = cJSON_GetObjectItemCaseSensitive(opened->json, "settings");
    const char *baked_hash = cJSON_GetObjectItemCaseSensitive(settings, "content_hash")->valuestring;
    return strcmp(hash, baked_hash) == 0
               ? LMB_OK
               : lmb_error_set(error, LMB_ERROR_FORMAT,
                               "%s: not the level that %s was baked from (content %s, baked %.16s): bake again",
                               opened->level.settings.path, directory, hash, baked_hash);
}

/* `wanted` says what is not the bake's: path (NULL: the bake's too), threads, and what pictures need. */
static lmb_result level_open(const lmb_level_settings *wanted, lmb_baked *opened, lmb_error *error)
{
    lmb_level_settings settings = opened->settings.level;
    settings.path = wanted->path ? wanted->path : settings.path;
    settings.threads = wanted->threads;
    settings.view_node = wanted->view_node;
    settings.reflection = wanted->reflection;
    return lmb_level_open(&settings, NULL, NULL, &opened->level, error);
}

static lmb_result record_open(const char *directory, lmb_baked *opened, lmb_error *error)
{
    lmb_result result = json_open(directory, &opened->json, error);
    const cJSON *settings = cJSON_GetObjectItemCaseSensitive(opened->json, "settings");
    if (result == LMB_OK && !lmb_bake_settings_read(settings, &opened->settings)) {
        result =
            lmb_error_set(error, LMB_ERROR_FORMAT, "%s/bake.json: its settings are not those of a bake", directory);
    }
    return result;
}

lmb_result lmb_baked_open(const char *level_path, const char *directory, int threads, const lmb_baked_view *view,
                          lmb_baked *opened, lmb_error *error)
{
    const lmb_level_settings wanted = {.path = level_path,
                                       .threads = threads,
                                       .view_node = view ? view->node : NULL,
                                       .reflection = view && view->reflection};
    memset(opened, 0, sizeof *opened);
    lmb_result result = record_open(directory, opened, error);
    if (result == LMB_OK) {
        result = level_open(&wanted, opened, error);
    }
    if (result == LMB_OK) {
        result = content_check(opened, directory, error);
    }
    if (result == LMB_OK && !opened->settings.no_probes) {
        result = volume_open(directory, &opened->volume, error);
    }
    if (result == LMB_OK) {
        result = lightmap_open(directory, opened, error);
    }
    if (result != LMB_OK) {
        lmb_baked_close(opened);
    }
    return result;
}

lmb_result lmb_baked_need_probes(const lmb_baked *baked, const char *directory, lmb_error *error)
{
    return baked->volume
               ? LMB_OK
               : lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: was baked without probes (--no-probes)", directory);
}

lmb_result lmb_baked_read_model(lmb_baked *baked, const char *directory, const lmb_model *model, lmb_error *error)
{
    if (!baked->lightmap) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: has no lightmaps, of model '%s' or any", directory,
                             model->name);
    }
    if (baked->lightmap->model == model) {
        return LMB_OK;
    }
    char *path = lmb_file_in(directory, "lightmap");
    const lmb_result result = path ? lmb_lightmap_read_model(baked->lightmap, model, path, error)
                                   : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    free(path);
    return result;
}

void lmb_baked_close(lmb_baked *closed)
{
    lmb_lightmap_destroy(closed->lightmap);
    lmb_volume_close(closed->volume);
    lmb_level_close(&closed->level);
    cJSON_Delete(closed->json);
    memset(closed, 0, sizeof *closed);
}
