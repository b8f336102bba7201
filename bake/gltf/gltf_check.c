#include "gltf/gltf_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_accessor.h"
#include "gltf/gltf_extensions.h"
#include "gltf/gltf_json.h"
#include "gltf/gltf_schema.h"

enum { SIGNED_INT = 5124 }; /* a component type that glTF 2.0 has not */

#define FAIL(error, ...) lmb_error_set(error, LMB_ERROR_FORMAT, __VA_ARGS__)

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Of two properties of one name every reader picks another. Depth is bounded by cJSON's nesting limit. */
static lmb_result check_unique(const lmb_gltf_file *file, const cJSON *item, lmb_error *error)
{
    const size_t count = (size_t)cJSON_GetArraySize(item);
    const cJSON *child;
    if (cJSON_IsObject(item) && count > 1) {
        const char **const names = malloc(count * sizeof *names);
        if (!names) {
            return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
        }
        size_t used = 0;
        cJSON_ArrayForEach(child, item)
        {
            names[used++] = child->string;
        }
        qsort(names, used, sizeof *names, compare_names);
        const char *twice = NULL;
        for (size_t i = 1; i < used; ++i) {
            twice = strcmp(names[i - 1], names[i]) == 0 ? names[i] : twice;
        }
        free(names);
        if (twice) {
            return FAIL(error, "%s: \"%s\" twice in one object", file->path, twice);
        }
    }
    cJSON_ArrayForEach(child, item)
    {
        const lmb_result result =
            cJSON_IsObject(child) || cJSON_IsArray(child) ? check_unique(file, child, error) : LMB_OK;
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

/* "major.minor". @return false when the text is not that */
static bool parse_version(const char *text, unsigned *major, unsigned *minor)
{
    int used = 0;
    return sscanf(text, "%3u.%3u%n", major, minor, &used) == 2 && text[used] == '\0' && strchr(text, '-') == NULL;
}

static lmb_result check_version(const lmb_gltf_file *file, const cJSON *asset, const char *name, lmb_error *error)
{
    const char *const text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(asset, name));
    if (!text) {
        return LMB_OK; /* the table says whether it must be there */
    }
    unsigned major, minor;
    if (!parse_version(text, &major, &minor)) {
        return FAIL(error, "%s: asset.%s: \"%s\" is not a version", file->path, name, text);
    }
    const bool minimum = strcmp(name, "minVersion") == 0;
    if (major != 2 || (minimum && minor > 0)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: asset.%s: glTF %s, not 2.0", file->path, name, text);
    }
    return LMB_OK;
}

static lmb_result check_required_extensions(const lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(file->root, "extensionsRequired"))
    {
        if (cJSON_IsString(item) && !lmb_gltf_extension_may_be_required(item->valuestring)) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: extensionsRequired: %s is not supported",
                                 file->path, item->valuestring);
        }
    }
    return LMB_OK;
}

static bool is_one_of(const char *text, const char *const *words, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (strcmp(text, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

/* Words and sums that the table cannot say. */
static lmb_result check_words(const lmb_gltf_file *file, lmb_error *error)
{
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    static const char *const lights[] = {"point", "spot", "directional"};
    static const char *const alpha[] = {"OPAQUE", "MASK", "BLEND"};
    const struct {
        const cJSON *list;
        const char *name, *property;
        const char *const *words;
        size_t count;
    } sets[] = {
        {cJSON_GetObjectItemCaseSensitive(file->root, "accessors"), "accessors", "type", types, 7},
        {cJSON_GetObjectItemCaseSensitive(file->root, "materials"), "materials", "alphaMode", alpha, 3},
        {cJSON_GetObjectItemCaseSensitive(lmb_gltf_extension(file->root, "KHR_lights_punctual"), "lights"), "lights",
         "type", lights, 3},
    };
    for (size_t s = 0; s < sizeof sets / sizeof *sets; ++s) {
        unsigned index = 0;
        const cJSON *item;
        cJSON_ArrayForEach(item, sets[s].list)
        {
            const char *const text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, sets[s].property));
            if (text && !is_one_of(text, sets[s].words, sets[s].count)) {
                return FAIL(error, "%s: %s[%u].%s: \"%s\" is unknown", file->path, sets[s].name, index,
                            sets[s].property, text);
            }
            ++index;
        }
    }
    return LMB_OK;
}

static lmb_result check_component_types(const lmb_gltf_file *file, lmb_error *error)
{
    unsigned index = 0;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(file->root, "accessors"))
    {
        const uint32_t type = lmb_gltf_uint(item, "componentType", 0);
        const cJSON *const sparse = cJSON_GetObjectItemCaseSensitive(item, "sparse");
        const uint32_t index_type =
            lmb_gltf_uint(cJSON_GetObjectItemCaseSensitive(sparse, "indices"), "componentType", LMB_GLTF_UNSIGNED_INT);
        if (type == SIGNED_INT || index_type == LMB_GLTF_SHORT || index_type == SIGNED_INT) {
            return FAIL(error, "%s: accessors[%u]: a componentType that glTF 2.0 has not", file->path, index);
        }
        ++index;
    }
    return LMB_OK;
}

lmb_result lmb_gltf_check_json(const lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *const asset = cJSON_GetObjectItemCaseSensitive(file->root, "asset");
    lmb_result result = check_unique(file, file->root, error);
    if (result == LMB_OK) {
        result = check_version(file, asset, "version", error);
    }
    if (result == LMB_OK) {
        result = check_version(file, asset, "minVersion", error);
    }
    if (result == LMB_OK) {
        result = check_required_extensions(file, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_check_schema(file, error);
    }
    if (result == LMB_OK) {
        result = check_words(file, error);
    }
    return result == LMB_OK ? check_component_types(file, error) : result;
}
