#include "gltf/gltf_embed.h"

#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_image.h"
#include "gltf/gltf_json.h"

lmb_result lmb_gltf_embed_buffers(lmb_gltf_writer *w)
{
    size_t *const bases = calloc((size_t)w->file->buffer_count + 1, sizeof *bases);
    if (!bases) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < w->file->buffer_count && result == LMB_OK; ++i) {
        const lmb_gltf_bytes *const buffer = &w->file->buffers[i];
        if (!buffer->data && buffer->size > 0) {
            result = lmb_error_set(w->error, LMB_ERROR_FORMAT, "%s: buffers[%u]: neither a uri nor a binary chunk",
                                   w->file->path, i);
            break;
        }
        unsigned char *const to = lmb_gltf_append_bytes(w, buffer->size, &bases[i]);
        if (!to && buffer->size > 0) {
            result = lmb_gltf_writer_out_of_memory(w);
        } else if (buffer->size > 0) {
            memcpy(to, buffer->data, buffer->size);
        }
    }
    cJSON *view;
    cJSON_ArrayForEach(view, w->views)
    {
        if (result != LMB_OK) {
            break;
        }
        const double offset = lmb_gltf_uint(view, "byteOffset", 0) + (double)bases[lmb_gltf_uint(view, "buffer", 0)];
        /* Its fallback, which is what was read, is now the only form. */
        cJSON_DeleteItemFromObjectCaseSensitive(cJSON_GetObjectItemCaseSensitive(view, "extensions"),
                                                "EXT_meshopt_compression");
        if (!lmb_gltf_set_number(view, "buffer", 0) || !lmb_gltf_set_number(view, "byteOffset", offset)) {
            result = lmb_gltf_writer_out_of_memory(w);
        }
        ++w->view_count;
    }
    free(bases);
    return result;
}

static const char *mime_type(const lmb_gltf_bytes *bytes)
{
    static const struct {
        const char *type;
        size_t at, size;
        unsigned char magic[8];
    } types[] = {{"image/png", 0, 4, {0x89, 'P', 'N', 'G'}},
                 {"image/jpeg", 0, 3, {0xff, 0xd8, 0xff}},
                 {"image/webp", 8, 4, {'W', 'E', 'B', 'P'}},
                 {"image/ktx2", 1, 6, {'K', 'T', 'X', ' ', '2', '0'}}};
    for (size_t i = 0; i < sizeof types / sizeof *types; ++i) {
        if (bytes->size >= types[i].at + types[i].size &&
            memcmp(bytes->data + types[i].at, types[i].magic, types[i].size) == 0) {
            return types[i].type;
        }
    }
    return "application/octet-stream";
}

lmb_result lmb_gltf_embed_images(lmb_gltf_writer *w)
{
    uint32_t index = 0;
    cJSON *image;
    cJSON_ArrayForEach(image, cJSON_GetObjectItemCaseSensitive(w->file->root, "images"))
    {
        if (!cJSON_GetObjectItemCaseSensitive(image, "uri")) {
            ++index;
            continue;
        }
        lmb_gltf_bytes bytes;
        lmb_error reason;
        const lmb_result result = lmb_gltf_image_read(w->file, image, index++, &bytes, NULL, &reason);
        if (result == LMB_ERROR_MEMORY) {
            return lmb_gltf_writer_out_of_memory(w);
        }
        if (result != LMB_OK) {
            /* Nothing that is read needs it, else the level would not have loaded. */
            lmb_warn(w->warnings, "%s; the level with new UVs only refers to it", reason.message);
            continue;
        }
        size_t offset;
        unsigned char *const to = lmb_gltf_append_bytes(w, bytes.size, &offset);
        const int64_t view = to ? lmb_gltf_add_view(w, (lmb_gltf_range){offset, bytes.size, 0, LMB_GLTF_ANY}) : -1;
        bool written = view >= 0 && lmb_gltf_set_number(image, "bufferView", (double)view);
        if (written) {
            memcpy(to, bytes.data, bytes.size);
            cJSON_DeleteItemFromObjectCaseSensitive(image, "uri");
            written = cJSON_GetObjectItemCaseSensitive(image, "mimeType") ||
                      cJSON_AddStringToObject(image, "mimeType", mime_type(&bytes));
        }
        free(bytes.owned);
        if (!written) {
            return lmb_gltf_writer_out_of_memory(w);
        }
    }
    return LMB_OK;
}
