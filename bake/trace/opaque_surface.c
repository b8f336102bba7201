#include <lambent/opaque_surface.h>

#include <math.h>
#include <stdlib.h>

#include <lambent/sequence.h>
#include <lambent/surface.h>

#include "base/interval.h"

/* Dimension pairs of a point's sequence. */
enum { PAIR_TRIANGLE, PAIR_POINT };

#define ALL_STATIC UINT32_MAX

static bool triangle_is_opaque(const lmb_scene *scene, const lmb_mesh *mesh, uint32_t triangle)
{
    const lmb_material *material = &scene->materials[mesh->material[triangle]];
    return lmb_material_is_opaque(material);
}

static double triangle_area(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
{
    const double area = (double)lmb_trace_triangle_area(tracer, instance, triangle);
    return isfinite(area) ? area : 0.0;
}

/* Of one instance, or, where that is none, of all static ones. */
static lmb_result surface_create(const lmb_tracer *tracer, uint32_t only, lmb_opaque_surface *surface)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    lmb_opaque_surface created = {.tracer = tracer};
    created.first = calloc((size_t)scene->instance_count + 1, sizeof *created.first);
    if (!created.first) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *instance = &scene->instances[i];
        created.first[i + 1] = created.first[i];
        if (only == ALL_STATIC ? !instance->dynamic : i == only) {
            created.first[i + 1] += scene->meshes[instance->mesh].triangle_count;
        }
    }
    created.entry_count = created.first[scene->instance_count];
    if (created.entry_count >= SIZE_MAX / sizeof *created.area_before) {
        lmb_opaque_surface_free(&created);
        return LMB_ERROR_MEMORY;
    }
    created.area_before = malloc(((size_t)created.entry_count + 1) * sizeof *created.area_before);
    if (!created.area_before) {
        lmb_opaque_surface_free(&created);
        return LMB_ERROR_MEMORY;
    }
    double area = 0.0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_mesh *mesh = &scene->meshes[scene->instances[i].mesh];
        const uint64_t count = created.first[i + 1] - created.first[i];
        for (uint32_t t = 0; t < count; ++t) {
            created.area_before[created.first[i] + t] = area;
            area += triangle_is_opaque(scene, mesh, t) ? triangle_area(tracer, i, t) : 0.0;
        }
    }
    created.area_before[created.entry_count] = area;
    *surface = created;
    return LMB_OK;
}

lmb_result lmb_opaque_surface_create(const lmb_tracer *tracer, lmb_opaque_surface *surface)
{
    return surface_create(tracer, ALL_STATIC, surface);
}

lmb_result lmb_opaque_surface_create_of(const lmb_tracer *tracer, uint32_t instance, lmb_opaque_surface *surface)
{
    return surface_create(tracer, instance, surface);
}

void lmb_opaque_surface_free(lmb_opaque_surface *surface)
{
    free(surface->first);
    free(surface->area_before);
    *surface = (lmb_opaque_surface){0};
}

double lmb_opaque_surface_area(const lmb_opaque_surface *surface)
{
    return surface->area_before[surface->entry_count];
}

static uint32_t instance_of_entry(const lmb_opaque_surface *surface, uint64_t entry)
{
    uint32_t low = 0, high = lmb_tracer_scene(surface->tracer)->instance_count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (surface->first[middle] <= entry) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

lmb_hit lmb_opaque_surface_point(const lmb_opaque_surface *surface, uint64_t seed, uint32_t index, uint32_t count)
{
    const uint64_t stream = lmb_mix(seed, index);
    float choice[2], u[2];
    lmb_sequence_2d(stream, 0, PAIR_TRIANGLE, choice);
    lmb_sequence_2d(stream, 0, PAIR_POINT, u);
    const double area = lmb_opaque_surface_area(surface);
    double target = ((double)index + (double)choice[0]) / (double)count * area;
    if (target >= area) {
        target = nextafter(area, 0.0);
    }
    const uint64_t entry = lmb_interval_find(surface->area_before, surface->entry_count, target);
    lmb_hit point;
    point.instance = instance_of_entry(surface, entry);
    point.triangle = (uint32_t)(entry - surface->first[point.instance]);
    lmb_triangle_point(u, &point.u, &point.v);
    return point;
}
