#include "bake_arguments.h"

#include <stdio.h>
#include <string.h>

#include <lambent/lightmap.h>

static void quality_set(lmb_bake_settings *settings, lmb_arguments *arguments, const char *name)
{
    if (!lmb_bake_settings_quality(settings, name)) {
        arguments_error(arguments, "--quality takes draft, medium or high, not", name);
    }
}

static void lightmap_format_set(lmb_bake_settings *settings, lmb_arguments *arguments, const char *name)
{
    if (!arguments->failed && !lmb_bake_settings_lightmap_format(settings, name)) {
        arguments_error(arguments, "--lightmap-format takes exr, ktx2, dds or ktx2-astc, not", name);
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

/* NAME[,NAME...] */
static void models_add(lmb_bake_settings *settings, lmb_arguments *arguments, const char *text)
{
    while (!arguments->failed) {
        char name[64];
        const size_t length = strcspn(text, ",");
        snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : 0), text);
        if (!lmb_bake_settings_add_model(settings, name)) {
            const char *what =
                lmb_model_for_lightmap(name) ? "--models: too many, from" : "--models: no lightmap has the model";
            arguments_error(arguments, what, name[0] != '\0' ? name : text);
        }
        if (text[length] == '\0') {
            return;
        }
        text += length + 1;
    }
}

const lmb_model *lightmap_model_named(lmb_arguments *arguments, const char *name)
{
    const lmb_model *model = arguments->failed ? NULL : lmb_model_for_lightmap(name);
    if (!arguments->failed && !model) {
        arguments_error(arguments, "--model: no lightmap has the model", name);
    }
    return model;
}

const lmb_model *lightmap_model_argument(lmb_arguments *arguments, const char *option)
{
    return lightmap_model_named(arguments, arguments_text(arguments, option));
}

bool bake_argument(lmb_bake_settings *settings, lmb_arguments *arguments, const char *argument)
{
    if (level_argument(&settings->level, arguments, argument) ||
        estimator_argument(&settings->estimator, arguments, argument)) {
        return true;
    }
    if (strcmp(argument, "--spacing") == 0) {
        settings->spacing = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--min-spacing") == 0) {
        settings->min_spacing = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--tolerance") == 0) {
        settings->tolerance = arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--placed-by-all") == 0) {
        settings->placed_by_all = true;
    } else if (strcmp(argument, "--max-probes") == 0) {
        settings->max_probes = (int32_t)arguments_integer(arguments, argument, 27, 1 << 28);
    } else if (strcmp(argument, "--seed-point") == 0) {
        seed_point_add(settings, arguments, argument);
    } else if (strcmp(argument, "--quality") == 0) {
        quality_set(settings, arguments, arguments_text(arguments, argument));
    } else if (strcmp(argument, "--samples") == 0) {
        settings->samples = (uint32_t)arguments_integer(arguments, argument, 1, 1 << 28);
        settings->max_samples = settings->samples;
    } else if (strcmp(argument, "--noise") == 0) {
        settings->noise = arguments_number(arguments, argument, 1e-6, 1.0);
    } else if (strcmp(argument, "--texels-per-m") == 0) {
        settings->texels_per_m = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--padding") == 0) {
        settings->padding = (int32_t)arguments_integer(arguments, argument, 1, LMB_LIGHTMAP_MAX_PADDING);
    } else if (strcmp(argument, "--lightmap-format") == 0) {
        lightmap_format_set(settings, arguments, arguments_text(arguments, argument));
    } else if (strcmp(argument, "--models") == 0) {
        models_add(settings, arguments, arguments_text(arguments, argument));
    } else if (strcmp(argument, "--compact") == 0) {
        settings->compact = true;
    } else if (strcmp(argument, "--tile-size") == 0) {
        settings->tile_size = arguments_number(arguments, argument, 1e-6, 1e9);
    } else if (strcmp(argument, "--texel-error") == 0) {
        settings->texel_error = true;
    } else if (strcmp(argument, "--no-denoise") == 0) {
        settings->denoise = false;
    } else if (argument[0] != '-' && !settings->level.path) {
        settings->level.path = argument;
    } else {
        return false;
    }
    return true;
}
