/* Skinned primitives at rest. */
#ifndef LMB_GLTF_SKIN_H
#define LMB_GLTF_SKIN_H

#include "gltf/gltf_part.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Moves the vertices of a skinned primitive to where the joints at rest hold them, in the scene. `where` names it in
 * messages. @return LMB_ERROR_FORMAT, _MEMORY */
lmb_result lmb_gltf_skin(const lmb_gltf_file *file, const lmb_gltf_primitive *primitive, const lmb_gltf_pose *pose,
                         const char *where, lmb_gltf_part *part, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
