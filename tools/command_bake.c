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
    "  --lightmaps           bake lightmaps too\n"
    "  --dry-run             print the number of probes and texels and the expected time, bake nothing\n"
    "  --json-progress       progress, warnings and the result or error as JSON lines on standard output\n" BAKE_USAGE
        LEVEL_USAGE;

static bool bake_argument(lmb_bake_settings *settings, lmb_arguments *arguments, const char *argument)
{
    if (strcmp(argument, "-o") == 0) {
        settings->directory = arguments_text(arguments, argument);
    } else if (strcmp(argument, "--lightmaps") == 0) {
        settings->lightmaps = true;
    } else if (strcmp(argument, "--dry-run") == 0) {
        settings->dry_run = true;
    } else if (strcmp(argument, "--json-progress") == 0) {
        settings->json_progress = true;
    } else {
        return bake_settings_argument(settings, arguments, argument);
    }
    return true;
}

static lmb_result level_bake(const lmb_bake_settings *settings, lmb_output_folder *folder, lmb_console *console,
                             const lmb_progress *progress, lmb_error *error)
{
    lmb_level level;
    lmb_result result = level_open(&settings->level.options, &level, error);
    if (result != LMB_OK) {
        return result;
    }
    lmb_forecast forecast = {0};
    console->forecast = &forecast;
    result = bake_run(settings, &level, folder, progress, &forecast, error);
    console_finish(console);
    console->forecast = NULL;
    level_close(&level);
    return result;
}

/* The folder comes first: one that cannot be written is found at once. */
static lmb_result bake_into_folder(const lmb_bake_settings *settings, lmb_console *console,
                                   const lmb_progress *progress, lmb_error *error)
{
    lmb_output_folder *folder = NULL;
    lmb_result result = LMB_OK;
    if (!settings->dry_run) {
        result = output_folder_open(settings->directory, settings->lightmaps, &folder, error);
    }
    if (result == LMB_OK) {
        result = level_bake(settings, folder, console, progress, error);
    }
    output_folder_close(folder);
    return result;
}

int command_bake(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "bake", usage);
    lmb_bake_settings settings = bake_settings_default();
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

    lmb_console console;
    const lmb_progress progress = console_progress(&console, settings.level.options.quiet, settings.json_progress);
    lmb_error error = {{0}};
    if (settings.max_samples == settings.samples) {
        samples_say_rounded(settings.samples, LMB_GATHER_REPLICATES, settings.level.options.quiet);
    }
    const lmb_result result = bake_into_folder(&settings, &console, &progress, &error);
    return result == LMB_OK ? EXIT_DONE : command_fail(result, &error);
}
