/* All the ways to look up the light of a volume that `lambent bench` compares. */
#ifndef LMB_TOOLS_BENCH_SAMPLERS_H
#define LMB_TOOLS_BENCH_SAMPLERS_H

#include <lambent/probes.h>
#include <lambent/volume.h>

#include "bench_sampler.h"

enum { BENCH_MOST_SAMPLERS = 14 };

typedef struct lmb_bench_samplers {
    const char *dense_kernel; /* instructions that the dense arrays are sampled with; NULL: too large for them */
    bool has_nanovdb;
    int count;
    lmb_bench_sampler sampler[BENCH_MOST_SAMPLERS];
} lmb_bench_samplers;

/* Makes them of one level's probes, several at once. `volume` is what was packed of
 * them, and outlives the samplers; NULL: it is packed here.
 * @return what packing can, LMB_ERROR_MEMORY, LMB_ERROR_ARGUMENT (a thread cannot be started): then there is none */
lmb_result bench_samplers_create(const lmb_probes *probes, const lmb_volume *volume, lmb_bench_samplers *samplers,
                                 lmb_error *error);

void bench_samplers_destroy(lmb_bench_samplers *samplers);

#endif
