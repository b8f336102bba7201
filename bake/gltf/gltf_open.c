#include "gltf/gltf_open.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_accessor.h"
#include "gltf/gltf_check.h"
#include "gltf/gltf_references.h"

static lmb_result read_and_check(lmb_gltf_file *file, lmb_error *error)
{
    lmb_result result = lmb_gltf_file_read(file, error);
    if (result == LMB_OK) {
        result = lmb_gltf_check_json(file, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_buffers_read(file, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_views_resolve(file, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_accessors_resolve(file, error);
    }
    return result == LMB_OK ? lmb_gltf_check_references(file, error) : result;
}

lmb_result lmb_gltf_file_open(const char *path, const lmb_gltf_options *options, lmb_gltf_file **file, lmb_error *error)
{
    assert(path && file);
    lmb_gltf_file *const opened = calloc(1, sizeof *opened);
    char *const copy = malloc(strlen(path) + 1);
    if (!opened || !copy) {
        free(opened);
        free(copy);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    opened->path = memcpy(copy, path, strlen(path) + 1);
    opened->allow_outside_uris = options && options->allow_outside_uris;
    const lmb_result result = read_and_check(opened, error);
    if (result != LMB_OK) {
        lmb_gltf_file_close(opened);
        return result;
    }
    *file = opened;
    return LMB_OK;
}
