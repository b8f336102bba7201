#include "gltf/gltf_skin.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "base/affine.h"
#include "gltf/gltf_transform.h"

/* Sum of the joints' matrices by the vertex's weights; false when it has none. */
static bool blend_joints(const lmb_gltf_pose *pose, const float *joints, const float *weights, lmb_affine *sum,
                         bool *in_range)
{
    double total = 0.0;
    for (int i = 0; i < 4; ++i) {
        const double weight = (double)weights[i];
        if (!(weight > 0.0) || !isfinite(weight)) {
            continue;
        }
        if ((double)joints[i] >= (double)pose->joint_count) {
            *in_range = false;
            return false;
        }
        const lmb_affine *const joint = &pose->joints[(size_t)joints[i]];
        for (int k = 0; k < 12; ++k) {
            sum->m[k / 4][k % 4] += weight * joint->m[k / 4][k % 4];
        }
        total += weight;
    }
    return total > 0.0;
}

static void transform_direction(const lmb_affine *t, float *v)
{
    const lmb_vec3 r = affine_vector(t, lmb_vec3_of(v[0], v[1], v[2]));
    v[0] = r.x;
    v[1] = r.y;
    v[2] = r.z;
}

/* Transforms normals by the inverse transpose, but for its size. They keep their side. */
static lmb_affine normal_transform(const lmb_affine *t)
{
    lmb_affine c;
    const double determinant = lmb_gltf_cofactors(t, &c);
    for (int k = 0; k < 9 && determinant < 0.0; ++k) {
        c.m[k / 3][k % 3] = -c.m[k / 3][k % 3];
    }
    return c;
}

static void move_vertex(const lmb_affine *t, size_t v, lmb_gltf_part *part)
{
    float *const position = part->position + 3 * v;
    const lmb_vec3 moved = affine_point(t, lmb_vec3_of(position[0], position[1], position[2]));
    position[0] = moved.x;
    position[1] = moved.y;
    position[2] = moved.z;
    if (part->normal) {
        const lmb_affine for_normals = normal_transform(t);
        transform_direction(&for_normals, part->normal + 3 * v);
    }
    if (part->tangent) {
        transform_direction(t, part->tangent + 4 * v);
    }
}

lmb_result lmb_gltf_skin(const lmb_gltf_file *file, const lmb_gltf_primitive *primitive, const lmb_gltf_pose *pose,
                         const char *where, lmb_gltf_part *part, lmb_error *error)
{
    float *joints[2] = {NULL, NULL}, *weights[2] = {NULL, NULL};
    lmb_result result = LMB_OK;
    for (int set = 0; set < 2; ++set) {
        if (primitive->joints[set] >= 0 && primitive->weights[set] >= 0 &&
            (!lmb_gltf_decode_new(file, primitive->joints[set], &joints[set]) ||
             !lmb_gltf_decode_new(file, primitive->weights[set], &weights[set]))) {
            result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
            goto cleanup;
        }
    }
    for (size_t v = 0; v < part->vertex_count; ++v) {
        lmb_affine sum = {{{0}}};
        bool any = false, in_range = true;
        for (int set = 0; set < 2; ++set) {
            any |= joints[set] && weights[set] &&
                   blend_joints(pose, joints[set] + 4 * v, weights[set] + 4 * v, &sum, &in_range);
        }
        if (!in_range) {
            result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: vertex %zu names a joint that the skin has not",
                                   file->path, where, v);
            goto cleanup;
        }
        if (any || pose->is_moved) {
            move_vertex(any ? &sum : &pose->joints[pose->joint_count], v, part);
        }
    }
cleanup:
    for (int set = 0; set < 2; ++set) {
        free(joints[set]);
        free(weights[set]);
    }
    return result;
}
