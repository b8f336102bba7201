#include "bench_rays.h"

#include <stdlib.h>

#include "command.h"
#include "cpu_time.h"

const lmb_bake_phase bench_phases[BENCH_PHASES] = {LMB_PHASE_PLACE, LMB_PHASE_SURFACE, LMB_PHASE_PROBES,
                                                   LMB_PHASE_LIGHTMAPS};

/* About as many rays of each phase are kept. */
#define RAYS_KEPT ((uint64_t)1 << 20)

typedef struct time_pair {
    double wall, cpu;
} time_pair;

/* What was measured of one phase at one number of threads. */
typedef struct phase_times {
    time_pair bake[BENCH_MAX_REPEATS];
    time_pair bare[BENCH_MAX_REPEATS];
    double call[LMB_RAY_KINDS][LMB_REPLAY_CALLS][BENCH_MAX_REPEATS];
} phase_times;

typedef struct bench_work {
    const lmb_bake_settings *settings;
    lmb_level *level;
    const lmb_progress *progress;
    lmb_ray_recorder *recorder[BENCH_PHASES];
    uint64_t rays[BENCH_PHASES]; /* as the bake counts them */
    phase_times times[2][BENCH_PHASES];
} bench_work;

static time_pair time_now(void)
{
    return (time_pair){seconds_now(), cpu_time_of_process()};
}

static time_pair time_since(time_pair start)
{
    const time_pair now = time_now();
    return (time_pair){now.wall - start.wall, now.cpu - start.cpu};
}

/* One whole bake in memory. `times`: where the time of each phase goes. `record`: whether to make recorders. */
static lmb_result bake_once(bench_work *work, bool record, time_pair times[BENCH_PHASES], lmb_error *error)
{
    static lmb_result (*const phases[BENCH_PHASES])(lmb_bake *, lmb_error *) = {lmb_bake_place, lmb_bake_surface,
                                                                                lmb_bake_probes, lmb_bake_lightmaps};
    lmb_bake bake = lmb_bake_begin(work->settings, work->level, work->progress);
    lmb_result result = LMB_OK;
    for (int phase = 0; phase < BENCH_PHASES && result == LMB_OK; ++phase) {
        if (bench_phases[phase] == LMB_PHASE_LIGHTMAPS) {
            result = lmb_bake_layout(&bake, error);
        }
        if (record && result == LMB_OK) {
            result = lmb_ray_recorder_create(1 + work->rays[phase] / RAYS_KEPT, &work->recorder[phase]);
            lmb_tracer_record(work->level->tracer, work->recorder[phase]);
        }
        const time_pair start = time_now();
        if (result == LMB_OK) {
            result = phases[phase](&bake, error);
        }
        times[phase] = time_since(start);
        if (record && result == LMB_OK) {
            result = lmb_ray_recorder_finish(work->recorder[phase]);
        }
        work->rays[phase] = bake.record.rays[bench_phases[phase]];
    }
    lmb_tracer_record(work->level->tracer, NULL);
    lmb_bake_end(&bake);
    return result;
}

static lmb_result replay_timed(const bench_work *work, int phase, lmb_ray_kind kind, lmb_ray_replay_call call,
                               time_pair *time)
{
    uint64_t hits;
    const time_pair start = time_now();
    const lmb_result result =
        lmb_ray_replay(work->level->tracer, work->recorder[phase], kind, call, work->level->pool, &hits);
    *time = time_since(start);
    return result;
}

static lmb_result replay_once(bench_work *work, phase_times times[BENCH_PHASES], int repeat)
{
    lmb_result result = LMB_OK;
    for (int phase = 0; phase < BENCH_PHASES && result == LMB_OK; ++phase) {
        result = replay_timed(work, phase, LMB_RAY_KINDS, LMB_REPLAY_SINGLE, &times[phase].bare[repeat]);
        for (int kind = 0; kind < LMB_RAY_KINDS; ++kind) {
            for (int call = 0; call < LMB_REPLAY_CALLS && result == LMB_OK; ++call) {
                time_pair time;
                result = replay_timed(work, phase, (lmb_ray_kind)kind, (lmb_ray_replay_call)call, &time);
                times[phase].call[kind][call][repeat] = time.wall;
            }
        }
    }
    return result;
}

