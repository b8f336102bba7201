#include "trace/trace_layers.h"

#include <float.h>
#include <string.h>

#include <lambent/material.h>
#include <lambent/vector.h>

static bool layer_is_before(const lmb_layer *a, const lmb_layer *b)
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

void lmb_layer_add(lmb_layers *passed, const lmb_layer *added)
{
    if (share_is_all(added->share)) {
        return;
    }
    uint32_t at = passed->count;
    while (at > 0 && layer_is_before(added, &passed->layer[at - 1])) {
        --at;
    }
    passed->more |= passed->count == LMB_LAYERS;
    if (at == LMB_LAYERS) {
        return;
    }
    passed->count += passed->count < LMB_LAYERS;
    memmove(&passed->layer[at + 1], &passed->layer[at], (passed->count - at - 1) * sizeof passed->layer[0]);
    passed->layer[at] = *added;
}

lmb_rgb lmb_layers_share(const lmb_layers *passed, float end)
{
    lmb_rgb share = {{1.0f, 1.0f, 1.0f}};
    float start = 0.0f;
    for (uint32_t i = 0; i < passed->count && passed->layer[i].distance < end; ++i) {
        if (passed->layer[i].distance >= start) {
            share = lmb_rgb_mul(share, passed->layer[i].share);
            start = lmb_trace_beyond(passed->layer[i].distance);
        }
    }
    return share;
}

float lmb_layers_left_from(const lmb_layers *passed, float end)
{
    const float last = passed->more ? passed->layer[LMB_LAYERS - 1].distance : FLT_MAX;
    return last < end ? lmb_trace_beyond(last) : 0.0f;
}

/* A word, at an offset of Embree's structure of `count` rays or hits. */
static float shown_float(const void *structure, unsigned count, unsigned offset, unsigned i)
{
    return ((const float *)structure)[offset * count + i];
}

static uint32_t shown_index(const void *structure, unsigned count, unsigned offset, unsigned i)
{
    return ((const uint32_t *)structure)[offset * count + i];
}

/* Offsets in rays (RTCRay) and hits (RTCHit). */
enum { RAY_FAR = 8, RAY_ID = 10, HIT_U = 3, HIT_V = 4, HIT_TRIANGLE = 5, HIT_GEOMETRY = 6, HIT_INSTANCE = 7 };

bool lmb_layer_shown(const struct RTCFilterFunctionNArguments *arguments, unsigned i, lmb_shown_hit *shown)
{
    const lmb_tracer *tracer = ((const lmb_layer_walk *)arguments->context)->tracer;
    const unsigned count = arguments->N;
    const uint32_t instance = shown_index(arguments->hit, count, HIT_INSTANCE, i);
    shown->instance =
        instance != RTC_INVALID_GEOMETRY_ID ? instance : shown_index(arguments->hit, count, HIT_GEOMETRY, i);
    if (!tracer->has_layers[shown->instance]) {
        return false;
    }
    shown->triangle = shown_index(arguments->hit, count, HIT_TRIANGLE, i);
    const lmb_mesh *mesh = &tracer->scene->meshes[tracer->scene->instances[shown->instance].mesh];
    const uint32_t material = mesh->material[shown->triangle];
    if (!tracer->is_see_through[material]) {
        return false;
    }
    if (mesh->color || tracer->scene->materials[material].base_color_texture.image >= 0) {
        const float u = shown_float(arguments->hit, count, HIT_U, i), v = shown_float(arguments->hit, count, HIT_V, i);
        shown->coverage = lmb_material_coverage(&(lmb_mesh_point){tracer->scene, mesh, shown->triangle, u, v});
    } else {
        shown->coverage = tracer->coverage[material];
    }
    shown->lane = shown_index(arguments->ray, count, RAY_ID, i);
    shown->distance = shown_float(arguments->ray, count, RAY_FAR, i);
    return lmb_rgb_max(shown->coverage.pass) > 0.0f;
}

void lmb_layer_walk_start(lmb_layer_walk *walk, const lmb_tracer *tracer, RTCFilterFunctionN filter,
                          const uint64_t *chance, lmb_layers *passed, int lanes)
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
