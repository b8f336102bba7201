/* What `lambent bench` found of volumes, as text and as JSON. */
#ifndef LMB_TOOLS_BENCH_REPORT_H
#define LMB_TOOLS_BENCH_REPORT_H

#include <cjson/cJSON.h>

#include "bench_volume.h"

/* Prints a table of a volume. */
void bench_report_print(const lmb_bench_volume *bench);

/* Adds an object for each sampler, pattern and number of threads to a list. */
void bench_report_add(const lmb_bench_volume *bench, cJSON *samplers);

#endif
