#define _POSIX_C_SOURCE 200809L
#include "command.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void bar_print(const lmb_console *console, double done, double elapsed)
{
    enum { WIDTH = 30 };
    char bar[WIDTH + 1];
    const int filled = (int)(done * WIDTH);
    for (int i = 0; i < WIDTH; ++i) {
        bar[i] = i < filled ? '#' : '.';
    }
    bar[WIDTH] = '\0';
    const double left = done > 0.0 ? elapsed / done * (1.0 - done) : 0.0;
    fprintf(stderr, "\r%-9s [%s] %3.0f %%  %4.0f s left ", console->phase, bar, 100.0 * done, left);
    if (done >= 1.0) {
        fprintf(stderr, "\r%-9s [%s] 100 %%  %6.1f s     \n", console->phase, bar, elapsed);
    }
    fflush(stderr);
}

static bool console_report(void *context, const char *phase, double done)
{
    lmb_console *console = context;
    const double now = seconds_now();
    if (!console->phase || strcmp(console->phase, phase) != 0) {
        console->phase = phase;
        console->phase_start = now;
        console->printed = 0.0;
    }
    const double elapsed = now - console->phase_start;
    if (console->json) {
        if (done >= 1.0 || now - console->printed >= 1.0) {
            console->printed = now;
            const double left = done > 0.0 ? elapsed / done * (1.0 - done) : -1.0;
            printf("{\"phase\":\"%s\",\"done\":%.6f,\"seconds\":%.3f,\"seconds_left\":%.3f}\n", phase, done, elapsed,
                   left);
            fflush(stdout);
        }
    } else if (!console->quiet) {
        bar_print(console, done, elapsed);
    }
    if (done >= 1.0) {
        console->phase = NULL;
    }
    return !interrupted;
}

lmb_progress console_progress(lmb_console *console, bool quiet, bool json)
{
    *console = (lmb_console){.quiet = quiet || (!json && !isatty(STDERR_FILENO)), .json = json};
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_interrupt;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    return (lmb_progress){console_report, console};
}

void console_finish(lmb_console *console)
{
    if (console->phase && !console->quiet && !console->json) {
        fputc('\n', stderr);
    }
    console->phase = NULL;
}
