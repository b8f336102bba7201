/* Light behind a surface's hemisphere or a cone, as the rows make it of SH3 radiance. */
#ifndef LMB_MODEL_CLIPPED_H
#define LMB_MODEL_CLIPPED_H

#include <lambent/hhd.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

/* Unit normal; +Y of one without a direction, as the sampler has it. */
static inline lmb_vec3 lmb_unit_normal(lmb_vec3 normal)
{
    return lmb_vec3_unit_or(normal, lmb_vec3_of(0.0f, 1.0f, 0.0f));
}

/* b_c and b of each colour, by the quadratic to linear multiply. */
void lmb_clipped_moments(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos, lmb_moments moments[3]);

/* Of Rec. 709 luminance. */
lmb_moments lmb_moments_luminance(const lmb_moments moments[3]);

#endif
