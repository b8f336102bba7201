#include "bench_report.h"

#include <stdio.h>
#include <string.h>

void bench_report_add(const lmb_bench_volume *bench, cJSON *samplers)
{
    const int series = BENCH_PATTERNS * bench_volume_loads(bench);
    for (int i = 0; i < bench->row_count * series; ++i) {
        const lmb_bench_volume_row *const row = &bench->row[i % bench->row_count];
        const int pattern = i / bench->row_count % BENCH_PATTERNS, load = i / bench->row_count / BENCH_PATTERNS;
        cJSON *const sampler = cJSON_CreateObject();
        cJSON_AddStringToObject(sampler, "name", row->name);
        cJSON_AddStringToObject(sampler, "pattern", bench_pattern_name((lmb_bench_pattern)pattern));
        cJSON_AddNumberToObject(sampler, "threads", bench_volume_threads(bench, load));
        cJSON_AddNumberToObject(sampler, "probes", bench->probes);
        cJSON_AddNumberToObject(sampler, "bytes_per_probe", row->bytes_per_probe);
        cJSON_AddNumberToObject(sampler, "ns_per_sample", row->ns_per_sample[load][pattern]);
        cJSON_AddNumberToObject(sampler, "rel_rmse", row->rel_rmse[pattern]);
        cJSON_AddItemToArray(samplers, sampler);
    }
}

static double ratio_of(const lmb_bench_volume_row *row, const lmb_bench_volume_row *base, int load, int pattern)
{
    return base && base->ns_per_sample[load][pattern] > 0.0
               ? row->ns_per_sample[load][pattern] / base->ns_per_sample[load][pattern]
               : 0.0;
}

static void rows_print(const lmb_bench_volume *bench, int load)
{
    const lmb_bench_volume_row *base = NULL;
    for (int i = 0; i < bench->row_count; ++i) {
        base = strcmp(bench->row[i].name, "dense.fp32") == 0 ? &bench->row[i] : base;
    }
    const int threads = bench_volume_threads(bench, load);
    printf("\n%d probes, %d thread%s\n", bench->probes, threads, threads > 1 ? "s" : "");
    printf("%-21s %11s %12s %8s %10s %8s %10s\n", "sampler", "bytes/probe", "coherent ns", "ratio", "random ns",
           "ratio", "rel. RMSE");
    for (int i = 0; i < bench->row_count; ++i) {
        const lmb_bench_volume_row *const row = &bench->row[i];
        const double *const ns = row->ns_per_sample[load];
        printf("%-21s %11.1f %12.1f %8.2f %10.1f %8.2f %10.1e\n", row->name, row->bytes_per_probe, ns[BENCH_COHERENT],
               ratio_of(row, base, load, BENCH_COHERENT), ns[BENCH_RANDOM], ratio_of(row, base, load, BENCH_RANDOM),
               row->rel_rmse[BENCH_RANDOM]);
    }
}

void bench_report_print(const lmb_bench_volume *bench)
{
    if (bench->dense_kernel) {
        printf("\nDense arrays by %s.", bench->dense_kernel);
    } else {
        printf("\nThe box is too large for dense arrays.");
    }
    puts(bench->has_nanovdb ? "" : " Built without NanoVDB.");
    for (int load = 0; load < bench_volume_loads(bench); ++load) {
        rows_print(bench, load);
    }
}
