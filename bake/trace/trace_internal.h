/* What surface.c, placement and ray_record_replay.c need of the tracer's inside. */
#ifndef LMB_TRACE_INTERNAL_H
#define LMB_TRACE_INTERNAL_H

#include <math.h>

#include <float.h>

#include <lambent/trace.h>
#include <lambent/vector.h>

/* How an instance's winding tells its front. */
typedef enum lmb_facing {
    LMB_FACING_AS_WOUND,
    LMB_FACING_TURNED, /* inside out and double-sided: what the winding calls its back is its front */
    LMB_FACING_WRONG   /* inside out, but not double-sided: nothing helps but turning its winding */
} lmb_facing;

lmb_facing lmb_tracer_facing(const lmb_tracer *tracer, uint32_t instance);

/* Far distance of a shadow ray whose direction runs from one point to another. Both lie just off their surfaces
 * already; it stops a hair short of the far one. */
#define LMB_TRACE_UP_TO_END (1.0f - 4.0f * FLT_EPSILON)

/* lmb_trace_epsilon, inline for what every sample does. */
static inline float trace_epsilon(lmb_vec3 position)
{
    /* Interpolated corners are off by a few ulps of the largest coordinate. Of 120 000 points on random triangles one
     * meets its own triangle from 2 ulps off it, none from 4. */
    const float size = lmb_larger(fabsf(position.x), lmb_larger(fabsf(position.y), fabsf(position.z)));
    return lmb_larger(size * 8.0f * FLT_EPSILON, 1e-12f);
}

/* lmb_trace_offset, likewise. */
static inline lmb_vec3 trace_offset(lmb_vec3 position, lmb_vec3 geometric_normal, float rounding, lmb_vec3 direction)
{
    const bool along = lmb_vec3_dot(geometric_normal, direction) >= 0.0f;
    return lmb_vec3_mad(position, geometric_normal, along ? rounding : -rounding);
}

static inline void lmb_ray_batch_add(lmb_ray_batch *rays, lmb_vec3 origin, lmb_vec3 direction, float far_distance)
{
    const uint32_t i = rays->count++;
    rays->origin[0][i] = origin.x;
    rays->origin[1][i] = origin.y;
    rays->origin[2][i] = origin.z;
    rays->direction[0][i] = direction.x;
    rays->direction[1][i] = direction.y;
    rays->direction[2][i] = direction.z;
    rays->far_distance[i] = far_distance;
}

/* Embree's scene: an RTCScene. */
struct RTCSceneTy *lmb_tracer_world(const lmb_tracer *tracer);

/* World-space vertices of an instance that was flattened into the world, or NULL. */
const lmb_vec3 *lmb_tracer_world_vertices(const lmb_tracer *tracer, uint32_t instance);

/* Whether a triangle's material lets light straight through, wholly or in part: MASK, BLEND or transmission. */
bool lmb_tracer_is_see_through(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle);

/* Signed crossings of all surfaces that are not see-through along a ray to infinity: +1 for leaving by a back face, -1
 * for entering by a front. Coincident faces all count. */
int lmb_trace_crossings(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction);

#endif
