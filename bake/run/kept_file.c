#include "run/kept_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/file.h>

static const char magic[8] = "LMBKEPT";
enum { KEPT_VERSION = 1 };

/* The caller's; NULL: out of memory. */
static char *file_path(const char *folder, const char *list)
{
    char name[64];
    snprintf(name, sizeof name, "gathered-%s.bin", list);
    return lmb_file_in(folder, name);
}

static lmb_result head_check(const lmb_kept *kept, const char *path, const lmb_kept_head *head, lmb_error *error)
{
    if (memcmp(head->magic, magic, sizeof magic) != 0) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s", path, lmb_result_text(LMB_ERROR_FORMAT));
    }
    if (head->version != KEPT_VERSION || head->record_bytes != sizeof(lmb_gathered) ||
        head->settings != kept->settings) {
        return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                             "%s: gathered by other settings, or by another version of Lambent", path);
    }
    return LMB_OK;
}

lmb_result lmb_kept_file_head(const lmb_kept *kept, const char *list, lmb_kept_head *head, lmb_error *error)
{
    char *const path = file_path(kept->read_from, list);
    FILE *const file = path ? fopen(path, "rb") : NULL;
    lmb_result result = LMB_OK;
    if (!path) {
        result = lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    } else if (!file) {
        result = lmb_error_set(error, LMB_ERROR_IO, "%s: cannot open: %s", path, strerror(errno));
    } else if (fread(head, sizeof *head, 1, file) != 1) {
        result = lmb_error_set(error, LMB_ERROR_TRUNCATED, "%s: %s", path, lmb_result_text(LMB_ERROR_TRUNCATED));
    } else {
        result = head_check(kept, path, head, error);
    }
    if (file) {
        fclose(file);
    }
    free(path);
    return result;
}

/* Whether so many bytes are the whole file, and those that were written. */
static lmb_result contents_check(const lmb_kept_head *head, const unsigned char *data, size_t size)
{
    const size_t rest = size - sizeof *head;
    const size_t each = sizeof(uint64_t) + sizeof(lmb_gathered);
    if (rest % each != 0 || head->count != rest / each) {
        return LMB_ERROR_TRUNCATED;
    }
    return head->checksum == lmb_hash(LMB_HASH_SEED, data + sizeof *head, rest) ? LMB_OK : LMB_ERROR_CHECKSUM;
}

lmb_result lmb_kept_file_read(const lmb_kept *kept, const char *list, lmb_kept_file *file, lmb_error *error)
{
    char *const path = file_path(kept->read_from, list);
    size_t size = 0;
    file->data = NULL;
    lmb_result result =
        path ? lmb_file_read(path, &file->data, &size, error) : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    if (result == LMB_OK && size < sizeof file->head) {
        result = lmb_error_set(error, LMB_ERROR_TRUNCATED, "%s: %s", path, lmb_result_text(LMB_ERROR_TRUNCATED));
    }
    if (result == LMB_OK) {
        memcpy(&file->head, file->data, sizeof file->head);
        result = head_check(kept, path, &file->head, error);
    }
    if (result == LMB_OK) {
        result = contents_check(&file->head, file->data, size);
        if (result != LMB_OK) {
            lmb_error_set(error, result, "%s: %s", path, lmb_result_text(result));
        }
    }
    free(path);
    if (result != LMB_OK) {
        free(file->data);
        file->data = NULL;
        return result;
    }
    file->site = file->data + sizeof file->head;
    file->gathered = file->site + (size_t)file->head.count * sizeof(uint64_t);
    return LMB_OK;
}

/* The same without what padding happens to hold. */
static lmb_gathered clean(const lmb_gathered *gathered)
{
    lmb_gathered copy;
    memset(&copy, 0, sizeof copy);
    copy.moments = gathered->moments;
    copy.steady = gathered->steady;
    copy.difference = gathered->difference;
    memcpy(copy.key_visibility, gathered->key_visibility, sizeof copy.key_visibility);
    copy.squared_error = gathered->squared_error;
    copy.squared_length = gathered->squared_length;
    copy.squared_light = gathered->squared_light;
    copy.samples = gathered->samples;
    copy.rays = gathered->rays;
    return copy;
}

/* Head last, when the checksum is known. */
static bool contents_write(FILE *file, lmb_kept_head *head, const uint64_t *site, const lmb_gathered *gathered)
{
    const size_t count = (size_t)head->count;
    bool good = fwrite(head, sizeof *head, 1, file) == 1 && fwrite(site, sizeof *site, count, file) == count;
    head->checksum = lmb_hash(LMB_HASH_SEED, site, count * sizeof *site);
    for (size_t i = 0; i < count && good; ++i) {
        const lmb_gathered record = clean(&gathered[i]);
        head->checksum = lmb_hash(head->checksum, &record, sizeof record);
        good = fwrite(&record, sizeof record, 1, file) == 1;
    }
    return good && fseek(file, 0, SEEK_SET) == 0 && fwrite(head, sizeof *head, 1, file) == 1;
}

lmb_result lmb_kept_file_write(const lmb_kept *kept, const char *list, size_t count, const uint64_t *site,
                               const lmb_gathered *gathered, lmb_error *error)
{
    lmb_kept_head head = {.version = KEPT_VERSION,
                          .settings = kept->settings,
                          .suns = kept->suns,
                          .count = count,
                          .record_bytes = sizeof *gathered};
    memcpy(head.magic, magic, sizeof magic);
    char *const path = file_path(kept->write_to, list);
    char *const temporary = path ? lmb_file_temporary_path(path) : NULL;
    if (!temporary) {
        free(path);
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    FILE *const file = fopen(temporary, "wb");
    const bool written = file && contents_write(file, &head, site, gathered);
    const int reason = errno;
    const bool good = (!file || fclose(file) == 0) && written;
    lmb_result result = LMB_OK;
    if (good) {
        result = lmb_file_commit(temporary, path, error);
    } else {
        remove(temporary);
        result = lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be written: %s", path,
                               strerror(written ? errno : reason));
    }
    free(temporary);
    free(path);
    return result;
}
