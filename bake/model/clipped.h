/* Light behind a surface's hemisphere or a cone, as the rows make it of SH3 radiance; units and signs as in
 * lambent/sh.h. */
#ifndef LMB_MODEL_CLIPPED_H
#define LMB_MODEL_CLIPPED_H

#include <lambent/hhd.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

/* Of the basis: 1/(2 sqrt(pi)), sqrt(3/(4 pi)), sqrt(15/(4 pi)), sqrt(5/(16 pi)), sqrt(15/(16 pi)). */
#define LMB_N0 0.28209479f
#define LMB_N1 0.48860251f
#define LMB_N2 1.09254843f
#define LMB_N20 0.31539157f
#define LMB_N22 0.54627422f

/* Unit normal; +Y of one without a direction, as the sampler has it. */
static inline lmb_vec3 lmb_unit_normal(lmb_vec3 normal)
{
    return lmb_vec3_unit_or(normal, lmb_vec3_of(0.0f, 1.0f, 0.0f));
}

/* Two tangents and the unit normal: the axes of what is said to be local. */
void lmb_normal_axes(lmb_vec3 normal, lmb_vec3 axes[3]);

/* SH2 of the radiance inside a cone, by the quadratic to linear multiply: four numbers of each colour. */
void lmb_clipped_sh2(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos, float sh2[3 * LMB_SH2_COUNT]);

/* b_c and b of each colour of it. */
void lmb_clipped_moments(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos, lmb_moments moments[3]);

/* Of Rec. 709 luminance. */
lmb_moments lmb_moments_luminance(const lmb_moments moments[3]);

/* Band 1 as a vector: L1(n) = sqrt(3/(4 pi)) v.n. */
static inline lmb_vec3 lmb_linear_band(const float *c)
{
    return lmb_vec3_of(-c[3], -c[1], c[2]);
}

/* SH3 of the radiance inside a cone about local z, of SH3 radiance in the same axes: the whole of G(c). */
lmb_sh3 lmb_clipped_sh3(const lmb_sh3 *local, float cone_cos);

/* The same in the world, about any axis. */
lmb_sh3_rgb lmb_clipped_sh3_rgb(const lmb_sh3_rgb *radiance, lmb_vec3 axis, float cone_cos);

/* Of SH3 of what the hemisphere lets through, those whose radiance they are, by least squares over it. */
lmb_sh3_rgb lmb_unclipped_sh3_rgb(const lmb_sh3_rgb *clipped, lmb_vec3 normal);

/* SH3 of the normalised irradiance of it, in the axes of `axis`. */
void lmb_clipped_irradiance(const lmb_sh3_rgb *radiance, const lmb_vec3 axes[3], float cone_cos, lmb_sh3 irradiance[3]);

#endif
