/* Primitives joined to meshes of the scene. */
#ifndef LMB_GLTF_MESH_H
#define LMB_GLTF_MESH_H

#include "gltf/gltf_file.h"

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One primitive's accessors; -1 where absent. */
typedef struct lmb_gltf_target {
    int32_t position;
    int32_t normal;
} lmb_gltf_target;

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
    uint32_t number; /* in its glTF mesh */
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

/* Which vertices a primitive takes, in what order. */
typedef struct lmb_gltf_run {
    int32_t mode;
    int32_t indices; /* accessor; -1: one after the other */
    uint32_t count;  /* of its vertices */
} lmb_gltf_run;

/* The corners (vertex numbers) of all triangles of a primitive, in order; none for points and lines. Every number is
 * checked against the vertex count. `*corners` is malloc'ed. */
lmb_result lmb_gltf_triangles(const lmb_gltf_file *file, const lmb_gltf_run *vertices, const char *place,
                              uint32_t (**corners)[3], uint32_t *count, lmb_error *error);

/* A mesh of the file: its number, its primitives and how they stand. */
typedef struct lmb_gltf_mesh_source {
    uint32_t number;
    const lmb_gltf_primitive *primitives;
    size_t primitive_count;
    const lmb_gltf_pose *pose;
} lmb_gltf_mesh_source;

/* Joins primitives into one mesh, and adds to `*dropped` how many triangles were left out. `mesh` must be zero; on
 * failure it holds what lmb_mesh_free frees. */
lmb_result lmb_gltf_mesh_build(const lmb_gltf_file *file, const lmb_gltf_mesh_source *source, lmb_mesh *mesh,
                               uint32_t *dropped, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
