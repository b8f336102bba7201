#include "surface_light_sample.h"

#include "bake_internal.h"
#include "leg.h"
#include "trace_internal.h"

/* Samples on their way. */
typedef struct sample_batch {
    const lmb_transport *transport;
    const lmb_surface_light *light;
    lmb_side_sample *sample;
    uint32_t count;
    lmb_receiver receiver[LMB_SIDE_SAMPLES];
    lmb_ray_batch rays;
    uint32_t owner[LMB_RAY_BATCH]; /* sample of each ray */
    uint64_t *rays_traced;
} sample_batch;

static void ray_add(sample_batch *batch, uint32_t sample, lmb_vec3 origin, lmb_vec3 direction, float far_distance)
{
    batch->owner[batch->rays.count] = sample;
    lmb_ray_batch_add(&batch->rays, origin, direction, far_distance);
}

/* Two numbers of each sample, for the samples of a side at once. */
typedef struct sample_numbers {
    float x[LMB_SIDE_SAMPLES];
    float y[LMB_SIDE_SAMPLES];
} sample_numbers;

static void numbers_find(const sample_batch *batch, uint32_t pair, sample_numbers *numbers)
{
    for (uint32_t i = 0, end; i < batch->count; i = end) {
        const lmb_path *path = &batch->sample[i].path;
        end = i + 1;
        while (end < batch->count && batch->sample[end].path.stream == path->stream) {
            ++end;
        }
        lmb_sample_numbers(path->transport, path->stream, path->sample, end - i, pair, &numbers->x[i], &numbers->y[i]);
    }
}

static void receivers_place(sample_batch *batch)
{
    sample_numbers points;
    numbers_find(batch, PAIRS_PER_VERTEX + PAIR_DIRECTION, &points);
    for (uint32_t i = 0; i < batch->count; ++i) {
        const lmb_side_sample *sample = &batch->sample[i];
        const float numbers[2] = {points.x[i], points.y[i]};
        float u, v;
        lmb_cell_point(&sample->cell, numbers, &u, &v);
        const lmb_place place =
            lmb_trace_place(batch->transport->tracer, sample->cell.instance, sample->cell.triangle, u, v);
        batch->receiver[i] = lmb_receiver_on_surface(&place, sample->front);
    }
}

static void skies_sample(const sample_batch *batch, lmb_direct_start *starts)
{
    sample_numbers numbers;
    lmb_light_sample sky[LMB_SIDE_SAMPLES];
    numbers_find(batch, PAIR_ENVIRONMENT, &numbers);
    lmb_emitters_sample_environment(batch->transport->emitters, numbers.x, numbers.y, batch->count, sky);
    for (uint32_t i = 0; i < batch->count; ++i) {
        starts[i].environment = sky[i];
    }
}

/* Where next-event estimation starts, as for a path. */
static void starts_find(const sample_batch *batch, lmb_direct_start *starts)
{
    const lmb_transport *transport = batch->transport;
    if (lmb_emitters_triangle_count(transport->emitters) > 0 || lmb_tracer_scene(transport->tracer)->light_count > 0) {
        sample_numbers choice, triangle;
        numbers_find(batch, PAIR_CHOICE, &choice);
        numbers_find(batch, PAIR_TRIANGLE, &triangle);
        for (uint32_t i = 0; i < batch->count; ++i) {
            starts[i] =
                (lmb_direct_start){.triangle = {triangle.x[i], triangle.y[i]}, .choice = {choice.x[i], choice.y[i]}};
        }
    }
    if (lmb_emitters_punctual_are_soft(transport->emitters)) {
        sample_numbers light;
        numbers_find(batch, lmb_light_pair(0), &light);
        for (uint32_t i = 0; i < batch->count; ++i) {
            starts[i].light[0] = light.x[i];
            starts[i].light[1] = light.y[i];
        }
    }
    if (lmb_emitters_environment_sampled(transport->emitters)) {
        skies_sample(batch, starts);
    }
}

static void direct_find(sample_batch *batch)
{
    lmb_rgb weight[LMB_RAY_BATCH], share[LMB_RAY_BATCH];
    lmb_direct_start starts[LMB_SIDE_SAMPLES];
    starts_find(batch, starts);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        lmb_aimed_light aimed[LMB_AIMED_MOST];
        const int count = lmb_direct_aim(batch->transport, &batch->receiver[i], &starts[i], aimed);
        for (int k = 0; k < count; ++k) {
            weight[batch->rays.count] = aimed[k].weight;
            ray_add(batch, i, aimed[k].origin, aimed[k].towards, aimed[k].far_distance);
        }
        batch->sample[i].direct = rgb(0.0f, 0.0f, 0.0f);
    }
    lmb_trace_transmittance_batch(batch->transport->tracer, &batch->rays, share, batch->rays_traced);
    for (uint32_t k = 0; k < batch->rays.count; ++k) {
        lmb_rgb *direct = &batch->sample[batch->owner[k]].direct;
        *direct = rgb_add(*direct, rgb_mul(weight[k], share[k]));
    }
}

