#include <lambent/gltf.h>

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_embed.h"
#include "gltf/gltf_json.h"
#include "gltf/gltf_open.h"
#include "gltf/gltf_triangles.h"
#include "gltf/gltf_writer.h"

/* The level's own JSON is edited, so that whatever nobody here knows stays as it was (tinygltf's writer loses empty
 * objects, nulls and unknown properties). All bytes go to one binary chunk:
 *
 *     old buffers, one after the other | external images | for each primitive: attributes, targets, indices
 *
 * Old accessors stay, because animations, skins and extensions refer to them by index. */

enum { NO_VERTEX = -1 };

/* One primitive's new vertices: which old vertex each one is, with which UV. */
typedef struct split {
    lmb_gltf_triangles triangles; /* of old vertices, then of new ones */
    lmb_vec2 *corner_uv;
    uint32_t vertex_count;
    uint32_t *source;
    lmb_vec2 *uv;
} split;

static void split_free(split *s)
{
    free(s->triangles.corners);
    free(s->corner_uv);
    free(s->source);
    free(s->uv);
}

/* Corners that share an old vertex and agree in their UV share the new one. */
static bool split_vertices(split *s, uint32_t old_count)
{
    const size_t corner_count = (size_t)s->triangles.count * 3;
    int64_t *const first = malloc(((size_t)old_count + 1) * sizeof *first);
    int64_t *const next = malloc((corner_count + 1) * sizeof *next);
    s->source = malloc((corner_count + 1) * sizeof *s->source);
    s->uv = malloc((corner_count + 1) * sizeof *s->uv);
    const bool allocated = first && next && s->source && s->uv;
    for (uint32_t v = 0; allocated && v < old_count; ++v) {
        first[v] = NO_VERTEX;
    }
    for (size_t c = 0; allocated && c < corner_count; ++c) {
        uint32_t *const corner = &s->triangles.corners[c / 3][c % 3];
        const lmb_vec2 uv = s->corner_uv[c];
        int64_t v = first[*corner];
        while (v != NO_VERTEX && (s->uv[v].x != uv.x || s->uv[v].y != uv.y)) {
            v = next[v];
        }
        if (v == NO_VERTEX) {
            v = s->vertex_count++;
            s->source[v] = *corner;
            s->uv[v] = uv;
            next[v] = first[*corner];
            first[*corner] = v;
        }
        *corner = (uint32_t)v;
    }
    free(first);
    free(next);
    return allocated;
}

/* POSITION must have exact bounds (glTF 2.0, 3.7.2.1); the other bounds are optional and no longer true. */
static bool set_bounds(cJSON *accessor, const lmb_gltf_accessor *source, const unsigned char *elements, size_t stride,
                       uint32_t count)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    lmb_gltf_accessor plain = *source;
    plain.normalized = false; /* bounds are of the stored numbers */
    for (uint32_t i = 0; i < count; ++i) {
        float value[3];
        lmb_gltf_decode(&plain, elements + i * stride, value);
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = isfinite(value[axis]) ? fmin(low[axis], (double)value[axis]) : low[axis];
            high[axis] = isfinite(value[axis]) ? fmax(high[axis], (double)value[axis]) : high[axis];
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = isfinite(low[axis]) ? low[axis] : 0.0;
        high[axis] = isfinite(high[axis]) ? high[axis] : 0.0;
    }
    cJSON *const minimum = cJSON_CreateDoubleArray(low, 3);
    cJSON *const maximum = cJSON_CreateDoubleArray(high, 3);
    const bool added = minimum && cJSON_AddItemToObject(accessor, "min", minimum);
    if (!added) {
        cJSON_Delete(minimum);
    }
    if (!added || !maximum || !cJSON_AddItemToObject(accessor, "max", maximum)) {
        cJSON_Delete(maximum);
        return false;
    }
    return true;
}

/* Rewrites one attribute for the new vertices and makes `item` refer to it. */
static lmb_result gather_attribute(lmb_gltf_writer *w, const split *s, cJSON *item)
{
    const uint32_t index = (uint32_t)item->valuedouble;
    const lmb_gltf_accessor *const source = &w->file->accessors[index];
    const size_t size = source->element_size, stride = (size + 3) / 4 * 4;
    unsigned char *const old = malloc((size_t)source->count * size + 1);
    cJSON *accessor = cJSON_Duplicate(w->source_accessors.items[index], true);
    size_t offset = 0;
    unsigned char *const to = lmb_gltf_append_bytes(w, s->vertex_count * stride, &offset);
    if (!old || !accessor || !to) {
        free(old);
        cJSON_Delete(accessor);
        return lmb_gltf_writer_out_of_memory(w);
    }
    lmb_gltf_copy_all(source, old);
    for (size_t v = 0; v < s->vertex_count; ++v) {
        memcpy(to + v * stride, old + s->source[v] * size, size);
    }
    free(old);
    static const char *const stale[] = {"min", "max", "sparse", "byteOffset"};
    for (size_t i = 0; i < sizeof stale / sizeof *stale; ++i) {
        cJSON_DeleteItemFromObjectCaseSensitive(accessor, stale[i]);
    }
    if (strcmp(item->string, "POSITION") == 0 && !set_bounds(accessor, source, to, stride, s->vertex_count)) {
        cJSON_Delete(accessor);
        return lmb_gltf_writer_out_of_memory(w);
    }
    const int64_t view =
        lmb_gltf_add_view(w, (lmb_gltf_range){offset, s->vertex_count * stride, stride, LMB_GLTF_VERTICES});
    const int64_t added = lmb_gltf_add_accessor(w, accessor, view, s->vertex_count);
    if (added < 0) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    cJSON_SetNumberValue(item, (double)added);
    return LMB_OK;
}

