#include "leg.h"

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

lmb_landing lmb_leg_land(const lmb_path *path, lmb_leg *leg, const lmb_hit *hit)
{
    const lmb_transport *transport = path->transport;
    if (!hit) {
        return sky_landing(transport, leg);
    }
    /* A camera sees texture that light does not. */
    const bool known = transport->surface && leg->from;
    const lmb_rgb *albedo = known ? lmb_surface_light_albedo(transport->surface, hit) : NULL;
    if (albedo) {
        return (lmb_landing){.on_surface = true, .hit = *hit, .albedo = *albedo};
    }
    const lmb_surface surface = lmb_trace_surface(transport->tracer, hit->instance, hit->triangle, hit->u, hit->v);
    leg->throughput = rgb_scale(leg->throughput, rgb_max(surface.pass) + surface.opacity);
    const float mis = rgb_max(surface.emission) > 0.0f ? emission_mis(transport, leg, hit) : 0.0f;
    return (lmb_landing){
        .on_surface = true, .hit = *hit, .albedo = surface.albedo, .emitted = rgb_scale(surface.emission, mis)};
}

lmb_landing lmb_leg_follow(const lmb_path *path, lmb_leg *leg)
{
    lmb_hit hit;
    return lmb_leg_land(path, leg, lmb_leg_trace(path, leg, &hit) ? &hit : NULL);
}

lmb_receiver lmb_landing_receiver(const lmb_path *path, const lmb_landing *landing)
{
    const lmb_hit *hit = &landing->hit;
    const lmb_place place = lmb_trace_place(path->transport->tracer, hit->instance, hit->triangle, hit->u, hit->v);
    return lmb_receiver_on_surface(&place, hit->front);
}
