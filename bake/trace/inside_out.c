#include "trace/inside_out.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "base/affine.h"
#include "base/directions.h"
#include "base/interval.h"
#include "base/vec3d.h"
#include "trace/trace_internal.h"

/* Points all over an object, and rays from each of them; fewer points where there are very many objects. */
enum { MOST_POINTS = 16, LEAST_POINTS = 2, POINTS_OF_ALL = 1 << 16, RAYS_PER_POINT = LMB_RAY_BATCH };

/* Of the rays outwards that meet other objects or leave the level, so many must meet fronts. */
#define LEAST_FRONTS 0.05f

/* How many of an object's vertices are looked at, to tell whether it is within another. */
enum { SAMPLE_VERTICES = 16 };

/* Larger meshes are levels rather than objects, and take long to take apart. */
enum { MOST_TRIANGLES = 1 << 18 };

/* Other objects that are seen from inside of one. */
enum { MOST_SEEN = 64 };

/* Whether no light comes from or through the object, and whether all of it is double-sided. `marks` NULL: all of the
 * mesh, else its marked triangles. */
static bool object_is_dark(const lmb_scene *scene, const lmb_mesh *mesh, const uint8_t *marks, bool *double_sided)
{
    *double_sided = true;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        if (marks && !marks[t]) {
            continue;
        }
        const lmb_material *material = &scene->materials[mesh->material[t]];
        if (!lmb_material_is_opaque(material) || lmb_material_emits(material)) {
            return false;
        }
        *double_sided = *double_sided && material->double_sided;
    }
    return true;
}

/* What all instances share. */
typedef struct facing_work {
    const lmb_tracer *tracer;
    const lmb_scene *scene;
    uint8_t *mesh_inward; /* [mesh] */
    uint32_t *dynamic;    /* instances that move */
    uint32_t dynamic_count;
    uint32_t points; /* on each object */
} facing_work;

/* What is looked at for one instance. */
typedef struct candidate {
    const facing_work *work;
    const lmb_tracer *tracer;
    const lmb_scene *scene;
    uint32_t instance;
    const uint8_t *marks; /* [triangle] what belongs to it; NULL: all */
    lmb_vec3 low, high;   /* world bounds */
    double *area_before;  /* [triangle + 1] in world space */
} candidate;

static const lmb_mesh *instance_mesh(const lmb_scene *scene, uint32_t instance)
{
    return &scene->meshes[scene->instances[instance].mesh];
}

static bool object_has(const candidate *object, uint32_t triangle)
{
    return !object->marks || object->marks[triangle];
}

