/* OpenEXR through OpenEXRCore, from and to memory. */
#include "image_internal.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include <Imath/half.h>
#include <OpenEXR/openexr.h>

static const char SCALE_ATTRIBUTE[] = "lambent:scale";

/* The file being read. The library's messages are kept instead of printed. */
typedef struct exr_source {
    const char *name;
    const unsigned char *data;
    size_t size;
    char message[256]; /* the library's first, or empty */
} exr_source;

/* Where a channel's pixels go: value (x, y) at base[(y width + x) stride]. */
typedef struct exr_target {
    const char *channel;
    float *base;
    int32_t stride;
} exr_target;

bool lmb_exr_is(const unsigned char *data, size_t size)
{
    return size >= 4 && data[0] == 0x76 && data[1] == 0x2f && data[2] == 0x31 && data[3] == 0x01;
}

static void message_keep(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    (void)code;
    if (exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user) {
        exr_source *const source = user;
        if (source->message[0] == '\0') {
            snprintf(source->message, sizeof source->message, "%s", message);
        }
    }
}

static void message_drop(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

static int64_t source_read(exr_const_context_t context, void *user, void *buffer, uint64_t size, uint64_t offset,
                           exr_stream_error_func_ptr_t on_error)
{
    const exr_source *const source = user;
    (void)context;
    (void)on_error;
    if (offset >= source->size) {
        return 0;
    }
    const uint64_t left = source->size - offset;
    const uint64_t count = size < left ? size : left;
    memcpy(buffer, source->data + offset, (size_t)count);
    return (int64_t)count;
}

static int64_t source_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const exr_source *)user)->size;
}

static const char *compression_name(exr_compression_t compression)
{
    static const char *const NAMES[] = {"NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    return (size_t)compression < sizeof NAMES / sizeof NAMES[0] ? NAMES[compression] : "unknown";
}

/* Names a failure of the library. */
static lmb_result source_fail(const exr_source *source, exr_result_t code, const char *doing, lmb_error *error)
{
    const lmb_result result = code == EXR_ERR_OUT_OF_MEMORY             ? LMB_ERROR_MEMORY
                              : code == EXR_ERR_FEATURE_NOT_IMPLEMENTED ? LMB_ERROR_UNSUPPORTED
                                                                        : LMB_ERROR_FORMAT;
    return lmb_error_set(error, result, "%s: %s: %s", source->name, doing,
                         source->message[0] ? source->message : exr_get_default_error_message(code));
}

static lmb_result source_open(exr_source *source, exr_context_t *context, lmb_error *error)
{
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = message_keep;
    settings.user_data = source;
    settings.read_fn = source_read;
    settings.size_fn = source_size;
    settings.max_image_width = LMB_IMAGE_MAX_SIDE;
    settings.max_image_height = LMB_IMAGE_MAX_SIDE;
    settings.max_tile_width = LMB_IMAGE_MAX_SIDE;
    settings.max_tile_height = LMB_IMAGE_MAX_SIDE;
    settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    const exr_result_t code = exr_start_read(context, source->name, &settings);
    return code == EXR_ERR_SUCCESS ? LMB_OK : source_fail(source, code, "cannot read the EXR header", error);
}

/* The first part's size, if it is a picture that can be decoded. */
static lmb_result part_check(const exr_source *source, exr_const_context_t context, int32_t *width, int32_t *height,
                             lmb_error *error)
{
    const char *const name = source->name;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_attr_box2i_t data_window;
    exr_attr_box2i_t display_window;
    const exr_attr_chlist_t *channels = NULL;
    if (exr_get_storage(context, 0, &storage) != EXR_ERR_SUCCESS ||
        exr_get_data_window(context, 0, &data_window) != EXR_ERR_SUCCESS ||
        exr_get_display_window(context, 0, &display_window) != EXR_ERR_SUCCESS ||
        exr_get_channels(context, 0, &channels) != EXR_ERR_SUCCESS || !channels) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: the EXR header lacks what every part has", name);
    }
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: deep EXRs are not supported", name);
    }
    const int64_t columns = (int64_t)data_window.max.x - data_window.min.x + 1;
    const int64_t rows = (int64_t)data_window.max.y - data_window.min.y + 1;
    if (columns < 1 || rows < 1) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: the data window is empty", name);
    }
    if (columns > LMB_IMAGE_MAX_SIDE || rows > LMB_IMAGE_MAX_SIDE || columns * rows > LMB_IMAGE_MAX_PIXELS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %lld x %lld pixels are too many", name,
                             (long long)columns, (long long)rows);
    }
    if (memcmp(&data_window, &display_window, sizeof data_window) != 0) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: a data window that is not the display window", name);
    }
    int64_t pixel_bytes = 0;
    for (int i = 0; i < channels->num_channels; ++i) {
        const exr_attr_chlist_entry_t *const channel = &channels->entries[i];
        if (channel->x_sampling != 1 || channel->y_sampling != 1) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: channel '%s' is subsampled", name,
                                 channel->name.str);
        }
        pixel_bytes += channel->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    /* No compression of the format does better than zlib's 1032 to 1: a small file cannot ask for gigabytes. */
    if (columns * rows * pixel_bytes / 1100 > (int64_t)source->size) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: the file is too short for %lld x %lld pixels", name,
                             (long long)columns, (long long)rows);
    }
    *width = (int32_t)columns;
    *height = (int32_t)rows;
    return LMB_OK;
}

