/* Gathering in batches: the same steps for many samples at once, so that each step's loop stays short and its data
 * near.
 */
#include <lambent/gather.h>

#include <float.h>
#include <string.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "transport/path.h"
#include "surface/bright_cells.h"
#include "trace/trace_internal.h"

enum {
    SAMPLES = LMB_RAY_BATCH,
    SAMPLES_PER_AIM = 4,      /* that a ray at a bright cell joins */
    SAMPLES_PER_PUNCTUAL = 2, /* a receiver asks no more punctual lights than it has samples for that */
};
_Static_assert((int)LMB_CONTRIBUTION_BATCH >= (int)SAMPLES && (int)SAMPLES >= 2 * LMB_PUNCTUAL_MAX,
               "room for the lights of a receiver");

/* Up to SAMPLES samples on their way. */
typedef struct gather_batch {
    const lmb_transport *transport;
    const lmb_surface_light *light; /* NULL: every ray is followed */
    uint64_t stream;
    uint32_t first;
    uint32_t count;
    lmb_receiver receiver;      /* that samples share, but for the position */
    lmb_vec3 position[SAMPLES]; /* of each sample's receiver */
    uint32_t per_receiver;      /* samples that one point has */
    bool second_half;           /* they start at points of the second half */
    bool skip_keys;             /* key lights are gathered apart */
    uint64_t *rays_traced;
    lmb_ray_batch rays;
    bool layers;            /* the level has any */
    lmb_rgb share[SAMPLES]; /* of each ray's light that they leave */
    lmb_contributions found;
    /* All receivers are near the first point: they choose lights as it would. */
    lmb_triangle_query triangles;
    lmb_light_query bright;
    lmb_light_memo triangles_memo;
    lmb_light_memo bright_memo;
} gather_batch;

static uint64_t replicate_stream(const lmb_transport *transport, const lmb_gather_samples *samples)
{
    const lmb_gather_point *point = &samples->points[0];
    uint64_t stream = lmb_stream_of_position(transport->seed, point->position);
    if (point->hemisphere) {
        stream = lmb_stream_of_position(stream, point->normal);
    }
    return lmb_mix(stream, samples->replicate);
}

static lmb_receiver point_receiver(const lmb_gather_point *point)
{
    return (lmb_receiver){.position = point->position,
                          .geometric_normal = point->normal,
                          .normal = point->normal,
                          .min_light_distance = point->min_light_distance,
                          .kind = point->hemisphere ? LMB_LOBE_HEMISPHERE : LMB_LOBE_SPHERE};
}

/* What all batches have in common; the position too, if it is the only one. */
static void receiver_set(gather_batch *batch, const lmb_gather_samples *samples)
{
    batch->receiver = point_receiver(&samples->points[0]);
    batch->receiver.triangles = &batch->triangles;
    for (uint32_t i = 0; i < SAMPLES && samples->point_count == 1; ++i) {
        batch->position[i] = batch->receiver.position;
    }
}

static void queries_set(gather_batch *batch, const lmb_gather_point *point)
{
    const lmb_vec3 *normal = point->hemisphere ? &point->normal : NULL;
    batch->triangles = (lmb_triangle_query){point->position, normal, &batch->triangles_memo};
    batch->bright = (lmb_light_query){point->position, normal, 0.0f, &batch->bright_memo};
    memset(batch->triangles_memo.node, 0, sizeof batch->triangles_memo.node);
    memset(batch->bright_memo.node, 0, sizeof batch->bright_memo.node);
}

/* The points that the batch's samples start at: of one half of them, which ends the batch. */
static void batch_points_set(gather_batch *batch, const lmb_gather_samples *samples)
{
    const uint32_t points = samples->point_count;
    uint32_t point = (batch->first / LMB_GATHER_BLOCK + samples->replicate * points / LMB_GATHER_REPLICATES) % points;
    batch->second_half = point >= points / 2;
    const uint32_t end = batch->second_half ? points : points / 2;
    const uint32_t most = (end - point) * LMB_GATHER_BLOCK;
    batch->count = batch->count < most ? batch->count : most;
    for (uint32_t i = 0; i < batch->count; i += LMB_GATHER_BLOCK, ++point) {
        for (uint32_t k = 0; k < LMB_GATHER_BLOCK; ++k) {
            batch->position[i + k] = samples->points[point].position;
        }
    }
}

