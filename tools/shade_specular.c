#include "shade_specular.h"

#include <float.h>

#include <lambent/key_lights.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "half_vector.h"
#include "key_lights_seen.h"

/* Streams of half vectors are none of the paths'. */
#define HALF_VECTOR_STREAM UINT64_C(0x5bec01a7)

static lmb_rgb highlights_add(const lmb_shader *shader, const specular_place *place, const key_lights_seen *keys,
                              lmb_rgb rest)
{
    for (uint32_t i = 0; i < keys->count; ++i) {
        const lmb_rgb highlight = lmb_specular_light(&keys->light[i], keys->visibility[i], shader->specular,
                                                     place->point.normal, place->normal, place->view);
        rest = lmb_rgb_add(rest, highlight);
    }
    return rest;
}

lmb_rgb shade_specular_of_probes(const lmb_shader *shader, const specular_place *place)
{
    if (!shader->volume) {
        return (lmb_rgb){{0.0f, 0.0f, 0.0f}};
    }
    const lmb_scene *scene = lmb_tracer_scene(shader->transport->tracer);
    lmb_sh3_rgb radiance;
    key_lights_seen keys;
    keys.count = lmb_volume_key_lights(shader->volume, keys.light);
    lmb_volume_sample_with_keys(shader->volume, lmb_scene_to_world(scene, place->point.position), &radiance,
                                keys.visibility);
    return highlights_add(shader, place, &keys,
                          lmb_specular_area(&radiance, shader->specular, place->normal, place->view));
}

lmb_rgb radiance_without_keys(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                              uint32_t sample)
{
    lmb_hit hit;
    uint64_t rays = 0;
    if (lmb_trace_nearest(transport->tracer, origin, direction, 0.0f, FLT_MAX, &hit)) {
        return lmb_radiance(transport, origin, direction, stream, sample, &rays);
    }
    lmb_environment_seen seen;
    const float *const axes[3] = {&direction.x, &direction.y, &direction.z};
    lmb_emitters_environment_look(transport->emitters, axes, 1, &seen);
    return seen.radiance;
}

lmb_rgb shade_specular_of_reference(const lmb_shader *shader, const specular_place *place)
{
    const lmb_transport *transport = shader->transport;
    const lmb_specular *specular = shader->specular;
    const uint64_t stream = lmb_stream_of_position(transport->seed ^ HALF_VECTOR_STREAM, place->point.position);
    const lmb_vec3 view = place->view, normal = place->normal;
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < shader->reference_samples; ++i) {
        float u[2];
        half_vector_sample picked;
        lmb_sequence_2d(stream, i, 0, u);
        if (!half_vector_pick(specular->roughness, normal, view, u, &picked) ||
            !(lmb_vec3_dot(picked.towards, place->point.normal) > 0.0f)) {
            continue;
        }
        const lmb_rgb seen = radiance_without_keys(transport, place->point.position,
                                                   lmb_vec3_unit_or(picked.towards, normal), ~stream, i);
        for (int c = 0; c < 3; ++c) {
            const double f0 = (double)specular->f0.c[c];
            sum[c] += picked.arrives * dielectric_reflectance(f0, picked.along) * (double)seen.c[c];
        }
    }
    const double share = 1.0 / shader->reference_samples;
    uint64_t rays = 0;
    key_lights_seen keys;
    keys.count = lmb_scene_key_lights(lmb_tracer_scene(transport->tracer), keys.light);
    lmb_gather_keys(transport, &place->point, 1, keys.visibility, &rays);
    return highlights_add(shader, place, &keys,
                          lmb_rgb_of((float)(sum[0] * share), (float)(sum[1] * share), (float)(sum[2] * share)));
}
