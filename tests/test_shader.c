/* The shader include against the sampler: the same inputs through sampler/ and through sampler/shader/, which a
 * compiler of GLSL and of HLSL has made SPIR-V of, on whatever Vulkan there is. */
#include "harness.h"
#include "shader_runner.h"
#include "variates.h"

#include <float.h>
#include <stdlib.h>

#include <lambent/direction_disc.h>
#include <lambent/hhd.h>
#include <lambent/hlsh.h>
#include <lambent/key_light.h>
#include <lambent/occlusion.h>
#include <lambent/rnm.h>
#include <lambent/specular.h>

/* What an item reads and writes, in tests/shaders/cases.glsl. */
enum {
    IN_SH = 0,
    IN_VERTEX_NORMAL = 27,
    IN_NORMAL = 30,
    IN_VISIBILITY = 33,
    IN_TEXEL_LIGHT = 34,
    IN_TEXEL_WEIGHT = 37,
    IN_TEXEL_DIRECTION = 38,
    IN_ALBEDO = 41,
    IN_BENT = 44,
    IN_VIEW = 45,
    IN_ROUGHNESS = 48,
    IN_F0 = 49,
    IN_LOBE = 52,
    INPUTS = 64
};
enum {
    OUT_CONE,
    OUT_BENT_CONE,
    OUT_SH3,
    OUT_ENCODED_LIGHT = 5,
    OUT_ENCODED_WEIGHT = 8,
    OUT_ENCODED_DIRECTION = 9,
    OUT_PROBE = 12,
    OUT_TEXEL = 15,
    OUT_HLSH_LIGHT = 18,
    OUT_HLSH = 21,
    OUT_SELF_BOUNCE = 24,
    OUT_TEXEL_AT_ONCE = 27,
    OUT_KEY = 30,
    OUT_FITTED_LIGHT = 33,
    OUT_FITTED = 36,
    OUT_FITTED_HLSH = 39,
    OUT_SPECULAR_AREA = 42,
    OUT_DOMINANT = 45,
    OUT_WITHOUT_DOMINANT = 48,
    OUT_HIGHLIGHT = 51,
    OUT_COORDINATES = 54,
    OUT_ENVIRONMENT = 56,
    OUT_RNM = 59,
    OUT_SSBUMP = 62,
    OUT_SH2 = 65,
    OUT_DISC = 68,
    OUT_PROXY = 71,
    OUT_LAMP = 74,
    OUT_PHONG = 75,
    OUT_PHONG_AREA = 78,
    OUTPUTS = 81
};

enum { GROUP = 64, GROUPS = 512, ITEMS = GROUP * GROUPS };

static float between(uint64_t *state, double low, double high)
{
    return (float)(low + (high - low) * variate_next(state));
}

static lmb_vec3 direction_of(uint64_t *state)
{
    const double z = 2.0 * variate_next(state) - 1.0, turn = 6.283185307179586 * variate_next(state);
    const double radius = sqrt(1.0 - z * z);
    return lmb_vec3_unit_or(lmb_vec3_of((float)(radius * cos(turn)), (float)(radius * sin(turn)), (float)z),
                            lmb_vec3_of(0.0f, 0.0f, 1.0f));
}

static void vector_put(float *at, lmb_vec3 v)
{
    at[0] = v.x;
    at[1] = v.y;
    at[2] = v.z;
}

static lmb_vec3 vector_get(const float *at)
{
    return lmb_vec3_of(at[0], at[1], at[2]);
}

static lmb_rgb colour_get(const float *at)
{
    return (lmb_rgb){{at[0], at[1], at[2]}};
}

/* Light of kinds that take turns: a sky and a few lamps; one lamp at an angle of its own about n_v; any coefficients at
 * all, which ring; the same of a brightness that squares cannot hold; none. */
