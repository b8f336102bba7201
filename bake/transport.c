#include <lambent/transport.h>

#include <float.h>

#include <lambent/sequence.h>

#include "bake_internal.h"

/* Dimension pairs of the sequence: the gather point uses vertex 0's, the k-th reflection vertex k's. */
enum { PAIR_DIRECTION, PAIR_TRIANGLE, PAIR_CHOICE, PAIR_ENVIRONMENT, PAIR_ROULETTE, PAIRS_PER_VERTEX };

/* Roulette starts after this many reflections: short paths carry most of the light. Survival is the albedo itself (a
 * lower one would let weights grow without bound), kept just below 1 so that a white room ends. */
#define ROULETTE_AFTER 2
#define ROULETTE_MAX_SURVIVAL 0.999f

/* One sample of one stream: where its random numbers come from. */
typedef struct lmb_path {
    const lmb_transport *transport;
    uint64_t stream;
    uint32_t sample;
    uint32_t vertex; /* reflections so far */
    uint64_t *rays;
} lmb_path;

/* A point that light is collected at: a gather point or a reflection. */
typedef struct lmb_receiver {
    lmb_vec3 position;         /* on the surface, or in space */
    lmb_vec3 geometric_normal; /* on the lit side; unused in space */
    lmb_vec3 normal;           /* shading normal; unused for a sphere */
    float rounding;            /* lmb_place's; unused for a gather point */
    float min_light_distance;
    enum { RECEIVE_SPHERE, RECEIVE_HEMISPHERE, RECEIVE_DIFFUSE } kind;
} lmb_receiver;

static void path_numbers(const lmb_path *path, uint32_t pair, float point[2])
{
    lmb_sequence_2d(path->stream, path->sample, path->vertex * PAIRS_PER_VERTEX + pair, point);
}

/* Density of the direction that direction sampling picks, per solid angle. */
static float receiver_density(const lmb_receiver *receiver, lmb_vec3 direction)
{
    switch (receiver->kind) {
    case RECEIVE_SPHERE:
        return 1.0f / (4.0f * LMB_PI_F);
    case RECEIVE_HEMISPHERE:
        return lmb_hemisphere_density(vec3_dot(receiver->normal, direction));
    default:
        return fmaxf(vec3_dot(receiver->normal, direction), 0.0f) / LMB_PI_F;
    }
}

static lmb_vec3 receiver_direction(const lmb_receiver *receiver, const float point[2])
{
    switch (receiver->kind) {
    case RECEIVE_SPHERE:
        return lmb_sphere_sample(point);
    case RECEIVE_HEMISPHERE:
        return lmb_hemisphere_sample(receiver->normal, point);
    default:
        return lmb_cosine_sample(receiver->normal, point);
    }
}

/* Whether light from `direction` counts at all. A smooth shading normal's hemisphere reaches below the triangle: from
 * there the surface itself blocks the light. */
static bool receiver_sees(const lmb_receiver *receiver, lmb_vec3 direction)
{
    if (receiver->kind == RECEIVE_SPHERE) {
        return true;
    }
    return vec3_dot(receiver->normal, direction) > 0.0f &&
           (receiver->kind == RECEIVE_HEMISPHERE || vec3_dot(receiver->geometric_normal, direction) > 0.0f);
}

/* The receiver's own factor of light from `direction`: a gather point takes it as it is, a surface by the cosine. */
static float receiver_response(const lmb_receiver *receiver, lmb_vec3 direction)
{
    return receiver->kind == RECEIVE_DIFFUSE ? vec3_dot(receiver->normal, direction) / LMB_PI_F : 1.0f;
}

/* A point in space may lie exactly on a surface: its rays start beyond, so that it sees both sides. */
static lmb_vec3 receiver_ray_origin(const lmb_receiver *receiver, lmb_vec3 direction)
{
    switch (receiver->kind) {
    case RECEIVE_SPHERE:
        return vec3_mad(receiver->position, direction, lmb_trace_epsilon(receiver->position));
    case RECEIVE_HEMISPHERE:
        return receiver->position;
    default:
        return lmb_trace_offset(receiver->position, receiver->geometric_normal, receiver->rounding, direction);
    }
}

