/* What is found at a hit: where it is, how it faces, what its material does. */
#include <lambent/surface.h>

#include <math.h>

#include <lambent/vector.h>

#include "base/affine.h"
#include "trace/surface_internal.h"
#include "trace/trace_internal.h"

void lmb_trace_corners(const lmb_tracer *tracer, uint32_t instance_index, uint32_t triangle, lmb_vec3 corner[3])
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_instance *instance = &scene->instances[instance_index];
    const lmb_mesh *mesh = &scene->meshes[instance->mesh];
    const lmb_vec3 *world = lmb_tracer_world_vertices(tracer, instance_index);
    for (int k = 0; k < 3; ++k) {
        const uint32_t vertex = mesh->triangle[triangle][k];
        corner[k] = world ? world[vertex] : affine_point(&instance->to_world, mesh->position[vertex]);
    }
}

float lmb_trace_triangle_area(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
{
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, instance, triangle, corner);
    return 0.5f *
           lmb_vec3_length(lmb_vec3_cross(lmb_vec3_sub(corner[1], corner[0]), lmb_vec3_sub(corner[2], corner[0])));
}

/* Rounding may put a point near a triangle's edge behind the wall that stands there; its rays would start outside the
 * room. One rounding step towards the triangle's middle keeps it inside. */
static lmb_vec3 position_inset(lmb_vec3 position, const lmb_vec3 corner[3], float rounding)
{
    const lmb_vec3 middle = lmb_vec3_scale(lmb_vec3_add(lmb_vec3_add(corner[0], corner[1]), corner[2]), 1.0f / 3.0f);
    const lmb_vec3 inward = lmb_vec3_sub(middle, position);
    const float length = lmb_vec3_length(inward);
    return length > 0.0f ? lmb_vec3_mad(position, inward, lmb_smaller(rounding / length, 0.5f)) : position;
}

static float corners_rounding(const lmb_vec3 corner[3])
{
    const float a = trace_epsilon(corner[0]), b = trace_epsilon(corner[1]), c = trace_epsilon(corner[2]);
    const float larger = a > b ? a : b;
    return larger > c ? larger : c;
}

static lmb_vec3 corners_position(const lmb_vec3 corner[3], float u, float v, float rounding)
{
    const lmb_vec3 along_u = lmb_vec3_mad(corner[0], lmb_vec3_sub(corner[1], corner[0]), u);
    return position_inset(lmb_vec3_mad(along_u, lmb_vec3_sub(corner[2], corner[0]), v), corner, rounding);
}

void lmb_trace_positions(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle, const float (*weights)[2],
                         uint32_t count, lmb_vec3 *position)
{
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, instance, triangle, corner);
    const float rounding = corners_rounding(corner);
    for (uint32_t i = 0; i < count; ++i) {
        position[i] = corners_position(corner, weights[i][0], weights[i][1], rounding);
    }
}

lmb_vec3 lmb_trace_position(const lmb_tracer *tracer, const lmb_hit *hit)
{
    const float weights[1][2] = {{hit->u, hit->v}};
    lmb_vec3 position;
    lmb_trace_positions(tracer, hit->instance, hit->triangle, weights, 1, &position);
    return position;
}

lmb_place lmb_trace_place(const lmb_tracer *tracer, const lmb_hit *hit)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_instance *instance = &scene->instances[hit->instance];
    const lmb_mesh *mesh = &scene->meshes[instance->mesh];
    const uint32_t *vertex = mesh->triangle[hit->triangle];
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, hit->instance, hit->triangle, corner);
    const lmb_vec3 edge_u = lmb_vec3_sub(corner[1], corner[0]);
    const lmb_vec3 edge_v = lmb_vec3_sub(corner[2], corner[0]);
    lmb_place place;
    place.rounding = corners_rounding(corner);
    place.position = corners_position(corner, hit->u, hit->v, place.rounding);
    lmb_vec3 facing = lmb_vec3_unit_or(lmb_vec3_cross(edge_u, edge_v), lmb_vec3_of(0.0f, 1.0f, 0.0f));
    if (instance->mirrored != lmb_tracer_is_turned(tracer, hit->instance)) {
        facing = lmb_vec3_scale(facing, -1.0f);
    }
    place.geometric_normal = facing;
    const float w = 1.0f - hit->u - hit->v;
    const lmb_vec3 local =
        lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(mesh->normal[vertex[0]], w), mesh->normal[vertex[1]], hit->u),
                     mesh->normal[vertex[2]], hit->v);
    const lmb_vec3 smooth = lmb_vec3_unit_or(affine_vector(&instance->normal_to_world, local), facing);
    place.shading_normal = lmb_vec3_dot(smooth, facing) < 0.0f ? lmb_vec3_scale(smooth, -1.0f) : smooth;
    return place;
}

