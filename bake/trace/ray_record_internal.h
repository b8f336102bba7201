/* Recorded rays, as ray_record_replay.c reads them. */
#ifndef LMB_RAY_RECORD_INTERNAL_H
#define LMB_RAY_RECORD_INTERNAL_H

#include <lambent/ray_record.h>

typedef struct lmb_recorded_ray {
    lmb_vec3 origin;
    float near_distance;
    lmb_vec3 direction;
    float far_distance;
} lmb_recorded_ray;

typedef struct lmb_ray_run {
    struct lmb_ray_run *next; /* of the same thread */
    uint32_t count;
    lmb_recorded_ray ray[LMB_RAYS_PER_RUN];
    uint8_t kind[LMB_RAYS_PER_RUN];
    /* Once finished: `order` lists the rays of each kind, from first_of[kind] to before first_of[kind + 1]. */
    uint16_t order[LMB_RAYS_PER_RUN];
    uint32_t first_of[LMB_RAY_KINDS + 1];
} lmb_ray_run;

/* All runs of a finished recorder. */
lmb_ray_run *const *lmb_ray_recorder_runs(const lmb_ray_recorder *recorder, size_t *count);

#endif