/* All attributes, those of morph targets too. */
static lmb_result gather_attributes(lmb_gltf_writer *w, const split *s, cJSON *primitive)
{
    lmb_result result = LMB_OK;
    cJSON *item, *target;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(primitive, "attributes"))
    {
        result = result == LMB_OK ? gather_attribute(w, s, item) : result;
    }
    cJSON_ArrayForEach(target, cJSON_GetObjectItemCaseSensitive(primitive, "targets"))
    {
        cJSON_ArrayForEach(item, target)
        {
            result = result == LMB_OK ? gather_attribute(w, s, item) : result;
        }
    }
    return result;
}

static lmb_result write_uvs_and_indices(lmb_gltf_writer *w, const split *s, cJSON *primitive, cJSON *attributes)
{
    size_t offset;
    unsigned char *to = lmb_gltf_append_bytes(w, s->vertex_count * sizeof *s->uv, &offset);
    if (!to) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    memcpy(to, s->uv, s->vertex_count * sizeof *s->uv);
    const int64_t uv_view =
        lmb_gltf_add_view(w, (lmb_gltf_range){offset, s->vertex_count * sizeof *s->uv, 0, LMB_GLTF_VERTICES});
    const int64_t uvs =
        lmb_gltf_add_accessor(w, lmb_gltf_new_accessor(LMB_GLTF_FLOAT, "VEC2"), uv_view, s->vertex_count);

    const bool narrow = s->vertex_count <= 65535; /* 65535 itself would mean "restart" */
    const size_t index_count = (size_t)s->triangles.count * 3, index_size = narrow ? 2 : 4;
    to = lmb_gltf_append_bytes(w, index_count * index_size, &offset);
    if (!to) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    for (size_t i = 0; i < index_count; ++i) {
        const uint32_t wide = s->triangles.corners[i / 3][i % 3];
        const uint16_t half = (uint16_t)wide;
        memcpy(to + i * index_size, narrow ? (const void *)&half : (const void *)&wide, index_size);
    }
    const int64_t index_view =
        lmb_gltf_add_view(w, (lmb_gltf_range){offset, index_count * index_size, 0, LMB_GLTF_INDICES});
    const int64_t indices = lmb_gltf_add_accessor(
        w, lmb_gltf_new_accessor(narrow ? LMB_GLTF_UNSIGNED_SHORT : LMB_GLTF_UNSIGNED_INT, "SCALAR"), index_view,
        (uint32_t)index_count);
    if (uvs < 0 || indices < 0 || !lmb_gltf_set_number(attributes, "TEXCOORD_1", (double)uvs) ||
        !lmb_gltf_set_number(primitive, "indices", (double)indices) ||
        !lmb_gltf_set_number(primitive, "mode", LMB_GLTF_TRIANGLES)) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    return LMB_OK;
}

/* Copies the UVs of the mesh's triangles to where they stand in the file; dropped triangles keep (0, 0). */
static lmb_result take_corner_uvs(const lmb_gltf_writer *w, const lmb_gltf_uv *uv, uint32_t primitive, split *s)
{
    s->corner_uv = calloc((size_t)s->triangles.count * 3 + 1, sizeof *s->corner_uv);
    if (!s->corner_uv) {
        return lmb_gltf_writer_out_of_memory(w);
    }
    const lmb_mesh *const mesh = uv->mesh;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        if (mesh->source_primitive[t] != primitive) {
            continue;
        }
        for (uint32_t c = 0; c < 3; ++c) {
            const lmb_vec2 corner = uv->corner_uv[3 * (size_t)t + c];
            if (mesh->source_triangle[t] >= s->triangles.count || !isfinite(corner.x) || !isfinite(corner.y)) {
                return lmb_error_set(w->error, LMB_ERROR_ARGUMENT,
                                     "%s: meshes[%d].primitives[%u]: the UVs do not fit the level", w->file->path,
                                     mesh->source_mesh, primitive);
            }
            s->corner_uv[3 * (size_t)mesh->source_triangle[t] + c] = corner;
        }
    }
    return LMB_OK;
}

