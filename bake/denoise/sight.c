#include "denoise/sight.h"

#include <float.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "trace/trace_internal.h"

/* Points on surfaces look from so far over them (spacings): a surface that bulges between two whose normals differ by
 * as much as neighbours' may, eight spacings apart, rises half a spacing over them. Not from more than half of the way
 * to what hangs there. */
#define EYE_SPACINGS 0.5f

/* Directions along the surface in which a point looks for what stands on it. */
enum { AROUND = 16 };

/* A straight wall is nearer than the nearest of them says, by less than this factor. */
#define STRAIGHT_ON 0.98f

/* Cosine and sine of k pi/8. */
static const float AROUND_SIDE[AROUND][2] = {
    {1.0f, 0.0f},  {0.92387953f, 0.38268343f},   {0.70710678f, 0.70710678f},   {0.38268343f, 0.92387953f},
    {0.0f, 1.0f},  {-0.38268343f, 0.92387953f},  {-0.70710678f, 0.70710678f},  {-0.92387953f, 0.38268343f},
    {-1.0f, 0.0f}, {-0.92387953f, -0.38268343f}, {-0.70710678f, -0.70710678f}, {-0.38268343f, -0.92387953f},
    {0.0f, -1.0f}, {0.38268343f, -0.92387953f},  {0.70710678f, -0.70710678f},  {0.92387953f, -0.38268343f}};

static lmb_vec3 eye_over(const lmb_sight *sight, lmb_vec3 position, lmb_vec3 normal, float spacing)
{
    const lmb_vec3 start = lmb_vec3_mad(position, normal, lmb_trace_epsilon(position));
    lmb_hit hit;
    const float most = EYE_SPACINGS * spacing;
    const bool low = lmb_trace_nearest(sight->tracer, start, normal, 0.0f, 2.0f * most, &hit);
    return lmb_vec3_mad(start, normal, low ? 0.5f * hit.distance : most);
}

static void surface_point_look(lmb_sight *sight, uint32_t rank)
{
    const lmb_neighbour_cells *cells = sight->cells;
    const lmb_vec3 position = {cells->x[rank], cells->y[rank], cells->z[rank]};
    const lmb_vec3 normal = {cells->nx[rank], cells->ny[rank], cells->nz[rank]};
    const lmb_vec3 eye = eye_over(sight, position, normal, cells->spacing[rank]);
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(normal, &tangent, &bitangent);
    lmb_ray_batch rays = {.count = 0};
    lmb_hit hit[LMB_RAY_BATCH];
    for (int k = 0; k < AROUND; ++k) {
        const lmb_vec3 side =
            lmb_vec3_add(lmb_vec3_scale(tangent, AROUND_SIDE[k][0]), lmb_vec3_scale(bitangent, AROUND_SIDE[k][1]));
        lmb_ray_batch_add(&rays, eye, side, cells->reach * cells->spacing[rank]);
    }
    lmb_trace_nearest_batch(sight->tracer, &rays, hit);
    sight->eye[rank] = eye;
    sight->clear[rank] = FLT_MAX;
    for (uint32_t k = 0; k < rays.count; ++k) {
        if (hit[k].instance != LMB_HIT_NOTHING) {
            sight->clear[rank] = lmb_smaller(sight->clear[rank], STRAIGHT_ON * hit[k].distance);
        }
    }
}

static void look_task(void *context, size_t cell, int worker)
{
    (void)worker;
    lmb_sight *const sight = context;
    const lmb_neighbour_cells *cells = sight->cells;
    for (uint32_t rank = cells->first[cell]; rank < cells->first[cell + 1]; ++rank) {
        if (cells->nx[rank] == 0.0f && cells->ny[rank] == 0.0f && cells->nz[rank] == 0.0f) {
            sight->eye[rank] = lmb_vec3_of(cells->x[rank], cells->y[rank], cells->z[rank]);
            sight->clear[rank] = 0.0f;
        } else {
            surface_point_look(sight, rank);
        }
    }
}

lmb_result lmb_sight_make(const lmb_tracer *tracer, const lmb_neighbour_cells *cells, lmb_pool *pool, lmb_sight *sight)
{
    *sight = (lmb_sight){.tracer = tracer, .cells = cells};
    if (!tracer) {
        return LMB_OK;
    }
    sight->eye = malloc(((size_t)cells->count + 1) * sizeof *sight->eye);
    sight->clear = malloc(((size_t)cells->count + 1) * sizeof *sight->clear);
    lmb_result result = LMB_ERROR_MEMORY;
    if (sight->eye && sight->clear) {
        result = lmb_pool_run(pool, cells->cell_count, look_task, sight, "denoise", NULL);
    }
    if (result != LMB_OK) {
        lmb_sight_free(sight);
    }
    return result;
}

void lmb_sight_free(lmb_sight *sight)
{
    free(sight->eye);
    free(sight->clear);
    *sight = (lmb_sight){.tracer = NULL};
}

/* Rays to neighbours, and which of the list they are. */
typedef struct sight_rays {
    lmb_ray_batch batch;
    uint32_t place[LMB_RAY_BATCH];
} sight_rays;

static void rays_trace(const lmb_sight *sight, sight_rays *rays, bool seen[LMB_NEIGHBOURS_MOST])
{
    lmb_rgb share[LMB_RAY_BATCH];
    uint64_t traced = 0;
    lmb_trace_transmittance_batch(sight->tracer, &rays->batch, share, &traced);
    for (uint32_t i = 0; i < rays->batch.count; ++i) {
        seen[rays->place[i]] = lmb_rgb_max(share[i]) > 0.0f;
    }
    rays->batch.count = 0;
}

void lmb_sight_keep(const lmb_sight *sight, lmb_neighbours *found)
{
    if (!sight->tracer) {
        return;
    }
    bool seen[LMB_NEIGHBOURS_MOST];
    sight_rays rays;
    rays.batch.count = 0;
    const uint32_t rank = found->rank[0];
    for (uint32_t i = 1; i < found->count; ++i) {
        const uint32_t other = found->rank[i];
        const lmb_vec3 from = sight->eye[rank < other ? rank : other];
        const lmb_vec3 way = lmb_vec3_sub(sight->eye[rank < other ? other : rank], from);
        const float clear = lmb_smaller(sight->clear[rank], sight->clear[other]);
        seen[i] = lmb_vec3_dot(way, way) < clear * clear;
        if (!seen[i]) {
            rays.place[rays.batch.count] = i;
            lmb_ray_batch_add(&rays.batch, from, way, LMB_TRACE_UP_TO_END);
        }
        if (rays.batch.count == LMB_RAY_BATCH) {
            rays_trace(sight, &rays, seen);
        }
    }
    if (rays.batch.count > 0) {
        rays_trace(sight, &rays, seen);
    }
    uint32_t kept = 1;
    for (uint32_t i = 1; i < found->count; ++i) {
        found->rank[kept] = found->rank[i];
        found->candidate[kept] = found->candidate[i];
        kept += seen[i];
    }
    found->count = kept;
}