/* Balance heuristic weight of a technique with density `mine` beside one with `other`. */
static float balance(float mine, float other)
{
    return mine / (mine + other);
}

/* What next-event estimation found: up to four contributions. */
typedef struct lmb_direct_light {
    lmb_vec3 direction[4];
    lmb_rgb weight[4]; /* radiance x solid angle, times the receiver's response */
    int count;
} lmb_direct_light;

static void direct_add(lmb_direct_light *direct, lmb_vec3 direction, lmb_rgb weight)
{
    if (rgb_max(weight) > 0.0f) {
        direct->direction[direct->count] = direction;
        direct->weight[direct->count++] = weight;
    }
}

static void direct_add_triangle(const lmb_path *path, const lmb_receiver *receiver, lmb_direct_light *direct)
{
    const lmb_transport *transport = path->transport;
    float point[2], choice[2];
    path_numbers(path, PAIR_TRIANGLE, point);
    path_numbers(path, PAIR_CHOICE, choice);
    lmb_light_sample sample;
    if (!lmb_emitters_sample_triangle(transport->emitters, receiver->position, choice[0], point, &sample) ||
        !receiver_sees(receiver, sample.direction)) {
        return;
    }
    const lmb_vec3 origin = receiver_ray_origin(receiver, sample.direction);
    const lmb_rgb share = lmb_trace_transmittance(transport->tracer, origin, sample.end, path->rays);
    const float mis = balance(sample.density, receiver_density(receiver, sample.direction));
    const float factor = receiver_response(receiver, sample.direction) * mis / sample.density;
    direct_add(direct, sample.direction, rgb_scale(rgb_mul(sample.radiance, share), factor));
}

static void direct_add_environment(const lmb_path *path, const lmb_receiver *receiver, lmb_direct_light *direct)
{
    const lmb_transport *transport = path->transport;
    float point[2];
    path_numbers(path, PAIR_ENVIRONMENT, point);
    lmb_light_sample sample;
    if (!lmb_emitters_sample_environment(transport->emitters, point, &sample) ||
        !receiver_sees(receiver, sample.direction)) {
        return;
    }
    const lmb_vec3 origin = receiver_ray_origin(receiver, sample.direction);
    const lmb_rgb share = lmb_trace_transmittance_to_infinity(transport->tracer, origin, sample.direction, path->rays);
    const float mis = balance(sample.density, receiver_density(receiver, sample.direction));
    const float factor = receiver_response(receiver, sample.direction) * mis / sample.density;
    direct_add(direct, sample.direction, rgb_scale(rgb_mul(sample.radiance, share), factor));
}

static void direct_add_punctual(const lmb_path *path, const lmb_receiver *receiver, bool at_infinity,
                                lmb_direct_light *direct)
{
    const lmb_transport *transport = path->transport;
    float choice[2];
    path_numbers(path, PAIR_CHOICE, choice);
    lmb_punctual_sample sample;
    const lmb_punctual_query query = {.position = receiver->position,
                                      .at_infinity = at_infinity,
                                      .normal = receiver->kind == RECEIVE_SPHERE ? NULL : &receiver->normal,
                                      .min_distance = receiver->min_light_distance,
                                      .skip_indirect_only = receiver->kind != RECEIVE_DIFFUSE};
    if (!lmb_emitters_sample_punctual(transport->emitters, &query, choice[1], &sample) ||
        !receiver_sees(receiver, sample.direction)) {
        return;
    }
    const lmb_vec3 origin = receiver_ray_origin(receiver, sample.direction);
    const lmb_rgb share =
        sample.at_infinity
            ? lmb_trace_transmittance_to_infinity(transport->tracer, origin, sample.direction, path->rays)
            : lmb_trace_transmittance(transport->tracer, origin, sample.end, path->rays);
    direct_add(direct, sample.direction,
               rgb_scale(rgb_mul(sample.irradiance, share), receiver_response(receiver, sample.direction)));
}

