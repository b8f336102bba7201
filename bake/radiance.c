/* Radiance .hdr (RGBE): G. Ward, "Real Pixels", Graphics Gems II, 1991, and Radiance's color.c for the run lengths.
 * stb_image is not used to read them: it never returns from a scanline that the end of the file cuts off. EXPOSURE is
 * left alone, as viewers and engines do. */
#include "image_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    const char *name;
    const unsigned char *at;
    const unsigned char *end;
    lmb_error *error;
} reader;

bool lmb_radiance_is(const unsigned char *data, size_t size)
{
    return (size >= 10 && memcmp(data, "#?RADIANCE", 10) == 0) || (size >= 6 && memcmp(data, "#?RGBE", 6) == 0);
}

/* Copies the next line without its end; a longer one is cut. False at the end of the file. */
static bool line_next(reader *in, char *line, size_t capacity)
{
    const unsigned char *const newline = memchr(in->at, '\n', (size_t)(in->end - in->at));
    if (!newline) {
        return false;
    }
    size_t length = (size_t)(newline - in->at);
    if (length > 0 && in->at[length - 1] == '\r') {
        --length;
    }
    const size_t copied = length < capacity - 1 ? length : capacity - 1;
    memcpy(line, in->at, copied);
    line[copied] = '\0';
    in->at = newline + 1;
    return true;
}

/* A decimal number of at most 9 digits after `prefix`; NULL when there is none, else what follows it. */
static const char *size_parse(const char *text, const char *prefix, int32_t *value)
{
    const size_t length = strlen(prefix);
    if (strncmp(text, prefix, length) != 0) {
        return NULL;
    }
    const char *at = text + length;
    *value = 0;
    while (*at >= '0' && *at <= '9' && at - text < (ptrdiff_t)length + 9) {
        *value = *value * 10 + (*at++ - '0');
    }
    return *value > 0 ? at : NULL;
}

static lmb_result header_read(reader *in, int32_t *width, int32_t *height)
{
    char line[256];
    bool more = line_next(in, line, sizeof line);
    while (more && line[0] != '\0') {
        if (strncmp(line, "FORMAT=", 7) == 0 && strcmp(line + 7, "32-bit_rle_rgbe") != 0) {
            return lmb_error_set(in->error, LMB_ERROR_UNSUPPORTED, "%s: Radiance pixel format '%s' is not supported",
                                 in->name, line + 7);
        }
        more = line_next(in, line, sizeof line);
    }
    if (!more || !line_next(in, line, sizeof line)) {
        return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: the file ends in its header", in->name);
    }
    const char *rest = size_parse(line, "-Y ", height);
    rest = rest ? size_parse(rest, " +X ", width) : NULL;
    if (!rest || *rest != '\0') {
        const bool other_order = strpbrk(line, "XY") != NULL && strncmp(line, "-Y ", 3) != 0;
        return other_order
                   ? lmb_error_set(in->error, LMB_ERROR_UNSUPPORTED,
                                   "%s: pixel order '%s' is not supported (only -Y height +X width)", in->name, line)
                   : lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: '%s' is no picture size", in->name, line);
    }
    if (*width > LMB_IMAGE_MAX_SIDE || *height > LMB_IMAGE_MAX_SIDE ||
        (int64_t)*width * *height > LMB_IMAGE_MAX_PIXELS) {
        return lmb_error_set(in->error, LMB_ERROR_UNSUPPORTED, "%s: %d x %d pixels are too many", in->name, *width,
                             *height);
    }
    return LMB_OK;
}

static bool is_run_length_coded(const unsigned char *at, int32_t width)
{
    return width >= 8 && width < 32768 && at[0] == 2 && at[1] == 2 && at[2] < 128;
}

/* Each of the four bytes of the scanline's pixels in turn, as runs (128 + n, value) and literals (n, n values). */
static lmb_result scanline_unpack(reader *in, int32_t row, int32_t width, unsigned char *rgbe)
{
    if ((in->at[2] << 8 | in->at[3]) != width) {
        return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: row %d is not as wide as the picture", in->name, row);
    }
    in->at += 4;
    for (int c = 0; c < 4; ++c) {
        int32_t x = 0;
        while (x < width) {
            const ptrdiff_t left = in->end - in->at;
            const int code = left > 0 ? in->at[0] : 0;
            const bool run = code > 128;
            const int count = run ? code - 128 : code;
            if (left < 1 || left < 1 + (run ? 1 : count)) {
                return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: the file ends in row %d", in->name, row);
            }
            if (count == 0 || count > width - x) {
                return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: row %d has a bad run length", in->name, row);
            }
            ++in->at;
            for (int i = 0; i < count; ++i) {
                rgbe[4 * x++ + c] = in->at[run ? 0 : i];
            }
            in->at += run ? 1 : count;
        }
    }
    return LMB_OK;
}

static lmb_result scanline_read(reader *in, int32_t row, int32_t width, unsigned char *rgbe)
{
    const size_t left = (size_t)(in->end - in->at);
    if (left >= 4 && is_run_length_coded(in->at, width)) {
        return scanline_unpack(in, row, width, rgbe);
    }
    const size_t flat = 4 * (size_t)width;
    const size_t whole = left < flat ? left / 4 * 4 : flat;
    for (size_t i = 0; i < whole; i += 4) {
        if (in->at[i] == 1 && in->at[i + 1] == 1 && in->at[i + 2] == 1) {
            return lmb_error_set(in->error, LMB_ERROR_UNSUPPORTED, "%s: old run-length coding is not supported",
                                 in->name);
        }
    }
    if (left < flat) {
        return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: the file ends in row %d", in->name, row);
    }
    memcpy(rgbe, in->at, flat);
    in->at += flat;
    return LMB_OK;
}

static void scanline_convert(const unsigned char *rgbe, int32_t width, float *rgb)
{
    for (int32_t x = 0; x < width; ++x, rgbe += 4, rgb += 3) {
        const float scale = rgbe[3] > 0 ? ldexpf(1.0f, rgbe[3] - (128 + 8)) : 0.0f;
        for (int c = 0; c < 3; ++c) {
            rgb[c] = scale * (float)rgbe[c];
        }
    }
}

lmb_result lmb_radiance_decode(const char *name, const unsigned char *data, size_t size, lmb_image *image,
                               lmb_error *error)
{
    reader in = {name, data, data + size, error};
    int32_t width = 0;
    int32_t height = 0;
    lmb_result result = header_read(&in, &width, &height);
    if (result != LMB_OK) {
        return result;
    }
    /* The least that a row takes, so that a small file cannot ask for gigabytes: runs of 127, else flat pixels. */
    const size_t row_least = width >= 8 && width < 32768 ? 4 + 8 * (((size_t)width + 126) / 127) : 4 * (size_t)width;
    if ((size_t)(in.end - in.at) / row_least < (size_t)height) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: the file is too short for %d x %d pixels", name, width,
                             height);
    }
    unsigned char *const rgbe = malloc(4 * (size_t)width);
    float *const rgb = malloc(3 * sizeof(float) * (size_t)width * (size_t)height);
    if (!rgbe || !rgb) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels", name, width, height);
    }
    for (int32_t y = 0; y < height && result == LMB_OK; ++y) {
        result = scanline_read(&in, y, width, rgbe);
        if (result == LMB_OK) {
            scanline_convert(rgbe, width, rgb + 3 * (size_t)y * (size_t)width);
        }
    }
    free(rgbe);
    if (result != LMB_OK) {
        free(rgb);
        return result;
    }
    *image = (lmb_image){width, height, rgb};
    return LMB_OK;
}
