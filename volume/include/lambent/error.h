/* One line about what went wrong, naming the file and the place, for functions whose result code is not enough. */
#ifndef LAMBENT_ERROR_H
#define LAMBENT_ERROR_H

#include <lambent/result.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { LMB_ERROR_MESSAGE_SIZE = 512 };

typedef struct lmb_error {
    char message[LMB_ERROR_MESSAGE_SIZE]; /* one line, no full stop, NUL-terminated; control characters replaced */
} lmb_error;

/* Fills `error` (NULL is allowed: then nothing is written) and returns `result`, so that failing is one statement. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
lmb_result
lmb_error_set(lmb_error *error, lmb_result result, const char *format, ...);

#ifdef __cplusplus
}
#endif

#endif
