#include "bench_volume.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/file.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include "bench_samplers.h"
#include "bench_time.h"
#include "house.h"

/* Samples of each pattern whose error is looked at. */
enum { ERROR_SAMPLES = 4096 };

typedef struct bench_work {
    lmb_volume *volume; /* NULL: a house */
    lmb_probes *probes;
    const lmb_bench_settings *settings;
    int loads;
    lmb_vec3 *position[BENCH_PATTERNS];
    lmb_bench_samplers samplers;
    double *seconds; /* [((sampler * BENCH_LOADS + load) * BENCH_PATTERNS + pattern) * repeats + repeat] */
} bench_work;

int bench_volume_loads(const lmb_bench_volume *bench)
{
    return bench->threads > 1 ? BENCH_LOADS : 1;
}

int bench_volume_threads(const lmb_bench_volume *bench, int load)
{
    return load == BENCH_ALONE ? 1 : bench->threads;
}

static double *times_of(const bench_work *work, int sampler, int load, int pattern)
{
    const int series = (sampler * BENCH_LOADS + load) * BENCH_PATTERNS + pattern;
    return work->seconds + (size_t)series * (size_t)work->settings->repeats;
}

static double pattern_error(const bench_work *work, const lmb_bench_sampler *sampler, lmb_bench_pattern pattern)
{
    const size_t step = work->settings->samples / ERROR_SAMPLES + 1;
    double error = 0.0, energy = 0.0;
    for (size_t i = 0; i < work->settings->samples; i += step) {
        lmb_sh3_rgb radiance;
        double truth[27];
        sampler->sample(sampler->data, &work->position[pattern][i], 1, &radiance);
        bench_points_truth(work->probes, work->position[pattern][i], truth);
        for (int k = 0; k < 27; ++k) {
            const double off = (double)radiance.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT] - truth[k];
            error += off * off;
            energy += truth[k] * truth[k];
        }
    }
    return energy > 0.0 ? sqrt(error / energy) : sqrt(error);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

/* One sampler's turn. @return false where threads cannot be started */
static bool turn_run(bench_work *work, int sampler, int load, int repeat)
{
    for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
        const double seconds = bench_time(&work->samplers.sampler[sampler], work->position[pattern],
                                          work->settings->samples, load == BENCH_ALONE ? 1 : work->settings->threads);
        if (seconds < 0.0) {
            return false;
        }
        if (repeat >= 0) {
            times_of(work, sampler, load, pattern)[repeat] = seconds;
        }
    }
    return true;
}

/* All samplers in turn, so that what else the machine does meets them alike, and each finds the caches full of
 * another's light. The first round warms up. */
static lmb_result rounds_run(bench_work *work, lmb_error *error)
{
    const int turns = work->loads * work->samplers.count;
    for (int i = -turns; i < work->settings->repeats * turns; ++i) {
        const int turn = (i + turns) % turns;
        const int load = turn / work->samplers.count, sampler = turn % work->samplers.count;
        if (!turn_run(work, sampler, load, i < 0 ? -1 : i / turns)) {
            return lmb_error_set(error, LMB_ERROR_ARGUMENT, "%d threads cannot be started", work->settings->threads);
        }
    }
    return LMB_OK;
}

static void rows_fill(bench_work *work, lmb_bench_volume *bench)
{
    bench->dense_kernel = work->samplers.dense_kernel;
    bench->has_nanovdb = work->samplers.has_nanovdb;
    bench->row_count = work->samplers.count;
    for (int i = 0; i < work->samplers.count; ++i) {
        const lmb_bench_sampler *const sampler = &work->samplers.sampler[i];
        lmb_bench_volume_row *const row = &bench->row[i];
        row->name = sampler->name;
        row->bytes_per_probe = sampler->bytes / bench->probes;
        for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
            for (int load = 0; load < work->loads; ++load) {
                const double seconds = median(times_of(work, i, load, pattern), work->settings->repeats);
                row->ns_per_sample[load][pattern] = 1e9 * seconds / (double)work->settings->samples;
            }
            row->rel_rmse[pattern] = pattern_error(work, sampler, (lmb_bench_pattern)pattern);
        }
    }
}

