/* HLSH (lambent/hlsh.h) without truncation: of the exact irradiance of the clipped SH3, and of the light itself. */
#include <lambent/hlsh.h>

#include "model/clipped.h"
#include "model/models.h"

/* I_z, C_a and the tangential vector of each colour. */
enum { OF_COLOUR = 5, CHANNELS = 3 * OF_COLOUR };

static void store(const lmb_hlsh *hlsh, float *channel)
{
    channel[0] = hlsh->irradiance_z;
    channel[1] = hlsh->ambient;
    channel[2] = hlsh->tangential.x;
    channel[3] = hlsh->tangential.y;
    channel[4] = hlsh->tangential.z;
}

/* What one unit of each part of the radiance about the axis adds behind a cone of half angle alpha. In double: a
 * closing cone cancels. */
typedef struct t2_weights {
    double ca_l0, ca_l1, ca_l2;
    double c_l1, c_l2;
} t2_weights;

static t2_weights t2_weights_of(float cone_cos)
{
    const double c = (double)lmb_saturate(cone_cos), a = acos(c), s = sqrt(1.0 - c * c), pi = LMB_PI;
    const double q = pi * sqrt(pi), s2 = 2.0 * s * c, c2 = 2.0 * c * c - 1.0;
    t2_weights w;
    w.ca_l0 = (2.0 * a * (s * s - c * c) - 4.0 * a + 3.0 * pi * (1.0 - c) * (1.0 - c) + 3.0 * s2) / (8.0 * q);
    w.ca_l1 =
        sqrt(3.0) *
        (-a * c * c * c / 3.0 + pi * (3.0 * s * s + 2.0 * c * c * c - 2.0) / 8.0 - s * s * s / 9.0 + c * c * s / 3.0) /
        q;
    w.ca_l2 = sqrt(5.0) *
              (28.0 * a - 16.0 * a * c2 - 24.0 * a * c2 * c2 - 24.0 * s2 + 15.0 * sin(4.0 * a) +
               pi * (24.0 * c + 18.0 * c2 * c2 + 12.0 * c2 - 24.0 * cos(3.0 * a) - 30.0)) /
              (256.0 * q);
    w.c_l1 = sqrt(3.0) *
             (9.0 * a * c - 3.0 * a * c * c * c + c * c * s - 7.0 * s + pi * (3.0 * c * c * c - 9.0 * c + 6.0)) /
             (18.0 * q);
    w.c_l2 = sqrt(15.0) * (3.0 * a + (2.0 * pi - 2.0 * a) * (1.0 - c2) * (1.0 - c2) - 2.0 * s2 + 0.25 * sin(4.0 * a)) /
             (64.0 * q);
    return w;
}

static void t2_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const t2_weights w = t2_weights_of(cone_cos);
    lmb_vec3 axes[3];
    lmb_normal_axes(vertex_normal, axes);
    lmb_moments moments[3];
    lmb_clipped_moments(radiance, axes[2], cone_cos, moments);
    for (int c = 0; c < 3; ++c) {
        const lmb_sh3 l = lmb_sh3_in_axes(&radiance->channel[c], axes);
        const double x = -w.c_l1 * (double)l.c[3] - w.c_l2 * (double)l.c[7];
        const double y = -w.c_l1 * (double)l.c[1] - w.c_l2 * (double)l.c[5];
        const lmb_hlsh hlsh = {lmb_vec3_dot(moments[c].vector, axes[2]),
                               (float)(w.ca_l0 * (double)l.c[0] + w.ca_l1 * (double)l.c[2] + w.ca_l2 * (double)l.c[6]),
                               lmb_vec3_mad(lmb_vec3_scale(axes[0], (float)x), axes[1], (float)y)};
        store(&hlsh, &channel[OF_COLOUR * c]);
    }
}

static void light_encode(const lmb_directed_light *light, size_t count, lmb_vec3 vertex_normal, float *channel)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_hlsh hlsh[3] = {{0}};
    for (size_t i = 0; i < count; ++i) {
        for (int c = 0; c < 3; ++c) {
            lmb_hlsh_add_light(&hlsh[c], n, light[i].direction, light[i].weight.c[c]);
        }
    }
    for (int c = 0; c < 3; ++c) {
        store(&hlsh[c], &channel[OF_COLOUR * c]);
    }
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    for (int c = 0; c < 3; ++c) {
        const float *s = &channel[OF_COLOUR * c];
        const lmb_hlsh hlsh = {s[0], s[1], {s[2], s[3], s[4]}};
        for (int i = 0; i < count; ++i) {
            irradiance[i].c[c] = lmb_hlsh_evaluate(&hlsh, n, normal[i]);
        }
    }
}

const lmb_model lmb_model_hlsh_t2 = {
    .name = "hlsh.t2",
    .title = "HLSH of the clipped SH3's exact irradiance",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    LMB_LINEAR_ROW(CHANNELS),
    .cone = true,
    .encode = t2_encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_hlsh_light = {
    .name = "hlsh.light",
    .title = "HLSH of the light itself",
    .channel_count = CHANNELS,
    .bytes = 2 * CHANNELS,
    .encode_light = light_encode,
    .evaluate = evaluate,
};
