/* The commands of `lambent`, and what they share: reading options, exit statuses, progress. */
#ifndef LMB_TOOLS_COMMAND_H
#define LMB_TOOLS_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/error.h>
#include <lambent/pool.h>
#include <lambent/types.h>

/* Exit statuses. */
enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_BAD_INPUT = 3, EXIT_INTERRUPTED = 4 };

/* Exit status of a result: bad input, interrupted, or failed. */
int exit_of_result(lmb_result result);

/* Prints "lambent: MESSAGE" to standard error and returns exit_of_result(result). */
int command_fail(lmb_result result, const lmb_error *error);

/* Options are "--name value", "--name=value" or "--flag", in any order among the positional arguments. */
typedef struct lmb_arguments {
    int count;
    char **values;
    int at;              /* next to read */
    const char *command; /* for messages */
    const char *usage;   /* the command's --help text */
    bool failed;         /* a usage error was printed */
    bool help;           /* --help was asked for and printed */
} lmb_arguments;

lmb_arguments arguments_begin(int count, char **values, const char *command, const char *usage);

/* Next argument: its option name with "--" (then fetch its value with the functions below), or a positional. NULL at
 * the end, after a usage error and after --help; then return arguments_status. */
const char *arguments_next(lmb_arguments *arguments);
int arguments_status(const lmb_arguments *arguments);

/* Prints "lambent COMMAND: what argument" and marks failure. */
void arguments_error(lmb_arguments *arguments, const char *what, const char *argument);

/* The value of the option just returned by arguments_next. On a missing or malformed value: usage error, and the
 * fallback 0. Numbers must be finite and within [minimum, maximum]. */
const char *arguments_text(lmb_arguments *arguments, const char *option);
double arguments_number(lmb_arguments *arguments, const char *option, double minimum, double maximum);
int64_t arguments_integer(lmb_arguments *arguments, const char *option, int64_t minimum, int64_t maximum);
lmb_vec3 arguments_vector(lmb_arguments *arguments, const char *option); /* X,Y,Z: a direction */
lmb_vec3d arguments_place(lmb_arguments *arguments, const char *option); /* X,Y,Z: a place in the world */

/* Progress as a bar with time left on a terminal (or JSON lines when `json`), and Ctrl-C: after SIGINT or SIGTERM the
 * running work stops with LMB_ERROR_INTERRUPTED. */
struct lmb_forecast;
typedef struct lmb_console {
    bool quiet;
    bool json;
    const struct lmb_forecast *forecast; /* time left is of all; NULL: of the phase at hand. May be set later */
    double start;
    double phase_start;
    double printed;
    double total_done;
    const char *phase;
    bool phase_done;
} lmb_console;
lmb_progress console_progress(lmb_console *console, bool quiet, bool json);
/* Ends the bar's line, so that other output starts clean. */
void console_finish(lmb_console *console);

/* Wall-clock seconds of a monotonic clock. */
double seconds_now(void);

/* count and values: what follows the command's name. */
int command_bake(int count, char **values);
int command_bench(int count, char **values);
int command_check(int count, char **values);
int command_info(int count, char **values);
int command_probe(int count, char **values);
int command_render(int count, char **values);
int command_sample(int count, char **values);

#endif