static void batch_start(gather_batch *batch, const lmb_gather_samples *samples, uint32_t done)
{
    const uint32_t left = samples->count - done;
    batch->first = samples->first + done;
    batch->count = left < SAMPLES ? left : SAMPLES;
    batch->per_receiver = samples->point_count == 1 ? SAMPLES : LMB_GATHER_BLOCK;
    if (samples->point_count > 1) {
        batch_points_set(batch, samples);
    }
}

static lmb_receiver batch_receiver(const gather_batch *batch, uint32_t sample)
{
    lmb_receiver receiver = batch->receiver;
    receiver.position = batch->position[sample];
    return receiver;
}

static void batch_variates(const gather_batch *batch, uint32_t pair, float *x, float *y)
{
    lmb_sample_variates(batch->transport, (lmb_sample_range){batch->stream, batch->first, batch->count}, pair, x, y);
}

static void contribution_add(lmb_contributions *found, lmb_vec3 direction, lmb_rgb weight)
{
    const uint32_t i = found->count++;
    const bool counts = lmb_rgb_is_finite(weight) && lmb_rgb_max(weight) > 0.0f;
    found->direction[0][i] = direction.x;
    found->direction[1][i] = direction.y;
    found->direction[2][i] = direction.z;
    for (int c = 0; c < 3; ++c) {
        found->weight[c][i] = counts ? weight.c[c] : 0.0f;
    }
}

static void found_give(gather_batch *batch, lmb_gather_sink sink, void *context)
{
    while (batch->found.count % LMB_CONTRIBUTION_LANES != 0) {
        contribution_add(&batch->found, lmb_vec3_of(0.0f, 0.0f, 0.0f), lmb_rgb_of(0.0f, 0.0f, 0.0f));
    }
    if (batch->found.count > 0) {
        sink(context, &batch->found);
        batch->found.count = 0;
    }
}

/* Gives what there is as soon as SAMPLES more might not fit. */
static void found_make_room(gather_batch *batch, lmb_gather_sink sink, void *context)
{
    if (batch->found.count + SAMPLES > LMB_CONTRIBUTION_BATCH) {
        found_give(batch, sink, context);
    }
}

/* Where light comes from that the batch's rays aim at, and what it gives where nothing is in its way. */
typedef struct aimed_lights {
    lmb_vec3 direction[SAMPLES];
    lmb_rgb weight[SAMPLES];
} aimed_lights;

static void aimed_trace(gather_batch *batch, const aimed_lights *lights)
{
    lmb_rgb share[SAMPLES];
    lmb_trace_transmittance_batch(batch->transport->tracer, &batch->rays, share, batch->rays_traced);
    for (uint32_t i = 0; i < batch->rays.count; ++i) {
        if (lmb_rgb_max(share[i]) > 0.0f) {
            contribution_add(&batch->found, lights->direction[i], lmb_rgb_mul(lights->weight[i], share[i]));
        }
    }
}

static void aimed_add(gather_batch *batch, aimed_lights *lights, lmb_vec3 direction, const lmb_aimed_light *aimed)
{
    lights->direction[batch->rays.count] = direction;
    lights->weight[batch->rays.count] = aimed->weight;
    lmb_ray_batch_add(&batch->rays, aimed->origin, aimed->towards, aimed->far_distance);
}

