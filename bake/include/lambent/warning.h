/* What is worth saying but stops nothing: work goes on after it. */
#ifndef LAMBENT_WARNING_H
#define LAMBENT_WARNING_H

#ifdef __cplusplus
extern "C" {
#endif

/* Who listens. `warn` gets one line without a full stop, on the thread that called the work; NULL: nobody. All zero is
 * silence. */
typedef struct lmb_warnings {
    void (*warn)(void *context, const char *line);
    void *context;
} lmb_warnings;

/* Says one line, cut at 511 bytes; control characters are replaced. `warnings` may be NULL. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void lmb_warn(const lmb_warnings *warnings, const char *format, ...);

#ifdef __cplusplus
}
#endif

#endif
