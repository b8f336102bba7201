#include <lambent/probe_locals.h>

#include <float.h>
#include <math.h>

#include <lambent/lattice.h>
#include <lambent/placement.h>
#include <lambent/vector.h>

#include "base/affine.h"
#include "base/vec3d.h"
#include "probes/placement_internal.h"

/* Probes along the longest side, where nothing else is told. */
enum { LONGEST_SIDE_PROBES = 6 };

/* Shares of the longest side: sides shorter than the first have one probe; the second is what steps count at least, so
 * that they keep a direction. Of the spacing of probes in the level likewise. */
#define FLAT_SHARE 1e-3
#define LEAST_SHARE 0.01

typedef struct oriented_box {
    lmb_vec3d axis[3]; /* unit, at right angles */
    double low[3], high[3];
} oriented_box;

/* The instance's own axes, or the world's where they are no use. */
static void axes_find(const lmb_affine *to_world, lmb_vec3d axis[3])
{
    static const int pairs[3][2] = {{0, 1}, {2, 0}, {1, 2}}; /* that are turned into x and y, z and x, y and z */
    lmb_vec3d column[3];
    for (int i = 0; i < 3; ++i) {
        column[i] = (lmb_vec3d){to_world->m[0][i], to_world->m[1][i], to_world->m[2][i]};
    }
    lmb_lattice turned = {.spacing = 1.0f};
    for (int i = 0; i < 3; ++i) {
        const int x = pairs[i][0], y = pairs[i][1];
        if (lmb_lattice_turn(&turned, column[x], column[y])) {
            axis[x] = turned.axis[0];
            axis[y] = turned.axis[1];
            axis[3 - x - y] = turned.axis[2];
            return;
        }
    }
    axis[0] = (lmb_vec3d){1.0, 0.0, 0.0};
    axis[1] = (lmb_vec3d){0.0, 1.0, 0.0};
    axis[2] = (lmb_vec3d){0.0, 0.0, 1.0};
}

/* Around the corners of its triangles. @return false: there are none */
static bool box_find(const lmb_scene *scene, const lmb_instance *instance, oriented_box *box)
{
    const lmb_mesh *const mesh = &scene->meshes[instance->mesh];
    axes_find(&instance->to_world, box->axis);
    for (int axis = 0; axis < 3; ++axis) {
        box->low[axis] = (double)INFINITY;
        box->high[axis] = -(double)INFINITY;
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; ++i) {
        const lmb_vec3 own = mesh->position[mesh->triangle[i / 3][i % 3]];
        const lmb_vec3d at = vec3d_of(affine_point(&instance->to_world, own));
        for (int axis = 0; axis < 3; ++axis) {
            const double along = vec3d_dot(at, box->axis[axis]);
            box->low[axis] = fmin(box->low[axis], along);
            box->high[axis] = fmax(box->high[axis], along);
        }
    }
    return mesh->triangle_count > 0;
}

static uint32_t side_probes(double side, double longest)
{
    if (side < FLAT_SHARE * longest || longest == 0.0) {
        return 1;
    }
    const double cells = floor((LONGEST_SIDE_PROBES - 1) * side / longest + 0.5);
    return cells > 1.0 ? (uint32_t)cells + 1 : 2;
}

bool lmb_probe_local_frame(const lmb_scene *scene, uint32_t instance, lmb_local_frame *frame)
{
    const lmb_instance *const of = &scene->instances[instance];
    oriented_box box;
    if (!box_find(scene, of, &box)) {
        return false;
    }
    double longest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        longest = fmax(longest, box.high[axis] - box.low[axis]);
    }
    const double least = LEAST_SHARE * fmax(longest, (double)lmb_placement_default_spacing(scene));
    lmb_vec3d centre = scene->origin;
    lmb_vec3 half[3];
    uint32_t size[3];
    for (int axis = 0; axis < 3; ++axis) {
        const lmb_vec3d *const a = &box.axis[axis];
        const double side = box.high[axis] - box.low[axis], middle = 0.5 * (box.high[axis] + box.low[axis]);
        size[axis] = of->local_size[axis] > 0 ? of->local_size[axis] : side_probes(side, longest);
        centre.x += middle * a->x;
        centre.y += middle * a->y;
        centre.z += middle * a->z;
        const double extent = 0.5 * fmax(side, least);
        half[axis] = lmb_vec3_of((float)(extent * a->x), (float)(extent * a->y), (float)(extent * a->z));
    }
    *frame = lmb_local_frame_of_box(centre, half, size);
    return true;
}

float lmb_probe_local_footprint(const lmb_local_frame *frame)
{
    float shortest = FLT_MAX, longest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const float step = lmb_vec3_length(frame->step[axis]);
        shortest = frame->size[axis] > 1 ? lmb_smaller(shortest, step) : shortest;
        longest = lmb_larger(longest, step);
    }
    return shortest < FLT_MAX ? shortest : longest;
}

lmb_vec3 lmb_probe_local_site(const lmb_tracer *tracer, const lmb_local_frame *frame, uint32_t probe, uint64_t *rays)
{
    const lmb_vec3 at = lmb_scene_from_world(lmb_tracer_scene(tracer), lmb_local_frame_position(frame, probe));
    return lmb_placement_relocate(tracer, at, lmb_probe_local_footprint(frame), rays);
}

lmb_result lmb_probe_locals_place(const lmb_tracer *tracer, lmb_probes *probes, uint64_t *rays)
{
    const lmb_scene *const scene = lmb_tracer_scene(tracer);
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < scene->instance_count && result == LMB_OK; ++i) {
        const lmb_instance *const instance = &scene->instances[i];
        lmb_local_frame frame;
        if (!instance->has_local_set || !lmb_probe_local_frame(scene, i, &frame) || !lmb_local_frame_is_valid(&frame)) {
            continue;
        }
        result = lmb_probes_add_local(probes, instance->name, instance->node, instance->place, &frame);
        for (uint32_t k = 0; result == LMB_OK && k < lmb_local_frame_count(&frame); ++k) {
            bool is_free;
            const lmb_vec3 site = lmb_probe_local_site(tracer, &frame, k, rays);
            probes->local[probes->local_count - 1].validity[k] = lmb_placement_validity(tracer, site, &is_free, rays);
        }
    }
    return result;
}
