#include "command.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

lmb_arguments arguments_begin(int count, char **values, const char *command, const char *usage)
{
    return (lmb_arguments){.count = count, .values = values, .command = command, .usage = usage};
}

void arguments_error(lmb_arguments *arguments, const char *what, const char *argument)
{
    fprintf(stderr, "lambent %s: %s %s (see: lambent %s --help)\n", arguments->command, what, argument,
            arguments->command);
    arguments->failed = true;
}

/* A path that begins with a dash, so that nobody takes it for an option. It lives as long as the process. */
static const char *path_of_dashed(lmb_arguments *arguments, char *path)
{
    static char *paths[8];
    static size_t count;
    const size_t size = strlen(path) + 3;
    char *const made = path[0] == '-' && count < sizeof paths / sizeof paths[0] ? malloc(size) : NULL;
    if (!made) {
        if (path[0] == '-') {
            arguments_error(arguments, "one argument too many:", path);
        }
        return path;
    }
    snprintf(made, size, "./%s", path);
    return paths[count++] = made;
}

const char *arguments_next(lmb_arguments *arguments)
{
    if (arguments->value && !arguments->failed) {
        arguments_error(arguments, "no value goes with", arguments->option);
    }
    if (!arguments->failed && !arguments->only_positional && arguments->at < arguments->count &&
        strcmp(arguments->values[arguments->at], "--") == 0) {
        arguments->only_positional = true;
        ++arguments->at;
    }
    if (arguments->failed || arguments->at >= arguments->count) {
        return NULL;
    }
    char *argument = arguments->values[arguments->at++];
    if (arguments->only_positional) {
        return path_of_dashed(arguments, argument);
    }
    if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) {
        console_print(arguments->usage);
        arguments->help = true;
        arguments->at = arguments->count;
        return NULL;
    }
    char *equals = argument[0] == '-' && argument[1] != '\0' ? strchr(argument, '=') : NULL;
    if (equals && (argument[1] == '-' || equals == argument + 2)) {
        *equals = '\0';
        arguments->option = argument;
        arguments->value = equals + 1;
    }
    return argument;
}

int arguments_status(const lmb_arguments *arguments)
{
    return arguments->failed ? EXIT_USAGE : EXIT_DONE;
}

const char *arguments_text(lmb_arguments *arguments, const char *option)
{
    const char *value = arguments->value;
    arguments->value = NULL;
    if (value) {
        return value;
    }
    if (arguments->at >= arguments->count) {
        arguments_error(arguments, "a value must follow", option);
        return "";
    }
    return arguments->values[arguments->at++];
}

double arguments_number(lmb_arguments *arguments, const char *option, double minimum, double maximum)
{
    const char *text = arguments_text(arguments, option);
    if (arguments->failed) {
        return 0.0;
    }
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end != '\0' || !(value >= minimum && value <= maximum)) {
        fprintf(stderr, "lambent %s: %s takes a number from %g to %g, not '%s'\n", arguments->command, option, minimum,
                maximum, text);
        arguments->failed = true;
        return 0.0;
    }
    return value;
}

int64_t arguments_integer(lmb_arguments *arguments, const char *option, int64_t minimum, int64_t maximum)
{
    const char *text = arguments_text(arguments, option);
    if (arguments->failed) {
        return 0;
    }
    char *end;
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (end == text || *end != '\0' || errno != 0 || value < minimum || value > maximum) {
        fprintf(stderr, "lambent %s: %s takes a whole number from %lld to %lld, not '%s'\n", arguments->command, option,
                (long long)minimum, (long long)maximum, text);
        arguments->failed = true;
        return 0;
    }
    return value;
}

/* "X,Y,...", finite as floats too. */
static bool numbers_parse(const char *text, double *parsed, int count)
{
    for (int i = 0; i < count; ++i) {
        char *end;
        parsed[i] = strtod(text, &end);
        if (end == text || !isfinite((float)parsed[i]) || *end != (i < count - 1 ? ',' : '\0')) {
            return false;
        }
        text = end + 1;
    }
    return true;
}

