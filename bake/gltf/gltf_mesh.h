/* The meshes of a scene from those of a file. */
#ifndef LMB_GLTF_MESH_H
#define LMB_GLTF_MESH_H

#include "gltf/gltf_part.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh of the file. */
typedef struct lmb_gltf_mesh {
    uint32_t index;
    const lmb_gltf_primitive *primitives;
    size_t primitive_count;
} lmb_gltf_mesh;

/* Joins the primitives that have surfaces into one mesh. `mesh` must be zero; on failure it holds what lmb_mesh_free
 * frees. `*dropped` grows by the triangles that are none.
 * @return LMB_ERROR_FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_mesh_build(const lmb_gltf_file *file, const lmb_gltf_mesh *source, const lmb_gltf_pose *pose,
                               lmb_mesh *mesh, uint32_t *dropped, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
