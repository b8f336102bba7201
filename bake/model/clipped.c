#include "model/clipped.h"

#include <lambent/occlusion.h>

void lmb_clipped_moments(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos, lmb_moments moments[3])
{
    const lmb_vec3 n = lmb_unit_normal(axis);
    for (int c = 0; c < 3; ++c) {
        const lmb_sh2 clipped = lmb_sh3_multiply_cone(&radiance->channel[c], n, cone_cos);
        moments[c] = lmb_moments_from_sh2(&clipped);
    }
}

lmb_moments lmb_moments_luminance(const lmb_moments moments[3])
{
    const lmb_moments *r = &moments[0], *g = &moments[1], *b = &moments[2];
    return (lmb_moments){lmb_luminance(lmb_rgb_of(r->scalar, g->scalar, b->scalar)),
                         {lmb_luminance(lmb_rgb_of(r->vector.x, g->vector.x, b->vector.x)),
                          lmb_luminance(lmb_rgb_of(r->vector.y, g->vector.y, b->vector.y)),
                          lmb_luminance(lmb_rgb_of(r->vector.z, g->vector.z, b->vector.z))}};
}
