/* How long a sampler takes, alone and beside itself. */
#ifndef LMB_TOOLS_BENCH_TIME_H
#define LMB_TOOLS_BENCH_TIME_H

#include "bench_sampler.h"

enum { BENCH_MOST_THREADS = 64 };

/* Samples at `count` positions, BENCH_CHUNK at a time, shared out to threads that begin together; one thread is the
 * caller's.
 * @return CPU seconds of all threads: n of them that do not get into each other's way take what one does; -1 where one
 * cannot be started */
double bench_time(const lmb_bench_sampler *sampler, const lmb_vec3 *position, size_t count, int threads);

#endif
