#include "bench_time.h"

#include <pthread.h>
#include <stdbool.h>

#include "cpu_time.h"

/* Where threads wait for each other. */
typedef struct gate {
    pthread_mutex_t mutex;
    pthread_cond_t opened;
    bool is_open;
} gate;

typedef struct share {
    const lmb_bench_sampler *sampler;
    const lmb_vec3 *position;
    size_t count;
    gate *start;
    double seconds;
} share;

static void gate_wait(gate *start)
{
    pthread_mutex_lock(&start->mutex);
    while (!start->is_open) {
        pthread_cond_wait(&start->opened, &start->mutex);
    }
    pthread_mutex_unlock(&start->mutex);
}

static void gate_open(gate *start)
{
    pthread_mutex_lock(&start->mutex);
    start->is_open = true;
    pthread_cond_broadcast(&start->opened);
    pthread_mutex_unlock(&start->mutex);
}

static void *share_run(void *context)
{
    share *const own = context;
    lmb_sh3_rgb radiance[BENCH_CHUNK];
    /* Once for nothing: a new thread's stack is no memory yet. */
    own->sampler->sample(own->sampler->data, own->position, own->count < BENCH_CHUNK ? own->count : BENCH_CHUNK,
                         radiance);
    gate_wait(own->start);
    const double start = cpu_time_of_thread();
    for (size_t first = 0; first < own->count; first += BENCH_CHUNK) {
        const size_t left = own->count - first;
        own->sampler->sample(own->sampler->data, own->position + first, left < BENCH_CHUNK ? left : BENCH_CHUNK,
                             radiance);
    }
    own->seconds = cpu_time_of_thread() - start;
    return NULL;
}

double bench_time(const lmb_bench_sampler *sampler, const lmb_vec3 *position, size_t count, int threads)
{
    gate start = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, false};
    share part[BENCH_MOST_THREADS];
    pthread_t thread[BENCH_MOST_THREADS];
    int started = 1;
    for (int i = 0; i < threads; ++i) {
        const size_t first = count * (size_t)i / (size_t)threads, end = count * ((size_t)i + 1) / (size_t)threads;
        part[i] = (share){sampler, position + first, end - first, &start, 0.0};
    }
    while (started < threads && pthread_create(&thread[started], NULL, share_run, &part[started]) == 0) {
        ++started;
    }
    gate_open(&start);
    share_run(&part[0]);
    double seconds = part[0].seconds;
    for (int i = 1; i < started; ++i) {
        pthread_join(thread[i], NULL);
        seconds += part[i].seconds;
    }
    pthread_cond_destroy(&start.opened);
    pthread_mutex_destroy(&start.mutex);
    return started == threads ? seconds : -1.0;
}
