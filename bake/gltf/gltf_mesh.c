#include "gltf/gltf_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/affine.h"
#include "base/scalar.h"
#include "base/vec3.h"

#include "gltf/gltf_accessor.h"

enum { MODE_TRIANGLES = 4, MODE_STRIP = 5, MODE_FAN = 6 };

/* Below this share of its longest side squared, a triangle's doubled area is rounding and not a surface. */
#define DEGENERATE_AREA 1e-12

static const uint32_t MAX_ELEMENTS = 0x7fffffffu / 3; /* so that 3 x triangles is an int */

lmb_result lmb_gltf_triangles(const lmb_gltf_file *file, const lmb_gltf_run *vertices, const char *place,
                              uint32_t (**corners)[3], uint32_t *count, lmb_error *error)
{
    const int32_t mode = vertices->mode;
    const lmb_gltf_accessor *const accessor = vertices->indices >= 0 ? &file->accessors[vertices->indices] : NULL;
    const uint32_t corner_count = accessor ? accessor->count : vertices->count;
    uint32_t triangle_count = 0;
    if (mode == MODE_TRIANGLES) {
        triangle_count = corner_count / 3;
    } else if (mode == MODE_STRIP || mode == MODE_FAN) {
        triangle_count = corner_count >= 3 ? corner_count - 2 : 0;
    }
    if (triangle_count > MAX_ELEMENTS) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: %u triangles", file->path, place, triangle_count);
    }
    uint32_t(*const made)[3] = malloc(((size_t)triangle_count + 1) * sizeof *made);
    uint32_t *const run = malloc(((size_t)corner_count + 1) * sizeof *run);
    lmb_result result = LMB_OK;
    if (!made || !run) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, place);
        goto cleanup;
    }
    if (accessor) {
        unsigned char *const bytes = (unsigned char *)run; /* an index is at most as large as what replaces it */
        lmb_gltf_copy_all(accessor, bytes);
        for (uint32_t i = corner_count; i-- > 0;) {
            run[i] = lmb_gltf_read_index(bytes, accessor->component_type, i);
        }
    }
    for (uint32_t i = 0; i < corner_count; ++i) {
        run[i] = accessor ? run[i] : i;
        if (run[i] >= vertices->count) {
            result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s.indices: element %u is vertex %u of %u", file->path,
                                   place, i, run[i], vertices->count);
            goto cleanup;
        }
    }
    for (uint32_t t = 0; t < triangle_count; ++t) {
        const uint32_t first = mode == MODE_TRIANGLES ? 3 * t : mode == MODE_FAN ? 0 : t;
        const uint32_t second = mode == MODE_TRIANGLES ? 3 * t + 1 : t + 1 + (mode == MODE_STRIP && t % 2);
        const uint32_t third = mode == MODE_TRIANGLES ? 3 * t + 2 : t + 2 - (mode == MODE_STRIP && t % 2);
        made[t][0] = run[first];
        made[t][1] = run[second];
        made[t][2] = run[third];
    }
cleanup:
    free(run);
    if (result != LMB_OK) {
        free(made);
        return result;
    }
    *corners = made;
    *count = triangle_count;
    return LMB_OK;
}

/* One primitive on its way into the mesh; arrays of 3 (tangent, colour 4; UV 2) floats a vertex. */
typedef struct part {
    uint32_t vertex_count;
    uint32_t (*corners)[3];
    uint32_t triangle_count;
    float *position, *normal, *tangent, *color, *uv[LMB_UV_SETS];
    uint32_t color_components;
    float reach; /* the largest coordinate of a corner in the file */
} part;

static void part_free(part *p)
{
    free(p->corners);
    free(p->position);
    free(p->normal);
    free(p->tangent);
    free(p->color);
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        free(p->uv[set]);
    }
}

static lmb_result out_of_memory(const lmb_gltf_file *file, const char *place, lmb_error *error)
{
    return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: %s: out of memory", file->path, place);
}

