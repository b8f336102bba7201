/* How a node's transform places what hangs on it. */
#ifndef LMB_GLTF_TRANSFORM_H
#define LMB_GLTF_TRANSFORM_H

#include <stdbool.h>

#include <lambent/affine.h>
#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Metres: nothing is placed as far as this. Squares of what is nearer are floats. */
#define LMB_GLTF_FARTHEST 1e18

/* a after b. */
lmb_affine lmb_gltf_product(const lmb_affine *a, const lmb_affine *b);

/* translation x rotation x scale, with a quaternion x, y, z, w that need not be unit, and turns nothing when it is
 * zero. */
lmb_affine lmb_gltf_compose(const double t[3], const double q[4], const double s[3]);

/* The cofactors of the linear part: its inverse transpose times its determinant; the translation is zero.
 * @return the determinant */
double lmb_gltf_cofactors(const lmb_affine *t, lmb_affine *cofactor);

/* @return false, and nothing is set, where it flattens, or its inverse is not finite */
bool lmb_gltf_inverse(const lmb_affine *t, lmb_affine *inverse);

/* One transform of EXT_mesh_gpu_instancing from its floats, each NULL where the node has none, and the largest of its
 * translation. @return false when one is not finite */
bool lmb_gltf_instancing_transform(const float *translation, const float *rotation, const float *scale,
                                   lmb_affine *transform, float *reach);

/* Unit, where a node's -Z points; -Z of the world where it has no direction. */
lmb_vec3 lmb_gltf_forward(const lmb_affine *to_world);

typedef enum lmb_gltf_rank { LMB_GLTF_NOTHING, LMB_GLTF_FLAT, LMB_GLTF_SOLID } lmb_gltf_rank;
lmb_gltf_rank lmb_gltf_transform_rank(const lmb_affine *t);

/* Sets the transforms, from positions that `shift` was taken off, and `mirrored`. What is flattened along one axis gets
 * a thickness of a millionth, so that its normals have a transform. @return false when nothing is left to see */
bool lmb_gltf_instance_place(const lmb_affine *to_world, const lmb_vec3 *shift, lmb_instance *instance);

#ifdef __cplusplus
}
#endif

#endif
