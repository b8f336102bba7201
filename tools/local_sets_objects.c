#include "local_sets_objects.h"

#include <float.h>
#include <fnmatch.h>
#include <math.h>

#include <lambent/lightmap.h>
#include <lambent/placement.h>
#include <lambent/probe_locals.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "check_points.h"

enum { POSE_TRIES = 400, HIDDEN_RAYS = 64 };

/* How far an object moves, and what it is lifted by, in its longest sides. */
#define REACH_SIDES 3.0f
#define LIFT_SIDES 0.05f

/* A point is hidden when more than this share of the sky over it shows back faces, or less than this is open. */
#define BACK_SHARE 0.9f
#define OPEN_SHARE 0.02f

uint32_t objects_find(lmb_scene *scene, const char *const *pattern, uint32_t pattern_count, uint32_t most,
                      uint32_t *instance, lmb_local_frame *frame)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < scene->instance_count && found < most; ++i) {
        lmb_instance *const candidate = &scene->instances[i];
        for (uint32_t p = 0; p < pattern_count; ++p) {
            candidate->has_local_set = candidate->has_local_set || fnmatch(pattern[p], candidate->name, 0) == 0;
        }
        if (candidate->has_local_set && lmb_probe_local_frame(scene, i, &frame[found]) &&
            lmb_local_frame_is_valid(&frame[found])) {
            instance[found++] = i;
        }
    }
    return found;
}

lmb_result level_retrace(lmb_level *level, lmb_error *error)
{
    lmb_surface_light_destroy(level->surface);
    lmb_emitters_destroy(level->emitters);
    lmb_tracer_destroy(level->tracer);
    level->surface = NULL;
    level->emitters = NULL;
    level->tracer = NULL;
    lmb_result result =
        lmb_tracer_create(level->scene, level->settings.isa, level->settings.threads, &level->tracer, error);
    if (result == LMB_OK) {
        result = lmb_emitters_create(level->tracer, &level->emitters);
    }
    level->transport.tracer = level->tracer;
    level->transport.emitters = level->emitters;
    level->transport.surface = NULL;
    return result;
}

/* ------------------------------------------------------------------------------------------------- poses */

static float longest_side(const lmb_local_frame *frame)
{
    float longest = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        longest = fmaxf(longest, (float)(frame->size[axis] - 1) * lmb_vec3_length(frame->step[axis]));
    }
    return longest;
}

static lmb_vec3 frame_middle(const lmb_scene *scene, const lmb_local_frame *frame)
{
    lmb_vec3 middle = lmb_scene_from_world(scene, frame->origin);
    for (int axis = 0; axis < 3; ++axis) {
        middle = lmb_vec3_mad(middle, frame->step[axis], 0.5f * (float)(frame->size[axis] - 1));
    }
    return middle;
}

/* Whether all probes of a frame are free and see its middle. */
static bool has_room(const lmb_tracer *tracer, const lmb_local_frame *frame)
{
    const lmb_scene *const scene = lmb_tracer_scene(tracer);
    const lmb_vec3 middle = frame_middle(scene, frame);
    uint64_t rays = 0;
    for (uint32_t i = 0; i < lmb_local_frame_count(frame); ++i) {
        const lmb_vec3 at = lmb_scene_from_world(scene, lmb_local_frame_position(frame, i));
        if (lmb_luminance(lmb_trace_transmittance(tracer, at, middle, &rays)) < 1.0f ||
            !lmb_placement_is_free(tracer, at, &rays)) {
            return false;
        }
    }
    return true;
}