static bool channel_exists(exr_const_context_t context, const char *name)
{
    const exr_attr_chlist_t *channels = NULL;
    if (exr_get_channels(context, 0, &channels) != EXR_ERR_SUCCESS || !channels) {
        return false;
    }
    for (int i = 0; i < channels->num_channels; ++i) {
        if (strcmp(channels->entries[i].name.str, name) == 0) {
            return true;
        }
    }
    return false;
}

/* Points the chunk's channels at pixel (x, y) of their targets; channels that nobody wants are skipped. */
static void chunk_aim(exr_decode_pipeline_t *decoder, const exr_target *targets, size_t count, int32_t width, int32_t x,
                      int32_t y)
{
    for (int i = 0; i < decoder->channel_count; ++i) {
        exr_coding_channel_info_t *const channel = &decoder->channels[i];
        channel->decode_to_ptr = NULL;
        for (size_t k = 0; k < count; ++k) {
            if (strcmp(channel->channel_name, targets[k].channel) == 0) {
                float *const first =
                    targets[k].base + ((size_t)y * (size_t)width + (size_t)x) * (size_t)targets[k].stride;
                channel->decode_to_ptr = (uint8_t *)first;
                channel->user_data_type = EXR_PIXEL_FLOAT;
                channel->user_bytes_per_element = sizeof(float);
                channel->user_pixel_stride = targets[k].stride * (int32_t)sizeof(float);
                channel->user_line_stride = width * channel->user_pixel_stride;
            }
        }
    }
}

/* The library's decoders of damaged chunks may leave the end of a buffer as it was: zeros, not what the heap held. */
static void *buffer_allocate(exr_transcoding_pipeline_buffer_id_t id, size_t size)
{
    (void)id;
    return calloc(1, size);
}

static void buffer_free(exr_transcoding_pipeline_buffer_id_t id, void *buffer)
{
    (void)id;
    free(buffer);
}

/* Decodes one chunk that starts at pixel (x, y); the first sets the pipeline up. */
static exr_result_t chunk_decode(exr_const_context_t context, const exr_chunk_info_t *chunk,
                                 exr_decode_pipeline_t *decoder, const exr_target *targets, size_t count, int32_t width,
                                 int32_t x, int32_t y)
{
    const bool first = decoder->context == NULL;
    exr_result_t code =
        first ? exr_decoding_initialize(context, 0, chunk, decoder) : exr_decoding_update(context, 0, chunk, decoder);
    if (code == EXR_ERR_SUCCESS) {
        decoder->alloc_fn = buffer_allocate;
        decoder->free_fn = buffer_free;
        chunk_aim(decoder, targets, count, width, x, y);
        code = first ? exr_decoding_choose_default_routines(context, 0, decoder) : code;
    }
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(context, 0, decoder) : code;
}

static exr_result_t scanlines_decode(exr_const_context_t context, const exr_target *targets, size_t count,
                                     int32_t width, int32_t height, exr_decode_pipeline_t *decoder)
{
    int32_t step = 0;
    exr_attr_box2i_t window;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &step);
    if (code == EXR_ERR_SUCCESS) {
        code = exr_get_data_window(context, 0, &window);
    }
    if (code == EXR_ERR_SUCCESS && step < 1) {
        return EXR_ERR_FILE_BAD_HEADER;
    }
    for (int32_t y = 0; y < height && code == EXR_ERR_SUCCESS; y += step) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(context, 0, window.min.y + y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = chunk.width == width && chunk.height <= height - y
                       ? chunk_decode(context, &chunk, decoder, targets, count, width, 0, y)
                       : EXR_ERR_CORRUPT_CHUNK;
        }
    }
    return code;
}

