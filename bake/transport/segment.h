/* A straight piece of a path: from where light is collected to what it comes from. */
#ifndef LMB_SEGMENT_H
#define LMB_SEGMENT_H

#include <float.h>

#include "transport/direct.h"

/* A ray that leaves a receiver, or a camera (from == NULL). */
typedef struct lmb_segment {
    const lmb_receiver *from;
    lmb_vec3 origin;
    lmb_vec3 direction;
    lmb_rgb throughput;
} lmb_segment;

/* What a segment ends on. */
typedef struct lmb_path_vertex {
    bool on_surface; /* false: the environment; then only `emitted` is set */
    lmb_hit hit;
    lmb_rgb albedo;
    lmb_rgb emitted; /* radiance of the surface or the environment, weighted against next-event estimation */
} lmb_path_vertex;

/* Finds what a segment ends on, through see-through surfaces, each of which it passes by chance. Its throughput takes
 * up the tint of what it passed; no channel of it grows. False: on nothing. */
static inline bool lmb_segment_trace(const lmb_path *path, lmb_segment *segment, lmb_hit *hit)
{
    const lmb_tracer *tracer = path->transport->tracer;
    if (!lmb_tracer_has_layers(tracer)) {
        ++*path->rays;
        return lmb_trace_nearest(tracer, segment->origin, segment->direction, 0.0f, FLT_MAX, hit);
    }
    const uint64_t chance = lmb_layer_chance(path->stream, path->sample, (int32_t)path->vertex);
    return lmb_trace_through(tracer, &(lmb_ray){segment->origin, segment->direction}, chance, hit, &segment->throughput,
                             path->rays);
}

/* What a segment finds there: at `hit`, or NULL for nothing. Its throughput takes up the share of the surface that it
 * met.
 */
lmb_path_vertex lmb_segment_vertex(const lmb_path *path, lmb_segment *segment, const lmb_hit *hit);

/* Both. */
lmb_path_vertex lmb_segment_follow(const lmb_path *path, lmb_segment *segment);

/* Radiance of the environment, as seen along a ray that leaves `from`, weighted against next-event estimation. */
lmb_rgb lmb_segment_sky(const lmb_receiver *from, lmb_vec3 direction, const lmb_environment_seen *seen);

/* Where a path goes on from a vertex on a surface. */
lmb_receiver lmb_vertex_receiver(const lmb_path *path, const lmb_path_vertex *vertex);

#endif
