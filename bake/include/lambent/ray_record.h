/* Recording the rays that a tracer is asked for, and replaying them on bare Embree: what the tracing of a bake is
 * measured against.
 *
 * Rays are kept in runs, each of successive rays as one thread traced them, spread evenly over all that the thread
 * traced. */
#ifndef LAMBENT_RAY_RECORD_H
#define LAMBENT_RAY_RECORD_H

#include <lambent/pool.h>
#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What is asked of a ray. */
typedef enum lmb_ray_kind {
    LMB_RAY_NEAREST,   /* the nearest triangle */
    LMB_RAY_OCCLUDED,  /* whether there is any */
    LMB_RAY_CROSSINGS, /* all of them, by a filter function that sends the ray on */
    LMB_RAY_KINDS
} lmb_ray_kind;

enum { LMB_RAYS_PER_RUN = 4096 };

typedef struct lmb_ray_recorder lmb_ray_recorder;

/* Keeps one run of LMB_RAYS_PER_RUN rays in `keep_one_in` (> 0) of each thread. @return LMB_ERROR_MEMORY */
lmb_result lmb_ray_recorder_create(uint64_t keep_one_in, lmb_ray_recorder **recorder);
void lmb_ray_recorder_destroy(lmb_ray_recorder *recorder);

/* Notes a ray, from any thread; what traces rays calls this. */
void lmb_ray_record(lmb_ray_recorder *recorder, lmb_ray_kind kind, lmb_vec3 origin, lmb_vec3 direction,
                    float near_distance, float far_distance);

/* Makes the recorded rays ready to replay; after it nothing more may be recorded.
 * @return LMB_ERROR_MEMORY, also when recording ran out of it */
lmb_result lmb_ray_recorder_finish(lmb_ray_recorder *recorder);

/* Of a finished recorder: all rays seen of a kind, and those of them that were kept. */
uint64_t lmb_ray_recorder_seen(const lmb_ray_recorder *recorder, lmb_ray_kind kind);
uint64_t lmb_ray_recorder_kept(const lmb_ray_recorder *recorder, lmb_ray_kind kind);

/* Embree's calls to trace with. Crossings are always traced one by one: the filter is one for single rays. */
typedef enum lmb_ray_replay_call {
    LMB_REPLAY_SINGLE,
    LMB_REPLAY_PACKET_8,
    LMB_REPLAY_STREAM_COHERENT,
    LMB_REPLAY_STREAM_INCOHERENT,
    LMB_REPLAY_CALLS
} lmb_ray_replay_call;

/* Replays the kept rays of a finished recorder on the tracer's BVH, a run at a time on each thread of the pool. Nothing
 * is done with what they hit. `kind`: only rays of that kind, in the order in which they were traced; LMB_RAY_KINDS:
 * all of them, as they were traced, which needs LMB_REPLAY_SINGLE. `*hits`: how many hit something (of crossings none
 * do). @return LMB_ERROR_MEMORY */
lmb_result lmb_ray_replay(const lmb_tracer *tracer, const lmb_ray_recorder *recorder, lmb_ray_kind kind,
                          lmb_ray_replay_call call, lmb_pool *pool, uint64_t *hits);

#ifdef __cplusplus
}
#endif

#endif
