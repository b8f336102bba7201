/* One pool of threads for all work, and how long work says how far it is.
 *
 * Work is a number of independent tasks; results go to slots of their own, so that nothing depends on which thread
 * ran what. */
#ifndef LAMBENT_POOL_H
#define LAMBENT_POOL_H

#include <stdbool.h>
#include <stddef.h>

#include <lambent/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Called from the thread that called the work, about ten times a second and at its end, with done in [0, 1].
 * Returning false asks the work to stop. */
typedef bool (*lmb_progress_function)(void *context, const char *phase, double done);

typedef struct lmb_progress {
    lmb_progress_function report; /* NULL: silent, never stopped */
    void *context;
} lmb_progress;

typedef struct lmb_pool lmb_pool;

/* One task, 0 <= task < count, on thread `worker`, 0 <= worker < lmb_pool_threads. */
typedef void (*lmb_task_function)(void *context, size_t task, int worker);

/* `threads` <= 0 means one for each processor. @return LMB_ERROR_MEMORY */
lmb_result lmb_pool_create(int threads, lmb_pool **pool);
void lmb_pool_destroy(lmb_pool *pool);
int lmb_pool_threads(const lmb_pool *pool);

/* Runs every task and waits for them, in an order that makes progress even. Must not be called from inside a task.
 * `progress` may be NULL. @return LMB_OK, or LMB_ERROR_INTERRUPTED when `progress` asked to stop: then some tasks have
 * not run */
lmb_result lmb_pool_run(lmb_pool *pool, size_t count, lmb_task_function function, void *context, const char *phase,
                        const lmb_progress *progress);

#ifdef __cplusplus
}
#endif

#endif
