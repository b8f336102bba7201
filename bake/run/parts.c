#include "run/parts.h"

#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <lambent/file.h>

#include "base/clock.h"

enum { PATH_SIZE = 4096 };

/* Threads that a part's groups keep evenly busy. */
enum { THREADS_OF_PART = 4 };

/* Of the machines that shards run on alike: what the file holds is what is in memory. */
typedef struct part_header {
    char magic[8];
    uint64_t key;
    uint64_t first_group, group_count;
    uint64_t count, record_bytes;
    lmb_gather_stats stats;
    uint64_t checksum; /* of the records */
} part_header;

static const char magic[8] = "LMBPART";

typedef struct parts_work {
    const lmb_parts *parts;
    const lmb_gather_job *job;
    lmb_gathered *gathered;
    lmb_gather_stats *stats; /* [part] */
    lmb_gather_stats *group; /* [group] of the parts at work */
    uint8_t *state;          /* [part] */
    size_t part_count;
    double written; /* when parts were, seconds */
    const lmb_progress *progress;
    size_t done, at_work; /* parts */
} parts_work;

enum { PART_MISSING, PART_GATHERED, PART_KEPT };

/* Some parts that follow each other. */
static lmb_gather_job parts_job(const parts_work *work, size_t part, size_t count)
{
    lmb_gather_job job = *work->job;
    const size_t first = part * LMB_PART_GROUPS, left = work->job->group_count - first;
    job.first_group = first;
    job.group_count = left < count * LMB_PART_GROUPS ? left : count * LMB_PART_GROUPS;
    return job;
}

static size_t job_first(const lmb_gather_job *job)
{
    return lmb_gather_group_first(job->list->count, job->first_group);
}

static size_t job_count(const lmb_gather_job *job)
{
    return lmb_gather_group_first(job->list->count, job->first_group + job->group_count) - job_first(job);
}

/* False: it is too long. */
static bool part_path(const parts_work *work, const char *directory, size_t part, char path[PATH_SIZE])
{
    return snprintf(path, PATH_SIZE, "%s/%s-%06zu.part", directory, work->job->list->name, part) < PATH_SIZE;
}

static part_header part_describe(const parts_work *work, const lmb_gather_job *job)
{
    part_header header = {.key = work->parts->key,
                          .first_group = job->first_group,
                          .group_count = job->group_count,
                          .count = job_count(job),
                          .record_bytes = sizeof(lmb_gathered)};
    memcpy(header.magic, magic, sizeof magic);
    return header;
}

/* Takes a part from a file. False: there is none, or it is another's, or broken. */
static bool part_read(parts_work *work, const char *directory, size_t part)
{
    const lmb_gather_job job = parts_job(work, part, 1);
    const part_header expected = part_describe(work, &job);
    const size_t bytes = (size_t)(expected.count * expected.record_bytes);
    char path[PATH_SIZE];
    unsigned char *data = NULL;
    size_t size = 0;
    if (!part_path(work, directory, part, path) || lmb_file_read(path, &data, &size, NULL) != LMB_OK) {
        return false;
    }
    part_header header = {.count = 0};
    bool good = size == sizeof header + bytes;
    if (good) {
        memcpy(&header, data, sizeof header);
        good = memcmp(&header, &expected, offsetof(part_header, stats)) == 0 &&
               header.checksum == lmb_hash(LMB_HASH_SEED, data + sizeof header, bytes);
    }
    if (good) {
        memcpy(&work->gathered[job_first(&job)], data + sizeof header, bytes);
        work->stats[part] = header.stats;
        work->state[part] = PART_KEPT;
    }
    free(data);
    return good;
}

static lmb_result part_write(parts_work *work, size_t part, lmb_error *error)
{
    const lmb_gather_job job = parts_job(work, part, 1);
    part_header header = part_describe(work, &job);
    const size_t bytes = (size_t)(header.count * header.record_bytes);
    const lmb_gathered *const records = &work->gathered[job_first(&job)];
    char path[PATH_SIZE];
    unsigned char *const data = malloc(sizeof header + bytes);
    if (!data) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    header.stats = work->stats[part];
    header.checksum = lmb_hash(LMB_HASH_SEED, records, bytes);
    memcpy(data, &header, sizeof header);
    memcpy(data + sizeof header, records, bytes);
    const lmb_result result = part_path(work, work->parts->write_to, part, path)
                                  ? lmb_file_write(path, data, sizeof header + bytes, error)
                                  : lmb_error_set(error, LMB_ERROR_WRITE, "%.100s...: path is too long", path);
    free(data);
    work->state[part] = result == LMB_OK ? PART_KEPT : work->state[part];
    return result;
}

static lmb_result folder_make(const char *folder, lmb_error *error)
{
    return mkdir(folder, 0777) == 0 || errno == EEXIST
               ? LMB_OK
               : lmb_error_set(error, LMB_ERROR_WRITE, "%s: cannot be made: %s", folder, strerror(errno));
}

