/* One primitive, decoded and morphed, on its way into a mesh. */
#ifndef LMB_GLTF_PART_H
#define LMB_GLTF_PART_H

#include <lambent/affine.h>
#include <lambent/scene.h>

#include "gltf/gltf_triangles.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The accessors of a morph target; -1 where absent. */
typedef struct lmb_gltf_target {
    int32_t position;
    int32_t normal;
} lmb_gltf_target;

/* One primitive's accessors; -1 where absent. */
typedef struct lmb_gltf_primitive {
    int32_t mode;
    int32_t indices;
    int32_t position;
    int32_t normal;
    int32_t tangent;
    int32_t color;
    int32_t uv[LMB_UV_SETS]; /* as lmb_mesh.uv */
    int32_t joints[2];
    int32_t weights[2];
    uint32_t material;
    uint32_t index; /* in its glTF mesh */
    const lmb_gltf_target *targets;
    size_t target_count;
} lmb_gltf_primitive;

/* How a mesh stands at rest. */
typedef struct lmb_gltf_pose {
    const double *weights; /* [target], NULL: none */
    size_t weight_count;
    const lmb_affine *joints; /* [joint] from mesh space to the scene, then that of vertices without a joint;
                                 NULL: not skinned */
    size_t joint_count;
    bool is_moved; /* the scene counts from another origin than the world */
} lmb_gltf_pose;

/* Arrays of 3 (tangent, colour 4; UV 2) floats a vertex, NULL where absent. */
typedef struct lmb_gltf_part {
    uint32_t vertex_count;
    lmb_gltf_triangles triangles;
    float *position, *normal, *tangent, *color, *uv[LMB_UV_SETS];
    uint32_t color_components;
    float reach; /* the largest coordinate of a corner in the file */
} lmb_gltf_part;

/* `part` must be zero; on failure too it holds what lmb_gltf_part_free frees. `where` names it in messages.
 * @return LMB_ERROR_FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_part_read(const lmb_gltf_file *file, const lmb_gltf_primitive *primitive, const lmb_gltf_pose *pose,
                              const char *where, lmb_gltf_part *part, lmb_error *error);
void lmb_gltf_part_free(lmb_gltf_part *part);

/* Leaves out triangles that are none, keeping the order; `indices` gets what they were called in the file.
 * @return how many were left out */
uint32_t lmb_gltf_part_drop_degenerate(lmb_gltf_part *part, uint32_t *indices);

/* Unit normals; where the file's are none, the area-weighted mean of the faces around. @return false when out of memory
 */
bool lmb_gltf_part_repair_normals(lmb_gltf_part *part);

/* The unit normal of a triangle that was kept. */
lmb_vec3 lmb_gltf_part_face_normal(const lmb_gltf_part *part, uint32_t triangle);

#ifdef __cplusplus
}
#endif

#endif
