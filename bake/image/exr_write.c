/* Writing OpenEXR to memory, through OpenEXRCore, and then to disk. */
#include <lambent/exr.h>

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/half_scale.h>

#include <Imath/half.h>
#include <OpenEXR/openexr.h>

#include "image/image_bytes.h"

static void message_drop(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

/* The file being written. */
typedef struct exr_sink {
    unsigned char *data;
    size_t size;
    size_t capacity;
    bool out_of_memory; /* the library calls it a failed write */
} exr_sink;

static int64_t sink_write(exr_const_context_t context, void *user, const void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t on_error)
{
    exr_sink *const sink = user;
    if (size > SIZE_MAX / 4 || offset > SIZE_MAX / 4) {
        sink->out_of_memory = true;
        on_error(context, EXR_ERR_OUT_OF_MEMORY, "no memory for the file");
        return -1;
    }
    const size_t end = (size_t)(offset + size);
    if (end > sink->capacity) {
        const size_t capacity = end > 2 * sink->capacity ? end : 2 * sink->capacity;
        unsigned char *const larger = realloc(sink->data, capacity);
        if (!larger) {
            sink->out_of_memory = true;
            on_error(context, EXR_ERR_OUT_OF_MEMORY, "no memory for the file");
            return -1;
        }
        memset(larger + sink->capacity, 0, capacity - sink->capacity);
        sink->data = larger;
        sink->capacity = capacity;
    }
    memcpy(sink->data + offset, buffer, (size_t)size);
    sink->size = end > sink->size ? end : sink->size;
    return (int64_t)size;
}

static size_t pixel_count(const lmb_exr_picture *picture)
{
    return (size_t)picture->width * (size_t)picture->height;
}

/* All channels as halfs, one after the other, clamped to the largest finite one. NULL: no memory. */
static uint16_t *halfs_make(const lmb_exr_picture *picture, size_t *overflows)
{
    const size_t pixels = pixel_count(picture);
    const size_t channel_count = picture->channel_count;
    if (pixels > SIZE_MAX / sizeof(uint16_t) / (channel_count > 0 ? channel_count : 1)) {
        return NULL;
    }
    uint16_t *const halfs = malloc(sizeof(uint16_t) * pixels * channel_count);
    for (size_t k = 0; k < channel_count && halfs; ++k) {
        for (size_t i = 0; i < pixels; ++i) {
            float value = picture->channels[k].values[i];
            if (fabsf(value) > LMB_HALF_MAX) {
                value = copysignf(LMB_HALF_MAX, value);
                ++*overflows;
            }
            halfs[k * pixels + i] = imath_float_to_half(value);
        }
    }
    return halfs;
}

static exr_result_t header_write(exr_context_t context, const lmb_exr_picture *picture)
{
    int part = 0;
    exr_result_t code = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS) {
        code = exr_initialize_required_attr_simple(context, part, picture->width, picture->height, EXR_COMPRESSION_ZIP);
    }
    if (code == EXR_ERR_SUCCESS) {
        code = exr_set_zip_compression_level(context, part, 6);
    }
    for (size_t i = 0; i < picture->channel_count && code == EXR_ERR_SUCCESS; ++i) {
        code = exr_add_channel(context, part, picture->channels[i].name, EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LOGARITHMIC,
                               1, 1);
    }
    for (size_t i = 0; i < picture->attribute_count && code == EXR_ERR_SUCCESS; ++i) {
        const lmb_exr_attribute *attribute = &picture->attributes[i];
        code = attribute->text ? exr_attr_set_string(context, part, attribute->name, attribute->text)
                               : exr_attr_set_float(context, part, attribute->name, attribute->number);
    }
    return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

/* What compresses by default. */
typedef struct exr_packer {
    exr_result_t (*compress)(exr_encode_pipeline_t *encoder);
} exr_packer;

/* A chunk that is as long compressed as not is read as not compressed: OpenEXRCore 3.1 writes it compressed all the
 * same. */
static exr_result_t chunk_compress(exr_encode_pipeline_t *encoder)
{
    const exr_packer *const packer = encoder->encoding_user_data;
    const exr_result_t code = packer->compress(encoder);
    if (code == EXR_ERR_SUCCESS && encoder->compressed_bytes == encoder->packed_bytes &&
        encoder->compressed_buffer != encoder->packed_buffer) {
        memcpy(encoder->compressed_buffer, encoder->packed_buffer, encoder->compressed_bytes);
    }
    return code;
}

static exr_result_t pixels_write(exr_context_t context, const lmb_exr_picture *picture, const uint16_t *halfs)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_packer packer = {NULL};
    const size_t pixels = pixel_count(picture), width = (size_t)picture->width;
    int32_t step = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &step);
    for (int32_t y = 0; y < picture->height && code == EXR_ERR_SUCCESS; y += step) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(context, 0, y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = y == 0 ? exr_encoding_initialize(context, 0, &chunk, &encoder)
                          : exr_encoding_update(context, 0, &chunk, &encoder);
        }
        for (int i = 0; i < encoder.channel_count && code == EXR_ERR_SUCCESS; ++i) {
            exr_coding_channel_info_t *const channel = &encoder.channels[i];
            size_t k = 0;
            while (k < picture->channel_count && strcmp(picture->channels[k].name, channel->channel_name) != 0) {
                ++k;
            }
            assert(k < picture->channel_count);
            channel->encode_from_ptr = (const uint8_t *)(halfs + k * pixels + (size_t)y * width);
            channel->user_pixel_stride = sizeof(uint16_t);
            channel->user_line_stride = picture->width * (int32_t)sizeof(uint16_t);
        }
        if (code == EXR_ERR_SUCCESS && y == 0) {
            code = exr_encoding_choose_default_routines(context, 0, &encoder);
            if (code == EXR_ERR_SUCCESS && encoder.compress_fn) {
                packer.compress = encoder.compress_fn;
                encoder.encoding_user_data = &packer;
                encoder.compress_fn = chunk_compress;
            }
        }
        if (code == EXR_ERR_SUCCESS) {
            code = exr_encoding_run(context, 0, &encoder);
        }
    }
    exr_encoding_destroy(context, &encoder);
    return code;
}

