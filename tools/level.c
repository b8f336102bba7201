#include "level.h"

#include <string.h>

#include <lambent/environment.h>

#include "command.h"

/* Of lamps and emission. */
#define MIN_SCALE 1e-9
#define MAX_SCALE 1e9

lmb_level_options level_options_default(void)
{
    return (lmb_level_options){.gltf = {.light_scale = 1.0, .emission_scale = 1.0}, .bounces = -1};
}

static void warning_print(void *context, const char *line)
{
    const lmb_level_options *options = context;
    console_warning(line, options->quiet);
}

lmb_warnings level_warnings(const lmb_level_options *options)
{
    return (lmb_warnings){warning_print, (void *)options};
}

bool level_argument(lmb_level_arguments *level, lmb_arguments *arguments, const char *option)
{
    lmb_level_options *options = &level->options;
    if (strcmp(option, "--env") == 0) {
        options->environment = arguments_text(arguments, option);
    } else if (strcmp(option, "--exclude") == 0) {
        if (options->gltf.exclude_count == LEVEL_MAX_EXCLUDE) {
            arguments_error(arguments, "too many", option);
            return true;
        }
        level->exclude[options->gltf.exclude_count++] = arguments_text(arguments, option);
        options->gltf.exclude = level->exclude;
    } else if (strcmp(option, "--light-scale") == 0) {
        options->gltf.light_scale = arguments_number(arguments, option, MIN_SCALE, MAX_SCALE);
    } else if (strcmp(option, "--emission-scale") == 0) {
        options->gltf.emission_scale = arguments_number(arguments, option, MIN_SCALE, MAX_SCALE);
    } else if (strcmp(option, "--allow-outside-uris") == 0) {
        options->gltf.allow_outside_uris = true;
    } else if (strcmp(option, "--threads") == 0) {
        options->threads = (int)arguments_integer(arguments, option, 1, 1024);
    } else if (strcmp(option, "--isa") == 0) {
        options->isa = arguments_text(arguments, option);
    } else if (strcmp(option, "--bounces") == 0) {
        options->bounces = (int)arguments_integer(arguments, option, 0, 1000000);
    } else if (strcmp(option, "--seed") == 0) {
        options->seed = (uint64_t)arguments_integer(arguments, option, 0, INT64_MAX);
    } else if (strcmp(option, "--quiet") == 0) {
        options->quiet = true;
    } else {
        return false;
    }
    return true;
}

const char *estimator_name(lmb_estimator estimator)
{
    return estimator == ESTIMATOR_CACHED ? "cached" : "reference";
}

bool estimator_argument(lmb_estimator *estimator, lmb_arguments *arguments, const char *option)
{
    if (strcmp(option, "--estimator") != 0) {
        return false;
    }
    const char *name = arguments_text(arguments, option);
    if (strcmp(name, estimator_name(ESTIMATOR_CACHED)) == 0) {
        *estimator = ESTIMATOR_CACHED;
    } else if (strcmp(name, estimator_name(ESTIMATOR_REFERENCE)) == 0) {
        *estimator = ESTIMATOR_REFERENCE;
    } else {
        arguments_error(arguments, "--estimator takes cached or reference, not", name);
    }
    return true;
}

static lmb_result environment_open(lmb_level *opened, lmb_error *error)
{
    const lmb_level_options *options = &opened->options;
    if (options->environment) {
        return lmb_scene_set_environment(opened->scene, options->environment, error);
    }
    if (lmb_scene_has_light(opened->scene)) {
        return LMB_OK;
    }
    lmb_warn(&options->gltf.warnings,
             "%s has no light of any kind that is read; baking under a constant sky of 1 (give one with --env)",
             options->path);
    return lmb_scene_set_environment(opened->scene, "#ffffff", error);
}

lmb_result level_open(const lmb_level_options *options, lmb_level *opened, lmb_error *error)
{
    memset(opened, 0, sizeof *opened);
    opened->options = *options;
    opened->options.gltf.warnings = level_warnings(options);
    const double start = seconds_now();
    lmb_result result = lmb_gltf_load(options->path, &opened->options.gltf, &opened->scene, error);
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
    lmb_tracer_warn(opened->tracer, &opened->options.gltf.warnings);
    opened->transport = (lmb_transport){
        .tracer = opened->tracer, .emitters = opened->emitters, .bounces = options->bounces, .seed = options->seed};
    return LMB_OK;
}

void level_close(lmb_level *closed)
{
    lmb_pool_destroy(closed->pool);
    lmb_surface_light_destroy(closed->surface);
    lmb_emitters_destroy(closed->emitters);
    lmb_tracer_destroy(closed->tracer);
    lmb_scene_destroy(closed->scene);
    memset(closed, 0, sizeof *closed);
}

lmb_result level_solve(lmb_level *level, lmb_estimator estimator, const lmb_progress *progress, lmb_error *error)
{
    lmb_surface_light_destroy(level->surface);
    level->surface = NULL;
    level->transport.surface = NULL;
    if (estimator == ESTIMATOR_REFERENCE) {
        return LMB_OK;
    }
    const double start = seconds_now();
    const lmb_surface_light_settings settings = lmb_surface_light_settings_default();
    const lmb_result result = lmb_surface_light_solve(&level->transport, &settings, level->pool, progress,
                                                      &level->surface, &level->surface_stats, error);
    level->transport.surface = level->surface;
    level->seconds_surface = seconds_now() - start;
    if (result == LMB_OK) {
        level->mean_light = lmb_surface_light_mean(level->surface, level->tracer);
    }
    if (result != LMB_ERROR_UNSUPPORTED) {
        return result;
    }
    lmb_warn(&level->options.gltf.warnings, "%s; tracing every path to its end", error->message);
    return LMB_OK;
}
