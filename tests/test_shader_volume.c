/* Volumes sampled by shaders, GLSL and HLSL, beside the library: of several levels, with cut cells, in both forms. */
#include "harness.h"
#include "levels_fixture.h"
#include "shader_runner.h"
#include "shader_volume_fixture.h"

#include <lambent/volume.h>

enum { POSITIONS = 4096, WORDS_BEFORE = 32 + 3 * POSITIONS, OUTPUTS = 32 };

/* Of light, whose probes hold -1 to 1. */
#define TOLERANCE 2e-4

/* By the shader whose path is given. */
static bool volume_check(const lmb_volume *volume, const void *path, const char *name)
{
    const double spacing = (double)lmb_volume_get_info(volume).spacing;
    const lmb_vec3d world_origin = {3.0, -7.0, 11.0};
    const lmb_volume_gpu gpu = lmb_volume_get_gpu(volume, world_origin);
    const size_t words = gpu.bytes / sizeof(float);
    float *const input = calloc(WORDS_BEFORE + words, sizeof *input);
    float *const output = calloc((size_t)POSITIONS * OUTPUTS, sizeof *output);
    if (!input || !output) {
        abort();
    }
    const uint32_t count = POSITIONS;
    uint64_t state = 4;
    memcpy(input, &gpu.constants, sizeof gpu.constants);
    memcpy(input + 28, &count, sizeof count);
    for (int i = 0; i < POSITIONS; ++i) {
        shader_position_put(volume, world_origin, &state, input + 32 + 3 * i);
    }
    memcpy(input + WORDS_BEFORE, gpu.words, words * sizeof *input);
    const shader_floats in = {input, WORDS_BEFORE + words}, out = {output, (size_t)POSITIONS * OUTPUTS};
    const shader_run_result result = shader_run(path, POSITIONS / 64, NULL, &in, &out);
    CHECK(result != SHADER_FAILED, "%s runs", (const char *)path);
    int inside = 0;
    for (int i = 0; i < POSITIONS && result == SHADER_RAN && test_failures < 20; ++i) {
        const float *const p = input + 32 + 3 * i;
        const lmb_vec3d at = {(double)p[0] + world_origin.x, (double)p[1] + world_origin.y,
                              (double)p[2] + world_origin.z};
        inside += output[(size_t)i * OUTPUTS] != 0.0f;
        const shader_tolerance tolerance = {2.0 * (double)gpu.constants.slack * spacing, TOLERANCE, TOLERANCE};
        CHECK(shader_agrees(volume, at, &tolerance, output + (size_t)i * OUTPUTS), "%s at (%g, %g, %g)", name, at.x,
              at.y, at.z);
    }
    CHECK(result != SHADER_RAN || test_failures > 0 || inside > POSITIONS / 4, "%s: %d inside", name, inside);
    free(input);
    free(output);
    return result != SHADER_NO_DEVICE;
}

static void glsl_samples_as_the_library(void)
{
    shader_volumes_check(volume_check, LMB_SHADER_GLSL);
}

static void hlsl_samples_as_the_library(void)
{
    shader_volumes_check(volume_check, LMB_SHADER_HLSL);
}

static const test_case cases[] = {
    {"glsl_samples_as_the_library", glsl_samples_as_the_library},
    {"hlsl_samples_as_the_library", hlsl_samples_as_the_library},
};
TEST_MAIN(cases)