/* Aims each sample at its light, and traces that. */
static void lights_trace(gather_batch *batch, const lmb_light_sample light[SAMPLES], bool at_infinity)
{
    aimed_lights lights;
    batch->rays.count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        const lmb_receiver receiver = batch_receiver(batch, i);
        lmb_aimed_light aimed;
        if (light[i].density > 0.0f && lmb_receiver_aim(&receiver, &light[i], at_infinity, &aimed)) {
            aimed_add(batch, &lights, light[i].direction, &aimed);
        }
    }
    aimed_trace(batch, &lights);
}

static void gather_triangles(gather_batch *batch)
{
    float x[SAMPLES], y[SAMPLES], choice[SAMPLES], unused[SAMPLES];
    lmb_light_sample light[SAMPLES];
    batch_variates(batch, PAIR_TRIANGLE, x, y);
    batch_variates(batch, PAIR_CHOICE, choice, unused);
    const lmb_triangle_choices choices = {batch->count, batch->position, choice, x, y};
    lmb_emitters_sample_triangles(batch->transport->emitters, &batch->triangles, &choices, light);
    lights_trace(batch, light, false);
}

static void gather_environment(gather_batch *batch)
{
    float x[SAMPLES], y[SAMPLES];
    lmb_light_sample light[SAMPLES];
    batch_variates(batch, PAIR_ENVIRONMENT, x, y);
    lmb_emitters_sample_environment(batch->transport->emitters, x, y, batch->count, light);
    lights_trace(batch, light, true);
}

/* One receiver's share of a batch. */
typedef struct receiver_samples {
    lmb_receiver receiver;
    uint32_t first; /* in the batch */
    uint32_t count;
} receiver_samples;

static void punctual_add(gather_batch *batch, aimed_lights *lights, const lmb_receiver *receiver,
                         const lmb_punctual_sample *light, float samples)
{
    lmb_aimed_light aimed;
    if (lmb_receiver_aim_punctual(receiver, light, &aimed)) {
        aimed.weight = lmb_rgb_scale(aimed.weight, samples);
        aimed_add(batch, lights, light->direction, &aimed);
    }
}

/* Aims at up to `max` lights of a kind. Those of no extent are the same for all of the receiver's samples: each is
 * asked once, and counts for all of them. Returns how many others `light` is left with. */
static int punctual_aim(gather_batch *batch, aimed_lights *lights, const receiver_samples *samples,
                        const float choice[2], int max, lmb_punctual_sample light[2 * LMB_PUNCTUAL_MAX])
{
    lmb_punctual_query query = lmb_receiver_punctual(&samples->receiver);
    query.skip_keys = batch->skip_keys;
    const int count = lmb_emitters_punctual(batch->transport->emitters, &query, choice, max, light);
    int soft = 0;
    for (int i = 0; i < count; ++i) {
        if (light[i].soft) {
            light[soft++] = light[i];
        } else {
            punctual_add(batch, lights, &samples->receiver, &light[i], (float)samples->count);
        }
    }
    return soft;
}

/* Traces what was aimed at, so that there is room again. */
static void punctual_trace(gather_batch *batch, const aimed_lights *lights, lmb_gather_sink sink, void *context)
{
    aimed_trace(batch, lights);
    found_make_room(batch, sink, context);
    batch->rays.count = 0;
}

/* Points of lights of an extent: one for each of the batch's samples. */
typedef struct soft_points {
    float x[SAMPLES], y[SAMPLES];
} soft_points;

/* Soft lights share the receiver's samples among them. */
static void soft_aim(gather_batch *batch, aimed_lights *lights, const receiver_samples *samples,
                     lmb_punctual_sample *light, int count, const soft_points *points)
{
    const uint32_t share = samples->count / (uint32_t)count;
    const uint32_t each = share > 0 ? share : 1;
    lmb_punctual_query query = lmb_receiver_punctual(&samples->receiver);
    for (uint32_t i = 0; i < (uint32_t)count * each; ++i) {
        lmb_punctual_sample *sample = &light[i / each];
        const uint32_t index = samples->first + i % samples->count;
        query.point[0] = points->x[index];
        query.point[1] = points->y[index];
        lmb_emitters_punctual_again(batch->transport->emitters, &query, sample);
        punctual_add(batch, lights, &samples->receiver, sample, (float)samples->count / (float)each);
    }
}

