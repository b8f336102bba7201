/* Runs a compute shader on this machine's Vulkan, which Mesa makes on the processor where there is no other. */
#ifndef LMB_TESTS_SHADER_RUNNER_H
#define LMB_TESTS_SHADER_RUNNER_H

#include <stdbool.h>
#include <stddef.h>

typedef enum shader_run_result {
    SHADER_RAN,
    SHADER_NO_DEVICE, /* there is no Vulkan here */
    SHADER_FAILED
} shader_run_result;

/* Runs `groups` work groups of the SPIR-V in file `path`, whose entry point is "main" and whose storage buffers 0 and 1
 * of set 0 are `input` and `output`, so many floats each. */
shader_run_result shader_run(const char *path, unsigned groups, const float *input, size_t input_count, float *output,
                             size_t output_count);

#endif
