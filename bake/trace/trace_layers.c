/* Light through see-through surfaces, the layers, in one walk through the BVH.
 *
 * Embree shows a filter every triangle that a ray meets on its way, in the order of its tree. Nothing may depend on
 * that order, so a layer lets pass or stops by a number of the ray and the triangle, and what layers leave of the light
 * is multiplied when the walk is done, nearest first. The BVH is built without spatial splits: none is shown twice. */
#include <float.h>
#include <math.h>

#include <lambent/sequence.h>

#include "base/rgb.h"
#include "base/vec3.h"
#include "trace/trace_embree.h"

/* Layers that are kept on one walk; a ray that meets more takes another from there. Those that leave all of the light,
 * like the holes in a leaf, are not kept. */
enum { LAYERS = 64 };

typedef struct layer {
    float distance;
    uint32_t instance, triangle;
    lmb_rgb share;
} layer;

/* The nearest layers that a ray has passed. */
typedef struct layers {
    layer layer[LAYERS]; /* nearest first; equally near ones by their numbers */
    uint32_t count;
    bool more; /* others lie farther off than the last */
} layers;

/* Up to PACKET rays under way. */
typedef struct layer_walk {
    struct RTCIntersectContext embree; /* first: Embree hands it back */
    const lmb_tracer *tracer;
    const uint64_t *chance; /* [lane] what decides which layers stop a ray; unused for shadow rays */
    layers *passed;         /* [lane] */
} layer_walk;

static bool layer_is_before(const layer *a, const layer *b)
{
    if (a->distance < b->distance || a->distance > b->distance) {
        return a->distance < b->distance;
    }
    return a->instance != b->instance ? a->instance < b->instance : a->triangle < b->triangle;
}

static bool share_is_all(lmb_rgb share)
{
    return share.c[0] >= 1.0f && share.c[1] >= 1.0f && share.c[2] >= 1.0f;
}

static void layer_add(layers *passed, const layer *added)
{
    if (share_is_all(added->share)) {
        return;
    }
    uint32_t at = passed->count;
    while (at > 0 && layer_is_before(added, &passed->layer[at - 1])) {
        --at;
    }
    passed->more |= passed->count == LAYERS;
    if (at == LAYERS) {
        return;
    }
    passed->count += passed->count < LAYERS;
    memmove(&passed->layer[at + 1], &passed->layer[at], (passed->count - at - 1) * sizeof passed->layer[0]);
    passed->layer[at] = *added;
}

/* The nearest distance that is not the same place. It is nudged by a hit's own rounding only: coincident layers count
 * once, which is what coincident faces are, and so does one whose two triangles meet under the ray. */
static float layer_beyond(float distance)
{
    return nextafterf(distance * (1.0f + 4.0f * FLT_EPSILON), FLT_MAX);
}

/* What the layers before `end` leave of the light. */
static lmb_rgb layers_share(const layers *passed, float end)
{
    lmb_rgb share = {{1.0f, 1.0f, 1.0f}};
    float start = 0.0f;
    for (uint32_t i = 0; i < passed->count && passed->layer[i].distance < end; ++i) {
        if (passed->layer[i].distance >= start) {
            share = rgb_mul(share, passed->layer[i].share);
            start = layer_beyond(passed->layer[i].distance);
        }
    }
    return share;
}

/* Where the next walk starts when this one left out layers before `end`; 0 when it did not. */
static float layers_left_from(const layers *passed, float end)
{
    const float last = passed->more ? passed->layer[LAYERS - 1].distance : FLT_MAX;
    return last < end ? layer_beyond(last) : 0.0f;
}

/* A number, at an offset of Embree's structure of `count` rays or hits. */
static float shown_float(const void *structure, unsigned count, unsigned offset, unsigned i)
{
    return ((const float *)structure)[offset * count + i];
}

static uint32_t shown_number(const void *structure, unsigned count, unsigned offset, unsigned i)
{
    return ((const uint32_t *)structure)[offset * count + i];
}

