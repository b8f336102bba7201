#include "solve/side_sample.h"

#include <lambent/sequence.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include "transport/segment.h"
#include "trace/trace_internal.h"

#define STREAM_OF_CELLS UINT64_C(0x73757266616365)

/* Samples on their way. */
typedef struct sample_batch {
    const lmb_transport *transport;
    const lmb_surface_light *light;
    lmb_side_sample *sample;
    uint32_t count;
    bool corrects; /* direct light is known but for what patches leave open */
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

/* Two variates of each sample, for the samples of a side at once. */
typedef struct sample_variates {
    float x[LMB_SIDE_SAMPLES];
    float y[LMB_SIDE_SAMPLES];
} sample_variates;

static void variates_find(const sample_batch *batch, uint32_t pair, sample_variates *pairs)
{
    for (uint32_t i = 0, end; i < batch->count; i = end) {
        const lmb_path *path = &batch->sample[i].path;
        end = i + 1;
        while (end < batch->count && batch->sample[end].path.stream == path->stream) {
            ++end;
        }
        const lmb_sample_range samples = {path->stream, path->sample, end - i};
        lmb_sample_variates(path->transport, samples, pair, &pairs->x[i], &pairs->y[i]);
    }
}

/* The same of their starts. */
static void start_variates_find(const sample_batch *batch, sample_variates *pairs)
{
    for (uint32_t i = 0, end; i < batch->count; i = end) {
        const lmb_side_sample *sample = &batch->sample[i];
        end = i + 1;
        while (end < batch->count && sample[end - i].start_stream == sample->start_stream &&
               sample[end - i].start_sample == sample->start_sample + (end - i)) {
            ++end;
        }
        const lmb_sample_range samples = {sample->start_stream, sample->start_sample, end - i};
        lmb_sample_variates(batch->transport, samples, LMB_PAIR_START, &pairs->x[i], &pairs->y[i]);
    }
}

static void receivers_place(sample_batch *batch)
{
    sample_variates points;
    start_variates_find(batch, &points);
    for (uint32_t i = 0; i < batch->count; ++i) {
        const lmb_side_sample *sample = &batch->sample[i];
        const float u[2] = {points.x[i], points.y[i]};
        const lmb_hit start = lmb_cell_point(&sample->cell, u);
        const lmb_place place = lmb_trace_place(batch->transport->tracer, &start);
        batch->receiver[i] = lmb_receiver_on_surface(&place, sample->front);
    }
}

static void skies_sample(const sample_batch *batch, lmb_direct_start *starts)
{
    sample_variates pairs;
    lmb_light_sample sky[LMB_SIDE_SAMPLES];
    variates_find(batch, PAIR_ENVIRONMENT, &pairs);
    lmb_emitters_sample_environment(batch->transport->emitters, pairs.x, pairs.y, batch->count, sky);
    for (uint32_t i = 0; i < batch->count; ++i) {
        starts[i].environment = sky[i];
    }
}

/* Where next-event estimation starts, as for a path. */
static void starts_find(const sample_batch *batch, lmb_direct_start *starts)
{
    const lmb_transport *transport = batch->transport;
    if (lmb_emitters_triangle_count(transport->emitters) > 0 ||
        lmb_emitters_have_punctual(transport->emitters, false)) {
        sample_variates choice, triangle;
        variates_find(batch, PAIR_CHOICE, &choice);
        variates_find(batch, PAIR_TRIANGLE, &triangle);
        for (uint32_t i = 0; i < batch->count; ++i) {
            starts[i] =
                (lmb_direct_start){.triangle = {triangle.x[i], triangle.y[i]}, .choice = {choice.x[i], choice.y[i]}};
        }
    }
    if (lmb_emitters_punctual_are_soft(transport->emitters, false)) {
        sample_variates light;
        variates_find(batch, lmb_light_pair(0), &light);
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
    bool is_sun[LMB_RAY_BATCH];
    lmb_direct_start starts[LMB_SIDE_SAMPLES];
    starts_find(batch, starts);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        lmb_aimed_light aimed[LMB_AIMED_MOST];
        const int count = lmb_direct_aim(batch->transport, &batch->receiver[i], &starts[i], aimed);
        for (int k = 0; k < count; ++k) {
            weight[batch->rays.count] = aimed[k].weight;
            is_sun[batch->rays.count] = aimed[k].is_sun;
            ray_add(batch, i, aimed[k].origin, aimed[k].towards, aimed[k].far_distance);
        }
        batch->sample[i].direct = lmb_rgb_of(0.0f, 0.0f, 0.0f);
        batch->sample[i].sun = lmb_rgb_of(0.0f, 0.0f, 0.0f);
    }
    lmb_trace_transmittance_batch(batch->transport->tracer, &batch->rays, share, batch->rays_traced);
    for (uint32_t k = 0; k < batch->rays.count; ++k) {
        lmb_side_sample *sample = &batch->sample[batch->owner[k]];
        const lmb_rgb arrives = lmb_rgb_mul(weight[k], share[k]);
        sample->direct = lmb_rgb_add(sample->direct, arrives);
        if (is_sun[k]) {
            sample->sun = lmb_rgb_add(sample->sun, arrives);
        }
    }
}

/* Whether a ray from the start of a sample gets away from the cell. It has a direction of its own: the one by
 * which the sample finds light would count more often the brighter what it sees. */
static void openness_find(sample_batch *batch)
{
    lmb_rgb share[LMB_RAY_BATCH];
    sample_variates directions;
    variates_find(batch, LMB_PAIR_OPENNESS, &directions);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        lmb_side_sample *sample = &batch->sample[i];
        const lmb_receiver *receiver = &batch->receiver[i];
        const float u[2] = {directions.x[i], directions.y[i]};
        const lmb_vec3 direction = lmb_receiver_direction(receiver, u);
        sample->link = (lmb_link){.open = false};
        if (lmb_receiver_sees(receiver, direction)) {
            ray_add(batch, i, lmb_receiver_ray_origin(receiver, direction),
                    lmb_vec3_scale(direction, lmb_cell_near(sample->cell.grid)), LMB_TRACE_UP_TO_END);
        }
    }
    lmb_trace_transmittance_batch(batch->transport->tracer, &batch->rays, share, batch->rays_traced);
    for (uint32_t k = 0; k < batch->rays.count; ++k) {
        batch->sample[batch->owner[k]].link.open = lmb_rgb_max(share[k]) > 0.0f;
    }
}

