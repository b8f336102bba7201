#define _POSIX_C_SOURCE 200809L

#include "volume_internal.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

lmb_result lmb_volume_map(const char *path, void **mapping, size_t *size)
{
    /* Not blocking: opening a pipe would wait for its other end. */
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        return LMB_ERROR_IO;
    }
    lmb_result result = LMB_ERROR_IO;
    struct stat status;
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        goto cleanup;
    }
    if (status.st_size == 0) {
        result = LMB_ERROR_TRUNCATED;
        goto cleanup;
    }
    if ((uintmax_t)status.st_size > SIZE_MAX) {
        goto cleanup;
    }
    void *const view = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    if (view == MAP_FAILED) {
        goto cleanup;
    }
    *mapping = view;
    *size = (size_t)status.st_size;
    result = LMB_OK;
cleanup:
    close(descriptor);
    return result;
}

void lmb_volume_unmap(void *mapping, size_t size)
{
    munmap(mapping, size);
}