/* Offsets in rays (RTCRay) and hits (RTCHit). */
enum { RAY_FAR = 8, RAY_ID = 10, HIT_U = 3, HIT_V = 4, HIT_TRIANGLE = 5, HIT_GEOMETRY = 6, HIT_INSTANCE = 7 };

/* A see-through surface that a filter is shown. */
typedef struct shown_hit {
    uint32_t lane;
    uint32_t instance, triangle;
    float distance;
    lmb_coverage coverage;
} shown_hit;

/* False where the surface stops all light. */
static bool shown_read(const struct RTCFilterFunctionNArguments *arguments, unsigned i, shown_hit *shown)
{
    const lmb_tracer *tracer = ((const layer_walk *)arguments->context)->tracer;
    const unsigned count = arguments->N;
    const uint32_t instance = shown_number(arguments->hit, count, HIT_INSTANCE, i);
    shown->instance =
        instance != RTC_INVALID_GEOMETRY_ID ? instance : shown_number(arguments->hit, count, HIT_GEOMETRY, i);
    if (!tracer->has_layers[shown->instance]) {
        return false;
    }
    shown->triangle = shown_number(arguments->hit, count, HIT_TRIANGLE, i);
    const lmb_mesh *mesh = &tracer->scene->meshes[tracer->scene->instances[shown->instance].mesh];
    const uint32_t material = mesh->material[shown->triangle];
    if (!tracer->is_see_through[material]) {
        return false;
    }
    if (mesh->color || tracer->scene->materials[material].base_color_texture.image >= 0) {
        const float u = shown_float(arguments->hit, count, HIT_U, i), v = shown_float(arguments->hit, count, HIT_V, i);
        const lmb_surface surface = lmb_trace_surface(
            tracer, &(lmb_hit){.instance = shown->instance, .triangle = shown->triangle, .u = u, .v = v});
        shown->coverage = (lmb_coverage){surface.opacity, surface.pass};
    } else {
        shown->coverage = tracer->coverage[material];
    }
    shown->lane = shown_number(arguments->ray, count, RAY_ID, i);
    shown->distance = shown_float(arguments->ray, count, RAY_FAR, i);
    return rgb_max(shown->coverage.pass) > 0.0f;
}

/* Sends shadow rays on through what leaves some of their light. */
static void shadow_filter(const struct RTCFilterFunctionNArguments *arguments)
{
    const layer_walk *walk = (const layer_walk *)arguments->context;
    for (unsigned i = 0; i < arguments->N; ++i) {
        shown_hit shown;
        if (arguments->valid[i] && shown_read(arguments, i, &shown)) {
            const layer found = {shown.distance, shown.instance, shown.triangle, shown.coverage.pass};
            layer_add(&walk->passed[shown.lane], &found);
            arguments->valid[i] = 0;
        }
    }
}

/* In [0, 1). */
static float chance_number(uint64_t chance, const shown_hit *shown)
{
    const uint64_t place = ((uint64_t)shown->instance << 32) | shown->triangle;
    return (float)(int32_t)(lmb_mix(chance, place) >> 40) * 0x1p-24f;
}

/* Sends rays on through layers by chance: in proportion to the light of the channel that passes best, so that no
 * channel of what is left grows. */
static void chance_filter(const struct RTCFilterFunctionNArguments *arguments)
{
    const layer_walk *walk = (const layer_walk *)arguments->context;
    for (unsigned i = 0; i < arguments->N; ++i) {
        shown_hit shown;
        if (!arguments->valid[i] || !shown_read(arguments, i, &shown)) {
            continue;
        }
        const float pass = rgb_max(shown.coverage.pass);
        const float all = pass + shown.coverage.opacity;
        if (chance_number(walk->chance[shown.lane], &shown) * all < pass) {
            const layer found = {shown.distance, shown.instance, shown.triangle,
                                 rgb_scale(rgb_scale(shown.coverage.pass, 1.0f / pass), all)};
            layer_add(&walk->passed[shown.lane], &found);
            arguments->valid[i] = 0;
        }
    }
}

