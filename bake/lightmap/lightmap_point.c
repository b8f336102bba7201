/* Gather points of texels: just off their surface, and outside of solids. */
#include <lambent/lightmap.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include <float.h>
#include <math.h>

#include "trace/trace_internal.h"

/* Directions around the texel, and the normal after them, that are searched for a way out. */
enum { AROUND_COUNT = 8, SEARCH_COUNT = AROUND_COUNT + 1 };

/* How far out of a solid a texel is moved, in texels: bilinear filtering shows a texel up to its diagonal away. */
#define REACH_TEXELS 1.42f

/* A point is inside a solid when at least this many of the directions below see back faces first. Half of them do
 * beside a wall without thickness, seen from its back, seven eighths in a dead end of three such walls, and those above
 * the plane under a sheet close by: those are no solids. */
enum { INSIDE_COUNT = 20, INSIDE_MIN_BACK = 18 };

/* Cosine and sine of k pi/4. */
static const float AROUND[AROUND_COUNT][2] = {
    {1.0f, 0.0f},  {0.70710678f, 0.70710678f},   {0.0f, 1.0f},  {-0.70710678f, 0.70710678f},
    {-1.0f, 0.0f}, {-0.70710678f, -0.70710678f}, {0.0f, -1.0f}, {0.70710678f, -0.70710678f}};

/* Rows of directions over the hemisphere: height above the plane, and every how many steps of AROUND. */
static const struct {
    float height;
    int step;
} INSIDE_ROWS[] = {{0.0f, 1}, {0.4f, 1}, {0.8f, 2}};

typedef struct lmb_frame {
    lmb_vec3 tangent, bitangent, normal;
} lmb_frame;

static lmb_vec3 frame_direction(const lmb_frame *frame, int step, float height)
{
    const float flat = sqrtf(1.0f - height * height);
    const lmb_vec3 side = lmb_vec3_add(lmb_vec3_scale(frame->tangent, AROUND[step][0] * flat),
                                       lmb_vec3_scale(frame->bitangent, AROUND[step][1] * flat));
    return lmb_vec3_mad(side, frame->normal, height);
}

/* How many of INSIDE_COUNT directions over the hemisphere see a back face first. */
static int back_count(const lmb_tracer *tracer, lmb_vec3 origin, const lmb_frame *frame)
{
    lmb_ray_batch rays;
    lmb_hit hit[LMB_RAY_BATCH];
    rays.count = 0;
    for (size_t row = 0; row < sizeof INSIDE_ROWS / sizeof INSIDE_ROWS[0]; ++row) {
        for (int step = 0; step < AROUND_COUNT; step += INSIDE_ROWS[row].step) {
            lmb_ray_batch_add(&rays, origin, frame_direction(frame, step, INSIDE_ROWS[row].height), FLT_MAX);
        }
    }
    lmb_trace_nearest_batch(tracer, &rays, hit);
    int count = 0;
    for (uint32_t i = 0; i < rays.count; ++i) {
        count += hit[i].instance != LMB_HIT_NOTHING && !hit[i].front;
    }
    return count;
}

/* A place just in front of a back face that was hit. */
typedef struct lmb_way_out {
    lmb_vec3 position;
    float distance;
} lmb_way_out;

/* The ways out within reach, nearest first. */
static int ways_out_find(const lmb_tracer *tracer, lmb_vec3 origin, const lmb_frame *frame, float reach,
                         lmb_way_out ways[SEARCH_COUNT])
{
    lmb_ray_batch rays;
    lmb_hit hits[LMB_RAY_BATCH];
    rays.count = 0;
    for (int k = 0; k < SEARCH_COUNT; ++k) {
        lmb_ray_batch_add(&rays, origin, k < AROUND_COUNT ? frame_direction(frame, k, 0.0f) : frame->normal, reach);
    }
    lmb_trace_nearest_batch(tracer, &rays, hits);
    int count = 0;
    for (uint32_t k = 0; k < rays.count; ++k) {
        const lmb_hit *hit = &hits[k];
        if (hit->instance == LMB_HIT_NOTHING || hit->front) {
            continue;
        }
        const lmb_vec3 direction = lmb_vec3_of(rays.direction[0][k], rays.direction[1][k], rays.direction[2][k]);
        const lmb_place place = lmb_trace_place(tracer, hit);
        int at = count++;
        for (; at > 0 && ways[at - 1].distance > hit->distance; --at) {
            ways[at] = ways[at - 1];
        }
        const lmb_vec3 beyond = lmb_trace_offset(place.position, place.geometric_normal, place.rounding, direction);
        ways[at] = (lmb_way_out){beyond, hit->distance};
    }
    return count;
}

lmb_gather_point lmb_surface_gather_point(const lmb_tracer *tracer, const lmb_place *place, float radius,
                                          bool *pushed_out)
{
    lmb_gather_point point = {
        .position =
            lmb_trace_offset(place->position, place->geometric_normal, place->rounding, place->geometric_normal),
        .hemisphere = true,
        .normal = place->shading_normal,
    };
    lmb_frame frame = {.normal = place->geometric_normal};
    lmb_vec3_frame(frame.normal, &frame.tangent, &frame.bitangent);
    lmb_way_out ways[SEARCH_COUNT];
    const int count = ways_out_find(tracer, point.position, &frame, REACH_TEXELS * radius, ways);
    *pushed_out = false;
    if (count == 0 || back_count(tracer, point.position, &frame) < INSIDE_MIN_BACK) {
        return point;
    }
    for (int i = 0; i < count; ++i) {
        /* Off the texel's own plane again: the back face may lean towards it. */
        const lmb_vec3 candidate =
            lmb_trace_offset(ways[i].position, place->geometric_normal, place->rounding, place->geometric_normal);
        if (lmb_vec3_dot(lmb_vec3_sub(candidate, place->position), place->geometric_normal) > 0.0f &&
            back_count(tracer, candidate, &frame) < INSIDE_MIN_BACK) {
            point.position = candidate;
            *pushed_out = true;
            break;
        }
    }
    return point;
}