static void light_put(float *item, int kind, double turn, uint64_t *state)
{
    lmb_sh3_rgb light = {{{{0}}}};
    const lmb_vec3 n_v = vector_get(item + IN_VERTEX_NORMAL);
    const int lamps = kind == 0 ? 1 + (int)(4.0 * variate_next(state)) : kind == 1;
    for (int i = 0; i < lamps; ++i) {
        lmb_vec3 towards = direction_of(state);
        if (kind == 1) {
            const lmb_vec3 across = lmb_vec3_unit_or(lmb_vec3_cross(n_v, towards), n_v);
            towards = lmb_vec3_mad(lmb_vec3_scale(n_v, (float)cos(turn)), across, (float)sin(turn));
        }
        const lmb_rgb colour = {{between(state, 0.1, 3.0), between(state, 0.1, 3.0), between(state, 0.1, 3.0)}};
        lmb_sh3_rgb_add_light(&light, towards, colour);
    }
    const float scale = kind == 3 ? (variate_next(state) < 0.5 ? 1e-25f : 1e25f) : 1.0f;
    for (int c = 0; c < 3; ++c) {
        light.channel[c].c[0] += kind == 0 ? between(state, 0.05, 2.0) : 0.0f;
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            light.channel[c].c[i] += kind == 2 || kind == 3 ? scale * between(state, -1.0, 1.0) : 0.0f;
            item[IN_SH + 3 * i + c] = light.channel[c].c[i];
        }
    }
}

/* Where an item's lobe is in the textures. */
static void coordinates_find(const float *item, float coordinates[2])
{
    const float c = lmb_saturate(lmb_vec3_dot(vector_get(item + IN_NORMAL), vector_get(item + IN_VIEW)));
    coordinates[0] = (0.5f + 7.0f * 0.5f * (c + sqrtf(c))) / 8.0f;
    coordinates[1] = (0.5f + 15.0f * sqrtf(lmb_saturate(item[IN_ROUGHNESS]))) / 16.0f;
}

/* Reads the textures as a graphics card does, linearly between the texels' middles, clamped at the edges. */
static void lobe_put(float *item)
{
    float texture[LMB_SPECULAR_TEXTURES][LMB_SPECULAR_ROWS][LMB_SPECULAR_COLUMNS][4], at[2];
    lmb_specular_textures(texture);
    coordinates_find(item, at);
    const float x = 8.0f * at[0] - 0.5f, y = 16.0f * at[1] - 0.5f;
    const int left = (int)floorf(x), top = (int)floorf(y);
    for (int i = 0; i < 12; ++i) {
        float sum = 0.0f;
        for (int corner = 0; corner < 4; ++corner) {
            const int column = left + corner % 2, row = top + corner / 2;
            const float share = (1.0f - fabsf(x - (float)column)) * (1.0f - fabsf(y - (float)row));
            sum += share * texture[i / 4][row < 16 ? row : 15][column < 8 ? column : 7][i % 4];
        }
        item[IN_LOBE + i] = sum;
    }
}

static void item_make(float *item, int index, uint64_t *state)
{
    vector_put(item + IN_VERTEX_NORMAL, index % 3 == 0 ? lmb_vec3_of(0.0f, 1.0f, 0.0f) : direction_of(state));
    vector_put(item + IN_NORMAL, direction_of(state));
    light_put(item, index % 5, 3.141592653589793 * index / ITEMS, state);
    item[IN_VISIBILITY] = index % 4 == 0 ? 1.0f : between(state, -0.1, 1.1);
    for (int c = 0; c < 3; ++c) {
        item[IN_TEXEL_LIGHT + c] = between(state, -0.1, 4.0);
        item[IN_ALBEDO + c] = between(state, 0.0, 1.0);
    }
    item[IN_TEXEL_WEIGHT] = between(state, -0.2, 1.2);
    vector_put(item + IN_TEXEL_DIRECTION, lmb_vec3_scale(direction_of(state), between(state, 0.0, 1.0)));
    item[IN_BENT] = between(state, 0.05, 1.0);
    vector_put(item + IN_VIEW, direction_of(state));
    item[IN_ROUGHNESS] = index % 7 == 0 ? 1.0f : between(state, 0.1, 1.1);
    for (int c = 0; c < 3; ++c) {
        item[IN_F0 + c] = between(state, 0.0, 1.0);
    }
    lobe_put(item);
}