static exr_result_t tiles_decode(exr_const_context_t context, const exr_target *targets, size_t count, int32_t width,
                                 int32_t height, exr_decode_pipeline_t *decoder)
{
    int32_t tile_width = 0;
    int32_t tile_height = 0;
    exr_result_t code = exr_get_tile_sizes(context, 0, 0, 0, &tile_width, &tile_height);
    if (code == EXR_ERR_SUCCESS && (tile_width < 1 || tile_height < 1)) {
        return EXR_ERR_FILE_BAD_HEADER;
    }
    for (int32_t y = 0; y < height && code == EXR_ERR_SUCCESS; y += tile_height) {
        for (int32_t x = 0; x < width && code == EXR_ERR_SUCCESS; x += tile_width) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(context, 0, x / tile_width, y / tile_height, 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) {
                code = chunk.width <= width - x && chunk.height <= height - y
                           ? chunk_decode(context, &chunk, decoder, targets, count, width, x, y)
                           : EXR_ERR_CORRUPT_CHUNK;
            }
        }
    }
    return code;
}

static lmb_result pixels_decode(const exr_source *source, exr_const_context_t context, const exr_target *targets,
                                size_t count, int32_t width, int32_t height, lmb_error *error)
{
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_result_t code = exr_get_storage(context, 0, &storage);
    if (code == EXR_ERR_SUCCESS) {
        code = storage == EXR_STORAGE_TILED ? tiles_decode(context, targets, count, width, height, &decoder)
                                            : scanlines_decode(context, targets, count, width, height, &decoder);
    }
    exr_decoding_destroy(context, &decoder);
    if (code == EXR_ERR_SUCCESS) {
        return LMB_OK;
    }
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    (void)exr_get_compression(context, 0, &compression);
    if (code == EXR_ERR_FEATURE_NOT_IMPLEMENTED) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: this OpenEXR does not decode %s compression",
                             source->name, compression_name(compression));
    }
    char doing[64];
    snprintf(doing, sizeof doing, "cannot decode the EXR's %s pixels", compression_name(compression));
    return source_fail(source, code, doing, error);
}

/* R, G, B, or Y three times over. */
static lmb_result colour_decode(const exr_source *source, exr_const_context_t context, lmb_image *image,
                                lmb_latlong_axes *axes, lmb_error *error)
{
    const char *const name = source->name;
    exr_envmap_t kind;
    const bool marked = exr_attr_get_envmap(context, 0, "envmap", &kind) == EXR_ERR_SUCCESS;
    if (marked && kind != EXR_ENVMAP_LATLONG) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: cube-map EXRs are not supported (only lat-long)", name);
    }
    const bool rgb = channel_exists(context, "R") && channel_exists(context, "G") && channel_exists(context, "B");
    if (!rgb && !channel_exists(context, "Y")) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: neither channels R, G, B nor Y", name);
    }
    if (!rgb && (channel_exists(context, "RY") || channel_exists(context, "BY"))) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: luminance-chroma EXRs are not supported", name);
    }
    lmb_image decoded = {0, 0, NULL};
    lmb_result result = part_check(source, context, &decoded.width, &decoded.height, error);
    if (result != LMB_OK) {
        return result;
    }
    const size_t pixels = (size_t)decoded.width * (size_t)decoded.height;
    decoded.rgb = malloc(3 * sizeof(float) * pixels);
    if (!decoded.rgb) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels", name, decoded.width,
                             decoded.height);
    }
    const exr_target targets[3] = {
        {rgb ? "R" : "Y", decoded.rgb, 3}, {"G", decoded.rgb + 1, 3}, {"B", decoded.rgb + 2, 3}};
    result = pixels_decode(source, context, targets, rgb ? 3 : 1, decoded.width, decoded.height, error);
    if (result != LMB_OK) {
        lmb_image_free(&decoded);
        return result;
    }
    for (size_t i = 0; i < pixels && !rgb; ++i) {
        decoded.rgb[3 * i + 1] = decoded.rgb[3 * i + 2] = decoded.rgb[3 * i];
    }
    *image = decoded;
    *axes = marked ? LMB_LATLONG_OPENEXR : LMB_LATLONG_GLTF;
    return LMB_OK;
}

lmb_result lmb_exr_decode(const char *name, const unsigned char *data, size_t size, lmb_image *image,
                          lmb_latlong_axes *axes, lmb_error *error)
{
    exr_source source = {.name = name, .data = data, .size = size};
    exr_context_t context = NULL;
    lmb_result result = source_open(&source, &context, error);
    if (result == LMB_OK) {
        result = colour_decode(&source, context, image, axes, error);
        exr_finish(&context);
    }
    return result;
}

