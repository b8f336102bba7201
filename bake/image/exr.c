/* Reading OpenEXR from memory, through OpenEXRCore. */
#include "image/exr_internal.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

#include <OpenEXR/openexr.h>

static const char SCALE_ATTRIBUTE[] = "lambent:scale";

/* The file being read. The library's messages are kept instead of printed. */
typedef struct exr_source {
    lmb_image_bytes file;
    char message[256]; /* the library's first, or empty */
} exr_source;

bool lmb_exr_is(const lmb_image_bytes *file)
{
    const unsigned char *const data = file->data;
    return file->size >= 4 && data[0] == 0x76 && data[1] == 0x2f && data[2] == 0x31 && data[3] == 0x01;
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

static int64_t source_read(exr_const_context_t context, void *user, void *buffer, uint64_t size, uint64_t offset,
                           exr_stream_error_func_ptr_t on_error)
{
    const exr_source *const source = user;
    (void)context;
    (void)on_error;
    if (offset >= source->file.size) {
        return 0;
    }
    const uint64_t left = source->file.size - offset;
    const uint64_t count = size < left ? size : left;
    memcpy(buffer, source->file.data + offset, (size_t)count);
    return (int64_t)count;
}

static int64_t source_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const exr_source *)user)->file.size;
}

static const char *compression_name(exr_compression_t compression)
{
    static const char *const NAMES[] = {"NONE", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    return (size_t)compression < sizeof NAMES / sizeof NAMES[0] ? NAMES[compression] : "unknown";
}

/* More than the library needs beside the pixels, for which there is memory already, to decode them. */
enum { DECODER_BYTES = 64 << 20 };

/* Whether memory has run out indeed. The library also says so of broken files: of tables that do not fit their place,
 * and of sizes that no memory has. */
static bool memory_is_out(void)
{
    void *const probe = malloc(DECODER_BYTES);
    free(probe);
    return probe == NULL;
}

/* Names a failure of the library. */
static lmb_result source_fail(const exr_source *source, exr_result_t code, const char *doing, lmb_error *error)
{
    const lmb_result result = code == EXR_ERR_OUT_OF_MEMORY && memory_is_out() ? LMB_ERROR_MEMORY : LMB_ERROR_FORMAT;
    const char *const reason = source->message[0] ? source->message : exr_get_default_error_message(code);
    return lmb_error_set(error, result, "%s: %s: %s", source->file.name, doing, reason);
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
    const exr_result_t code = exr_start_read(context, source->file.name, &settings);
    return code == EXR_ERR_SUCCESS ? LMB_OK : source_fail(source, code, "cannot read the EXR header", error);
}

/* The first part's size, if it is a picture that can be decoded. */
static lmb_result part_check(const exr_source *source, exr_const_context_t context, int32_t *width, int32_t *height,
                             lmb_error *error)
{
    const char *const name = source->file.name;
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
    if (columns * rows * pixel_bytes / 1100 > (int64_t)source->file.size) {
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

/* What chunks are decoded by, one after the other. */
typedef struct exr_chunks {
    exr_decode_pipeline_t decoder;
    float *unwanted; /* a chunk of one channel */
    bool out_of_memory;
} exr_chunks;

/* Room for the channels that nobody wants, as large as a chunk can be. Version 3.1 of the library unpacks three or four
 * channels of half floats together, and writes through the NULL that otherwise says to skip one. */
static exr_result_t unwanted_allocate(exr_chunks *chunks, const lmb_exr_targets *targets, int32_t width, int32_t height)
{
    const size_t columns = (size_t)(width < targets->width ? width : targets->width);
    const size_t rows = (size_t)(height < targets->height ? height : targets->height);
    chunks->unwanted = malloc(columns * rows * sizeof *chunks->unwanted);
    chunks->out_of_memory = !chunks->unwanted;
    return chunks->unwanted ? EXR_ERR_SUCCESS : EXR_ERR_OUT_OF_MEMORY;
}

/* Points the chunk's channels at pixel (x, y) of their targets, and those that nobody wants at one place for all. */
static void chunk_aim(exr_chunks *chunks, const lmb_exr_targets *targets, int32_t x, int32_t y)
{
    for (int i = 0; i < chunks->decoder.channel_count; ++i) {
        exr_coding_channel_info_t *const channel = &chunks->decoder.channels[i];
        channel->decode_to_ptr = (uint8_t *)chunks->unwanted;
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = sizeof(float);
        channel->user_pixel_stride = sizeof(float);
        channel->user_line_stride = channel->width * (int32_t)sizeof(float);
        for (size_t k = 0; k < targets->count; ++k) {
            const lmb_exr_target *const target = &targets->target[k];
            if (strcmp(channel->channel_name, target->channel) == 0) {
                const size_t pixel = (size_t)y * (size_t)targets->width + (size_t)x;
                float *const first = target->base + pixel * (size_t)target->stride;
                channel->decode_to_ptr = (uint8_t *)first;
                channel->user_pixel_stride = target->stride * (int32_t)sizeof(float);
                channel->user_line_stride = targets->width * channel->user_pixel_stride;
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
static exr_result_t chunk_decode(exr_const_context_t context, const exr_chunk_info_t *chunk, exr_chunks *chunks,
                                 const lmb_exr_targets *targets, int32_t x, int32_t y)
{
    exr_decode_pipeline_t *const decoder = &chunks->decoder;
    const bool first = decoder->context == NULL;
    exr_result_t code =
        first ? exr_decoding_initialize(context, 0, chunk, decoder) : exr_decoding_update(context, 0, chunk, decoder);
    if (code == EXR_ERR_SUCCESS) {
        decoder->alloc_fn = buffer_allocate;
        decoder->free_fn = buffer_free;
        chunk_aim(chunks, targets, x, y);
        code = first ? exr_decoding_choose_default_routines(context, 0, decoder) : code;
    }
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(context, 0, decoder) : code;
}

static exr_result_t scanlines_decode(exr_const_context_t context, const lmb_exr_targets *targets, exr_chunks *chunks)
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
    if (code == EXR_ERR_SUCCESS) {
        code = unwanted_allocate(chunks, targets, targets->width, step);
    }
    for (int32_t y = 0; y < targets->height && code == EXR_ERR_SUCCESS; y += step) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(context, 0, window.min.y + y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = chunk.width == targets->width && chunk.height <= targets->height - y
                       ? chunk_decode(context, &chunk, chunks, targets, 0, y)
                       : EXR_ERR_CORRUPT_CHUNK;
        }
    }
    return code;
}

static exr_result_t tiles_decode(exr_const_context_t context, const lmb_exr_targets *targets, exr_chunks *chunks)
{
    int32_t tile_width = 0;
    int32_t tile_height = 0;
    exr_result_t code = exr_get_tile_sizes(context, 0, 0, 0, &tile_width, &tile_height);
    if (code == EXR_ERR_SUCCESS && (tile_width < 1 || tile_height < 1)) {
        return EXR_ERR_FILE_BAD_HEADER;
    }
    if (code == EXR_ERR_SUCCESS) {
        code = unwanted_allocate(chunks, targets, tile_width, tile_height);
    }
    for (int32_t y = 0; y < targets->height && code == EXR_ERR_SUCCESS; y += tile_height) {
        for (int32_t x = 0; x < targets->width && code == EXR_ERR_SUCCESS; x += tile_width) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(context, 0, x / tile_width, y / tile_height, 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) {
                code = chunk.width <= targets->width - x && chunk.height <= targets->height - y
                           ? chunk_decode(context, &chunk, chunks, targets, x, y)
                           : EXR_ERR_CORRUPT_CHUNK;
            }
        }
    }
    return code;
}

/* DWAA and DWAB need OpenEXR's C++ library. */
static lmb_result dwa_decode(const exr_source *source, const lmb_exr_targets *targets, lmb_error *error)
{
    if (!lmb_exr_attributes_fit(&source->file)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT,
                             "%s: an attribute of the EXR's header is of another length than it says",
                             source->file.name);
    }
    const lmb_result result = lmb_exr_decode_dwa(&source->file, targets, error);
    return result == LMB_ERROR_MEMORY && !memory_is_out()
               ? lmb_error_set(error, LMB_ERROR_FORMAT, "%s: the EXR's pixels are broken", source->file.name)
               : result;
}

static lmb_result pixels_decode(const exr_source *source, exr_const_context_t context, const lmb_exr_targets *targets,
                                lmb_error *error)
{
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_result_t code = exr_get_compression(context, 0, &compression);
    if (code == EXR_ERR_SUCCESS && (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB)) {
        return dwa_decode(source, targets, error);
    }
    exr_chunks chunks = {EXR_DECODE_PIPELINE_INITIALIZER, NULL, false};
    if (code == EXR_ERR_SUCCESS) {
        code = exr_get_storage(context, 0, &storage);
    }
    if (code == EXR_ERR_SUCCESS) {
        code = storage == EXR_STORAGE_TILED ? tiles_decode(context, targets, &chunks)
                                            : scanlines_decode(context, targets, &chunks);
    }
    exr_decoding_destroy(context, &chunks.decoder);
    free(chunks.unwanted);
    if (code == EXR_ERR_SUCCESS) {
        return LMB_OK;
    }
    if (chunks.out_of_memory) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory to decode the EXR's pixels", source->file.name);
    }
    char doing[64];
    snprintf(doing, sizeof doing, "cannot decode the EXR's %s pixels", compression_name(compression));
    return source_fail(source, code, doing, error);
}

/* The channels of a picture: three, or one for all colours. */
typedef struct exr_colour {
    const char *channel[3];
    size_t count;
} exr_colour;

/* The name in `channels` that is `prefix`, which need not end, followed by `suffix`; NULL: none. */
static const char *channel_find(const exr_attr_chlist_t *channels, const char *prefix, size_t prefix_length,
                                const char *suffix)
{
    for (int i = 0; i < channels->num_channels; ++i) {
        const char *const name = channels->entries[i].name.str;
        if (strncmp(name, prefix, prefix_length) == 0 && strcmp(name + prefix_length, suffix) == 0) {
            return name;
        }
    }
    return NULL;
}

static bool layer_is_combined(const char *name, size_t length)
{
    static const char COMBINED[] = "Combined";
    const size_t own = sizeof COMBINED - 1;
    return length >= own && strncmp(name + length - own, COMBINED, own) == 0 &&
           (length == own || name[length - own - 1] == '.');
}

/* The layer that is the picture: the first `Combined` one, as Blender calls what it rendered, or the only one. Returns
 * how many there are to choose from; 0 when none has R, G and B. */
static int layer_choose(const exr_attr_chlist_t *channels, exr_colour *colour)
{
    int layers = 0;
    for (int i = 0; i < channels->num_channels; ++i) {
        const char *const name = channels->entries[i].name.str;
        const char *const dot = strrchr(name, '.');
        const size_t length = dot ? (size_t)(dot - name) : 0;
        if (!dot || strcmp(dot, ".R") != 0) {
            continue;
        }
        const exr_colour found = {
            {name, channel_find(channels, name, length, ".G"), channel_find(channels, name, length, ".B")}, 3};
        if (!found.channel[1] || !found.channel[2]) {
            continue;
        }
        *colour = found;
        if (layer_is_combined(name, length)) {
            return 1;
        }
        ++layers;
    }
    return layers;
}

/* R, G and B; or Y; or those of a layer. */
static lmb_result colour_choose(const exr_source *source, exr_const_context_t context, exr_colour *colour,
                                lmb_error *error)
{
    const char *const name = source->file.name;
    if (channel_exists(context, "R") && channel_exists(context, "G") && channel_exists(context, "B")) {
        *colour = (exr_colour){{"R", "G", "B"}, 3};
        return LMB_OK;
    }
    if (channel_exists(context, "Y")) {
        *colour = (exr_colour){{"Y", NULL, NULL}, 1};
        return channel_exists(context, "RY") || channel_exists(context, "BY")
                   ? lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: luminance-chroma EXRs are not supported", name)
                   : LMB_OK;
    }
    const exr_attr_chlist_t *channels = NULL;
    const int layers =
        exr_get_channels(context, 0, &channels) == EXR_ERR_SUCCESS && channels ? layer_choose(channels, colour) : 0;
    if (layers > 1) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                             "%s: neither channels R, G, B nor Y, and %d layers that could be meant ('%s' is of one)",
                             name, layers, colour->channel[0]);
    }
    return layers == 1 ? LMB_OK
                       : lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                                       "%s: neither channels R, G, B nor Y in the file's first part", name);
}

