#define _POSIX_C_SOURCE 200809L
#include "command.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include <lambent/bake.h>

#include "interrupt.h"

/* Of the process. */
static atomic_bool json_records;
static atomic_bool bar_open; /* the line that the cursor is in is the bar's */

/* The first reason why standard output did not take something; -1: not known. */
static int output_fault;

static bool output_note(bool good)
{
    if (!good && output_fault == 0) {
        output_fault = errno != 0 ? errno : -1;
    }
    return good;
}

static bool output_flush(void)
{
    errno = 0;
    return output_note(fflush(stdout) == 0 && !ferror(stdout));
}

void console_print(const char *text)
{
    errno = 0;
    output_note(fputs(text, stdout) != EOF);
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
    atomic_store(&bar_open, true);
}

static void bar_end(void)
{
    if (atomic_exchange(&bar_open, false)) {
        fputc('\n', stderr);
    }
}

static void line_print(lmb_console *console, double now, double done, double left)
{
    printf("{\"phase\":\"%s\",\"done\":%.6f,\"seconds\":%.3f,\"seconds_left\":%.3f,\"total_seconds\":%.3f,"
           "\"total_done\":%.6f}\n",
           console->phase, done, now - console->phase_start, left, now - console->start, console->total_done);
}

/* Work that runs again and again under one name, as bounces do, is one phase, and ends where the next begins. */
static void phase_begin(lmb_console *console, const char *phase, double now)
{
    if (!console->phase || strcmp(console->phase, phase) != 0) {
        console_finish(console);
        console->phase = phase;
        console->phase_start = now;
        console->phase_done = false;
    }
}

/* `left`: seconds, -1 not known. */
static bool phase_print(lmb_console *console, double now, double done, double left)
{
    bool good = true;
    if (console->json) {
        if ((done >= 1.0 && !console->phase_done) || now - console->printed >= 1.0) {
            console->printed = now;
            line_print(console, now, done, left);
            good = output_flush();
        }
    } else if (!console->quiet) {
        bar_print(console, done, now - console->phase_start, left);
    }
    console->phase_done |= done >= 1.0;
    return good;
}

static bool console_report(void *context, const char *phase, double done)
{
    lmb_console *console = context;
    const double now = seconds_now();
    phase_begin(console, phase, now);
    const double elapsed = now - console->phase_start;
    return phase_print(console, now, done, done > 0.0 ? elapsed / done * (1.0 - done) : -1.0);
}

bool console_bake_progress(lmb_console *console, const lmb_bake_progress *progress)
{
    const double now = seconds_now();
    const double left = progress->seconds_left >= 0.0 ? progress->seconds_left : -1.0;
    phase_begin(console, lmb_bake_phase_name(progress->phase), now);
    /* A forecast that grows does not take back what was said to be done. */
    const double passed = now - console->start;
    const double total = left >= 0.0 ? passed / (passed + left) : 0.0;
    console->total_done = total > console->total_done ? total : console->total_done;
    return phase_print(console, now, progress->done, left);
}

lmb_progress console_progress(lmb_console *console, bool quiet, bool json)
{
    *console = (lmb_console){.quiet = quiet || (!json && !isatty(STDERR_FILENO)), .json = json, .start = seconds_now()};
    json_records = json;
    return (lmb_progress){console_report, console};
}

void console_finish(lmb_console *console)
{
    bar_end();
    console->phase = NULL;
}

/* Length of the UTF-8 sequence at `text`; 0 when it is none. */
static size_t utf8_length(const unsigned char *text)
{
    const size_t length = text[0] < 0x80u                        ? 1
                          : text[0] >= 0xc2u && text[0] <= 0xdfu ? 2
                          : (text[0] & 0xf0u) == 0xe0u           ? 3
                          : text[0] >= 0xf0u && text[0] <= 0xf4u ? 4
                                                                 : 0;
    for (size_t i = 1; i < length; ++i) {
        if ((text[i] & 0xc0u) != 0x80u) {
            return 0;
        }
    }
    return length;
}

