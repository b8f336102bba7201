/* What is checked once the accessors are known. */
#ifndef LMB_GLTF_REFERENCES_H
#define LMB_GLTF_REFERENCES_H

#include "gltf/gltf_accessor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The rest that the JSON alone cannot tell: the node hierarchy, primitives, skins, instancing. Needs the accessors.
 * @return LMB_ERROR_FORMAT, _MEMORY */
lmb_result lmb_gltf_check_references(const lmb_gltf_file *file, lmb_error *error);

/* Whether an accessor may be a TEXCOORD. */
bool lmb_gltf_is_uv(const lmb_gltf_accessor *accessor);

#ifdef __cplusplus
}
#endif

#endif