/* Three channels, or one three times over. */
static lmb_result colour_decode(const exr_source *source, exr_const_context_t context, lmb_image *image,
                                lmb_latlong_axes *axes, lmb_error *error)
{
    const char *const name = source->file.name;
    exr_envmap_t kind;
    const bool marked = exr_attr_get_envmap(context, 0, "envmap", &kind) == EXR_ERR_SUCCESS;
    if (marked && kind != EXR_ENVMAP_LATLONG) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                             "%s: cube-map EXRs are not supported (OpenEXR's `exrenvmap -l` makes a lat-long one)",
                             name);
    }
    exr_colour colour = {{NULL, NULL, NULL}, 0};
    lmb_image decoded = {0, 0, NULL};
    lmb_result result = colour_choose(source, context, &colour, error);
    if (result == LMB_OK) {
        result = part_check(source, context, &decoded.width, &decoded.height, error);
    }
    if (result != LMB_OK) {
        return result;
    }
    const size_t pixels = (size_t)decoded.width * (size_t)decoded.height;
    decoded.rgb = malloc(3 * sizeof(float) * pixels);
    if (!decoded.rgb) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels", name, decoded.width,
                             decoded.height);
    }
    const lmb_exr_target targets[3] = {{colour.channel[0], decoded.rgb, 3},
                                       {colour.channel[1], decoded.rgb + 1, 3},
                                       {colour.channel[2], decoded.rgb + 2, 3}};
    result =
        pixels_decode(source, context, &(lmb_exr_targets){targets, colour.count, decoded.width, decoded.height}, error);
    if (result != LMB_OK) {
        free(decoded.rgb);
        return result;
    }
    for (size_t i = 0; i < pixels && colour.count == 1; ++i) {
        decoded.rgb[3 * i + 1] = decoded.rgb[3 * i + 2] = decoded.rgb[3 * i];
    }
    *image = decoded;
    *axes = marked ? LMB_LATLONG_OPENEXR : LMB_LATLONG_GLTF;
    return LMB_OK;
}

