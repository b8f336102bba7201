#include "gltf/gltf_open.h"

#include "gltf/gltf_accessor.h"
#include "gltf/gltf_buffers.h"
#include "gltf/gltf_check.h"
#include "gltf/gltf_references.h"

lmb_result lmb_gltf_open(const lmb_gltf_source *source, const lmb_gltf_options *options, lmb_gltf_file **file,
                         lmb_error *error)
{
    lmb_gltf_file *opened;
    lmb_result result = lmb_gltf_file_read(source, options && options->allow_outside_uris, &opened, error);
    if (result != LMB_OK) {
        return result;
    }
    result = lmb_gltf_check_json(opened, error);
    if (result == LMB_OK) {
        result = lmb_gltf_buffers_read(opened, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_views_resolve(opened, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_accessors_resolve(opened, error);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_check_references(opened, error);
    }
    if (result != LMB_OK) {
        lmb_gltf_file_close(opened);
        return result;
    }
    *file = opened;
    return LMB_OK;
}
