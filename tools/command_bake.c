#include <stdio.h>
#include <string.h>

#include "bake_run.h"
#include "command.h"

static const char usage[] =
    "usage: lambent bake LEVEL -o DIR [options]\n"
    "\n"
    "Bakes LEVEL (.gltf or .glb) into DIR: probes.vdb for other tools, probes.lmb for the game, lightmap/ with\n"
    "--lightmaps, and bake.json, the record of it.\n"
    "\n"
    "  -o DIR                where to write\n"
    "  --spacing M           metres between probes (default: from the level's size)\n"
    "  --max-probes N        the spacing grows until there are no more (default 262144)\n"
    "  --seed-point X,Y,Z    bake only free space connected to this point (repeatable)\n"
    "  --quality NAME        draft, medium or high: 64, 256 or 1024 samples (default medium)\n"
    "  --samples N           samples at each probe and texel, in place of --quality\n"
    "  --estimator NAME      cached: solve the light on surfaces first, then gather it (default);\n"
    "                        reference: trace every path to its end, unbiased and slower\n"
    "  --lightmaps           bake lightmaps too\n"
    "  --texels-per-m N      lightmap density (default: from the level's size)\n"
    "  --dry-run             print the number of probes and texels and the expected time, bake nothing\n"
    "  --json-progress       progress as JSON lines on standard output\n" LEVEL_USAGE;

static void quality_set(lmb_bake_settings *settings, lmb_arguments *arguments, const char *name)
{
    static const struct {
        const char *name;
        uint32_t samples;
    } qualities[] = {{"draft", 64}, {"medium", 256}, {"high", 1024}};
    for (size_t i = 0; i < sizeof qualities / sizeof qualities[0]; ++i) {
        if (strcmp(name, qualities[i].name) == 0) {
            settings->samples = qualities[i].samples;
            return;
        }
    }
    arguments_error(arguments, "--quality takes draft, medium or high, not", name);
}

static void seed_point_add(lmb_bake_settings *settings, lmb_arguments *arguments, const char *option)
{
    if (settings->placement.seed_count == BAKE_MAX_SEEDS) {
        arguments_error(arguments, "too many", option);
        return;
    }
    settings->seeds[settings->placement.seed_count++] = arguments_vector(arguments, option);
    settings->placement.seeds = settings->seeds;
}

static bool bake_argument(lmb_bake_settings *settings, lmb_arguments *arguments, const char *argument)
{
    if (level_argument(&settings->level, arguments, argument) ||
        estimator_argument(&settings->estimator, arguments, argument)) {
        return true;
    }
    if (strcmp(argument, "-o") == 0) {
        settings->directory = arguments_text(arguments, argument);
    } else if (strcmp(argument, "--spacing") == 0) {
        settings->placement.spacing = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--max-probes") == 0) {
        settings->placement.max_probes = (int32_t)arguments_integer(arguments, argument, 27, 1 << 28);
    } else if (strcmp(argument, "--seed-point") == 0) {
        seed_point_add(settings, arguments, argument);
    } else if (strcmp(argument, "--quality") == 0) {
        quality_set(settings, arguments, arguments_text(arguments, argument));
    } else if (strcmp(argument, "--samples") == 0) {
        settings->samples = (uint32_t)arguments_integer(arguments, argument, 1, 1 << 28);
    } else if (strcmp(argument, "--lightmaps") == 0) {
        settings->lightmaps = true;
    } else if (strcmp(argument, "--texels-per-m") == 0) {
        settings->texels_per_m = (float)arguments_number(arguments, argument, 1e-6, 1e6);
    } else if (strcmp(argument, "--dry-run") == 0) {
        settings->dry_run = true;
    } else if (strcmp(argument, "--json-progress") == 0) {
        settings->json_progress = true;
    } else if (argument[0] != '-' && !settings->level.options.path) {
        settings->level.options.path = argument;
    } else {
        return false;
    }
    return true;
}

int command_bake(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "bake", usage);
    lmb_bake_settings settings = {
        .level = {.options = level_options_default()}, .placement = lmb_placement_settings_default(), .samples = 256};
    for (const char *argument; (argument = arguments_next(&arguments));) {
        if (!bake_argument(&settings, &arguments, argument)) {
            arguments_error(&arguments, "unexpected argument", argument);
        }
    }
    if (!arguments.failed && !arguments.help && !settings.level.options.path) {
        arguments_error(&arguments, "missing argument", "LEVEL");
    } else if (!arguments.failed && !arguments.help && !settings.directory && !settings.dry_run) {
        arguments_error(&arguments, "missing option", "-o DIR");
    }
    if (arguments.failed || arguments.help) {
        return arguments_status(&arguments);
    }

    lmb_error error = {{0}};
    lmb_level level;
    lmb_result result = level_open(&settings.level.options, &level, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    lmb_console console;
    const lmb_progress progress = console_progress(&console, settings.level.options.quiet, settings.json_progress);
    result = bake_run(&settings, &level, &progress, &error);
    console_finish(&console);
    level_close(&level);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