static lmb_sh3_rgb light_get(const float *item)
{
    lmb_sh3_rgb light;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            light.channel[c].c[i] = item[IN_SH + 3 * i + c];
        }
    }
    return light;
}

static void colour_put(float *at, lmb_rgb colour)
{
    memcpy(at, colour.c, sizeof colour.c);
}

/* What the sampler makes of an item. */
static void item_expect(const float *item, float *expected)
{
    const lmb_sh3_rgb light = light_get(item);
    const lmb_vec3 n_v = vector_get(item + IN_VERTEX_NORMAL), n = vector_get(item + IN_NORMAL);
    const float cone = lmb_cone_cos_from_visibility(item[IN_VISIBILITY]);
    expected[OUT_CONE] = cone;
    expected[OUT_BENT_CONE] = lmb_cone_cos_from_bent_visibility(item[IN_VISIBILITY], item[IN_BENT]);
    colour_put(expected + OUT_SH3, lmb_sh3_rgb_irradiance(&light, n));
    const lmb_irradz encoded = lmb_irradz_encode(&light, n_v, cone);
    colour_put(expected + OUT_ENCODED_LIGHT, encoded.irradiance_z);
    expected[OUT_ENCODED_WEIGHT] = encoded.ambient_weight;
    vector_put(expected + OUT_ENCODED_DIRECTION, encoded.direction);
    const lmb_hhd_rgb probe = lmb_irradz_decode(&encoded, n_v);
    colour_put(expected + OUT_PROBE, lmb_hhd_rgb_evaluate(&probe, n_v, n));
    const lmb_irradz texel = {colour_get(item + IN_TEXEL_LIGHT), item[IN_TEXEL_WEIGHT],
                              vector_get(item + IN_TEXEL_DIRECTION)};
    const lmb_hhd_rgb surface = lmb_irradz_decode(&texel, n_v);
    colour_put(expected + OUT_TEXEL, lmb_hhd_rgb_evaluate(&surface, n_v, n));
    const lmb_hlsh_rgb hlsh = lmb_hlsh_rgb_from_sh3(&light, n_v, cone);
    for (int c = 0; c < 3; ++c) {
        expected[OUT_HLSH_LIGHT + c] = hlsh.channel[c].irradiance_z;
    }
    colour_put(expected + OUT_HLSH, lmb_hlsh_rgb_evaluate(&hlsh, n_v, n));
    colour_put(expected + OUT_TEXEL_AT_ONCE, lmb_irradz_evaluate(&texel, n_v, n));
    colour_put(expected + OUT_SELF_BOUNCE, lmb_self_bounce(colour_get(item + IN_ALBEDO), texel.irradiance_z, n_v, n));
    const lmb_key_light key = {texel.direction, texel.irradiance_z};
    colour_put(expected + OUT_KEY, lmb_key_light_irradiance(&key, item[IN_VISIBILITY], n_v, n));
    const lmb_irradz fitted = lmb_irradz_from_probe(&light, n_v, cone);
    colour_put(expected + OUT_FITTED_LIGHT, fitted.irradiance_z);
    colour_put(expected + OUT_FITTED, lmb_irradz_evaluate(&fitted, n_v, n));
    const lmb_hlsh_rgb fitted_hlsh = lmb_hlsh_rgb_from_probe(&light, n_v, cone);
    colour_put(expected + OUT_FITTED_HLSH, lmb_hlsh_rgb_evaluate(&fitted_hlsh, n_v, n));
    vector_put(expected + OUT_DISC, lmb_disc_to_direction(texel.direction.x, texel.direction.y, n_v));
    const lmb_rnm rnm = {
        {texel.irradiance_z,
         colour_get(item + IN_ALBEDO),
         {{lmb_larger(item[IN_SH], 0.0f), lmb_larger(item[IN_SH + 1], 0.0f), lmb_larger(item[IN_SH + 2], 0.0f)}}}};
    lmb_vec3 slope[LMB_RNM_SLOPES];
    lmb_rnm_slopes(n_v, slope);
    colour_put(expected + OUT_RNM, lmb_rnm_evaluate(&rnm, slope, n));
    colour_put(expected + OUT_SSBUMP, lmb_ssbump_evaluate(&rnm, colour_get(item + IN_ALBEDO)));
    lmb_sh2_rgb sh2;
    for (int c = 0; c < 3; ++c) {
        memcpy(sh2.channel[c].c, light.channel[c].c, sizeof sh2.channel[c].c);
    }
    colour_put(expected + OUT_SH2, lmb_sh2_rgb_irradiance(&sh2, n));
}

