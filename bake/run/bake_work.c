#include "run/bake_work.h"

#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>

#include "run/bake_current.h"
#include "run/bake_folder_internal.h"
#include "run/bake_key.h"
#include "run/bake_settings_internal.h"
#include "run/prepared.h"

#define SHARD_NAME "shard.json"

/* Seconds of work that an interruption may cost. */
#define SECONDS_BETWEEN_PARTS 1.0

bool lmb_bake_work_is_done(const lmb_bake_work *work, const lmb_bake_folder *folder, uint64_t key)
{
    const char *const directory = lmb_bake_folder_directory(folder);
    if (work->again || lmb_bake_work_is_shard(work)) {
        return false;
    }
    if (work->prepare) {
        return lmb_bake_prepared_is_current(directory, key);
    }
    return lmb_bake_is_current(directory, key, work->keep) ||
           (work->only && lmb_bake_is_current(directory, lmb_bake_part_key(key, work->only), true));
}

void lmb_bake_parts_free(lmb_parts *parts)
{
    for (uint32_t i = 0; i < parts->read_count; ++i) {
        free((char *)parts->read_from[i]);
    }
    free((void *)parts->read_from);
    free((char *)parts->write_to);
    *parts = (lmb_parts){0};
}

lmb_result lmb_bake_parts_make(const lmb_bake_work *work, const lmb_bake_folder *folder, uint64_t key, lmb_parts *parts)
{
    const char *const own = lmb_bake_folder_directory(folder);
    const char **const from = calloc((size_t)work->from_count + 1, sizeof *from);
    *parts = (lmb_parts){.key = key,
                         .read_from = from,
                         .write_to = lmb_file_in(own, LMB_PARTS_NAME),
                         .seconds = SECONDS_BETWEEN_PARTS,
                         .shard = work->shard,
                         .shard_count = work->shard_count,
                         .read_only = work->merge};
    bool good = from && parts->write_to;
    for (uint32_t i = 0; from && i < work->from_count + (work->resume ? 1u : 0u); ++i) {
        from[i] = lmb_file_in(i < work->from_count ? work->from[i] : own, LMB_PARTS_NAME);
        good = good && from[i];
        parts->read_count = i + 1;
    }
    if (!good) {
        lmb_bake_parts_free(parts);
    }
    return good ? LMB_OK : LMB_ERROR_MEMORY;
}

lmb_result lmb_bake_shard_write(const lmb_bake_settings *settings, const lmb_bake_work *work,
                                const lmb_bake_folder *folder, uint64_t content_hash, lmb_error *error)
{
    cJSON *const json = cJSON_CreateObject();
    cJSON_AddNumberToObject(json, "shard", work->shard + 1.0);
    cJSON_AddNumberToObject(json, "shards", work->shard_count);
    cJSON_AddItemToObject(json, "settings", lmb_bake_settings_json(settings, content_hash));
    char *const text = cJSON_Print(json);
    char *const path = lmb_file_in(lmb_bake_folder_directory(folder), SHARD_NAME);
    const lmb_result result = text && path ? lmb_file_write(path, text, strlen(text), error)
                                           : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    free(path);
    cJSON_free(text);
    cJSON_Delete(json);
    return result;
}

lmb_result lmb_bake_shard_settings(const char *directory, struct cJSON **json, lmb_bake_settings *settings,
                                   lmb_error *error)
{
    char *const path = lmb_file_in(directory, SHARD_NAME);
    unsigned char *text = NULL;
    size_t size = 0;
    *json = NULL;
    lmb_result result =
        path ? lmb_file_read(path, &text, &size, error) : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK) {
        *json = cJSON_ParseWithLength((const char *)text, size);
        if (!lmb_bake_settings_read(cJSON_GetObjectItemCaseSensitive(*json, "settings"), settings)) {
            result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not the record of a shard", path);
            cJSON_Delete(*json);
            *json = NULL;
        }
    }
    free(text);
    free(path);
    return result;
}
