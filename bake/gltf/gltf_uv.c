#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>
#include <lambent/gltf.h>

#include "gltf/gltf_image.h"
#include "gltf/gltf_json.h"
#include "gltf/gltf_open.h"
#include "gltf/gltf_triangles.h"

/* The level's own JSON is edited, so that whatever nobody here knows stays as it was (tinygltf's writer loses empty
 * objects, nulls and unknown properties). All bytes go to one binary chunk:
 *
 *     old buffers, one after the other | external images | for each primitive: attributes, targets, indices
 *
 * Old accessors stay, because animations, skins and extensions refer to them by number. */

enum { TARGET_VERTICES = 34962, TARGET_INDICES = 34963, NO_VERTEX = -1 };

static const size_t MAX_SIZE = 0x7fffffff;

/* The items of one of the level's lists by number, which cJSON would have to walk to. */
typedef struct item_list {
    cJSON **items;
    uint32_t count;
} item_list;

typedef struct writer {
    lmb_gltf_file *file;
    const lmb_warnings *warnings;
    lmb_error *error;
    unsigned char *bytes; /* the binary chunk */
    size_t size, capacity;
    cJSON *views, *accessors;
    uint32_t view_count, accessor_count; /* of those lists; cJSON would count anew each time */
    uint32_t mesh_count;                 /* with the copies that were added */
    item_list source_accessors, source_meshes, source_nodes;
} writer;

static lmb_result out_of_memory(const writer *w)
{
    return lmb_error_set(w->error, LMB_ERROR_MEMORY, "%s: out of memory", w->file->path);
}

/* Appends room for `size` bytes at a multiple of 4, zeroed. NULL when out of memory or too large. */
static unsigned char *append_bytes(writer *w, size_t size, size_t *offset)
{
    const size_t start = (w->size + 3) / 4 * 4;
    if (size > MAX_SIZE || start > MAX_SIZE - size) {
        return NULL;
    }
    if (start + size > w->capacity) {
        const size_t capacity = (start + size) + (start + size) / 2 + 64;
        unsigned char *const larger = realloc(w->bytes, capacity);
        if (!larger) {
            return NULL;
        }
        w->bytes = larger;
        w->capacity = capacity;
    }
    memset(w->bytes + w->size, 0, start + size - w->size);
    w->size = start + size;
    *offset = start;
    return w->bytes + start;
}

static bool set_number(cJSON *object, const char *name, double value)
{
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
    return cJSON_AddNumberToObject(object, name, value) != NULL;
}

/* A list of the root, made when it is not there. */
static cJSON *root_list(const writer *w, const char *name)
{
    cJSON *const list = cJSON_GetObjectItemCaseSensitive(w->file->root, name);
    return list ? list : cJSON_AddArrayToObject(w->file->root, name);
}

static bool items_collect(const writer *w, const char *name, item_list *list)
{
    cJSON *const array = cJSON_GetObjectItemCaseSensitive(w->file->root, name);
    list->items = calloc((size_t)cJSON_GetArraySize(array) + 1, sizeof *list->items);
    if (!list->items) {
        return false;
    }
    cJSON *item;
    cJSON_ArrayForEach(item, array)
    {
        list->items[list->count++] = item;
    }
    return true;
}

/* NULL for a number that the list does not have. */
static cJSON *item_at(const item_list *list, int32_t number)
{
    return number >= 0 && (uint32_t)number < list->count ? list->items[number] : NULL;
}

/* New buffer view of bytes that were appended. @return its number, or -1 */
static int64_t add_view(writer *w, size_t offset, size_t size, size_t stride, int target)
{
    cJSON *const view = cJSON_CreateObject();
    if (!view || !cJSON_AddItemToArray(w->views, view)) {
        cJSON_Delete(view);
        return -1;
    }
    const bool made = set_number(view, "buffer", 0) && set_number(view, "byteOffset", (double)offset) &&
                      set_number(view, "byteLength", (double)size) &&
                      (stride == 0 || set_number(view, "byteStride", (double)stride)) &&
                      (target == 0 || set_number(view, "target", target));
    return made ? (int64_t)w->view_count++ : -1;
}

/* Takes `accessor`, which may be NULL. @return its number, or -1 */
static int64_t add_accessor(writer *w, cJSON *accessor, int64_t view, uint32_t count)
{
    const bool made = accessor && view >= 0 && set_number(accessor, "bufferView", (double)view) &&
                      set_number(accessor, "count", count);
    if (!made || !cJSON_AddItemToArray(w->accessors, accessor)) {
        cJSON_Delete(accessor);
        return -1;
    }
    return w->accessor_count++;
}

