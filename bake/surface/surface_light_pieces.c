/* Which piece of a side a hit sees. */
#include "surface/surface_light_internal.h"

#include <math.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

#include "trace/trace_internal.h"

bool lmb_surface_light_piece_find(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit,
                                  bool front, uint64_t *rays, uint32_t *patch)
{
    const uint32_t first = light->first_piece[*patch];
    if (first >= LMB_SIDE_HOLE) {
        return first == LMB_SIDE_WHOLE;
    }
    const lmb_place place = lmb_trace_place(tracer, hit);
    const lmb_vec3 from =
        lmb_vec3_mad(place.position, place.geometric_normal, front ? place.rounding : -place.rounding);
    lmb_vec3 towards[LMB_CELL_MOST_PIECES];
    float distance[LMB_CELL_MOST_PIECES];
    int count = 0;
    do {
        towards[count] = lmb_vec3_sub(light->piece[first + (uint32_t)count].point, from);
        distance[count] = lmb_vec3_dot(towards[count], towards[count]);
    } while (!light->piece[first + (uint32_t)count++].last);
    /* The nearest that is seen: through a slit, others are too. */
    for (int tries = 0; tries < count; ++tries) {
        int nearest = 0;
        for (int i = 1; i < count; ++i) {
            nearest = distance[i] < distance[nearest] ? i : nearest;
        }
        const lmb_rgb share = lmb_trace_transmittance_along(tracer, from, towards[nearest], LMB_TRACE_UP_TO_END, rays);
        if (lmb_rgb_max(share) > LMB_PIECE_OPEN_SHARE) {
            *patch = 2 * light->cell_count + first + (uint32_t)nearest;
            return true;
        }
        distance[nearest] = INFINITY;
    }
    return false;
}
