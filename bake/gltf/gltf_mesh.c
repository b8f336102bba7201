#include "gltf/gltf_mesh.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "gltf/gltf_json.h"
#include "gltf/gltf_skin.h"

/* Which of its optional arrays a mesh has: those that any of its primitives has. */
typedef struct mesh_streams {
    bool uv[LMB_UV_SETS], color, tangent;
} mesh_streams;

/* A mesh on its way. */
typedef struct builder {
    const lmb_gltf_file *file;
    const lmb_gltf_pose *pose;
    mesh_streams streams;
    lmb_mesh *mesh;
    uint32_t dropped; /* triangles */
    lmb_error *error;
} builder;

static float finite_or(float value, float other)
{
    return isfinite(value) ? value : other;
}

/* Copies vertex `from` of the part to vertex `to` of the mesh; the normal is the caller's. */
static void copy_vertex(const lmb_gltf_part *p, uint32_t from, lmb_mesh *mesh, uint32_t to)
{
    const float *const position = p->position + 3 * (size_t)from;
    const bool finite = isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]);
    mesh->position[to] = finite ? lmb_vec3_of(position[0], position[1], position[2]) : lmb_vec3_of(0.0f, 0.0f, 0.0f);
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        if (mesh->uv[set]) {
            const float *const uv = p->uv[set] ? p->uv[set] + 2 * (size_t)from : NULL;
            mesh->uv[set][to] = uv ? (lmb_vec2){finite_or(uv[0], 0.0f), finite_or(uv[1], 0.0f)} : (lmb_vec2){0, 0};
        }
    }
    if (mesh->color) {
        const float *const color = p->color ? p->color + p->color_components * (size_t)from : NULL;
        for (uint32_t c = 0; c < 4; ++c) {
            mesh->color[to][c] = color && c < p->color_components ? lmb_saturate(color[c]) : 1.0f;
        }
    }
    if (mesh->tangent) {
        const float *const tangent = p->tangent ? p->tangent + 4 * (size_t)from : NULL;
        const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
        const lmb_vec3 unit = tangent ? lmb_vec3_unit_or(lmb_vec3_of(tangent[0], tangent[1], tangent[2]), none) : none;
        const bool any = unit.x != 0.0f || unit.y != 0.0f || unit.z != 0.0f;
        mesh->tangent[to][0] = unit.x;
        mesh->tangent[to][1] = unit.y;
        mesh->tangent[to][2] = unit.z;
        mesh->tangent[to][3] = !any ? 0.0f : tangent[3] < 0.0f ? -1.0f : 1.0f;
    }
}

/* Gives `array` room for `count` elements and one more, so that it is never NULL. */
#define GROW(array, count)                                                                                             \
    (larger = realloc(array, ((count) + 1) * sizeof *(array)), larger != NULL && ((array) = larger, true))

static bool mesh_grow(lmb_mesh *mesh, const mesh_streams *streams, size_t vertices, size_t triangles)
{
    void *larger;
    for (int set = 0; set < LMB_UV_SETS; ++set) {
        if (streams->uv[set] && !GROW(mesh->uv[set], vertices)) {
            return false;
        }
    }
    return GROW(mesh->position, vertices) && GROW(mesh->normal, vertices) &&
           (!streams->color || GROW(mesh->color, vertices)) && (!streams->tangent || GROW(mesh->tangent, vertices)) &&
           GROW(mesh->triangle, triangles) && GROW(mesh->material, triangles) &&
           GROW(mesh->source_primitive, triangles) && GROW(mesh->source_triangle, triangles);
}

/* Appends the part: with its own vertices, or with three of each triangle's own when it has no normals. */
static void append_part(const lmb_gltf_part *p, const lmb_gltf_primitive *primitive, const uint32_t *indices,
                        lmb_mesh *mesh)
{
    const uint32_t base = mesh->vertex_count;
    const bool flat = !p->normal;
    for (uint32_t v = 0; !flat && v < p->vertex_count; ++v) {
        const float *const n = p->normal + 3 * (size_t)v;
        copy_vertex(p, v, mesh, base + v);
        mesh->normal[base + v] = lmb_vec3_of(n[0], n[1], n[2]);
    }
    for (uint32_t t = 0; t < p->triangles.count; ++t) {
        const uint32_t to = mesh->triangle_count + t;
        const lmb_vec3 normal = flat ? lmb_gltf_part_face_normal(p, t) : lmb_vec3_of(0.0f, 0.0f, 0.0f);
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const uint32_t vertex = base + (flat ? 3 * t + corner : p->triangles.corners[t][corner]);
            if (flat) {
                copy_vertex(p, p->triangles.corners[t][corner], mesh, vertex);
                mesh->normal[vertex] = normal;
            }
            mesh->triangle[to][corner] = vertex;
        }
        mesh->material[to] = primitive->material;
        mesh->source_primitive[to] = primitive->index;
        mesh->source_triangle[to] = indices[t];
    }
    mesh->vertex_count += flat ? 3 * p->triangles.count : p->vertex_count;
    mesh->triangle_count += p->triangles.count;
}

