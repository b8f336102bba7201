/* SIGINT and SIGTERM at any moment of any command: it ends within a second, with status 4, and what was in the folder
 * stays. */
#define _POSIX_C_SOURCE 200809L
#include <cjson/cJSON.h>
#include <fcntl.h>
#include <signal.h>
#include <stdint.h>
#include <sys/stat.h>
#include <time.h>

#include "command_fixture.h"
#include "scenes/levels.h"

#define OUTPUT LMB_TEST_OUTPUT_DIR "/interrupt"
#define LEVEL OUTPUT "/room.glb"
#define LARGE OUTPUT "/sphere.glb" /* takes some time to load, to build and to lay out */
#define BAKED OUTPUT "/baked"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MOST_SECONDS 5.0
#else
#define MOST_SECONDS 1.0
#endif

static bool levels_make(void)
{
    static bool made;
    lmb_error error = {{0}};
    mkdir(OUTPUT, 0777);
    if (!made) {
        lmb_result result = lmb_level_cornell(LEVEL, &error);
        if (result == LMB_OK) {
            result = lmb_level_sphere_room(LARGE, 4.0f, 160, 0.5f, 10.0f, &error);
        }
        CHECK(result == LMB_OK, "%s", error.message);
        made = result == LMB_OK && CHECK_RUN(0, NULL,
                                             "rm -rf " BAKED " && " LMB_COMMAND " bake " LEVEL " -o " BAKED
                                             " --quiet --spacing 0.5 --samples 2 --lightmaps --texels-per-m 4");
    }
    return made;
}

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void wait_ms(int milliseconds)
{
    const struct timespec pause = {milliseconds / 1000, milliseconds % 1000 * 1000000L};
    nanosleep(&pause, NULL);
}

/* Whether a process waits for its signals yet: before, it is the loader's, which they kill; and before that this
 * program's own copy, in which fork() blocks all signals for a moment. */
static bool waits_for_signals(pid_t process)
{
    char path[64], line[256], name[32] = "";
    snprintf(path, sizeof path, "/proc/%ld/status", (long)process);
    FILE *file = fopen(path, "r");
    unsigned long long blocked = 0;
    while (file && fgets(line, sizeof line, file)) {
        sscanf(line, "Name: %31s", name);
        if (sscanf(line, "SigBlk: %llx", &blocked) == 1) {
            break;
        }
    }
    if (file) {
        fclose(file);
    }
    return strcmp(name, "lambent") == 0 && (blocked >> (SIGINT - 1) & 1) != 0;
}

/* Starts `lambent`, output to OUTPUT/printed and input from nowhere that ends. */
static pid_t command_start(const char *const *arguments)
{
    int input[2];
    if (pipe(input) != 0) {
        return -1;
    }
    const pid_t child = fork();
    if (child == 0) {
        const char *values[24] = {LMB_COMMAND};
        for (int i = 0; arguments[i]; ++i) {
            values[i + 1] = arguments[i];
        }
        const int output = open(OUTPUT "/printed", O_WRONLY | O_CREAT | O_TRUNC, 0666);
        dup2(input[0], STDIN_FILENO);
        dup2(output, STDOUT_FILENO);
        dup2(output, STDERR_FILENO);
        execv(LMB_COMMAND, (char **)(uintptr_t)values);
        _exit(127);
    }
    close(input[0]);
    /* A sanitizer's own start blocks signals for a moment too: blocked now and for some milliseconds is for good. */
    for (int i = 0, steady = 0; i < 5000 && steady < 8; ++i) {
        steady = waits_for_signals(child) ? steady + 1 : 0;
        wait_ms(1);
    }
    /* input[1] stays open: whoever reads waits. */
    return child;
}

