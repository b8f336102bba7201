#define _POSIX_C_SOURCE 200809L
#include "bench_volume.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#include <lambent/file.h>
#include <lambent/vdb.h>
#include <lambent/volume.h>

#include "bench_dense.h"
#include "bench_forms.h"
#include "bench_grids.h"

/* Samples that a sampler is asked for at a time: as many objects as a game may move, whose light stays in the caches.
 */
enum { CHUNK = BENCH_CHUNK };

/* Samples of each pattern whose error is looked at. */
enum { ERROR_SAMPLES = 4096 };

typedef struct bench_work {
    lmb_volume *volume;
    lmb_probes *probes;
    size_t samples;
    int repeats;
    lmb_vec3 *position[BENCH_PATTERNS];
    lmb_bench_sampler sampler[BENCH_VOLUME_MOST_SAMPLERS];
    int sampler_count;
    double *seconds; /* [(sampler * BENCH_PATTERNS + pattern) * repeats + repeat] */
} bench_work;

static double thread_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double pattern_time(const bench_work *work, const lmb_bench_sampler *sampler, lmb_bench_pattern pattern)
{
    static lmb_sh3_rgb radiance[CHUNK];
    const double start = thread_seconds();
    for (size_t first = 0; first < work->samples; first += CHUNK) {
        const size_t left = work->samples - first;
        sampler->sample(sampler->data, work->position[pattern] + first, left < CHUNK ? left : CHUNK, radiance);
    }
    return thread_seconds() - start;
}

static double pattern_error(const bench_work *work, const lmb_bench_sampler *sampler, lmb_bench_pattern pattern)
{
    const size_t step = work->samples / ERROR_SAMPLES + 1;
    double error = 0.0, energy = 0.0;
    for (size_t i = 0; i < work->samples; i += step) {
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

/* All samplers in turn, so that what else the machine does meets them alike. The first round warms up. */
static void rounds_run(bench_work *work)
{
    for (int repeat = -1; repeat < work->repeats; ++repeat) {
        for (int i = 0; i < work->sampler_count; ++i) {
            for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
                const double seconds = pattern_time(work, &work->sampler[i], (lmb_bench_pattern)pattern);
                if (repeat >= 0) {
                    work->seconds[(i * BENCH_PATTERNS + pattern) * work->repeats + repeat] = seconds;
                }
            }
        }
    }
}

static void rows_fill(bench_work *work, lmb_bench_volume *bench)
{
    bench->row_count = work->sampler_count;
    for (int i = 0; i < work->sampler_count; ++i) {
        const lmb_bench_sampler *const sampler = &work->sampler[i];
        lmb_bench_volume_row *const row = &bench->row[i];
        row->name = sampler->name;
        row->bytes_per_probe = sampler->bytes / bench->probes;
        for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
            double *const seconds = &work->seconds[(i * BENCH_PATTERNS + pattern) * work->repeats];
            row->ns_per_sample[pattern] = 1e9 * median(seconds, work->repeats) / (double)work->samples;
            row->rel_rmse[pattern] = pattern_error(work, sampler, (lmb_bench_pattern)pattern);
        }
    }
}

static lmb_result samplers_create(bench_work *work, lmb_bench_volume *bench, lmb_error *error)
{
    const double bytes = (double)lmb_volume_get_info(work->volume).file_bytes;
    work->sampler[work->sampler_count++] =
        (lmb_bench_sampler){"lambent", work->volume, bytes, bench_sample_single, NULL};
    work->sampler[work->sampler_count++] =
        (lmb_bench_sampler){"lambent.batch", work->volume, bytes, bench_sample_batch, NULL};
    lmb_result result = bench_dense_create(work->probes, &work->sampler[work->sampler_count]);
    if (result == LMB_OK) {
        work->sampler_count += BENCH_DENSE_SAMPLERS;
        bench->dense_kernel = bench_dense_kernel_name();
    } else if (result != LMB_ERROR_ARGUMENT) {
        return lmb_error_set(error, result, "dense arrays: %s", lmb_result_text(result));
    }
    const int grids = bench_grids_create(work->probes, &work->sampler[work->sampler_count]);
    if (grids == 0) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "OpenVDB: the grids cannot be made");
    }
    work->sampler_count += grids;
    result = bench_forms_create(work->probes, &work->sampler[work->sampler_count]);
    if (result != LMB_OK) {
        return lmb_error_set(error, result, "other forms of the volume: %s", lmb_result_text(result));
    }
    work->sampler_count += BENCH_FORMS;
    bench->has_nanovdb = grids == BENCH_GRID_SAMPLERS;
    return LMB_OK;
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

static lmb_result points_make(bench_work *work, const char *folder, lmb_error *error)
{
    lmb_result result = LMB_OK;
    for (int pattern = 0; pattern < BENCH_PATTERNS && result == LMB_OK; ++pattern) {
        work->position[pattern] = malloc(work->samples * sizeof *work->position[pattern]);
        result = work->position[pattern] ? bench_points_fill(work->probes, (lmb_bench_pattern)pattern, work->samples,
                                                             work->position[pattern])
                                         : LMB_ERROR_MEMORY;
    }
    const size_t times = (size_t)(BENCH_VOLUME_MOST_SAMPLERS * BENCH_PATTERNS) * (size_t)work->repeats;
    work->seconds = malloc(times * sizeof *work->seconds);
    if (result == LMB_OK && !work->seconds) {
        result = LMB_ERROR_MEMORY;
    }
    if (result == LMB_ERROR_FORMAT) {
        return lmb_error_set(error, result, "%s/probes.vdb: no cell has eight baked probes to interpolate", folder);
    }
    return result == LMB_OK ? result : lmb_error_set(error, result, "%s", lmb_result_text(result));
}

lmb_result bench_volume_measure(const char *folder, size_t samples, int repeats, lmb_bench_volume *bench,
                                lmb_error *error)
{
    bench_work work = {.samples = samples, .repeats = repeats};
    *bench = (lmb_bench_volume){0};
    lmb_result result = files_open(&work, folder, error);
    if (result == LMB_OK) {
        bench->probes = work.probes->count;
        result = points_make(&work, folder, error);
    }
    if (result == LMB_OK) {
        result = samplers_create(&work, bench, error);
    }
    if (result == LMB_OK) {
        rounds_run(&work);
        rows_fill(&work, bench);
    }
    for (int i = 0; i < work.sampler_count; ++i) {
        bench_sampler_destroy(&work.sampler[i]);
    }
    for (int pattern = 0; pattern < BENCH_PATTERNS; ++pattern) {
        free(work.position[pattern]);
    }
    free(work.seconds);
    lmb_volume_close(work.volume);
    lmb_probes_destroy(work.probes);
    return result;
}
