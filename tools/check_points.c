#include "check_points.h"

#include <lambent/placement.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

/* Dimension pairs of a point's sequence. */
enum { PAIR_FREE = 2, PAIR_FREE_HEIGHT };

/* A direction around `axis` from its squared sine and a turn in [0, 1). */
static lmb_vec3 direction_around(lmb_vec3 axis, float sine_squared, float turn)
{
    lmb_vec3 tangent, bitangent;
    lmb_vec3_frame(axis, &tangent, &bitangent);
    const float sine = sqrtf(sine_squared);
    const float angle = 2.0f * LMB_PI_F * turn;
    const lmb_vec3 up = lmb_vec3_scale(axis, sqrtf(fmaxf(0.0f, 1.0f - sine_squared)));
    return lmb_vec3_mad(lmb_vec3_mad(up, tangent, sine * cosf(angle)), bitangent, sine * sinf(angle));
}

void shading_normals(lmb_vec3 normal, uint64_t stream, int count, lmb_vec3 *normals)
{
    const float max_sine_squared = 0.75f; /* of 60 degrees */
    for (int k = 0; k < count; ++k) {
        float point[2];
        lmb_sequence_2d(stream, (uint32_t)k, 0, point);
        normals[k] = direction_around(normal, max_sine_squared * point[0], point[1]);
    }
}

static lmb_vec3 sphere_direction(const float point[2])
{
    const float z = 1.0f - 2.0f * point[0];
    const float radius = sqrtf(fmaxf(0.0f, 1.0f - z * z));
    const float angle = 2.0f * LMB_PI_F * point[1];
    return (lmb_vec3){radius * cosf(angle), radius * sinf(angle), z};
}

void sphere_directions(uint64_t stream, int count, lmb_vec3 *directions)
{
    for (int k = 0; k < count; ++k) {
        float point[2];
        lmb_sequence_2d(stream, (uint32_t)k, 0, point);
        directions[k] = sphere_direction(point);
    }
}

bool free_point(const lmb_tracer *tracer, const lmb_volume *volume, bool avoid_solids, uint64_t stream, lmb_vec3 *point)
{
    enum { TRIES = 4096 };
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const lmb_vec3 low = lmb_scene_from_world(scene, info.bounds_min);
    const lmb_vec3 high = lmb_scene_from_world(scene, info.bounds_max);
    const lmb_vec3 size = lmb_vec3_sub(high, low);
    for (uint32_t attempt = 0; attempt < TRIES; ++attempt) {
        float across[2], height[2];
        lmb_sequence_2d(stream, attempt, PAIR_FREE, across);
        lmb_sequence_2d(stream, attempt, PAIR_FREE_HEIGHT, height);
        const lmb_vec3 at = {low.x + across[0] * size.x, low.y + height[0] * size.y, low.z + across[1] * size.z};
        lmb_sh3_rgb radiance;
        uint64_t rays = 0;
        if (lmb_volume_sample_at(volume, lmb_scene_to_world(scene, at), &radiance) &&
            (!avoid_solids || lmb_placement_is_free(tracer, at, &rays))) {
            *point = at;
            return true;
        }
    }
    return false;
}

float ambient_visibility(const lmb_tracer *tracer, lmb_vec3 position, lmb_vec3 normal, float distance, uint64_t stream,
                         int rays)
{
    double open = 0.0;
    for (int k = 0; k < rays; ++k) {
        float point[2];
        lmb_sequence_2d(stream, (uint32_t)k, 0, point);
        const lmb_vec3 end = lmb_vec3_mad(position, direction_around(normal, point[0], point[1]), distance);
        uint64_t unused = 0;
        open += (double)lmb_luminance(lmb_trace_transmittance(tracer, position, end, &unused));
    }
    return (float)(open / rays);
}
