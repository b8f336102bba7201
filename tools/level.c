#include "level.h"

#include <stdio.h>
#include <string.h>

#include "command.h"

level_options level_options_default(void)
{
    return (level_options){.bounces = -1};
}

static lmb_result environment_open(level *opened, lmb_error *error)
{
    const level_options *options = &opened->options;
    if (options->environment) {
        return lmb_scene_set_environment(opened->scene, options->environment, error);
    }
    if (lmb_scene_has_light(opened->scene)) {
        return LMB_OK;
    }
    if (!options->quiet) {
        fprintf(stderr, "lambent: warning: %s has no light of any kind; baking under a constant sky of 1 "
                        "(give one with --env)\n",
                options->path);
    }
    return lmb_scene_set_environment(opened->scene, "#ffffff", error);
}

lmb_result level_open(const level_options *options, level *opened, lmb_error *error)
{
    memset(opened, 0, sizeof *opened);
    opened->options = *options;
    const double start = seconds_now();
    lmb_result result = lmb_gltf_load(options->path, &options->gltf, &opened->scene, error);
    if (result == LMB_OK) {
        result = environment_open(opened, error);
    }
    const double loaded = seconds_now();
    opened->seconds_load = loaded - start;
    if (result == LMB_OK) {
        result = lmb_tracer_create(opened->scene, options->isa, options->threads, &opened->tracer, error);
    }
    if (result == LMB_OK && (lmb_emitters_create(opened->tracer, &opened->emitters) != LMB_OK ||
                             lmb_pool_create(options->threads, &opened->pool) != LMB_OK)) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    opened->seconds_bvh = seconds_now() - loaded;
    if (result != LMB_OK) {
        level_close(opened);
        return result;
    }
    opened->transport = (lmb_transport){.tracer = opened->tracer,
                                        .emitters = opened->emitters,
                                        .bounces = options->bounces,
                                        .seed = options->seed};
    return LMB_OK;
}

void level_close(level *closed)
{
    lmb_pool_destroy(closed->pool);
    lmb_emitters_destroy(closed->emitters);
    lmb_tracer_destroy(closed->tracer);
    lmb_scene_destroy(closed->scene);
    memset(closed, 0, sizeof *closed);
}
