/* Ctrl-C and SIGTERM end the process with EXIT_INTERRUPTED at once, whatever it is doing: reading, building, tracing,
 * writing.
 *
 * A thread of its own waits for them, so that it may do what a signal handler may not. What a command leaves on the
 * disk is either whole or taken back by its clean-up. */
#ifndef LMB_TOOLS_INTERRUPT_H
#define LMB_TOOLS_INTERRUPT_H

#ifdef __cplusplus
extern "C" {
#endif

/* To be called before any thread is started: all of them leave the signals to the one that waits. */
void interrupt_watch(void);

/* An interruption waits from `hold` to `release`, for what may not be left half done and takes no time. */
void interrupt_hold(void);
void interrupt_release(void);

/* What an interruption does first; NULL: nothing. It runs beside the work, and the process ends after it. To be called
 * between `hold` and `release`. */
void interrupt_set_cleanup(void (*cleanup)(void *context), void *context);

/* From here on an interruption comes too late. Where one is under way this does not return. To be called before files
 * replace their old versions, and before the last line of output: it is said once how a command ended. */
void interrupt_shut(void);

/* Lets them in again. */
void interrupt_reopen(void);

/* Ends the process as a failure of any thread, after the same clean-up. Does not return. */
void interrupt_fail(const char *message);

/* Ends it so, with one line, when a C++ library lets an exception go where nobody can catch it: TBB does when memory
 * runs out while Embree builds. */
void interrupt_catch_terminate(void);

#ifdef __cplusplus
}
#endif

#endif