lmb_result lmb_exr_decode(const lmb_image_bytes *file, lmb_image *image, lmb_latlong_axes *axes, lmb_error *error)
{
    exr_source source = {.file = *file};
    exr_context_t context = NULL;
    lmb_result result = source_open(&source, &context, error);
    if (result == LMB_OK) {
        result = colour_decode(&source, context, image, axes, error);
        exr_finish(&context);
    }
    return result;
}

/* Allocates and reads `targets->count` channels, whose names `target` has. */
static lmb_result channels_decode(const exr_source *source, exr_const_context_t context, lmb_exr_target *target,
                                  lmb_exr_targets *targets, lmb_error *error)
{
    const char *const name = source->file.name;
    for (size_t i = 0; i < targets->count; ++i) {
        if (!channel_exists(context, target[i].channel)) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: no channel '%s'", name, target[i].channel);
        }
    }
    const lmb_result result = part_check(source, context, &targets->width, &targets->height, error);
    if (result != LMB_OK) {
        return result;
    }
    const size_t pixels = (size_t)targets->width * (size_t)targets->height;
    for (size_t i = 0; i < targets->count; ++i) {
        target[i].base = malloc(sizeof(float) * pixels);
        target[i].stride = 1;
        if (!target[i].base) {
            return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels of %zu channels", name,
                                 targets->width, targets->height, targets->count);
        }
    }
    return pixels_decode(source, context, targets, error);
}