bool object_pose_find(const lmb_tracer *tracer, const lmb_local_frame *frame, uint64_t stream, object_pose *pose)
{
    const lmb_scene *const scene = lmb_tracer_scene(tracer);
    const float side = longest_side(frame);
    for (uint32_t attempt = 0; attempt < POSE_TRIES; ++attempt) {
        float across[2], turn[2];
        lmb_sequence_2d(stream, attempt, 0, across);
        lmb_sequence_2d(stream, attempt, 1, turn);
        const float angle = 2.0f * LMB_PI_F * turn[0];
        *pose = (object_pose){.from = frame_middle(scene, frame),
                              .turn = {{cosf(angle), 0.0f, -sinf(angle)}, {0, 1, 0}, {sinf(angle), 0.0f, cosf(angle)}}};
        pose->to =
            lmb_vec3_of(pose->from.x + REACH_SIDES * side * (2.0f * across[0] - 1.0f), pose->from.y + LIFT_SIDES * side,
                        pose->from.z + REACH_SIDES * side * (2.0f * across[1] - 1.0f));
        const lmb_local_frame moved = object_pose_frame(pose, scene, frame);
        if (has_room(tracer, &moved)) {
            return true;
        }
    }
    return false;
}

lmb_local_frame object_pose_frame(const object_pose *pose, const lmb_scene *scene, const lmb_local_frame *frame)
{
    return lmb_local_frame_moved(frame, lmb_scene_to_world(scene, pose->from), lmb_scene_to_world(scene, pose->to),
                                 pose->turn);
}

/* Columns of a transform, turned. */
static void columns_turn(const lmb_vec3 turn[3], lmb_affine *t)
{
    for (int column = 0; column < 4; ++column) {
        const double x = t->m[0][column], y = t->m[1][column], z = t->m[2][column];
        t->m[0][column] = (double)turn[0].x * x + (double)turn[1].x * y + (double)turn[2].x * z;
        t->m[1][column] = (double)turn[0].y * x + (double)turn[1].y * y + (double)turn[2].y * z;
        t->m[2][column] = (double)turn[0].z * x + (double)turn[1].z * y + (double)turn[2].z * z;
    }
}

void object_pose_apply(const object_pose *pose, lmb_instance *instance)
{
    const double from[3] = {(double)pose->from.x, (double)pose->from.y, (double)pose->from.z};
    const double to[3] = {(double)pose->to.x, (double)pose->to.y, (double)pose->to.z};
    for (int axis = 0; axis < 3; ++axis) {
        instance->to_world.m[axis][3] -= from[axis];
    }
    columns_turn(pose->turn, &instance->to_world);
    columns_turn(pose->turn, &instance->normal_to_world);
    for (int axis = 0; axis < 3; ++axis) {
        instance->to_world.m[axis][3] += to[axis];
    }
}

/* ------------------------------------------------------------------------------------------------ points */

/* The share of directions about a normal in which back faces come first. */
static float back_share(const lmb_tracer *tracer, const lmb_gather_point *at, uint64_t stream)
{
    lmb_vec3 direction[HIDDEN_RAYS];
    shading_normals(at->normal, stream, HIDDEN_RAYS, direction);
    int backs = 0;
    for (int i = 0; i < HIDDEN_RAYS; ++i) {
        lmb_hit hit;
        backs += lmb_trace_nearest(tracer, at->position, direction[i], 0.0f, FLT_MAX, &hit) && !hit.front;
    }
    return (float)backs / HIDDEN_RAYS;
}

void object_point_make(const lmb_opaque_surface *surface, uint64_t stream, uint32_t index, uint32_t count, float radius,
                       float reach, object_point *point)
{
    const lmb_tracer *const tracer = surface->tracer;
    const uint64_t own = lmb_mix(stream, index);
    const lmb_hit hit = lmb_opaque_surface_point(surface, stream, index, count);
    const lmb_place place = lmb_trace_place(tracer, &hit);
    bool pushed_out;
    point->at = lmb_surface_gather_point(tracer, &place, radius, &pushed_out);
    point->hidden =
        back_share(tracer, &point->at, own) > BACK_SHARE ||
        ambient_visibility(tracer, point->at.position, point->at.normal, reach, own, HIDDEN_RAYS) < OPEN_SHARE;
}
