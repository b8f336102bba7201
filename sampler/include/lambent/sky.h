/* A sky that changes at run time: weather, hours of the day.
 *
 * What a probe gets from the sky, directly and by any number of bounces, is linear in the sky. So a level is baked
 * under a few fixed skies, the basis, `lambent bake --env sky-basis:K`, one volume for each; and light under any sky
 * that is a sum of them is the same sum of volumes. The basis spans harmonics: its first 4 functions the linear ones,
 * all 9 the quadratic ones.
 *
 *     K         0    1      2      3      4       5        6      7        8
 *     radiance  1  1 - y  1 + z  1 - x  1 + 2xy  1 - 2yz  3z^2  1 - 2xz  1 + x^2 - y^2
 *
 * No function is negative anywhere, as light is not; 1 less, all but the first are multiples of the harmonics of the
 * same number (lambent/sh.h). A sun does not fit in: it is a key light, and its bounces are a set of their own.
 *
 * All functions are pure, allocate nothing, and may be called from any thread. */
#ifndef LAMBENT_SKY_H
#define LAMBENT_SKY_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/api.h>
#include <lambent/sh.h>
#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_SKY_LINEAR = 4, LMB_SKY_QUADRATIC = 9 };

/* Radiance of each function of the basis from a unit direction, never negative. */
LMB_API void lmb_sky_basis(lmb_vec3 direction, float radiance[LMB_SKY_QUADRATIC]);

/* What each volume counts for under a sky, whose radiance `sky` holds: lmb_sh3_rgb_add_light of all its pixels. With
 * LMB_SKY_LINEAR as `count`, bands 0 and 1 alone are taken, and the first 4 weights set. Weights may be negative.
 * @return false, and nothing is set, for another count */
LMB_API bool lmb_sky_weights(const lmb_sh3_rgb *sky, uint32_t count, lmb_rgb *weight);

/* lmb_volume_blend with weights in colour, finite, which may be negative: so may the sum be where a sky is dark and
 * steep, by what its harmonics ring. Evaluating it clamps. Others than a sky's volumes may be among them: lamps with
 * weight 1, the sun's bounces with the sun's colour. @return true inside of all of them; never NaN */
LMB_API bool lmb_volume_blend_rgb(const lmb_volume *const *volume, const lmb_rgb *weight, uint32_t count,
                                  lmb_vec3d position, lmb_sh3_rgb *radiance);

#ifdef __cplusplus
}
#endif

#endif
