#include "gltf/gltf_accessor.h"

#include <stdlib.h>
#include <string.h>

#include "gltf/gltf_buffers.h"
#include "gltf/gltf_json.h"

/* Elements of an accessor without bytes: nothing in the file vouches for them. */
enum { MAX_ZERO_ELEMENTS = 1 << 24 };

static uint32_t component_size(int component_type)
{
    switch (component_type) {
    case LMB_GLTF_BYTE:
    case LMB_GLTF_UNSIGNED_BYTE:
        return 1;
    case LMB_GLTF_SHORT:
    case LMB_GLTF_UNSIGNED_SHORT:
        return 2;
    default:
        return 4;
    }
}

/* Columns of matrices start at multiples of 4 bytes (glTF 2.0, 3.6.2.4). */
static void element_layout(const char *type, lmb_gltf_accessor *accessor)
{
    static const struct {
        const char *type;
        uint32_t columns, rows;
    } types[] = {{"SCALAR", 1, 1}, {"VEC2", 1, 2}, {"VEC3", 1, 3}, {"VEC4", 1, 4},
                 {"MAT2", 2, 2},   {"MAT3", 3, 3}, {"MAT4", 4, 4}};
    const uint32_t size = component_size(accessor->component_type);
    for (size_t i = 0; i < sizeof types / sizeof *types; ++i) {
        if (strcmp(type, types[i].type) == 0) {
            const uint32_t column = types[i].rows * size;
            const uint32_t padding = types[i].columns > 1 ? (4u - column % 4u) % 4u : 0;
            accessor->components = types[i].columns * types[i].rows;
            accessor->element_size = types[i].columns * (column + padding);
            accessor->used_size = accessor->element_size - padding;
        }
    }
}

/* Whether `count` elements fit in a view of `size` bytes from `offset` on. */
static bool elements_fit(size_t size, size_t offset, uint32_t count, size_t stride, size_t used_size)
{
    if (count == 0) {
        return offset <= size;
    }
    const uint64_t last = (uint64_t)(count - 1) * stride; /* count < 2^31, stride < 256: no overflow */
    return offset <= size && last <= size - offset && used_size <= size - offset - last;
}

static lmb_result resolve_sparse(const lmb_gltf_file *file, const cJSON *sparse, const char *where,
                                 lmb_gltf_accessor *accessor, lmb_error *error)
{
    const cJSON *const indices = cJSON_GetObjectItemCaseSensitive(sparse, "indices");
    const cJSON *const values = cJSON_GetObjectItemCaseSensitive(sparse, "values");
    const uint32_t count = lmb_gltf_uint(sparse, "count", 0);
    const lmb_gltf_bytes index_view = lmb_gltf_view_bytes(file, lmb_gltf_uint(indices, "bufferView", 0));
    const lmb_gltf_bytes value_view = lmb_gltf_view_bytes(file, lmb_gltf_uint(values, "bufferView", 0));
    const size_t index_offset = lmb_gltf_uint(indices, "byteOffset", 0);
    const size_t value_offset = lmb_gltf_uint(values, "byteOffset", 0);
    const int index_type = (int)lmb_gltf_uint(indices, "componentType", 0);
    const uint32_t index_size = component_size(index_type);
    if (count > accessor->count) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.sparse: count %u is above the accessor's %u", file->path,
                             where, count, accessor->count);
    }
    if (!elements_fit(index_view.size, index_offset, count, index_size, index_size)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.sparse.indices: leaves its buffer view", file->path,
                             where);
    }
    if (!elements_fit(value_view.size, value_offset, count, accessor->element_size, accessor->used_size)) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.sparse.values: leaves its buffer view", file->path,
                             where);
    }
    if (count == 0 || !index_view.data || !value_view.data) {
        accessor->missing |= count > 0;
        return LMB_OK;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t index = lmb_gltf_read_index(index_view.data + index_offset, index_type, i);
        if (index >= accessor->count) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.sparse.indices: element %u is %u, of %u", file->path,
                                 where, i, index, accessor->count);
        }
    }
    accessor->sparse_count = count;
    accessor->sparse_index_type = index_type;
    accessor->sparse_indices = index_view.data + index_offset;
    accessor->sparse_values = value_view.data + value_offset;
    return LMB_OK;
}

static lmb_result resolve_accessor(const lmb_gltf_file *file, const cJSON *item, const char *where,
                                   lmb_gltf_accessor *accessor, lmb_error *error)
{
    accessor->component_type = (int)lmb_gltf_uint(item, "componentType", 0);
    accessor->count = lmb_gltf_uint(item, "count", 0);
    accessor->normalized = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(item, "normalized"));
    element_layout(cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "type")), accessor);
    accessor->stride = accessor->element_size;
    if (cJSON_GetObjectItemCaseSensitive(item, "bufferView")) {
        const uint32_t view = lmb_gltf_uint(item, "bufferView", 0);
        const lmb_gltf_bytes bytes = lmb_gltf_view_bytes(file, view);
        const size_t offset = lmb_gltf_uint(item, "byteOffset", 0);
        const uint32_t stride = lmb_gltf_uint(file->views[view], "byteStride", 0);
        if (stride != 0 && stride < accessor->element_size) {
            return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: byteStride %u is below the element's %u bytes",
                                 file->path, where, stride, accessor->element_size);
        }
        accessor->stride = stride ? stride : accessor->element_size;
        if (!elements_fit(bytes.size, offset, accessor->count, accessor->stride, accessor->used_size)) {
            return lmb_error_set(error, LMB_ERROR_FORMAT,
                                 "%s: %s: %u elements of %u bytes from byte %zu on leave bufferViews[%u] of %zu bytes",
                                 file->path, where, accessor->count, accessor->element_size, offset, view, bytes.size);
        }
        accessor->missing = !bytes.data && accessor->count > 0;
        accessor->data = bytes.data && accessor->count > 0 ? bytes.data + offset : NULL;
    } else if (accessor->count > MAX_ZERO_ELEMENTS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: %u elements without a buffer view", file->path,
                             where, accessor->count);
    }
    const cJSON *const sparse = cJSON_GetObjectItemCaseSensitive(item, "sparse");
    return sparse ? resolve_sparse(file, sparse, where, accessor, error) : LMB_OK;
}