/* Decodes an attribute; NULL stays when it is absent. */
static bool decode_attribute(const lmb_gltf_file *file, int32_t accessor, float **values)
{
    if (accessor < 0) {
        return true;
    }
    const lmb_gltf_accessor *const a = &file->accessors[accessor];
    *values = malloc(((size_t)a->count + 1) * a->components * sizeof **values);
    if (*values) {
        lmb_gltf_decode_all(a, *values);
    }
    return *values != NULL;
}

static bool add_target(const lmb_gltf_file *file, int32_t accessor, double weight, float *values)
{
    float *delta = NULL;
    if (accessor < 0 || weight == 0.0 || !values) {
        return true;
    }
    if (!decode_attribute(file, accessor, &delta)) {
        return false;
    }
    for (size_t i = 0; i < (size_t)file->accessors[accessor].count * 3; ++i) {
        values[i] = (float)((double)values[i] + weight * (double)delta[i]);
    }
    free(delta);
    return true;
}

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
    const lmb_vec3 r = affine_vector(t, vec3(v[0], v[1], v[2]));
    v[0] = r.x;
    v[1] = r.y;
    v[2] = r.z;
}

/* Cofactors: the inverse transpose times the determinant. Its sign is undone so that normals keep their side. */
static lmb_affine cofactors(const lmb_affine *t)
{
    lmb_affine c = {{{0}}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c.m[i][j] = t->m[i1][j1] * t->m[i2][j2] - t->m[i1][j2] * t->m[i2][j1];
        }
    }
    const double determinant = t->m[0][0] * c.m[0][0] + t->m[0][1] * c.m[0][1] + t->m[0][2] * c.m[0][2];
    for (int k = 0; k < 12 && determinant < 0.0; ++k) {
        c.m[k / 4][k % 4] = -c.m[k / 4][k % 4];
    }
    return c;
}

/* Moves the vertices of a skinned primitive to where the joints at rest hold them, in world space. */
static lmb_result skin_part(const lmb_gltf_file *file, const lmb_gltf_primitive *primitive, const lmb_gltf_pose *pose,
                            const char *place, part *p, lmb_error *error)
{
    float *joints[2] = {NULL, NULL}, *weights[2] = {NULL, NULL};
    lmb_result result = LMB_OK;
    for (int set = 0; set < 2; ++set) {
        if (primitive->joints[set] >= 0 && primitive->weights[set] >= 0 &&
            (!decode_attribute(file, primitive->joints[set], &joints[set]) ||
             !decode_attribute(file, primitive->weights[set], &weights[set]))) {
            result = out_of_memory(file, place, error);
            goto cleanup;
        }
    }
    for (size_t v = 0; v < p->vertex_count; ++v) {
        lmb_affine sum = {{{0}}};
        bool any = false, in_range = true;
        for (int set = 0; set < 2; ++set) {
            any |= joints[set] && weights[set] &&
                   blend_joints(pose, joints[set] + 4 * v, weights[set] + 4 * v, &sum, &in_range);
        }
        if (!in_range) {
            result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s: vertex %zu names a joint that the skin has not",
                                   file->path, place, v);
            goto cleanup;
        }
        if (!any && !pose->is_moved) {
            continue;
        }
        if (!any) {
            sum = pose->joints[pose->joint_count];
        }
        float *const position = p->position + 3 * v;
        const lmb_vec3 moved = affine_point(&sum, vec3(position[0], position[1], position[2]));
        position[0] = moved.x;
        position[1] = moved.y;
        position[2] = moved.z;
        if (p->normal) {
            const lmb_affine normal_sum = cofactors(&sum);
            transform_direction(&normal_sum, p->normal + 3 * v);
        }
        if (p->tangent) {
            transform_direction(&sum, p->tangent + 4 * v);
        }
    }
cleanup:
    for (int set = 0; set < 2; ++set) {
        free(joints[set]);
        free(weights[set]);
    }
    return result;
}