static lmb_result candidate_make(const facing_work *work, uint32_t instance, const uint8_t *marks, candidate *made)
{
    const lmb_mesh *mesh = instance_mesh(work->scene, instance);
    *made = (candidate){.work = work,
                        .tracer = work->tracer,
                        .scene = work->scene,
                        .instance = instance,
                        .marks = marks,
                        .low = {FLT_MAX, FLT_MAX, FLT_MAX},
                        .high = {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    made->area_before = malloc(((size_t)mesh->triangle_count + 1) * sizeof *made->area_before);
    if (!made->area_before) {
        return LMB_ERROR_MEMORY;
    }
    double area = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
        lmb_vec3 corner[3];
        made->area_before[t] = area;
        if (!object_has(made, t)) {
            continue;
        }
        lmb_trace_corners(work->tracer, instance, t, corner);
        for (int k = 0; k < 3; ++k) {
            made->low = lmb_vec3_smaller(made->low, corner[k]);
            made->high = lmb_vec3_larger(made->high, corner[k]);
        }
        area += (double)lmb_vec3_length(
            lmb_vec3_cross(lmb_vec3_sub(corner[1], corner[0]), lmb_vec3_sub(corner[2], corner[0])));
    }
    made->area_before[mesh->triangle_count] = area;
    return LMB_OK;
}

/* Cosine-distributed rays from the index-th point, on the side of the front (side 1) or of the back (-1). */
static void surface_rays(const candidate *object, uint32_t index, float side, lmb_hit hit[RAYS_PER_POINT])
{
    const uint32_t triangles = instance_mesh(object->scene, object->instance)->triangle_count;
    const double target = ((double)index + 0.5) / object->work->points * object->area_before[triangles];
    const uint64_t stream = lmb_mix(object->instance, index);
    float point[2];
    lmb_sequence_2d(stream, 0, 1, point);
    lmb_hit start = {.instance = object->instance,
                     .triangle = (uint32_t)lmb_interval_find(object->area_before, triangles, target)};
    lmb_triangle_point(point, &start.u, &start.v);
    const lmb_place place = lmb_trace_place(object->tracer, &start);
    const lmb_vec3 normal = lmb_vec3_scale(place.geometric_normal, side);
    const lmb_vec3 origin = trace_offset(place.position, place.geometric_normal, place.rounding, normal);
    float x[RAYS_PER_POINT], y[RAYS_PER_POINT];
    lmb_ray_batch rays;
    float *const direction[3] = {rays.direction[0], rays.direction[1], rays.direction[2]};
    lmb_sequence_2d_batch(stream, 0, RAYS_PER_POINT, 0, x, y);
    lmb_directions_make(LMB_LOBE_COSINE, normal, x, y, RAYS_PER_POINT, direction);
    rays.count = RAYS_PER_POINT;
    for (uint32_t i = 0; i < RAYS_PER_POINT; ++i) {
        rays.origin[0][i] = origin.x;
        rays.origin[1][i] = origin.y;
        rays.origin[2][i] = origin.z;
        rays.far_distance[i] = FLT_MAX;
    }
    lmb_trace_nearest_batch(object->tracer, &rays, hit);
}

/* Signed crossings of the object's triangles from a point on, exact but for rays that meet an edge. */
static int crossings_along(const candidate *object, lmb_vec3d from, lmb_vec3d direction)
{
    int crossings = 0;
    const uint32_t count = instance_mesh(object->scene, object->instance)->triangle_count;
    for (uint32_t t = 0; t < count; ++t) {
        lmb_vec3 corner[3];
        if (!object_has(object, t)) {
            continue;
        }
        lmb_trace_corners(object->tracer, object->instance, t, corner);
        const lmb_vec3d a = vec3d_of(corner[0]);
        const lmb_vec3d u = vec3d_between(a, vec3d_of(corner[1]));
        const lmb_vec3d v = vec3d_between(a, vec3d_of(corner[2]));
        const lmb_vec3d across = vec3d_cross(direction, v);
        const double facing = vec3d_dot(u, across);
        if (facing == 0.0) {
            continue;
        }
        const lmb_vec3d to = vec3d_between(a, from);
        const double at_u = vec3d_dot(to, across) / facing;
        const lmb_vec3d turned = vec3d_cross(to, u);
        const double at_v = vec3d_dot(direction, turned) / facing;
        if (at_u >= 0.0 && at_v >= 0.0 && at_u + at_v <= 1.0 && vec3d_dot(v, turned) / facing > 0.0) {
            crossings += facing > 0.0 ? 1 : -1;
        }
    }
    return crossings;
}

static bool point_is_within(const candidate *object, lmb_vec3 point)
{
    /* Rays along these meet no edge of what stands straight. */
    static const lmb_vec3d DIRECTIONS[3] = {{0.683, 0.571, 0.455}, {-0.433, 0.749, -0.502}, {0.291, -0.397, 0.870}};
    if (!(point.x > object->low.x && point.y > object->low.y && point.z > object->low.z && point.x < object->high.x &&
          point.y < object->high.y && point.z < object->high.z)) {
        return false;
    }
    int within = 0;
    for (int k = 0; k < 3; ++k) {
        within += crossings_along(object, vec3d_of(point), DIRECTIONS[k]) != 0;
    }
    return within >= 2;
}

/* Whether half of an instance or more is within the object. */
static bool instance_is_within(const candidate *object, uint32_t instance)
{
    const lmb_mesh *mesh = instance_mesh(object->scene, instance);
    const uint32_t samples = mesh->vertex_count < SAMPLE_VERTICES ? mesh->vertex_count : SAMPLE_VERTICES;
    uint32_t within = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        const uint32_t vertex = (uint32_t)((uint64_t)i * mesh->vertex_count / samples);
        within +=
            point_is_within(object, affine_point(&object->scene->instances[instance].to_world, mesh->position[vertex]));
    }
    return samples > 0 && 2 * within >= samples;
}

static bool any_point_is_within(const candidate *object, const lmb_vec3 *points, uint32_t count)
{
    bool any = false;
    for (uint32_t i = 0; i < count && !any; ++i) {
        any = point_is_within(object, points[i]);
    }
    return any;
}