static cJSON *new_accessor(int component_type, const char *type)
{
    cJSON *const accessor = cJSON_CreateObject();
    if (!accessor || !set_number(accessor, "componentType", component_type) ||
        !cJSON_AddStringToObject(accessor, "type", type)) {
        cJSON_Delete(accessor);
        return NULL;
    }
    return accessor;
}

/* Moves all buffers into the chunk. */
static lmb_result join_buffers(writer *w)
{
    size_t *const bases = calloc((size_t)w->file->buffer_count + 1, sizeof *bases);
    if (!bases) {
        return out_of_memory(w);
    }
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < w->file->buffer_count && result == LMB_OK; ++i) {
        const lmb_gltf_bytes *const buffer = &w->file->buffers[i];
        if (!buffer->data && buffer->size > 0) {
            result = lmb_error_set(w->error, LMB_ERROR_FORMAT, "%s: buffers[%u]: neither a uri nor a binary chunk",
                                   w->file->path, i);
            break;
        }
        unsigned char *const to = append_bytes(w, buffer->size, &bases[i]);
        if (!to && buffer->size > 0) {
            result = out_of_memory(w);
        } else if (buffer->size > 0) {
            memcpy(to, buffer->data, buffer->size);
        }
    }
    cJSON *view;
    cJSON_ArrayForEach(view, w->views)
    {
        if (result != LMB_OK) {
            break;
        }
        const double offset = lmb_gltf_uint(view, "byteOffset", 0) + (double)bases[lmb_gltf_uint(view, "buffer", 0)];
        /* Its fallback, which is what was read, is now the only form. */
        cJSON_DeleteItemFromObjectCaseSensitive(cJSON_GetObjectItemCaseSensitive(view, "extensions"),
                                                "EXT_meshopt_compression");
        if (!set_number(view, "buffer", 0) || !set_number(view, "byteOffset", offset)) {
            result = out_of_memory(w);
        }
        ++w->view_count;
    }
    free(bases);
    return result;
}

static const char *mime_type(const lmb_gltf_bytes *bytes)
{
    static const struct {
        const char *type;
        size_t at, size;
        unsigned char magic[8];
    } types[] = {{"image/png", 0, 4, {0x89, 'P', 'N', 'G'}},
                 {"image/jpeg", 0, 3, {0xff, 0xd8, 0xff}},
                 {"image/webp", 8, 4, {'W', 'E', 'B', 'P'}},
                 {"image/ktx2", 1, 6, {'K', 'T', 'X', ' ', '2', '0'}}};
    for (size_t i = 0; i < sizeof types / sizeof *types; ++i) {
        if (bytes->size >= types[i].at + types[i].size &&
            memcmp(bytes->data + types[i].at, types[i].magic, types[i].size) == 0) {
            return types[i].type;
        }
    }
    return "application/octet-stream";
}

static lmb_result embed_images(writer *w)
{
    uint32_t number = 0;
    cJSON *image;
    cJSON_ArrayForEach(image, cJSON_GetObjectItemCaseSensitive(w->file->root, "images"))
    {
        if (!cJSON_GetObjectItemCaseSensitive(image, "uri")) {
            ++number;
            continue;
        }
        lmb_gltf_bytes bytes;
        lmb_error reason;
        const lmb_result result = lmb_gltf_image_read(w->file, image, number++, &bytes, NULL, &reason);
        if (result == LMB_ERROR_MEMORY) {
            return out_of_memory(w);
        }
        if (result != LMB_OK) {
            /* Nothing that is read needs it, else the level would not have loaded. */
            lmb_warn(w->warnings, "%s; the level with new UVs only refers to it", reason.message);
            continue;
        }
        size_t offset;
        unsigned char *const to = append_bytes(w, bytes.size, &offset);
        const int64_t view = to ? add_view(w, offset, bytes.size, 0, 0) : -1;
        bool written = view >= 0 && set_number(image, "bufferView", (double)view);
        if (written) {
            memcpy(to, bytes.data, bytes.size);
            cJSON_DeleteItemFromObjectCaseSensitive(image, "uri");
            written = cJSON_GetObjectItemCaseSensitive(image, "mimeType") ||
                      cJSON_AddStringToObject(image, "mimeType", mime_type(&bytes));
        }
        free(bytes.owned);
        if (!written) {
            return out_of_memory(w);
        }
    }
    return LMB_OK;
}

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
static lmb_result gather_attribute(writer *w, const split *s, cJSON *item)
{
    const uint32_t number = (uint32_t)item->valuedouble;
    const lmb_gltf_accessor *const source = &w->file->accessors[number];
    const size_t size = source->element_size, stride = (size + 3) / 4 * 4;
    unsigned char *const old = malloc((size_t)source->count * size + 1);
    cJSON *accessor = cJSON_Duplicate(w->source_accessors.items[number], true);
    size_t offset = 0;
    unsigned char *const to = append_bytes(w, s->vertex_count * stride, &offset);
    if (!old || !accessor || !to) {
        free(old);
        cJSON_Delete(accessor);
        return out_of_memory(w);
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
        return out_of_memory(w);
    }
    const int64_t view = add_view(w, offset, s->vertex_count * stride, stride, TARGET_VERTICES);
    const int64_t added = add_accessor(w, accessor, view, s->vertex_count);
    if (added < 0) {
        return out_of_memory(w);
    }
    cJSON_SetNumberValue(item, (double)added);
    return LMB_OK;
}

