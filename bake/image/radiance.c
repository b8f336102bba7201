/* Radiance .hdr (RGBE): G. Ward, "Real Pixels", Graphics Gems II, 1991, and Radiance's color.c for the run lengths.
 * stb_image is not used to read them: it never returns from a scanline that the end of the file cuts off. EXPOSURE is
 * left alone, as viewers and engines do. */
#include "image/radiance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
    const char *name;
    const unsigned char *at;
    const unsigned char *end;
    const char *line; /* what a scanline is: "row" or "column" */
    lmb_error *error;
} reader;

/* How the file's scanlines lie in the picture, as the size says: "-Y 512 +X 1024" are 512 rows from the top, each from
 * the left. X grows to the right and Y upwards; the axis that is named first is the one that scanlines follow. */
typedef struct scan_order {
    int32_t lines, length; /* scanlines, and pixels in each */
    bool columns;          /* scanlines are columns, not rows */
    bool backwards[2];     /* the first scanline, the first pixel is the picture's last */
} scan_order;

bool lmb_radiance_is(const lmb_image_bytes *file)
{
    return (file->size >= 10 && memcmp(file->data, "#?RADIANCE", 10) == 0) ||
           (file->size >= 6 && memcmp(file->data, "#?RGBE", 6) == 0);
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

/* "+X 1024" or the like: a decimal number of at most 9 digits. NULL when it is none, else what follows it. */
static const char *axis_parse(const char *text, char *axis, bool *backwards, int32_t *value)
{
    if ((text[0] != '+' && text[0] != '-') || (text[1] != 'X' && text[1] != 'Y') || text[2] != ' ') {
        return NULL;
    }
    *axis = text[1];
    *backwards = (text[0] == '-') == (text[1] == 'X'); /* row 0 is the top */
    const char *at = text + 3;
    *value = 0;
    while (*at >= '0' && *at <= '9' && at - text < 3 + 9) {
        *value = *value * 10 + (*at++ - '0');
    }
    return *value > 0 ? at : NULL;
}

static bool order_parse(const char *line, scan_order *order)
{
    char first = '\0', second = '\0';
    const char *rest = axis_parse(line, &first, &order->backwards[0], &order->lines);
    rest = rest && *rest == ' ' ? axis_parse(rest + 1, &second, &order->backwards[1], &order->length) : NULL;
    order->columns = first == 'X';
    return rest && *rest == '\0' && first != second;
}

static lmb_result header_read(reader *in, scan_order *order)
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
    if (!order_parse(line, order)) {
        return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: '%s' is no picture size (-Y height +X width)", in->name,
                             line);
    }
    if (order->lines > LMB_IMAGE_MAX_SIDE || order->length > LMB_IMAGE_MAX_SIDE ||
        (int64_t)order->lines * order->length > LMB_IMAGE_MAX_PIXELS) {
        return lmb_error_set(in->error, LMB_ERROR_UNSUPPORTED, "%s: '%s' are too many pixels", in->name, line);
    }
    in->line = order->columns ? "column" : "row";
    return LMB_OK;
}

static bool is_run_length_coded(const unsigned char *at, int32_t length)
{
    return length >= 8 && length < 32768 && at[0] == 2 && at[1] == 2 && at[2] < 128;
}

/* Each of the four bytes of the scanline's pixels in turn, as runs (128 + n, value) and literals (n, n values). */
static lmb_result scanline_unpack(reader *in, int32_t index, int32_t length, unsigned char *rgbe)
{
    if ((in->at[2] << 8 | in->at[3]) != length) {
        return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: %s %d is not as long as the picture", in->name, in->line,
                             index);
    }
    in->at += 4;
    for (int c = 0; c < 4; ++c) {
        int32_t x = 0;
        while (x < length) {
            const ptrdiff_t left = in->end - in->at;
            const int code = left > 0 ? in->at[0] : 0;
            const bool run = code > 128;
            const int count = run ? code - 128 : code;
            if (left < 1 || left < 1 + (run ? 1 : count)) {
                return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: the file ends in %s %d", in->name, in->line,
                                     index);
            }
            if (count == 0 || count > length - x) {
                return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: %s %d has a bad run length", in->name, in->line,
                                     index);
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

static lmb_result scanline_read(reader *in, int32_t index, int32_t length, unsigned char *rgbe)
{
    const size_t left = (size_t)(in->end - in->at);
    if (left >= 4 && is_run_length_coded(in->at, length)) {
        return scanline_unpack(in, index, length, rgbe);
    }
    const size_t flat = 4 * (size_t)length;
    const size_t whole = left < flat ? left / 4 * 4 : flat;
    for (size_t i = 0; i < whole; i += 4) {
        if (in->at[i] == 1 && in->at[i + 1] == 1 && in->at[i + 2] == 1) {
            return lmb_error_set(in->error, LMB_ERROR_UNSUPPORTED, "%s: old run-length coding is not supported",
                                 in->name);
        }
    }
    if (left < flat) {
        return lmb_error_set(in->error, LMB_ERROR_FORMAT, "%s: the file ends in %s %d", in->name, in->line, index);
    }
    memcpy(rgbe, in->at, flat);
    in->at += flat;
    return LMB_OK;
}

/* Puts a scanline's pixels where they are in the picture. */
static void scanline_place(const unsigned char *rgbe, const scan_order *order, int32_t index, lmb_image *image)
{
    const int32_t line = order->backwards[0] ? order->lines - 1 - index : index;
    for (int32_t i = 0; i < order->length; ++i, rgbe += 4) {
        const int32_t along = order->backwards[1] ? order->length - 1 - i : i;
        const int32_t x = order->columns ? line : along;
        const int32_t y = order->columns ? along : line;
        float *const rgb = image->rgb + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
        const float scale = rgbe[3] > 0 ? ldexpf(1.0f, rgbe[3] - (128 + 8)) : 0.0f;
        for (int c = 0; c < 3; ++c) {
            rgb[c] = scale * (float)rgbe[c];
        }
    }
}

lmb_result lmb_radiance_decode(const lmb_image_bytes *file, lmb_image *image, lmb_error *error)
{
    reader in = {.name = file->name, .at = file->data, .end = file->data + file->size, .error = error};
    scan_order order = {0, 0, false, {false, false}};
    lmb_result result = header_read(&in, &order);
    if (result != LMB_OK) {
        return result;
    }
    const size_t length = (size_t)order.length;
    lmb_image decoded = {order.columns ? order.lines : order.length, order.columns ? order.length : order.lines, NULL};
    /* The least that a scanline takes, so that a small file cannot ask for gigabytes: runs of 127, else flat pixels. */
    const size_t line_least = length >= 8 && length < 32768 ? 4 + 8 * ((length + 126) / 127) : 4 * length;
    if ((size_t)(in.end - in.at) / line_least < (size_t)order.lines) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: the file is too short for %d x %d pixels", in.name,
                             decoded.width, decoded.height);
    }
    unsigned char *const rgbe = malloc(4 * length);
    decoded.rgb = malloc(3 * sizeof(float) * length * (size_t)order.lines);
    if (!rgbe || !decoded.rgb) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory for %d x %d pixels", in.name, decoded.width,
                               decoded.height);
    }
    for (int32_t i = 0; i < order.lines && result == LMB_OK; ++i) {
        result = scanline_read(&in, i, order.length, rgbe);
        if (result == LMB_OK) {
            scanline_place(rgbe, &order, i, &decoded);
        }
    }
    free(rgbe);
    if (result != LMB_OK) {
        free(decoded.rgb);
        return result;
    }
    *image = decoded;
    return LMB_OK;
}
