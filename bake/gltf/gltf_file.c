#define _POSIX_C_SOURCE 200809L

#include "gltf/gltf_file.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/file.h>

/* tinygltf counts in unsigned int and GLB in 32 bits; half of that leaves room for sums. */
#define MAX_FILE_SIZE ((size_t)0x7fffffff)
/* cJSON needs some 40 bytes for each byte of JSON at worst. */
#define MAX_JSON_SIZE ((size_t)256 << 20)
#define MAX_PRINTED 1e308

/* Refuses what is not a plain file (a pipe would hang) or too large before reading it. */
static lmb_result read_plain_file(const char *path, const char *shown, unsigned char **data, size_t *size,
                                  lmb_error *error)
{
    struct stat status;
    if (stat(path, &status) == 0) {
        if (!S_ISREG(status.st_mode)) {
            return lmb_error_set(error, LMB_ERROR_IO, "%s: not a plain file", shown);
        }
        if ((uintmax_t)status.st_size > MAX_FILE_SIZE) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: larger than 2 GiB", shown);
        }
    }
    lmb_error reason;
    const lmb_result result = lmb_file_read(path, data, size, &reason);
    if (result != LMB_OK) {
        /* lmb_file_read begins with the path; what is shown may name the place as well. */
        const size_t length = strlen(path);
        const bool named = strncmp(reason.message, path, length) == 0;
        return lmb_error_set(error, result, "%s%s%s", shown, named ? "" : ": ", reason.message + (named ? length : 0));
    }
    return LMB_OK;
}

void lmb_gltf_place(char place[LMB_GLTF_PLACE_SIZE], const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(place, LMB_GLTF_PLACE_SIZE, format, arguments);
    va_end(arguments);
}

uint32_t lmb_gltf_uint(const cJSON *object, const char *name, uint32_t missing)
{
    const cJSON *const item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(item) ? (uint32_t)item->valuedouble : missing;
}

static uint32_t read_u32(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/* Finds the JSON (and the binary chunk) in the file's bytes. */
static lmb_result split_container(lmb_gltf_file *file, const unsigned char **json, size_t *json_size, lmb_error *error)
{
    *json = file->data;
    *json_size = file->size;
    if (file->size < 4 || memcmp(file->data, "glTF", 4) != 0) {
        return LMB_OK;
    }
    if (file->size < 20) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB header: the file ends after %zu bytes", file->path,
                             file->size);
    }
    if (read_u32(file->data + 4) != 2) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: GLB header: version %u, not 2", file->path,
                             read_u32(file->data + 4));
    }
    const size_t length = read_u32(file->data + 8);
    if (length > file->size || length < 20) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB header: says %zu bytes, the file has %zu", file->path,
                             length, file->size);
    }
    size_t offset = 12;
    for (unsigned chunk = 0; length - offset >= 8; ++chunk) {
        const size_t size = read_u32(file->data + offset);
        const unsigned char *const type = file->data + offset + 4;
        if (size > length - offset - 8) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB chunk %u: says %zu bytes, %zu are left", file->path,
                                 chunk, size, length - offset - 8);
        }
        const unsigned char *const contents = file->data + offset + 8;
        if (chunk == 0) {
            if (memcmp(type, "JSON", 4) != 0) {
                return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB chunk 0: not JSON", file->path);
            }
            *json = contents;
            *json_size = size;
        } else if (chunk == 1 && memcmp(type, "BIN\0", 4) == 0) {
            file->bin = contents;
            file->bin_size = size;
        }
        offset += 8 + size;
    }
    if (offset != length) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: GLB: %zu bytes after the last chunk", file->path,
                             length - offset);
    }
    return LMB_OK;
}

/* cJSON prints the largest doubles larger than they are, which other readers then refuse. */
static void limit_numbers(cJSON *item)
{
    if (cJSON_IsNumber(item) && isfinite(item->valuedouble) && fabs(item->valuedouble) > MAX_PRINTED) {
        item->valuedouble = copysign(MAX_PRINTED, item->valuedouble);
    }
    cJSON *child;
    cJSON_ArrayForEach(child, item)
    {
        limit_numbers(child); /* depth is bounded by cJSON's nesting limit */
    }
}

