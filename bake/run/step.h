/* Saying how far work is that no pool runs. */
#ifndef LMB_STEP_H
#define LMB_STEP_H

#include <lambent/error.h>
#include <lambent/pool.h>

/* `progress` may be NULL. @return LMB_ERROR_INTERRUPTED when it asks to stop */
static inline lmb_result step_report(const lmb_progress *progress, const char *phase, double done, lmb_error *error)
{
    if (!progress || !progress->report || progress->report(progress->context, phase, done)) {
        return LMB_OK;
    }
    return lmb_error_set(error, LMB_ERROR_INTERRUPTED, "%s: %s", phase, lmb_result_text(LMB_ERROR_INTERRUPTED));
}

#endif
