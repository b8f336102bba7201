#include <lambent/height.h>

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include <stb_image.h>

#include "image/image_bytes.h"

void lmb_height_map_free(lmb_height_map *map)
{
    free(map->value);
    *map = (lmb_height_map){0, 0, NULL};
}

/* 8 bits are widened exactly: v / 255 is 257 v / 65535. */
static lmb_result decode(const lmb_image_bytes *file, lmb_height_map *map, lmb_error *error)
{
    static const unsigned char signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    int width, height, channels;
    if (file->size < sizeof signature || memcmp(file->data, signature, sizeof signature) != 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a PNG", file->name);
    }
    const int size = file->size < INT_MAX ? (int)file->size : INT_MAX;
    if (!stbi_info_from_memory(file->data, size, &width, &height, &channels)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: a broken PNG: %s", file->name, stbi_failure_reason());
    }
    if ((int64_t)width * height > LMB_IMAGE_MAX_PIXELS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %d x %d pixels are too many", file->name, width,
                             height);
    }
    stbi_us *const grey = stbi_load_16_from_memory(file->data, size, &width, &height, &channels, 1);
    if (!grey) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: a broken PNG: %s", file->name, stbi_failure_reason());
    }
    const size_t count = (size_t)width * (size_t)height;
    float *const value = malloc(count * sizeof *value);
    for (size_t i = 0; value && i < count; ++i) {
        value[i] = (float)grey[i] / 65535.0f;
    }
    stbi_image_free(grey);
    if (!value) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory for %d x %d pixels", file->name, width,
                             height);
    }
    *map = (lmb_height_map){width, height, value};
    return LMB_OK;
}

lmb_result lmb_height_map_read(const char *path, lmb_height_map *map, lmb_error *error)
{
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(path, &data, &size, error);
    if (result == LMB_OK) {
        result = decode(&(lmb_image_bytes){path, data, size}, map, error);
        free(data);
    }
    return result;
}
