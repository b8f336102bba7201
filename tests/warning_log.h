/* Warnings counted, and the last one kept. */
#ifndef LMB_TESTS_WARNING_LOG_H
#define LMB_TESTS_WARNING_LOG_H

#include <stdio.h>

typedef struct warning_log {
    int count;
    char last[512];
} warning_log;

static inline void warning_keep(void *context, const char *text)
{
    warning_log *const log = context;
    ++log->count;
    snprintf(log->last, sizeof log->last, "%s", text);
}

#endif