/* Writes what is not written yet. What cannot be written is only not kept, unless it is a shard's. */
static lmb_result parts_write(parts_work *work, lmb_error *error)
{
    lmb_error reason;
    lmb_result result = LMB_OK;
    for (size_t part = 0; work->parts->write_to && part < work->part_count && result == LMB_OK; ++part) {
        if (work->state[part] == PART_GATHERED) {
            result = folder_make(work->parts->write_to, &reason);
            result = result == LMB_OK ? part_write(work, part, &reason) : result;
        }
    }
    work->written = lmb_clock_seconds();
    return result == LMB_OK || !lmb_parts_are_a_shard(work->parts) ? LMB_OK
                                                                   : lmb_error_set(error, result, "%s", reason.message);
}

/* The progress of the parts at work as that of the list. */
static bool part_report(void *context, const char *phase, double done)
{
    const parts_work *work = context;
    const lmb_progress *progress = work->progress;
    return !progress || !progress->report ||
           progress->report(progress->context, phase,
                            ((double)work->done + done * (double)work->at_work) / (double)work->part_count);
}

static lmb_result parts_run(parts_work *work, size_t part, size_t count, lmb_pool *pool, lmb_error *error)
{
    const lmb_gather_job job = parts_job(work, part, count);
    const lmb_progress progress = {part_report, work};
    work->at_work = count;
    const lmb_result result =
        lmb_gather_elements_by_group(&job, pool, &progress, &work->gathered[job_first(&job)], work->group);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "%s: %s", job.list->name, lmb_result_text(result));
    }
    for (size_t i = 0; i < count; ++i) {
        const size_t groups = parts_job(work, part + i, 1).group_count;
        work->stats[part + i] = lmb_gather_stats_sum(&work->group[i * LMB_PART_GROUPS], groups);
        work->state[part + i] = PART_GATHERED;
    }
    const bool is_time = lmb_clock_seconds() - work->written >= work->parts->seconds;
    return is_time ? parts_write(work, error) : LMB_OK;
}

/* Begins where the part lies when the folders are those of all shards in their order. */
static bool part_find(parts_work *work, size_t part)
{
    const uint32_t count = work->parts->read_count;
    bool found = false;
    for (uint32_t i = 0; i < count && !found; ++i) {
        found = part_read(work, work->parts->read_from[(part + i) % count], part);
    }
    return found;
}

static bool part_is_ours(const lmb_parts *parts, size_t part)
{
    return parts->shard_count < 2 || part % parts->shard_count == parts->shard;
}

/* How many that follow each other are to be gathered, from `part` on: some for each thread, as one run ends when its
 * last thread does. */
static size_t parts_missing(parts_work *work, size_t part, const lmb_pool *pool)
{
    const size_t most = 1 + (size_t)lmb_pool_threads(pool) / THREADS_OF_PART;
    size_t count = 0;
    while (count < most && part + count < work->part_count && part_is_ours(work->parts, part + count) &&
           !part_find(work, part + count)) {
        ++count;
    }
    return count;
}

static lmb_result parts_gather(parts_work *work, lmb_pool *pool, lmb_error *error)
{
    const lmb_parts *parts = work->parts;
    lmb_result result = LMB_OK;
    while (work->done < work->part_count && result == LMB_OK) {
        const size_t part = work->done;
        const size_t missing = work->state[part] == PART_MISSING ? parts_missing(work, part, pool) : 0;
        if (missing > 0 && parts->read_only) {
            return lmb_error_set(error, LMB_ERROR_UNSUPPORTED,
                                 "part %zu of %zu of the %s is in none of the folders: a shard is missing, or of other "
                                 "settings",
                                 part + 1, work->part_count, work->job->list->name);
        }
        if (missing > 0) {
            result = parts_run(work, part, missing, pool, error);
        }
        work->done += missing > 0 ? missing : 1;
    }
    /* A shard's are there to be read by others. */
    return result == LMB_OK && parts->shard_count > 1 ? parts_write(work, error) : result;
}

lmb_result lmb_parts_gather(const lmb_parts *parts, const lmb_gather_job *job, lmb_pool *pool,
                            const lmb_progress *progress, lmb_gathered *gathered, lmb_gather_stats *stats,
                            lmb_error *error)
{
    lmb_result result;
    if (!parts) {
        result = lmb_gather_elements(job, pool, progress, gathered, stats);
    } else {
        const size_t count = (job->group_count + LMB_PART_GROUPS - 1) / LMB_PART_GROUPS;
        parts_work work = {.parts = parts,
                           .job = job,
                           .gathered = gathered,
                           .stats = calloc(count + 1, sizeof *work.stats),
                           .group = calloc(job->group_count + 1, sizeof *work.group),
                           .state = calloc(count + 1, sizeof *work.state),
                           .part_count = count,
                           .written = lmb_clock_seconds(),
                           .progress = progress};
        memset(gathered, 0, job->list->count * sizeof *gathered);
        result = work.stats && work.group && work.state ? parts_gather(&work, pool, error)
                                                        : lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
        if (result == LMB_OK) {
            *stats = lmb_gather_stats_sum(work.stats, count);
        }
        free(work.stats);
        free(work.group);
        free(work.state);
    }
    if (result == LMB_OK) {
        lmb_gather_stats_renew(stats, gathered, job->list->count);
    }
    return result;
}
