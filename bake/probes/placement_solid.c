/* Which lattice points lie in free space. */
#include "probes/placement_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "base/clock.h"
#include "base/directions.h"
#include "trace/trace_internal.h"

enum { RAYS_PER_POINT = LMB_RAY_BATCH, WINDING_RAYS = 32, POINTS_PER_TASK = 64 };

/* Above this share of back faces among the hits a point is looked at twice. */
#define SUSPICIOUS_BACK_SHARE 0.5f
/* A room that faces inwards has a winding number of -1, free space 0, a solid +1, a solid within a room 0. */
#define ROOM_WINDING (-0.25f)

/* Between two reports, seconds. */
#define REPORT_SECONDS 0.1

typedef struct lmb_classify_work {
    lmb_survey *survey;
    uint64_t *rays; /* [task] */
} lmb_classify_work;

/* Leaves, glass and other see-through surfaces bound no solid, whichever side they show. */
static bool hit_is_back(const lmb_tracer *tracer, const lmb_hit *hit)
{
    return !hit->front && !lmb_tracer_is_see_through(tracer, hit->instance, hit->triangle);
}

/* The same directions at every point, turned by the point's own stream: no pattern, and no state. */
static void point_rays(lmb_vec3 position, lmb_ray_batch *rays)
{
    float x[RAYS_PER_POINT], y[RAYS_PER_POINT];
    float *const direction[3] = {rays->direction[0], rays->direction[1], rays->direction[2]};
    lmb_sequence_2d_batch(lmb_stream_of_position(0, position), 0, RAYS_PER_POINT, 0, x, y);
    lmb_directions_make(LMB_LOBE_SPHERE, lmb_vec3_of(0.0f, 0.0f, 1.0f), x, y, RAYS_PER_POINT, direction);
    rays->count = RAYS_PER_POINT;
    for (uint32_t i = 0; i < RAYS_PER_POINT; ++i) {
        rays->origin[0][i] = position.x;
        rays->origin[1][i] = position.y;
        rays->origin[2][i] = position.z;
        rays->far_distance[i] = FLT_MAX;
    }
}

static bool winding_is_free(const lmb_tracer *tracer, lmb_vec3 position, const lmb_ray_batch *rays)
{
    int crossings = 0;
    for (uint32_t i = 0; i < WINDING_RAYS; ++i) {
        const lmb_vec3 direction = lmb_vec3_of(rays->direction[0][i], rays->direction[1][i], rays->direction[2][i]);
        crossings += lmb_trace_crossings(tracer, position, direction);
    }
    return (float)crossings < ROOM_WINDING * (float)WINDING_RAYS;
}

float lmb_placement_validity(const lmb_tracer *tracer, lmb_vec3 position, bool *is_free, uint64_t *rays_traced)
{
    lmb_ray_batch rays;
    lmb_hit hit[LMB_RAY_BATCH];
    point_rays(position, &rays);
    lmb_trace_nearest_batch(tracer, &rays, hit);
    *rays_traced += RAYS_PER_POINT;
    int hits = 0;
    int backs = 0;
    for (uint32_t i = 0; i < RAYS_PER_POINT; ++i) {
        if (hit[i].instance != LMB_HIT_NOTHING) {
            ++hits;
            backs += hit_is_back(tracer, &hit[i]);
        }
    }
    *is_free = true;
    if (hits > 0 && (float)backs > SUSPICIOUS_BACK_SHARE * (float)hits) {
        *is_free = winding_is_free(tracer, position, &rays);
        *rays_traced += WINDING_RAYS;
    }
    /* A free point is valid, however much of it double-sided scenery turns its back on. */
    const float share = 1.0f - (float)backs / (float)RAYS_PER_POINT;
    return *is_free ? lmb_larger(share, LMB_PROBES_MIN_VALIDITY) : lmb_smaller(share, 0.5f * LMB_PROBES_MIN_VALIDITY);
}

bool lmb_placement_is_free(const lmb_tracer *tracer, lmb_vec3 position, uint64_t *rays)
{
    bool is_free;
    lmb_placement_validity(tracer, position, &is_free, rays);
    return is_free;
}

static void classify_task(void *context, size_t task, int worker)
{
    (void)worker;
    const lmb_classify_work *work = context;
    lmb_survey *survey = work->survey;
    const size_t count = (size_t)survey->points.count;
    const size_t first = (size_t)survey->classified + task * POINTS_PER_TASK;
    const size_t last = first + POINTS_PER_TASK < count ? first + POINTS_PER_TASK : count;
    uint64_t rays = 0;
    for (size_t i = first; i < last; ++i) {
        bool is_free;
        const lmb_vec3 lattice_point = survey_position(survey, survey->points.point[i]);
        const lmb_vec3 position = lmb_placement_relocate(survey->tracer, lattice_point, survey->box.spacing, &rays);
        survey->validity[i] = lmb_placement_validity(survey->tracer, position, &is_free, &rays);
        survey->free[i] = is_free;
    }
    work->rays[task] = rays;
}

/* How far the whole box is: a flood comes in many small parts. */
static bool report_share(void *context, const char *phase, double done)
{
    lmb_survey *survey = context;
    const double now = lmb_clock_seconds();
    const double points = survey->classified + done * (survey->points.count - survey->classified);
    const bool is_end = points >= survey_box_points(survey);
    if (now - survey->reported < REPORT_SECONDS && !is_end) {
        return true;
    }
    survey->reported = now;
    return survey->progress->report(survey->progress->context, phase, points / survey_box_points(survey));
}

static bool arrays_grow(lmb_survey *survey)
{
    const size_t room = (size_t)survey->points.room;
    float *const validity = realloc(survey->validity, room * sizeof *validity);
    survey->validity = validity ? validity : survey->validity;
    uint8_t *const is_free = realloc(survey->free, room * sizeof *is_free);
    survey->free = is_free ? is_free : survey->free;
    return validity && is_free;
}

lmb_result lmb_survey_classify(lmb_survey *survey)
{
    if (survey->classified == survey->points.count) {
        return LMB_OK;
    }
    const size_t added = (size_t)(survey->points.count - survey->classified);
    const size_t tasks = (added + POINTS_PER_TASK - 1) / POINTS_PER_TASK;
    lmb_classify_work work = {survey, calloc(tasks, sizeof *work.rays)};
    if (!work.rays || !arrays_grow(survey)) {
        free(work.rays);
        return LMB_ERROR_MEMORY;
    }
    const bool reports = survey->progress && survey->progress->report;
    const lmb_progress progress = {reports ? report_share : NULL, survey};
    const lmb_result result = lmb_pool_run(survey->pool, tasks, classify_task, &work, "place", &progress);
    for (size_t i = 0; i < tasks; ++i) {
        survey->rays += work.rays[i];
    }
    survey->classified = survey->points.count;
    free(work.rays);
    return result;
}

lmb_result lmb_survey_fill(lmb_survey *survey)
{
    if (survey_box_points(survey) > LMB_POINT_SET_MOST) {
        return LMB_ERROR_UNSUPPORTED;
    }
    const int32_t *const min = survey->box.min, *const size = survey->box.size;
    lmb_result result = LMB_OK;
    for (int32_t z = 0; z < size[2]; ++z) {
        for (int32_t y = 0; y < size[1]; ++y) {
            for (int32_t x = 0; x < size[0] && result == LMB_OK; ++x) {
                result = lmb_point_set_add(&survey->points, (const int32_t[3]){min[0] + x, min[1] + y, min[2] + z});
            }
        }
    }
    return result == LMB_OK ? lmb_survey_classify(survey) : result;
}
