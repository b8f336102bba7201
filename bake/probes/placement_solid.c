/* Which lattice points lie in free space, and which of them can be reached. */
#include "probes/placement_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/sequence.h>

#include "base/rgb.h"
#include "base/scalar.h"
#include "base/vec3.h"
#include "base/directions.h"
#include "trace/trace_internal.h"

enum { RAYS_PER_POINT = LMB_RAY_BATCH, WINDING_RAYS = 32, POINTS_PER_TASK = 64 };

/* Above this share of back faces among the hits a point is looked at twice. */
#define SUSPICIOUS_BACK_SHARE 0.5f
/* A room that faces inwards has a winding number of -1, free space 0, a solid +1, a solid within a room 0. */
#define ROOM_WINDING (-0.25f)

typedef struct lmb_classify_work {
    lmb_survey *survey;
    const lmb_tracer *tracer;
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
    lmb_directions_make(LMB_LOBE_SPHERE, vec3(0.0f, 0.0f, 1.0f), x, y, RAYS_PER_POINT, direction);
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
        const lmb_vec3 direction = vec3(rays->direction[0][i], rays->direction[1][i], rays->direction[2][i]);
        crossings += lmb_trace_crossings(tracer, position, direction);
    }
    return (float)crossings < ROOM_WINDING * (float)WINDING_RAYS;
}

static float point_validity(const lmb_tracer *tracer, lmb_vec3 position, bool *is_free, uint64_t *rays_traced)
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
    return *is_free ? float_larger(share, LMB_PROBES_MIN_VALIDITY)
                    : float_smaller(share, 0.5f * LMB_PROBES_MIN_VALIDITY);
}

bool lmb_placement_is_free(const lmb_tracer *tracer, lmb_vec3 position, uint64_t *rays)
{
    bool is_free;
    point_validity(tracer, position, &is_free, rays);
    return is_free;
}

static void classify_task(void *context, size_t task, int worker)
{
    (void)worker;
    const lmb_classify_work *work = context;
    lmb_survey *survey = work->survey;
    const size_t first = task * POINTS_PER_TASK;
    const size_t last = first + POINTS_PER_TASK < survey->count ? first + POINTS_PER_TASK : survey->count;
    uint64_t rays = 0;
    for (size_t i = first; i < last; ++i) {
        const int32_t x = (int32_t)(i % (size_t)survey->size[0]);
        const int32_t y = (int32_t)(i / (size_t)survey->size[0] % (size_t)survey->size[1]);
        const int32_t z = (int32_t)(i / (size_t)survey->size[0] / (size_t)survey->size[1]);
        bool is_free;
        const lmb_vec3 position =
            lmb_placement_relocate(work->tracer, survey_position(survey, x, y, z), survey->spacing, &rays);
        survey->validity[i] = point_validity(work->tracer, position, &is_free, &rays);
        survey->free[i] = is_free;
    }
    work->rays[task] = rays;
}

lmb_result lmb_survey_classify(lmb_survey *survey, const lmb_tracer *tracer, lmb_pool *pool,
                               const lmb_progress *progress, uint64_t *rays)
{
    const size_t tasks = (survey->count + POINTS_PER_TASK - 1) / POINTS_PER_TASK;
    lmb_classify_work work = {survey, tracer, calloc(tasks + 1, sizeof *work.rays)};
    if (!work.rays) {
        return LMB_ERROR_MEMORY;
    }
    const lmb_result result = lmb_pool_run(pool, tasks, classify_task, &work, "place", progress);
    for (size_t i = 0; i < tasks; ++i) {
        *rays += work.rays[i];
    }
    free(work.rays);
    return result;
}

/* The free lattice point nearest to a seed among the corners of its cell, or SIZE_MAX, and why. */
static size_t seed_point(const lmb_survey *survey, lmb_vec3 seed, lmb_seed_state *state)
{
    const double world[3] = {(double)seed.x + survey->origin.x, (double)seed.y + survey->origin.y,
                             (double)seed.z + survey->origin.z};
    *state = LMB_SEED_OUTSIDE;
    int32_t cell[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double at = floor(world[axis] / (double)survey->spacing) - (double)survey->min[axis];
        if (!(at >= 0.0 && at + 1.0 < (double)survey->size[axis])) {
            return SIZE_MAX;
        }
        cell[axis] = (int32_t)at;
    }
    size_t nearest = SIZE_MAX;
    float nearest_distance = FLT_MAX;
    for (int k = 0; k < 8; ++k) {
        const int32_t x = cell[0] + (k & 1), y = cell[1] + (k >> 1 & 1), z = cell[2] + (k >> 2);
        const size_t index = survey_index(survey, x, y, z);
        const float distance = vec3_length(vec3_sub(survey_position(survey, x, y, z), seed));
        if (survey->free[index] && distance < nearest_distance) {
            nearest = index;
            nearest_distance = distance;
        }
    }
    *state = nearest == SIZE_MAX ? LMB_SEED_SOLID : LMB_SEED_FREE;
    return nearest;
}

static bool points_connected(const lmb_survey *survey, const lmb_tracer *tracer, size_t a, size_t b, uint64_t *rays)
{
    const size_t row = (size_t)survey->size[0];
    const size_t slice = row * (size_t)survey->size[1];
    const lmb_vec3 from = survey_position(survey, (int32_t)(a % row), (int32_t)(a % slice / row), (int32_t)(a / slice));
    const lmb_vec3 to = survey_position(survey, (int32_t)(b % row), (int32_t)(b % slice / row), (int32_t)(b / slice));
    return rgb_max(lmb_trace_transmittance(tracer, from, to, rays)) > 0.0f;
}

lmb_result lmb_survey_flood(lmb_survey *survey, const lmb_tracer *tracer, const lmb_vec3 *seeds, uint32_t seed_count,
                            lmb_seed_state *states, uint64_t *rays)
{
    uint8_t *reached = calloc(survey->count, 1);
    size_t *queue = malloc(survey->count * sizeof *queue);
    if (!reached || !queue) {
        free(reached);
        free(queue);
        return LMB_ERROR_MEMORY;
    }
    size_t filled = 0;
    for (uint32_t i = 0; i < seed_count; ++i) {
        const size_t point = seed_point(survey, seeds[i], &states[i]);
        if (point != SIZE_MAX && !reached[point]) {
            reached[point] = 1;
            queue[filled++] = point;
        }
    }
    const size_t row = (size_t)survey->size[0];
    const size_t slice = row * (size_t)survey->size[1];
    for (size_t done = 0; done < filled; ++done) {
        const size_t at = queue[done];
        const size_t coordinate[3] = {at % row, at % slice / row, at / slice};
        const size_t stride[3] = {1, row, slice};
        for (int side = 0; side < 6; ++side) {
            const int axis = side / 2;
            const bool up = side % 2 == 1;
            if (up ? coordinate[axis] + 1 >= (size_t)survey->size[axis] : coordinate[axis] == 0) {
                continue;
            }
            const size_t next = up ? at + stride[axis] : at - stride[axis];
            if (survey->free[next] && !reached[next] && points_connected(survey, tracer, at, next, rays)) {
                reached[next] = 1;
                queue[filled++] = next;
            }
        }
    }
    for (size_t i = 0; i < survey->count; ++i) {
        survey->free[i] = reached[i];
    }
    free(reached);
    free(queue);
    return LMB_OK;
}
