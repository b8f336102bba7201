#include <lambent/trace.h>

#include <float.h>
#include <math.h>

#include "trace/trace_embree.h"

bool lmb_trace_nearest(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float near_distance,
                       float far_distance, lmb_hit *hit)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit ray = {
        .ray = ray_make(origin, direction, near_distance, far_distance),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
    };
    ray_note(tracer, LMB_RAY_NEAREST, &ray.ray);
    rtcIntersect1(tracer->world, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return false;
    }
    hit_set(tracer, &ray, hit);
    return true;
}

static void packet_nearest(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first, lmb_hit hit[PACKET])
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit8 packet;
    packet_intersect(tracer, &context, rays, first, &packet);
    for (int lane = 0; lane < PACKET; ++lane) {
        const struct RTCRayHit ray = packet_lane(&packet, lane);
        hit_set_or_nothing(tracer, &ray, &hit[lane]);
    }
}

void lmb_trace_nearest_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_hit hit[LMB_RAY_BATCH])
{
    batch_note(tracer, LMB_RAY_NEAREST, rays, rays->count);
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_nearest(tracer, rays, i, &hit[i]);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (; i < rays->count; ++i) {
        struct RTCRayHit ray = {
            .ray = ray_of_batch(rays, i),
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
        };
        rtcIntersect1(tracer->world, &context, &ray);
        hit_set_or_nothing(tracer, &ray, &hit[i]);
    }
}

bool lmb_tracer_has_layers(const lmb_tracer *tracer)
{
    return tracer->any_see_through;
}

bool lmb_tracer_is_see_through(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
{
    const lmb_mesh *mesh = &tracer->scene->meshes[tracer->scene->instances[instance].mesh];
    return tracer->is_see_through[mesh->material[triangle]];
}

typedef struct crossing_context {
    struct RTCIntersectContext embree; /* first: Embree hands it back */
    const lmb_tracer *tracer;
    lmb_vec3 direction;
    int crossings;
} crossing_context;

/* Counts a hit and sends the ray on. */
static void crossing_count(const struct RTCFilterFunctionNArguments *arguments)
{
    crossing_context *context = (crossing_context *)arguments->context;
    const struct RTCHit *hit = (const struct RTCHit *)arguments->hit; /* of one ray: N is 1 */
    arguments->valid[0] = 0;
    if (!lmb_tracer_is_see_through(context->tracer, hit_instance(hit), hit->primID)) {
        context->crossings += hit_is_front(context->tracer, hit, context->direction) ? -1 : 1;
    }
}

int lmb_trace_crossings(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction)
{
    crossing_context context = {.tracer = tracer, .direction = direction};
    rtcInitIntersectContext(&context.embree);
    context.embree.filter = crossing_count;
    struct RTCRayHit ray = {
        .ray = ray_make(origin, direction, 0.0f, FLT_MAX),
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
    };
    ray_note(tracer, LMB_RAY_CROSSINGS, &ray.ray);
    rtcIntersect1(tracer->world, &context.embree, &ray);
    return context.crossings;
}

float lmb_trace_beyond(float distance)
{
    return nextafterf(distance * (1.0f + 4.0f * FLT_EPSILON), FLT_MAX);
}

float lmb_trace_epsilon(lmb_vec3 position)
{
    return trace_epsilon(position);
}

lmb_vec3 lmb_trace_offset(lmb_vec3 position, lmb_vec3 geometric_normal, float rounding, lmb_vec3 direction)
{
    return trace_offset(position, geometric_normal, rounding, direction);
}
