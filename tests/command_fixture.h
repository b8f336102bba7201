/* Running the `lambent` command from a test. */
#ifndef LMB_TESTS_COMMAND_FIXTURE_H
#define LMB_TESTS_COMMAND_FIXTURE_H

#include <stdarg.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "harness.h"
#include "scenes/levels.h"

/* Makes the folder, and in it the Cornell box at `path`. */
static inline bool cornell_make(const char *folder, const char *path)
{
    lmb_error error = {{0}};
    mkdir(folder, 0777);
    const lmb_result result = lmb_level_cornell(path, &error);
    CHECK(result == LMB_OK, "%s", error.message);
    return result == LMB_OK;
}

/* Runs a shell command and keeps the first part of what it prints on standard output and error together.
 * @return its exit status, -1 when a signal ended it */
static inline int run(char *printed, size_t size, const char *command)
{
    char line[4096];
    snprintf(line, sizeof line, "{ %s\n} 2>&1", command);
    FILE *pipe = popen(line, "r");
    if (!pipe) {
        return -1;
    }
    const size_t got = fread(printed, 1, size - 1, pipe);
    printed[got] = '\0';
    char rest[4096];
    while (fread(rest, 1, sizeof rest, pipe) > 0) {
    }
    const int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* A check that a command, made as printf does, exits with `status` and prints `says` (NULL: whatever). */
#define CHECK_RUN(status, says, ...) check_run_at(__LINE__, status, says, __VA_ARGS__)
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
static inline bool
check_run_at(int line, int status, const char *says, const char *format, ...)
{
    static char printed[65536];
    char command[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    const int got = run(printed, sizeof printed, command);
    const bool good = got == status && (!says || strstr(printed, says));
    CHECK(good, "line %d: %s: exits with %d, not %d, or does not say '%s': %s", line, command, got, status,
          says ? says : "", printed);
    return good;
}

/* Text that stands for all files in a folder and what is in them, but for what a bake that did not finish may go on
 * from.
 */
static inline void folder_state(const char *folder, char *state, size_t size)
{
    char command[1024];
    snprintf(command, sizeof command,
             "cd '%s' && find . -not -path './.lambent-parts*' | LC_ALL=C sort && "
             "find . -type f -not -path './.lambent-parts*' -print0 | LC_ALL=C sort -z | "
             "xargs -0 cksum",
             folder);
    run(state, size, command);
}

#endif