static void gather_punctual(gather_batch *batch, lmb_gather_sink sink, void *context)
{
    const uint32_t receivers = (batch->count + batch->per_receiver - 1) / batch->per_receiver;
    float x[SAMPLES], y[SAMPLES];
    soft_points points;
    aimed_lights lights;
    const lmb_sample_range range = {batch->stream, batch->first / batch->per_receiver, receivers};
    lmb_sample_variates(batch->transport, range, PAIR_CHOICE, x, y);
    if (lmb_emitters_punctual_are_soft(batch->transport->emitters, batch->skip_keys)) {
        batch_variates(batch, lmb_light_pair(0), points.x, points.y);
    }
    batch->rays.count = 0;
    for (uint32_t i = 0; i < receivers; ++i) {
        const uint32_t first = i * batch->per_receiver;
        const uint32_t left = batch->count - first;
        const uint32_t count = left < batch->per_receiver ? left : batch->per_receiver;
        const receiver_samples samples = {batch_receiver(batch, first), first, count};
        const uint32_t wanted = count / SAMPLES_PER_PUNCTUAL;
        const int max = wanted < 1 ? 1 : wanted < LMB_PUNCTUAL_MAX ? (int)wanted : LMB_PUNCTUAL_MAX;
        const float choice[2] = {x[i], y[i]};
        lmb_punctual_sample light[2 * LMB_PUNCTUAL_MAX];
        if (batch->rays.count + 2 * LMB_PUNCTUAL_MAX > SAMPLES) {
            punctual_trace(batch, &lights, sink, context);
        }
        const int soft = punctual_aim(batch, &lights, &samples, choice, max, light);
        if (soft > 0) {
            /* They are no more than their receiver's samples, or one each. */
            punctual_trace(batch, &lights, sink, context);
            soft_aim(batch, &lights, &samples, light, soft, &points);
        }
    }
    aimed_trace(batch, &lights);
}

/* Rays of all directions by the receivers' density, which is returned for each. */
static void rays_make(gather_batch *batch, float density[SAMPLES])
{
    lmb_ray_batch *rays = &batch->rays;
    float x[SAMPLES], y[SAMPLES];
    float *const direction[3] = {rays->direction[0], rays->direction[1], rays->direction[2]};
    batch_variates(batch, PAIR_DIRECTION, x, y);
    lmb_directions_make(batch->receiver.kind, batch->receiver.normal, x, y, batch->count, direction);
    rays->count = batch->count;
    for (uint32_t i = 0; i < batch->count; ++i) {
        const lmb_vec3 towards = lmb_vec3_of(direction[0][i], direction[1][i], direction[2][i]);
        const lmb_receiver receiver = batch_receiver(batch, i);
        const lmb_vec3 origin = lmb_receiver_ray_origin(&receiver, towards);
        density[i] = lmb_receiver_density(&receiver, towards);
        rays->origin[0][i] = origin.x;
        rays->origin[1][i] = origin.y;
        rays->origin[2][i] = origin.z;
        rays->far_distance[i] = FLT_MAX;
    }
}

/* The nearest hits of all rays through layers. A ray joins a sample: its own, or one of every `step`. */
static void rays_trace(gather_batch *batch, uint32_t step, int32_t vertex, lmb_hit hit[SAMPLES])
{
    uint64_t chance[SAMPLES];
    for (uint32_t i = 0; batch->layers && i < batch->rays.count; ++i) {
        chance[i] = lmb_layer_chance(batch->stream, batch->first + i * step, vertex);
    }
    lmb_trace_through_batch(batch->transport->tracer, &batch->rays, chance, hit, batch->share, batch->rays_traced);
}

/* What layers leave of a ray's light. */
static inline lmb_rgb ray_share(const gather_batch *batch, uint32_t ray)
{
    return batch->layers ? batch->share[ray] : lmb_rgb_of(1.0f, 1.0f, 1.0f);
}

