#include "gltf/gltf_part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

/* Below this share of its longest side squared, a triangle's doubled area is rounding and not a surface. */
#define DEGENERATE_AREA 1e-12

void lmb_gltf_part_free(lmb_gltf_part *p)
{
    free(p->triangles.corners);
    free(p->position);
    free(p->normal);
    free(p->tangent);
    free(p->color);
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        free(p->uv[set]);
    }
}

static bool add_target(const lmb_gltf_file *file, int32_t accessor, double weight, float *values)
{
    float *delta = NULL;
    if (accessor < 0 || weight == 0.0 || !values) {
        return true;
    }
    if (!lmb_gltf_decode_new(file, accessor, &delta)) {
        return false;
    }
    for (size_t i = 0; i < (size_t)file->accessors[accessor].count * 3; ++i) {
        values[i] = (float)((double)values[i] + weight * (double)delta[i]);
    }
    free(delta);
    return true;
}

static float corners_reach(const lmb_gltf_part *p)
{
    float reach = 0.0f;
    for (uint32_t c = 0; c < 3 * p->triangles.count; ++c) {
        const float *const position = p->position + 3 * (size_t)p->triangles.corners[c / 3][c % 3];
        for (int axis = 0; axis < 3; ++axis) {
            const float size = fabsf(position[axis]);
            reach = isfinite(size) ? lmb_larger(reach, size) : reach;
        }
    }
    return reach;
}

lmb_result lmb_gltf_part_read(const lmb_gltf_file *file, const lmb_gltf_primitive *primitive, const lmb_gltf_pose *pose,
                              const char *where, lmb_gltf_part *p, lmb_error *error)
{
    p->vertex_count = file->accessors[primitive->position].count;
    const lmb_gltf_topology topology = {primitive->mode, primitive->indices, p->vertex_count};
    const lmb_result result = lmb_gltf_triangles_read(file, &topology, where, &p->triangles, error);
    if (result != LMB_OK) {
        return result;
    }
    bool read = lmb_gltf_decode_new(file, primitive->position, &p->position) &&
                lmb_gltf_decode_new(file, primitive->normal, &p->normal) &&
                lmb_gltf_decode_new(file, primitive->normal >= 0 ? primitive->tangent : -1, &p->tangent) &&
                lmb_gltf_decode_new(file, primitive->color, &p->color);
    for (int set = 0; read && set < LMB_UV_SETS; ++set) {
        read = lmb_gltf_decode_new(file, primitive->uv[set], &p->uv[set]);
    }
    for (size_t t = 0; read && t < primitive->target_count && t < pose->weight_count; ++t) {
        read = add_target(file, primitive->targets[t].position, pose->weights[t], p->position) &&
               add_target(file, primitive->targets[t].normal, pose->weights[t], p->normal);
    }
    if (!read) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, where);
    }
    p->reach = corners_reach(p);
    p->color_components = primitive->color >= 0 ? file->accessors[primitive->color].components : 0;
    return LMB_OK;
}

/* The doubled area as a vector, and whether the triangle is one. */
static bool face_vector(const lmb_gltf_part *p, const uint32_t *corners, double face[3])
{
    double edge[3][3], longest = 0.0;
    for (int side = 0; side < 3; ++side) {
        const float *const from = p->position + 3 * (size_t)corners[side];
        const float *const to = p->position + 3 * (size_t)corners[(side + 1) % 3];
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            edge[side][axis] = (double)to[axis] - (double)from[axis];
            square += edge[side][axis] * edge[side][axis];
        }
        longest = fmax(longest, square);
    }
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        face[axis] = edge[0][a] * edge[1][b] - edge[0][b] * edge[1][a];
        square += face[axis] * face[axis];
    }
    return isfinite(square) && isfinite(longest) && sqrt(square) > DEGENERATE_AREA * longest;
}

static lmb_vec3 unit_of(const double v[3])
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return length > 0.0 && isfinite(length)
               ? lmb_vec3_of((float)(v[0] / length), (float)(v[1] / length), (float)(v[2] / length))
               : lmb_vec3_of(0.0f, 1.0f, 0.0f);
}

uint32_t lmb_gltf_part_drop_degenerate(lmb_gltf_part *p, uint32_t *indices)
{
    uint32_t kept = 0;
    for (uint32_t t = 0; t < p->triangles.count; ++t) {
        double face[3];
        if (face_vector(p, p->triangles.corners[t], face)) {
            memcpy(p->triangles.corners[kept], p->triangles.corners[t], sizeof *p->triangles.corners);
            indices[kept++] = t;
        }
    }
    const uint32_t dropped = p->triangles.count - kept;
    p->triangles.count = kept;
    return dropped;
}

bool lmb_gltf_part_repair_normals(lmb_gltf_part *p)
{
    double(*const sums)[3] = calloc((size_t)p->vertex_count + 1, sizeof *sums);
    if (!sums) {
        return false;
    }
    for (uint32_t t = 0; t < p->triangles.count; ++t) {
        double face[3];
        face_vector(p, p->triangles.corners[t], face);
        for (int k = 0; k < 9; ++k) {
            sums[p->triangles.corners[t][k / 3]][k % 3] += face[k % 3];
        }
    }
    for (size_t v = 0; v < p->vertex_count; ++v) {
        float *const n = p->normal + 3 * v;
        const lmb_vec3 unit = lmb_vec3_unit_or(lmb_vec3_of(n[0], n[1], n[2]), unit_of(sums[v]));
        n[0] = unit.x;
        n[1] = unit.y;
        n[2] = unit.z;
    }
    free(sums);
    return true;
}

lmb_vec3 lmb_gltf_part_face_normal(const lmb_gltf_part *p, uint32_t triangle)
{
    double face[3];
    face_vector(p, p->triangles.corners[triangle], face);
    return unit_of(face);
}