/* Lights, marks and moving things within the object. */
static bool holds_marks(const candidate *object)
{
    const lmb_scene *scene = object->scene;
    if (any_point_is_within(object, scene->seed_points, scene->seed_point_count) ||
        any_point_is_within(object, scene->path_points, scene->path_point_count)) {
        return true;
    }
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        if (scene->lights[i].type != LMB_LIGHT_DIRECTIONAL && point_is_within(object, scene->lights[i].position)) {
            return true;
        }
    }
    for (uint32_t i = 0; i < object->work->dynamic_count; ++i) {
        if (instance_is_within(object, object->work->dynamic[i])) {
            return true;
        }
    }
    return false;
}

/* Adds an instance to those seen; false when there are too many, or it gives light. */
static bool seen_add(const candidate *object, const lmb_hit *hit, uint32_t seen[MOST_SEEN], uint32_t *count)
{
    const lmb_mesh *mesh = instance_mesh(object->scene, hit->instance);
    if (lmb_material_emits(&object->scene->materials[mesh->material[hit->triangle]])) {
        return false;
    }
    for (uint32_t i = 0; i < *count; ++i) {
        if (seen[i] == hit->instance) {
            return true;
        }
    }
    if (*count == MOST_SEEN) {
        return false;
    }
    seen[(*count)++] = hit->instance;
    return true;
}

static bool hit_is_own(const candidate *object, const lmb_hit *hit)
{
    return hit->instance == object->instance && object_has(object, hit->triangle);
}

/* Whether what a ray from inside has met is something in the object for sure, or is noted among `seen`. */
static bool hit_is_within(const candidate *object, const lmb_hit *hit, uint32_t seen[MOST_SEEN], uint32_t *count)
{
    if (hit->instance != object->instance) {
        return !seen_add(object, hit, seen, count);
    }
    lmb_vec3 corner[3];
    lmb_trace_corners(object->tracer, hit->instance, hit->triangle, corner);
    return point_is_within(object, corner[0]) && point_is_within(object, corner[1]) &&
           point_is_within(object, corner[2]);
}

/* Whether something is in the object: what merely reaches into it, as a floor does into what stands on it, is not. */
static bool holds_objects(const candidate *object)
{
    uint32_t seen[MOST_SEEN];
    uint32_t count = 0;
    for (uint32_t k = 0; k < object->work->points; ++k) {
        lmb_hit hit[RAYS_PER_POINT];
        surface_rays(object, k, 1.0f, hit);
        for (uint32_t i = 0; i < RAYS_PER_POINT; ++i) {
            if (hit[i].instance != LMB_HIT_NOTHING && !hit_is_own(object, &hit[i]) &&
                hit_is_within(object, &hit[i], seen, &count)) {
                return true;
            }
        }
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (instance_is_within(object, seen[i])) {
            return true;
        }
    }
    return false;
}

/* Whether the object's outer side is in free space, where others turn their fronts to it. Others that may be inside out
 * themselves have no say. */
static bool outside_is_free(const candidate *object)
{
    uint32_t fronts = 0, backs = 0, open = 0;
    for (uint32_t k = 0; k < object->work->points; ++k) {
        lmb_hit hit[RAYS_PER_POINT];
        surface_rays(object, k, -1.0f, hit);
        for (uint32_t i = 0; i < RAYS_PER_POINT; ++i) {
            const bool met = hit[i].instance != LMB_HIT_NOTHING;
            if (met && (hit_is_own(object, &hit[i]) ||
                        object->work->mesh_inward[object->scene->instances[hit[i].instance].mesh])) {
                continue;
            }
            open += !met;
            fronts += met && hit[i].front;
            backs += met && !hit[i].front;
        }
    }
    return fronts > backs && (float)fronts >= LEAST_FRONTS * (float)(fronts + backs + open);
}

static lmb_result instance_judge(const facing_work *work, uint32_t instance, const uint8_t *marks, uint8_t *facing)
{
    bool double_sided;
    if (!object_is_dark(work->scene, instance_mesh(work->scene, instance), marks, &double_sided)) {
        return LMB_OK;
    }
    candidate object;
    const lmb_result result = candidate_make(work, instance, marks, &object);
    if (result == LMB_OK && outside_is_free(&object) && !holds_marks(&object) && !holds_objects(&object)) {
        *facing = double_sided ? LMB_FACING_TURNED : LMB_FACING_WRONG;
    }
    free(object.area_before);
    return result;
}

