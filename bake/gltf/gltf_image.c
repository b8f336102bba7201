#include "gltf/gltf_image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <stb_image.h>

#include "gltf/gltf_buffers.h"
#include "gltf/gltf_json.h"
#include "gltf/gltf_uri.h"

/* Pixels of one image; enough for 16 k x 16 k. */
#define MAX_PIXELS ((int64_t)1 << 28)

lmb_result lmb_gltf_image_read(lmb_gltf_file *file, const cJSON *image, uint32_t index, lmb_gltf_bytes *bytes,
                               char **name, lmb_error *error)
{
    const char *const uri = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(image, "uri"));
    const bool external = uri && strncmp(uri, "data:", 5) != 0;
    const uint32_t view = lmb_gltf_uint(image, "bufferView", UINT32_MAX);
    char where[LMB_GLTF_WHERE_SIZE];
    lmb_gltf_where(where, "images[%u]", index);
    if ((uri == NULL) == (view == UINT32_MAX)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: needs either a uri or a bufferView", file->path, where);
    }
    if (uri) {
        const lmb_result result = lmb_gltf_uri_read(file, uri, where, bytes, error);
        if (result != LMB_OK) {
            return result;
        }
    } else if (view >= file->view_count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.bufferView: %u, but there are %u bufferViews", file->path,
                             where, view, file->view_count);
    } else {
        *bytes = lmb_gltf_view_bytes(file, view);
    }
    if (!bytes->data) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: no bytes", file->path, where);
    }
    if (name) {
        const size_t size = (external ? strlen(uri) : 0) + sizeof "image 4294967295";
        *name = malloc(size);
        if (!*name) {
            free(bytes->owned);
            return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
        }
        if (external) {
            memcpy(*name, uri, strlen(uri) + 1);
        } else {
            snprintf(*name, size, "image %u", index);
        }
    }
    return LMB_OK;
}

/* 16-bit pixels, rounded to 8; NULL when they cannot be decoded. */
static uint8_t *load_wide(const lmb_gltf_bytes *bytes, int32_t *width, int32_t *height)
{
    int channels;
    stbi_us *const wide = stbi_load_16_from_memory(bytes->data, (int)bytes->size, width, height, &channels, 4);
    const size_t count = wide ? (size_t)*width * (size_t)*height * 4 : 0;
    uint8_t *const rgba = wide ? malloc(count) : NULL;
    for (size_t i = 0; rgba && i < count; ++i) {
        rgba[i] = (uint8_t)((wide[i] * 255u + 32767u) / 65535u);
    }
    stbi_image_free(wide);
    return rgba;
}

/* Sets the size and the pixels. `where` names the image in messages. */
static lmb_result decode(const char *path, const char *where, const lmb_gltf_bytes *bytes, lmb_texture_image *image,
                         lmb_error *error)
{
    int channels;
    const int size = (int)bytes->size;
    if (!stbi_info_from_memory(bytes->data, size, &image->width, &image->height, &channels)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: %s: neither PNG nor JPEG", path, where, image->name);
    }
    if ((int64_t)image->width * image->height > MAX_PIXELS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: %s: %d x %d pixels are too many", path, where,
                             image->name, image->width, image->height);
    }
    image->rgba = stbi_is_16_bit_from_memory(bytes->data, size)
                      ? load_wide(bytes, &image->width, &image->height)
                      : stbi_load_from_memory(bytes->data, size, &image->width, &image->height, &channels, 4);
    if (!image->rgba) {
        const char *const reason = stbi_failure_reason();
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: %s: cannot be decoded: %s", path, where, image->name,
                             reason ? reason : "");
    }
    return LMB_OK;
}

lmb_result lmb_gltf_image_decode(lmb_gltf_file *file, const cJSON *item, uint32_t index, lmb_texture_image *image,
                                 lmb_error *error)
{
    lmb_gltf_bytes bytes = {NULL, 0, NULL};
    lmb_texture_image decoded = {.name = NULL};
    char where[LMB_GLTF_WHERE_SIZE];
    lmb_result result = lmb_gltf_image_read(file, item, index, &bytes, &decoded.name, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_gltf_where(where, "images[%u]", index);
    result = decode(file->path, where, &bytes, &decoded, error);
    free(bytes.owned);
    if (result != LMB_OK) {
        free(decoded.name);
        return result;
    }
    *image = decoded;
    return LMB_OK;
}