static void walk_start(layer_walk *walk, const lmb_tracer *tracer, RTCFilterFunctionN filter, const uint64_t *chance,
                       layers *passed, int lanes)
{
    rtcInitIntersectContext(&walk->embree);
    walk->embree.filter = filter;
    walk->tracer = tracer;
    walk->chance = chance;
    walk->passed = passed;
    for (int lane = 0; lane < lanes; ++lane) {
        passed[lane].count = 0;
        passed[lane].more = false;
    }
}

/* The rest of a shadow ray from `start` on, which layers up to there have left `share` of. */
static lmb_rgb shadow_follow(const lmb_tracer *tracer, struct RTCRay ray, float start, lmb_rgb share, uint64_t *rays)
{
    const float end = ray.tfar;
    do {
        layer_walk walk;
        layers passed;
        walk_start(&walk, tracer, shadow_filter, NULL, &passed, 1);
        ray.tnear = start;
        ray.tfar = end;
        ++*rays;
        ray_note(tracer, LMB_RAY_OCCLUDED, &ray);
        rtcOccluded1(tracer->world, &walk.embree, &ray);
        if (ray.tfar < 0.0f) {
            return rgb(0.0f, 0.0f, 0.0f);
        }
        share = rgb_mul(share, layers_share(&passed, FLT_MAX));
        start = layers_left_from(&passed, FLT_MAX);
    } while (start > 0.0f && start < end && rgb_max(share) > 0.0f);
    return share;
}

static lmb_rgb share_of_occluded(float far_distance)
{
    const float open = far_distance < 0.0f ? 0.0f : 1.0f;
    return rgb(open, open, open);
}

lmb_rgb lmb_trace_transmittance_along(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float far_distance,
                                      uint64_t *rays)
{
    struct RTCRay ray = ray_make(origin, direction, 0.0f, far_distance);
    if (tracer->any_see_through) {
        return shadow_follow(tracer, ray, 0.0f, rgb(1.0f, 1.0f, 1.0f), rays);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    ++*rays;
    ray_note(tracer, LMB_RAY_OCCLUDED, &ray);
    rtcOccluded1(tracer->world, &context, &ray);
    return share_of_occluded(ray.tfar);
}

lmb_rgb lmb_trace_transmittance(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to, uint64_t *rays)
{
    return lmb_trace_transmittance_along(tracer, from, vec3_sub(to, from), LMB_TRACE_UP_TO_END, rays);
}

static void packet_occluded(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first, lmb_rgb share[PACKET])
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRay8 packet;
    packet_fill(&packet, rays, first);
    rtcOccluded8(packet_all, tracer->world, &context, &packet);
    for (int lane = 0; lane < PACKET; ++lane) {
        share[lane] = share_of_occluded(packet.tfar[lane]);
    }
}

static void opaque_occluded(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_rgb share[LMB_RAY_BATCH])
{
    batch_note(tracer, LMB_RAY_OCCLUDED, rays, rays->count);
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_occluded(tracer, rays, i, &share[i]);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (; i < rays->count; ++i) {
        struct RTCRay ray = ray_of_batch(rays, i);
        rtcOccluded1(tracer->world, &context, &ray);
        share[i] = share_of_occluded(ray.tfar);
    }
}

static void packet_occluded_by_layers(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first,
                                      lmb_rgb share[PACKET], uint64_t *rays_traced)
{
    layer_walk walk;
    layers passed[PACKET]; /* large: only what is used is set */
    struct RTCRay8 packet;
    walk_start(&walk, tracer, shadow_filter, NULL, passed, PACKET);
    packet_fill(&packet, rays, first);
    rtcOccluded8(packet_all, tracer->world, &walk.embree, &packet);
    for (uint32_t lane = 0; lane < PACKET; ++lane) {
        share[lane] = share_of_occluded(packet.tfar[lane]);
        if (packet.tfar[lane] < 0.0f) {
            continue;
        }
        share[lane] = layers_share(&passed[lane], FLT_MAX);
        const float start = layers_left_from(&passed[lane], FLT_MAX);
        const struct RTCRay ray = ray_of_batch(rays, first + lane);
        if (start > 0.0f && start < ray.tfar) {
            share[lane] = shadow_follow(tracer, ray, start, share[lane], rays_traced);
        }
    }
}

