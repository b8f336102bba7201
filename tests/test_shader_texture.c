/* Volumes in 3D textures, sampled by shaders, GLSL and HLSL, beside the library: filtered by the sampler, and texel by
 * texel. */
#include "harness.h"
#include "levels_fixture.h"
#include "shader_runner.h"
#include "shader_volume_fixture.h"

#include <lambent/volume_texture.h>

enum { POSITIONS = 4096, WORDS_BEFORE = 32 + 3 * POSITIONS, OUTPUTS = 32, RGBA16F = 97 /* VkFormat */ };

/* A shader, and how far it may be off where probes hold -1 to 1, and 0 to 1 of key lights. */
typedef struct shader_case {
    const char *path, *name;
    double light, visibility;
} shader_case;

/* Filters weigh in 256ths, rounded to the nearest: of each axis 1/512 of what two probes differ by. */
#define FILTERED (3.0 / 512.0)
#define ROUNDED 2e-4

/* To the nearest half, of numbers below 2. */
#define COMPACT_ROUNDED 0x1p-11

static const shader_case shader_cases[] = {
    {LMB_SHADER_FETCH_GLSL, "GLSL, fetched", ROUNDED, ROUNDED},
    {LMB_SHADER_FETCH_HLSL, "HLSL, fetched", ROUNDED, ROUNDED},
    {LMB_SHADER_FILTER_GLSL, "GLSL, filtered", 2.0 * FILTERED + ROUNDED, FILTERED + ROUNDED},
    {LMB_SHADER_FILTER_HLSL, "HLSL, filtered", 2.0 * FILTERED + ROUNDED, FILTERED + ROUNDED},
};

/* What a shader gets, and where it writes. */
typedef struct shader_data {
    lmb_volume_texture_layout layout;
    lmb_volume_texture_constants constants;
    uint16_t *texels;
    float *input, *output;
} shader_data;

static const lmb_vec3d world_origin = {3.0, -7.0, 11.0};

static shader_data data_make(const lmb_volume *volume)
{
    const lmb_volume_texture_def def = lmb_volume_texture_default();
    shader_data made = {.texels = NULL};
    const lmb_result result = lmb_volume_texture_size(volume, &def, &made.layout);
    CHECK(result == LMB_OK, "%s", lmb_result_text(result));
    made.constants = lmb_volume_texture_get_constants(volume, &made.layout, world_origin);
    made.texels = malloc((size_t)made.layout.texture_bytes);
    made.input = calloc(WORDS_BEFORE + made.layout.word_count, sizeof *made.input);
    made.output = calloc((size_t)POSITIONS * OUTPUTS, sizeof *made.output);
    if (!made.texels || !made.input || !made.output) {
        abort();
    }
    const uint32_t count = POSITIONS;
    uint64_t state = 4;
    memcpy(made.input, &made.constants, sizeof made.constants);
    memcpy(made.input + 28, &count, sizeof count);
    for (int i = 0; i < POSITIONS; ++i) {
        shader_position_put(volume, world_origin, &state, made.input + 32 + 3 * i);
    }
    lmb_volume_texture_fill(volume, &made.layout, made.texels, (uint32_t *)(made.input + WORDS_BEFORE));
    return made;
}

static void data_destroy(shader_data *made)
{
    free(made->texels);
    free(made->input);
    free(made->output);
}

static void output_check(const lmb_volume *volume, const shader_data *data, const shader_case *of, const char *name)
{
    const double spacing = (double)lmb_volume_get_info(volume).spacing;
    const double rounded = lmb_volume_get_info(volume).is_compact ? COMPACT_ROUNDED : 0.0;
    const shader_tolerance tolerance = {2.0 * (double)data->constants.slack * spacing, of->light + rounded,
                                        of->visibility};
    int inside = 0;
    for (int i = 0; i < POSITIONS && test_failures < 20; ++i) {
        const float *const p = data->input + 32 + 3 * i;
        const lmb_vec3d at = {(double)p[0] + world_origin.x, (double)p[1] + world_origin.y,
                              (double)p[2] + world_origin.z};
        inside += data->output[(size_t)i * OUTPUTS] != 0.0f;
        CHECK(shader_agrees(volume, at, &tolerance, data->output + (size_t)i * OUTPUTS), "%s, %s at (%g, %g, %g)",
              of->name, name, at.x, at.y, at.z);
    }
    CHECK(test_failures > 0 || inside > POSITIONS / 4, "%s, %s: %d inside", of->name, name, inside);
}

static bool volume_check(const lmb_volume *volume, const void *context, const char *name)
{
    const shader_case *const of = context;
    shader_data data = data_make(volume);
    const size_t level_start = 0;
    const shader_texture texture = {.format = RGBA16F,
                                    .width = data.layout.width,
                                    .height = data.layout.height,
                                    .depth = data.layout.depth * data.layout.parts,
                                    .layers = 1,
                                    .levels = 1,
                                    .data = data.texels,
                                    .size = (size_t)data.layout.texture_bytes,
                                    .level_start = &level_start};
    const shader_floats in = {data.input, WORDS_BEFORE + data.layout.word_count},
                        out = {data.output, (size_t)POSITIONS * OUTPUTS};
    const shader_run_result result = shader_run(of->path, POSITIONS / 64, &texture, &in, &out);
    CHECK(result != SHADER_FAILED, "%s runs", of->path);
    if (result == SHADER_RAN) {
        output_check(volume, &data, of, name);
    }
    data_destroy(&data);
    return result != SHADER_NO_DEVICE;
}

static void glsl_fetches_the_library(void)
{
    shader_volumes_check(volume_check, &shader_cases[0]);
}

static void hlsl_fetches_the_library(void)
{
    shader_volumes_check(volume_check, &shader_cases[1]);
}

static void glsl_filters_near_the_library(void)
{
    shader_volumes_check(volume_check, &shader_cases[2]);
}

static void hlsl_filters_near_the_library(void)
{
    shader_volumes_check(volume_check, &shader_cases[3]);
}

static const test_case cases[] = {
    {"glsl_fetches_the_library", glsl_fetches_the_library},
    {"hlsl_fetches_the_library", hlsl_fetches_the_library},
    {"glsl_filters_near_the_library", glsl_filters_near_the_library},
    {"hlsl_filters_near_the_library", hlsl_filters_near_the_library},
};
TEST_MAIN(cases)
