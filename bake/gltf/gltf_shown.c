/* What tinygltf gets to see of a file: the structure only. Bytes and pictures are read by lmb_gltf_file, and nobody
 * needs the rest. Written anew, so that it reads exactly what was checked. */
#include "gltf/gltf_shown.h"

#include <string.h>

static bool is_read_by_tinygltf(const char *name)
{
    static const char *const own[] = {"accessors", "animations", "buffers", "bufferViews", "cameras", "images"};
    for (size_t i = 0; i < sizeof own / sizeof *own; ++i) {
        if (strcmp(name, own[i]) == 0) {
            return false;
        }
    }
    return true;
}

/* The meshes without what tinygltf must not see: it refuses indices that are accessors without a buffer view. */
static cJSON *meshes_without_indices(const cJSON *meshes)
{
    cJSON *const copy = cJSON_Duplicate(meshes, true);
    cJSON *mesh, *primitive;
    cJSON_ArrayForEach(mesh, copy)
    {
        cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives"))
        {
            cJSON_DeleteItemFromObjectCaseSensitive(primitive, "indices");
        }
    }
    return copy;
}

char *lmb_gltf_text_for_tinygltf(const lmb_gltf_file *file)
{
    cJSON *const shown = cJSON_CreateObject();
    bool good = shown != NULL;
    cJSON *item;
    cJSON_ArrayForEach(item, file->root)
    {
        if (good && strcmp(item->string, "meshes") == 0) {
            cJSON *const meshes = meshes_without_indices(item);
            good = meshes && cJSON_AddItemToObject(shown, item->string, meshes);
        } else if (good && is_read_by_tinygltf(item->string)) {
            good = cJSON_AddItemReferenceToObject(shown, item->string, item);
        }
    }
    char *const text = good ? cJSON_PrintUnformatted(shown) : NULL;
    cJSON_Delete(shown);
    return text;
}