static int double_compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(const double *values, int count)
{
    double sorted[BENCH_MAX_REPEATS];
    for (int i = 0; i < count; ++i) {
        sorted[i] = values[i];
    }
    qsort(sorted, (size_t)count, sizeof sorted[0], double_compare);
    return 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
}

static time_pair median_pair(const time_pair *times, int count)
{
    double wall[BENCH_MAX_REPEATS], cpu[BENCH_MAX_REPEATS];
    for (int i = 0; i < count; ++i) {
        wall[i] = times[i].wall;
        cpu[i] = times[i].cpu;
    }
    return (time_pair){median(wall, count), median(cpu, count)};
}

static lmb_bench_phase phase_summary(const bench_work *work, const phase_times *times, int phase, int repeats)
{
    lmb_bench_phase summary = {0};
    for (int kind = 0; kind < LMB_RAY_KINDS; ++kind) {
        summary.rays += lmb_ray_recorder_seen(work->recorder[phase], (lmb_ray_kind)kind);
        summary.recorded += lmb_ray_recorder_kept(work->recorder[phase], (lmb_ray_kind)kind);
        double best = 0.0;
        for (int call = 0; call < LMB_REPLAY_CALLS; ++call) {
            const double seconds = median(times->call[kind][call], repeats);
            if (call == 0 || seconds < best) {
                best = seconds;
                summary.best[kind] = (lmb_ray_replay_call)call;
            }
        }
        summary.best_seconds += best;
    }
    const time_pair bake = median_pair(times->bake, repeats);
    const time_pair bare = median_pair(times->bare, repeats);
    const double scale = summary.recorded > 0 ? (double)summary.rays / (double)summary.recorded : 0.0;
    summary.seconds = bake.wall;
    summary.cpu_seconds = bake.cpu;
    summary.bare_seconds = scale * bare.wall;
    summary.bare_cpu_seconds = scale * bare.cpu;
    summary.best_seconds *= scale;
    return summary;
}

static lmb_result pool_replace(lmb_level *level, int threads)
{
    lmb_pool_destroy(level->pool);
    level->pool = NULL;
    return lmb_pool_create(threads, &level->pool);
}

static lmb_result work_measure(bench_work *work, int threads, int repeats, lmb_error *error)
{
    time_pair unused[BENCH_PHASES];
    lmb_result result = bake_once(work, false, unused, error);
    work->level->warnings = (lmb_warnings){NULL, NULL}; /* the first bake has given them */
    if (result == LMB_OK) {
        result = bake_once(work, true, unused, error);
    }
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (int many = 0; many < 2 && result == LMB_OK; ++many) {
            time_pair times[BENCH_PHASES];
            result = pool_replace(work->level, many ? threads : 1);
            if (result == LMB_OK) {
                result = bake_once(work, false, times, error);
            }
            for (int phase = 0; phase < BENCH_PHASES && result == LMB_OK; ++phase) {
                work->times[many][phase].bake[repeat] = times[phase];
            }
            if (result == LMB_OK) {
                result = replay_once(work, work->times[many], repeat);
            }
        }
    }
    return result;
}

lmb_result bench_rays_measure(const lmb_bake_settings *settings, lmb_level *level, int repeats,
                              const lmb_progress *progress, lmb_bench_rays *bench, lmb_error *error)
{
    bench_work *work = calloc(1, sizeof *work);
    if (!work) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "out of memory");
    }
    work->settings = settings;
    work->level = level;
    work->progress = progress;
    bench->threads = lmb_pool_threads(level->pool);
    const lmb_result result = work_measure(work, bench->threads, repeats, error);
    for (int many = 0; many < 2 && result == LMB_OK; ++many) {
        for (int phase = 0; phase < BENCH_PHASES; ++phase) {
            bench->phase[many][phase] = phase_summary(work, &work->times[many][phase], phase, repeats);
        }
    }
    for (int phase = 0; phase < BENCH_PHASES; ++phase) {
        lmb_ray_recorder_destroy(work->recorder[phase]);
    }
    free(work);
    return result == LMB_OK || error->message[0] ? result : lmb_error_set(error, result, "%s", lmb_result_text(result));
}
