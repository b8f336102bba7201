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
    "  --keep-gathered       leave what was gathered in DIR too, for --only: 400 bytes a probe or texel\n"
    "  --only X0,Y0,Z0,X1,Y1,Z1\n"
    "                        gather anew what lies between these corners, and take all else from what the bake in DIR\n"
    "                        has kept\n"
    "  --prepare             place probes and solve the light on surfaces alone, and leave them in DIR\n"
    "  --prepared FROM       take them from the folder where --prepare has left them for this bake\n"
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
    if (strcmp(argument, "--lightmaps") == 0) {
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
    } else if (strcmp(argument, "--keep-gathered") == 0) {
        options->work.keep = true;
    } else if (strcmp(argument, "--only") == 0) {
        arguments_box(arguments, argument, options->only);
        options->work.only = options->only;
    } else if (strcmp(argument, "--prepare") == 0) {
        options->work.prepare = true;
    } else if (strcmp(argument, "--prepared") == 0) {
        options->work.prepared = arguments_text(arguments, argument);
    } else if (strcmp(argument, "--light-sets") == 0) {
        options->light_sets = arguments_text(arguments, argument);
    } else if (strcmp(argument, "--json-progress") == 0) {
        options->json_progress = true;
    } else {
        return bake_argument(&options->settings, arguments, argument);
    }
    return true;
}

/* Options of which one alone may be given. */
static void pairs_check(const bake_options *options, lmb_arguments *arguments)
{
    const lmb_bake_work *const work = &options->work;
    const bool shard = work->shard_count > 0;
    const bool sets = options->light_sets != NULL;
    const struct {
        bool both;
        const char *text, *option;
    } pairs[] = {
        {work->prepare && work->prepared, "--prepared does not go with", "--prepare"},
        {work->prepare && shard, "--shard does not go with", "--prepare"},
        {work->prepare && work->only, "--only does not go with", "--prepare"},
        {work->only && shard, "--shard does not go with", "--only"},
        {work->only && options->dry_run, "--dry-run does not go with", "--only"},
        {work->keep && shard, "it is lambent merge that takes", "--keep-gathered"},
        {sets && work->prepare, "--light-sets does not go with", "--prepare"},
        {sets && work->prepared, "--light-sets does not go with", "--prepared"},
        {sets && work->only, "--light-sets does not go with", "--only"},
        {sets && work->keep, "--light-sets does not go with", "--keep-gathered"},
        {sets && options->settings.level.light_set, "--light-sets does not go with", "--light-set"},
        {sets && options->dry_run, "--light-sets does not go with", "--dry-run"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0] && !arguments->failed; ++i) {
        if (pairs[i].both) {
            arguments_error(arguments, pairs[i].text, pairs[i].option);
        }
    }
}

/* Reads the command line. False: a usage error was printed, or --help. */
static bool options_read(bake_options *options, lmb_arguments *arguments)
{
    lmb_shared_arguments shared = {.output_name = "DIR"};
    for (const char *argument; (argument = arguments_next(arguments));) {
        if (!option_take(options, arguments, argument)) {
            arguments_shared(arguments, argument, &shared);
        }
    }
    options->quiet = arguments->quiet;
    options->directory = shared.output;
    if (arguments->failed || arguments->help) {
        return false;
    }
    if (!options->settings.level.path) {
        arguments_error(arguments, "missing argument", "LEVEL");
    } else if (options->settings.no_probes && !options->settings.lightmaps) {
        arguments_error(arguments, "--lightmaps has to go with", "--no-probes");
    } else if (!options->dry_run) {
        arguments_complete(arguments, &shared);
    }
    pairs_check(options, arguments);
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
