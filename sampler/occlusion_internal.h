/* The multiply by a cone, of what is known about its axis. */
#ifndef LMB_OCCLUSION_INTERNAL_H
#define LMB_OCCLUSION_INTERNAL_H

#include "sh_internal.h"

/* Gram matrix of the cone z > c, G_ij = integral of Y_i Y_j: its rows for the linear basis, blocks apart. */
typedef struct lmb_linear_gram {
    float g00_00, g00_10, g00_20, g10_10, g10_20; /* zonal */
    float gx_x, gx_xz;                            /* tangential, the same for y */
} lmb_linear_gram;

static inline lmb_linear_gram lmb_linear_gram_of_cone(float c)
{
    const float cc = c * c;
    const float closing = 1.0f - c;
    const float sine_squared = closing * (1.0f + c);
    lmb_linear_gram g;
    g.g00_00 = 0.5f * closing;
    g.g00_10 = (float)(LMB_SQRT_3 / 4.0) * sine_squared;
    g.g00_20 = (float)(LMB_SQRT_5 / 4.0) * c * sine_squared;
    g.g10_10 = 0.5f * closing * (1.0f + c + cc);
    g.g10_20 = (float)(LMB_SQRT_15 / 16.0) * sine_squared * (1.0f + 3.0f * cc);
    g.gx_x = 0.25f * closing * closing * (2.0f + c);
    g.gx_xz = (float)(3.0 * LMB_SQRT_5 / 16.0) * sine_squared * sine_squared;
    return g;
}

/* The first four coefficients of what lies in the cone of cosine c in [0, 1]. */
static inline lmb_sh2 lmb_sh3_axial_clipped(const lmb_sh3_axial *l, lmb_vec3 axis, float c)
{
    const lmb_linear_gram g = lmb_linear_gram_of_cone(c);
    const float zonal0 = g.g00_00 * l->l0 + g.g00_10 * l->l1_zonal + g.g00_20 * l->l2_zonal;
    const float zonal1 = g.g00_10 * l->l0 + g.g10_10 * l->l1_zonal + g.g10_20 * l->l2_zonal;
    lmb_vec3 v = lmb_vec3_scale(axis, zonal1);
    v = lmb_vec3_mad(v, l->l1_tangential, g.gx_x);
    v = lmb_vec3_mad(v, l->l2_tangential, g.gx_xz);
    return (lmb_sh2){{zonal0, -v.y, v.z, -v.x}};
}

#endif
