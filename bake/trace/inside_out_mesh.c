/* Which parts of a mesh are closed and face inwards: by their volumes and edges. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "scene/mesh_weld.h"
#include "base/vec3d.h"
#include "trace/inside_out.h"

/* Volumes within this part of (area)^(3/2) are those of sheets; a sphere has 0.094. */
#define LEAST_VOLUME 1e-4

static void triangle_corners(const lmb_mesh *mesh, uint32_t triangle, lmb_vec3d corner[3])
{
    for (int k = 0; k < 3; ++k) {
        corner[k] = vec3d_of(mesh->position[mesh->triangle[triangle][k]]);
    }
}

/* Six times the volume of the tetrahedron to `apex`, positive where the triangle faces away from it. */
static double triangle_volume(const lmb_mesh *mesh, uint32_t triangle, lmb_vec3d apex)
{
    lmb_vec3d corner[3];
    triangle_corners(mesh, triangle, corner);
    return vec3d_dot(vec3d_between(apex, corner[0]),
                     vec3d_cross(vec3d_between(apex, corner[1]), vec3d_between(apex, corner[2])));
}

static double triangle_area(const lmb_mesh *mesh, uint32_t triangle)
{
    lmb_vec3d corner[3];
    triangle_corners(mesh, triangle, corner);
    const lmb_vec3d normal = vec3d_cross(vec3d_between(corner[0], corner[1]), vec3d_between(corner[0], corner[2]));
    return 0.5 * sqrt(vec3d_dot(normal, normal));
}

/* Triangles that hang together. */
typedef struct part {
    double volume; /* six times it */
    double area;
    uint64_t edges; /* 0 (almost surely) if each edge is walked as often one way as the other: then it is closed */
} part;

static uint32_t root_find(uint32_t *parent, uint32_t item)
{
    while (parent[item] != item) {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    return item;
}

static uint64_t edge_sum(uint32_t from, uint32_t to)
{
    const uint64_t hash = lmb_mix(from < to ? from : to, from < to ? to : from);
    return from < to ? hash : from > to ? UINT64_C(0) - hash : 0;
}

/* Sums up all parts; `parts` [vertex] is that of the root. */
static void parts_sum(const lmb_mesh *mesh, lmb_vec3d apex, const uint32_t *weld, uint32_t *parent, part *parts)
{
    memcpy(parent, weld, mesh->vertex_count * sizeof *parent);
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const uint32_t root = root_find(parent, mesh->triangle[t][0]);
        for (int k = 1; k < 3; ++k) {
            parent[root_find(parent, mesh->triangle[t][k])] = root;
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        const uint32_t *const v = mesh->triangle[t];
        part *const sum = &parts[root_find(parent, v[0])];
        sum->volume += triangle_volume(mesh, t, apex);
        sum->area += triangle_area(mesh, t);
        for (int k = 0; k < 3; ++k) {
            sum->edges += edge_sum(weld[v[k]], weld[v[(k + 1) % 3]]);
        }
    }
}

static lmb_vec3d mesh_middle(const lmb_mesh *mesh)
{
    lmb_vec3 low = mesh->position[mesh->triangle[0][0]], high = low;
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        low = lmb_vec3_smaller(low, mesh->position[v]);
        high = lmb_vec3_larger(high, mesh->position[v]);
    }
    return (lmb_vec3d){0.5 * ((double)low.x + (double)high.x), 0.5 * ((double)low.y + (double)high.y),
                       0.5 * ((double)low.z + (double)high.z)};
}

static bool part_is_inward(const part *sum)
{
    return sum->edges == 0 && sum->volume < -6.0 * LEAST_VOLUME * sum->area * sqrt(sum->area);
}

lmb_result lmb_mesh_mark_inward(const lmb_mesh *mesh, uint8_t *inward, uint32_t *others)
{
    uint32_t *const weld = malloc(mesh->vertex_count * sizeof *weld);
    uint32_t *const parent = malloc(mesh->vertex_count * sizeof *parent);
    part *const parts = calloc(mesh->vertex_count, sizeof *parts);
    const bool enough = weld && parent && parts && lmb_mesh_weld(mesh, weld);
    if (enough) {
        parts_sum(mesh, mesh_middle(mesh), weld, parent, parts);
    }
    *others = 0;
    for (uint32_t t = 0; enough && t < mesh->triangle_count; ++t) {
        const part *sum = &parts[root_find(parent, mesh->triangle[t][0])];
        inward[t] = part_is_inward(sum);
        *others += !inward[t] && sum->area > 0.0;
    }
    free(weld);
    free(parent);
    free(parts);
    return enough ? LMB_OK : LMB_ERROR_MEMORY;
}

lmb_result lmb_mesh_is_inward(const lmb_mesh *mesh, bool *inward)
{
    *inward = false;
    const lmb_vec3d middle = mesh_middle(mesh);
    double volume = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        volume += triangle_volume(mesh, t, middle);
    }
    if (!(volume < 0.0)) {
        return LMB_OK; /* most meshes: nothing more to look at */
    }
    uint8_t *const marks = malloc(mesh->triangle_count);
    uint32_t others = 0;
    const lmb_result result = marks ? lmb_mesh_mark_inward(mesh, marks, &others) : LMB_ERROR_MEMORY;
    *inward = result == LMB_OK && others == 0;
    free(marks);
    return result;
}
