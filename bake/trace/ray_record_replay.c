/* Recorded rays on bare Embree. */
#include <assert.h>
#include <stdlib.h>

#include <embree3/rtcore.h>

#include "trace/ray_record_internal.h"
#include "trace/trace_internal.h"

enum { PACKET = 8, STREAM = 256 };

typedef struct replay_work {
    RTCScene world;
    lmb_ray_run *const *runs;
    lmb_ray_kind kind;
    lmb_ray_replay_call call;
    uint64_t *hits; /* [run] */
} replay_work;

static struct RTCRay ray_of(const lmb_recorded_ray *recorded)
{
    return (struct RTCRay){.org_x = recorded->origin.x,
                           .org_y = recorded->origin.y,
                           .org_z = recorded->origin.z,
                           .tnear = recorded->near_distance,
                           .dir_x = recorded->direction.x,
                           .dir_y = recorded->direction.y,
                           .dir_z = recorded->direction.z,
                           .tfar = recorded->far_distance,
                           .mask = ~0u};
}

static struct RTCRayHit ray_hit_of(const lmb_recorded_ray *recorded)
{
    return (struct RTCRayHit){
        .ray = ray_of(recorded),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
    };
}

/* Sends a ray on through everything. */
static void hit_reject(const struct RTCFilterFunctionNArguments *arguments)
{
    arguments->valid[0] = 0;
}

static bool replay_single(RTCScene world, lmb_ray_kind kind, const lmb_recorded_ray *recorded)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (kind == LMB_RAY_OCCLUDED) {
        struct RTCRay ray = ray_of(recorded);
        rtcOccluded1(world, &context, &ray);
        return ray.tfar < 0.0f;
    }
    context.filter = kind == LMB_RAY_CROSSINGS ? hit_reject : NULL;
    struct RTCRayHit ray = ray_hit_of(recorded);
    rtcIntersect1(world, &context, &ray);
    return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

static void packet_fill(struct RTCRay8 *packet, int *valid, const lmb_ray_run *run, uint32_t first, uint32_t count)
{
    for (uint32_t lane = 0; lane < PACKET; ++lane) {
        valid[lane] = lane < count ? -1 : 0;
        const lmb_recorded_ray *ray = &run->ray[run->order[first + (lane < count ? lane : 0)]];
        packet->org_x[lane] = ray->origin.x;
        packet->org_y[lane] = ray->origin.y;
        packet->org_z[lane] = ray->origin.z;
        packet->tnear[lane] = ray->near_distance;
        packet->dir_x[lane] = ray->direction.x;
        packet->dir_y[lane] = ray->direction.y;
        packet->dir_z[lane] = ray->direction.z;
        packet->time[lane] = 0.0f;
        packet->tfar[lane] = ray->far_distance;
        packet->mask[lane] = ~0u;
        packet->id[lane] = 0;
        packet->flags[lane] = 0;
    }
}

/* Up to PACKET rays of the work's kind. */
static uint64_t replay_packet(const replay_work *work, const lmb_ray_run *run, uint32_t first, uint32_t count)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    _Alignas(32) int valid[PACKET];
    uint64_t hits = 0;
    if (work->kind == LMB_RAY_OCCLUDED) {
        struct RTCRay8 packet;
        packet_fill(&packet, valid, run, first, count);
        rtcOccluded8(valid, work->world, &context, &packet);
        for (uint32_t lane = 0; lane < count; ++lane) {
            hits += packet.tfar[lane] < 0.0f;
        }
        return hits;
    }
    struct RTCRayHit8 packet;
    packet_fill(&packet.ray, valid, run, first, count);
    for (uint32_t lane = 0; lane < PACKET; ++lane) {
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, work->world, &context, &packet);
    for (uint32_t lane = 0; lane < count; ++lane) {
        hits += packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

/* Up to STREAM rays of the work's kind. */
static uint64_t replay_stream(const replay_work *work, const lmb_ray_run *run, uint32_t first, uint32_t count)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = work->call == LMB_REPLAY_STREAM_COHERENT ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                                             : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    uint64_t hits = 0;
    if (work->kind == LMB_RAY_OCCLUDED) {
        struct RTCRay rays[STREAM];
        for (uint32_t i = 0; i < count; ++i) {
            rays[i] = ray_of(&run->ray[run->order[first + i]]);
        }
        rtcOccluded1M(work->world, &context, rays, count, sizeof rays[0]);
        for (uint32_t i = 0; i < count; ++i) {
            hits += rays[i].tfar < 0.0f;
        }
        return hits;
    }
    struct RTCRayHit rays[STREAM];
    for (uint32_t i = 0; i < count; ++i) {
        rays[i] = ray_hit_of(&run->ray[run->order[first + i]]);
    }
    rtcIntersect1M(work->world, &context, rays, count, sizeof rays[0]);
    for (uint32_t i = 0; i < count; ++i) {
        hits += rays[i].hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

static void replay_task(void *context, size_t task, int worker)
{
    (void)worker;
    const replay_work *work = context;
    const lmb_ray_run *run = work->runs[task];
    uint64_t hits = 0;
    if (work->kind == LMB_RAY_KINDS) {
        for (uint32_t i = 0; i < run->count; ++i) {
            hits += replay_single(work->world, (lmb_ray_kind)run->kind[i], &run->ray[i]);
        }
        work->hits[task] = hits;
        return;
    }
    const bool single = work->call == LMB_REPLAY_SINGLE || work->kind == LMB_RAY_CROSSINGS;
    const uint32_t step = single ? 1 : work->call == LMB_REPLAY_PACKET_8 ? PACKET : STREAM;
    const uint32_t end = run->first_of[work->kind + 1];
    for (uint32_t i = run->first_of[work->kind]; i < end; i += step) {
        const uint32_t count = end - i < step ? end - i : step;
        hits += single                              ? replay_single(work->world, work->kind, &run->ray[run->order[i]])
                : work->call == LMB_REPLAY_PACKET_8 ? replay_packet(work, run, i, count)
                                                    : replay_stream(work, run, i, count);
    }
    work->hits[task] = hits;
}

lmb_result lmb_ray_replay(const lmb_tracer *tracer, const lmb_ray_recorder *recorder, lmb_ray_kind kind,
                          lmb_ray_replay_call call, lmb_pool *pool, uint64_t *hits)
{
    assert(kind != LMB_RAY_KINDS || call == LMB_REPLAY_SINGLE);
    size_t count;
    replay_work work = {
        .world = lmb_tracer_world(tracer), .runs = lmb_ray_recorder_runs(recorder, &count), .kind = kind, .call = call};
    work.hits = calloc(count + 1, sizeof *work.hits);
    if (!work.hits) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_pool_run(pool, count, replay_task, &work, "replay", NULL);
    *hits = 0;
    for (size_t i = 0; i < count; ++i) {
        *hits += work.hits[i];
    }
    free(work.hits);
    return result;
}
