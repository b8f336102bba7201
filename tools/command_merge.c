#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

#include "bake_command.h"
#include "command.h"

static const char usage[] =
    "usage: lambent merge DIR... -o DIR [options]\n"
    "\n"
    "Puts the shares of a bake together that lambent bake --shard gathered, one folder each, into the bytes that one\n"
    "bake of all would have made. The level is read again, by the path that the first share names.\n"
    "\n"
    "  -o DIR                where to write\n"
    "  --level LEVEL         the level, where it lies elsewhere now\n"
    "  --prepared FROM       a folder where lambent bake --prepare has left what comes before gathering\n"
    "  --keep-gathered       leave what was gathered in DIR too, for lambent bake --only\n"
    "  --threads N           threads (default: one for each processor)\n"
    "  --json-progress       progress, warnings and the result or error as JSON lines on standard output\n"
    "  --quiet               no progress and no closing lines\n";

typedef struct merge_options {
    lmb_shared_arguments shared; /* the shares' folders, and the one that is written */
    const char *level, *prepared;
    bool keep;
    bake_options bake;
} merge_options;

/* Reads the command line. False: a usage error was printed, or --help. */
static bool options_read(merge_options *options, lmb_arguments *arguments)
{
    for (const char *argument; (argument = arguments_next(arguments));) {
        if (strcmp(argument, "--level") == 0) {
            options->level = arguments_text(arguments, argument);
        } else if (strcmp(argument, "--prepared") == 0) {
            options->prepared = arguments_text(arguments, argument);
        } else if (strcmp(argument, "--keep-gathered") == 0) {
            options->keep = true;
        } else if (strcmp(argument, "--json-progress") == 0) {
            options->bake.json_progress = true;
        } else {
            arguments_shared(arguments, argument, &options->shared);
        }
    }
    return arguments_complete(arguments, &options->shared);
}

static int merge_run(merge_options *options)
{
    lmb_error error = {{0}};
    cJSON *json;
    const lmb_shared_arguments *const shared = &options->shared;
    lmb_bake_settings *const settings = &options->bake.settings;
    const lmb_result result = lmb_bake_shard_settings(shared->many[0], &json, settings, &error);
    if (result != LMB_OK) {
        return command_fail(result, &error);
    }
    settings->level.path = options->level ? options->level : settings->level.path;
    settings->level.threads = shared->threads;
    options->bake.directory = shared->output;
    options->bake.quiet = shared->quiet;
    options->bake.work = (lmb_bake_work){.from = shared->many,
                                         .from_count = shared->many_count,
                                         .merge = true,
                                         .prepared = options->prepared,
                                         .keep = options->keep};
    const int status = bake_command_run(&options->bake);
    cJSON_Delete(json);
    return status;
}

int command_merge(int count, char **values)
{
    lmb_arguments arguments = arguments_begin(count, values, "merge", usage);
    const char **const from = calloc((size_t)count + 1, sizeof *from);
    if (!from) {
        return command_fail(LMB_ERROR_MEMORY, &(lmb_error){"out of memory"});
    }
    merge_options options = {
        .shared = {
            .many_name = "DIR", .many = from, .output_name = "DIR", .takes = ARGUMENTS_THREADS | ARGUMENTS_QUIET}};
    const int status = options_read(&options, &arguments) ? merge_run(&options) : arguments_status(&arguments);
    free(from);
    return status;
}
