#include "gltf_internal.h"

#include <string.h>

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

void lmb_gltf_copy_all(const lmb_gltf_accessor *accessor, unsigned char *bytes)
{
    const size_t size = accessor->element_size;
    for (size_t i = 0; i < accessor->count; ++i) {
        if (accessor->data) {
            memcpy(bytes + i * size, accessor->data + i * accessor->stride, size);
        } else {
            memset(bytes + i * size, 0, size);
        }
    }
    for (size_t i = 0; i < accessor->sparse_count; ++i) {
        const size_t index = lmb_gltf_read_index(accessor->sparse_indices, accessor->sparse_index_type, i);
        memcpy(bytes + index * size, accessor->sparse_values + i * size, size);
    }
}
