/* SH2 and SH3 whose irradiance, found by the plain band scales, comes closest to the exact one over the hemisphere:
 * stored and decoded like the projection of what the hemisphere lets through, but without its error's share from below
 * the horizon. */
#include "model/clipped.h"
#include "model/models.h"

enum { SH2_CHANNELS = 3 * LMB_SH2_COUNT, SH3_CHANNELS = 3 * LMB_SH3_COUNT };

/* G^-1 <E_j, Y_i> over the hemisphere, divided by the band scales, where E_j is the exact normalised irradiance of Y_j
 * clipped by the horizon (docs/maths.md): of 00, 10, 20; of x, xz and of y, yz; of what has two turns. */
typedef struct fit_weights {
    float zonal[3][3];
    float tangential[2][2];
    float twice;
} fit_weights;

static const fit_weights sh2_weights = {
    {{0.5f, 0.3323152046f, -0.2096313729f}, {0.4330127019f, 0.6744131816f, 0.6051536478f}},
    {{0.6286384661f, 0.5764862754f}},
    0.0f};

static const fit_weights sh3_weights = {
    {{0.5f, 0.4456503766f, 0.0f}, {0.4330127019f, 0.4781109053f, 0.2420614591f}, {0.0f, 0.2703201590f, 0.5f}},
    {{0.4892295701f, 0.4192627458f}, {0.4433461592f, 0.5f}},
    0.5f};

static lmb_sh3 local_fit(const fit_weights *w, const float *l)
{
    lmb_sh3 fit;
    static const int zonal[3] = {0, 2, 6}, tangential[2][2] = {{3, 7}, {1, 5}};
    for (int i = 0; i < 3; ++i) {
        fit.c[zonal[i]] = w->zonal[i][0] * l[0] + w->zonal[i][1] * l[2] + w->zonal[i][2] * l[6];
    }
    for (int turn = 0; turn < 2; ++turn) {
        const int *of = tangential[turn];
        for (int i = 0; i < 2; ++i) {
            fit.c[of[i]] = w->tangential[i][0] * l[of[0]] + w->tangential[i][1] * l[of[1]];
        }
    }
    fit.c[4] = w->twice * l[4];
    fit.c[8] = w->twice * l[8];
    return fit;
}

static void fit_store(const fit_weights *weights, const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, int count,
                      float *channel)
{
    lmb_vec3 axes[3];
    lmb_normal_axes(vertex_normal, axes);
    const lmb_vec3 back[3] = {
        {axes[0].x, axes[1].x, axes[2].x}, {axes[0].y, axes[1].y, axes[2].y}, {axes[0].z, axes[1].z, axes[2].z}};
    for (int c = 0; c < 3; ++c) {
        const lmb_sh3 local = lmb_sh3_in_axes(&radiance->channel[c], axes);
        const lmb_sh3 fit = local_fit(weights, local.c);
        const lmb_sh3 world = lmb_sh3_in_axes(&fit, back);
        for (int i = 0; i < count; ++i) {
            channel[count * c + i] = world.c[i];
        }
    }
}

static void sh2_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)cone_cos;
    fit_store(&sh2_weights, radiance, vertex_normal, LMB_SH2_COUNT, channel);
}

static void sh3_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    (void)cone_cos;
    fit_store(&sh3_weights, radiance, vertex_normal, LMB_SH3_COUNT, channel);
}

static void sh2_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                         lmb_rgb *irradiance)
{
    (void)vertex_normal;
    lmb_sh2_rgb sh2;
    for (int i = 0; i < SH2_CHANNELS; ++i) {
        sh2.channel[i / LMB_SH2_COUNT].c[i % LMB_SH2_COUNT] = channel[i];
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh2_rgb_irradiance(&sh2, normal[i]);
    }
}

static void sh3_evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                         lmb_rgb *irradiance)
{
    (void)vertex_normal;
    lmb_sh3_rgb sh3;
    for (int i = 0; i < SH3_CHANNELS; ++i) {
        sh3.channel[i / LMB_SH3_COUNT].c[i % LMB_SH3_COUNT] = channel[i];
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_sh3_rgb_irradiance(&sh3, normal[i]);
    }
}

const lmb_model lmb_model_sh2_fit = {
    .name = "sh2.fit",
    .title = "SH2, least squares over the hemisphere",
    .channel_count = SH2_CHANNELS,
    .bytes = 2 * SH2_CHANNELS,
    LMB_LINEAR_ROW(SH2_CHANNELS),
    .at_run_time = true,
    .encode = sh2_encode,
    .evaluate = sh2_evaluate,
};

const lmb_model lmb_model_sh3_fit = {
    .name = "sh3.fit",
    .title = "SH3, least squares over the hemisphere",
    .channel_count = SH3_CHANNELS,
    .bytes = 2 * SH3_CHANNELS,
    LMB_LINEAR_ROW(SH3_CHANNELS),
    .at_run_time = true,
    .encode = sh3_encode,
    .evaluate = sh3_evaluate,
};