static lmb_result files_open(bench_work *work, const char *folder, lmb_error *error)
{
    char *const lmb = lmb_file_in(folder, "probes.lmb");
    char *const vdb = lmb_file_in(folder, "probes.vdb");
    lmb_result result = lmb && vdb ? LMB_OK : LMB_ERROR_MEMORY;
    if (result != LMB_OK) {
        lmb_error_set(error, result, "%s: out of memory", folder);
        goto cleanup;
    }
    result = lmb_volume_open_file(lmb, &work->volume);
    if (result != LMB_OK) {
        lmb_error_set(error, result, "%s: %s", lmb, lmb_result_text(result));
        goto cleanup;
    }
    result = lmb_vdb_read(vdb, &work->probes, NULL, NULL, error);
    if (result != LMB_OK) {
        goto cleanup;
    }
    const lmb_volume_info info = lmb_volume_get_info(work->volume);
    const lmb_vec3d low = lmb_lattice_position(&work->probes->level[0].lattice, work->probes->level[0].lattice.min);
    if (lmb_volume_spacing_at(work->volume, low) != work->probes->level[0].lattice.spacing ||
        info.probe_count > (uint64_t)work->probes->count) {
        result = lmb_error_set(error, LMB_ERROR_FORMAT, "%s: not made from the probes.vdb beside it", lmb);
    }
cleanup:
    free(lmb);
    free(vdb);
    return result;
}

static lmb_result points_make(bench_work *work, const lmb_bench_source *source, lmb_error *error)
{
    const size_t samples = work->settings->samples;
    const size_t series = (size_t)BENCH_MOST_SAMPLERS * BENCH_LOADS * BENCH_PATTERNS;
    work->seconds = malloc(series * (size_t)work->settings->repeats * sizeof *work->seconds);
    lmb_result result = work->seconds ? LMB_OK : LMB_ERROR_MEMORY;
    for (int pattern = 0; pattern < BENCH_PATTERNS && result == LMB_OK; ++pattern) {
        work->position[pattern] = malloc(samples * sizeof *work->position[pattern]);
        result = work->position[pattern]
                     ? bench_points_fill(work->probes, (lmb_bench_pattern)pattern, samples, work->position[pattern])
                     : LMB_ERROR_MEMORY;
    }
    if (result == LMB_ERROR_FORMAT) {
        return lmb_error_set(error, result, "%s%s: no cell has eight baked probes to interpolate",
                             source->folder ? source->folder : "house", source->folder ? "/probes.vdb" : "");
    }
    return result == LMB_OK ? result : lmb_error_set(error, result, "%s", lmb_result_text(result));
}

static void work_free(bench_work *work)
{
    bench_samplers_destroy(&work->samplers);
    for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
        free(work->position[pattern]);
    }
    free(work->seconds);
    lmb_volume_close(work->volume);
    lmb_probes_destroy(work->probes);
}

lmb_result bench_volume_measure(const lmb_bench_source *source, const lmb_bench_settings *settings,
                                lmb_bench_volume *bench, lmb_error *error)
{
    bench_work work = {.settings = settings, .loads = settings->threads > 1 ? BENCH_LOADS : 1};
    *bench = (lmb_bench_volume){.threads = settings->threads};
    lmb_result result = LMB_OK;
    if (source->folder) {
        result = files_open(&work, source->folder, error);
    } else {
        work.probes = house_probes(source->house);
        result = work.probes ? LMB_OK : lmb_error_set(error, LMB_ERROR_MEMORY, "house: out of memory");
    }
    if (result == LMB_OK) {
        bench->probes = work.probes->count;
        result = points_make(&work, source, error);
    }
    if (result == LMB_OK) {
        result = bench_samplers_create(work.probes, work.volume, &work.samplers, error);
    }
    if (result == LMB_OK) {
        result = rounds_run(&work, error);
    }
    if (result == LMB_OK) {
        rows_fill(&work, bench);
    }
    work_free(&work);
    return result;
}
