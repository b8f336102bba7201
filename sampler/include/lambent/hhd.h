/* HHD, hemisphere and highlight direction: irradiance over a surface's hemisphere as a hemisphere light and one
 * directional light,
 *
 *     I(n) = C_a (1 + n_v.n)/2 + C_d max(0, n.d)
 *
 * and IrradZ, the filterable form that lightmaps store: I_z = I(n_v), the ambient weight w and the direction d, so
 * that C_a = w I_z and C_d = (1 - w) I_z / (n_v.d) (Roughton, Sloan, Silvennoinen and Shirley, SIGGRAPH 2024).
 *
 * Colour: the direction d and the weight w come from Rec. 709 luminance and are shared by the channels; I_z is a
 * colour. Probes and lightmaps split colour in the same way; they differ in what their SH3 know, and each has a
 * function of its own, so that a call says which it has.
 *
 * All functions are pure, allocate nothing, and may be called from any thread. Normals are unit vectors; n_v is the
 * surface (vertex) normal, n the shading normal. Irradiance is normalised (lambent/sh.h). No input, however broken,
 * gives NaN, infinity or negative light.
 *
 * Evaluating is a few instructions, and stands here to be inlined: the library has no symbol for it. Compiled with
 * the library's own -ffp-contract=off it gives the same bits everywhere; other flags may differ in the last one. */
#ifndef LAMBENT_HHD_H
#define LAMBENT_HHD_H

#include <lambent/api.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Normalised moments of radiance already clipped to the hemisphere: scalar b_c = integral of L dw / pi, vector
 * b = integral of L w dw / pi, so that b.n_v is the normalised irradiance at n_v. */
typedef struct lmb_moments {
    float scalar;
    lmb_vec3 vector;
} lmb_moments;

/* One channel: C_a, C_d and unit d. */
typedef struct lmb_hhd {
    float ambient;
    float directional;
    lmb_vec3 direction;
} lmb_hhd;

/* The same with colour; d is shared. */
typedef struct lmb_hhd_rgb {
    lmb_rgb ambient;
    lmb_rgb directional;
    lmb_vec3 direction;
} lmb_hhd_rgb;

/* What a lightmap texel stores; every member may be filtered, d normalised afterwards. */
typedef struct lmb_irradz {
    lmb_rgb irradiance_z;
    float ambient_weight; /* w in [0, 1] */
    lmb_vec3 direction;   /* unit, world space, at least LMB_IRRADZ_MIN_COS above the horizon of n_v; a shorter one, as
                             filtering leaves it, is trusted less by normals that it is low for (lmb_irradz_decode) */
} lmb_irradz;

/* The lowest n_v.d that IrradZ stores: below it (1 - w) / (n_v.d) is too steep to store and filter. */
#define LMB_IRRADZ_MIN_COS 0.05f

/* Moments of clipped linear SH (lmb_sh3_multiply_cone): b_c = (2/sqrt(pi)) y0, b = 2/sqrt(3 pi) y1. */
LMB_API lmb_moments lmb_moments_from_sh2(const lmb_sh2 *clipped_radiance);

/* Moments of what a cone about unit `vertex_normal` lets through (cone_cos = 0: the hemisphere; clamped to [0, 1]) of a
 * PROBE's radiance: SH3 of the whole sphere around a point. Nine numbers do not say what exactly comes from above the
 * horizon; the Gram multiply (lmb_sh3_multiply_cone) takes them for all there is, and lets light from below leak up and
 * light from above leak down. This one adds to it what a small network, fitted to procedural skies, makes of their
 * invariants about the normal: irradiance from them has half of the error near surfaces, two thirds in the open
 * (docs/testing.md has the figures). Turns and mirrors with the light, scales with it, is continuous in everything, and
 * goes over into Gram as c[0] goes to 0. Not for SH3 that were fitted over the hemisphere (lmb_sh3_fit_hemisphere), as
 * a lightmap's texels: what those have below the horizon is no light. May be NaN for broken sets, which lmb_hhd_solve
 * mends. */
LMB_API lmb_moments lmb_moments_from_probe(const lmb_sh3 *radiance, lmb_vec3 vertex_normal, float cone_cos);

/* The HHD light that has these moments, by the closed form, robust for every input: no light for b_c <= 0 or NaN;
 * C_a, C_d >= 0; d unit, never below the horizon. Keeps I(n_v) = b.n_v wherever b.n_v is physical
 * (0 <= b.n_v, |b| <= b_c). */
