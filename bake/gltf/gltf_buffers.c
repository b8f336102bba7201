#include "gltf/gltf_buffers.h"

#include <stdlib.h>

#include "gltf/gltf_json.h"
#include "gltf/gltf_uri.h"

lmb_result lmb_gltf_buffers_read(lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(file->root, "buffers");
    const int count = cJSON_GetArraySize(list);
    file->buffers = calloc((size_t)count + 1, sizeof *file->buffers);
    if (!file->buffers) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        lmb_gltf_bytes *const buffer = &file->buffers[file->buffer_count];
        const cJSON *const uri = cJSON_GetObjectItemCaseSensitive(item, "uri");
        const size_t length = lmb_gltf_uint(item, "byteLength", 0);
        char where[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(where, "buffers[%u]", file->buffer_count);
        if (uri) {
            const lmb_result result = lmb_gltf_uri_read(file, uri->valuestring, where, buffer, error);
            if (result != LMB_OK) {
                return result;
            }
        } else if (file->buffer_count == 0 && file->bin.data) {
            *buffer = file->bin;
        } else {
            *buffer = (lmb_gltf_bytes){NULL, length, NULL}; /* legal as long as nobody reads it */
        }
        ++file->buffer_count;
        if (buffer->size < length) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: byteLength %zu, but %zu bytes are there", file->path,
                                 where, length, buffer->size);
        }
        buffer->size = length;
    }
    return LMB_OK;
}

lmb_result lmb_gltf_views_resolve(lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(file->root, "bufferViews");
    file->views = calloc((size_t)cJSON_GetArraySize(list) + 1, sizeof *file->views);
    if (!file->views) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        const size_t size = file->buffers[lmb_gltf_uint(item, "buffer", 0)].size;
        const size_t offset = lmb_gltf_uint(item, "byteOffset", 0);
        const size_t length = lmb_gltf_uint(item, "byteLength", 0);
        if (offset > size || length > size - offset) {
            return lmb_error_set(error, LMB_ERROR_FORMAT,
                                 "%s: bufferViews[%u]: bytes %zu to %zu leave buffers[%u] of %zu bytes", file->path,
                                 file->view_count, offset, offset + length, lmb_gltf_uint(item, "buffer", 0), size);
        }
        file->views[file->view_count++] = item;
    }
    return LMB_OK;
}

lmb_gltf_bytes lmb_gltf_view_bytes(const lmb_gltf_file *file, uint32_t view)
{
    const lmb_gltf_bytes *const buffer = &file->buffers[lmb_gltf_uint(file->views[view], "buffer", 0)];
    const size_t offset = lmb_gltf_uint(file->views[view], "byteOffset", 0);
    return (lmb_gltf_bytes){buffer->data ? buffer->data + offset : NULL,
                            lmb_gltf_uint(file->views[view], "byteLength", 0), NULL};
}