static float corners_reach(const part *p)
{
    float reach = 0.0f;
    for (uint32_t c = 0; c < 3 * p->triangle_count; ++c) {
        const float *const position = p->position + 3 * (size_t)p->corners[c / 3][c % 3];
        for (int axis = 0; axis < 3; ++axis) {
            const float size = fabsf(position[axis]);
            reach = isfinite(size) ? float_larger(reach, size) : reach;
        }
    }
    return reach;
}

static lmb_result part_read(const lmb_gltf_file *file, const lmb_gltf_primitive *primitive, const lmb_gltf_pose *pose,
                            const char *place, part *p, lmb_error *error)
{
    p->vertex_count = file->accessors[primitive->position].count;
    const lmb_gltf_run vertices = {primitive->mode, primitive->indices, p->vertex_count};
    lmb_result result = lmb_gltf_triangles(file, &vertices, place, &p->corners, &p->triangle_count, error);
    if (result != LMB_OK) {
        return result;
    }
    bool read = decode_attribute(file, primitive->position, &p->position) &&
                decode_attribute(file, primitive->normal, &p->normal) &&
                decode_attribute(file, primitive->normal >= 0 ? primitive->tangent : -1, &p->tangent) &&
                decode_attribute(file, primitive->color, &p->color);
    for (int set = 0; read && set < LMB_UV_SETS; ++set) {
        read = decode_attribute(file, primitive->uv[set], &p->uv[set]);
    }
    for (size_t t = 0; read && t < primitive->target_count && t < pose->weight_count; ++t) {
        read = add_target(file, primitive->targets[t].position, pose->weights[t], p->position) &&
               add_target(file, primitive->targets[t].normal, pose->weights[t], p->normal);
    }
    if (!read) {
        return out_of_memory(file, place, error);
    }
    p->reach = corners_reach(p);
    p->color_components = primitive->color >= 0 ? file->accessors[primitive->color].components : 0;
    return pose->joints ? skin_part(file, primitive, pose, place, p, error) : LMB_OK;
}

/* The doubled area as a vector, and whether the triangle is one. */
static bool face_vector(const part *p, const uint32_t *corners, double face[3])
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
               ? vec3((float)(v[0] / length), (float)(v[1] / length), (float)(v[2] / length))
               : vec3(0.0f, 1.0f, 0.0f);
}

/* Leaves out triangles that are none, keeping the order; `numbers` gets what they were called in the file. */
static uint32_t drop_degenerate(part *p, uint32_t *numbers)
{
    uint32_t kept = 0;
    for (uint32_t t = 0; t < p->triangle_count; ++t) {
        double face[3];
        if (face_vector(p, p->corners[t], face)) {
            memcpy(p->corners[kept], p->corners[t], sizeof *p->corners);
            numbers[kept++] = t;
        }
    }
    const uint32_t dropped = p->triangle_count - kept;
    p->triangle_count = kept;
    return dropped;
}

/* Unit normals; where the file's are none, the area-weighted mean of the faces around. */
static bool repair_normals(part *p)
{
    double(*const sums)[3] = calloc((size_t)p->vertex_count + 1, sizeof *sums);
    if (!sums) {
        return false;
    }
    for (uint32_t t = 0; t < p->triangle_count; ++t) {
        double face[3];
        face_vector(p, p->corners[t], face);
        for (int k = 0; k < 9; ++k) {
            sums[p->corners[t][k / 3]][k % 3] += face[k % 3];
        }
    }
    for (size_t v = 0; v < p->vertex_count; ++v) {
        float *const n = p->normal + 3 * v;
        const lmb_vec3 unit = vec3_normalize_or(vec3(n[0], n[1], n[2]), unit_of(sums[v]));
        n[0] = unit.x;
        n[1] = unit.y;
        n[2] = unit.z;
    }
    free(sums);
    return true;
}

