#include "gltf/gltf_triangles.h"

#include <stdlib.h>

static uint32_t count_triangles(int32_t mode, uint32_t corner_count)
{
    switch (mode) {
    case LMB_GLTF_TRIANGLES:
        return corner_count / 3;
    case LMB_GLTF_TRIANGLE_STRIP:
    case LMB_GLTF_TRIANGLE_FAN:
        return corner_count >= 3 ? corner_count - 2 : 0;
    default:
        return 0;
    }
}

/* The vertex of each corner, in the order of the file. @return the first that names no vertex, or `count` */
static uint32_t read_run(const lmb_gltf_accessor *accessor, uint32_t count, uint32_t vertex_count, uint32_t *run)
{
    if (accessor) {
        unsigned char *const bytes = (unsigned char *)run; /* an index is at most as large as what replaces it */
        lmb_gltf_copy_all(accessor, bytes);
        for (uint32_t i = count; i-- > 0;) {
            run[i] = lmb_gltf_read_index(bytes, accessor->component_type, i);
        }
    }
    for (uint32_t i = 0; i < count; ++i) {
        run[i] = accessor ? run[i] : i;
        if (run[i] >= vertex_count) {
            return i;
        }
    }
    return count;
}

static void connect(int32_t mode, const uint32_t *run, lmb_gltf_triangles *triangles)
{
    for (uint32_t t = 0; t < triangles->count; ++t) {
        const bool odd = mode == LMB_GLTF_TRIANGLE_STRIP && t % 2;
        const uint32_t at = mode == LMB_GLTF_TRIANGLES ? 3 * t : t;
        triangles->corners[t][0] = run[mode == LMB_GLTF_TRIANGLE_FAN ? 0 : at];
        triangles->corners[t][1] = run[at + 1 + odd];
        triangles->corners[t][2] = run[at + 2 - odd];
    }
}

lmb_result lmb_gltf_triangles_read(const lmb_gltf_file *file, const lmb_gltf_topology *topology, const char *where,
                                   lmb_gltf_triangles *triangles, lmb_error *error)
{
    const lmb_gltf_accessor *const accessor = topology->indices >= 0 ? &file->accessors[topology->indices] : NULL;
    const uint32_t corner_count = accessor ? accessor->count : topology->vertex_count;
    lmb_gltf_triangles made = {NULL, count_triangles(topology->mode, corner_count)};
    if (made.count > LMB_GLTF_MAX_ELEMENTS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: %u triangles", file->path, where, made.count);
    }
    made.corners = malloc(((size_t)made.count + 1) * sizeof *made.corners);
    uint32_t *const run = malloc(((size_t)corner_count + 1) * sizeof *run);
    lmb_result result = LMB_OK;
    if (!made.corners || !run) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
        goto cleanup;
    }
    const uint32_t wrong = read_run(accessor, corner_count, topology->vertex_count, run);
    if (wrong < corner_count) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.indices: element %u is vertex %u of %u", file->path,
                               where, wrong, run[wrong], topology->vertex_count);
        goto cleanup;
    }
    connect(topology->mode, run, &made);
cleanup:
    free(run);
    if (result != LMB_OK) {
        free(made.corners);
        return result;
    }
    *triangles = made;
    return LMB_OK;
}
