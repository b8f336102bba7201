/* Accessors whose every element was checked to lie in its buffer, and the numbers in them. */
#ifndef LMB_GLTF_ACCESSOR_H
#define LMB_GLTF_ACCESSOR_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Component types, as glTF counts them. */
enum {
    LMB_GLTF_BYTE = 5120,
    LMB_GLTF_UNSIGNED_BYTE = 5121,
    LMB_GLTF_SHORT = 5122,
    LMB_GLTF_UNSIGNED_SHORT = 5123,
    LMB_GLTF_UNSIGNED_INT = 5125,
    LMB_GLTF_FLOAT = 5126
};

typedef struct lmb_gltf_accessor {
    const unsigned char *data; /* NULL: zeros */
    size_t stride;
    uint32_t count;
    uint32_t components;
    uint32_t element_size; /* bytes, with the padding of small matrices */
    uint32_t used_size;    /* the same without the padding after the last column, which the last element may lack */
    int component_type;
    bool normalized;
    bool missing; /* its buffer has no bytes in the file, which is an error for whoever reads it */
    uint32_t sparse_count;
    int sparse_index_type;
    const unsigned char *sparse_indices;
    const unsigned char *sparse_values; /* tightly packed */
} lmb_gltf_accessor;

/* Every accessor in its view, sparse indices in their accessor. Needs the views.
 * @return LMB_ERROR_FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_accessors_resolve(lmb_gltf_file *file, lmb_error *error);

/* Element `index` of the plain part (without sparse substitution) as floats, normalised when the accessor says so. */
void lmb_gltf_decode(const lmb_gltf_accessor *accessor, const unsigned char *element, float *values);

/* All elements, sparse ones substituted; `values` holds count x components. */
void lmb_gltf_decode_all(const lmb_gltf_accessor *accessor, float *values);

/* The same into malloc'ed memory, never of 0 bytes; of no accessor (negative) nothing. @return false when out of memory
 */
bool lmb_gltf_decode_new(const lmb_gltf_file *file, int32_t accessor, float **values);

/* All elements' raw bytes, tightly packed, sparse ones substituted; `bytes` holds count x element_size. */
void lmb_gltf_copy_all(const lmb_gltf_accessor *accessor, unsigned char *bytes);

/* Element `index` of a run of unsigned integers. */
uint32_t lmb_gltf_read_index(const unsigned char *data, int component_type, size_t index);

#ifdef __cplusplus
}
#endif

#endif
