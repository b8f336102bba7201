/* How fast the sampler is on a baked volume, beside other ways to hold the same light. */
#ifndef LMB_TOOLS_BENCH_VOLUME_H
#define LMB_TOOLS_BENCH_VOLUME_H

#include <lambent/error.h>

#include "bench_points.h"

enum { BENCH_VOLUME_MOST_SAMPLERS = 12, BENCH_VOLUME_MOST_SAMPLES = 1 << 26 };

typedef struct lmb_bench_volume_row {
    const char *name;
    double bytes_per_probe;
    double ns_per_sample[BENCH_PATTERNS]; /* CPU time of the thread; median of the repeats */
    double rel_rmse[BENCH_PATTERNS];      /* of coefficients, against probes.vdb interpolated in double */
} lmb_bench_volume_row;

typedef struct lmb_bench_volume {
    int32_t probes;
    const char *dense_kernel; /* instructions that the dense arrays are sampled with; NULL: too large for them */
    bool has_nanovdb;
    int row_count;
    lmb_bench_volume_row row[BENCH_VOLUME_MOST_SAMPLERS];
} lmb_bench_volume;

/* Opens `folder`/probes.lmb and probes.vdb, and samples with each sampler in turn, `repeats` times.
 * @return what opening either can, LMB_ERROR_FORMAT (they don't belong together; no cell with eight probes), _MEMORY */
lmb_result bench_volume_measure(const char *folder, size_t samples, int repeats, lmb_bench_volume *bench,
                                lmb_error *error);

#endif