static float finite_or(float value, float other)
{
    return isfinite(value) ? value : other;
}

static float clamp01(float value)
{
    return value > 0.0f ? fminf(value, 1.0f) : 0.0f; /* NaN becomes 0 */
}

/* Copies vertex `from` of the part to vertex `to` of the mesh; the normal is the caller's. */
static void copy_vertex(const part *p, uint32_t from, lmb_mesh *mesh, uint32_t to)
{
    const float *const position = p->position + 3 * (size_t)from;
    const bool finite = isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]);
    mesh->position[to] = finite ? vec3(position[0], position[1], position[2]) : vec3(0.0f, 0.0f, 0.0f);
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        if (mesh->uv[set]) {
            const float *const uv = p->uv[set] ? p->uv[set] + 2 * (size_t)from : NULL;
            mesh->uv[set][to] = uv ? (lmb_vec2){finite_or(uv[0], 0.0f), finite_or(uv[1], 0.0f)} : (lmb_vec2){0, 0};
        }
    }
    if (mesh->color) {
        const float *const color = p->color ? p->color + p->color_components * (size_t)from : NULL;
        for (uint32_t c = 0; c < 4; ++c) {
            mesh->color[to][c] = color && c < p->color_components ? clamp01(color[c]) : 1.0f;
        }
    }
    if (mesh->tangent) {
        const float *const tangent = p->tangent ? p->tangent + 4 * (size_t)from : NULL;
        const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
        const lmb_vec3 unit = tangent ? vec3_normalize_or(vec3(tangent[0], tangent[1], tangent[2]), none) : none;
        const bool any = unit.x != 0.0f || unit.y != 0.0f || unit.z != 0.0f;
        mesh->tangent[to][0] = unit.x;
        mesh->tangent[to][1] = unit.y;
        mesh->tangent[to][2] = unit.z;
        mesh->tangent[to][3] = !any ? 0.0f : tangent[3] < 0.0f ? -1.0f : 1.0f;
    }
}

/* A mesh while primitives are added to it, and which of its arrays any of them fills. */
typedef struct builder {
    const lmb_gltf_file *file;
    const lmb_gltf_pose *pose;
    bool has_uv[LMB_UV_SETS], has_color, has_tangent;
    lmb_mesh *mesh;
    uint32_t dropped;
} builder;

/* Gives `array` room for `count` elements and one more, so that it is never NULL. */
#define GROW(array, count)                                                                                             \
    (larger = realloc(array, ((count) + 1) * sizeof *(array)), larger != NULL && ((array) = larger, true))

static bool mesh_grow(const builder *b, size_t vertices, size_t triangles)
{
    lmb_mesh *const mesh = b->mesh;
    void *larger;
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        if (b->has_uv[set] && !GROW(mesh->uv[set], vertices)) {
            return false;
        }
    }
    return GROW(mesh->position, vertices) && GROW(mesh->normal, vertices) &&
           (!b->has_color || GROW(mesh->color, vertices)) && (!b->has_tangent || GROW(mesh->tangent, vertices)) &&
           GROW(mesh->triangle, triangles) && GROW(mesh->material, triangles) &&
           GROW(mesh->source_primitive, triangles) && GROW(mesh->source_triangle, triangles);
}

/* Appends the part: with its own vertices, or with three of each triangle's own when it has no normals. */
static void append_part(const part *p, const lmb_gltf_primitive *primitive, const uint32_t *numbers, lmb_mesh *mesh)
{
    const uint32_t base = mesh->vertex_count;
    const bool flat = !p->normal;
    for (uint32_t v = 0; !flat && v < p->vertex_count; ++v) {
        const float *const n = p->normal + 3 * (size_t)v;
        copy_vertex(p, v, mesh, base + v);
        mesh->normal[base + v] = vec3(n[0], n[1], n[2]);
    }
    for (uint32_t t = 0; t < p->triangle_count; ++t) {
        const uint32_t to = mesh->triangle_count + t;
        double face[3];
        face_vector(p, p->corners[t], face);
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t vertex = base + (flat ? 3 * t + corner : p->corners[t][corner]);
            if (flat) {
                copy_vertex(p, p->corners[t][corner], mesh, vertex);
                mesh->normal[vertex] = unit_of(face);
            }
            mesh->triangle[to][corner] = vertex;
        }
        mesh->material[to] = primitive->material;
        mesh->source_primitive[to] = primitive->number;
        mesh->source_triangle[to] = numbers[t];
    }
    mesh->vertex_count += flat ? 3 * p->triangle_count : p->vertex_count;
    mesh->triangle_count += p->triangle_count;
}