lmb_vec3d arguments_position(lmb_arguments *arguments, const char *option)
{
    const char *text = arguments_text(arguments, option);
    double position[3] = {0.0, 0.0, 0.0};
    if (!arguments->failed && !numbers_parse(text, position, 3)) {
        fprintf(stderr, "lambent %s: %s takes three numbers X,Y,Z, not '%s'\n", arguments->command, option, text);
        arguments->failed = true;
    }
    return (lmb_vec3d){position[0], position[1], position[2]};
}

void arguments_box(lmb_arguments *arguments, const char *option, lmb_vec3d box[2])
{
    const char *text = arguments_text(arguments, option);
    double c[6] = {0.0};
    if (!arguments->failed && !numbers_parse(text, c, 6)) {
        fprintf(stderr, "lambent %s: %s takes two corners X0,Y0,Z0,X1,Y1,Z1, not '%s'\n", arguments->command, option,
                text);
        arguments->failed = true;
    }
    box[0] = (lmb_vec3d){fmin(c[0], c[3]), fmin(c[1], c[4]), fmin(c[2], c[5])};
    box[1] = (lmb_vec3d){fmax(c[0], c[3]), fmax(c[1], c[4]), fmax(c[2], c[5])};
}

lmb_vec3 arguments_vector(lmb_arguments *arguments, const char *option)
{
    const lmb_vec3d position = arguments_position(arguments, option);
    return (lmb_vec3){(float)position.x, (float)position.y, (float)position.z};
}

/* Of the paths that are still to come, the first; none of a command with all of them. */
static const char **next_path(lmb_shared_arguments *shared)
{
    for (int i = 0; i < ARGUMENTS_PATHS && shared->path_name[i]; ++i) {
        if (!shared->path[i]) {
            return &shared->path[i];
        }
    }
    return NULL;
}

void arguments_shared(lmb_arguments *arguments, const char *argument, lmb_shared_arguments *shared)
{
    const char **const path = next_path(shared);
    if (shared->output_name && strcmp(argument, "-o") == 0) {
        shared->output = arguments_text(arguments, argument);
    } else if ((shared->takes & ARGUMENTS_THREADS) && strcmp(argument, "--threads") == 0) {
        shared->threads = (int)arguments_integer(arguments, argument, 1, 1024);
    } else if ((shared->takes & ARGUMENTS_QUIET) && strcmp(argument, "--quiet") == 0) {
        shared->quiet = true;
    } else if (argument[0] == '-' && argument[1] != '\0') {
        arguments_error(arguments, "unknown option", argument);
    } else if (path) {
        *path = argument;
    } else if (shared->many_name) {
        shared->many[shared->many_count++] = argument;
    } else {
        arguments_error(arguments, "one argument too many:", argument);
    }
}

bool arguments_complete(lmb_arguments *arguments, const lmb_shared_arguments *shared)
{
    for (int i = 0; i < ARGUMENTS_PATHS && !arguments->failed && !arguments->help; ++i) {
        if (shared->path_name[i] && !shared->path[i]) {
            arguments_error(arguments, "missing argument", shared->path_name[i]);
        }
    }
    if (!arguments->failed && !arguments->help && shared->many_name && shared->many_count == 0) {
        arguments_error(arguments, "missing argument", shared->many_name);
    }
    if (!arguments->failed && !arguments->help && shared->output_name && !shared->output) {
        arguments_error(arguments, "missing option -o", shared->output_name);
    }
    return !arguments->failed && !arguments->help;
}

int exit_of_result(lmb_result result)
{
    switch (result) {
    case LMB_OK:
        return EXIT_DONE;
    case LMB_ERROR_INTERRUPTED:
        return EXIT_INTERRUPTED;
    case LMB_ERROR_MEMORY:
    case LMB_ERROR_WRITE:
    case LMB_ERROR_ARGUMENT:
        return EXIT_FAILED;
    default:
        return EXIT_BAD_INPUT;
    }
}
