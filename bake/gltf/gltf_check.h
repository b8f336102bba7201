/* What the JSON must be like, property by property. */
#ifndef LMB_GLTF_CHECK_H
#define LMB_GLTF_CHECK_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Versions, required extensions, then the type and range of every property that is read. */
lmb_result lmb_gltf_check_json(const lmb_gltf_file *file, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
