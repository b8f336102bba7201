/* How fast the phases of a bake trace their rays, beside bare Embree on the same rays. */
#ifndef LMB_TOOLS_BENCH_RAYS_H
#define LMB_TOOLS_BENCH_RAYS_H

#include <lambent/bake_phases.h>
#include <lambent/ray_record.h>

enum { BENCH_MAX_REPEATS = 99 };

/* The phases that trace, in the order in which they run. */
enum { BENCH_PHASES = 4 };
extern const lmb_bake_phase bench_phases[BENCH_PHASES];

/* One phase at one number of threads: medians over the repeats. Seconds of Embree are those that it would need for all
 * rays of the phase, from those of the recorded ones. */
typedef struct lmb_bench_phase {
    uint64_t rays;                         /* that the phase traced */
    uint64_t recorded;                     /* of them, kept and replayed */
    double seconds, cpu_seconds;           /* of the bake */
    double bare_seconds, bare_cpu_seconds; /* single rays, in the order in which the bake traced them */
    double best_seconds;                   /* each kind of rays by the call that is fastest for it */
    lmb_ray_replay_call best[LMB_RAY_KINDS];
} lmb_bench_phase;

/* [0]: on one thread, [1]: on `threads`. When `threads` is 1 both are the same. */
typedef struct lmb_bench_rays {
    int threads;
    lmb_bench_phase phase[2][BENCH_PHASES];
} lmb_bench_rays;

/* Bakes once to count rays, once to record them, and then `repeats` times (1 to BENCH_MAX_REPEATS) bakes and replays in
 * turn, on one thread and on all of the level's. `level` is left with another pool.
 * @return what baking can, and LMB_ERROR_MEMORY */
lmb_result bench_rays_measure(const lmb_bake_settings *settings, lmb_level *level, int repeats,
                              const lmb_progress *progress, lmb_bench_rays *bench, lmb_error *error);

#endif