/* Radiance along a ray that ends on what takes more than a look at the surface's light. */
static lmb_rgb radiance_followed(const gather_batch *batch, uint32_t sample, lmb_vec3 direction, const lmb_hit *hit)
{
    const lmb_ray_batch *rays = &batch->rays;
    lmb_path path = {batch->transport, batch->stream, batch->first + sample, 0, batch->rays_traced};
    const lmb_vec3 origin = lmb_vec3_of(rays->origin[0][sample], rays->origin[1][sample], rays->origin[2][sample]);
    const lmb_receiver receiver = batch_receiver(batch, sample);
    lmb_segment segment = {&receiver, origin, direction, ray_share(batch, sample)};
    const lmb_path_vertex vertex = lmb_segment_vertex(&path, &segment, hit);
    return lmb_path_radiance(&path, segment, vertex);
}

/* Radiance of a patch along a ray that hits it, by what layers leave of it; of an uneven one that of the very hit. */
static lmb_rgb patch_radiance(const gather_batch *batch, uint32_t ray, lmb_vec3 direction, const lmb_hit *hit,
                              uint32_t patch)
{
    if (lmb_patch_is_uneven(batch->light, patch)) {
        return radiance_followed(batch, ray, direction, hit);
    }
    const lmb_rgb radiance = batch->light->radiance[patch];
    return batch->layers ? lmb_rgb_mul(radiance, batch->share[ray]) : radiance;
}

static lmb_vec3 ray_direction(const gather_batch *batch, uint32_t sample)
{
    const lmb_ray_batch *rays = &batch->rays;
    return lmb_vec3_of(rays->direction[0][sample], rays->direction[1][sample], rays->direction[2][sample]);
}

static void ray_give(gather_batch *batch, uint32_t sample, lmb_rgb radiance, float density)
{
    const float weight = density > 0.0f ? 1.0f / density : 0.0f;
    contribution_add(&batch->found, ray_direction(batch, sample), lmb_rgb_scale(radiance, weight));
}

/* Rays that leave the level. */
static void skies_gather(gather_batch *batch, const lmb_hit *hit, const float *density)
{
    float direction[3][SAMPLES];
    uint32_t ray[SAMPLES]; /* their indices in the batch */
    uint32_t count = 0;
    for (uint32_t i = 0; i < batch->count; ++i) {
        if (hit[i].instance == LMB_HIT_NOTHING) {
            for (int axis = 0; axis < 3; ++axis) {
                direction[axis][count] = batch->rays.direction[axis][i];
            }
            ray[count++] = i;
        }
    }
    lmb_environment_seen seen[SAMPLES];
    const float *const arrays[3] = {direction[0], direction[1], direction[2]};
    lmb_emitters_environment_look(batch->transport->emitters, arrays, count, seen);
    for (uint32_t k = 0; k < count; ++k) {
        const uint32_t i = ray[k];
        const lmb_rgb sky = lmb_segment_sky(&batch->receiver, ray_direction(batch, i), &seen[k]);
        ray_give(batch, i, batch->layers ? lmb_rgb_mul(sky, batch->share[i]) : sky, density[i]);
    }
}

/* Rays at bright cells that join the batch's samples: the first of every SAMPLES_PER_AIM. */
static uint32_t batch_aims(const gather_batch *batch)
{
    return (batch->count + SAMPLES_PER_AIM - 1) / SAMPLES_PER_AIM;
}

static float aims_per_sample(const gather_batch *batch)
{
    return (float)batch_aims(batch) / (float)batch->count;
}

/* A ray at a bright cell, and a sample of the receiver that it joins. */
typedef struct bright_ray {
    lmb_bright_aim aim;
    uint32_t sample;
} bright_ray;

