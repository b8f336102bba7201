#define _POSIX_C_SOURCE 200809L
#include "interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

#include "command.h"

static sigset_t signals;
static pthread_mutex_t ending = PTHREAD_MUTEX_INITIALIZER; /* whoever holds it for good ends the process */
static bool shut;                                          /* by the main thread */
static void (*cleanup_function)(void *context);
static void *cleanup_context;

static void cleanup_run(void)
{
    if (cleanup_function) {
        cleanup_function(cleanup_context);
    }
}

static void *signals_await(void *unused)
{
    (void)unused;
    int signal_number;
    while (sigwait(&signals, &signal_number) != 0) {
    }
    pthread_mutex_lock(&ending);
    cleanup_run();
    console_interrupted();
    _exit(EXIT_INTERRUPTED);
}

static void on_signal(int signal_number)
{
    (void)signal_number;
    static const char message[] = "lambent: interrupted\n";
    const ssize_t written = write(STDERR_FILENO, message, sizeof message - 1);
    (void)written;
    _exit(EXIT_INTERRUPTED);
}

/* Without a thread there is no clean-up. */
static void signals_handle(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    pthread_sigmask(SIG_UNBLOCK, &signals, NULL);
}

void interrupt_watch(void)
{
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals, NULL);
    pthread_t thread;
    if (pthread_create(&thread, NULL, signals_await, NULL) != 0) {
        signals_handle();
    } else {
        pthread_detach(thread);
    }
}

void interrupt_hold(void)
{
    if (!shut) {
        pthread_mutex_lock(&ending);
    }
}

void interrupt_release(void)
{
    if (!shut) {
        pthread_mutex_unlock(&ending);
    }
}

void interrupt_set_cleanup(void (*cleanup)(void *context), void *context)
{
    cleanup_function = cleanup;
    cleanup_context = context;
}

void interrupt_shut(void)
{
    interrupt_hold();
    shut = true;
}

void interrupt_reopen(void)
{
    if (shut) {
        shut = false;
        pthread_mutex_unlock(&ending);
    }
}

void interrupt_fail(const char *message)
{
    interrupt_shut();
    cleanup_run();
    lmb_error error;
    lmb_error_set(&error, LMB_ERROR_MEMORY, "%s", message);
    _exit(command_fail(LMB_ERROR_MEMORY, &error));
}
