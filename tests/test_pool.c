/* The pool runs every task once, whatever their number, and its progress is even and never goes back. */
#include <lambent/pool.h>

#include "harness.h"

enum { MOST = 1200 };

static void count_task(void *context, size_t task, int worker)
{
    (void)worker;
    ++((int *)context)[task];
}

static void every_task_runs_once(void)
{
    lmb_pool *pool;
    CHECK(lmb_pool_create(3, &pool) == LMB_OK, "pool");
    for (size_t count = 0; count <= MOST; ++count) {
        int runs[MOST + 1] = {0};
        CHECK(lmb_pool_run(pool, count, count_task, runs, "count", NULL) == LMB_OK, "%zu tasks", count);
        size_t once = 0;
        for (size_t i = 0; i <= MOST; ++i) {
            once += runs[i] == (i < count);
        }
        CHECK(once == MOST + 1, "of %zu tasks some did not run once", count);
    }
    lmb_pool_destroy(pool);
}

/* Tasks of which the latter half cost much more than the first: in any quarter of the run, as many of them. */
typedef struct order {
    size_t ran;
    size_t late[4];
} order;

static void order_task(void *context, size_t task, int worker)
{
    (void)worker;
    order *o = context;
    o->late[o->ran++ * 4 / 1024] += task >= 512;
}

static void order_is_even(void)
{
    lmb_pool *pool;
    CHECK(lmb_pool_create(1, &pool) == LMB_OK, "pool");
    order o = {0};
    CHECK(lmb_pool_run(pool, 1024, order_task, &o, "order", NULL) == LMB_OK, "run");
    for (int i = 0; i < 4; ++i) {
        CHECK_NEAR((double)o.late[i], 128.0, 16.0, "quarter %d", i);
    }
    lmb_pool_destroy(pool);
}

static const test_case cases[] = {
    {"every_task_runs_once", every_task_runs_once},
    {"order_is_even", order_is_even},
};

TEST_MAIN(cases)
