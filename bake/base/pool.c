#define _POSIX_C_SOURCE 200809L
#include <lambent/pool.h>

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/clock.h"

typedef struct worker {
    lmb_pool *pool;
    int index;
    pthread_t thread;
} worker;

struct lmb_pool {
    int threads;
    int started; /* threads besides the caller's that exist */
    worker *workers;
    pthread_mutex_t mutex;
    pthread_cond_t work_ready;
    pthread_cond_t work_done;
    unsigned generation; /* counts calls of lmb_pool_run */
    int busy;            /* workers that have not finished this generation */
    bool quit;
    /* The work at hand. */
    lmb_task_function function;
    void *context;
    size_t count;
    atomic_size_t next;
    atomic_bool stop;
};

/* Tasks that lie side by side often cost alike, and other parts of a level otherwise: blocks of BLOCK tasks, side by
 * side for the caches, are handed out from each of STRIPS parts in turn, so that the share that is done tells how long
 * the rest takes. What fills no block comes last. */
enum { BLOCK = 8, STRIPS = 32 };

static size_t task_in_turn(size_t turn, size_t count)
{
    const size_t blocks = count / BLOCK;
    if (turn >= blocks * BLOCK) {
        return turn;
    }
    const size_t strip = turn / BLOCK % STRIPS;
    const size_t longer = blocks % STRIPS; /* strips, the first ones, that have one block more */
    const size_t block = strip * (blocks / STRIPS) + (strip < longer ? strip : longer) + turn / BLOCK / STRIPS;
    return block * BLOCK + turn % BLOCK;
}

static bool task_run_next(lmb_pool *pool, int index)
{
    if (atomic_load_explicit(&pool->stop, memory_order_relaxed)) {
        return false;
    }
    const size_t turn = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
    if (turn >= pool->count) {
        return false;
    }
    pool->function(pool->context, task_in_turn(turn, pool->count), index);
    return true;
}

static void *worker_main(void *argument)
{
    const worker *self = argument;
    lmb_pool *pool = self->pool;
    unsigned seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (!pool->quit && pool->generation == seen) {
            pthread_cond_wait(&pool->work_ready, &pool->mutex);
        }
        if (pool->quit) {
            break;
        }
        seen = pool->generation;
        pthread_mutex_unlock(&pool->mutex);
        while (task_run_next(pool, self->index)) {
        }
        pthread_mutex_lock(&pool->mutex);
        if (--pool->busy == 0) {
            pthread_cond_signal(&pool->work_done);
        }
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

lmb_result lmb_pool_create(int threads, lmb_pool **pool)
{
    if (threads <= 0) {
        const long processors = sysconf(_SC_NPROCESSORS_ONLN);
        threads = processors > 0 ? (int)processors : 1;
    }
    lmb_pool *created = calloc(1, sizeof *created);
    worker *workers = calloc((size_t)threads, sizeof *workers);
    if (!created || !workers) {
        free(created);
        free(workers);
        return LMB_ERROR_MEMORY;
    }
    created->threads = threads;
    created->workers = workers;
    pthread_mutex_init(&created->mutex, NULL);
    pthread_cond_init(&created->work_ready, NULL);
    pthread_cond_init(&created->work_done, NULL);
    for (int i = 1; i < threads; ++i) {
        workers[i].pool = created;
        workers[i].index = i;
        if (pthread_create(&workers[i].thread, NULL, worker_main, &workers[i]) != 0) {
            lmb_pool_destroy(created);
            return LMB_ERROR_MEMORY;
        }
        ++created->started;
    }
    *pool = created;
    return LMB_OK;
}

void lmb_pool_destroy(lmb_pool *pool)
{
    if (!pool) {
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->quit = true;
    pthread_cond_broadcast(&pool->work_ready);
    pthread_mutex_unlock(&pool->mutex);
    for (int i = 1; i <= pool->started; ++i) {
        pthread_join(pool->workers[i].thread, NULL);
    }
    pthread_cond_destroy(&pool->work_ready);
    pthread_cond_destroy(&pool->work_done);
    pthread_mutex_destroy(&pool->mutex);
    free(pool->workers);
    free(pool);
}

int lmb_pool_threads(const lmb_pool *pool)
{
    return pool->threads;
}

static bool progress_report(lmb_pool *pool, const char *phase, const lmb_progress *progress)
{
    const size_t next = atomic_load_explicit(&pool->next, memory_order_relaxed);
    const double done = pool->count == 0 || next >= pool->count ? 1.0 : (double)next / (double)pool->count;
    return progress->report(progress->context, phase, done);
}

lmb_result lmb_pool_run(lmb_pool *pool, size_t count, lmb_task_function function, void *context, const char *phase,
                        const lmb_progress *progress)
{
    const bool reports = progress && progress->report;
    pthread_mutex_lock(&pool->mutex);
    pool->function = function;
    pool->context = context;
    pool->count = count;
    atomic_store(&pool->next, 0);
    atomic_store(&pool->stop, false);
    pool->busy = pool->started;
    ++pool->generation;
    pthread_cond_broadcast(&pool->work_ready);
    pthread_mutex_unlock(&pool->mutex);

    double reported = 0.0;
    do {
        const double now = reports ? lmb_clock_seconds() : 0.0;
        if (reports && now - reported >= 0.1) {
            reported = now;
            if (!progress_report(pool, phase, progress)) {
                atomic_store(&pool->stop, true);
            }
        }
    } while (task_run_next(pool, 0));

    pthread_mutex_lock(&pool->mutex);
    while (pool->busy > 0) {
        pthread_cond_wait(&pool->work_done, &pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
    if (!atomic_load(&pool->stop) && reports && !progress_report(pool, phase, progress)) {
        atomic_store(&pool->stop, true);
    }
    return atomic_load(&pool->stop) ? LMB_ERROR_INTERRUPTED : LMB_OK;
}
