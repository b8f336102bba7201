/* One way of looking up the light of a volume: what `lambent bench` times. */
#ifndef LMB_TOOLS_BENCH_SAMPLER_H
#define LMB_TOOLS_BENCH_SAMPLER_H

#include <stddef.h>

#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Samples that a sampler is asked for at a time: as many objects as a game may move, whose light stays in the caches.
 */
enum { BENCH_CHUNK = 256 };

typedef struct lmb_bench_sampler {
    const char *name;
    void *data;
    double bytes; /* of memory that holds the light */
    /* SH3 radiance at positions in the world, metres, all within cells that have eight probes. */
    void (*sample)(const void *data, const lmb_vec3 *position, size_t count, lmb_sh3_rgb *radiance);
    void (*destroy)(void *data); /* NULL: the data is another sampler's */
} lmb_bench_sampler;

static inline void bench_sampler_destroy(lmb_bench_sampler *sampler)
{
    if (sampler->destroy) {
        sampler->destroy(sampler->data);
    }
}

#ifdef __cplusplus
}
#endif

#endif
