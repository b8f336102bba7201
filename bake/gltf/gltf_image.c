#include "gltf/gltf_image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_accessor.h"

lmb_result lmb_gltf_image_read(lmb_gltf_file *file, const cJSON *image, uint32_t number, lmb_gltf_bytes *bytes,
                               char **name, lmb_error *error)
{
    const char *const uri = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(image, "uri"));
    const bool external = uri && strncmp(uri, "data:", 5) != 0;
    const uint32_t view = lmb_gltf_uint(image, "bufferView", UINT32_MAX);
    char place[LMB_GLTF_PLACE_SIZE];
    lmb_gltf_place(place, "images[%u]", number);
    if ((uri == NULL) == (view == UINT32_MAX)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: needs either a uri or a bufferView", file->path, place);
    }
    if (uri) {
        const lmb_result result = lmb_gltf_uri_read(file, uri, place, bytes, error);
        if (result != LMB_OK) {
            return result;
        }
    } else if (view >= file->view_count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.bufferView: %u, but there are %u bufferViews", file->path,
                             place, view, file->view_count);
    } else {
        *bytes = lmb_gltf_view_bytes(file, view);
    }
    if (!bytes->data) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: no bytes", file->path, place);
    }
    if (name) {
        const size_t size = (external ? strlen(uri) : 0) + sizeof "image 4294967295";
        *name = malloc(size);
        if (!*name) {
            free(bytes->owned);
            return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, place);
        }
        if (external) {
            memcpy(*name, uri, strlen(uri) + 1);
        } else {
            snprintf(*name, size, "image %u", number);
        }
    }
    return LMB_OK;
}