LMB_API lmb_hhd lmb_hhd_solve(lmb_moments moments, lmb_vec3 vertex_normal);

/* Normalised irradiance at `normal`, >= 0. */
static inline float lmb_hhd_evaluate(const lmb_hhd *hhd, lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    const float hemisphere = 0.5f + 0.5f * lmb_vec3_dot(vertex_normal, normal);
    const float cosine = lmb_vec3_dot(normal, hhd->direction);
    const float highlight = cosine > 0.0f ? cosine : 0.0f;
    return lmb_light_clamped(hhd->ambient * hemisphere + hhd->directional * highlight);
}

static inline lmb_rgb lmb_hhd_rgb_evaluate(const lmb_hhd_rgb *hhd, lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    lmb_rgb irradiance;
    for (int i = 0; i < 3; ++i) {
        const lmb_hhd channel = {hhd->ambient.c[i], hhd->directional.c[i], hhd->direction};
        irradiance.c[i] = lmb_hhd_evaluate(&channel, vertex_normal, normal);
    }
    return irradiance;
}

/* IrradZ of a probe's SH3, which knows the whole sphere: lmb_moments_from_probe of each colour (cone_cos = 0: the
 * hemisphere) -> HHD of the luminance -> IrradZ. What lights an object, or a surface, from a baked volume. */
LMB_API lmb_irradz lmb_irradz_from_probe(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos);

/* The same of SH3 that are right where the surface can see, as hemispherical least squares makes them
 * (lmb_sh3_fit_hemisphere): what lightmaps are baked with. They are taken at their word: clipped by the Gram multiply,
 * which is the papers' for probes too (Roughton et al. 2024). */
LMB_API lmb_irradz lmb_irradz_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos);

/* IrradZ back to HHD. The direction may be filtered and unnormalised, the weight out of range: both are mended. A
 * filtered direction that is lower than LMB_IRRADZ_MIN_COS before it is made unit comes from surfaces that face apart:
 * the directional part fades to nothing until n_v.d = 0, and I(n_v) = I_z stays. */
LMB_API lmb_hhd_rgb lmb_irradz_decode(const lmb_irradz *irradz, lmb_vec3 vertex_normal);

/* Both at once, for one normal a texel: lmb_irradz_decode and lmb_hhd_rgb_evaluate to within rounding, where d is no
 * longer than 1, but without a root: I = I_z (w (1 + n_v.n)/2 + (1 - w) max(0, n.d)/(n_v.d)), where the length of d
 * cancels. */
static inline lmb_rgb lmb_irradz_evaluate(const lmb_irradz *irradz, lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    const float height = lmb_vec3_dot(irradz->direction, vertex_normal);
    if (!(height >= LMB_IRRADZ_MIN_COS && height < 2.0f)) { /* filtering has mixed what does not agree */
        const lmb_hhd_rgb hhd = lmb_irradz_decode(irradz, vertex_normal);
        return lmb_hhd_rgb_evaluate(&hhd, vertex_normal, normal);
    }
    const float directional = lmb_saturate(1.0f - irradz->ambient_weight);
    const float hemisphere = 0.5f + 0.5f * lmb_vec3_dot(vertex_normal, normal);
    const float highlight = lmb_larger(lmb_vec3_dot(normal, irradz->direction), 0.0f) / height;
    const float share = hemisphere + directional * (highlight - hemisphere);
    lmb_rgb irradiance;
    for (int i = 0; i < 3; ++i) {
        irradiance.c[i] = lmb_light_clamped(share * irradz->irradiance_z.c[i]);
    }
    return irradiance;
}

/* Light that the surface reflects onto its own bumps: albedo I_z (1 - n.n_v)/2, per channel. */
static inline lmb_rgb lmb_self_bounce(lmb_rgb albedo, lmb_rgb irradiance_z, lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    const float backward = 0.5f - 0.5f * lmb_vec3_dot(vertex_normal, normal);
    lmb_rgb bounce;
    for (int i = 0; i < 3; ++i) {
        bounce.c[i] = lmb_light_clamped(albedo.c[i] * irradiance_z.c[i] * backward);
    }
    return bounce;
}

#ifdef __cplusplus
}
#endif

#endif