static lmb_result channels_decode(const exr_source *source, exr_const_context_t context, const char *const *names,
                                  size_t count, float **values, int32_t *width, int32_t *height, lmb_error *error)
{
    for (size_t i = 0; i < count; ++i) {
        if (!channel_exists(context, names[i])) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no channel '%s'", source->name, names[i]);
        }
    }
    lmb_result result = part_check(source, context, width, height, error);
    if (result != LMB_OK) {
        return result;
    }
    exr_target *const targets = calloc(count > 0 ? count : 1, sizeof *targets);
    bool memory = targets != NULL;
    for (size_t i = 0; i < count && memory; ++i) {
        targets[i] = (exr_target){names[i], malloc(sizeof(float) * (size_t)*width * (size_t)*height), 1};
        memory = targets[i].base != NULL;
    }
    result = memory ? pixels_decode(source, context, targets, count, *width, *height, error)
                    : lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels of %zu channels",
                                    source->name, *width, *height, count);
    for (size_t i = 0; i < count && targets; ++i) {
        if (result == LMB_OK) {
            values[i] = targets[i].base;
        } else {
            free(targets[i].base);
        }
    }
    free(targets);
    return result;
}

lmb_result lmb_exr_read_channels(const char *path, const char *const *names, size_t count, float **values,
                                 int32_t *width, int32_t *height, float *scale, lmb_error *error)
{
    assert(path && names && values && width && height);
    unsigned char *data = NULL;
    exr_source source = {.name = path};
    lmb_result result = lmb_file_read(path, &data, &source.size, error);
    if (result != LMB_OK) {
        return result;
    }
    source.data = data;
    if (!lmb_exr_is(data, source.size)) {
        free(data);
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not an OpenEXR file", path);
    }
    exr_context_t context = NULL;
    result = source_open(&source, &context, error);
    if (result == LMB_OK) {
        int32_t size[2] = {0, 0};
        result = channels_decode(&source, context, names, count, values, &size[0], &size[1], error);
        if (result == LMB_OK) {
            *width = size[0];
            *height = size[1];
            float found = 1.0f;
            const bool has_scale = exr_attr_get_float(context, 0, SCALE_ATTRIBUTE, &found) == EXR_ERR_SUCCESS;
            if (scale) {
                *scale = has_scale ? found : 1.0f;
            }
        }
        exr_finish(&context);
    }
    free(data);
    return result;
}

/* The file being written. */
typedef struct exr_sink {
    unsigned char *data;
    size_t size;
    size_t capacity;
} exr_sink;