/* And of it for the eye. */
static void item_expect_specular(const float *item, float *expected)
{
    lmb_sh3_rgb light = light_get(item);
    const lmb_vec3 n_v = vector_get(item + IN_VERTEX_NORMAL), n = vector_get(item + IN_NORMAL);
    const lmb_vec3 view = vector_get(item + IN_VIEW);
    const lmb_specular specular = {item[IN_ROUGHNESS], colour_get(item + IN_F0)};
    colour_put(expected + OUT_SPECULAR_AREA, lmb_specular_area(&light, &specular, n, view));
    colour_put(expected + OUT_PHONG_AREA, lmb_specular_area_phong(&light, &specular, n, view));
    colour_put(expected + OUT_ENVIRONMENT,
               lmb_specular_environment(colour_get(item + IN_ALBEDO), &light, &specular, n, view));
    const lmb_key_light dominant = lmb_sh3_rgb_dominant_light(&light);
    colour_put(expected + OUT_DOMINANT, dominant.irradiance);
    lmb_key_light_add_to_sh3(&dominant, -1.0f, &light);
    colour_put(expected + OUT_WITHOUT_DOMINANT, lmb_sh3_rgb_irradiance(&light, n));
    const lmb_key_light key = {lmb_vec3_unit_or(vector_get(item + IN_TEXEL_DIRECTION), n_v),
                               colour_get(item + IN_TEXEL_LIGHT)};
    colour_put(expected + OUT_HIGHLIGHT, lmb_specular_light(&key, item[IN_VISIBILITY], &specular, n_v, n, view));
    colour_put(expected + OUT_PHONG, lmb_specular_light_phong(&key, item[IN_VISIBILITY], &specular, n_v, n, view));
    coordinates_find(item, expected + OUT_COORDINATES);
    light = light_get(item);
    expected[OUT_LAMP] = lmb_sh3_rgb_light_visibility(&light, &key);
    const lmb_vec3 low = vector_get(item + IN_ALBEDO), high = vector_get(item + IN_F0);
    const lmb_specular_proxy proxy = {vector_get(item + IN_TEXEL_DIRECTION),
                                      {-1.5f - low.x, -1.5f - low.y, -1.5f - low.z},
                                      {1.5f + high.x, 1.5f + high.y, 1.5f + high.z}};
    vector_put(expected + OUT_PROXY, lmb_specular_proxy_direction(&proxy, lmb_vec3_scale(view, 2.0f), n));
}

static float largest_of(const float *item)
{
    float largest = FLT_MIN;
    for (int i = 0; i < 3 * LMB_SH3_COUNT; ++i) {
        largest = fmaxf(largest, fabsf(item[IN_SH + i]));
    }
    return largest;
}

/* How far outputs may be off: floats in another order of operations, a few ulps of the largest coefficient, times what
 * the solve makes of them. */
