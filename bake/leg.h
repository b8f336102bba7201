/* A straight piece of a path: from where light is collected to what it comes from. */
#ifndef LMB_LEG_H
#define LMB_LEG_H

#include <float.h>

#include "direct.h"

/* A ray that leaves a receiver, or a camera (from == NULL). */
typedef struct lmb_leg {
    const lmb_receiver *from;
    lmb_vec3 origin;
    lmb_vec3 direction;
    lmb_rgb throughput;
} lmb_leg;

/* What a leg ends on. */
typedef struct lmb_landing {
    bool on_surface; /* false: the environment; then only `emitted` is set */
    lmb_hit hit;
    lmb_rgb albedo;
    lmb_rgb emitted; /* radiance of the surface or the environment, weighted against next-event estimation */
} lmb_landing;

/* Finds what a leg ends on, through see-through surfaces, each of which it passes by chance. Its throughput takes up
 * the tint of what it passed; no channel of it grows. False: on nothing. */
static inline bool lmb_leg_trace(const lmb_path *path, lmb_leg *leg, lmb_hit *hit)
{
    const lmb_tracer *tracer = path->transport->tracer;
    if (!lmb_tracer_has_layers(tracer)) {
        ++*path->rays;
        return lmb_trace_nearest(tracer, leg->origin, leg->direction, 0.0f, FLT_MAX, hit);
    }
    const uint64_t chance = lmb_layer_chance(path->stream, path->sample, (int32_t)path->vertex);
    return lmb_trace_through(tracer, leg->origin, leg->direction, chance, hit, &leg->throughput, path->rays);
}

/* What a leg finds there: at `hit`, or NULL for nothing. Its throughput takes up the share of the surface that it met.
 */
lmb_landing lmb_leg_land(const lmb_path *path, lmb_leg *leg, const lmb_hit *hit);

/* Both. */
lmb_landing lmb_leg_follow(const lmb_path *path, lmb_leg *leg);

/* Radiance of the environment, as seen along a ray that leaves `from` (NULL: a camera), weighted against next-event
 * estimation. */
lmb_rgb lmb_leg_sky(const lmb_receiver *from, lmb_vec3 direction, const lmb_environment_seen *seen);

/* Where a path goes on from a landing on a surface. */
lmb_receiver lmb_landing_receiver(const lmb_path *path, const lmb_landing *landing);

/* Radiance along a leg from its landing on: what it ends on emits, and what that reflects. `path` is at its first
 * vertex. */
lmb_rgb lmb_path_radiance(lmb_path *path, lmb_leg leg, lmb_landing landing);

#endif
