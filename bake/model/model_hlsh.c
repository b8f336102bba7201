/* HLSH: irradiance over a hemisphere as three numbers and a constraint (lambent/hlsh.h), of a texel's
 * SH3 or of a probe's. */
#include <lambent/hlsh.h>

#include "model/models.h"

/* I_z of each colour, then C_a, then the tangential vector. */
enum { I_Z, AMBIENT = 3, TANGENTIAL = 6, CHANNELS = 15 };

static const char *const names[CHANNELS] = {"R",   "G",   "B",   "a.R", "a.G", "a.B", "R.X", "R.Y",
                                            "R.Z", "G.X", "G.Y", "G.Z", "B.X", "B.Y", "B.Z"};

static const lmb_model_part parts[] = {
    {"irradiance", 3, 0.0f, 0.0f}, {"ambient", 3, 0.0f, 0.0f}, {"tangential", 9, 0.0f, 0.0f}, {NULL, 0, 0.0f, 0.0f}};

static void store(const lmb_hlsh_rgb *hlsh, float *channel)
{
    for (int c = 0; c < 3; ++c) {
        const lmb_hlsh *one = &hlsh->channel[c];
        channel[I_Z + c] = one->irradiance_z;
        channel[AMBIENT + c] = one->ambient;
        channel[TANGENTIAL + 3 * c] = one->tangential.x;
        channel[TANGENTIAL + 3 * c + 1] = one->tangential.y;
        channel[TANGENTIAL + 3 * c + 2] = one->tangential.z;
    }
}

static void encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_hlsh_rgb hlsh = lmb_hlsh_rgb_from_sh3(radiance, vertex_normal, cone_cos);
    store(&hlsh, channel);
}

static void probe_encode(const lmb_sh3_rgb *radiance, lmb_vec3 vertex_normal, float cone_cos, float *channel)
{
    const lmb_hlsh_rgb hlsh = lmb_hlsh_rgb_from_probe(radiance, vertex_normal, cone_cos);
    store(&hlsh, channel);
}

static void evaluate(const float *channel, lmb_vec3 vertex_normal, const lmb_vec3 *normal, int count,
                     lmb_rgb *irradiance)
{
    lmb_hlsh_rgb hlsh;
    for (int c = 0; c < 3; ++c) {
        const float *tangential = &channel[TANGENTIAL + 3 * c];
        hlsh.channel[c] =
            (lmb_hlsh){channel[I_Z + c], channel[AMBIENT + c], {tangential[0], tangential[1], tangential[2]}};
    }
    for (int i = 0; i < count; ++i) {
        irradiance[i] = lmb_hlsh_rgb_evaluate(&hlsh, vertex_normal, normal[i]);
    }
}

static const char convention[] =
    "irradiance: normalised (integral of L cos / pi), at the vertex normal; a: C_a; R.XYZ and so on: c in world space, "
    "+Y up; all / lambent:scale, linear Rec. 709";

const lmb_model lmb_model_hlsh = {
    .name = "hlsh",
    .full_name = "hlsh.t1",
    .short_name = "hlsh",
    .title = "HLSH",
    .uses = LMB_MODEL_FOR_LIGHTMAP,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = CHANNELS,
    .irradiance_first = true,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .convention = convention,
    .encode = encode,
    .evaluate = evaluate,
};

const lmb_model lmb_model_hlsh_fitted = {
    .name = "hlsh.fitted",
    .short_name = "hlsh",
    .title = "HLSH by the fitted multiply",
    .uses = LMB_MODEL_FOR_SURFACE | LMB_MODEL_FOR_OBJECT,
    .default_uses = LMB_MODEL_FOR_OBJECT,
    .at_run_time = true,
    .channel_count = CHANNELS,
    .channel_name = names,
    .part = parts,
    .light_count = CHANNELS,
    .irradiance_first = true,
    .bytes = 2 * CHANNELS,
    .cone = true,
    .convention = convention,
    .encode = probe_encode,
    .evaluate = evaluate,
};
