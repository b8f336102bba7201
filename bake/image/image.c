#include "image/image_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/file.h>

#include <stb_image_write.h>

#include "image/exr_internal.h"
#include "image/radiance.h"

void lmb_image_free(lmb_image *image)
{
    if (image) {
        free(image->rgb);
        *image = (lmb_image){0, 0, NULL};
    }
}

/* Zeroes what is not a finite number >= 0, and counts the pixels that it was in. */
static size_t pixels_repair(lmb_image *image)
{
    const size_t count = (size_t)image->width * (size_t)image->height;
    size_t bad = 0;
    for (size_t i = 0; i < count; ++i) {
        float *const rgb = image->rgb + 3 * i;
        bool good = true;
        for (int c = 0; c < 3; ++c) {
            if (!isfinite(rgb[c]) || rgb[c] < 0.0f) {
                rgb[c] = 0.0f;
                good = false;
            }
        }
        bad += good ? 0 : 1;
    }
    return bad;
}

lmb_result lmb_image_decode(const lmb_image_bytes *file, lmb_image *image, lmb_latlong_axes *axes, size_t *bad_pixels,
                            lmb_error *error)
{
    lmb_image decoded = {0, 0, NULL};
    lmb_latlong_axes decoded_axes = LMB_LATLONG_GLTF;
    lmb_result result;
    if (lmb_radiance_is(file)) {
        result = lmb_radiance_decode(file, &decoded, error);
    } else if (lmb_exr_is(file)) {
        result = lmb_exr_decode(file, &decoded, &decoded_axes, error);
    } else {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: neither Radiance .hdr nor OpenEXR", file->name);
    }
    if (result != LMB_OK) {
        return result;
    }
    const size_t bad = pixels_repair(&decoded);
    *image = decoded;
    if (axes) {
        *axes = decoded_axes;
    }
    if (bad_pixels) {
        *bad_pixels = bad;
    }
    return LMB_OK;
}

lmb_result lmb_image_read(const char *path, lmb_image *image, lmb_latlong_axes *axes, size_t *bad_pixels,
                          lmb_error *error)
{
    assert(path && image);
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(path, &data, &size, error);
    if (result == LMB_OK) {
        result = lmb_image_decode(&(lmb_image_bytes){path, data, size}, image, axes, bad_pixels, error);
        free(data);
    }
    return result;
}

typedef struct png_bytes {
    const char *path;
    lmb_error *error;
    lmb_result result;
} png_bytes;

static void png_take(void *context, void *data, int size)
{
    png_bytes *const bytes = context;
    bytes->result = lmb_file_write(bytes->path, data, (size_t)size, bytes->error);
}

lmb_result lmb_png_write(const char *path, int32_t width, int32_t height, const uint8_t *srgb, lmb_error *error)
{
    assert(path && srgb);
    if (width <= 0 || height <= 0 || (int64_t)width * height > LMB_IMAGE_MAX_PIXELS) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: cannot write %d x %d pixels", path, width, height);
    }
    /* stb_image_write hands over the whole picture in one call, or none when it runs out of memory. */
    png_bytes bytes = {path, error, LMB_ERROR_MEMORY};
    if (!stbi_write_png_to_func(png_take, &bytes, width, height, 3, srgb, 3 * width)) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory to write %d x %d pixels", path, width, height);
    }
    return bytes.result;
}