static lmb_result write_uvs_and_indices(writer *w, const split *s, cJSON *primitive, cJSON *attributes)
{
    size_t offset;
    unsigned char *to = append_bytes(w, s->vertex_count * sizeof *s->uv, &offset);
    if (!to) {
        return out_of_memory(w);
    }
    memcpy(to, s->uv, s->vertex_count * sizeof *s->uv);
    const int64_t uv_view = add_view(w, offset, s->vertex_count * sizeof *s->uv, 0, TARGET_VERTICES);
    const int64_t uvs = add_accessor(w, new_accessor(LMB_GLTF_FLOAT, "VEC2"), uv_view, s->vertex_count);

    const bool narrow = s->vertex_count <= 65535; /* 65535 itself would mean "restart" */
    const size_t index_count = (size_t)s->triangles.count * 3, index_size = narrow ? 2 : 4;
    to = append_bytes(w, index_count * index_size, &offset);
    if (!to) {
        return out_of_memory(w);
    }
    for (size_t i = 0; i < index_count; ++i) {
        const uint32_t wide = s->triangles.corners[i / 3][i % 3];
        const uint16_t half = (uint16_t)wide;
        memcpy(to + i * index_size, narrow ? (const void *)&half : (const void *)&wide, index_size);
    }
    const int64_t index_view = add_view(w, offset, index_count * index_size, 0, TARGET_INDICES);
    const int64_t indices =
        add_accessor(w, new_accessor(narrow ? LMB_GLTF_UNSIGNED_SHORT : LMB_GLTF_UNSIGNED_INT, "SCALAR"), index_view,
                     (uint32_t)index_count);
    if (uvs < 0 || indices < 0 || !set_number(attributes, "TEXCOORD_1", (double)uvs) ||
        !set_number(primitive, "indices", (double)indices) || !set_number(primitive, "mode", LMB_GLTF_TRIANGLES)) {
        return out_of_memory(w);
    }
    return LMB_OK;
}

/* Copies the UVs of the mesh's triangles to where they stand in the file; dropped triangles keep (0, 0). */
static lmb_result take_corner_uvs(const writer *w, const lmb_gltf_uv *uv, uint32_t primitive, split *s)
{
    s->corner_uv = calloc((size_t)s->triangles.count * 3 + 1, sizeof *s->corner_uv);
    if (!s->corner_uv) {
        return out_of_memory(w);
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

static lmb_result rewrite_primitive(writer *w, const lmb_gltf_uv *uv, uint32_t number, cJSON *primitive)
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
    lmb_gltf_where(where, "meshes[%d].primitives[%u]", uv->mesh->source_mesh, number);
    split s = {0};
    const lmb_gltf_topology topology = {(int32_t)lmb_gltf_uint(primitive, "mode", LMB_GLTF_TRIANGLES),
                                        (int32_t)lmb_gltf_uint(primitive, "indices", UINT32_MAX), vertex_count};
    lmb_result result = lmb_gltf_triangles_read(w->file, &topology, where, &s.triangles, w->error);
    if (result != LMB_OK || s.triangles.count == 0) {
        goto cleanup;
    }
    result = take_corner_uvs(w, uv, number, &s);
    if (result == LMB_OK && !split_vertices(&s, vertex_count)) {
        result = out_of_memory(w);
    }
    cJSON_DeleteItemFromObjectCaseSensitive(attributes, "TEXCOORD_1");
    cJSON_DeleteItemFromObjectCaseSensitive(cJSON_GetObjectItemCaseSensitive(primitive, "extensions"),
                                            "KHR_draco_mesh_compression");
    cJSON *item, *target;
    cJSON_ArrayForEach(item, attributes)
    {
        result = result == LMB_OK ? gather_attribute(w, &s, item) : result;
    }
    cJSON_ArrayForEach(target, cJSON_GetObjectItemCaseSensitive(primitive, "targets"))
    {
        cJSON_ArrayForEach(item, target)
        {
            result = result == LMB_OK ? gather_attribute(w, &s, item) : result;
        }
    }
    result = result == LMB_OK ? write_uvs_and_indices(w, &s, primitive, attributes) : result;
cleanup:
    split_free(&s);
    return result;
}

/* Gives a mesh its UVs: in where, or in a copy for the node that poses it alone. */
static lmb_result rewrite_mesh(writer *w, const lmb_gltf_uv *uv)
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
            return out_of_memory(w);
        }
        if (!set_number(node, "mesh", w->mesh_count++)) {
            return out_of_memory(w);
        }
    }
    uint32_t number = 0;
    cJSON *primitive;
    cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives"))
    {
        const lmb_result result = rewrite_primitive(w, uv, number++, primitive);
        if (result != LMB_OK) {
            return result;
        }
    }
    return LMB_OK;
}

