/* The commands of `lambent`, and what they share: reading options, exit statuses, progress. */
#ifndef LMB_TOOLS_COMMAND_H
#define LMB_TOOLS_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/error.h>
#include <lambent/pool.h>
#include <lambent/types.h>
#include <lambent/warning.h>

/* Exit statuses. */
enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_BAD_INPUT = 3, EXIT_INTERRUPTED = 4 };

/* Exit status of a result: bad input, interrupted, or failed. */
int exit_of_result(lmb_result result);

/* Says how a command failed: "lambent: MESSAGE" on standard error, a record too where progress is JSON. Returns
 * exit_of_result(result). Does not return where the command is being interrupted. */
int command_fail(lmb_result result, const lmb_error *error);

/* Options are "--name value", "--name=value", "-n value", "-n=value" or "--flag", in any order among the positional
 * arguments. After "--" all are positional; one that begins with a dash is handed on as "./-...", which is the same
 * file and no option. */
typedef struct lmb_arguments {
    int count;
    char **values;
    int at;              /* next to read */
    const char *command; /* for messages */
    const char *usage;   /* the command's --help text */
    const char *option;  /* the last one returned that came with "=" */
    const char *value;   /* what stands behind its "=", until it is fetched */
    bool only_positional;
    bool failed; /* a usage error was printed */
    bool help;   /* --help was asked for and printed */
    bool quiet;  /* --quiet was among the options of a level */
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
lmb_vec3 arguments_vector(lmb_arguments *arguments, const char *option);    /* X,Y,Z: a direction */
lmb_vec3d arguments_position(lmb_arguments *arguments, const char *option); /* X,Y,Z: a position in the world */
/* X0,Y0,Z0,X1,Y1,Z1: two corners of a box in the world. Its least and its greatest coordinates. */
void arguments_box(lmb_arguments *arguments, const char *option, lmb_vec3d box[2]);

/* What commands share, besides their own options: paths in their order, or one and more of a kind, -o, --threads and
 * --quiet. */
enum { ARGUMENTS_PATHS = 2 };
enum { ARGUMENTS_THREADS = 1, ARGUMENTS_QUIET = 2 };
typedef struct lmb_shared_arguments {
    const char *path_name[ARGUMENTS_PATHS]; /* of those that must be given; NULL: no more */
    const char *output_name;                /* what must follow -o; NULL: there is no -o */
    unsigned takes;                         /* ARGUMENTS_THREADS, ARGUMENTS_QUIET */
    const char *path[ARGUMENTS_PATHS];
    const char *many_name; /* of paths behind those, one at least; NULL: there are none */
    const char **many;     /* the command's, with room for as many as there are arguments */
    uint32_t many_count;
    const char *output;
    int threads; /* 0: all processors */
    bool quiet;
} lmb_shared_arguments;

/* Takes an argument that is none of the command's own options; a usage error where it is none of these either. */
void arguments_shared(lmb_arguments *arguments, const char *argument, lmb_shared_arguments *shared);

/* Whether the command has something to do, with all that must be given: else a usage error, or there was one, or
 * --help. */
bool arguments_complete(lmb_arguments *arguments, const lmb_shared_arguments *shared);

/* What a command says of itself: progress as a bar with time left on a terminal, or, when `json`, as records on
 * standard output, a JSON object a line. */
struct cJSON;
struct lmb_bake_progress;
typedef struct lmb_console {
    bool quiet;
    bool json;
    double start;
    double phase_start;
    double printed;
    double total_done;
    const char *phase;
    bool phase_done;
} lmb_console;
/* The console of this process from here on. What it returns tells of the time left in the phase at hand. */
lmb_progress console_progress(lmb_console *console, bool quiet, bool json);
/* The same for a bake, which knows the time left of all. False: standard output takes no more. */
bool console_bake_progress(lmb_console *console, const struct lmb_bake_progress *progress);
/* Ends the bar's line, so that other output starts clean. */
void console_finish(lmb_console *console);

/* Says a warning: on standard error unless `quiet`, or as a record. */
void console_warning(const char *line, bool quiet);

/* Says all warnings so. */
lmb_warnings console_warnings(bool quiet);

/* Warns where `--samples N` is no multiple of what samples come in, and more are taken. */
void samples_say_rounded(uint32_t samples, uint32_t multiple, bool quiet);

/* The last record, {"result": result}; takes `result`. Where progress is no JSON it says nothing. */
void console_result(struct cJSON *result);

/* For the thread that interrupts: says so. */
void console_interrupted(void);

/* Prints a text that may be longer than what standard output buffers; console_end knows why it was not taken. */
void console_print(const char *text);

/* The exit status after a command that ended with `status`: EXIT_FAILED where standard output did not take all. */
int console_end(int status);

/* Wall-clock seconds of a monotonic clock. */
double seconds_now(void);

/* count and values: what follows the command's name. */
int command_bake(int count, char **values);
int command_bench(int count, char **values);
int command_check(int count, char **values);
int command_cube(int count, char **values);
int command_info(int count, char **values);
int command_models(int count, char **values);
int command_merge(int count, char **values);
int command_pack(int count, char **values);
int command_probe(int count, char **values);
int command_render(int count, char **values);
int command_sample(int count, char **values);
int command_ssbump(int count, char **values);

#endif
