/* The buffers of a level whose JSON was checked, and the views of them. */
#ifndef LMB_GLTF_BUFFERS_H
#define LMB_GLTF_BUFFERS_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads every buffer, then finds every view in its buffer. A buffer without bytes in the file is none of its errors, as
 * long as nobody reads it.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_buffers_read(lmb_gltf_file *file, lmb_error *error);
lmb_result lmb_gltf_views_resolve(lmb_gltf_file *file, lmb_error *error);

/* A buffer view's bytes; `data` is NULL when the file does not have them. */
lmb_gltf_bytes lmb_gltf_view_bytes(const lmb_gltf_file *file, uint32_t view);

#ifdef __cplusplus
}
#endif

#endif
