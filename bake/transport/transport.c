#include <lambent/transport.h>

#include <lambent/vector.h>

#include "transport/path.h"

lmb_rgb lmb_radiance(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                     uint32_t sample, uint64_t *rays)
{
    lmb_path path = {transport, stream, sample, 0, rays};
    lmb_segment segment = {NULL, origin, direction, {{1.0f, 1.0f, 1.0f}}};
    const lmb_path_vertex vertex = lmb_segment_follow(&path, &segment);
    const lmb_rgb radiance = lmb_path_radiance(&path, segment, vertex);
    return lmb_rgb_is_finite(radiance) ? radiance : (lmb_rgb){{0.0f, 0.0f, 0.0f}};
}
