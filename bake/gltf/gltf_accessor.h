/* Buffer views and accessors, and the numbers in them. */
#ifndef LMB_GLTF_ACCESSOR_H
#define LMB_GLTF_ACCESSOR_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Every view in its buffer, then every accessor in its view; sparse indices in their accessor. */
lmb_result lmb_gltf_views_resolve(lmb_gltf_file *file, lmb_error *error);
lmb_result lmb_gltf_accessors_resolve(lmb_gltf_file *file, lmb_error *error);
/* A buffer view's bytes; `data` is NULL when the file does not have them. */
lmb_gltf_bytes lmb_gltf_view_bytes(const lmb_gltf_file *file, uint32_t view);

/* Element `index` of the plain part (without sparse substitution) as floats, normalised when the accessor says so. */
void lmb_gltf_decode(const lmb_gltf_accessor *accessor, const unsigned char *element, float *values);
/* All elements, sparse ones substituted; `values` holds count x components. */
void lmb_gltf_decode_all(const lmb_gltf_accessor *accessor, float *values);
/* All elements' raw bytes, tightly packed, sparse ones substituted; `bytes` holds count x element_size. */
void lmb_gltf_copy_all(const lmb_gltf_accessor *accessor, unsigned char *bytes);
/* Number `index` of a run of unsigned integers. */
uint32_t lmb_gltf_read_index(const unsigned char *data, int component_type, size_t index);

#ifdef __cplusplus
}
#endif

#endif
