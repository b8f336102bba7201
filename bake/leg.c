#include "leg.h"

#include <float.h>

#include <lambent/sequence.h>

#include "bake_internal.h"

static float environment_mis(const lmb_transport *transport, const lmb_leg *leg)
{
    if (!leg->from || !lmb_emitters_environment_sampled(transport->emitters)) {
        return 1.0f;
    }
    return lmb_balance(lmb_receiver_density(leg->from, leg->direction),
                       lmb_emitters_environment_density(transport->emitters, leg->direction));
}

static float emission_mis(const lmb_transport *transport, const lmb_leg *leg, const lmb_hit *hit)
{
    if (!leg->from) {
        return 1.0f;
    }
    const lmb_place place = lmb_trace_place(transport->tracer, hit->instance, hit->triangle, hit->u, hit->v);
    const float distance = vec3_length(vec3_sub(place.position, leg->from->position));
    const float density =
        lmb_emitters_triangle_density(transport->emitters, hit, leg->direction, distance, place.geometric_normal);
    return lmb_balance(lmb_receiver_density(leg->from, leg->direction), density);
}

lmb_landing lmb_leg_follow(const lmb_path *path, lmb_leg *leg)
{
    const lmb_transport *transport = path->transport;
    float start = 0.0f;
    for (uint32_t layer = 0;; ++layer) {
        ++*path->rays;
        lmb_hit hit;
        if (!lmb_trace_nearest(transport->tracer, leg->origin, leg->direction, start, FLT_MAX, &hit)) {
            const lmb_rgb sky = lmb_emitters_environment_radiance(transport->emitters, leg->direction);
            return (lmb_landing){.emitted = rgb_scale(sky, environment_mis(transport, leg))};
        }
        const lmb_surface surface = lmb_trace_surface(transport->tracer, hit.instance, hit.triangle, hit.u, hit.v);
        const float pass = rgb_max(surface.pass);
        if (pass > 0.0f) {
            const float probability = pass / (pass + surface.opacity);
            if (lmb_random(path->stream, path->sample, path->vertex, layer) < probability) {
                leg->throughput = rgb_mul(leg->throughput, rgb_scale(surface.pass, 1.0f / probability));
                start = nextafterf(hit.distance * (1.0f + 4.0f * FLT_EPSILON), FLT_MAX);
                continue;
            }
            leg->throughput = rgb_scale(leg->throughput, surface.opacity / (1.0f - probability));
        }
        const float mis = rgb_max(surface.emission) > 0.0f ? emission_mis(transport, leg, &hit) : 0.0f;
        return (lmb_landing){.on_surface = true,
                             .hit = hit,
                             .front =
                                 lmb_trace_meets_front(transport->tracer, hit.instance, hit.triangle, leg->direction),
                             .albedo = surface.albedo,
                             .emitted = rgb_scale(surface.emission, mis)};
    }
}

lmb_receiver lmb_landing_receiver(const lmb_path *path, const lmb_landing *landing)
{
    const lmb_hit *hit = &landing->hit;
    const lmb_place place = lmb_trace_place(path->transport->tracer, hit->instance, hit->triangle, hit->u, hit->v);
    return lmb_receiver_on_surface(&place, landing->front);
}