lmb_mesh_point lmb_trace_mesh_point(const lmb_tracer *tracer, const lmb_hit *hit)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    return (lmb_mesh_point){scene, &scene->meshes[scene->instances[hit->instance].mesh], hit->triangle, hit->u, hit->v};
}

lmb_surface lmb_trace_surface(const lmb_tracer *tracer, const lmb_hit *hit)
{
    const lmb_mesh_point point = lmb_trace_mesh_point(tracer, hit);
    return lmb_material_surface(&point);
}

/* World-space tangent of increasing texture u: the mesh's own, or derived from the triangle's UVs. `*handedness` tells
 * the bitangent's side. Returns false where UVs give none. */
static bool tangent_at(const lmb_tracer *tracer, const lmb_hit *hit, int set, lmb_vec3 *tangent, float *handedness)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_instance *instance = &scene->instances[hit->instance];
    const lmb_mesh *mesh = &scene->meshes[instance->mesh];
    const uint32_t *vertex = mesh->triangle[hit->triangle];
    if (mesh->tangent) {
        const float weight[3] = {1.0f - hit->u - hit->v, hit->u, hit->v};
        lmb_vec3 sum = {0.0f, 0.0f, 0.0f};
        for (int k = 0; k < 3; ++k) {
            const float *t = mesh->tangent[vertex[k]];
            sum = lmb_vec3_mad(sum, lmb_vec3_of(t[0], t[1], t[2]), weight[k]);
        }
        *tangent = affine_vector(&instance->to_world, sum);
        *handedness = instance->mirrored ? -mesh->tangent[vertex[0]][3] : mesh->tangent[vertex[0]][3];
        if (lmb_vec3_length(*tangent) > 0.0f) {
            return true;
        }
    }
    if (!mesh->uv[set]) {
        return false;
    }
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, hit->instance, hit->triangle, corner);
    const lmb_vec2 a = mesh->uv[set][vertex[0]];
    const lmb_vec2 b = mesh->uv[set][vertex[1]];
    const lmb_vec2 c = mesh->uv[set][vertex[2]];
    const float area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (!(fabsf(area) > 0.0f)) {
        return false;
    }
    *tangent = lmb_vec3_sub(lmb_vec3_scale(lmb_vec3_sub(corner[1], corner[0]), c.y - a.y),
                            lmb_vec3_scale(lmb_vec3_sub(corner[2], corner[0]), b.y - a.y));
    *tangent = lmb_vec3_scale(*tangent, area > 0.0f ? 1.0f : -1.0f);
    /* Image rows run downwards while tangent-space +Y is up: glTF's bitangent is cross(n, t) w with w = 1 for UVs
     * that are not mirrored as seen with v pointing up. */
    *handedness = (area > 0.0f) != instance->mirrored ? -1.0f : 1.0f;
    return true;
}

lmb_vec3 lmb_trace_mapped_normal(const lmb_tracer *tracer, const lmb_hit *hit, const lmb_place *place)
{
    const lmb_mesh_point point = lmb_trace_mesh_point(tracer, hit);
    const lmb_material *material = lmb_material_at(&point);
    const lmb_vec3 normal = place->shading_normal;
    const lmb_texture *map = &material->normal_texture;
    lmb_vec3 tangent;
    float handedness;
    if (map->image < 0 || !tangent_at(tracer, hit, map->uv_set, &tangent, &handedness)) {
        return normal;
    }
    float texel[4];
    lmb_material_texel(&point, map, false, texel);
    tangent = lmb_vec3_unit_or(lmb_vec3_mad(tangent, normal, -lmb_vec3_dot(tangent, normal)), normal);
    const lmb_vec3 bitangent = lmb_vec3_scale(lmb_vec3_cross(normal, tangent), handedness);
    const float x = (2.0f * texel[0] - 1.0f) * material->normal_scale;
    const float y = (2.0f * texel[1] - 1.0f) * material->normal_scale;
    const float z = lmb_larger(2.0f * texel[2] - 1.0f, 0.05f);
    return lmb_vec3_unit_or(lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(normal, z), tangent, x), bitangent, y), normal);
}
