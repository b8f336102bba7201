/* Specular reflection of baked light, after Chen and Liu, "Lighting and Material of Halo 3" (2008), in three layers:
 *
 *     analytic     one direction: a key light, or the dominant light of harmonics, through the reflectance itself
 *     area         harmonics, through lobes integrated beforehand (3 KB of tables)
 *     environment  in place of area, for smooth surfaces: a cube map of some place, as bright as the area layer says
 *
 * The reflectance is Cook and Torrance's (1981) with Beckmann's slopes,
 *
 *     f = F D G / (4 (N.L)(N.V))      D = exp(-tan^2(a)/m^2) / (pi m^2 cos^4(a)), a between N and H
 *                                     G = min(1, 2 (N.H)(N.V)/(V.H), 2 (N.H)(N.L)/(V.H))
 *
 * with 4 where the papers print pi (docs/maths.md): of light that is the same from everywhere no more comes back than
 * arrives. What these functions return is radiance towards the eye: add it to albedo x irradiance. They clamp it to
 * [0, FLT_MAX], and NaN gives 0. `view` is a unit vector towards the eye, `normal` a unit shading normal; a view from
 * below the normal's horizon counts as one along it.
 *
 * All functions are pure, allocate nothing, and may be called from any thread. */
#ifndef LAMBENT_SPECULAR_H
#define LAMBENT_SPECULAR_H

#include <lambent/key_light.h>
#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Below this roughness the analytic layer's highlight stays as wide: that of one direction would be a point. */
#define LMB_SPECULAR_LEAST_ROUGHNESS 0.02f

/* What a surface does to specular light. */
typedef struct lmb_specular {
    float roughness; /* m, the root mean square of the facets' slopes; clamped to [0, 1] */
    lmb_rgb f0;      /* reflectance along the normal, each in [0, 1]: 0.04 for most that is no metal */
} lmb_specular;

/* The directional light that is nearest to harmonics: their linear direction, by luminance, and for each colour the
 * irradiance of least squares, 4 pi/9 sum l_i Y_i(d), not below 0. As a key light, E/pi. Without a direction: +Y and no
 * light. The area layer of what remains goes with its analytic one:
 *
 *     const lmb_key_light dominant = lmb_sh3_rgb_dominant_light(&radiance);
 *     lmb_key_light_add_to_sh3(&dominant, -1.0f, &radiance);
 */
LMB_API lmb_key_light lmb_sh3_rgb_dominant_light(const lmb_sh3_rgb *radiance);

/* How much of a lamp, or of a sun that is no key light, is seen where its direct light is in the harmonics, as far as
 * these tell: the irradiance of least squares in its direction (as for the dominant light; of luminance) over its own
 * at this place, in [0, 1]. `light` as it is there with nothing in its way, E/pi. Its highlight goes with that:
 *
 *     const float seen = lmb_sh3_rgb_light_visibility(&radiance, &lamp);
 *     reflected = add(reflected, lmb_specular_light(&lamp, seen, &specular, n_v, n, view));
 *     lmb_key_light_add_to_sh3(&lamp, -seen, &radiance);
 *
 * Of several the strongest first, each asked for in what those before it have left. Of a texel's harmonics, before they
 * are fitted over the hemisphere (lmb_sh3_fit_hemisphere). */
LMB_API float lmb_sh3_rgb_light_visibility(const lmb_sh3_rgb *radiance, const lmb_key_light *light);

/* Radiance of one light's highlight, with the Fresnel factor of a dielectric of that f0 (for metals an approximation).
 * `visibility` of the light and `vertex_normal` as for lmb_key_light_irradiance: nothing where n_v.d <= 0. */
LMB_API lmb_rgb lmb_specular_light(const lmb_key_light *light, float visibility, const lmb_specular *specular,
                                   lmb_vec3 vertex_normal, lmb_vec3 normal, lmb_vec3 view);

/* The same with the paper's Phong lobe, exp(-tan^2(a)/m^2) / (pi m^2 cos^3(a)), a between light and mirrored view: for
 * glossy surfaces; it keeps no account of light near the horizon. Facets of slope m turn what they mirror by twice the
 * angle: this lobe is about as wide as the reflectance's of half the roughness. */
LMB_API lmb_rgb lmb_specular_light_phong(const lmb_key_light *light, float visibility, const lmb_specular *specular,
                                         lmb_vec3 vertex_normal, lmb_vec3 normal, lmb_vec3 view);

/* Radiance of the reflection of harmonics, of the whole sphere or fitted over the hemisphere, with Schlick's Fresnel
 * factor. Harmonics are blurred light: below a roughness of about 0.4 reflections are blurred with it. */
LMB_API lmb_rgb lmb_specular_area(const lmb_sh3_rgb *radiance, const lmb_specular *specular, lmb_vec3 normal,
                                  lmb_vec3 view);

/* The same with Phong's lobe, without tables: each band of harmonics times what the lobe leaves of it, in the mirrored
 * direction, and Schlick's factor at the view's own angle. The lobe is all about that direction, below the horizon too:
 * for harmonics of the whole sphere. */
LMB_API lmb_rgb lmb_specular_area_phong(const lmb_sh3_rgb *radiance, const lmb_specular *specular, lmb_vec3 normal,
                                        lmb_vec3 view);

/* Radiance of the reflection by an environment map: `map` is its texel in the mirrored direction, at the level of the
 * surface's roughness, as `lambent cube` writes it: over lmb_specular_environment_divisor of its own place, direction
 * and roughness. `radiance` is of the surface's place, so that a map goes dark in a shadow and takes on the light
 * around. */
LMB_API lmb_rgb lmb_specular_environment(lmb_rgb map, const lmb_sh3_rgb *radiance, const lmb_specular *specular,
                                         lmb_vec3 normal, lmb_vec3 view);

/* What a map's texel is divided by: the area layer of a mirror that is looked at along its normal `direction`. As in
 * lmb_specular_environment it counts no less than half of the mean radiance does, since harmonics ring. */
LMB_API lmb_rgb lmb_specular_environment_divisor(const lmb_sh3_rgb *radiance, float roughness, lmb_vec3 direction);

/* A box for what is around an environment map, along the world's axes, as `lambent cube` finds one. */
typedef struct lmb_specular_proxy {
    lmb_vec3 position; /* the map's */
    lmb_vec3 low, high;
} lmb_specular_proxy;

/* The direction in which a map has what a surface at `position` sees along unit `mirrored`: from the map's place
 * towards the point where that ray leaves the box (box projection). Of a position outside, the nearest one inside
 * counts. A unit vector; `mirrored` where the box says nothing. */
LMB_API lmb_vec3 lmb_specular_proxy_direction(const lmb_specular_proxy *proxy, lmb_vec3 position, lmb_vec3 mirrored);

enum { LMB_SPECULAR_TEXTURES = 3, LMB_SPECULAR_ROWS = 16, LMB_SPECULAR_COLUMNS = 8 };

/* The lobes as three textures of four channels, for shaders (sampler/shader/lambent_specular.glsl): C of the harmonics
 * 0, 2, 3, 6; D of these; C of 7 and 8 and D of them. Rows by roughness, columns by view; all within (-2, 2), so that
 * halves or 16-bit numbers over 2 hold them. */
LMB_API void lmb_specular_textures(float rgba[LMB_SPECULAR_TEXTURES][LMB_SPECULAR_ROWS][LMB_SPECULAR_COLUMNS][4]);

#ifdef __cplusplus
}
#endif

#endif