static int64_t sink_write(exr_const_context_t context, void *user, const void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t on_error)
{
    exr_sink *const sink = user;
    if (size > SIZE_MAX / 4 || offset > SIZE_MAX / 4) {
        on_error(context, EXR_ERR_OUT_OF_MEMORY, "no memory for the file");
        return -1;
    }
    const size_t end = (size_t)(offset + size);
    if (end > sink->capacity) {
        const size_t capacity = end > 2 * sink->capacity ? end : 2 * sink->capacity;
        unsigned char *const larger = realloc(sink->data, capacity);
        if (!larger) {
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

/* All channels as halfs, one after the other, clamped to the largest finite one. NULL: no memory. */
static uint16_t *halfs_make(const lmb_exr_channel *channels, size_t channel_count, size_t pixels, size_t *overflows)
{
    if (pixels > SIZE_MAX / sizeof(uint16_t) / (channel_count > 0 ? channel_count : 1)) {
        return NULL;
    }
    uint16_t *const halfs = malloc(sizeof(uint16_t) * pixels * channel_count);
    for (size_t k = 0; k < channel_count && halfs; ++k) {
        for (size_t i = 0; i < pixels; ++i) {
            float value = channels[k].values[i];
            if (fabsf(value) > 65504.0f) {
                value = copysignf(65504.0f, value);
                ++*overflows;
            }
            halfs[k * pixels + i] = imath_float_to_half(value);
        }
    }
    return halfs;
}

static exr_result_t header_write(exr_context_t context, int32_t width, int32_t height, const lmb_exr_channel *channels,
                                 size_t channel_count, const lmb_exr_attribute *attributes, size_t attribute_count)
{
    int part = 0;
    exr_result_t code = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS) {
        code = exr_initialize_required_attr_simple(context, part, width, height, EXR_COMPRESSION_ZIP);
    }
    if (code == EXR_ERR_SUCCESS) {
        code = exr_set_zip_compression_level(context, part, 6);
    }
    for (size_t i = 0; i < channel_count && code == EXR_ERR_SUCCESS; ++i) {
        code = exr_add_channel(context, part, channels[i].name, EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    for (size_t i = 0; i < attribute_count && code == EXR_ERR_SUCCESS; ++i) {
        code = attributes[i].text ? exr_attr_set_string(context, part, attributes[i].name, attributes[i].text)
                                  : exr_attr_set_float(context, part, attributes[i].name, attributes[i].number);
    }
    return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

static exr_result_t pixels_write(exr_context_t context, int32_t width, int32_t height, const lmb_exr_channel *channels,
                                 size_t channel_count, const uint16_t *halfs)
{
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    const size_t pixels = (size_t)width * (size_t)height;
    int32_t step = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &step);
    for (int32_t y = 0; y < height && code == EXR_ERR_SUCCESS; y += step) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(context, 0, y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = y == 0 ? exr_encoding_initialize(context, 0, &chunk, &encoder)
                          : exr_encoding_update(context, 0, &chunk, &encoder);
        }
        for (int i = 0; i < encoder.channel_count && code == EXR_ERR_SUCCESS; ++i) {
            exr_coding_channel_info_t *const channel = &encoder.channels[i];
            size_t k = 0;
            while (k < channel_count && strcmp(channels[k].name, channel->channel_name) != 0) {
                ++k;
            }
            assert(k < channel_count);
            channel->encode_from_ptr = (const uint8_t *)(halfs + k * pixels + (size_t)y * (size_t)width);
            channel->user_pixel_stride = sizeof(uint16_t);
            channel->user_line_stride = width * (int32_t)sizeof(uint16_t);
        }
        if (code == EXR_ERR_SUCCESS && y == 0) {
            code = exr_encoding_choose_default_routines(context, 0, &encoder);
        }
        if (code == EXR_ERR_SUCCESS) {
            code = exr_encoding_run(context, 0, &encoder);
        }
    }
    exr_encoding_destroy(context, &encoder);
    return code;
}

static lmb_result write_arguments_check(const char *path, int32_t width, int32_t height,
                                        const lmb_exr_channel *channels, size_t channel_count, lmb_error *error)
{
    if (width < 1 || height < 1 || width > LMB_IMAGE_MAX_SIDE || height > LMB_IMAGE_MAX_SIDE ||
        (int64_t)width * height > LMB_IMAGE_MAX_PIXELS || channel_count < 1) {
        return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%s: cannot write %d x %d pixels of %zu channels", path, width,
                             height, channel_count);
    }
    const size_t pixels = (size_t)width * (size_t)height;
    for (size_t k = 0; k < channel_count; ++k) {
        for (size_t i = 0; i < pixels; ++i) {
            if (isnan(channels[k].values[i])) {
                return lmb_error_set(error, LMB_ERROR_ARGUMENT,
                                     "%s: channel '%s' is not a number at column %zu, row %zu", path, channels[k].name,
                                     i % (size_t)width, i / (size_t)width);
            }
        }
    }
    return LMB_OK;
}

lmb_result lmb_exr_write(const char *path, int32_t width, int32_t height, const lmb_exr_channel *channels,
                         size_t channel_count, const lmb_exr_attribute *attributes, size_t attribute_count,
                         size_t *overflow_count, lmb_error *error)
{
    assert(path && channels && (attributes || attribute_count == 0));
    lmb_result result = write_arguments_check(path, width, height, channels, channel_count, error);
    if (result != LMB_OK) {
        return result;
    }
    size_t overflows = 0;
    exr_sink sink = {NULL, 0, 0};
    uint16_t *const halfs = halfs_make(channels, channel_count, (size_t)width * (size_t)height, &overflows);
    if (!halfs) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels of %zu channels", path, width,
                             height, channel_count);
    }
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = message_drop;
    settings.user_data = &sink;
    settings.write_fn = sink_write;
    exr_context_t context = NULL;
    exr_result_t code = exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &settings);
    if (code == EXR_ERR_SUCCESS) {
        code = header_write(context, width, height, channels, channel_count, attributes, attribute_count);
        if (code == EXR_ERR_SUCCESS) {
            code = pixels_write(context, width, height, channels, channel_count, halfs);
        }
        const exr_result_t finished = exr_finish(&context);
        code = code == EXR_ERR_SUCCESS ? finished : code;
    }
    if (code == EXR_ERR_SUCCESS) {
        result = lmb_file_write(path, sink.data, sink.size, error);
    } else {
        result = lmb_error_set(error, code == EXR_ERR_OUT_OF_MEMORY ? LMB_ERROR_MEMORY : LMB_ERROR_ARGUMENT,
                               "%s: cannot write the EXR: %s", path, exr_get_default_error_message(code));
    }
    if (result == LMB_OK && overflow_count) {
        *overflow_count = overflows;
    }
    free(halfs);
    free(sink.data);
    return result;
}
