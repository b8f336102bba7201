/* Spherical harmonics, up to the quadratic band.
 *
 * Basis: real, orthonormal over the sphere, WITH the Condon-Shortley signs, in the order
 *
 *     l,m    00 | 1-1   10   11  | 2-2   2-1    20          21     22
 *            N0 | -N1 y N1 z -N1 x | N2 xy -N2 yz N20(3z2-1) -N2 xz N22(x2-y2)
 *
 *     N0 = 1/(2 sqrt(pi))  N1 = sqrt(3/(4 pi))  N2 = sqrt(15/(4 pi))  N20 = sqrt(5/(16 pi))  N22 = sqrt(15/(16 pi))
 *
 * Shader code often uses the same basis with all signs positive; that one is this one turned 180 degrees about z.
 * SH live in world space; nothing is ever rotated, except for engines with other axes (lmb_sh3_in_axes).
 *
 * Coefficients hold RADIANCE unless a name says irradiance. Irradiance is NORMALISED: E/pi, the number that a
 * Lambertian albedo multiplies, so that a constant environment of radiance 1 gives 1. Going from radiance to
 * normalised irradiance scales the bands by 1, 2/3, 1/4 (Ramamoorthi and Hanrahan 2001).
 *
 * All functions are pure, allocate nothing, and may be called from any thread. Directions are unit vectors. */
#ifndef LAMBENT_SH_H
#define LAMBENT_SH_H

#include <lambent/api.h>
#include <lambent/types.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_SH2_COUNT = 4, LMB_SH3_COUNT = 9 };

/* Linear SH of one scalar: 2 bands, 4 coefficients. */
typedef struct lmb_sh2 {
    float c[LMB_SH2_COUNT];
} lmb_sh2;

/* Linear SH of a colour: what a lightmap of the model `sh2` stores. */
typedef struct lmb_sh2_rgb {
    lmb_sh2 channel[3];
} lmb_sh2_rgb;

/* Quadratic SH of one scalar: 3 bands, 9 coefficients. */
typedef struct lmb_sh3 {
    float c[LMB_SH3_COUNT];
} lmb_sh3;

/* Quadratic SH of a colour, one set per channel: what a probe holds. */
typedef struct lmb_sh3_rgb {
    lmb_sh3 channel[3];
} lmb_sh3_rgb;

/* The nine basis functions at `direction`. */
LMB_API lmb_sh3 lmb_sh3_basis(lmb_vec3 direction);

/* Radiance that the set reconstructs towards `direction`. May be negative: truncated SH ring. */
LMB_API float lmb_sh3_evaluate(const lmb_sh3 *radiance, lmb_vec3 direction);

/* Normalised irradiance (E/pi) on `normal` from the whole sphere, no occlusion, clamped to [0, FLT_MAX]: the sum alone
 * goes negative, as truncated SH ring. NaN and infinite coefficients give 0. */
LMB_API float lmb_sh3_irradiance(const lmb_sh3 *radiance, lmb_vec3 normal);
LMB_API lmb_rgb lmb_sh3_rgb_irradiance(const lmb_sh3_rgb *radiance, lmb_vec3 normal);

/* The same of linear SH. Of SH that hold what a surface's hemisphere lets through, as lightmaps do, it is the
 * irradiance with occlusion. */
LMB_API float lmb_sh2_irradiance(const lmb_sh2 *radiance, lmb_vec3 normal);
LMB_API lmb_rgb lmb_sh2_rgb_irradiance(const lmb_sh2_rgb *radiance, lmb_vec3 normal);

/* Adds light of `weight` (radiance times solid angle) that arrives from `direction`: the Monte Carlo projector. */
LMB_API void lmb_sh3_add_light(lmb_sh3 *radiance, lmb_vec3 direction, float weight);
LMB_API void lmb_sh3_rgb_add_light(lmb_sh3_rgb *radiance, lmb_vec3 direction, lmb_rgb weight);

/* a + (b - a) t, coefficient by coefficient. Blend SH and solve afterwards, never the other way round. */
LMB_API lmb_sh3_rgb lmb_sh3_rgb_lerp(const lmb_sh3_rgb *a, const lmb_sh3_rgb *b, float t);

/* The same light in another system of axes: `axes` are the other system's x, y and z in ours, three orthogonal unit
 * vectors, a rotation or a reflection. A direction d of ours is (axes[0].d, axes[1].d, axes[2].d) there, and evaluates
 * to the same. Band 1 turns as a vector, band 2 as a symmetric matrix; units and signs stay (docs/sampling.md has the
 * tables for some engines). */
LMB_API lmb_sh3 lmb_sh3_in_axes(const lmb_sh3 *sh, const lmb_vec3 axes[3]);
LMB_API lmb_sh3_rgb lmb_sh3_rgb_in_axes(const lmb_sh3_rgb *sh, const lmb_vec3 axes[3]);

/* Rec. 709 luminance of a coloured set. */
LMB_API lmb_sh3 lmb_sh3_rgb_luminance(const lmb_sh3_rgb *radiance);

#ifdef __cplusplus
}
#endif

#endif
