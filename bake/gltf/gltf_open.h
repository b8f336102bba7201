/* Opens a glTF file: everything about it is read and checked but what its elements and pictures say. */
#ifndef LMB_GLTF_OPEN_H
#define LMB_GLTF_OPEN_H

#include <lambent/gltf.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* For lmb_gltf_file_close. `options` may be NULL. @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_open(const lmb_gltf_source *source, const lmb_gltf_options *options, lmb_gltf_file **file,
                         lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