/* The same of a file; header and values stay as they are when it fails. */
static lmb_result file_decode(exr_source *source, const char *const *names, lmb_exr_targets *targets, float **values,
                              lmb_exr_header *header, lmb_error *error)
{
    exr_context_t context = NULL;
    lmb_exr_target *const target = calloc(targets->count + 1, sizeof *target);
    lmb_result result = target ? source_open(source, &context, error)
                               : lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", source->file.name);
    if (result == LMB_OK) {
        for (size_t i = 0; i < targets->count; ++i) {
            target[i].channel = names[i];
        }
        targets->target = target;
        result = channels_decode(source, context, target, targets, error);
        if (result == LMB_OK) {
            *header = (lmb_exr_header){targets->width, targets->height, 1.0f};
            (void)exr_attr_get_float(context, 0, SCALE_ATTRIBUTE, &header->scale); /* absent: stays 1 */
        }
        exr_finish(&context);
    }
    for (size_t i = 0; i < targets->count && target; ++i) {
        if (result == LMB_OK) {
            values[i] = target[i].base;
        } else {
            free(target[i].base);
        }
    }
    free(target);
    return result;
}

lmb_result lmb_exr_decode_channels(const lmb_image_bytes *file, const char *const *names, size_t count, float **values,
                                   lmb_exr_header *header, lmb_error *error)
{
    exr_source source = {.file = *file};
    lmb_exr_targets targets = {.count = count};
    return lmb_exr_is(file) ? file_decode(&source, names, &targets, values, header, error)
                            : lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not an OpenEXR file", file->name);
}