static void put_u32(unsigned char *to, size_t value)
{
    for (int i = 0; i < 4; ++i) {
        to[i] = (unsigned char)(value >> 8 * i);
    }
}

static lmb_result write_glb(writer *w, const char *path)
{
    cJSON *const buffers = cJSON_CreateArray(), *const buffer = cJSON_CreateObject();
    const size_t bin_size = (w->size + 3) / 4 * 4;
    cJSON_DeleteItemFromObjectCaseSensitive(w->file->root, "buffers");
    if (!buffers || !buffer || !set_number(buffer, "byteLength", (double)bin_size) ||
        !cJSON_AddItemToArray(buffers, buffer)) {
        cJSON_Delete(buffers);
        cJSON_Delete(buffer);
        return out_of_memory(w);
    }
    if (bin_size == 0 || !cJSON_AddItemToObject(w->file->root, "buffers", buffers)) {
        cJSON_Delete(buffers); /* a buffer of no bytes is not allowed */
    }
    if (w->view_count == 0) {
        cJSON_DeleteItemFromObjectCaseSensitive(w->file->root, "bufferViews"); /* nor is an empty list */
    }
    if (w->accessor_count == 0) {
        cJSON_DeleteItemFromObjectCaseSensitive(w->file->root, "accessors");
    }
    char *const json = cJSON_PrintUnformatted(w->file->root);
    const size_t json_size = json ? strlen(json) : 0, json_padded = (json_size + 3) / 4 * 4;
    const size_t total = 12 + 8 + json_padded + (bin_size ? 8 + bin_size : 0);
    unsigned char *const glb = json && total <= MAX_SIZE ? calloc(total, 1) : NULL;
    if (!glb) {
        cJSON_free(json);
        return out_of_memory(w);
    }
    memcpy(glb, "glTF", 4);
    put_u32(glb + 4, 2);
    put_u32(glb + 8, total);
    put_u32(glb + 12, json_padded);
    memcpy(glb + 16, "JSON", 4);
    memset(glb + 20, ' ', json_padded);
    memcpy(glb + 20, json, json_size);
    cJSON_free(json);
    if (bin_size > 0) {
        unsigned char *const chunk = glb + 20 + json_padded;
        put_u32(chunk, bin_size);
        memcpy(chunk + 4, "BIN", 4);
        memcpy(chunk + 8, w->bytes, w->size);
    }
    const lmb_result result = lmb_file_write(path, glb, total, w->error);
    free(glb);
    return result;
}

static lmb_result edit_level(writer *w, const lmb_gltf_uv *uvs, size_t uv_count)
{
    w->views = root_list(w, "bufferViews");
    w->accessors = root_list(w, "accessors");
    w->accessor_count = w->file->accessor_count;
    if (!w->views || !w->accessors || !items_collect(w, "accessors", &w->source_accessors) ||
        !items_collect(w, "meshes", &w->source_meshes) || !items_collect(w, "nodes", &w->source_nodes)) {
        return out_of_memory(w);
    }
    w->mesh_count = w->source_meshes.count;
    lmb_result result = join_buffers(w);
    if (result == LMB_OK) {
        result = embed_images(w);
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
    writer w = {.warnings = options ? &options->warnings : NULL, .error = error};
    lmb_result result = lmb_gltf_open(source_path, options, &w.file, error);
    if (result != LMB_OK) {
        return result;
    }
    result = edit_level(&w, uvs, uv_count);
    if (result == LMB_OK) {
        result = write_glb(&w, path);
    }
    free(w.bytes);
    free(w.source_accessors.items);
    free(w.source_meshes.items);
    free(w.source_nodes.items);
    lmb_gltf_file_close(w.file);
    return result;
}
