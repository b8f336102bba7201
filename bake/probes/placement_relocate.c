/* Moving probes off the surfaces that they happen to lie on. */
#include "probes/placement_internal.h"

#include <float.h>
#include <math.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

/* A probe keeps this far from surfaces, in spacings. Walls stand on multiples of round figures, and so do lattices. */
#define CLEARANCE_SPACINGS 0.05f

/* How far the point has to move along the surface's front normal to be `clearance` in front of it; 0 for surfaces that
 * are far enough, or that the point is behind of. */
static float shortfall(const lmb_tracer *tracer, const lmb_hit *hit, lmb_vec3 position, float clearance,
                       lmb_vec3 *normal)
{
    const lmb_place place = lmb_trace_place(tracer, hit);
    *normal = place.geometric_normal;
    const float before = lmb_vec3_dot(lmb_vec3_sub(position, place.position), place.geometric_normal);
    const float rounding = 4.0f * lmb_larger(place.rounding, lmb_trace_epsilon(position));
    return before >= -rounding && before < clearance ? clearance - before : 0.0f;
}

/* One move away from the surface that is most too near, looked for along the 6 axes and the 8 diagonals by rays that
 * run through the point. Returns whether there was one. */
static bool move_once(const lmb_tracer *tracer, float clearance, lmb_vec3 *position, uint64_t *rays)
{
    float most = 0.0f;
    lmb_vec3 away = {0.0f, 0.0f, 0.0f};
    for (int i = 0; i < 27; ++i) {
        const lmb_vec3 step = lmb_vec3_of((float)(i % 3 - 1), (float)(i / 3 % 3 - 1), (float)(i / 9 - 1));
        const float length_squared = lmb_vec3_dot(step, step);
        if (!(length_squared == 1.0f || length_squared == 3.0f)) {
            continue;
        }
        const lmb_vec3 direction = lmb_vec3_scale(step, 1.0f / sqrtf(length_squared));
        const lmb_vec3 origin = lmb_vec3_mad(*position, direction, -clearance);
        lmb_hit hit;
        ++*rays;
        if (!lmb_trace_nearest(tracer, origin, direction, 0.0f, 2.0f * clearance, &hit)) {
            continue;
        }
        lmb_vec3 normal;
        const float missing = shortfall(tracer, &hit, *position, clearance, &normal);
        if (missing > most) {
            most = missing;
            away = normal;
        }
    }
    *position = lmb_vec3_mad(*position, away, most);
    return most > 0.0f;
}

lmb_vec3 lmb_placement_relocate(const lmb_tracer *tracer, lmb_vec3 position, float spacing, uint64_t *rays)
{
    /* A corner has three walls. */
    for (int i = 0; i < 3 && move_once(tracer, CLEARANCE_SPACINGS * spacing, &position, rays); ++i) {
    }
    return position;
}
