#include "gltf/gltf_uri.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/base64.h>
#include <lambent/file.h>

#include "base/hex_digit.h"

/* Undoes %XX; anything else stays. @return number of bytes written, at most strlen(text) */
static size_t percent_decode(const char *text, unsigned char *bytes)
{
    size_t used = 0;
    while (*text) {
        if (text[0] == '%' && lmb_hex_digit(text[1]) >= 0 && lmb_hex_digit(text[2]) >= 0) {
            bytes[used++] = (unsigned char)(lmb_hex_digit(text[1]) * 16 + lmb_hex_digit(text[2]));
            text += 3;
        } else {
            bytes[used++] = (unsigned char)*text++;
        }
    }
    return used;
}

static lmb_result read_data_uri(const lmb_gltf_file *file, const char *uri, const char *where, lmb_gltf_bytes *bytes,
                                lmb_error *error)
{
    const char *const comma = strchr(uri, ',');
    if (!comma) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: data URI without a comma", file->path, where);
    }
    unsigned char *const data = malloc(strlen(comma));
    if (!data) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
    }
    static const char base64[] = ";base64";
    const size_t head = (size_t)(comma - uri);
    size_t size = 0;
    if (head >= sizeof base64 - 1 && memcmp(comma - (sizeof base64 - 1), base64, sizeof base64 - 1) == 0) {
        if (!lmb_base64_decode(comma + 1, data, &size)) {
            free(data);
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: broken base64", file->path, where);
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

/* The file's name in a URI that is not a data: one, relative to the level's folder unless it begins with a slash.
 * `name` has room for the URI. */
static lmb_result read_name(const lmb_gltf_file *file, const char *uri, const char *where, char *name, lmb_error *error)
{
    if (has_scheme(uri)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: \"%s\" is not a file's name", file->path, where,
                             uri);
    }
    const size_t length = percent_decode(uri, (unsigned char *)name);
    name[length] = '\0';
    if (length == 0 || strlen(name) != length) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: not a file's name", file->path, where);
    }
    if (!file->allow_outside_uris && leaves_folder(name)) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: \"%s\" leaves the level's folder", file->path,
                             where, name);
    }
    return LMB_OK;
}

lmb_result lmb_gltf_uri_read(lmb_gltf_file *file, const char *uri, const char *where, lmb_gltf_bytes *bytes,
                             lmb_error *error)
{
    if (strncmp(uri, "data:", 5) == 0) {
        return read_data_uri(file, uri, where, bytes, error);
    }
    const size_t shown_size = strlen(file->path) + strlen(where) + strlen(uri) + sizeof ": : \"\"";
    char *const name = malloc(strlen(uri) + 1), *const shown = malloc(shown_size);
    char *path = NULL;
    lmb_result result;
    if (!name || !shown) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
        goto cleanup;
    }
    result = read_name(file, uri, where, name, error);
    if (result != LMB_OK) {
        goto cleanup;
    }
    path = lmb_file_path_beside(file->path, name);
    if (!path) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
        goto cleanup;
    }
    snprintf(shown, shown_size, "%s: %s: \"%s\"", file->path, where, name);
    result = lmb_gltf_plain_file_read(path, shown, bytes, error);
    if (result == LMB_OK) {
        file->hash = lmb_hash(file->hash, bytes->data, bytes->size);
    }
cleanup:
    free(name);
    free(path);
    free(shown);
    return result;
}