lmb_result lmb_exr_read_channels(const char *path, const char *const *names, size_t count, float **values,
                                 lmb_exr_header *header, lmb_error *error)
{
    assert(path && names && values && header);
    unsigned char *data = NULL;
    size_t size = 0;
    lmb_result result = lmb_file_read(path, &data, &size, error);
    if (result == LMB_OK) {
        result = lmb_exr_decode_channels(&(lmb_image_bytes){path, data, size}, names, count, values, header, error);
        free(data);
    }
    return result;
}

lmb_result lmb_exr_list_channels(const char *path, lmb_exr_name *names, size_t most, size_t *count, lmb_error *error)
{
    unsigned char *data = NULL;
    exr_source source = {.file = {.name = path}};
    exr_context_t context = NULL;
    lmb_result result = lmb_file_read(path, &data, &source.file.size, error);
    if (result != LMB_OK) {
        return result;
    }
    source.file.data = data;
    result = lmb_exr_is(&source.file) ? source_open(&source, &context, error)
                                      : lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not an OpenEXR file", path);
    if (result == LMB_OK) {
        const exr_attr_chlist_t *channels = NULL;
        const bool listed = exr_get_channels(context, 0, &channels) == EXR_ERR_SUCCESS && channels;
        *count = listed ? (size_t)channels->num_channels : 0;
        for (size_t i = 0; i < *count && i < most; ++i) {
            snprintf(names[i].text, sizeof names[i].text, "%s", channels->entries[i].name.str);
        }
        exr_finish(&context);
    }
    free(data);
    return result;
}