static void link_weigh(lmb_link *link, lmb_rgb weight)
{
    for (int c = 0; c < 3; ++c) {
        link->weight[c] = (uint16_t)(lmb_saturate(weight.c[c]) * 65535.0f + 0.5f);
    }
}

/* Reflections at most before a path finds a patch. */
enum { LINK_VERTICES = 8 };

/* Reflects a path where the light of no patch stands for that of its vertex, and adds the direct light there. False
 * when it ends. */
static bool path_reflect(lmb_path *path, lmb_segment *segment, lmb_path_vertex *vertex, lmb_receiver *here,
                         lmb_rgb *direct)
{
    segment->throughput = lmb_rgb_mul(segment->throughput, vertex->albedo);
    *here = lmb_vertex_receiver(path, vertex);
    *direct = lmb_rgb_add(*direct, lmb_rgb_mul(segment->throughput, lmb_direct_collect(path, here)));
    float u[2];
    lmb_path_variates(path, PAIR_DIRECTION, u);
    segment->from = here;
    segment->direction = lmb_receiver_direction(here, u);
    segment->origin = lmb_receiver_ray_origin(here, segment->direction);
    if (!lmb_receiver_sees(here, segment->direction)) {
        return false;
    }
    *vertex = lmb_segment_follow(path, segment);
    *direct = lmb_rgb_add(*direct, lmb_rgb_mul(segment->throughput, vertex->emitted));
    return true;
}

/* The weight as the bounces take it: what is corrected in a patch's light is to vanish where the patch's light does. */
static lmb_rgb link_weight_rounded(const lmb_link *link)
{
    return lmb_rgb_scale(lmb_rgb_of((float)link->weight[0], (float)link->weight[1], (float)link->weight[2]),
                         1.0f / 65535.0f);
}

static void sample_correct(const sample_batch *batch, lmb_side_sample *sample, const lmb_path *path,
                           const lmb_path_vertex *vertex)
{
    const lmb_rgb mean = batch->light->sun[sample->link.target];
    const lmb_receiver here = lmb_vertex_receiver(path, vertex);
    const lmb_rgb direct = lmb_direct_collect_suns(path, &here);
    sample->direct = lmb_rgb_mul(link_weight_rounded(&sample->link), lmb_rgb_add(direct, lmb_rgb_scale(mean, -1.0f)));
}

