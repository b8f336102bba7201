/* What can go wrong out in the world, as named results. A function that returns anything but LMB_OK has left its
 * outputs untouched. Mistakes of the caller (a NULL where none is allowed) are asserted in debug builds and come back
 * as LMB_ERROR_ARGUMENT in release builds; per-sample functions say in their own comment what they do instead. */
#ifndef LAMBENT_RESULT_H
#define LAMBENT_RESULT_H

#include <lambent/api.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lmb_result {
    LMB_OK = 0,
    LMB_ERROR_ARGUMENT,    /* the caller broke the function's contract */
    LMB_ERROR_MEMORY,      /* an allocation failed */
    LMB_ERROR_IO,          /* cannot be read: missing, unreadable */
    LMB_ERROR_WRITE,       /* cannot be written: no such folder, no permission, disk full */
    LMB_ERROR_FORMAT,      /* not a file of this kind, or one that contradicts itself */
    LMB_ERROR_TRUNCATED,   /* the file ends before its own contents do */
    LMB_ERROR_VERSION,     /* written by a newer version */
    LMB_ERROR_CHECKSUM,    /* the bytes are not those that were written */
    LMB_ERROR_UNSUPPORTED, /* well-formed, but it asks for something that Lambent does not have */
    LMB_ERROR_INTERRUPTED  /* the user asked to stop */
} lmb_result;

/* A short English phrase for a result, lower case, without a full stop; never NULL. */
LMB_API const char *lmb_result_text(lmb_result result);

#ifdef __cplusplus
}
#endif

#endif