static void bright_rays_make(gather_batch *batch, bright_ray *made)
{
    const lmb_transport *transport = batch->transport;
    const uint32_t first = batch->first / SAMPLES_PER_AIM;
    const uint32_t aims = batch_aims(batch);
    float x[SAMPLES], y[SAMPLES], choice[SAMPLES], unused[SAMPLES];
    const lmb_sample_range range = {batch->stream, first, aims};
    lmb_sample_variates(transport, range, PAIR_BRIGHT, x, y);
    lmb_sample_variates(transport, range, PAIR_BRIGHT_CHOICE, choice, unused);
    batch->rays.count = 0;
    for (uint32_t i = 0; i < aims; ++i) {
        const float point[2] = {x[i], y[i]};
        bright_ray *ray = &made[batch->rays.count];
        ray->sample = i * SAMPLES_PER_AIM;
        const lmb_receiver receiver = batch_receiver(batch, ray->sample);
        if (lmb_bright_cells_aim(batch->light->bright, &batch->bright, receiver.position, choice[i], point,
                                 &ray->aim) &&
            lmb_receiver_sees(&receiver, ray->aim.direction)) {
            lmb_ray_batch_add(&batch->rays, lmb_receiver_ray_origin(&receiver, ray->aim.direction), ray->aim.direction,
                              FLT_MAX);
        }
    }
}

/* Rays at bright cells, weighted against those that find them by chance. */
static void gather_bright(gather_batch *batch)
{
    const lmb_transport *transport = batch->transport;
    const lmb_surface_light *light = batch->light;
    bright_ray ray[SAMPLES];
    lmb_hit hit[SAMPLES];
    bright_rays_make(batch, ray);
    rays_trace(batch, SAMPLES_PER_AIM, LMB_CHANCE_OF_AIM, hit);
    for (uint32_t i = 0; i < batch->rays.count; ++i) {
        const lmb_bright_aim *aim = &ray[i].aim;
        uint32_t patch;
        if (hit[i].instance != LMB_HIT_NOTHING &&
            lmb_surface_light_find(light, transport->tracer, &hit[i], transport->bounces < 0, batch->rays_traced,
                                   &patch) &&
            patch == aim->patch) {
            const float density = lmb_receiver_density(&batch->receiver, aim->direction) +
                                  aims_per_sample(batch) * lmb_bright_aim_density(light->bright, aim, &hit[i]);
            const lmb_rgb radiance = patch_radiance(batch, i, aim->direction, &hit[i], patch);
            contribution_add(&batch->found, aim->direction, lmb_rgb_scale(radiance, 1.0f / density));
        }
    }
}

/* Patches that have the radiance of what rays hit, NO_PATCH where it takes a closer look. Their memory is on its way.
 */
#define NO_PATCH UINT32_MAX
static void patches_find(const gather_batch *batch, const lmb_hit *hit, uint32_t *patch)
{
    const lmb_surface_light *light = batch->light;
    for (uint32_t i = 0; light && i < batch->count; ++i) {
        if (hit[i].instance != LMB_HIT_NOTHING) {
            lmb_surface_light_prefetch(light, &hit[i]);
        }
    }
    for (uint32_t i = 0; i < batch->count; ++i) {
        if (light && hit[i].instance != LMB_HIT_NOTHING &&
            lmb_surface_light_find(light, batch->transport->tracer, &hit[i], batch->transport->bounces < 0,
                                   batch->rays_traced, &patch[i])) {
            __builtin_prefetch(&light->radiance[patch[i]]);
        } else {
            patch[i] = NO_PATCH;
        }
    }
}

/* Rays that end on surfaces. */
static void surfaces_gather(gather_batch *batch, const lmb_hit *hit, const float *density)
{
    const lmb_surface_light *light = batch->light;
    uint32_t patch[SAMPLES];
    patches_find(batch, hit, patch);
    for (uint32_t i = 0; i < batch->count; ++i) {
        if (hit[i].instance == LMB_HIT_NOTHING) {
            continue;
        }
        const lmb_vec3 direction = ray_direction(batch, i);
        if (patch[i] == NO_PATCH) {
            ray_give(batch, i, radiance_followed(batch, i, direction, &hit[i]), density[i]);
            continue;
        }
        float aimed = 0.0f;
        if (light->bright) {
            aimed =
                aims_per_sample(batch) * lmb_bright_cells_density(light, &batch->bright, direction, &hit[i], patch[i]);
        }
        ray_give(batch, i, patch_radiance(batch, i, direction, &hit[i], patch[i]), density[i] + aimed);
    }
}

