/* What the URIs of a level stand for: data: URIs, and files beside it. */
#ifndef LMB_GLTF_URI_H
#define LMB_GLTF_URI_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The bytes that a `uri` stands for; `where` names it in messages. Those of a file are added to file->hash. Unless the
 * level allows it, no path leaves its folder.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_uri_read(lmb_gltf_file *file, const char *uri, const char *where, lmb_gltf_bytes *bytes,
                             lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
