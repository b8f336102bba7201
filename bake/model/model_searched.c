/* AHD and HHD whose direction is searched: I_z exact, the ambient weight by least squares over the hemisphere against
 * the irradiance of the quadratic multiply, the direction by golden section (Roughton et al., SIGGRAPH 2024). */
#include <lambent/hhd.h>

#include "model/clipped.h"
#include "model/direction_search.h"
#include "model/hhd_store.h"
#include "model/models.h"

/* The irradiance of each colour about the normal. */
typedef struct searched_light {
    lmb_vec3 axes[3];
    lmb_moments moments[3];
    lmb_sh3 irradiance[3];
} searched_light;

static searched_light light_of(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos)
{
    searched_light light;
    lmb_normal_axes(vertex_normal, light.axes);
    lmb_clipped_moments(radiance, light.axes[2], cone_cos, light.moments);
    lmb_clipped_irradiance(radiance, light.axes, cone_cos, light.irradiance);
    return light;
}

static lmb_light_fit luminance_fit(const searched_light *light, float a0)
{
    const lmb_sh3_rgb irradiance = {{light->irradiance[0], light->irradiance[1], light->irradiance[2]}};
    const lmb_moments moments = lmb_moments_luminance(light->moments);
    return (lmb_light_fit){.irradiance = lmb_sh3_rgb_luminance(&irradiance),
                           .irradiance_z = lmb_light_clamped(lmb_vec3_dot(moments.vector, light->axes[2])),
                           .a0 = a0,
                           .a1 = 1.0f - a0};
}

static lmb_vec3 in_world(const searched_light *light, lmb_vec3 d)
{
    return lmb_vec3_mad(lmb_vec3_mad(lmb_vec3_scale(light->axes[0], d.x), light->axes[1], d.y), light->axes[2], d.z);
}

/* The colours share w and d. */
static void shared_store(const searched_light *light, const lmb_light_fit *fit, lmb_vec3 d, float *channel)
{
    const lmb_moments luminance = lmb_moments_luminance(light->moments);
    const float directional = lmb_light_fit_directional(fit, d);
    const float ambient = fit->irradiance_z - directional * d.z;
    lmb_hhd_rgb hhd = {.direction = in_world(light, d)};
    for (int c = 0; c < 3; ++c) {
        const float share = lmb_hhd_share(light->moments[c], luminance, light->axes[2]);
        hhd.ambient.c[c] = lmb_light_clamped(ambient * share);
        hhd.directional.c[c] = lmb_light_clamped(directional * share);
    }
    lmb_hhd_store(&hhd, channel);
}

static void hhd_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const searched_light light = light_of(radiance, vertex_normal, cone_cos);
    const lmb_light_fit fit = luminance_fit(&light, 0.5f);
    shared_store(&light, &fit, lmb_light_fit_in_plane(&fit), channel);
}

static void azimuth_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const searched_light light = light_of(radiance, vertex_normal, cone_cos);
    const lmb_light_fit fit = luminance_fit(&light, 0.5f);
    shared_store(&light, &fit, lmb_light_fit_anywhere(&fit), channel);
}

/* The colours share d. */
static void channels_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const searched_light light = light_of(radiance, vertex_normal, cone_cos);
    lmb_light_fit fit = luminance_fit(&light, 0.5f);
    const lmb_vec3 d = lmb_light_fit_in_plane(&fit);
    lmb_hhd_rgb hhd = {.direction = in_world(&light, d)};
    for (int c = 0; c < 3; ++c) {
        fit.irradiance = light.irradiance[c];
        fit.irradiance_z = lmb_light_clamped(lmb_vec3_dot(light.moments[c].vector, light.axes[2]));
        hhd.directional.c[c] = lmb_light_clamped(lmb_light_fit_directional(&fit, d));
        hhd.ambient.c[c] = lmb_light_clamped(fit.irradiance_z - hhd.directional.c[c] * d.z);
    }
    lmb_hhd_store(&hhd, channel);
}

static void ahd_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const searched_light light = light_of(radiance, vertex_normal, cone_cos);
    const lmb_light_fit fit = luminance_fit(&light, 1.0f);
    shared_store(&light, &fit, lmb_light_fit_in_plane(&fit), channel);
}

