#include "gltf/gltf_writer.h"

#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

/* A list of the root, made when it is not there. */
static cJSON *root_list(const lmb_gltf_writer *w, const char *name)
{
    cJSON *const list = cJSON_GetObjectItemCaseSensitive(w->file->root, name);
    return list ? list : cJSON_AddArrayToObject(w->file->root, name);
}

static bool items_collect(const lmb_gltf_writer *w, const char *name, lmb_gltf_items *list)
{
    cJSON *const array = cJSON_GetObjectItemCaseSensitive(w->file->root, name);
    list->items = calloc((size_t)cJSON_GetArraySize(array) + 1, sizeof *list->items);
    if (!list->items) {
        return false;
    }
    cJSON *item;
    cJSON_ArrayForEach(item, array)
    {
        list->items[list->count++] = item;
    }
    return true;
}

lmb_result lmb_gltf_writer_begin(lmb_gltf_writer *w)
{
    w->views = root_list(w, "bufferViews");
    w->accessors = root_list(w, "accessors");
    w->accessor_count = w->file->accessor_count;
    if (!w->views || !w->accessors || !items_collect(w, "accessors", &w->source_accessors) ||
        !items_collect(w, "meshes", &w->source_meshes) || !items_collect(w, "nodes", &w->source_nodes)) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    w->mesh_count = w->source_meshes.count;
    return LMB_OK;
}

void lmb_gltf_writer_free(lmb_gltf_writer *w)
{
    free(w->bytes);
    free(w->source_accessors.items);
    free(w->source_meshes.items);
    free(w->source_nodes.items);
}

lmb_result lmb_gltf_writer_out_of_memory(const lmb_gltf_writer *w)
{
    return lmb_error_set(w->error, LMB_ERROR_MEMORY, "%s: out of memory", w->file->path);
}

unsigned char *lmb_gltf_append_bytes(lmb_gltf_writer *w, size_t size, size_t *offset)
{
    const size_t start = (w->size + 3) / 4 * 4;
    if (size > LMB_GLTF_MAX_SIZE || start > LMB_GLTF_MAX_SIZE - size) {
        return NULL;
    }
    if (start + size > w->capacity) {
        const size_t capacity = (start + size) + (start + size) / 2 + 64;
        unsigned char *const larger = realloc(w->bytes, capacity);
        if (!larger) {
            return NULL;
        }
        w->bytes = larger;
        w->capacity = capacity;
    }
    memset(w->bytes + w->size, 0, start + size - w->size);
    w->size = start + size;
    *offset = start;
    return w->bytes + start;
}

bool lmb_gltf_set_number(cJSON *object, const char *name, double value)
{
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
    return cJSON_AddNumberToObject(object, name, value) != NULL;
}

int64_t lmb_gltf_add_view(lmb_gltf_writer *w, lmb_gltf_range range)
{
    cJSON *const view = cJSON_CreateObject();
    if (!view || !cJSON_AddItemToArray(w->views, view)) {
        cJSON_Delete(view);
        return -1;
    }
    const bool made = lmb_gltf_set_number(view, "buffer", 0) &&
                      lmb_gltf_set_number(view, "byteOffset", (double)range.offset) &&
                      lmb_gltf_set_number(view, "byteLength", (double)range.size) &&
                      (range.stride == 0 || lmb_gltf_set_number(view, "byteStride", (double)range.stride)) &&
                      (range.target == 0 || lmb_gltf_set_number(view, "target", range.target));
    return made ? (int64_t)w->view_count++ : -1;
}

int64_t lmb_gltf_add_accessor(lmb_gltf_writer *w, cJSON *accessor, int64_t view, uint32_t count)
{
    const bool made = accessor && view >= 0 && lmb_gltf_set_number(accessor, "bufferView", (double)view) &&
                      lmb_gltf_set_number(accessor, "count", count);
    if (!made || !cJSON_AddItemToArray(w->accessors, accessor)) {
        cJSON_Delete(accessor);
        return -1;
    }
    return w->accessor_count++;
}

cJSON *lmb_gltf_new_accessor(int component_type, const char *type)
{
    cJSON *const accessor = cJSON_CreateObject();
    if (!accessor || !lmb_gltf_set_number(accessor, "componentType", component_type) ||
        !cJSON_AddStringToObject(accessor, "type", type)) {
        cJSON_Delete(accessor);
        return NULL;
    }
    return accessor;
}

/* What is empty is not allowed: neither a buffer of no bytes nor a list. */
static bool finish_lists(lmb_gltf_writer *w)
{
    cJSON *const root = w->file->root;
    cJSON_DeleteItemFromObjectCaseSensitive(root, "buffers");
    if (w->view_count == 0) {
        cJSON_DeleteItemFromObjectCaseSensitive(root, "bufferViews");
    }
    if (w->accessor_count == 0) {
        cJSON_DeleteItemFromObjectCaseSensitive(root, "accessors");
    }
    if (w->size == 0) {
        return true;
    }
    cJSON *const buffers = cJSON_AddArrayToObject(root, "buffers"), *const buffer = cJSON_CreateObject();
    if (!buffers || !buffer || !cJSON_AddItemToArray(buffers, buffer)) {
        cJSON_Delete(buffer);
        return false;
    }
    const size_t padded = (w->size + 3) / 4 * 4;
    return lmb_gltf_set_number(buffer, "byteLength", (double)padded);
}

lmb_result lmb_gltf_write_glb(lmb_gltf_writer *w, const char *path)
{
    char *const json = finish_lists(w) ? cJSON_PrintUnformatted(w->file->root) : NULL;
    size_t size;
    unsigned char *const glb =
        json ? lmb_gltf_container_join(json, (lmb_gltf_bytes){w->bytes, w->size, NULL}, &size) : NULL;
    cJSON_free(json);
    if (!glb) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    const lmb_result result = lmb_file_write(path, glb, size, w->error);
    free(glb);
    return result;
}
