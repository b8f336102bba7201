#include "bake_arguments.h"

#include <string.h>

#include <lambent/lightmap.h>

static void quality_set(lmb_bake_settings *settings, lmb_arguments *arguments, const char *name)
{
    if (!lmb_bake_settings_quality(settings, name)) {
        arguments_error(arguments, "--quality takes draft, medium or high, not", name);
    }
}

static void seed_point_add(lmb_bake_settings *settings, lmb_arguments *arguments, const char *option)
{
    if (settings->seed_count == LMB_BAKE_MAX_SEEDS) {
        arguments_error(arguments, "too many", option);
        return;
    }
    settings->seeds[settings->seed_count++] = arguments_position(arguments, option);
}

bool bake_argument(lmb_bake_settings *settings, lmb_arguments *arguments, const char *argument)
{
    if (level_argument(&settings->level, arguments, argument) ||
        estimator_argument(&settings->estimator, arguments, argument)) {
        return true;
    }
    if (strcmp(argument, "--spacing") == 0) {
        settings->spacing = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--max-probes") == 0) {
        settings->max_probes = (int32_t)arguments_integer(arguments, argument, 27, 1 << 28);
    } else if (strcmp(argument, "--seed-point") == 0) {
        seed_point_add(settings, arguments, argument);
    } else if (strcmp(argument, "--quality") == 0) {
        quality_set(settings, arguments, arguments_text(arguments, argument));
    } else if (strcmp(argument, "--samples") == 0) {
        settings->samples = (uint32_t)arguments_integer(arguments, argument, 1, 1 << 28);
        settings->max_samples = settings->samples;
    } else if (strcmp(argument, "--tolerance") == 0) {
        settings->tolerance = arguments_number(arguments, argument, 1e-6, 1.0);
    } else if (strcmp(argument, "--texels-per-m") == 0) {
        settings->texels_per_m = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--padding") == 0) {
        settings->padding = (int32_t)arguments_integer(arguments, argument, 1, LMB_LIGHTMAP_MAX_PADDING);
    } else if (strcmp(argument, "--no-denoise") == 0) {
        settings->denoise = false;
    } else if (argument[0] != '-' && !settings->level.path) {
        settings->level.path = argument;
    } else {
        return false;
    }
    return true;
}
