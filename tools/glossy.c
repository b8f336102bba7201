#include "glossy.h"

#include <float.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "half_vector.h"

/* Dimension pairs of the sequence. */
enum { PAIR_HALF_VECTOR, PAIR_TRIANGLE, PAIR_POINT, PAIR_ENVIRONMENT, PAIR_LIGHTS, PAIR_LIGHT_POINT };

/* One place, whose light is summed. */
typedef struct glossy {
    const lmb_transport *transport;
    const specular_place *place;
    lmb_specular specular; /* with the least roughness */
    lmb_triangle_query triangles;
    uint64_t stream;
    uint64_t rays;
    double sum[3];
} glossy;

static void reflected_add(glossy *work, lmb_rgb light, double reflects, double along)
{
    for (int c = 0; c < 3; ++c) {
        const double fresnel = dielectric_reflectance((double)work->specular.f0.c[c], along);
        work->sum[c] += reflects * fresnel * (double)light.c[c];
    }
}

static bool responds(const glossy *work, lmb_vec3 towards, half_vector_response *response)
{
    const specular_place *place = work->place;
    return lmb_vec3_dot(towards, place->point.normal) > 0.0f &&
           half_vector_respond(work->specular.roughness, place->normal, place->view, towards, response);
}

/* The density with which lights are picked that a ray ended at. */
static double light_density(const glossy *work, const lmb_radiance_seen *seen, lmb_vec3 direction)
{
    const lmb_emitters *emitters = work->transport->emitters;
    if (!(lmb_rgb_max(seen->emitted) > 0.0f)) {
        return 0.0;
    }
    if (seen->on_surface) {
        return (double)lmb_emitters_triangle_density(emitters, &work->triangles, &seen->hit, direction);
    }
    lmb_environment_seen sky;
    const float *const axes[3] = {&direction.x, &direction.y, &direction.z};
    lmb_emitters_environment_look(emitters, axes, 1, &sky);
    return (double)sky.density;
}

/* What a half vector sends on. */
static void half_vector_add(glossy *work, uint32_t sample)
{
    const specular_place *place = work->place;
    float u[2];
    half_vector_sample picked;
    half_vector_response response;
    lmb_sequence_2d(work->stream, sample, PAIR_HALF_VECTOR, u);
    if (!half_vector_pick(work->specular.roughness, place->normal, place->view, u, &picked)) {
        return;
    }
    const lmb_vec3 towards = lmb_vec3_unit_or(picked.towards, place->normal);
    if (!responds(work, towards, &response)) {
        return;
    }
    const lmb_ray ray = {place->point.position, towards};
    const lmb_radiance_seen seen = lmb_radiance_look(work->transport, &ray, ~work->stream, sample, &work->rays);
    const double other = light_density(work, &seen, towards);
    const lmb_rgb emitted = lmb_rgb_scale(seen.emitted, (float)(response.density / (response.density + other)));
    reflected_add(work, lmb_rgb_add(seen.reflected, emitted), picked.arrives, picked.along);
}

/* Light that was aimed at, where half vectors find it too. */
static void aimed_add(glossy *work, const lmb_light_sample *light, bool at_infinity)
{
    const lmb_tracer *tracer = work->transport->tracer;
    const lmb_vec3 from = work->place->point.position;
    half_vector_response response;
    if (!(light->density > 0.0f) || !responds(work, light->direction, &response)) {
        return;
    }
    const lmb_rgb share = at_infinity
                              ? lmb_trace_transmittance_along(tracer, from, light->direction, FLT_MAX, &work->rays)
                              : lmb_trace_transmittance(tracer, from, light->end, &work->rays);
    reflected_add(work, lmb_rgb_mul(share, light->radiance),
                  response.reflects / ((double)light->density + response.density), response.along);
}

static void emitters_add(glossy *work, uint32_t sample)
{
    const lmb_emitters *emitters = work->transport->emitters;
    float u[2], v[2];
    lmb_light_sample light;
    if (lmb_emitters_triangle_count(emitters) > 0) {
        lmb_sequence_2d(work->stream, sample, PAIR_TRIANGLE, u);
        lmb_sequence_2d(work->stream, sample, PAIR_POINT, v);
        const lmb_triangle_choices choices = {1, &work->place->point.position, &u[0], &v[0], &v[1]};
        lmb_emitters_sample_triangles(emitters, &work->triangles, &choices, &light);
        aimed_add(work, &light, false);
    }
    if (lmb_emitters_environment_sampled(emitters)) {
        lmb_sequence_2d(work->stream, sample, PAIR_ENVIRONMENT, u);
        lmb_emitters_sample_environment(emitters, &u[0], &u[1], 1, &light);
        aimed_add(work, &light, true);
    }
}

/* Lights that half vectors never find. */
static void punctual_add(glossy *work, uint32_t sample, double weight)
{
    const lmb_tracer *tracer = work->transport->tracer;
    const lmb_vec3 from = work->place->point.position;
    float choice[2];
    lmb_punctual_query query = {.position = from, .normal = &work->place->point.normal, .skip_indirect_only = true};
    lmb_sequence_2d(work->stream, sample, PAIR_LIGHTS, choice);
    lmb_sequence_2d(work->stream, sample, PAIR_LIGHT_POINT, query.point);
    lmb_punctual_sample light[2 * LMB_PUNCTUAL_MAX];
    const int count = lmb_emitters_punctual(work->transport->emitters, &query, choice, LMB_PUNCTUAL_MAX, light);
    for (int i = 0; i < count; ++i) {
        half_vector_response response;
        if (!responds(work, light[i].direction, &response)) {
            continue;
        }
        const lmb_rgb share =
            light[i].at_infinity ? lmb_trace_transmittance_along(tracer, from, light[i].direction, FLT_MAX, &work->rays)
                                 : lmb_trace_transmittance(tracer, from, light[i].end, &work->rays);
        reflected_add(work, lmb_rgb_mul(share, light[i].irradiance), weight * response.reflects, response.along);
    }
}

lmb_rgb glossy_radiance(const lmb_transport *transport, const specular_place *place, uint32_t samples, uint64_t stream)
{
    glossy work = {.transport = transport, .place = place, .specular = place->specular};
    work.specular.roughness = lmb_larger(place->specular.roughness, LMB_SPECULAR_LEAST_ROUGHNESS);
    work.triangles = (lmb_triangle_query){place->point.position, &place->point.normal, NULL};
    work.stream = lmb_mix(lmb_stream_of_position(transport->seed, place->point.position), stream);
    const bool few = lmb_emitters_punctual_are_few(transport->emitters, false);
    for (uint32_t i = 0; i < samples; ++i) {
        half_vector_add(&work, i);
        emitters_add(&work, i);
        if (!few || i == 0) {
            punctual_add(&work, i, few ? (double)samples : 1.0);
        }
    }
    const double share = 1.0 / (double)samples;
    return lmb_rgb_of((float)(work.sum[0] * share), (float)(work.sum[1] * share), (float)(work.sum[2] * share));
}