static lmb_result parse_json(lmb_gltf_file *file, const unsigned char *json, size_t size, lmb_error *error)
{
    if (size > MAX_JSON_SIZE) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: JSON larger than %zu bytes", file->path, MAX_JSON_SIZE);
    }
    const char *end = NULL;
    file->root = cJSON_ParseWithLengthOpts((const char *)json, size, &end, false);
    const unsigned char *at = end ? (const unsigned char *)end : json;
    if (file->root) {
        while (at < json + size && (isspace(*at) || *at == 0)) {
            ++at;
        }
    }
    if (!file->root || at < json + size) {
        unsigned line = 1;
        for (const unsigned char *c = json; c < at && c < json + size; ++c) {
            line += *c == '\n';
        }
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: line %u: not JSON", file->path, line);
    }
    if (!cJSON_IsObject(file->root)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not a JSON object", file->path);
    }
    limit_numbers(file->root);
    return LMB_OK;
}

static int base64_digit(unsigned char c)
{
    if (c >= 'A' && c <= 'Z') {
        return c - 'A';
    }
    if (c >= 'a' && c <= 'z') {
        return c - 'a' + 26;
    }
    if (c >= '0' && c <= '9') {
        return c - '0' + 52;
    }
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Decodes base64 up to its end or padding. @return false on any other character */
static bool base64_decode(const char *text, unsigned char *bytes, size_t *size)
{
    uint32_t bits = 0;
    unsigned bit_count = 0;
    size_t used = 0;
    for (; *text && *text != '='; ++text) {
        const int digit = base64_digit((unsigned char)*text);
        if (digit < 0) {
            return false;
        }
        bits = (bits << 6 | (uint32_t)digit) & 0xffffffu;
        bit_count += 6;
        if (bit_count >= 8) {
            bit_count -= 8;
            bytes[used++] = (unsigned char)(bits >> bit_count);
        }
    }
    *size = used;
    return strspn(text, "=") == strlen(text) && strlen(text) <= 2;
}

static int hex_digit(char c)
{
    return isdigit((unsigned char)c) ? c - '0' : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10 : -1;
}

/* Undoes %XX; anything else stays. @return number of bytes written, at most strlen(text) */
static size_t percent_decode(const char *text, unsigned char *bytes)
{
    size_t used = 0;
    while (*text) {
        if (text[0] == '%' && hex_digit(text[1]) >= 0 && hex_digit(text[2]) >= 0) {
            bytes[used++] = (unsigned char)(hex_digit(text[1]) * 16 + hex_digit(text[2]));
            text += 3;
        } else {
            bytes[used++] = (unsigned char)*text++;
        }
    }
    return used;
}

static lmb_result read_data_uri(const lmb_gltf_file *file, const char *uri, const char *place, lmb_gltf_bytes *bytes,
                                lmb_error *error)
{
    const char *const comma = strchr(uri, ',');
    if (!comma) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: data URI without a comma", file->path, place);
    }
    unsigned char *const data = malloc(strlen(comma));
    if (!data) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, place);
    }
    static const char base64[] = ";base64";
    const size_t head = (size_t)(comma - uri);
    size_t size = 0;
    if (head >= sizeof base64 - 1 && memcmp(comma - (sizeof base64 - 1), base64, sizeof base64 - 1) == 0) {
        if (!base64_decode(comma + 1, data, &size)) {
            free(data);
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: broken base64", file->path, place);
        }
    } else {
        size = percent_decode(comma + 1, data);
    }
    *bytes = (lmb_gltf_bytes){data, size, data};
    return LMB_OK;
}

/* "name:" before any slash, as in http: or C: */
static bool has_scheme(const char *uri)
{
    const size_t length = strcspn(uri, ":/?#");
    return uri[length] == ':' && isalpha((unsigned char)uri[0]);
}

static bool leaves_folder(const char *path)
{
    if (path[0] == '/') {
        return true;
    }
    long depth = 0;
    while (*path) {
        const size_t length = strcspn(path, "/");
        if (length == 2 && path[0] == '.' && path[1] == '.') {
            --depth;
        } else if (length > 0 && !(length == 1 && path[0] == '.')) {
            ++depth;
        }
        if (depth < 0) {
            return true;
        }
        path += length;
        path += *path == '/';
    }
    return false;
}

