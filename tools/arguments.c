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

const char *arguments_next(lmb_arguments *arguments)
{
    if (arguments->failed || arguments->at >= arguments->count) {
        return NULL;
    }
    char *value = arguments->values[arguments->at++];
    if (strcmp(value, "--help") == 0 || strcmp(value, "-h") == 0) {
        fputs(arguments->usage, stdout);
        arguments->help = true;
        arguments->at = arguments->count;
        return NULL;
    }
    if (value[0] == '-' && value[1] != '\0') {
        /* "--name=value" is read as two arguments: the name now, the value by the next arguments_text. */
        char *equals = strchr(value, '=');
        if (equals && value[1] == '-') {
            *equals = '\0';
            arguments->values[--arguments->at] = equals + 1;
        }
    }
    return value;
}

int arguments_status(const lmb_arguments *arguments)
{
    return arguments->failed ? EXIT_USAGE : EXIT_DONE;
}

const char *arguments_text(lmb_arguments *arguments, const char *option)
{
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

/* "X,Y,Z", finite as floats too. */
static bool place_parse(const char *text, lmb_vec3d *place)
{
    double parsed[3];
    for (int i = 0; i < 3; ++i) {
        char *end;
        parsed[i] = strtod(text, &end);
        if (end == text || !isfinite((float)parsed[i]) || *end != (i < 2 ? ',' : '\0')) {
            return false;
        }
        text = end + 1;
    }
    *place = (lmb_vec3d){parsed[0], parsed[1], parsed[2]};
    return true;
}

lmb_vec3d arguments_place(lmb_arguments *arguments, const char *option)
{
    const char *text = arguments_text(arguments, option);
    lmb_vec3d place = {0.0, 0.0, 0.0};
    if (!arguments->failed && !place_parse(text, &place)) {
        fprintf(stderr, "lambent %s: %s takes three numbers X,Y,Z, not '%s'\n", arguments->command, option, text);
        arguments->failed = true;
    }
    return place;
}

lmb_vec3 arguments_vector(lmb_arguments *arguments, const char *option)
{
    const lmb_vec3d place = arguments_place(arguments, option);
    return (lmb_vec3){(float)place.x, (float)place.y, (float)place.z};
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

int command_fail(lmb_result result, const lmb_error *error)
{
    fprintf(stderr, "lambent: %s\n", error->message[0] ? error->message : lmb_result_text(result));
    return exit_of_result(result);
}
