/* Objects of a level as lambent_local_sets measures them: which they are, points on them, and where else they could be.
 * Points and poses are pure functions of a stream. */
#ifndef LMB_TOOLS_LOCAL_SETS_OBJECTS_H
#define LMB_TOOLS_LOCAL_SETS_OBJECTS_H

#include <lambent/bake_level.h>
#include <lambent/gather.h>
#include <lambent/local_set.h>
#include <lambent/opaque_surface.h>

/* Where an object is that has moved: turned about a place of it, the scene's, which then moved. */
typedef struct object_pose {
    lmb_vec3 from, to;
    lmb_vec3 turn[3]; /* as lmb_local_frame_moved has it */
} object_pose;

/* A point on an object. */
typedef struct object_point {
    lmb_gather_point at;
    bool hidden; /* in a solid, or where something else touches the object: nobody sees it */
} object_point;

/* Gives instances whose names match one of the patterns (as of a shell) local sets, beside those that have one. Lists
 * all that have one and a frame of it, at most `most`. @return how many */
uint32_t objects_find(lmb_scene *scene, const char *const *pattern, uint32_t pattern_count, uint32_t most,
                      uint32_t *instance, lmb_local_frame *frame);

/* Builds the level's tracer and emitters anew, after instances have changed; the estimator is the reference again.
 * @return LMB_ERROR_MEMORY, _UNSUPPORTED; the level is then good for closing only */
lmb_result level_retrace(lmb_level *level, lmb_error *error);

/* A place nearby where the object's frame has room, without the object in the tracer's level: within a few of its
 * longest sides across, a twentieth of that higher, and turned about +Y. @return false: none of many tries had */
bool object_pose_find(const lmb_tracer *tracer, const lmb_local_frame *frame, uint64_t stream, object_pose *pose);

void object_pose_apply(const object_pose *pose, lmb_instance *instance);
lmb_local_frame object_pose_frame(const object_pose *pose, const lmb_scene *scene, const lmb_local_frame *frame);

/* Point `index` of `count` on an object's surface, by area; `radius`, as of a texel, is what it is pushed out of
 * geometry by, `reach` how near something else is that hides it, metres. */
void object_point_make(const lmb_opaque_surface *surface, uint64_t stream, uint32_t index, uint32_t count, float radius,
                       float reach, object_point *point);

#endif
