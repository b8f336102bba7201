/* H-basis: polynomials orthonormal over the hemisphere, of the irradiance of the quadratic multiply; four of them, or
 * six (Habel and Wimmer, "Efficient Irradiance Normal Mapping", I3D 2010). */
#include "model/clipped.h"
#include "model/models.h"

enum { MOST = 6, FOUR_CHANNELS = 12, SIX_CHANNELS = 18 };

/* 1/sqrt(2 pi), sqrt(3/(2 pi)), sqrt(15/(2 pi)) */
#define H_ONE 0.39894228f
#define H_LINEAR 0.69098830f
#define H_SQUARE 1.54509681f

/* The basis in the axes of the normal. The first four span 1, x, y, z. */
static void basis_of(lmb_vec3 n, float h[MOST])
{
    h[0] = H_ONE;
    h[1] = H_LINEAR * n.y;
    h[2] = H_LINEAR * (2.0f * n.z - 1.0f);
    h[3] = H_LINEAR * n.x;
    h[4] = H_SQUARE * n.x * n.y;
    h[5] = 0.5f * H_SQUARE * (n.x * n.x - n.y * n.y);
}

/* Inner products with SH: over the hemisphere the integrals of 1, z, x^2, x^2 z, x^2 y^2 and (x^2 - y^2)^2 are 2 pi,
 * pi, 2 pi/3, pi/4, 2 pi/15 and 8 pi/15, and 2z - 1 meets z and 3z^2 - 1 with pi/3 and pi. */
static void project(const lmb_sh3 *irradiance, float h[MOST])
{
    const float *e = irradiance->c, pi = LMB_PI_F;
    h[0] = H_ONE * pi * (2.0f * LMB_N0 * e[0] + LMB_N1 * e[2]);
    h[1] = -H_LINEAR * pi * (2.0f / 3.0f * LMB_N1 * e[1] + 0.25f * LMB_N2 * e[5]);
    h[2] = H_LINEAR * pi * (LMB_N1 / 3.0f * e[2] + LMB_N20 * e[6]);
    h[3] = -H_LINEAR * pi * (2.0f / 3.0f * LMB_N1 * e[3] + 0.25f * LMB_N2 * e[7]);
    h[4] = H_SQUARE * pi * (2.0f / 15.0f) * LMB_N2 * e[4];
    h[5] = H_SQUARE * pi * (4.0f / 15.0f) * LMB_N22 * e[8];
}

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, int taken, float *channel)
{
    lmb_vec3 axes[3];
    lmb_sh3 irradiance[3];
    lmb_normal_axes(vertex_normal, axes);
    lmb_clipped_irradiance(radiance, axes, cone_cos, irradiance);
    for (int c = 0; c < 3; ++c) {
        float h[MOST];
        project(&irradiance[c], h);
        for (int i = 0; i < taken; ++i) {
            channel[taken * c + i] = h[i];
        }
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count, int taken,
                     lmb_rgb *irradiance)
{
    lmb_vec3 axes[3];
    lmb_normal_axes(vertex_normal, axes);
    for (int i = 0; i < count; ++i) {
        float h[MOST];
        basis_of(lmb_vec3_of(lmb_vec3_dot(axes[0], normal[i]), lmb_vec3_dot(axes[1], normal[i]),
                             lmb_vec3_dot(axes[2], normal[i])),
                 h);
        for (int c = 0; c < 3; ++c) {
            float sum = 0.0f;
            for (int k = 0; k < taken; ++k) {
                sum += channel[taken * c + k] * h[k];
            }
            irradiance[i].c[c] = lmb_light_clamped(sum);
        }
    }
}

static void four_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    encode(radiance, vertex_normal, cone_cos, FOUR_CHANNELS / 3, channel);
}

static void four_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                          lmb_rgb *irradiance)
{
    evaluate(channel, vertex_normal, normal, count, FOUR_CHANNELS / 3, irradiance);
}

static void six_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    encode(radiance, vertex_normal, cone_cos, SIX_CHANNELS / 3, channel);
}

static void six_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                         lmb_rgb *irradiance)
{
    evaluate(channel, vertex_normal, normal, count, SIX_CHANNELS / 3, irradiance);
}

const lmb_model lmb_model_h4_gram = {
    .name = "h4.gram",
    .title = "H-basis of four",
    .channel_count = FOUR_CHANNELS,
    .bytes = 2 * FOUR_CHANNELS,
    LMB_LINEAR_ROW(FOUR_CHANNELS),
    .cone = true,
    .encode = four_encode,
    .evaluate = four_evaluate,
};

const lmb_model lmb_model_h6_gram = {
    .name = "h6.gram",
    .title = "H-basis of six",
    .channel_count = SIX_CHANNELS,
    .bytes = 2 * SIX_CHANNELS,
    LMB_LINEAR_ROW(SIX_CHANNELS),
    .cone = true,
    .encode = six_encode,
    .evaluate = six_evaluate,
};