/* Sends `signal_number` after some time. Returns the exit status, -1 for a death by the signal itself. */
static int interrupt_after(const char *const *arguments, int milliseconds, int signal_number)
{
    const pid_t child = command_start(arguments);
    wait_ms(milliseconds);
    const double start = seconds_now();
    kill(child, signal_number);
    int status = 0;
    waitpid(child, &status, 0);
    const double seconds = seconds_now() - start;
    CHECK(seconds < MOST_SECONDS, "%s: ended %.2f s after the signal at %d ms", arguments[0], seconds, milliseconds);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* Work that would take minutes or hours, in one place each. */
static void long_work_ends_at_once(void)
{
    static const struct {
        int milliseconds;
        const char *arguments[16];
    } table[] = {
        {400, {"bake", LEVEL, "-o", OUTPUT "/x", "--samples", "268435456", "--quiet"}}, /* the forecast */
        {900, {"bake", LEVEL, "-o", OUTPUT "/x", "--samples", "2", "--spacing", "0.004", "--max-probes", "100000000"}},
        {700, {"bake", LEVEL, "-o", OUTPUT "/x", "--samples", "100000", "--spacing", "0.1"}},
        {900,
         {"bake", LEVEL, "-o", OUTPUT "/x", "--samples", "2", "--spacing", "1", "--lightmaps", "--texels-per-m",
          "4000"}},
        {300, {"bake", LARGE, "-o", OUTPUT "/x", "--samples", "2", "--lightmaps", "--texels-per-m", "100"}},
        {500, {"check", LEVEL, BAKED, "--points", "100000", "--samples", "100000000"}},
        {500, {"render", LEVEL, BAKED, "-o", OUTPUT "/x.png", "--mode", "reference", "--samples", "100000000"}},
        {500, {"probe", LEVEL, "--at", "0,1,0", "--samples", "268435456"}},
        {500,
         {"probe", LEVEL, "--at", "0,1,0", "--normal", "0,1,0", "--estimator", "cached", "--samples", "268435456"}},
        {500, {"bench", "--rays", LEVEL, "--samples", "1000000"}},
        {100, {"sample", BAKED "/probes.lmb"}},
        {100, {"probe", LEVEL}},
    };
    if (!levels_make()) {
        return;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; ++i) {
        const int signal_number = i % 2 == 0 ? SIGINT : SIGTERM;
        const int status = interrupt_after(table[i].arguments, table[i].milliseconds, signal_number);
        CHECK(status == 4, "row %zu: %s: exits with %d", i, table[i].arguments[0], status);
    }
    CHECK_RUN(0, "lambent: interrupted", "cat " OUTPUT "/printed");
    CHECK(access(OUTPUT "/x", F_OK) != 0 && access(OUTPUT "/x.png", F_OK) != 0, "something was left");
}

/* Moments of a bake from its first to its last millisecond: it is done and whole, or the old bake is as it was. */
static void any_moment_keeps_a_whole_bake(void)
{
    static const char *const small[] = {"bake", LEVEL,       "-o", BAKED,         "--spacing",
                                        "0.2",  "--samples", "8",  "--lightmaps", "--texels-per-m",
                                        "16",   "--quiet",   NULL};
    static const char *const large[] = {
        "bake",           LARGE, "-o", BAKED, "--samples", "2", "--max-probes", "1000", "--lightmaps",
        "--texels-per-m", "8",   NULL};
    static char before[16384], after[16384];
    if (!levels_make()) {
        return;
    }
    double whole = seconds_now();
    CHECK_RUN(0, NULL,
              LMB_COMMAND " bake " LEVEL " -o " OUTPUT "/timed --spacing 0.2 --samples 8 --lightmaps "
                          "--texels-per-m 16 --quiet");
    whole = 1000.0 * (seconds_now() - whole);
    uint32_t random = 12345;
    enum { TRIES = 12 };
    for (int i = 0; i < TRIES; ++i) {
        random = random * 1664525u + 1013904223u;
        const bool is_small = i % 3 != 0;
        const int milliseconds = (int)(is_small ? whole * (i + random / 4294967296.0) / TRIES : (double)(random >> 23));
        folder_state(BAKED, before, sizeof before);
        const int status = interrupt_after(is_small ? small : large, milliseconds, SIGINT);
        folder_state(BAKED, after, sizeof after);
        if (status == 4) {
            CHECK(strcmp(before, after) == 0, "at %d ms: before\n%s\nand after\n%s", milliseconds, before, after);
        } else {
            CHECK(status == 0 && !strstr(after, "lambent"), "at %d ms: status %d, %s", milliseconds, status, after);
        }
    }
}

static void the_last_record_says_so(void)
{
    static const char *const arguments[] = {"bake", LEVEL,       "-o",     OUTPUT "/x",       "--spacing",
                                            "0.1",  "--samples", "100000", "--json-progress", NULL};
    if (!levels_make()) {
        return;
    }
    CHECK(interrupt_after(arguments, 800, SIGTERM) == 4, "not 4");
    CHECK_RUN(0, "{\"error\":\"interrupted\",\"status\":4}", "grep -v '^lambent: ' " OUTPUT "/printed | tail -1");
    CHECK_RUN(0, "1", "grep -c error " OUTPUT "/printed");
}

static const test_case cases[] = {
    {"long_work_ends_at_once", long_work_ends_at_once},
    {"any_moment_keeps_a_whole_bake", any_moment_keeps_a_whole_bake},
    {"the_last_record_says_so", the_last_record_says_so},
};

TEST_MAIN(cases)