/* Text for JSON: a path may hold bytes that are no UTF-8. */
static cJSON *json_text(const char *line)
{
    char text[LMB_ERROR_MESSAGE_SIZE];
    snprintf(text, sizeof text, "%s", line);
    for (char *at = text; *at;) {
        const size_t length = utf8_length((const unsigned char *)at);
        if (length == 0) {
            *at = '?';
        }
        at += length > 0 ? length : 1;
    }
    return cJSON_CreateString(text);
}

/* One line, with what was printed before it; frees the record. */
static void record_print(cJSON *record)
{
    char *text = cJSON_PrintUnformatted(record);
    puts(text ? text : "{\"error\":\"out of memory\",\"status\":1}");
    cJSON_free(text);
    cJSON_Delete(record);
    output_flush();
}

static void error_record_print(const char *message, int status)
{
    cJSON *record = cJSON_CreateObject();
    cJSON_AddItemToObject(record, "error", json_text(message));
    cJSON_AddNumberToObject(record, "status", status);
    record_print(record);
}

void console_warning(const char *line, bool quiet)
{
    if (json_records) {
        cJSON *record = cJSON_CreateObject();
        cJSON_AddItemToObject(record, "warning", json_text(line));
        record_print(record);
    } else if (!quiet) {
        bar_end();
        fprintf(stderr, "lambent: warning: %s\n", line);
    }
}

static void warning_say(void *context, const char *line)
{
    (void)context;
    console_warning(line, false);
}

static void warning_say_if_json(void *context, const char *line)
{
    (void)context;
    console_warning(line, true);
}

lmb_warnings console_warnings(bool quiet)
{
    return (lmb_warnings){quiet ? warning_say_if_json : warning_say, NULL};
}

void samples_say_rounded(uint32_t samples, uint32_t multiple, bool quiet)
{
    const uint32_t over = samples % multiple;
    if (over != 0) {
        char line[128];
        snprintf(line, sizeof line, "--samples %" PRIu32 ": taking %" PRIu32 ", the next multiple of %" PRIu32, samples,
                 samples - over + multiple, multiple);
        console_warning(line, quiet);
    }
}

void console_result(cJSON *result)
{
    if (!json_records) {
        cJSON_Delete(result);
        return;
    }
    interrupt_shut();
    cJSON *record = cJSON_CreateObject();
    cJSON_AddItemToObject(record, "result", result);
    record_print(record);
}

int command_fail(lmb_result result, const lmb_error *error)
{
    interrupt_shut();
    lmb_error fault;
    if (output_fault != 0) {
        result = lmb_error_set(&fault, LMB_ERROR_WRITE, "standard output: cannot write%s%s",
                               output_fault > 0 ? ": " : "", output_fault > 0 ? strerror(output_fault) : "");
        error = &fault;
        output_fault = 0;
    }
    const char *message = error->message[0] ? error->message : lmb_result_text(result);
    bar_end();
    fprintf(stderr, "lambent: %s\n", message);
    if (json_records) {
        error_record_print(message, exit_of_result(result));
    }
    return exit_of_result(result);
}

/* Standard output for this thread alone. False when another is stuck in it. */
static bool output_seize(void)
{
    const struct timespec pause = {0, 10000000};
    for (int attempt = 0; attempt < 50; ++attempt) {
        if (ftrylockfile(stdout) == 0) {
            return true;
        }
        nanosleep(&pause, NULL);
    }
    return false;
}

void console_interrupted(void)
{
    /* Past stdio: another thread may be stuck in it. */
    const char *message = atomic_exchange(&bar_open, false) ? "\nlambent: interrupted\n" : "lambent: interrupted\n";
    const ssize_t written = write(STDERR_FILENO, message, strlen(message));
    (void)written;
    if (json_records && output_seize()) {
        error_record_print("interrupted", EXIT_INTERRUPTED);
    }
}

int console_end(int status)
{
    if (output_flush() || status != EXIT_DONE) {
        return status;
    }
    const lmb_error error = {{0}}; /* command_fail knows it */
    return command_fail(LMB_ERROR_WRITE, &error);
}
