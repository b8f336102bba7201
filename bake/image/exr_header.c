/* The headers of an EXR file, looked at before OpenEXR's C++ library reads them: it takes a known type's values
 * whatever the attribute says of its size, so that what comes next is read at another place, and takes memory for a
 * size before it looks how much there is. */
#include "image/exr_internal.h"

#include <string.h>

/* The place behind the NUL that ends a text at `at`; the file's size where there is none. */
static size_t text_end(const lmb_image_bytes *file, size_t at)
{
    const unsigned char *const end = at < file->size ? memchr(file->data + at, '\0', file->size - at) : NULL;
    return end ? (size_t)(end - file->data) + 1 : file->size;
}

static uint32_t number_at(const unsigned char *data)
{
    return data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16 | (uint32_t)data[3] << 24;
}

/* Channels: name, and 16 bytes of each; then an empty name. */
static bool channels_fill(const lmb_image_bytes *file, size_t at, size_t end)
{
    while (at < end && file->data[at] != '\0') {
        at = text_end(file, at);
        if (at > end || end - at < 16) {
            return false;
        }
        at += 16;
    }
    return at + 1 == end;
}

/* Texts, with their lengths before them. */
static bool texts_fill(const lmb_image_bytes *file, size_t at, size_t end)
{
    while (end - at >= 4) {
        const uint32_t length = number_at(file->data + at);
        at += 4;
        if (length > end - at) {
            return false;
        }
        at += length;
    }
    return at == end;
}

/* Width, height, and a small picture of four bytes a pixel. */
static bool preview_fills(const lmb_image_bytes *file, size_t at, size_t end)
{
    if (end - at < 8) {
        return false;
    }
    const uint64_t width = number_at(file->data + at), height = number_at(file->data + at + 4);
    return width <= end && height <= end && width * height * 4 == end - at - 8;
}

/* Whether a value of `type` fills the bytes from `at` to `end`, as far as is known of it. */
static bool value_fills(const lmb_image_bytes *file, const char *type, size_t at, size_t end)
{
    static const struct {
        const char *type;
        size_t bytes;
    } sizes[] = {
        {"box2f", 16},
        {"box2i", 16},
        {"chromaticities", 32},
        {"compression", 1},
        {"deepImageState", 1},
        {"double", 8},
        {"envmap", 1},
        {"float", 4},
        {"int", 4},
        {"keycode", 28},
        {"lineOrder", 1},
        {"m33d", 72},
        {"m33f", 36},
        {"m44d", 128},
        {"m44f", 64},
        {"rational", 8},
        {"tiledesc", 9},
        {"timecode", 8},
        {"v2d", 16},
        {"v2f", 8},
        {"v2i", 8},
        {"v3d", 24},
        {"v3f", 12},
        {"v3i", 12},
    };
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; ++i) {
        if (strcmp(type, sizes[i].type) == 0) {
            return end - at == sizes[i].bytes;
        }
    }
    return strcmp(type, "chlist") == 0         ? channels_fill(file, at, end)
           : strcmp(type, "stringvector") == 0 ? texts_fill(file, at, end)
           : strcmp(type, "preview") == 0      ? preview_fills(file, at, end)
           : strcmp(type, "floatvector") == 0  ? (end - at) % 4 == 0
                                               : true;
}

/* An attribute is a name, a type, 32 bits of size, and so many bytes; an empty name ends a header. */
bool lmb_exr_attributes_fit(const lmb_image_bytes *file)
{
    const bool many_parts = file->size > 8 && (file->data[5] & 0x10) != 0; /* headers until an empty one */
    size_t at = 8;
    while (at < file->size) {
        if (file->data[at] == '\0') {
            ++at;
            if (!many_parts || at >= file->size || file->data[at] == '\0') {
                return true;
            }
        }
        const size_t type = text_end(file, at);
        at = text_end(file, type);
        if (file->size - at < 4) {
            return false;
        }
        const uint32_t length = number_at(file->data + at);
        at += 4;
        if (length > file->size - at || !value_fills(file, (const char *)file->data + type, at, at + length)) {
            return false;
        }
        at += length;
    }
    return false;
}
