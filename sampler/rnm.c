#include <lambent/rnm.h>

#include "sh_internal.h"

/* Of the slopes: sqrt(2/3), 1/sqrt3, 1/sqrt6, 1/sqrt2. */
#define ACROSS 0.81649658f
#define UP 0.57735027f
#define BACK 0.40824829f
#define ASIDE 0.70710678f

void lmb_rnm_slopes_in_axes(const lmb_vec3 axes[3], lmb_vec3 slope[LMB_RNM_SLOPES])
{
    static const float local[LMB_RNM_SLOPES][2] = {{ACROSS, 0.0f}, {-BACK, ASIDE}, {-BACK, -ASIDE}};
    for (int k = 0; k < LMB_RNM_SLOPES; ++k) {
        const lmb_vec3 flat = lmb_vec3_mad(lmb_vec3_scale(axes[0], local[k][0]), axes[1], local[k][1]);
        slope[k] = lmb_vec3_mad(flat, axes[2], UP);
    }
}

/* `a` mirrored in the plane through the origin that `s`, of squared length `length`, is perpendicular to. */
static lmb_vec3 mirrored(lmb_vec3 a, lmb_vec3 s, float length)
{
    return lmb_vec3_mad(a, s, -2.0f * lmb_vec3_dot(a, s) / length);
}

/* Mirroring in s = r + n takes r to -n; so the shortest turn from r to n does to what is perpendicular to r what the
 * mirror does. Unlike a division by 1 + r.n this stays exact however near n is to -r, where r and n must
 * only be of one length to more than floats are: s.n = s.s/2 sees to it. */
void lmb_rnm_slopes(lmb_vec3 vertex_normal, lmb_vec3 slope[LMB_RNM_SLOPES])
{
    const lmb_vec3 from[3] = {{0.48f, -0.6f, 0.64f}, {0.8f, 0.0f, -0.6f}, {0.36f, 0.8f, 0.48f}};
    const lmb_vec3 n = lmb_normal_mended(vertex_normal);
    const lmb_vec3 sum = lmb_vec3_add(from[2], n);
    const lmb_vec3 s = lmb_vec3_mad(sum, n, 0.5f * lmb_vec3_dot(sum, sum) - lmb_vec3_dot(sum, n));
    const float length = lmb_vec3_dot(s, s);
    lmb_vec3 axes[3] = {from[0], lmb_vec3_scale(from[1], -1.0f), n};
    if (length > FLT_MIN) {
        axes[0] = mirrored(from[0], s, length);
        axes[1] = mirrored(from[1], s, length);
    }
    lmb_rnm_slopes_in_axes(axes, slope);
}

/* With w over both the horizon and the slope's own, z along n, x along `flat`: the integrals over pi of N0 (w.B),
 * N1 z (w.B), N1 x (w.B), and what is left of those of w w^T (w.B) against a matrix without trace. The slope is
 * g = acos(1/sqrt3) from n (docs/maths.md has the integrals for any g). */
static float slope_irradiance(const lmb_sh3 *radiance, lmb_vec3 n, lmb_vec3 flat)
{
    const lmb_vec3 v = lmb_sh_linear(radiance->c);
    const lmb_vec3 mn = lmb_sh3_quadratic_times(radiance, n), mx = lmb_sh3_quadratic_times(radiance, flat);
    const float constant = 0.22248115f * radiance->c[0];
    const float linear = 0.21553386f * lmb_vec3_dot(v, n) + 0.18508615f * lmb_vec3_dot(v, flat);
    const float quadratic = (1.0f / 12.0f) * lmb_vec3_dot(flat, mx) + 0.11383545f * lmb_vec3_dot(n, mn) +
                            0.32197528f * lmb_vec3_dot(flat, mn);
    return lmb_light_clamped(constant + linear + quadratic);
}

lmb_rnm lmb_rnm_from_sh3(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal)
{
    const lmb_vec3 n = lmb_normal_mended(vertex_normal);
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(n, slope);
    lmb_rnm rnm;
    for (int k = 0; k < LMB_RNM_SLOPES; ++k) {
        const lmb_vec3 flat = lmb_vec3_scale(lmb_vec3_mad(slope[k], n, -UP), 1.0f / ACROSS);
        for (int c = 0; c < 3; ++c) {
            rnm.light[k].c[c] = slope_irradiance(&radiance->channel[c], n, flat);
        }
    }
    return rnm;
}

void lmb_rnm_add_light(lmb_rnm *rnm, lmb_vec3 vertex_normal, const lmb_vec3 slope[LMB_RNM_SLOPES], lmb_vec3 direction,
                       lmb_rgb weight)
{
    if (!(lmb_vec3_dot(direction, vertex_normal) > 0.0f)) {
        return;
    }
    for (int k = 0; k < LMB_RNM_SLOPES; ++k) {
        const float cosine = lmb_larger(lmb_vec3_dot(direction, slope[k]), 0.0f);
        rnm->light[k] = lmb_rgb_add(rnm->light[k], lmb_rgb_scale(weight, cosine * (1.0f / LMB_PI_F)));
    }
}
