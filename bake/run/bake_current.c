#include "run/bake_current.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "run/bake_settings_internal.h"
#include "run/kept.h"

/* As text; false when it cannot be read. */
static bool file_hash(const char *directory, const char *name, char text[17])
{
    char *const path = lmb_file_in(directory, name);
    unsigned char *data = NULL;
    size_t size = 0;
    const bool read = path && lmb_file_read(path, &data, &size, NULL) == LMB_OK;
    if (read) {
        lmb_bake_settings_hash_text(lmb_hash(LMB_HASH_SEED, data, size), text);
    }
    free(data);
    free(path);
    return read;
}

cJSON *lmb_bake_hashes(const char *directory, const cJSON *files)
{
    cJSON *const hashes = cJSON_CreateObject();
    bool good = hashes != NULL;
    const cJSON *item;
    cJSON_ArrayForEach(item, files)
    {
        char text[17];
        good = good && file_hash(directory, item->valuestring, text) &&
               cJSON_AddStringToObject(hashes, item->valuestring, text);
    }
    if (!good) {
        cJSON_Delete(hashes);
    }
    return good ? hashes : NULL;
}

/* The record that lies in a folder; NULL where there is none. */
static cJSON *record_read(const char *directory)
{
    char *const path = lmb_file_in(directory, "bake.json");
    unsigned char *text = NULL;
    size_t size = 0;
    cJSON *const record = path && lmb_file_read(path, &text, &size, NULL) == LMB_OK
                              ? cJSON_ParseWithLength((const char *)text, size)
                              : NULL;
    free(text);
    free(path);
    return record;
}

static bool text_is(const cJSON *object, const char *name, const char *wanted)
{
    const char *const own = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
    return own && strcmp(own, wanted) == 0;
}

bool lmb_bake_is_current(const char *directory, uint64_t key, bool kept)
{
    cJSON *const record = record_read(directory);
    char wanted[17];
    lmb_bake_settings_hash_text(key, wanted);
    const cJSON *const hashes = cJSON_GetObjectItemCaseSensitive(record, "hashes");
    bool current = text_is(record, "key", wanted) && cJSON_GetArraySize(hashes) > 0;
    if (kept) {
        current = current &&
                  (cJSON_HasObjectItem(hashes, LMB_KEPT_PROBES) || cJSON_HasObjectItem(hashes, LMB_KEPT_LIGHTMAPS));
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, hashes)
    {
        char found[17];
        current = current && cJSON_IsString(item) && file_hash(directory, item->string, found) &&
                  strcmp(found, item->valuestring) == 0;
    }
    cJSON_Delete(record);
    return current;
}

void lmb_bake_changes(const char *directory, const lmb_bake_record *record, char *text, size_t size)
{
    cJSON *const earlier = record_read(directory);
    const cJSON *const content = cJSON_GetObjectItemCaseSensitive(earlier, "content");
    const bool is_ours =
        content && text_is(cJSON_GetObjectItemCaseSensitive(earlier, "settings"), "level", record->settings.level.path);
    size_t length = 0;
    text[0] = '\0';
    for (int part = 0; part < LMB_SCENE_PARTS && is_ours; ++part) {
        const char *const name = lmb_scene_part_name((lmb_scene_part)part);
        char hash[17];
        lmb_bake_settings_hash_text(record->content[part], hash);
        if (!text_is(content, name, hash) && length < size) {
            length += (size_t)snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "", name);
        }
    }
    cJSON_Delete(earlier);
}
