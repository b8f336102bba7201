#include "run/bake_key.h"

#include <string.h>

#include <cjson/cJSON.h>

#include <lambent/file.h>
#include <lambent/version.h>
#include <lambent/volume_format.h>

#include "lightmap/lightmap_files.h"
#include "run/bake_settings_internal.h"

uint64_t lmb_bake_key(const lmb_bake_settings *settings, uint64_t content_hash)
{
    cJSON *const json = lmb_bake_settings_json(settings, content_hash);
    cJSON_DeleteItemFromObject(json, "level"); /* where a file lies does not matter: what is in it is hashed */
    char *const text = cJSON_PrintUnformatted(json);
    uint64_t key = 0;
    if (text) {
        const uint32_t formats[2] = {LMB_VOLUME_VERSION, LMB_LIGHTMAP_FORMAT_VERSION};
        key = lmb_hash(LMB_HASH_SEED, lmb_version_text(), strlen(lmb_version_text()));
        key = lmb_hash(key, formats, sizeof formats);
        key = lmb_hash(key, text, strlen(text));
        key = key == 0 ? 1 : key;
    }
    cJSON_free(text);
    cJSON_Delete(json);
    return key;
}

uint64_t lmb_bake_part_key(uint64_t key, const lmb_vec3d box[2])
{
    return lmb_hash(key, box, 2 * sizeof *box);
}
