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

/* A compressed texture: level by level, in each layer by layer. Or one of three dimensions, of any format. */
typedef struct shader_texture {
    int format; /* VkFormat */
    unsigned width, height, layers, levels;
    unsigned depth; /* 0: an array of layers; else layers and levels are 1 */
    const void *data;
    size_t size;
    const size_t *level_start; /* [level] */
} shader_texture;

typedef struct shader_floats {
    float *value;
    size_t count;
} shader_floats;

/* Runs `groups` work groups of the SPIR-V in file `path`, whose entry point is "main" and whose storage buffers 0 and 1
 * of set 0 are `input` and `output`. `texture` (NULL: none) is its combined image sampler 2, filtered
 * linearly within a level; without a device that can sample it there is no Vulkan. */
shader_run_result shader_run(const char *path, unsigned groups, const shader_texture *texture,
                             const shader_floats *input, const shader_floats *output);

#endif
