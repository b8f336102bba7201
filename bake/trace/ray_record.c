#include "trace/ray_record_internal.h"

#include <assert.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

/* What one thread has recorded; only that thread writes it. */
typedef struct ray_log {
    struct ray_log *next;
    uint64_t seen;
    uint64_t seen_of[LMB_RAY_KINDS];
    lmb_ray_run *runs; /* the latest first */
    lmb_ray_run *run;  /* the one being filled; NULL: rays are not kept at present */
} ray_log;

struct lmb_ray_recorder {
    uint64_t serial; /* no other recorder of the process has it, at the same address or not */
    uint64_t keep_one_in;
    pthread_mutex_t mutex; /* of `logs` */
    ray_log *logs;
    atomic_bool out_of_memory;
    lmb_ray_run **runs; /* once finished */
    size_t run_count;
};

static atomic_uint_fast64_t serials;

/* The log of this thread, and the recorder that it belongs to. */
static _Thread_local ray_log *thread_log;
static _Thread_local uint64_t thread_serial;

lmb_result lmb_ray_recorder_create(uint64_t keep_one_in, lmb_ray_recorder **recorder)
{
    assert(keep_one_in > 0);
    lmb_ray_recorder *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->serial = 1 + atomic_fetch_add(&serials, 1);
    created->keep_one_in = keep_one_in;
    pthread_mutex_init(&created->mutex, NULL);
    *recorder = created;
    return LMB_OK;
}

void lmb_ray_recorder_destroy(lmb_ray_recorder *recorder)
{
    if (!recorder) {
        return;
    }
    for (ray_log *log = recorder->logs; log;) {
        for (lmb_ray_run *run = log->runs; run;) {
            lmb_ray_run *const next_run = run->next;
            free(run);
            run = next_run;
        }
        ray_log *const next = log->next;
        free(log);
        log = next;
    }
    pthread_mutex_destroy(&recorder->mutex);
    free(recorder->runs);
    free(recorder);
}

/* NULL when memory has run out. */
static ray_log *thread_log_find(lmb_ray_recorder *recorder)
{
    if (thread_serial != recorder->serial) {
        ray_log *log = calloc(1, sizeof *log);
        if (!log) {
            return NULL;
        }
        pthread_mutex_lock(&recorder->mutex);
        log->next = recorder->logs;
        recorder->logs = log;
        pthread_mutex_unlock(&recorder->mutex);
        thread_log = log;
        thread_serial = recorder->serial;
    }
    return thread_log;
}

/* Every LMB_RAYS_PER_RUN rays: a new run, or none. Keeps from the middle of each stretch. */
static void run_begin(lmb_ray_recorder *recorder, ray_log *log)
{
    log->run = NULL;
    if (log->seen / LMB_RAYS_PER_RUN % recorder->keep_one_in != recorder->keep_one_in / 2) {
        return;
    }
    lmb_ray_run *run = malloc(sizeof *run);
    if (!run) {
        atomic_store(&recorder->out_of_memory, true);
        return;
    }
    run->next = log->runs;
    run->count = 0;
    log->runs = run;
    log->run = run;
}

void lmb_ray_record(lmb_ray_recorder *recorder, lmb_ray_kind kind, lmb_vec3 origin, lmb_vec3 direction,
                    float near_distance, float far_distance)
{
    ray_log *log = thread_log_find(recorder);
    if (!log) {
        atomic_store(&recorder->out_of_memory, true);
        return;
    }
    if (log->seen % LMB_RAYS_PER_RUN == 0) {
        run_begin(recorder, log);
    }
    ++log->seen;
    ++log->seen_of[kind];
    if (log->run) {
        const uint32_t at = log->run->count++;
        log->run->ray[at] = (lmb_recorded_ray){origin, near_distance, direction, far_distance};
        log->run->kind[at] = (uint8_t)kind;
    }
}

static void run_sort(lmb_ray_run *run)
{
    uint32_t at = 0;
    for (uint32_t kind = 0; kind < LMB_RAY_KINDS; ++kind) {
        run->first_of[kind] = at;
        for (uint32_t i = 0; i < run->count; ++i) {
            if (run->kind[i] == kind) {
                run->order[at++] = (uint16_t)i;
            }
        }
    }
    run->first_of[LMB_RAY_KINDS] = at;
}

lmb_result lmb_ray_recorder_finish(lmb_ray_recorder *recorder)
{
    assert(!recorder->runs);
    size_t count = 0;
    for (const ray_log *log = recorder->logs; log; log = log->next) {
        for (const lmb_ray_run *run = log->runs; run; run = run->next) {
            ++count;
        }
    }
    recorder->runs = malloc((count + 1) * sizeof *recorder->runs);
    if (!recorder->runs || atomic_load(&recorder->out_of_memory)) {
        return LMB_ERROR_MEMORY;
    }
    for (const ray_log *log = recorder->logs; log; log = log->next) {
        for (lmb_ray_run *run = log->runs; run; run = run->next) {
            run_sort(run);
            recorder->runs[recorder->run_count++] = run;
        }
    }
    return LMB_OK;
}

uint64_t lmb_ray_recorder_seen(const lmb_ray_recorder *recorder, lmb_ray_kind kind)
{
    uint64_t seen = 0;
    for (const ray_log *log = recorder->logs; log; log = log->next) {
        seen += log->seen_of[kind];
    }
    return seen;
}

uint64_t lmb_ray_recorder_kept(const lmb_ray_recorder *recorder, lmb_ray_kind kind)
{
    uint64_t kept = 0;
    for (size_t i = 0; i < recorder->run_count; ++i) {
        kept += recorder->runs[i]->first_of[kind + 1] - recorder->runs[i]->first_of[kind];
    }
    return kept;
}

lmb_ray_run *const *lmb_ray_recorder_runs(const lmb_ray_recorder *recorder, size_t *count)
{
    *count = recorder->run_count;
    return recorder->runs;
}