static void gather_rays(gather_batch *batch)
{
    float density[SAMPLES];
    lmb_hit hit[SAMPLES];
    rays_make(batch, density);
    rays_trace(batch, 1, 0, hit);
    skies_gather(batch, hit, density);
    surfaces_gather(batch, hit, density);
}

/* Light that is steady is given by itself. */
static void gather_punctual_apart(gather_batch *batch, lmb_gather_sink sink, void *context)
{
    const bool steady = lmb_emitters_punctual_are_few(batch->transport->emitters, batch->skip_keys);
    if (steady) {
        found_give(batch, sink, context);
    }
    batch->found.steady = steady;
    gather_punctual(batch, sink, context);
    if (steady) {
        found_give(batch, sink, context);
    }
    batch->found.steady = false;
    found_make_room(batch, sink, context);
}

void lmb_gather(const lmb_transport *transport, const lmb_gather_samples *samples, lmb_gather_sink sink, void *context,
                uint64_t *rays)
{
    gather_batch batch; /* large: only what is used is set */
    batch.transport = transport;
    batch.light = transport->bounces != 0 ? transport->surface : NULL;
    batch.stream = replicate_stream(transport, samples);
    batch.skip_keys = samples->without_keys;
    batch.rays_traced = rays;
    batch.layers = lmb_tracer_has_layers(transport->tracer);
    batch.found.count = 0;
    batch.found.steady = false;
    batch.second_half = batch.found.second_half = false;
    receiver_set(&batch, samples);
    queries_set(&batch, &samples->points[0]);
    for (uint32_t done = 0; done < samples->count; done += batch.count) {
        batch_start(&batch, samples, done);
        if (batch.second_half != batch.found.second_half) {
            found_give(&batch, sink, context);
            batch.found.second_half = batch.second_half;
        }
        if (lmb_emitters_triangle_count(transport->emitters) > 0) {
            gather_triangles(&batch);
            found_make_room(&batch, sink, context);
        }
        if (lmb_emitters_environment_sampled(transport->emitters)) {
            gather_environment(&batch);
            found_make_room(&batch, sink, context);
        }
        if (lmb_emitters_have_punctual(transport->emitters, batch.skip_keys) && !samples->without_punctual) {
            gather_punctual_apart(&batch, sink, context);
        }
        gather_rays(&batch);
        found_make_room(&batch, sink, context);
        if (batch.light && batch.light->bright) {
            gather_bright(&batch);
            found_make_room(&batch, sink, context);
        }
    }
    found_give(&batch, sink, context);
}

bool lmb_gather_punctual(const lmb_transport *transport, const lmb_gather_point *point, bool without_keys,
                         lmb_gather_sink sink, void *context, uint64_t *rays)
{
    if (!lmb_emitters_punctual_are_few(transport->emitters, without_keys)) {
        return false;
    }
    const receiver_samples one = {point_receiver(point), 0, 1};
    const float choice[2] = {0.0f, 0.0f};
    lmb_punctual_sample light[2 * LMB_PUNCTUAL_MAX];
    gather_batch batch; /* large: only what is used is set */
    batch.transport = transport;
    batch.skip_keys = without_keys;
    batch.rays_traced = rays;
    batch.found.count = 0;
    batch.found.second_half = false;
    batch.found.steady = true;
    batch.rays.count = 0;
    aimed_lights lights;
    punctual_aim(&batch, &lights, &one, choice, LMB_PUNCTUAL_MAX, light);
    aimed_trace(&batch, &lights);
    found_give(&batch, sink, context);
    return true;
}
