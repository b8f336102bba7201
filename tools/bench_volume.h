/* How fast the sampler is on a baked volume, beside other ways to hold the same light. */
#ifndef LMB_TOOLS_BENCH_VOLUME_H
#define LMB_TOOLS_BENCH_VOLUME_H

#include <lambent/error.h>

#include "bench_points.h"
#include "bench_samplers.h"

enum { BENCH_VOLUME_MOST_SAMPLES = 1 << 26 };

/* Alone, or `threads` at once. */
enum { BENCH_ALONE, BENCH_TOGETHER, BENCH_LOADS };

/* What is measured: a folder with probes.lmb and probes.vdb, or a house (house.h) of so many probes. */
typedef struct lmb_bench_source {
    const char *folder; /* NULL: a house */
    double house;
} lmb_bench_source;

typedef struct lmb_bench_settings {
    size_t samples; /* of each pattern */
    int repeats;    /* rounds, in which samplers take turns */
    int threads;    /* 1 to BENCH_MOST_THREADS */
} lmb_bench_settings;

typedef struct lmb_bench_volume_row {
    const char *name;
    double bytes_per_probe;
    double ns_per_sample[BENCH_LOADS][BENCH_PATTERNS]; /* CPU time of a thread; median of the repeats */
    double rel_rmse[BENCH_PATTERNS];                   /* of coefficients, against probes interpolated in double */
} lmb_bench_volume_row;

typedef struct lmb_bench_volume {
    int32_t probes;
    int threads;              /* of BENCH_TOGETHER; 1: there is no such figure */
    const char *dense_kernel; /* instructions that the dense arrays are sampled with; NULL: too large for them */
    bool has_nanovdb;
    int row_count;
    lmb_bench_volume_row row[BENCH_MOST_SAMPLERS];
} lmb_bench_volume;

/* How many loads were measured, and the threads of one. */
int bench_volume_loads(const lmb_bench_volume *bench);
int bench_volume_threads(const lmb_bench_volume *bench, int load);

/* Opens or makes a volume, and samples it with each sampler in turn.
 * @return what opening can, LMB_ERROR_FORMAT (the folder's files don't belong together; no cell with eight probes),
 * LMB_ERROR_ARGUMENT (threads cannot be started), _MEMORY */
lmb_result bench_volume_measure(const lmb_bench_source *source, const lmb_bench_settings *settings,
                                lmb_bench_volume *bench, lmb_error *error);

#endif
