#define _POSIX_C_SOURCE 200809L

#include "gltf/gltf_file.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/file.h>

/* cJSON needs some 40 bytes for each byte of JSON at worst. */
#define MAX_JSON_SIZE ((size_t)256 << 20)
#define MAX_PRINTED 1e308

lmb_result lmb_gltf_plain_file_read(const char *path, const char *shown, lmb_gltf_bytes *bytes, lmb_error *error)
{
    struct stat status;
    if (stat(path, &status) == 0) {
        if (!S_ISREG(status.st_mode)) {
            return lmb_error_set(error, LMB_ERROR_IO, "%s: not a plain file", shown);
        }
        if ((uintmax_t)status.st_size > LMB_GLTF_MAX_SIZE) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: larger than 2 GiB", shown);
        }
    }
    unsigned char *data;
    size_t size;
    lmb_error reason;
    const lmb_result result = lmb_file_read(path, &data, &size, &reason);
    if (result != LMB_OK) {
        /* lmb_file_read begins with the path; what is shown may say where in the level it stands. */
        const size_t length = strlen(path);
        const bool named = strncmp(reason.message, path, length) == 0;
        return lmb_error_set(error, result, "%s%s%s", shown, named ? "" : ": ", reason.message + (named ? length : 0));
    }
    *bytes = (lmb_gltf_bytes){data, size, data};
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

static lmb_result parse_json(lmb_gltf_file *file, lmb_gltf_bytes text, lmb_error *error)
{
    if (text.size > MAX_JSON_SIZE) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: JSON larger than %zu bytes", file->path, MAX_JSON_SIZE);
    }
    const unsigned char *const json = text.data, *const after = json + text.size;
    const char *end = NULL;
    file->root = cJSON_ParseWithLengthOpts((const char *)json, text.size, &end, false);
    const unsigned char *at = end ? (const unsigned char *)end : json;
    if (file->root) {
        while (at < after && (isspace(*at) || *at == 0)) {
            ++at;
        }
    }
    if (!file->root || at < after) {
        unsigned line = 1;
        for (const unsigned char *c = json; c < at && c < after; ++c) {
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

static lmb_result read_bytes(lmb_gltf_file *file, const lmb_gltf_source *source, lmb_error *error)
{
    if (!source->data) {
        return lmb_gltf_plain_file_read(file->path, file->path, &file->bytes, error);
    }
    if (source->size > LMB_GLTF_MAX_SIZE) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: larger than 2 GiB", file->path);
    }
    file->bytes = (lmb_gltf_bytes){source->data, source->size, NULL};
    return LMB_OK;
}

static lmb_result read_json(lmb_gltf_file *file, const lmb_gltf_source *source, lmb_error *error)
{
    lmb_gltf_bytes json;
    lmb_result result = read_bytes(file, source, error);
    if (result == LMB_OK) {
        file->hash = lmb_hash(LMB_HASH_SEED, file->bytes.data, file->bytes.size);
        result = lmb_gltf_container_split(file->path, file->bytes, &json, &file->bin, error);
    }
    return result == LMB_OK ? parse_json(file, json, error) : result;
}

lmb_result lmb_gltf_file_read(const lmb_gltf_source *source, bool allow_outside_uris, lmb_gltf_file **file,
                              lmb_error *error)
{
    assert(source->path && file);
    const char *const path = source->path;
    lmb_gltf_file *const opened = calloc(1, sizeof *opened);
    char *const copy = malloc(strlen(path) + 1);
    if (!opened || !copy) {
        free(opened);
        free(copy);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    opened->path = memcpy(copy, path, strlen(path) + 1);
    opened->allow_outside_uris = allow_outside_uris;
    const lmb_result result = read_json(opened, source, error);
    if (result != LMB_OK) {
        lmb_gltf_file_close(opened);
        return result;
    }
    *file = opened;
    return LMB_OK;
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
    free(file->bytes.owned);
    free(file->path);
    free(file);
}