/* What games have shipped: IrradZ along the direction of the linear band, its weight by least squares over the whole
 * sphere against the irradiance of all light. There <1,1> = 4 pi, <1,(n.d)+> = pi, <(n.d)+,(n.d)+> = 2 pi/3. A
 * direction below the horizon is tilted up, as far as IrradZ stores it. */
static void shipped_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)cone_cos;
    const lmb_vec3 n = lmb_unit_normal(vertex_normal);
    lmb_moments moments[3];
    lmb_clipped_moments(radiance, n, 0.0f, moments);
    const lmb_moments seen = lmb_moments_luminance(moments);
    const lmb_sh3 luminance = lmb_sh3_rgb_luminance(radiance);
    lmb_sh3 twice = luminance; /* convolved twice: <E,(n.d)+> is pi times it at d */
    for (int i = 1; i < LMB_SH3_COUNT; ++i) {
        twice.c[i] *= i < LMB_SH2_COUNT ? 4.0f / 9.0f : 1.0f / 16.0f;
    }
    lmb_hhd_rgb hhd = {.direction = lmb_vec3_unit_or(lmb_linear_band(luminance.c), n)};
    const float least = LMB_IRRADZ_MIN_COS;
    if (lmb_vec3_dot(hhd.direction, n) < least) {
        const lmb_vec3 flat = lmb_vec3_mad(hhd.direction, n, -lmb_vec3_dot(hhd.direction, n));
        const float sine = sqrtf(1.0f - least * least);
        hhd.direction = lmb_vec3_mad(lmb_vec3_scale(lmb_vec3_unit_or(flat, n), sine), n, least);
    }
    const float i_z = lmb_light_clamped(lmb_vec3_dot(seen.vector, n));
    const float h = lmb_vec3_dot(hhd.direction, n), mean = LMB_N0 * twice.c[0];
    const float product = lmb_sh3_evaluate(&twice, hhd.direction) - 4.0f * h * mean - i_z * (1.0f - 4.0f * h);
    const float found = lmb_larger(product / (2.0f / 3.0f - 2.0f * h + 4.0f * h * h), 0.0f);
    const float directional = found * h < i_z ? found : i_z / h;
    for (int c = 0; c < 3; ++c) {
        const float share = lmb_hhd_share(moments[c], seen, n);
        hhd.directional.c[c] = lmb_light_clamped(directional * share);
        hhd.ambient.c[c] = lmb_light_clamped((i_z - h * directional) * share);
    }
    lmb_hhd_store(&hhd, channel);
}

static void ahd_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                         lmb_rgb *irradiance)
{
    (void)vertex_normal;
    const lmb_hhd_rgb ahd = lmb_hhd_stored(channel);
    for (int i = 0; i < count; ++i) {
        const float cosine = lmb_larger(lmb_vec3_dot(normal[i], ahd.direction), 0.0f);
        for (int c = 0; c < 3; ++c) {
            irradiance[i].c[c] = lmb_light_clamped(ahd.ambient.c[c] + ahd.directional.c[c] * cosine);
        }
    }
}

const lmb_model lmb_model_hhd_searched_gram = {
    .name = "hhd.searched.gram",
    .title = "HHD, direction searched in a plane",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .cone = true,
    .encode = hhd_encode,
    .evaluate = lmb_hhd_store_evaluate,
};

const lmb_model lmb_model_hhd_searched_azimuth = {
    .name = "hhd.searched.azimuth",
    .title = "HHD, direction searched all around",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .cone = true,
    .encode = azimuth_encode,
    .evaluate = lmb_hhd_store_evaluate,
};

const lmb_model lmb_model_hhd_searched_channels = {
    .name = "hhd.searched.channels",
    .title = "HHD, direction searched, C_a of each colour",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .cone = true,
    .encode = channels_encode,
    .evaluate = lmb_hhd_store_evaluate,
};

const lmb_model lmb_model_ahd_searched = {
    .name = "ahd.searched",
    .title = "AHD, direction searched in a plane",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .cone = true,
    .encode = ahd_encode,
    .evaluate = ahd_evaluate,
};

const lmb_model lmb_model_ahd_shipped = {
    .name = "ahd.shipped",
    .title = "AHD, linear direction, fitted over the sphere",
    .channel_count = LMB_HHD_CHANNELS,
    .bytes = 2 * LMB_HHD_CHANNELS,
    LMB_HHD_ROW,
    .encode = shipped_encode,
    .evaluate = ahd_evaluate,
};
