#include "leg.h"

#include <float.h>

#include <lambent/sequence.h>

#include "bake_internal.h"
#include "surface_light_internal.h"

lmb_rgb lmb_leg_sky(const lmb_receiver *from, lmb_vec3 direction, const lmb_environment_seen *seen)
{
    const bool aimed = from && seen->density > 0.0f;
    return aimed ? rgb_scale(seen->radiance, lmb_balance(lmb_receiver_density(from, direction), seen->density))
                 : seen->radiance;
}

static lmb_landing sky_landing(const lmb_transport *transport, const lmb_leg *leg)
{
    lmb_environment_seen seen;
    const float *const direction[3] = {&leg->direction.x, &leg->direction.y, &leg->direction.z};
    lmb_emitters_environment_look(transport->emitters, direction, 1, &seen);
    return (lmb_landing){.emitted = lmb_leg_sky(leg->from, leg->direction, &seen)};
}

static float emission_mis(const lmb_transport *transport, const lmb_leg *leg, const lmb_hit *hit)
{
    if (!leg->from) {
        return 1.0f;
    }
    const lmb_triangle_query query = lmb_receiver_triangles(leg->from);
    const float density = lmb_emitters_triangle_density(transport->emitters, &query, hit, leg->direction);
    return lmb_balance(lmb_receiver_density(leg->from, leg->direction), density);
}

/* Whether the leg goes through the surface. Its throughput takes up either. */
static bool leg_passes(const lmb_path *path, lmb_leg *leg, const lmb_surface *surface, uint32_t layer)
{
    const float pass = rgb_max(surface->pass);
    if (!(pass > 0.0f)) {
        return false;
    }
    const float probability = pass / (pass + surface->opacity);
    const bool passes = lmb_random(path->stream, path->sample, path->vertex, layer) < probability;
    const float stays = surface->opacity / (1.0f - probability);
    const lmb_rgb share = passes ? rgb_scale(surface->pass, 1.0f / probability) : rgb(stays, stays, stays);
    leg->throughput = rgb_mul(leg->throughput, share);
    return passes;
}

lmb_landing lmb_leg_land(const lmb_path *path, lmb_leg *leg, const lmb_hit *first)
{
    const lmb_transport *transport = path->transport;
    if (!first) {
        return sky_landing(transport, leg);
    }
    /* A camera sees texture that light does not. */
    const bool known = transport->surface && leg->from;
    const lmb_rgb *albedo = known ? lmb_surface_light_albedo(transport->surface, first) : NULL;
    if (albedo) {
        return (lmb_landing){.on_surface = true, .hit = *first, .albedo = *albedo};
    }
    lmb_hit hit = *first;
    for (uint32_t layer = 0;; ++layer) {
        const lmb_surface surface = lmb_trace_surface(transport->tracer, hit.instance, hit.triangle, hit.u, hit.v);
        if (!leg_passes(path, leg, &surface, layer)) {
            const float mis = rgb_max(surface.emission) > 0.0f ? emission_mis(transport, leg, &hit) : 0.0f;
            return (lmb_landing){
                .on_surface = true, .hit = hit, .albedo = surface.albedo, .emitted = rgb_scale(surface.emission, mis)};
        }
        const float start = nextafterf(hit.distance * (1.0f + 4.0f * FLT_EPSILON), FLT_MAX);
        ++*path->rays;
        if (!lmb_trace_nearest(transport->tracer, leg->origin, leg->direction, start, FLT_MAX, &hit)) {
            return sky_landing(transport, leg);
        }
    }
}

lmb_landing lmb_leg_follow(const lmb_path *path, lmb_leg *leg)
{
    lmb_hit hit;
    ++*path->rays;
    const bool found = lmb_trace_nearest(path->transport->tracer, leg->origin, leg->direction, 0.0f, FLT_MAX, &hit);
    return lmb_leg_land(path, leg, found ? &hit : NULL);
}

lmb_receiver lmb_landing_receiver(const lmb_path *path, const lmb_landing *landing)
{
    const lmb_hit *hit = &landing->hit;
    const lmb_place place = lmb_trace_place(path->transport->tracer, hit->instance, hit->triangle, hit->u, hit->v);
    return lmb_receiver_on_surface(&place, hit->front);
}
