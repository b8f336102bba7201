#define _POSIX_C_SOURCE 200809L
#include "output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <lambent/file.h>

#include "interrupt.h"

static void file_abandon(void *context)
{
    unlink(context);
}

lmb_result output_file_check(const char *path, lmb_error *error)
{
    static char *temporary; /* for as long as an interruption may need it */
    free(temporary);
    temporary = lmb_file_temporary_path(path);
    if (!temporary) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be written: not a file", path);
    }
    const int descriptor = open(temporary, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be written: %s", path, strerror(errno));
    }
    close(descriptor);
    unlink(temporary);
    interrupt_hold();
    interrupt_set_cleanup(file_abandon, temporary);
    interrupt_release();
    return LMB_OK;
}

bool output_file_ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), ending_length = strlen(ending);
    return length > ending_length && strcmp(path + length - ending_length, ending) == 0;
}
