#include <lambent/transport.h>

#include <lambent/surface_light.h>

#include "bake_internal.h"
#include "leg.h"

/* Roulette starts after this many reflections: short paths carry most of the light. Survival is the albedo itself (a
 * lower one would let weights grow without bound), kept just below 1 so that a white room ends. */
#define ROULETTE_AFTER 2
#define ROULETTE_MAX_SURVIVAL 0.999f

/* Whether what a landing reflects is to be looked up, and that. A camera sees each cell's edges, so its own landing is
 * traced; so is one that is nearer than a cell is wide, where a cell's mean is no measure of what one point of it
 * sends, unless counting the reflections forbids to put one more before what is stored. */
static bool landing_look_up(const lmb_transport *transport, const lmb_leg *leg, const lmb_landing *landing,
                            lmb_rgb *irradiance)
{
    const lmb_surface_light *light = transport->surface;
    if (!light || !leg->from ||
        (transport->bounces < 0 && landing->hit.distance < lmb_surface_light_cell_size_at(light, &landing->hit))) {
        return false;
    }
    *irradiance = lmb_surface_light_at(light, &landing->hit, landing->front);
    return true;
}

/* Radiance along a leg: what it ends on emits, and what that reflects. */
static lmb_rgb leg_radiance(lmb_path *path, lmb_leg first)
{
    const lmb_transport *transport = path->transport;
    lmb_rgb radiance = {{0.0f, 0.0f, 0.0f}};
    lmb_receiver receivers[2]; /* the one at hand, and the one before, which `leg.from` points to */
    lmb_leg leg = first;
    for (int turn = 0;; turn ^= 1) {
        const lmb_landing landing = lmb_leg_follow(path, &leg);
        radiance = rgb_add(radiance, rgb_mul(leg.throughput, landing.emitted));
        if (!landing.on_surface || !(rgb_max(landing.albedo) > 0.0f) ||
            (transport->bounces >= 0 && path->vertex >= (uint32_t)transport->bounces)) {
            return radiance;
        }
        leg.throughput = rgb_mul(leg.throughput, landing.albedo);
        lmb_rgb irradiance;
        if (landing_look_up(transport, &leg, &landing, &irradiance)) {
            return rgb_add(radiance, rgb_mul(leg.throughput, irradiance));
        }
        ++path->vertex;
        float numbers[2];
        if (path->vertex > ROULETTE_AFTER) {
            const float survival = fminf(rgb_max(landing.albedo), ROULETTE_MAX_SURVIVAL);
            lmb_path_numbers(path, PAIR_ROULETTE, numbers);
            if (numbers[0] >= survival) {
                return radiance;
            }
            leg.throughput = rgb_scale(leg.throughput, 1.0f / survival);
        }
        lmb_receiver *here = &receivers[turn];
        *here = lmb_landing_receiver(path, &landing);
        lmb_direct_light direct;
        lmb_direct_collect(path, here, &direct);
        for (int i = 0; i < direct.count; ++i) {
            radiance = rgb_add(radiance, rgb_mul(leg.throughput, direct.weight[i]));
        }
        lmb_path_numbers(path, PAIR_DIRECTION, numbers);
        leg.direction = lmb_receiver_direction(here, numbers);
        if (!lmb_receiver_sees(here, leg.direction)) {
            return radiance;
        }
        /* Cosine sampling cancels the cosine: the throughput stays. */
        leg.from = here;
        leg.origin = lmb_receiver_ray_origin(here, leg.direction);
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
    const lmb_receiver receiver = {.position = point->position,
                                   .geometric_normal = point->normal,
                                   .normal = point->normal,
                                   .min_light_distance = point->min_light_distance,
                                   .kind = point->hemisphere ? RECEIVE_HEMISPHERE : RECEIVE_SPHERE};
    for (uint32_t i = 0; i < count; ++i) {
        lmb_path path = {transport, stream, first + i, 0, rays};
        lmb_direct_light direct;
        lmb_direct_collect(&path, &receiver, &direct);
        for (int k = 0; k < direct.count; ++k) {
            contribution_give(sink, context, direct.direction[k], direct.weight[k]);
        }
        float numbers[2];
        lmb_path_numbers(&path, PAIR_DIRECTION, numbers);
        const lmb_vec3 direction = lmb_receiver_direction(&receiver, numbers);
        const float density = lmb_receiver_density(&receiver, direction);
        if (!(density > 0.0f)) {
            continue;
        }
        const lmb_vec3 origin = lmb_receiver_ray_origin(&receiver, direction);
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