/* Adds the part with what it keeps of its triangles; `indices` has room for them. */
static lmb_result add_part(builder *b, const lmb_gltf_primitive *primitive, const char *where, lmb_gltf_part *p,
                           uint32_t *indices)
{
    lmb_mesh *const mesh = b->mesh;
    const uint32_t dropped = lmb_gltf_part_drop_degenerate(p, indices);
    const uint64_t vertices = (uint64_t)mesh->vertex_count + (p->normal ? p->vertex_count : 3 * p->triangles.count);
    const uint64_t triangles = (uint64_t)mesh->triangle_count + p->triangles.count;
    if (vertices > LMB_GLTF_MAX_ELEMENTS || triangles > LMB_GLTF_MAX_ELEMENTS) {
        return lmb_error_set(b->error, LMB_ERROR_UNSUPPORTED, "%s: %s: too many vertices", b->file->path, where);
    }
    if ((p->normal && !lmb_gltf_part_repair_normals(p)) ||
        !mesh_grow(mesh, &b->streams, (size_t)vertices, (size_t)triangles)) {
        return lmb_error_set(b->error, LMB_ERROR_MEMORY, "%s: %s: out of memory", b->file->path, where);
    }
    append_part(p, primitive, indices, mesh);
    mesh->file_reach = lmb_larger(mesh->file_reach, p->reach);
    b->dropped += dropped;
    return LMB_OK;
}

static lmb_result add_primitive(builder *b, const lmb_gltf_primitive *primitive)
{
    lmb_gltf_part p = {0};
    char where[LMB_GLTF_WHERE_SIZE];
    lmb_gltf_where(where, "meshes[%d].primitives[%u]", b->mesh->source_mesh, primitive->index);
    lmb_result result = lmb_gltf_part_read(b->file, primitive, b->pose, where, &p, b->error);
    if (result == LMB_OK && b->pose->joints) {
        result = lmb_gltf_skin(b->file, primitive, b->pose, where, &p, b->error);
    }
    if (result == LMB_OK) {
        uint32_t *const indices = malloc(((size_t)p.triangles.count + 1) * sizeof *indices);
        result = indices ? add_part(b, primitive, where, &p, indices)
                         : lmb_error_set(b->error, LMB_ERROR_MEMORY, "%s: %s: out of memory", b->file->path, where);
        free(indices);
    }
    lmb_gltf_part_free(&p);
    return result;
}

static bool has_surface(const lmb_gltf_primitive *primitive)
{
    return primitive->position >= 0 && primitive->mode >= LMB_GLTF_TRIANGLES;
}

static mesh_streams find_streams(const lmb_gltf_mesh *source)
{
    mesh_streams streams = {{false}, false, false};
    for (size_t i = 0; i < source->primitive_count; ++i) {
        const lmb_gltf_primitive *const primitive = &source->primitives[i];
        const bool surface = has_surface(primitive);
        for (int set = 0; set < LMB_UV_SETS; ++set) {
            streams.uv[set] |= surface && primitive->uv[set] >= 0;
        }
        streams.color |= surface && primitive->color >= 0;
        streams.tangent |= surface && primitive->tangent >= 0 && primitive->normal >= 0;
    }
    return streams;
}

lmb_result lmb_gltf_mesh_build(const lmb_gltf_file *file, const lmb_gltf_mesh *source, const lmb_gltf_pose *pose,
                               lmb_mesh *mesh, uint32_t *dropped, lmb_error *error)
{
    builder b = {file, pose, find_streams(source), mesh, 0, error};
    mesh->source_mesh = (int32_t)source->index;
    if (!mesh_grow(mesh, &b.streams, 0, 0)) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: meshes[%u]: out of memory", file->path, source->index);
    }
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < source->primitive_count && result == LMB_OK; ++i) {
        if (has_surface(&source->primitives[i])) {
            result = add_primitive(&b, &source->primitives[i]);
        }
    }
    *dropped += b.dropped;
    return result;
}