static bool instance_is_inward(const facing_work *work, uint32_t instance)
{
    const lmb_instance *placed = &work->scene->instances[instance];
    return !placed->dynamic && work->mesh_inward[placed->mesh];
}

static lmb_result work_make(const lmb_tracer *tracer, facing_work *work)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    *work = (facing_work){.tracer = tracer, .scene = scene, .points = MOST_POINTS};
    work->mesh_inward = calloc((size_t)scene->mesh_count + 1, sizeof *work->mesh_inward);
    work->dynamic = malloc(((size_t)scene->instance_count + 1) * sizeof *work->dynamic);
    for (uint32_t i = 0; work->dynamic && i < scene->instance_count; ++i) {
        if (scene->instances[i].dynamic) {
            work->dynamic[work->dynamic_count++] = i;
        }
    }
    return work->mesh_inward && work->dynamic ? LMB_OK : LMB_ERROR_MEMORY;
}

static void work_free(facing_work *work)
{
    free(work->mesh_inward);
    free(work->dynamic);
}

/* Looks at all meshes. */
static lmb_result meshes_look_at(facing_work *work)
{
    const lmb_scene *scene = work->scene;
    for (uint32_t m = 0; m < scene->mesh_count; ++m) {
        bool inward = false;
        if (scene->meshes[m].triangle_count > 0 && lmb_mesh_is_inward(&scene->meshes[m], &inward) != LMB_OK) {
            return LMB_ERROR_MEMORY;
        }
        work->mesh_inward[m] = inward;
    }
    uint32_t inward_count = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        inward_count += instance_is_inward(work, i);
    }
    const uint32_t affordable = POINTS_OF_ALL / (inward_count + 1);
    work->points = affordable > MOST_POINTS ? MOST_POINTS : affordable < LEAST_POINTS ? LEAST_POINTS : affordable;
    return LMB_OK;
}

lmb_result lmb_inside_out_find(const lmb_tracer *tracer, uint8_t *facing)
{
    facing_work work;
    lmb_result result = work_make(tracer, &work);
    if (result == LMB_OK) {
        result = meshes_look_at(&work);
    }
    for (uint32_t i = 0; i < work.scene->instance_count && result == LMB_OK; ++i) {
        facing[i] = LMB_FACING_AS_WOUND;
        if (instance_is_inward(&work, i)) {
            result = instance_judge(&work, i, NULL, &facing[i]);
        }
    }
    work_free(&work);
    return result;
}

/* Judges the first instance of a mesh by its inward parts. */
static lmb_result mesh_parts_judge(const facing_work *work, uint32_t instance, uint8_t *facing)
{
    const lmb_mesh *mesh = instance_mesh(work->scene, instance);
    uint8_t *const marks = malloc(mesh->triangle_count);
    uint32_t others = 0;
    lmb_result result = marks ? lmb_mesh_mark_inward(mesh, marks, &others) : LMB_ERROR_MEMORY;
    if (result == LMB_OK && others > 0 && memchr(marks, 1, mesh->triangle_count)) {
        result = instance_judge(work, instance, marks, facing);
    }
    free(marks);
    return result;
}

lmb_result lmb_inside_out_parts_find(const lmb_tracer *tracer, uint8_t *facing)
{
    facing_work work;
    lmb_result result = work_make(tracer, &work);
    uint8_t *const looked_at = calloc((size_t)work.scene->mesh_count + 1, sizeof *looked_at);
    result = looked_at ? result : LMB_ERROR_MEMORY;
    for (uint32_t i = 0; i < work.scene->instance_count && result == LMB_OK; ++i) {
        const lmb_instance *placed = &work.scene->instances[i];
        const uint32_t triangles = work.scene->meshes[placed->mesh].triangle_count;
        facing[i] = LMB_FACING_AS_WOUND;
        if (!placed->dynamic && triangles > 0 && triangles <= MOST_TRIANGLES && !looked_at[placed->mesh]) {
            looked_at[placed->mesh] = 1;
            result = mesh_parts_judge(&work, i, &facing[i]);
        }
    }
    free(looked_at);
    work_free(&work);
    return result;
}