static lmb_result rewrite_primitive(lmb_gltf_writer *w, const lmb_gltf_uv *uv, uint32_t index, cJSON *primitive)
{
    cJSON *const attributes = cJSON_GetObjectItemCaseSensitive(primitive, "attributes");
    const uint32_t position = lmb_gltf_uint(attributes, "POSITION", UINT32_MAX);
    if (position == UINT32_MAX) {
        return LMB_OK;
    }
    if (position >= w->file->accessor_count) {
        return lmb_error_set(w->error, LMB_ERROR_ARGUMENT, "%s: meshes[%d]: UVs given twice", w->file->path,
                             uv->mesh->source_mesh);
    }
    const uint32_t vertex_count = w->file->accessors[position].count;
    char where[LMB_GLTF_WHERE_SIZE];
    lmb_gltf_where(where, "meshes[%d].primitives[%u]", uv->mesh->source_mesh, index);
    split s = {0};
    const lmb_gltf_topology topology = {(int32_t)lmb_gltf_uint(primitive, "mode", LMB_GLTF_TRIANGLES),
                                        (int32_t)lmb_gltf_uint(primitive, "indices", UINT32_MAX), vertex_count};
    lmb_result result = lmb_gltf_triangles_read(w->file, &topology, where, &s.triangles, w->error);
    if (result != LMB_OK || s.triangles.count == 0) {
        goto cleanup;
    }
    result = take_corner_uvs(w, uv, index, &s);
    if (result == LMB_OK && !split_vertices(&s, vertex_count)) {
        result = lmb_gltf_writer_out_of_memory(w);
    }
    cJSON_DeleteItemFromObjectCaseSensitive(attributes, "TEXCOORD_1");
    cJSON_DeleteItemFromObjectCaseSensitive(cJSON_GetObjectItemCaseSensitive(primitive, "extensions"),
                                            "KHR_draco_mesh_compression");
    result = result == LMB_OK ? gather_attributes(w, &s, primitive) : result;
    result = result == LMB_OK ? write_uvs_and_indices(w, &s, primitive, attributes) : result;
cleanup:
    split_free(&s);
    return result;
}

/* NULL for an index that the list does not have. */
static cJSON *item_at(const lmb_gltf_items *list, int32_t index)
{
    return index >= 0 && (uint32_t)index < list->count ? list->items[index] : NULL;
}

/* Gives a mesh its UVs: in where, or in a copy for the node that poses it alone. */
static lmb_result rewrite_mesh(lmb_gltf_writer *w, const lmb_gltf_uv *uv)
{
    cJSON *mesh = item_at(&w->source_meshes, uv->mesh->source_mesh);
    cJSON *const node = item_at(&w->source_nodes, uv->mesh->source_node);
    if (!mesh || (uv->mesh->source_node >= 0 && !node)) {
        return lmb_error_set(w->error, LMB_ERROR_ARGUMENT, "%s: meshes[%d]: the UVs are of another level",
                             w->file->path, uv->mesh->source_mesh);
    }
    if (node) {
        mesh = cJSON_Duplicate(mesh, true);
        if (!mesh || !cJSON_AddItemToArray(cJSON_GetObjectItemCaseSensitive(w->file->root, "meshes"), mesh)) {
            cJSON_Delete(mesh);
            return lmb_gltf_writer_out_of_memory(w);
        }
        if (!lmb_gltf_set_number(node, "mesh", w->mesh_count++)) {
            return lmb_gltf_writer_out_of_memory(w);
        }
    }
    uint32_t index = 0;
    cJSON *primitive;
    cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives"))
    {
        const lmb_result result = rewrite_primitive(w, uv, index++, primitive);
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

static lmb_result edit_level(lmb_gltf_writer *w, const lmb_gltf_uv *uvs, size_t uv_count)
{
    lmb_result result = lmb_gltf_writer_begin(w);
    if (result == LMB_OK) {
        result = lmb_gltf_embed_buffers(w);
    }
    if (result == LMB_OK) {
        result = lmb_gltf_embed_images(w);
    }
    /* Copies of meshes are made before the meshes themselves change. */
    for (int in_place = 0; in_place < 2; ++in_place) {
        for (size_t i = 0; i < uv_count && result == LMB_OK; ++i) {
            if ((uvs[i].mesh->source_node < 0) == (in_place == 1)) {
                result = rewrite_mesh(w, &uvs[i]);
            }
        }
    }
    return result;
}

lmb_result lmb_gltf_write_with_uvs(const char *source_path, const lmb_gltf_options *options, const lmb_gltf_uv *uvs,
                                   size_t uv_count, const char *path, lmb_error *error)
{
    assert(source_path && path && (uvs || uv_count == 0));
    lmb_gltf_writer w = {.warnings = options ? &options->warnings : NULL, .error = error};
    lmb_result result = lmb_gltf_open(&(lmb_gltf_source){.path = source_path}, options, &w.file, error);
    if (result != LMB_OK) {
        return result;
    }
    result = edit_level(&w, uvs, uv_count);
    if (result == LMB_OK) {
        result = lmb_gltf_write_glb(&w, path);
    }
    lmb_gltf_writer_free(&w);
    lmb_gltf_file_close(w.file);
    return result;
}
