#define _POSIX_C_SOURCE 200809L
#include "command.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "forecast.h"

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

static void bar_print(const lmb_console *console, double done, double elapsed, double left)
{
    enum { WIDTH = 30 };
    char bar[WIDTH + 1];
    const int filled = (int)(done * WIDTH);
    for (int i = 0; i < WIDTH; ++i) {
        bar[i] = i < filled ? '#' : '.';
    }
    bar[WIDTH] = '\0';
    fprintf(stderr, "\r%-13s [%s] %3.0f %%  %6.1f s", console->phase, bar, 100.0 * done, elapsed);
    if (left >= 0.0) {
        fprintf(stderr, ", %4.0f s left ", left);
    }
    fflush(stderr);
}

/* -1: not known. */
static double seconds_left(const lmb_console *console, double done, double elapsed)
{
    if (console->forecast) {
        return forecast_left(console->forecast, console->phase, done, elapsed);
    }
    return done > 0.0 ? elapsed / done * (1.0 - done) : -1.0;
}

static void line_print(lmb_console *console, double now, double done, double left)
{
    /* A forecast that grows does not take back what was said to be done. */
    const double passed = now - console->start;
    const double total = left >= 0.0 && console->forecast ? passed / (passed + left) : 0.0;
    console->total_done = total > console->total_done ? total : console->total_done;
    printf("{\"phase\":\"%s\",\"done\":%.6f,\"seconds\":%.3f,\"seconds_left\":%.3f,\"total_seconds\":%.3f,"
           "\"total_done\":%.6f}\n",
           console->phase, done, now - console->phase_start, left, passed, console->total_done);
    fflush(stdout);
}

/* Work that runs again and again under one name, as bounces do, is one phase, and ends where the next begins. */
static bool console_report(void *context, const char *phase, double done)
{
    lmb_console *console = context;
    const double now = seconds_now();
    const bool first = !console->phase || strcmp(console->phase, phase) != 0;
    if (first) {
        console_finish(console);
        console->phase = phase;
        console->phase_start = now;
        console->phase_done = false;
    }
    const double elapsed = now - console->phase_start;
    const double left = seconds_left(console, done, elapsed);
    if (console->json) {
        if ((done >= 1.0 && !console->phase_done) || now - console->printed >= 1.0) {
            console->printed = now;
            line_print(console, now, done, left);
        }
    } else if (!console->quiet) {
        bar_print(console, done, elapsed, left);
    }
    console->phase_done |= done >= 1.0;
    return !interrupted;
}

lmb_progress console_progress(lmb_console *console, bool quiet, bool json)
{
    *console = (lmb_console){.quiet = quiet || (!json && !isatty(STDERR_FILENO)), .json = json, .start = seconds_now()};
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
