#include "transport/segment.h"

#include <lambent/surface.h>
#include <lambent/vector.h>

#include "surface/surface_light_internal.h"

lmb_rgb lmb_segment_sky(const lmb_receiver *from, lmb_vec3 direction, const lmb_environment_seen *seen)
{
    return seen->density > 0.0f
               ? lmb_rgb_scale(seen->radiance, lmb_balance(lmb_receiver_density(from, direction), seen->density))
               : seen->radiance;
}

static lmb_path_vertex sky_vertex(const lmb_transport *transport, const lmb_segment *segment)
{
    if (!segment->from) {
        return (lmb_path_vertex){.emitted = lmb_emitters_environment_shown(transport->emitters, segment->direction)};
    }
    lmb_environment_seen seen;
    const float *const direction[3] = {&segment->direction.x, &segment->direction.y, &segment->direction.z};
    lmb_emitters_environment_look(transport->emitters, direction, 1, &seen);
    return (lmb_path_vertex){.emitted = lmb_segment_sky(segment->from, segment->direction, &seen)};
}

static float emission_mis(const lmb_transport *transport, const lmb_segment *segment, const lmb_hit *hit)
{
    if (!segment->from) {
        return 1.0f;
    }
    const lmb_triangle_query query = lmb_receiver_triangles(segment->from);
    const float density = lmb_emitters_triangle_density(transport->emitters, &query, hit, segment->direction);
    return lmb_balance(lmb_receiver_density(segment->from, segment->direction), density);
}

lmb_path_vertex lmb_segment_vertex(const lmb_path *path, lmb_segment *segment, const lmb_hit *hit)
{
    const lmb_transport *transport = path->transport;
    if (!hit) {
        return sky_vertex(transport, segment);
    }
    /* A camera sees texture that light does not. */
    const bool known = transport->surface && segment->from;
    const lmb_rgb *albedo = known ? lmb_surface_light_albedo(transport->surface, hit) : NULL;
    if (albedo) {
        return (lmb_path_vertex){.on_surface = true, .hit = *hit, .albedo = *albedo};
    }
    const lmb_surface surface = lmb_trace_surface(transport->tracer, hit);
    const lmb_coverage *coverage = &surface.coverage;
    segment->throughput = lmb_rgb_scale(segment->throughput, lmb_rgb_max(coverage->pass) + coverage->opacity);
    const lmb_rgb emission = lmb_emitters_emission(transport->emitters, hit);
    const float mis = lmb_rgb_max(emission) > 0.0f ? emission_mis(transport, segment, hit) : 0.0f;
    return (lmb_path_vertex){
        .on_surface = true, .hit = *hit, .albedo = surface.albedo, .emitted = lmb_rgb_scale(emission, mis)};
}

lmb_path_vertex lmb_segment_follow(const lmb_path *path, lmb_segment *segment)
{
    lmb_hit hit;
    return lmb_segment_vertex(path, segment, lmb_segment_trace(path, segment, &hit) ? &hit : NULL);
}

lmb_receiver lmb_vertex_receiver(const lmb_path *path, const lmb_path_vertex *vertex)
{
    const lmb_hit *hit = &vertex->hit;
    const lmb_place place = lmb_trace_place(path->transport->tracer, hit);
    return lmb_receiver_on_surface(&place, hit->front);
}
