/* Five spherical Gaussians, exp(2 (n.m - 1)), one about the normal and four around it at 60 degrees, fitted by least
 * squares over the hemisphere to the irradiance of the quadratic multiply. */
#include "model/clipped.h"
#include "model/models.h"

enum { LOBES = 5, CHANNELS = 3 * LOBES };

#define SHARPNESS 2.0f
#define TILT_SINE 0.86602540f
#define TILT_COSINE 0.5f

/* (<lobe, lobe>^-1 <lobe, Y>), over the hemisphere: 00, 10, 20 in the middle lobe and in the ring; what the sides of
 * the ring differ in. tests/test_models.c has the integrals. */
static const float middle[3] = {-0.10421914f, 0.53865149f, 1.35129705f};
static const float ring[3] = {0.23272064f, 0.01023006f, -0.41557597f};
static const float sides[2] = {0.51126422f, 0.47707307f}, squares = 0.76180133f;

static void fit(const lmb_sh3 *irradiance, float amplitude[LOBES])
{
    const float *e = irradiance->c;
    const float level = ring[0] * e[0] + ring[1] * e[2] + ring[2] * e[6];
    const float x = -sides[0] * e[3] - sides[1] * e[7], y = -sides[0] * e[1] - sides[1] * e[5];
    amplitude[0] = middle[0] * e[0] + middle[1] * e[2] + middle[2] * e[6];
    amplitude[1] = level + squares * e[8] + x;
    amplitude[2] = level - squares * e[8] + y;
    amplitude[3] = level + squares * e[8] - x;
    amplitude[4] = level - squares * e[8] - y;
}

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    lmb_vec3 axes[3];
    lmb_sh3 irradiance[3];
    lmb_normal_axes(vertex_normal, axes);
    lmb_clipped_irradiance(radiance, axes, cone_cos, irradiance);
    for (int c = 0; c < 3; ++c) {
        fit(&irradiance[c], &channel[LOBES * c]);
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    lmb_vec3 axes[3];
    lmb_normal_axes(vertex_normal, axes);
    for (int i = 0; i < count; ++i) {
        const float x = TILT_SINE * lmb_vec3_dot(axes[0], normal[i]), y = TILT_SINE * lmb_vec3_dot(axes[1], normal[i]);
        const float z = lmb_vec3_dot(axes[2], normal[i]), low = TILT_COSINE * z;
        const float cosine[LOBES] = {z, low + x, low + y, low - x, low - y};
        float lobe[LOBES];
        for (int k = 0; k < LOBES; ++k) {
            lobe[k] = expf(SHARPNESS * (cosine[k] - 1.0f));
        }
        for (int c = 0; c < 3; ++c) {
            float sum = 0.0f;
            for (int k = 0; k < LOBES; ++k) {
                sum += channel[LOBES * c + k] * lobe[k];
            }
            irradiance[i].c[c] = lmb_light_clamped(sum);
        }
    }
}

const lmb_model lmb_model_sg5_gram = {
    .name = "sg5.gram",
    .title = "five spherical Gaussians",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .cone = true,
    .encode = encode,
    .evaluate = evaluate,
};