static lmb_result add_primitive(builder *b, const lmb_gltf_primitive *primitive, lmb_error *error)
{
    const lmb_gltf_file *const file = b->file;
    lmb_mesh *const mesh = b->mesh;
    part p = {0};
    uint32_t *numbers = NULL;
    char place[LMB_GLTF_PLACE_SIZE];
    lmb_gltf_place(place, "meshes[%d].primitives[%u]", mesh->source_mesh, primitive->number);
    lmb_result result = part_read(file, primitive, b->pose, place, &p, error);
    if (result != LMB_OK) {
        goto cleanup;
    }
    numbers = malloc(((size_t)p.triangle_count + 1) * sizeof *numbers);
    if (!numbers) {
        result = out_of_memory(file, place, error);
        goto cleanup;
    }
    const uint32_t dropped_here = drop_degenerate(&p, numbers);
    const uint64_t vertices = (uint64_t)mesh->vertex_count + (p.normal ? p.vertex_count : 3 * p.triangle_count);
    const uint64_t triangles = (uint64_t)mesh->triangle_count + p.triangle_count;
    if (vertices > MAX_ELEMENTS || triangles > MAX_ELEMENTS) {
        result = lmb_error_set(error, LMB_ERROR_UNSUPPORTED, "%s: %s: too many vertices", file->path, place);
        goto cleanup;
    }
    if ((p.normal && !repair_normals(&p)) || !mesh_grow(b, (size_t)vertices, (size_t)triangles)) {
        result = out_of_memory(file, place, error);
        goto cleanup;
    }
    append_part(&p, primitive, numbers, mesh);
    mesh->file_reach = float_larger(mesh->file_reach, p.reach);
    b->dropped += dropped_here;
cleanup:
    free(numbers);
    part_free(&p);
    return result;
}

lmb_result lmb_gltf_mesh_build(const lmb_gltf_file *file, const lmb_gltf_mesh_source *source, lmb_mesh *mesh,
                               uint32_t *dropped, lmb_error *error)
{
    builder b = {.file = file, .pose = source->pose, .mesh = mesh};
    mesh->source_mesh = (int32_t)source->number;
    for (size_t i = 0; i < source->primitive_count; ++i) {
        const lmb_gltf_primitive *const primitive = &source->primitives[i];
        const bool surface = primitive->position >= 0 && primitive->mode >= MODE_TRIANGLES;
        for (int set = 0; set < LMB_UV_SETS; ++set) {
            b.has_uv[set] |= surface && primitive->uv[set] >= 0;
        }
        b.has_color |= surface && primitive->color >= 0;
        b.has_tangent |= surface && primitive->tangent >= 0 && primitive->normal >= 0;
    }
    if (!mesh_grow(&b, 0, 0)) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: meshes[%u]: out of memory", file->path, source->number);
    }
    for (size_t i = 0; i < source->primitive_count; ++i) {
        const lmb_gltf_primitive *const primitive = &source->primitives[i];
        if (primitive->position < 0 || primitive->mode < MODE_TRIANGLES) {
            continue;
        }
        const lmb_result result = add_primitive(&b, primitive, error);
        if (result != LMB_OK) {
            return result;
        }
    }
    *dropped += b.dropped;
    return LMB_OK;
}