lmb_result lmb_gltf_accessors_resolve(lmb_gltf_file *file, lmb_error *error)
{
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(file->root, "accessors");
    file->accessors = calloc((size_t)cJSON_GetArraySize(list) + 1, sizeof *file->accessors);
    if (!file->accessors) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", file->path);
    }
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        char where[LMB_GLTF_WHERE_SIZE];
        lmb_gltf_where(where, "accessors[%u]", file->accessor_count);
        const lmb_result result = resolve_accessor(file, item, where, &file->accessors[file->accessor_count], error);
        if (result != LMB_OK) {
            return result;
        }
        ++file->accessor_count;
    }
    return LMB_OK;
}

static float decode_component(const unsigned char *bytes, int component_type, bool normalized)
{
    int16_t s;
    uint16_t u;
    uint32_t w;
    float f;
    switch (component_type) {
    case LMB_GLTF_BYTE:
        s = (int8_t)*bytes;
        return !normalized ? (float)s : s < -127 ? -1.0f : (float)s / 127.0f;
    case LMB_GLTF_UNSIGNED_BYTE:
        return normalized ? (float)*bytes / 255.0f : (float)*bytes;
    case LMB_GLTF_SHORT:
        memcpy(&s, bytes, sizeof s);
        return !normalized ? (float)s : s < -32767 ? -1.0f : (float)s / 32767.0f;
    case LMB_GLTF_UNSIGNED_SHORT:
        memcpy(&u, bytes, sizeof u);
        return normalized ? (float)u / 65535.0f : (float)u;
    case LMB_GLTF_UNSIGNED_INT:
        memcpy(&w, bytes, sizeof w);
        return normalized ? (float)((double)w / 4294967295.0) : (float)w;
    default:
        memcpy(&f, bytes, sizeof f);
        return f;
    }
}

/* Columns of small matrices are padded; only float matrices are read, and those have no padding. */
void lmb_gltf_decode(const lmb_gltf_accessor *accessor, const unsigned char *element, float *values)
{
    const uint32_t size = accessor->element_size / accessor->components;
    for (uint32_t i = 0; i < accessor->components; ++i) {
        values[i] = decode_component(element + i * size, accessor->component_type, accessor->normalized);
    }
}

uint32_t lmb_gltf_read_index(const unsigned char *data, int component_type, size_t index)
{
    uint16_t u;
    uint32_t w;
    switch (component_type) {
    case LMB_GLTF_UNSIGNED_BYTE:
        return data[index];
    case LMB_GLTF_UNSIGNED_SHORT:
        memcpy(&u, data + 2 * index, sizeof u);
        return u;
    default:
        memcpy(&w, data + 4 * index, sizeof w);
        return w;
    }
}

void lmb_gltf_decode_all(const lmb_gltf_accessor *accessor, float *values)
{
    const size_t components = accessor->components;
    for (size_t i = 0; i < accessor->count; ++i) {
        if (accessor->data) {
            lmb_gltf_decode(accessor, accessor->data + i * accessor->stride, values + i * components);
        } else {
            memset(values + i * components, 0, components * sizeof *values);
        }
    }
    for (size_t i = 0; i < accessor->sparse_count; ++i) {
        const size_t index = lmb_gltf_read_index(accessor->sparse_indices, accessor->sparse_index_type, i);
        lmb_gltf_decode(accessor, accessor->sparse_values + i * accessor->element_size, values + index * components);
    }
}

bool lmb_gltf_decode_new(const lmb_gltf_file *file, int32_t accessor, float **values)
{
    if (accessor < 0) {
        return true;
    }
    const lmb_gltf_accessor *const a = &file->accessors[accessor];
    *values = malloc(((size_t)a->count + 1) * a->components * sizeof **values);
    if (*values) {
        lmb_gltf_decode_all(a, *values);
    }
    return *values != NULL;
}

void lmb_gltf_copy_all(const lmb_gltf_accessor *accessor, unsigned char *bytes)
{
    const size_t size = accessor->element_size;
    memset(bytes, 0, accessor->count * size);
    for (size_t i = 0; i < accessor->count; ++i) {
        if (accessor->data) {
            memcpy(bytes + i * size, accessor->data + i * accessor->stride, accessor->used_size);
        }
    }
    for (size_t i = 0; i < accessor->sparse_count; ++i) {
        const size_t index = lmb_gltf_read_index(accessor->sparse_indices, accessor->sparse_index_type, i);
        memcpy(bytes + index * size, accessor->sparse_values + i * size, accessor->used_size);
    }
}
