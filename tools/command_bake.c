#include <stdio.h>
#include <string.h>

#include "bake_arguments.h"
#include "bake_command.h"

static const char usage[] =
    "usage: lambent bake LEVEL -o DIR [options]\n"
    "\n"
    "Bakes LEVEL (.gltf or .glb) into DIR: probes.vdb for other tools, probes.lmb for the game, lightmap/ with\n"
    "--lightmaps, and bake.json, the record of it.\n"
    "\n"
    "  -o DIR                where to write\n"
    "  --lightmaps           bake lightmaps too\n"
    "  --no-probes           lightmaps alone\n"
    "  --dry-run             print the number of probes and texels and the expected time, bake nothing\n"
    "  --resume              go on from what a bake into DIR that was cut off has left there\n"
    "  --force               bake even where DIR holds this very bake\n"
    "  --shard K/N           gather the K-th of N shares alone, for lambent merge\n"
    "  --light-sets NAME,... the lights of each of these sets ('base': those that name none; 'all': all sets that\n"
    "                        give light), into DIR/NAME each, by one placement of probes and one layout\n"
    "  --json-progress       progress, warnings and the result or error as JSON lines on standard output\n" BAKE_USAGE
        LEVEL_USAGE;

/* K/N */
static void shard_read(lmb_bake_work *work, lmb_arguments *arguments, const char *option)
{
    const char *const text = arguments_text(arguments, option);
    unsigned shard, count;
    int end = -1;
    if (!text || sscanf(text, "%6u/%6u%n", &shard, &count, &end) != 2 || text[end] != '\0' || shard < 1 ||
        shard > count) {
        arguments_error(arguments, "--shard takes K/N, 1 <= K <= N, not", text ? text : "");
        return;
    }
    work->shard = shard - 1;
    work->shard_count = count;
}

static bool option_take(bake_options *options, lmb_arguments *arguments, const char *argument)
{
    if (strcmp(argument, "-o") == 0) {
        options->directory = arguments_text(arguments, argument);
    } else if (strcmp(argument, "--lightmaps") == 0) {
        options->settings.lightmaps = true;
    } else if (strcmp(argument, "--no-probes") == 0) {
        options->settings.no_probes = true;
    } else if (strcmp(argument, "--dry-run") == 0) {
        options->dry_run = true;
    } else if (strcmp(argument, "--resume") == 0) {
        options->work.resume = true;
    } else if (strcmp(argument, "--force") == 0) {
        options->work.again = true;
    } else if (strcmp(argument, "--shard") == 0) {
        shard_read(&options->work, arguments, argument);
    } else if (strcmp(argument, "--light-sets") == 0) {
        options->light_sets = arguments_text(arguments, argument);
    } else if (strcmp(argument, "--json-progress") == 0) {
        options->json_progress = true;
    } else {
        return bake_argument(&options->settings, arguments, argument);
    }
    return true;
}

/* Reads the command line. False: a usage error was printed, or --help. */
static bool options_read(bake_options *options, lmb_arguments *arguments)
{
    for (const char *argument; (argument = arguments_next(arguments));) {
        if (!option_take(options, arguments, argument)) {
            arguments_error(arguments, "unexpected argument", argument);
        }
    }
    options->quiet = arguments->quiet;
    if (arguments->failed || arguments->help) {
        return false;
    }
    if (!options->settings.level.path) {
        arguments_error(arguments, "missing argument", "LEVEL");
    } else if (options->settings.no_probes && !options->settings.lightmaps) {
        arguments_error(arguments, "--lightmaps has to go with", "--no-probes");
    } else if (options->light_sets && (options->settings.level.light_set || options->dry_run)) {
        arguments_error(arguments, "--light-sets does not go with", options->dry_run ? "--dry-run" : "--light-set");
    } else if (!options->directory && !options->dry_run) {
        arguments_error(arguments, "missing option", "-o DIR");
    }
    return !arguments->failed;
}

int command_bake(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "bake", usage);
    bake_options options = {.settings = lmb_bake_settings_default()};
    if (!options_read(&options, &arguments)) {
        return arguments_status(&arguments);
    }
    return bake_command_run(&options);
}
