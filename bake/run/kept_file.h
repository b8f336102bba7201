/* The file in which what was gathered for a list is kept. */
#ifndef LMB_KEPT_FILE_H
#define LMB_KEPT_FILE_H

#include <lambent/gather_sh3.h>

#include "run/kept.h"

/* What it begins with. As parts are, it is of machines of one kind. */
typedef struct lmb_kept_head {
    char magic[8];
    uint64_t version;
    uint64_t settings, suns; /* as lmb_kept has them */
    uint64_t count;          /* of elements: their sites' hashes follow, then what was gathered at them */
    uint64_t record_bytes;
    uint64_t checksum; /* of all that follows */
} lmb_kept_head;

/* An open file: `data` is the caller's to free, the rest points into it. */
typedef struct lmb_kept_file {
    unsigned char *data;
    lmb_kept_head head;
    const unsigned char *site;     /* [count] of 8 bytes */
    const unsigned char *gathered; /* [count] of `record_bytes` */
} lmb_kept_file;

/* The head alone; LMB_ERROR_IO where there is none. @return LMB_ERROR_IO, _FORMAT, _MEMORY, _UNSUPPORTED (settings) */
lmb_result lmb_kept_file_head(const lmb_kept *kept, const char *list, lmb_kept_head *head, lmb_error *error);

/* @return as above, _TRUNCATED, _CHECKSUM */
lmb_result lmb_kept_file_read(const lmb_kept *kept, const char *list, lmb_kept_file *file, lmb_error *error);

/* @return LMB_ERROR_WRITE, _MEMORY */
lmb_result lmb_kept_file_write(const lmb_kept *kept, const char *list, size_t count, const uint64_t *site,
                               const lmb_gathered *gathered, lmb_error *error);

#endif
