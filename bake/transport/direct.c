#include "transport/direct.h"

#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "base/directions.h"
#include "light/emitters_internal.h"
#include "trace/trace_internal.h"

void lmb_sample_variates(const lmb_transport *transport, lmb_sample_range samples, uint32_t pair, float *x, float *y)
{
    if (!lmb_emitters_go_without(transport->emitters, LMB_WITHOUT_SEQUENCE)) {
        lmb_sequence_2d_batch(samples.stream, samples.first, samples.count, pair, x, y);
        return;
    }
    for (uint32_t i = 0; i < samples.count; ++i) {
        x[i] = lmb_random(samples.stream, samples.first + i, pair, UINT32_MAX);
        y[i] = lmb_random(samples.stream, samples.first + i, pair, UINT32_MAX - 1);
    }
}

uint64_t lmb_layer_chance(uint64_t stream, uint32_t sample, int32_t vertex)
{
    return lmb_mix(lmb_mix(stream ^ UINT64_C(0x5851f42d4c957f2d), sample), (uint32_t)vertex);
}

void lmb_path_variates(const lmb_path *path, uint32_t pair, float u[2])
{
    const lmb_sample_range samples = {path->stream, path->sample, 1};
    lmb_sample_variates(path->transport, samples, path->vertex * PAIRS_PER_VERTEX + pair, &u[0], &u[1]);
}

lmb_receiver lmb_receiver_on_surface(const lmb_place *place, bool front)
{
    const float side = front ? 1.0f : -1.0f;
    return (lmb_receiver){.position = place->position,
                          .geometric_normal = lmb_vec3_scale(place->geometric_normal, side),
                          .normal = lmb_vec3_scale(place->shading_normal, side),
                          .rounding = place->rounding,
                          .kind = LMB_LOBE_COSINE};
}

lmb_vec3 lmb_receiver_direction(const lmb_receiver *receiver, const float u[2])
{
    return lmb_direction_make(receiver->kind, receiver->normal, u);
}

static int punctual_aim(const lmb_transport *transport, const lmb_receiver *receiver, const lmb_direct_start *start,
                        lmb_aimed_light aimed[2])
{
    lmb_punctual_sample light[2 * LMB_PUNCTUAL_MAX];
    lmb_punctual_query query = lmb_receiver_punctual(receiver);
    if (lmb_emitters_punctual_are_soft(transport->emitters, false)) {
        query.point[0] = start->light[0];
        query.point[1] = start->light[1];
    }
    const int found = lmb_emitters_punctual(transport->emitters, &query, start->choice, 1, light);
    int count = 0;
    for (int i = 0; i < found; ++i) {
        count += lmb_receiver_aim_punctual(receiver, &light[i], &aimed[count]);
    }
    return count;
}

static bool triangle_aim(const lmb_transport *transport, const lmb_receiver *receiver, const lmb_direct_start *start,
                         lmb_aimed_light *aimed)
{
    lmb_light_sample light;
    const lmb_triangle_query query = lmb_receiver_triangles(receiver);
    const lmb_triangle_choices choices = {1, &receiver->position, &start->choice[0], &start->triangle[0],
                                          &start->triangle[1]};
    lmb_emitters_sample_triangles(transport->emitters, &query, &choices, &light);
    return light.density > 0.0f && lmb_receiver_aim(receiver, &light, false, aimed);
}

int lmb_direct_aim(const lmb_transport *transport, const lmb_receiver *receiver, const lmb_direct_start *start,
                   lmb_aimed_light aimed[LMB_AIMED_MOST])
{
    int count = 0;
    if (lmb_emitters_have_punctual(transport->emitters, false)) {
        count += punctual_aim(transport, receiver, start, aimed);
    }
    if (lmb_emitters_triangle_count(transport->emitters) > 0) {
        count += triangle_aim(transport, receiver, start, aimed + count);
    }
    if (lmb_emitters_environment_sampled(transport->emitters) && start->environment.density > 0.0f) {
        count += lmb_receiver_aim(receiver, &start->environment, true, aimed + count);
    }
    return count;
}

static lmb_direct_start path_start(const lmb_path *path)
{
    const lmb_emitters *emitters = path->transport->emitters;
    lmb_direct_start start;
    const bool triangles = lmb_emitters_triangle_count(emitters) > 0;
    if (triangles || lmb_emitters_have_punctual(path->transport->emitters, false)) {
        lmb_path_variates(path, PAIR_CHOICE, start.choice);
    }
    if (triangles) {
        lmb_path_variates(path, PAIR_TRIANGLE, start.triangle);
    }
    if (lmb_emitters_punctual_are_soft(emitters, false)) {
        const lmb_sample_range samples = {path->stream, path->sample, 1};
        lmb_sample_variates(path->transport, samples, lmb_light_pair(path->vertex), &start.light[0], &start.light[1]);
    }
    if (lmb_emitters_environment_sampled(emitters)) {
        float point[2];
        lmb_path_variates(path, PAIR_ENVIRONMENT, point);
        lmb_emitters_sample_environment(emitters, &point[0], &point[1], 1, &start.environment);
    }
    return start;
}

static lmb_rgb aimed_collect(const lmb_path *path, const lmb_aimed_light *aimed, int count)
{
    lmb_rgb sum = lmb_rgb_of(0.0f, 0.0f, 0.0f);
    for (int i = 0; i < count; ++i) {
        const lmb_rgb share = lmb_trace_transmittance_along(path->transport->tracer, aimed[i].origin, aimed[i].towards,
                                                            aimed[i].far_distance, path->rays);
        sum = lmb_rgb_add(sum, lmb_rgb_mul(aimed[i].weight, share));
    }
    return sum;
}

lmb_rgb lmb_direct_collect(const lmb_path *path, const lmb_receiver *receiver)
{
    lmb_aimed_light aimed[LMB_AIMED_MOST];
    const lmb_direct_start start = path_start(path);
    return aimed_collect(path, aimed, lmb_direct_aim(path->transport, receiver, &start, aimed));
}

lmb_rgb lmb_direct_collect_suns(const lmb_path *path, const lmb_receiver *receiver)
{
    lmb_aimed_light aimed[LMB_AIMED_MOST];
    const lmb_direct_start start = path_start(path);
    const int count = punctual_aim(path->transport, receiver, &start, aimed);
    int suns = 0;
    for (int i = 0; i < count; ++i) {
        if (aimed[i].is_sun) {
            aimed[suns++] = aimed[i];
        }
    }
    return aimed_collect(path, aimed, suns);
}