/* Next-event estimation of everything that can be aimed at. */
static void direct_collect(const lmb_path *path, const lmb_receiver *receiver, lmb_direct_light *direct)
{
    direct->count = 0;
    if (lmb_emitters_triangle_count(path->transport->emitters) > 0) {
        direct_add_triangle(path, receiver, direct);
    }
    if (lmb_emitters_environment_sampled(path->transport->emitters)) {
        direct_add_environment(path, receiver, direct);
    }
    if (lmb_tracer_scene(path->transport->tracer)->light_count > 0) {
        direct_add_punctual(path, receiver, false, direct);
        direct_add_punctual(path, receiver, true, direct);
    }
}

/* A ray that leaves a receiver, or a camera (from == NULL). */
typedef struct lmb_leg {
    const lmb_receiver *from;
    lmb_vec3 origin;
    lmb_vec3 direction;
    lmb_rgb throughput;
} lmb_leg;

/* What a leg ends on. */
typedef struct lmb_landing {
    bool hit;        /* false: the environment */
    lmb_receiver at; /* where the path goes on, when hit */
    lmb_rgb albedo;
    lmb_rgb emitted; /* radiance of the surface or the environment, weighted against next-event estimation */
} lmb_landing;

static float environment_mis(const lmb_transport *transport, const lmb_leg *leg)
{
    if (!leg->from || !lmb_emitters_environment_sampled(transport->emitters)) {
        return 1.0f;
    }
    return balance(receiver_density(leg->from, leg->direction),
                   lmb_emitters_environment_density(transport->emitters, leg->direction));
}

static float emission_mis(const lmb_transport *transport, const lmb_leg *leg, const lmb_hit *hit,
                          const lmb_place *place)
{
    if (!leg->from) {
        return 1.0f;
    }
    const float distance = vec3_length(vec3_sub(place->position, leg->from->position));
    const float density =
        lmb_emitters_triangle_density(transport->emitters, hit, leg->direction, distance, place->geometric_normal);
    return balance(receiver_density(leg->from, leg->direction), density);
}

/* Follows a leg through see-through surfaces, passing each by chance, to what it ends on. Its throughput takes up the
 * tint of what it passed. */
static lmb_landing leg_follow(const lmb_path *path, lmb_leg *leg)
{
    const lmb_transport *transport = path->transport;
    float start = 0.0f;
    for (uint32_t layer = 0;; ++layer) {
        ++*path->rays;
        lmb_hit hit;
        if (!lmb_trace_nearest(transport->tracer, leg->origin, leg->direction, start, FLT_MAX, &hit)) {
            const lmb_rgb sky = lmb_emitters_environment_radiance(transport->emitters, leg->direction);
            return (lmb_landing){.emitted = rgb_scale(sky, environment_mis(transport, leg))};
        }
        const lmb_surface surface = lmb_trace_surface(transport->tracer, hit.instance, hit.triangle, hit.u, hit.v);
        const float pass = rgb_max(surface.pass);
        if (pass > 0.0f) {
            const float probability = pass / (pass + surface.opacity);
            if (lmb_random(path->stream, path->sample, path->vertex, layer) < probability) {
                leg->throughput = rgb_mul(leg->throughput, rgb_scale(surface.pass, 1.0f / probability));
                start = nextafterf(hit.distance * (1.0f + 4.0f * FLT_EPSILON), FLT_MAX);
                continue;
            }
            leg->throughput = rgb_scale(leg->throughput, surface.opacity / (1.0f - probability));
        }
        lmb_place place = lmb_trace_place(transport->tracer, hit.instance, hit.triangle, hit.u, hit.v);
        const float mis = rgb_max(surface.emission) > 0.0f ? emission_mis(transport, leg, &hit, &place) : 0.0f;
        if (vec3_dot(place.geometric_normal, leg->direction) > 0.0f) {
            place.geometric_normal = vec3_scale(place.geometric_normal, -1.0f);
            place.shading_normal = vec3_scale(place.shading_normal, -1.0f);
        }
        return (lmb_landing){
            .hit = true,
            .at = {place.position, place.geometric_normal, place.shading_normal, place.rounding, 0.0f, RECEIVE_DIFFUSE},
            .albedo = surface.albedo,
            .emitted = rgb_scale(surface.emission, mis)};
    }
}

