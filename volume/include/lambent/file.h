/* Whole files, written so that a reader never sees half of one. */
#ifndef LAMBENT_FILE_H
#define LAMBENT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a whole file or pipe, not a device, of up to 4 GiB into malloc'ed memory (one NUL byte follows the contents).
 * The caller frees `*data`. @return LMB_ERROR_IO, _MEMORY, _UNSUPPORTED (larger) */
lmb_result lmb_file_read(const char *path, unsigned char **data, size_t *size, lmb_error *error);

/* `directory`/`name` in malloc'ed memory; NULL when out of it. */
char *lmb_file_in(const char *directory, const char *name);

/* The path of a file that `name` stands for beside the file at `path`: in its folder, or `name` itself where it begins
 * with a slash. The caller frees it. NULL when out of memory. */
char *lmb_file_path_beside(const char *path, const char *name);

/* The path beside `path` that a new version is written to before it replaces the old one; fits any path that
 * open() takes. The caller frees it. NULL when out of memory. */
char *lmb_file_temporary_path(const char *path);

/* Renames a finished temporary file over `path`, after its bytes are on the disk. On failure removes the temporary
 * file. @return LMB_ERROR_WRITE */
lmb_result lmb_file_commit(const char *temporary_path, const char *path, lmb_error *error);

/* Writes beside, then renames: `path` holds either its old contents or all of the new ones. @return LMB_ERROR_WRITE,
 * _MEMORY */
lmb_result lmb_file_write(const char *path, const void *data, size_t size, lmb_error *error);

/* 64-bit FNV-1a; start with LMB_HASH_SEED, or continue from an earlier result. Not cryptographic. */
#define LMB_HASH_SEED UINT64_C(0xcbf29ce484222325)
uint64_t lmb_hash(uint64_t hash, const void *data, size_t size);

#ifdef __cplusplus
}
#endif

#endif
