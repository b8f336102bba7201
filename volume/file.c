#define _POSIX_C_SOURCE 200809L

#include <lambent/file.h>

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* No file of a bake or environment is as large; a pipe may go on for ever. */
#define MOST_BYTES (SIZE_MAX / 4 < UINT64_C(1) << 32 ? SIZE_MAX / 4 : (size_t)(UINT64_C(1) << 32))

static lmb_result read_stream(FILE *stream, size_t capacity, unsigned char **data, size_t *size)
{
    unsigned char *buffer = malloc(capacity);
    size_t used = 0;
    while (buffer) {
        used += fread(buffer + used, 1, capacity - 1 - used, stream);
        if (used < capacity - 1) {
            break;
        }
        if (used > MOST_BYTES) {
            free(buffer);
            return LMB_ERROR_UNSUPPORTED;
        }
        unsigned char *larger = realloc(buffer, capacity * 2);
        if (!larger) {
            free(buffer);
        }
        buffer = larger;
        capacity *= 2;
    }
    if (!buffer) {
        return LMB_ERROR_MEMORY;
    }
    if (ferror(stream)) {
        free(buffer);
        return LMB_ERROR_IO;
    }
    buffer[used] = 0;
    *data = buffer;
    *size = used;
    return LMB_OK;
}

/* What to read at first. @return LMB_ERROR_ARGUMENT of a device, which may have no end, _UNSUPPORTED of too much */
static lmb_result capacity_find(FILE *stream, size_t *capacity)
{
    struct stat status;
    *capacity = 4096;
    if (fstat(fileno(stream), &status) != 0 || status.st_size < 0) {
        return LMB_OK;
    }
    if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) {
        return LMB_ERROR_ARGUMENT;
    }
    if ((uintmax_t)status.st_size > MOST_BYTES) {
        return LMB_ERROR_UNSUPPORTED;
    }
    if (status.st_size > 0) {
        *capacity = (size_t)status.st_size + 2; /* one for the NUL, one so that the end is seen without growing */
    }
    return LMB_OK;
}

lmb_result lmb_file_read(const char *path, unsigned char **data, size_t *size, lmb_error *error)
{
    assert(path && data && size);
    FILE *const stream = fopen(path, "rb");
    if (!stream) {
        return lmb_error_set(error, LMB_ERROR_IO, "%s: cannot open: %s", path, strerror(errno));
    }
    size_t capacity = 0;
    lmb_result result = capacity_find(stream, &capacity);
    if (result == LMB_OK) {
        result = read_stream(stream, capacity, data, size);
    }
    const int reason = errno;
    fclose(stream);
    if (result == LMB_ERROR_ARGUMENT) {
        return lmb_error_set(error, LMB_ERROR_IO, "%s: a device, not a file", path);
    }
    if (result == LMB_ERROR_UNSUPPORTED) {
        return lmb_error_set(error, result, "%s: larger than %" PRIu64 " bytes", path, (uint64_t)MOST_BYTES);
    }
    if (result == LMB_ERROR_IO) {
        return lmb_error_set(error, result, "%s: cannot read: %s", path, strerror(reason));
    }
    if (result == LMB_ERROR_MEMORY) {
        return lmb_error_set(error, result, "%s: out of memory", path);
    }
    return result;
}

/* Length of the folder part, with its slash; 0 when there is none. */
static size_t folder_length(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

char *lmb_file_in(const char *directory, const char *name)
{
    const size_t length = strlen(directory);
    const size_t size = length + 1 + strlen(name) + 1;
    char *path = malloc(size);
    if (path) {
        snprintf(path, size, "%s%s%s", directory, length > 0 && directory[length - 1] == '/' ? "" : "/", name);
    }
    return path;
}

char *lmb_file_path_beside(const char *path, const char *name)
{
    assert(path && name);
    const size_t folder = name[0] == '/' ? 0 : folder_length(path), size = strlen(name) + 1;
    char *const joined = malloc(folder + size);
    if (joined) {
        memcpy(joined, path, folder);
        memcpy(joined + folder, name, size);
    }
    return joined;
}

char *lmb_file_temporary_path(const char *path)
{
    assert(path);
    /* The name is replaced, not extended: it may already be as long as a name can be. The process id keeps two
     * processes that write one file apart. */
    const size_t folder = folder_length(path);
    const size_t name_size = sizeof ".lmb-0123456789abcdef-18446744073709551615";
    char *const temporary = malloc(folder + name_size);
    if (temporary) {
        memcpy(temporary, path, folder);
        snprintf(temporary + folder, name_size, ".lmb-%016" PRIx64 "-%ju",
                 lmb_hash(LMB_HASH_SEED, path + folder, strlen(path + folder)), (uintmax_t)getpid());
    }
    return temporary;
}

/* fsync of a file or folder. @return 0 or errno */
static int flush_to_disk(const char *path)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return errno;
    }
    const int reason = fsync(descriptor) == 0 ? 0 : errno;
    close(descriptor);
    return reason;
}

static void flush_folder(const char *path)
{
    /* The rename is atomic without this; a file system that cannot flush a folder has lost nothing. */
    const size_t length = folder_length(path);
    char *const folder = malloc(length + 2);
    if (folder) {
        memcpy(folder, path, length);
        memcpy(folder + length, ".", 2);
        flush_to_disk(folder);
        free(folder);
    }
}

lmb_result lmb_file_commit(const char *temporary_path, const char *path, lmb_error *error)
{
    assert(temporary_path && path);
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode)) {
        unlink(temporary_path);
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot replace: not a regular file", path);
    }
    int reason = flush_to_disk(temporary_path);
    if (reason == 0 && rename(temporary_path, path) != 0) {
        reason = errno;
    }
    if (reason != 0) {
        unlink(temporary_path);
        return lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot write: %s", path, strerror(reason));
    }
    flush_folder(path);
    return LMB_OK;
}

lmb_result lmb_file_write(const char *path, const void *data, size_t size, lmb_error *error)
{
    assert(path && (data || size == 0));
    char *const temporary = lmb_file_temporary_path(path);
    if (!temporary) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    }
    lmb_result result;
    FILE *const stream = fopen(temporary, "wb");
    if (!stream) {
        result = lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot write: %s", path, strerror(errno));
        goto cleanup;
    }
    errno = 0;
    bool written = size == 0 || fwrite(data, 1, size, stream) == size;
    int reason = errno;
    if (fclose(stream) != 0 && written) {
        written = false;
        reason = errno;
    }
    if (!written) {
        unlink(temporary);
        result = lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot write: %s", path, strerror(reason));
        goto cleanup;
    }
    result = lmb_file_commit(temporary, path, error);
cleanup:
    free(temporary);
    return result;
}

uint64_t lmb_hash(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *const bytes = data;
    for (size_t i = 0; i < size; ++i) {
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}
