/* What the JSON must be like as a whole. */
#ifndef LMB_GLTF_REFERENCES_H
#define LMB_GLTF_REFERENCES_H

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What is left to check: the node hierarchy, primitives, skins. Needs the accessors. */
lmb_result lmb_gltf_check_references(const lmb_gltf_file *file, lmb_error *error);

/* Whether an accessor may be a TEXCOORD. */
bool lmb_gltf_is_uv(const lmb_gltf_accessor *accessor);

#ifdef __cplusplus
}
#endif

#endif