static void sample_land(const sample_batch *batch, uint32_t ray, const lmb_hit *hit, lmb_rgb share)
{
    const lmb_ray_batch *rays = &batch->rays;
    const lmb_tracer *tracer = batch->transport->tracer;
    lmb_side_sample *sample = &batch->sample[batch->owner[ray]];
    lmb_segment segment = {&batch->receiver[batch->owner[ray]],
                           lmb_vec3_of(rays->origin[0][ray], rays->origin[1][ray], rays->origin[2][ray]),
                           lmb_vec3_of(rays->direction[0][ray], rays->direction[1][ray], rays->direction[2][ray]),
                           share};
    lmb_path path = sample->path;
    lmb_path_vertex vertex = lmb_segment_vertex(&path, &segment, hit->instance != LMB_HIT_NOTHING ? hit : NULL);
    sample->direct = lmb_rgb_add(sample->direct, lmb_rgb_mul(segment.throughput, vertex.emitted));
    lmb_receiver receivers[2]; /* the one at hand, and the one before, which `segment.from` points to */
    for (path.vertex = 2; vertex.on_surface && lmb_rgb_max(vertex.albedo) > 0.0f; ++path.vertex) {
        uint32_t patch;
        if (lmb_surface_light_patch(batch->light, tracer, &vertex.hit, vertex.hit.front, path.rays, &patch)) {
            sample->link.target = patch;
            link_weigh(&sample->link, lmb_rgb_mul(segment.throughput, vertex.albedo));
            if (batch->corrects) {
                sample_correct(batch, sample, &path, &vertex);
            }
            return;
        }
        if (path.vertex > LINK_VERTICES ||
            !path_reflect(&path, &segment, &vertex, &receivers[path.vertex % 2], &sample->direct)) {
            return;
        }
    }
}

static void links_find(sample_batch *batch)
{
    uint64_t chance[LMB_RAY_BATCH];
    lmb_hit hit[LMB_RAY_BATCH];
    lmb_rgb share[LMB_RAY_BATCH];
    sample_variates directions;
    variates_find(batch, PAIR_DIRECTION, &directions);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        const lmb_receiver *receiver = &batch->receiver[i];
        const float u[2] = {directions.x[i], directions.y[i]};
        const lmb_vec3 direction = lmb_receiver_direction(receiver, u);
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
        sample_land(batch, k, &hit[k], layers ? share[k] : lmb_rgb_of(1.0f, 1.0f, 1.0f));
    }
}

uint64_t lmb_side_stream(const lmb_transport *transport, const lmb_cell *cell, uint32_t side)
{
    const uint64_t instance = lmb_mix(transport->seed ^ STREAM_OF_CELLS, cell->instance);
    return lmb_mix(lmb_mix(instance, cell->triangle), 2 * (uint64_t)cell->index + (side & 1));
}

static void batch_begin(sample_batch *batch, const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count)
{
    batch->transport = samples[0].path.transport;
    batch->light = light;
    batch->sample = samples;
    batch->count = count;
    batch->rays_traced = samples[0].path.rays;
    receivers_place(batch);
}

static lmb_rgb finite_or_black(lmb_rgb light)
{
    return lmb_rgb_is_finite(light) ? light : lmb_rgb_of(0.0f, 0.0f, 0.0f);
}

void lmb_side_samples_take(const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count)
{
    sample_batch batch; /* large: only what is used is set */
    batch.corrects = false;
    batch_begin(&batch, light, samples, count);
    direct_find(&batch);
    openness_find(&batch);
    links_find(&batch);
    for (uint32_t i = 0; i < count; ++i) {
        samples[i].direct = finite_or_black(samples[i].direct);
        samples[i].sun = finite_or_black(samples[i].sun);
    }
}

void lmb_side_samples_correct(const lmb_surface_light *light, lmb_side_sample *samples, uint32_t count)
{
    sample_batch batch;
    batch.corrects = true;
    batch_begin(&batch, light, samples, count);
    for (uint32_t i = 0; i < count; ++i) {
        samples[i].direct = lmb_rgb_of(0.0f, 0.0f, 0.0f);
    }
    links_find(&batch);
    for (uint32_t i = 0; i < count; ++i) {
        samples[i].direct = finite_or_black(samples[i].direct);
    }
}
