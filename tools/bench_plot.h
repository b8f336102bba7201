/* What a sample costs against how many probes there are, as a picture. */
#ifndef LMB_TOOLS_BENCH_PLOT_H
#define LMB_TOOLS_BENCH_PLOT_H

#include "bench_volume.h"

/* Writes an SVG that needs no other file and suits light and dark pages: a plot of ns against probes for each pattern
 * and number of threads, both axes logarithmic, a line for each sampler with its name at its end, and under them each
 * one's bytes a probe and error in the largest volume. `bench` has `count` >= 1 volumes, in any order; `machine` is a
 * line of text. The file is replaced at once.
 * @return LMB_ERROR_MEMORY, _WRITE */
lmb_result bench_plot_write(const char *path, const lmb_bench_volume *bench, int count, const char *machine,
                            lmb_error *error);

#endif
