/* The types and ranges of all properties that are read. */
#ifndef LMB_GLTF_SCHEMA_H
#define LMB_GLTF_SCHEMA_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The type and range of every property that is read, and the length of what each index counts in.
 * @return LMB_ERROR_FORMAT */
lmb_result lmb_gltf_check_schema(const lmb_gltf_file *file, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