static lmb_result write_arguments_check(const char *path, const lmb_exr_picture *picture, lmb_error *error)
{
    const int32_t width = picture->width, height = picture->height;
    if (width < 1 || height < 1 || width > LMB_IMAGE_MAX_SIDE || height > LMB_IMAGE_MAX_SIDE ||
        (int64_t)width * height > LMB_IMAGE_MAX_PIXELS || picture->channel_count < 1) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: cannot write %d x %d pixels of %zu channels", path, width,
                             height, picture->channel_count);
    }
    const size_t pixels = pixel_count(picture);
    for (size_t k = 0; k < picture->channel_count; ++k) {
        for (size_t i = 0; i < pixels; ++i) {
            if (isnan(picture->channels[k].values[i])) {
                return lmb_error_set(error, LMB_ERROR_ARGUMENT,
                                     "%s: channel '%s' is not a number at column %zu, row %zu", path,
                                     picture->channels[k].name, i % (size_t)width, i / (size_t)width);
            }
        }
    }
    return LMB_OK;
}

lmb_result lmb_exr_write(const char *path, const lmb_exr_picture *picture, size_t *overflow_count, lmb_error *error)
{
    assert(path && picture->channels && (picture->attributes || picture->attribute_count == 0));
    lmb_result result = write_arguments_check(path, picture, error);
    if (result != LMB_OK) {
        return result;
    }
    size_t overflows = 0;
    exr_sink sink = {NULL, 0, 0, false};
    uint16_t *const halfs = halfs_make(picture, &overflows);
    if (!halfs) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels of %zu channels", path,
                             picture->width, picture->height, picture->channel_count);
    }
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = message_drop;
    settings.user_data = &sink;
    settings.write_fn = sink_write;
    exr_context_t context = NULL;
    exr_result_t code = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &settings);
    if (code == EXR_ERR_SUCCESS) {
        code = header_write(context, picture);
        if (code == EXR_ERR_SUCCESS) {
            code = pixels_write(context, picture, halfs);
        }
        const exr_result_t finished = exr_finish(&context);
        code = code == EXR_ERR_SUCCESS ? finished : code;
    }
    if (code == EXR_ERR_SUCCESS) {
        result = lmb_file_write(path, sink.data, sink.size, error);
    } else {
        const bool out_of_memory = code == EXR_ERR_OUT_OF_MEMORY || sink.out_of_memory;
        result = lmb_error_set(error, out_of_memory ? LMB_ERROR_MEMORY : LMB_ERROR_ARGUMENT,
                               "%s: cannot write the EXR: %s", path, exr_get_default_error_message(code));
    }
    if (result == LMB_OK && overflow_count) {
        *overflow_count = overflows;
    }
    free(halfs);
    free(sink.data);
    return result;
}