/* Whether a ray from the start of a sample gets away from the cell. It has a direction of its own: the one by
 * which the sample finds light would count more often the brighter what it sees. */
static void openness_find(sample_batch *batch)
{
    lmb_rgb share[LMB_RAY_BATCH];
    sample_numbers directions;
    numbers_find(batch, PAIRS_PER_VERTEX + PAIR_ENVIRONMENT, &directions);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        lmb_side_sample *sample = &batch->sample[i];
        const lmb_receiver *receiver = &batch->receiver[i];
        const float numbers[2] = {directions.x[i], directions.y[i]};
        const lmb_vec3 direction = lmb_receiver_direction(receiver, numbers);
        sample->link = (lmb_link){.open = false};
        if (lmb_receiver_sees(receiver, direction)) {
            ray_add(batch, i, lmb_receiver_ray_origin(receiver, direction),
                    vec3_scale(direction, lmb_cell_near(sample->cell.grid)), LMB_TRACE_UP_TO_END);
        }
    }
    lmb_trace_transmittance_batch(batch->transport->tracer, &batch->rays, share, batch->rays_traced);
    for (uint32_t k = 0; k < batch->rays.count; ++k) {
        batch->sample[batch->owner[k]].link.open = rgb_max(share[k]) > 0.0f;
    }
}

static void link_weigh(lmb_link *link, lmb_rgb weight)
{
    for (int c = 0; c < 3; ++c) {
        link->weight[c] = (uint16_t)(float_smaller(float_larger(weight.c[c], 0.0f), 1.0f) * 65535.0f + 0.5f);
    }
}

static void sample_land(const sample_batch *batch, uint32_t ray, const lmb_hit *hit, lmb_rgb share)
{
    const lmb_ray_batch *rays = &batch->rays;
    const uint32_t i = batch->owner[ray];
    lmb_side_sample *sample = &batch->sample[i];
    lmb_leg leg = {&batch->receiver[i], vec3(rays->origin[0][ray], rays->origin[1][ray], rays->origin[2][ray]),
                   vec3(rays->direction[0][ray], rays->direction[1][ray], rays->direction[2][ray]), share};
    const lmb_landing landing = lmb_leg_land(&sample->path, &leg, hit->instance != LMB_HIT_NOTHING ? hit : NULL);
    sample->direct = rgb_add(sample->direct, rgb_mul(leg.throughput, landing.emitted));
    if (landing.on_surface && rgb_max(landing.albedo) > 0.0f) {
        sample->link.target = lmb_surface_light_side(batch->light, &landing.hit, landing.hit.front);
        link_weigh(&sample->link, rgb_mul(leg.throughput, landing.albedo));
    }
}

static void links_find(sample_batch *batch)
{
    uint64_t chance[LMB_RAY_BATCH];
    lmb_hit hit[LMB_RAY_BATCH];
    lmb_rgb share[LMB_RAY_BATCH];
    sample_numbers directions;
    numbers_find(batch, PAIR_DIRECTION, &directions);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        const lmb_receiver *receiver = &batch->receiver[i];
        const float numbers[2] = {directions.x[i], directions.y[i]};
        const lmb_vec3 direction = lmb_receiver_direction(receiver, numbers);
        if (lmb_receiver_sees(receiver, direction)) {
            ray_add(batch, i, lmb_receiver_ray_origin(receiver, direction), direction, FLT_MAX);
        }
    }
    const lmb_tracer *tracer = batch->transport->tracer;
    const bool layers = lmb_tracer_has_layers(tracer);
    for (uint32_t k = 0; layers && k < batch->rays.count; ++k) {
        const lmb_path *path = &batch->sample[batch->owner[k]].path;
        chance[k] = lmb_layer_chance(path->stream, path->sample, (int32_t)path->vertex);
    }
    lmb_trace_through_batch(tracer, &batch->rays, chance, hit, share, batch->rays_traced);
    for (uint32_t k = 0; k < batch->rays.count; ++k) {
        sample_land(batch, k, &hit[k], layers ? share[k] : rgb(1.0f, 1.0f, 1.0f));
    }
}

void lmb_side_samples_take(const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count)
{
    sample_batch batch; /* large: only what is used is set */
    batch.transport = samples[0].path.transport;
    batch.light = light;
    batch.sample = samples;
    batch.count = count;
    batch.rays_traced = samples[0].path.rays;
    receivers_place(&batch);
    direct_find(&batch);
    openness_find(&batch);
    links_find(&batch);
    for (uint32_t i = 0; i < count; ++i) {
        if (!rgb_is_finite(samples[i].direct)) {
            samples[i].direct = rgb(0.0f, 0.0f, 0.0f);
        }
    }
}
