/* Rays that pass layers by chance. */
#include <float.h>

#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "trace/trace_layers.h"

/* A uniform variate in [0, 1) of the ray and the triangle. */
static float chance_variate(uint64_t chance, const lmb_shown_hit *shown)
{
    const uint64_t triangle = ((uint64_t)shown->instance << 32) | shown->triangle;
    return lmb_unit_float((uint32_t)(lmb_mix(chance, triangle) >> 32));
}

/* Sends rays on through layers by chance: in proportion to the light of the channel that passes best, so that no
 * channel of what is left grows. */
static void chance_filter(const struct RTCFilterFunctionNArguments *arguments)
{
    const lmb_layer_walk *walk = (const lmb_layer_walk *)arguments->context;
    for (unsigned i = 0; i < arguments->N; ++i) {
        lmb_shown_hit shown;
        if (!arguments->valid[i] || !lmb_layer_shown(arguments, i, &shown)) {
            continue;
        }
        const float pass = lmb_rgb_max(shown.coverage.pass);
        const float all = pass + shown.coverage.opacity;
        if (chance_variate(walk->chance[shown.lane], &shown) * all < pass) {
            const lmb_layer found = {shown.distance, shown.instance, shown.triangle,
                                     lmb_rgb_scale(lmb_rgb_scale(shown.coverage.pass, 1.0f / pass), all)};
            lmb_layer_add(&walk->passed[shown.lane], &found);
            arguments->valid[i] = 0;
        }
    }
}

/* The rest of a ray from its near distance on. `*share` takes up what layers leave from there. */
static bool chance_follow(const lmb_tracer *tracer, struct RTCRay from, uint64_t chance, lmb_hit *hit, lmb_rgb *share,
                          uint64_t *rays)
{
    for (;;) {
        lmb_layer_walk walk;
        lmb_layers passed;
        struct RTCRayHit ray = {
            .ray = from,
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
        };
        lmb_layer_walk_start(&walk, tracer, chance_filter, &chance, &passed, 1);
        ++*rays;
        ray_note(tracer, LMB_RAY_NEAREST, &ray.ray);
        rtcIntersect1(tracer->world, &walk.embree, &ray);
        const bool found = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        const float end = found ? ray.ray.tfar : FLT_MAX;
        *share = lmb_rgb_mul(*share, lmb_layers_share(&passed, end));
        from.tnear = lmb_layers_left_from(&passed, end);
        if (!(from.tnear > 0.0f && from.tnear < end)) {
            hit_set_or_nothing(tracer, &ray, hit);
            return found;
        }
    }
}

bool lmb_trace_through(const lmb_tracer *tracer, const lmb_ray *ray, uint64_t chance, lmb_hit *hit, lmb_rgb *share,
                       uint64_t *rays)
{
    if (tracer->any_see_through) {
        return chance_follow(tracer, ray_make(ray->origin, ray->direction, 0.0f, FLT_MAX), chance, hit, share, rays);
    }
    ++*rays;
    return lmb_trace_nearest(tracer, ray->origin, ray->direction, 0.0f, FLT_MAX, hit);
}

/* What lmb_trace_through_batch is given, and gives. */
typedef struct through_batch {
    const lmb_tracer *tracer;
    const lmb_ray_batch *rays;
    const uint64_t *chance;
    lmb_hit *hit;
    lmb_rgb *share;
    uint64_t *rays_traced;
} through_batch;

static void packet_through(const through_batch *batch, uint32_t first)
{
    lmb_layer_walk walk;
    lmb_layers passed[PACKET]; /* large: only what is used is set */
    struct RTCRayHit8 packet;
    lmb_layer_walk_start(&walk, batch->tracer, chance_filter, batch->chance + first, passed, PACKET);
    packet_intersect(batch->tracer, &walk.embree, batch->rays, first, &packet);
    for (uint32_t lane = 0; lane < PACKET; ++lane) {
        const uint32_t i = first + lane;
        const struct RTCRayHit ray = packet_lane(&packet, (int)lane);
        const float end = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID ? ray.ray.tfar : FLT_MAX;
        batch->share[i] = lmb_layers_share(&passed[lane], end);
        hit_set_or_nothing(batch->tracer, &ray, &batch->hit[i]);
        const float start = lmb_layers_left_from(&passed[lane], end);
        if (start > 0.0f && start < end) {
            struct RTCRay rest = ray_of_batch(batch->rays, i);
            rest.tnear = start;
            chance_follow(batch->tracer, rest, batch->chance[i], &batch->hit[i], &batch->share[i], batch->rays_traced);
        }
    }
}

void lmb_trace_through_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, const uint64_t chance[LMB_RAY_BATCH],
                             lmb_hit hit[LMB_RAY_BATCH], lmb_rgb share[LMB_RAY_BATCH], uint64_t *rays_traced)
{
    if (!tracer->any_see_through) {
        lmb_trace_nearest_batch(tracer, rays, hit);
        *rays_traced += rays->count;
        return;
    }
    const through_batch batch = {tracer, rays, chance, hit, share, rays_traced};
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_through(&batch, i);
    }
    batch_note(tracer, LMB_RAY_NEAREST, rays, i);
    *rays_traced += i;
    for (; i < rays->count; ++i) {
        share[i] = lmb_rgb_of(1.0f, 1.0f, 1.0f);
        chance_follow(tracer, ray_of_batch(rays, i), chance[i], &hit[i], &share[i], rays_traced);
    }
}
