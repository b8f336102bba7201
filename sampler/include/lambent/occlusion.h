/* Occlusion of SH radiance by a surface's own hemisphere or by an ambient-occlusion cone.
 *
 * A cone has a unit axis and the cosine c of its half angle: c = 0 is the hemisphere, c -> 1 closes. The multiply
 * clips radiance to the cone: coefficients of L(w) [w.axis > c]. Done in the cone's frame with the Gram matrix
 * G(c)_ij = integral over z > c of Y_i Y_j, but expressed in world space, so that no SH is ever rotated (Roughton,
 * Sloan, Silvennoinen and Shirley, SIGGRAPH 2024). Basis, signs and units: lambent/sh.h.
 *
 * All functions are pure, allocate nothing, and may be called from any thread. */
#ifndef LAMBENT_OCCLUSION_H
#define LAMBENT_OCCLUSION_H

#include <lambent/api.h>
#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Cone cosine of a COSINE-WEIGHTED visibility, which ambient-occlusion bakes and screen-space AO give: V = sin^2(a),
 * so c = sqrt(1 - V). `visibility` is clamped to [0, 1]; NaN counts as 1 (open). */
LMB_API float lmb_cone_cos_from_visibility(float visibility);

/* Cone cosine of a UNIFORM (solid-angle) visibility of the hemisphere: V = 1 - c. Clamped as above. */
LMB_API float lmb_cone_cos_from_solid_angle_visibility(float visibility);

/* Cone cosine of a bent cone wholly above the horizon, `axis_dot_normal` in (0, 1]: V = (b.n) sin^2(a), so
 * c = sqrt(1 - V / (b.n)), the ratio clamped to [0, 1]. */
LMB_API float lmb_cone_cos_from_bent_visibility(float visibility, float axis_dot_normal);

/* Linear SH of the radiance inside the cone: the exact first four coefficients of the clipped quadratic polynomial.
 * `axis` unit, `cone_cos` clamped to [0, 1]. */
LMB_API lmb_sh2 lmb_sh3_multiply_cone(const lmb_sh3 *radiance, lmb_vec3 axis, float cone_cos);

/* Hemispherical least squares: the SH3 that approximates radiance best where a surface with unit `normal` can see,
 * from its moments over that hemisphere, moments_i = integral over w.normal > 0 of L Y_i. Solves G(0) a = moments in
 * closed form per block of G; condition number 254. Coefficients may be large where they do not matter, below the
 * horizon. */
LMB_API lmb_sh3 lmb_sh3_fit_hemisphere(const lmb_sh3 *moments, lmb_vec3 normal);

#ifdef __cplusplus
}
#endif

#endif