static void item_compare(const float *item, const float *got, int index, const char *language)
{
    float expected[OUTPUTS];
    item_expect(item, expected);
    item_expect_specular(item, expected);
    const float light = largest_of(item);
    for (int i = 0; i < OUTPUTS; ++i) {
        double tolerance = 2e-6 * (double)light;
        if (i >= OUT_PHONG_AREA) {
            tolerance = 4e-6 * (double)light;
        } else if (i >= OUT_PHONG) {
            tolerance = 1e-4 * (1.0 + (double)expected[i]);
        } else if (i >= OUT_LAMP) {
            const float lamp = lmb_luminance(colour_get(item + IN_TEXEL_LIGHT));
            tolerance = 1e-5 + 4e-6 * (double)(light / fmaxf(lamp, 1e-6f));
        } else if (i >= OUT_PROXY) {
            tolerance = 1e-5;
        } else if (i >= OUT_DISC) {
            tolerance = 1e-4; /* the frame turns fast about one normal */
        } else if (i >= OUT_SH2) {
            tolerance = 2e-6 * (double)light;
        } else if (i >= OUT_RNM) {
            /* Where no slope is faced by much, a rounding of 1e-7 is a larger share of the squared cosines. */
            tolerance = 1e-3 * (double)fmaxf(light, 4.0f);
        } else if (i >= OUT_ENVIRONMENT) {
            tolerance = 4e-6 * (double)light;
        } else if (i >= OUT_COORDINATES) {
            tolerance = 2e-6;
        } else if (i >= OUT_HIGHLIGHT) {
            tolerance = 1e-4 * (1.0 + (double)expected[i]); /* a narrow lobe's exponential */
        } else if (i >= OUT_SPECULAR_AREA) {
            tolerance = 4e-6 * (double)light;
        } else if (i == OUT_CONE || i == OUT_BENT_CONE || (i >= OUT_SELF_BOUNCE && i < OUT_TEXEL_AT_ONCE) ||
                   (i >= OUT_KEY && i < OUT_FITTED_LIGHT)) {
            tolerance = 2e-6;
        } else if ((i >= OUT_TEXEL && i < OUT_HLSH_LIGHT) || (i >= OUT_TEXEL_AT_ONCE && i < OUT_KEY)) {
            tolerance = 2e-4; /* of a light of 4 from LMB_IRRADZ_MIN_COS above the horizon: of 80 */
        } else if ((i >= OUT_PROBE && i < OUT_TEXEL) || i >= OUT_FITTED_LIGHT) {
            tolerance = 1e-4 * (double)light;
        } else if (i >= OUT_ENCODED_WEIGHT && i < OUT_PROBE) {
            /* The direction of what is hardly directional, or hardly light at all, is that of the rounding. */
            const float i_z = lmb_luminance(colour_get(expected + OUT_ENCODED_LIGHT));
            const bool counts = expected[OUT_ENCODED_WEIGHT] < 0.9f && i_z > 0.01f * light;
            tolerance = counts ? 1e-3 : 3.0;
        }
        CHECK_NEAR(got[i], expected[i], tolerance, "%s: item %d, output %d, light of %g", language, index, i,
                   (double)light);
        CHECK(isfinite(got[i]), "%s: item %d, output %d", language, index, i);
    }
}

static void language_agrees(const char *path, const char *language)
{
    float *const input = malloc(sizeof *input * ITEMS * INPUTS);
    float *const output = calloc((size_t)ITEMS * OUTPUTS, sizeof *output);
    CHECK(input && output, "memory");
    uint64_t state = 18;
    for (int i = 0; i < ITEMS && input; ++i) {
        item_make(input + (size_t)i * INPUTS, i, &state);
    }
    const shader_floats in = {input, (size_t)ITEMS * INPUTS}, out = {output, (size_t)ITEMS * OUTPUTS};
    const shader_run_result result = input && output ? shader_run(path, GROUPS, NULL, &in, &out) : SHADER_FAILED;
    CHECK(result != SHADER_FAILED, "%s runs", path);
    if (result == SHADER_NO_DEVICE) {
        test_skip("no Vulkan device (Debian: mesa-vulkan-drivers)");
    }
    for (int i = 0; i < ITEMS && result == SHADER_RAN && test_failures < 20; ++i) {
        item_compare(input + (size_t)i * INPUTS, output + (size_t)i * OUTPUTS, i, language);
    }
    free(input);
    free(output);
}

static void glsl_agrees_with_the_sampler(void)
{
    language_agrees(LMB_SHADER_GLSL, "GLSL");
}

static void hlsl_agrees_with_the_sampler(void)
{
    language_agrees(LMB_SHADER_HLSL, "HLSL");
}

static const test_case cases[] = {
    {"glsl_agrees_with_the_sampler", glsl_agrees_with_the_sampler},
    {"hlsl_agrees_with_the_sampler", hlsl_agrees_with_the_sampler},
};

TEST_MAIN(cases)