void lmb_trace_transmittance_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_rgb share[LMB_RAY_BATCH],
                                   uint64_t *rays_traced)
{
    uint32_t i = 0;
    if (!tracer->any_see_through) {
        opaque_occluded(tracer, rays, share);
        *rays_traced += rays->count;
        return;
    }
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_occluded_by_layers(tracer, rays, i, &share[i], rays_traced);
    }
    batch_note(tracer, LMB_RAY_OCCLUDED, rays, i);
    *rays_traced += i;
    for (; i < rays->count; ++i) {
        share[i] = shadow_follow(tracer, ray_of_batch(rays, i), 0.0f, rgb(1.0f, 1.0f, 1.0f), rays_traced);
    }
}

/* The rest of a ray from `start` on. `*share` takes up what layers leave from there. */
static bool chance_follow(const lmb_tracer *tracer, struct RTCRay from, float start, uint64_t chance, lmb_hit *hit,
                          lmb_rgb *share, uint64_t *rays)
{
    for (;;) {
        layer_walk walk;
        layers passed;
        struct RTCRayHit ray = {
            .ray = from,
            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}},
        };
        ray.ray.tnear = start;
        walk_start(&walk, tracer, chance_filter, &chance, &passed, 1);
        ++*rays;
        ray_note(tracer, LMB_RAY_NEAREST, &ray.ray);
        rtcIntersect1(tracer->world, &walk.embree, &ray);
        const bool found = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        const float end = found ? ray.ray.tfar : FLT_MAX;
        *share = rgb_mul(*share, layers_share(&passed, end));
        start = layers_left_from(&passed, end);
        if (!(start > 0.0f && start < end)) {
            hit_set_or_nothing(tracer, &ray, hit);
            return found;
        }
    }
}

bool lmb_trace_through(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, uint64_t chance, lmb_hit *hit,
                       lmb_rgb *share, uint64_t *rays)
{
    if (tracer->any_see_through) {
        return chance_follow(tracer, ray_make(origin, direction, 0.0f, FLT_MAX), 0.0f, chance, hit, share, rays);
    }
    ++*rays;
    return lmb_trace_nearest(tracer, origin, direction, 0.0f, FLT_MAX, hit);
}

static void packet_through(const lmb_tracer *tracer, const lmb_ray_batch *rays, uint32_t first, const uint64_t *chance,
                           lmb_hit hit[PACKET], lmb_rgb share[PACKET], uint64_t *rays_traced)
{
    layer_walk walk;
    layers passed[PACKET]; /* large: only what is used is set */
    struct RTCRayHit8 packet;
    walk_start(&walk, tracer, chance_filter, chance, passed, PACKET);
    packet_intersect(tracer, &walk.embree, rays, first, &packet);
    for (uint32_t lane = 0; lane < PACKET; ++lane) {
        const struct RTCRayHit ray = packet_lane(&packet, (int)lane);
        const float end = ray.hit.geomID != RTC_INVALID_GEOMETRY_ID ? ray.ray.tfar : FLT_MAX;
        share[lane] = layers_share(&passed[lane], end);
        hit_set_or_nothing(tracer, &ray, &hit[lane]);
        const float start = layers_left_from(&passed[lane], end);
        if (start > 0.0f && start < end) {
            chance_follow(tracer, ray_of_batch(rays, first + lane), start, chance[lane], &hit[lane], &share[lane],
                          rays_traced);
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
    uint32_t i = 0;
    for (; i + PACKET <= rays->count; i += PACKET) {
        packet_through(tracer, rays, i, &chance[i], &hit[i], &share[i], rays_traced);
    }
    batch_note(tracer, LMB_RAY_NEAREST, rays, i);
    *rays_traced += i;
    for (; i < rays->count; ++i) {
        share[i] = rgb(1.0f, 1.0f, 1.0f);
        chance_follow(tracer, ray_of_batch(rays, i), 0.0f, chance[i], &hit[i], &share[i], rays_traced);
    }
}
