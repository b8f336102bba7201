/* HLSH: irradiance over a surface's hemisphere as three numbers and a constraint,
 *
 *     I(n) = I_z t + C_a (1 - t) + c.n_perp,     t = n.n_v,  n_perp = n - n_v t
 *
 * with I(n_v) = I_z exactly (Roughton, Sloan, Silvennoinen and Shirley, SIGGRAPH 2024). n_v is the surface (vertex)
 * normal that owns the hemisphere, n the shading normal. Irradiance is normalised (lambent/sh.h).
 *
 * All functions are pure, allocate nothing, and may be called from any thread. Normals are unit vectors.
 *
 * Evaluating is a few instructions, and stands here to be inlined: the library has no symbol for it. Compiled with
 * the library's own -ffp-contract=off it gives the same bits everywhere; other flags may differ in the last one. */
#ifndef LAMBENT_HLSH_H
#define LAMBENT_HLSH_H

#include <lambent/api.h>
#include <lambent/sh.h>
#include <lambent/vector.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One channel. */
typedef struct lmb_hlsh {
    float irradiance_z;  /* I_z, normalised irradiance at n_v */
    float ambient;       /* C_a */
    lmb_vec3 tangential; /* c, world space, perpendicular to n_v */
} lmb_hlsh;

typedef struct lmb_hlsh_rgb {
    lmb_hlsh channel[3];
} lmb_hlsh_rgb;

/* HLSH of a probe's SH3, which knows the whole sphere, behind a cone about unit `vertex_normal` (cone_cos = 0: the
 * whole hemisphere; clamped to [0, 1]): of the HHD light that lmb_moments_from_probe leads to (lambent/hhd.h). I(n) is
 * never far below 0. No input, however broken, gives NaN or infinity. */
LMB_API lmb_hlsh lmb_hlsh_from_probe(const lmb_sh3 *radiance, lmb_vec3 vertex_normal, float cone_cos);
LMB_API lmb_hlsh_rgb lmb_hlsh_rgb_from_probe(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos);

/* The same of SH3 taken at their word, as those that were fitted over the hemisphere may be (lmb_sh3_fit_hemisphere):
 * the clipped radiance is truncated to SH3, convolved and fitted with I_z held exact. Linear, and half the work. */
LMB_API lmb_hlsh lmb_hlsh_from_sh3(const lmb_sh3 *radiance, lmb_vec3 vertex_normal, float cone_cos);
LMB_API lmb_hlsh_rgb lmb_hlsh_rgb_from_sh3(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos);

/* Adds light of `weight` (radiance times solid angle) from `direction`: the exact least-squares projector of any
 * radiance. Light from below the horizon adds nothing. */
LMB_API void lmb_hlsh_add_light(lmb_hlsh *hlsh, lmb_vec3 vertex_normal, lmb_vec3 direction, float weight);

/* Normalised irradiance at `normal`, clamped at 0: from a raw probe the linear model goes negative somewhere in most
 * hemispheres of a sunny environment. NaN gives 0. */
static inline float lmb_hlsh_evaluate(const lmb_hlsh *hlsh, lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    const float t = lmb_vec3_dot(normal, vertex_normal);
    /* `tangential` is perpendicular to n_v: its dot product with n is the one with n_perp. */
    return lmb_light_clamped(hlsh->irradiance_z * t + hlsh->ambient * (1.0f - t) +
                             lmb_vec3_dot(hlsh->tangential, normal));
}

static inline lmb_rgb lmb_hlsh_rgb_evaluate(const lmb_hlsh_rgb *hlsh, lmb_vec3 vertex_normal, lmb_vec3 normal)
{
    lmb_rgb irradiance;
    for (int i = 0; i < 3; ++i) {
        irradiance.c[i] = lmb_hlsh_evaluate(&hlsh->channel[i], vertex_normal, normal);
    }
    return irradiance;
}

#ifdef __cplusplus
}
#endif

#endif