/* Radiance along a leg: what it ends on emits, and what that reflects. */
static lmb_rgb leg_radiance(lmb_path *path, lmb_leg first)
{
    const lmb_transport *transport = path->transport;
    lmb_rgb radiance = {{0.0f, 0.0f, 0.0f}};
    lmb_landing landings[2]; /* the one at hand, and the one before, which `leg.from` points to */
    lmb_leg leg = first;
    for (int turn = 0;; turn ^= 1) {
        lmb_landing *here = &landings[turn];
        *here = leg_follow(path, &leg);
        radiance = rgb_add(radiance, rgb_mul(leg.throughput, here->emitted));
        if (!here->hit || !(rgb_max(here->albedo) > 0.0f) ||
            (transport->bounces >= 0 && path->vertex >= (uint32_t)transport->bounces)) {
            return radiance;
        }
        leg.throughput = rgb_mul(leg.throughput, here->albedo);
        ++path->vertex;
        float numbers[2];
        if (path->vertex > ROULETTE_AFTER) {
            const float survival = fminf(rgb_max(here->albedo), ROULETTE_MAX_SURVIVAL);
            path_numbers(path, PAIR_ROULETTE, numbers);
            if (numbers[0] >= survival) {
                return radiance;
            }
            leg.throughput = rgb_scale(leg.throughput, 1.0f / survival);
        }
        lmb_direct_light direct;
        direct_collect(path, &here->at, &direct);
        for (int i = 0; i < direct.count; ++i) {
            radiance = rgb_add(radiance, rgb_mul(leg.throughput, direct.weight[i]));
        }
        path_numbers(path, PAIR_DIRECTION, numbers);
        leg.direction = receiver_direction(&here->at, numbers);
        if (!receiver_sees(&here->at, leg.direction)) {
            return radiance;
        }
        /* Cosine sampling cancels the cosine: the throughput stays. */
        leg.from = &here->at;
        leg.origin = receiver_ray_origin(&here->at, leg.direction);
    }
}

static bool weight_is_finite(lmb_rgb weight)
{
    return isfinite(weight.c[0]) && isfinite(weight.c[1]) && isfinite(weight.c[2]);
}

static void contribution_give(lmb_gather_sink sink, void *context, lmb_vec3 direction, lmb_rgb weight)
{
    if (weight_is_finite(weight) && rgb_max(weight) > 0.0f) {
        sink(context, direction, weight);
    }
}

void lmb_gather(const lmb_transport *transport, const lmb_gather_point *point, uint64_t stream, uint32_t first,
                uint32_t count, lmb_gather_sink sink, void *context, uint64_t *rays)
{
    const lmb_receiver receiver = {point->position,
                                   point->normal,
                                   point->normal,
                                   0.0f,
                                   point->min_light_distance,
                                   point->hemisphere ? RECEIVE_HEMISPHERE : RECEIVE_SPHERE};
    for (uint32_t i = 0; i < count; ++i) {
        lmb_path path = {transport, stream, first + i, 0, rays};
        lmb_direct_light direct;
        direct_collect(&path, &receiver, &direct);
        for (int k = 0; k < direct.count; ++k) {
            contribution_give(sink, context, direct.direction[k], direct.weight[k]);
        }
        float numbers[2];
        path_numbers(&path, PAIR_DIRECTION, numbers);
        const lmb_vec3 direction = receiver_direction(&receiver, numbers);
        const float density = receiver_density(&receiver, direction);
        if (!(density > 0.0f)) {
            continue;
        }
        const lmb_vec3 origin = receiver_ray_origin(&receiver, direction);
        const lmb_leg leg = {&receiver, origin, direction, {{1.0f, 1.0f, 1.0f}}};
        contribution_give(sink, context, direction, rgb_scale(leg_radiance(&path, leg), 1.0f / density));
    }
}

lmb_rgb lmb_radiance(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                     uint32_t sample, uint64_t *rays)
{
    lmb_path path = {transport, stream, sample, 0, rays};
    const lmb_leg leg = {NULL, origin, direction, {{1.0f, 1.0f, 1.0f}}};
    const lmb_rgb radiance = leg_radiance(&path, leg);
    return weight_is_finite(radiance) ? radiance : (lmb_rgb){{0.0f, 0.0f, 0.0f}};
}
