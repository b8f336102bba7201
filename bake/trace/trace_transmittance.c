/* Shadow rays: what gets through. */
#include <float.h>

#include <lambent/vector.h>

#include "trace/trace_layers.h"

/* Sends shadow rays on through what leaves some of their light. */
static void shadow_filter(const struct RTCFilterFunctionNArguments *arguments)
{
    const lmb_layer_walk *walk = (const lmb_layer_walk *)arguments->context;
    for (unsigned i = 0; i < arguments->N; ++i) {
        lmb_shown_hit shown;
        if (arguments->valid[i] && lmb_layer_shown(arguments, i, &shown)) {
            const lmb_layer found = {shown.distance, shown.instance, shown.triangle, shown.coverage.pass};
            lmb_layer_add(&walk->passed[shown.lane], &found);
            arguments->valid[i] = 0;
        }
    }
}

/* The rest of a shadow ray from `start` on, which layers up to there have left `share` of. */
static lmb_rgb shadow_follow(const lmb_tracer *tracer, struct RTCRay ray, float start, lmb_rgb share, uint64_t *rays)
{
    const float end = ray.tfar;
    do {
        lmb_layer_walk walk;
        lmb_layers passed;
        lmb_layer_walk_start(&walk, tracer, shadow_filter, NULL, &passed, 1);
        ray.tnear = start;
        ray.tfar = end;
        ++*rays;
        ray_note(tracer, LMB_RAY_OCCLUDED, &ray);
        rtcOccluded1(tracer->world, &walk.embree, &ray);
        if (ray.tfar < 0.0f) {
            return lmb_rgb_of(0.0f, 0.0f, 0.0f);
        }
        share = lmb_rgb_mul(share, lmb_layers_share(&passed, FLT_MAX));
        start = lmb_layers_left_from(&passed, FLT_MAX);
    } while (start > 0.0f && start < end && lmb_rgb_max(share) > 0.0f);
    return share;
}

static lmb_rgb share_of_occluded(float far_distance)
{
    const float open = far_distance < 0.0f ? 0.0f : 1.0f;
    return lmb_rgb_of(open, open, open);
}

lmb_rgb lmb_trace_transmittance_along(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float far_distance,
                                      uint64_t *rays)
{
    struct RTCRay ray = ray_make(origin, direction, 0.0f, far_distance);
    if (tracer->any_see_through) {
        return shadow_follow(tracer, ray, 0.0f, lmb_rgb_of(1.0f, 1.0f, 1.0f), rays);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    ++*rays;
    ray_note(tracer, LMB_RAY_OCCLUDED, &ray);
    rtcOccluded1(tracer->world, &context, &ray);
    return share_of_occluded(ray.tfar);
}

lmb_rgb lmb_trace_transmittance(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to, uint64_t *rays)
{
    return lmb_trace_transmittance_along(tracer, from, lmb_vec3_sub(to, from), LMB_TRACE_UP_TO_END, rays);
}

static void packet_occluded(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first, lmb_rgb share[PACKET])
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRay8 packet;
    packet_fill(&packet, rays, first);
    rtcOccluded8(packet_all, tracer->world, &context, &packet);
    for (int lane = 0; lane < PACKET; ++lane) {
        share[lane] = share_of_occluded(packet.tfar[lane]);
    }
}

static void opaque_occluded(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_rgb share[LMB_RAY_BATCH])
{
    batch_note(tracer, LMB_RAY_OCCLUDED, rays, rays->count);
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_occluded(tracer, rays, i, &share[i]);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (; i < rays->count; ++i) {
        struct RTCRay ray = ray_of_batch(rays, i);
        rtcOccluded1(tracer->world, &context, &ray);
        share[i] = share_of_occluded(ray.tfar);
    }
}

static void packet_occluded_by_layers(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first,
                                      lmb_rgb share[PACKET], uint64_t *rays_traced)
{
    lmb_layer_walk walk;
    lmb_layers passed[PACKET]; /* large: only what is used is set */
    struct RTCRay8 packet;
    lmb_layer_walk_start(&walk, tracer, shadow_filter, NULL, passed, PACKET);
    packet_fill(&packet, rays, first);
    rtcOccluded8(packet_all, tracer->world, &walk.embree, &packet);
    for (uint32_t lane = 0; lane < PACKET; ++lane) {
        share[lane] = share_of_occluded(packet.tfar[lane]);
        if (packet.tfar[lane] < 0.0f) {
            continue;
        }
        share[lane] = lmb_layers_share(&passed[lane], FLT_MAX);
        const float start = lmb_layers_left_from(&passed[lane], FLT_MAX);
        const struct RTCRay ray = ray_of_batch(rays, first + lane);
        if (start > 0.0f && start < ray.tfar) {
            share[lane] = shadow_follow(tracer, ray, start, share[lane], rays_traced);
        }
    }
}

void lmb_trace_transmittance_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_rgb share[LMB_RAY_BATCH],
                                   uint64_t *rays_traced)
{
    uint32_t i = 0;
    if (!tracer->any_see_through) {
        opaque_occluded(tracer, rays, share);
        *rays_traced += rays->count;
        return;
    }
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_occluded_by_layers(tracer, rays, i, &share[i], rays_traced);
    }
    batch_note(tracer, LMB_RAY_OCCLUDED, rays, i);
    *rays_traced += i;
    for (; i < rays->count; ++i) {
        share[i] = shadow_follow(tracer, ray_of_batch(rays, i), 0.0f, lmb_rgb_of(1.0f, 1.0f, 1.0f), rays_traced);
    }
}
