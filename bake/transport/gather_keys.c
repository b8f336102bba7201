/* What is seen of key lights: shadow rays to points of their discs. A light of no extent takes one from each of the
 * element's points. Of others LOOK tell whether the element is all in the light or all in the shadow, and only where it
 * is neither, MOST. */
#include <lambent/gather.h>

#include <assert.h>
#include <string.h>

#include <lambent/key_lights.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "light/soft_light.h"
#include "transport/direct.h"

enum { LOOK = LMB_RAY_BATCH, MOST = 4 * LOOK };

/* Apart from the streams that samples take at the same position. */
#define STREAM_KEYS UINT64_C(0x6b65796c69676874)

/* Each round through the points gives every one of them another part of the sequence. */
enum { ROUND_STEP = 17 };

/* One light of one element on its way. */
typedef struct key_work {
    const lmb_transport *transport;
    const lmb_gather_point *points;
    uint32_t point_count;
    lmb_key_light light;
    float extent; /* sine of half its angle; 0: none */
    uint64_t stream;
    uint64_t *rays_traced;
    double seen; /* summed over `asked` rays */
    uint32_t asked;
} key_work;

static lmb_receiver key_receiver(const lmb_gather_point *point)
{
    return (lmb_receiver){.position = point->position,
                          .geometric_normal = point->normal,
                          .normal = point->normal,
                          .kind = point->hemisphere ? LMB_LOBE_HEMISPHERE : LMB_LOBE_SPHERE};
}

static void rays_aim(const key_work *work, uint32_t count, lmb_ray_batch *rays)
{
    float x[LOOK] = {0.0f}, y[LOOK] = {0.0f};
    if (work->extent > 0.0f) {
        const lmb_sample_range range = {work->stream, work->asked, count};
        lmb_sample_variates(work->transport, range, lmb_light_pair(0), x, y);
    }
    rays->count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t sample = work->asked + i;
        const uint32_t point = (sample + sample / work->point_count * ROUND_STEP) % work->point_count;
        const lmb_receiver receiver = key_receiver(&work->points[point]);
        const float u[2] = {x[i], y[i]};
        const lmb_vec3 towards = work->extent > 0.0f ? lmb_sun_point(work->light.direction, work->extent, u).direction
                                                     : work->light.direction;
        if (lmb_receiver_sees(&receiver, towards)) {
            lmb_ray_batch_add(rays, lmb_receiver_ray_origin(&receiver, towards), towards, FLT_MAX);
        }
    }
}

/* Asks up to LOOK more. */
static void rays_ask(key_work *work, uint32_t count)
{
    lmb_ray_batch rays;
    lmb_rgb share[LMB_RAY_BATCH];
    rays_aim(work, count, &rays);
    lmb_trace_transmittance_batch(work->transport->tracer, &rays, share, work->rays_traced);
    const float whole = lmb_luminance(work->light.irradiance);
    for (uint32_t i = 0; i < rays.count; ++i) {
        work->seen += (double)(lmb_luminance(lmb_rgb_mul(work->light.irradiance, share[i])) / whole);
    }
    work->asked += count;
}

static float key_visibility(key_work *work)
{
    const uint32_t points = work->point_count;
    const uint32_t look = work->extent > 0.0f ? LOOK : points;
    for (uint32_t left = look; left > 0; left = look - work->asked) {
        rays_ask(work, left < LOOK ? left : LOOK);
    }
    while (work->extent > 0.0f && work->seen > 0.0 && work->seen < work->asked && work->asked < MOST) {
        rays_ask(work, LOOK);
    }
    return lmb_saturate((float)(work->seen / work->asked));
}

void lmb_gather_keys(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                     float visibility[LMB_KEY_LIGHTS_MOST], uint64_t *rays)
{
    const lmb_scene *scene = lmb_tracer_scene(transport->tracer);
    const uint64_t stream = lmb_stream_of_position(transport->seed ^ STREAM_KEYS, points[0].position);
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    memset(visibility, 0, LMB_KEY_LIGHTS_MOST * sizeof *visibility);
    for (uint32_t i = 0; i < lmb_scene_key_lights(scene, light); ++i) {
        key_work work = {.transport = transport,
                         .points = points,
                         .point_count = point_count,
                         .light = light[i],
                         .extent = lmb_light_extent(&scene->lights[scene->key_light[i]]),
                         .stream = lmb_mix(stream, i),
                         .rays_traced = rays};
        visibility[i] = key_visibility(&work);
    }
}
