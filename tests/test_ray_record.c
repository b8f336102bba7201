/* Recorded rays over a square whose hits are known by hand, replayed by every call of Embree's. */
#include <float.h>

#include <lambent/ray_record.h>

#include "level_fixture.h"
#include "scenes/levels.h"

#define LEVEL LMB_TEST_OUTPUT_DIR "/ray_record.glb"
enum { THREADS = 3, TASKS = 64, RAYS_PER_TASK = 1000 };

/* Rays from y = 1 straight down onto a square of 4 m on y = 0, along x from -4 to 4: half of them meet it. Of nearest
 * rays every fifth ends before it and every seventh starts behind it. */
typedef struct shot {
    lmb_vec3 origin;
    float near_distance, far_distance;
    bool hits;
} shot;

static shot shot_of(size_t task, int i)
{
    const float x = 8.0f * ((float)i + 0.5f) / (float)RAYS_PER_TASK - 4.0f;
    const bool is_short = i % 5 == 0;
    const bool is_behind = i % 7 == 0;
    return (shot){.origin = {x, 1.0f, (float)task / (float)TASKS},
                  .near_distance = is_behind ? 1.5f : 0.0f,
                  .far_distance = is_short ? 0.5f : 3.0f,
                  .hits = fabsf(x) < 2.0f && !is_short && !is_behind};
}

static const lmb_vec3 down = {0.0f, -1.0f, 0.0f};

static void shoot_task(void *context, size_t task, int worker)
{
    (void)worker;
    const lmb_tracer *tracer = context;
    for (int i = 0; i < RAYS_PER_TASK; ++i) {
        const shot s = shot_of(task, i);
        lmb_hit hit;
        uint64_t rays = 0;
        lmb_trace_nearest(tracer, s.origin, down, s.near_distance, s.far_distance, &hit);
        lmb_trace_transmittance_along(tracer, s.origin, down, FLT_MAX, &rays);
    }
}

/* Shoots under a recorder; NULL after a failed check. */
static lmb_ray_recorder *shoot(level_fixture *level, uint64_t keep_one_in)
{
    lmb_ray_recorder *recorder = NULL;
    if (lmb_ray_recorder_create(keep_one_in, &recorder) != LMB_OK) {
        CHECK(false, "out of memory");
        return NULL;
    }
    lmb_tracer_record(level->tracer, recorder);
    CHECK(lmb_pool_run(level->pool, TASKS, shoot_task, level->tracer, "shoot", NULL) == LMB_OK, "pool");
    lmb_tracer_record(level->tracer, NULL);
    shoot_task(level->tracer, 0, 0); /* nobody is to see these */
    CHECK(lmb_ray_recorder_finish(recorder) == LMB_OK, "finish");
    return recorder;
}

static bool ground_open(level_fixture *level)
{
    lmb_error error = {{0}};
    return level_fixture_open(level, LEVEL, lmb_level_open_ground(LEVEL, 4.0f, 0.5f, &error), &error, THREADS);
}

static void every_call_hits_what_was_hit(void)
{
    level_fixture level;
    lmb_ray_recorder *recorder = ground_open(&level) ? shoot(&level, 1) : NULL;
    if (!recorder) {
        return;
    }
    uint64_t expected[LMB_RAY_KINDS] = {0};
    for (size_t task = 0; task < TASKS; ++task) {
        for (int i = 0; i < RAYS_PER_TASK; ++i) {
            const shot s = shot_of(task, i);
            expected[LMB_RAY_NEAREST] += s.hits;
            expected[LMB_RAY_OCCLUDED] += fabsf(s.origin.x) < 2.0f;
        }
    }
    uint64_t hits;
    for (int kind = 0; kind < LMB_RAY_KINDS; ++kind) {
        const uint64_t all = kind == LMB_RAY_CROSSINGS ? 0 : (uint64_t)TASKS * RAYS_PER_TASK;
        CHECK(lmb_ray_recorder_seen(recorder, (lmb_ray_kind)kind) == all, "kind %d", kind);
        CHECK(lmb_ray_recorder_kept(recorder, (lmb_ray_kind)kind) == all, "kind %d", kind);
        for (int call = 0; call < LMB_REPLAY_CALLS; ++call) {
            CHECK(lmb_ray_replay(level.tracer, recorder, (lmb_ray_kind)kind, (lmb_ray_replay_call)call, level.pool,
                                 &hits) == LMB_OK,
                  "replay");
            CHECK(hits == expected[kind], "kind %d, call %d: %llu hits, not %llu", kind, call, (unsigned long long)hits,
                  (unsigned long long)expected[kind]);
        }
    }
    CHECK(lmb_ray_replay(level.tracer, recorder, LMB_RAY_KINDS, LMB_REPLAY_SINGLE, level.pool, &hits) == LMB_OK, " ");
    CHECK(hits == expected[LMB_RAY_NEAREST] + expected[LMB_RAY_OCCLUDED], "%llu hits", (unsigned long long)hits);
    lmb_ray_recorder_destroy(recorder);
    level_fixture_close(&level);
}

/* Each thread keeps every fourth of its runs, so at most one run off a quarter of what it traced. */
static void thinned_evenly(void)
{
    level_fixture level;
    lmb_ray_recorder *recorder = ground_open(&level) ? shoot(&level, 4) : NULL;
    if (!recorder) {
        return;
    }
    uint64_t seen = 0, kept = 0;
    for (int kind = 0; kind < LMB_RAY_KINDS; ++kind) {
        seen += lmb_ray_recorder_seen(recorder, (lmb_ray_kind)kind);
        kept += lmb_ray_recorder_kept(recorder, (lmb_ray_kind)kind);
    }
    CHECK(seen == 2u * TASKS * RAYS_PER_TASK, "%llu seen", (unsigned long long)seen);
    CHECK_NEAR((double)kept, (double)seen / 4.0, (double)THREADS * LMB_RAYS_PER_RUN, "of %llu",
               (unsigned long long)seen);
    lmb_ray_recorder_destroy(recorder);
    level_fixture_close(&level);
}

static const test_case cases[] = {
    {"every_call_hits_what_was_hit", every_call_hits_what_was_hit},
    {"thinned_evenly", thinned_evenly},
};

TEST_MAIN(cases)
