/* Radiosity normal mapping: light on three orthogonal slopes about a surface's normal, blended by the squared cosines
 * of the shading normal with them (McTaggart, "Half-Life 2 / Valve Source Shading", 2004), and self-shadowed bump maps,
 * which store the blend (Green, "Efficient Self-Shadowed Radiosity Normal Mapping", SIGGRAPH 2007).
 *
 * In a frame whose z is the surface's normal the slopes are
 *
 *     B1 = (sqrt(2/3), 0, 1/sqrt3)    B2 = (-1/sqrt6, 1/sqrt2, 1/sqrt3)    B3 = (-1/sqrt6, -1/sqrt2, 1/sqrt3)
 *
 * Which x and y the frame has is lmb_rnm_slopes' choice, from the normal alone, so that lightmaps need no tangents; it
 * changes smoothly with the normal, and texels of a bent surface can be filtered. Irradiance is normalised
 * (lambent/sh.h).
 *
 * All functions are pure, allocate nothing, and may be called from any thread. Normals are unit vectors unless it is
 * said otherwise. No input, however broken, gives NaN, infinity or negative light. */
#ifndef LAMBENT_RNM_H
#define LAMBENT_RNM_H

#include <lambent/api.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_RNM_SLOPES = 3 };

/* What a lightmap texel stores: normalised irradiance on each slope, from above the surface's horizon. May be filtered.
 */
typedef struct lmb_rnm {
    lmb_rgb light[LMB_RNM_SLOPES];
} lmb_rnm;

/* The slopes in the world, of any three orthogonal unit vectors: a surface's tangent, bitangent and normal, as a normal
 * map has them. Lightmaps hold light on lmb_rnm_slopes; light on these is found by evaluating at each of them. */
LMB_API void lmb_rnm_slopes_in_axes(const lmb_vec3 axes[3], lmb_vec3 slope[LMB_RNM_SLOPES]);

/* The slopes in the world that lightmaps are stored on, about a normal of any length (+Y where it has none). Their
 * frame is the one that the shortest turn of (0.36, 0.8, 0.48) to the normal carries along from the axes (0.48, -0.6,
 * 0.64) and (0.8, 0, -0.6): smooth everywhere but at the normal (-0.36, -0.8, -0.48), where floors, walls and ceilings
 * are not. */
LMB_API void lmb_rnm_slopes(lmb_vec3 vertex_normal, lmb_vec3 slope[LMB_RNM_SLOPES]);

/* Light on the slopes of a surface whose SH3 radiance is right where it can see, as lightmaps' is
 * (lmb_sh3_fit_hemisphere): the exact integrals of the polynomial over what is above both the horizon and the slope's
 * own. */
LMB_API lmb_rnm lmb_rnm_from_sh3(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal);

/* Adds light of `weight` (radiance times solid angle) from `direction`, for light that is not in harmonics. `slope` are
 * those of the surface. Light from below its horizon adds nothing. */
LMB_API void lmb_rnm_add_light(lmb_rnm *rnm, lmb_vec3 vertex_normal, const lmb_vec3 slope[LMB_RNM_SLOPES],
                               lmb_vec3 direction, lmb_rgb weight);

/* Normalised irradiance at `normal`. `slope` are those that the light is of. 0 on normals that face none of them, more
 * than 90 degrees from the surface's. */
static inline lmb_rgb lmb_rnm_evaluate(const lmb_rnm *rnm, const lmb_vec3 slope[LMB_RNM_SLOPES], lmb_vec3 normal)
{
    lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
    float total = 0.0f;
    for (int k = 0; k < LMB_RNM_SLOPES; ++k) {
        const float cosine = lmb_larger(lmb_vec3_dot(normal, slope[k]), 0.0f);
        sum = lmb_rgb_add(sum, lmb_rgb_scale(rnm->light[k], cosine * cosine));
        total += cosine * cosine;
    }
    for (int c = 0; c < 3; ++c) {
        sum.c[c] = total > 0.0f ? lmb_light_clamped(sum.c[c] / total) : 0.0f;
    }
    return sum;
}

/* The same by a texel of a self-shadowed bump map (`lambent ssbump`), filtered or not: `weight` are its red, green and
 * blue, 0 to 1, the share of the light on each slope that the bump takes. They are no longer divided by their sum: what
 * is missing is shadow. `rnm` is of the slopes in the bump map's own axes. */
static inline lmb_rgb lmb_ssbump_evaluate(const lmb_rnm *rnm, lmb_rgb weight)
{
    lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
    for (int k = 0; k < LMB_RNM_SLOPES; ++k) {
        sum = lmb_rgb_add(sum, lmb_rgb_scale(rnm->light[k], weight.c[k]));
    }
    for (int c = 0; c < 3; ++c) {
        sum.c[c] = lmb_light_clamped(sum.c[c]);
    }
    return sum;
}

#ifdef __cplusplus
}
#endif

#endif