lmb_result lmb_gltf_uri_read(lmb_gltf_file *file, const char *uri, const char *place, lmb_gltf_bytes *bytes,
                             lmb_error *error)
{
    if (strncmp(uri, "data:", 5) == 0) {
        return read_data_uri(file, uri, place, bytes, error);
    }
    if (has_scheme(uri)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: \"%s\" is not a file's name", file->path, place,
                             uri);
    }
    const char *const slash = strrchr(file->path, '/');
    const size_t folder = slash ? (size_t)(slash - file->path) + 1 : 0;
    char *const path = malloc(folder + strlen(uri) + 1);
    char *const shown = malloc(strlen(file->path) + strlen(place) + strlen(uri) + 16);
    lmb_result result = LMB_OK;
    if (!path || !shown) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, place);
        goto cleanup;
    }
    char *name = path + folder;
    const size_t length = percent_decode(uri, (unsigned char *)name);
    name[length] = '\0';
    if (length == 0 || strlen(name) != length) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: not a file's name", file->path, place);
        goto cleanup;
    }
    if (!file->allow_outside_uris && leaves_folder(name)) {
        result = lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: \"%s\" leaves the level's folder", file->path,
                               place, name);
        goto cleanup;
    }
    if (name[0] == '/') {
        memmove(path, name, length + 1);
        name = path;
    } else {
        memcpy(path, file->path, folder);
    }
    sprintf(shown, "%s: %s: \"%s\"", file->path, place, name);
    unsigned char *data;
    size_t size;
    result = read_plain_file(path, shown, &data, &size, error);
    if (result == LMB_OK) {
        *bytes = (lmb_gltf_bytes){data, size, data};
        file->hash = lmb_hash(file->hash, data, size);
    }
cleanup:
    free(path);
    free(shown);
    return result;
}

lmb_result lmb_gltf_buffers_read(lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(file->root, "buffers");
    const int count = cJSON_GetArraySize(list);
    file->buffers = calloc((size_t)count + 1, sizeof *file->buffers);
    if (!file->buffers) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        lmb_gltf_bytes *const buffer = &file->buffers[file->buffer_count];
        const cJSON *const uri = cJSON_GetObjectItemCaseSensitive(item, "uri");
        const size_t length = lmb_gltf_uint(item, "byteLength", 0);
        char place[LMB_GLTF_PLACE_SIZE];
        lmb_gltf_place(place, "buffers[%u]", file->buffer_count);
        if (uri) {
            const lmb_result result = lmb_gltf_uri_read(file, uri->valuestring, place, buffer, error);
            if (result != LMB_OK) {
                return result;
            }
        } else if (file->buffer_count == 0 && file->bin) {
            *buffer = (lmb_gltf_bytes){file->bin, file->bin_size, NULL};
        } else {
            *buffer = (lmb_gltf_bytes){NULL, length, NULL}; /* legal as long as nobody reads it */
        }
        ++file->buffer_count;
        if (buffer->size < length) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: byteLength %zu, but %zu bytes are there", file->path,
                                 place, length, buffer->size);
        }
        buffer->size = length;
    }
    return LMB_OK;
}

lmb_result lmb_gltf_file_read(lmb_gltf_file *file, lmb_error *error)
{
    const unsigned char *json;
    size_t json_size;
    lmb_result result = read_plain_file(file->path, file->path, &file->data, &file->size, error);
    if (result == LMB_OK) {
        file->hash = lmb_hash(LMB_HASH_SEED, file->data, file->size);
        result = split_container(file, &json, &json_size, error);
    }
    return result == LMB_OK ? parse_json(file, json, json_size, error) : result;
}

void lmb_gltf_file_close(lmb_gltf_file *file)
{
    if (!file) {
        return;
    }
    for (uint32_t i = 0; file->buffers && i < file->buffer_count; ++i) {
        free(file->buffers[i].owned);
    }
    free(file->buffers);
    free((void *)file->views);
    free(file->accessors);
    cJSON_Delete(file->root);
    free(file->data);
    free(file->path);
    free(file);
}
