#include <lambent/transport.h>

#include <lambent/vector.h>

#include "transport/path.h"

static lmb_rgb finite_or_black(lmb_rgb radiance)
{
    return lmb_rgb_is_finite(radiance) ? radiance : (lmb_rgb){{0.0f, 0.0f, 0.0f}};
}

lmb_rgb lmb_radiance(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                     uint32_t sample, uint64_t *rays)
{
    lmb_path path = {transport, stream, sample, 0, rays};
    lmb_segment segment = {NULL, origin, direction, {{1.0f, 1.0f, 1.0f}}};
    const lmb_path_vertex vertex = lmb_segment_follow(&path, &segment);
    return finite_or_black(lmb_path_radiance(&path, segment, vertex));
}

lmb_radiance_seen lmb_radiance_look(const lmb_transport *transport, const lmb_ray *ray, uint64_t stream,
                                    uint32_t sample, uint64_t *rays)
{
    lmb_path path = {transport, stream, sample, 0, rays};
    lmb_segment segment = {NULL, ray->origin, ray->direction, {{1.0f, 1.0f, 1.0f}}};
    lmb_path_vertex vertex = lmb_segment_follow(&path, &segment);
    lmb_radiance_seen seen = {.on_surface = vertex.on_surface, .hit = vertex.hit};
    if (!vertex.on_surface) {
        lmb_environment_seen sky;
        const float *const axes[3] = {&ray->direction.x, &ray->direction.y, &ray->direction.z};
        lmb_emitters_environment_look(transport->emitters, axes, 1, &sky);
        vertex.emitted = sky.radiance;
    }
    seen.emitted = finite_or_black(lmb_rgb_mul(segment.throughput, vertex.emitted));
    vertex.emitted = (lmb_rgb){{0.0f, 0.0f, 0.0f}};
    seen.reflected = finite_or_black(lmb_path_radiance(&path, segment, vertex));
    return seen;
}
