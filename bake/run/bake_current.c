#include "run/bake_current.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include "run/bake_settings_internal.h"

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

bool lmb_bake_is_current(const char *directory, uint64_t key)
{
    char *const path = lmb_file_in(directory, "bake.json");
    unsigned char *text = NULL;
    size_t size = 0;
    cJSON *const record = path && lmb_file_read(path, &text, &size, NULL) == LMB_OK
                              ? cJSON_ParseWithLength((const char *)text, size)
                              : NULL;
    char wanted[17];
    lmb_bake_settings_hash_text(key, wanted);
    const char *const own = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(record, "key"));
    const cJSON *const hashes = cJSON_GetObjectItemCaseSensitive(record, "hashes");
    bool current = own && strcmp(own, wanted) == 0 && cJSON_GetArraySize(hashes) > 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, hashes)
    {
        char found[17];
        current = current && cJSON_IsString(item) && file_hash(directory, item->string, found) &&
                  strcmp(found, item->valuestring) == 0;
    }
    cJSON_Delete(record);
    free(text);
    free(path);
    return current;
}
