/* What of the JSON is checked before anything is read by it. */
#ifndef LMB_GLTF_CHECK_H
#define LMB_GLTF_CHECK_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Versions, required extensions, the type and range of every property that is read, and its words. Every function that
 * reads the JSON needs this.
 * @return LMB_ERROR_FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_check_json(const lmb_gltf_file *file, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
