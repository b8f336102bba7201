#include "check_points.h"

#include <stdlib.h>

#include <lambent/placement.h>
#include <lambent/sequence.h>
#include <lambent/surface.h>

#include "vector_math.h"

/* Dimension pairs of a point's sequence. */
enum { PAIR_TRIANGLE, PAIR_PLACE, PAIR_FREE, PAIR_FREE_HEIGHT };

static bool triangle_is_opaque(const lmb_scene *scene, const lmb_mesh *mesh, uint32_t triangle)
{
    const lmb_material *material = &scene->materials[mesh->material[triangle]];
    return lmb_material_is_opaque(material);
}

static double triangle_area(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
{
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, instance, triangle, corner);
    const double area =
        0.5 * (double)vector_length(vector_cross(vector_sub(corner[1], corner[0]), vector_sub(corner[2], corner[0])));
    return isfinite(area) ? area : 0.0;
}

lmb_result opaque_surface_create(const lmb_tracer *tracer, opaque_surface *surface)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    opaque_surface created = {.tracer = tracer};
    created.first = calloc((size_t)scene->instance_count + 1, sizeof *created.first);
    if (!created.first) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_instance *instance = &scene->instances[i];
        created.first[i + 1] = created.first[i];
        if (!instance->dynamic) {
            created.first[i + 1] += scene->meshes[instance->mesh].triangle_count;
        }
    }
    created.entry_count = created.first[scene->instance_count];
    if (created.entry_count >= SIZE_MAX / sizeof *created.area_before) {
        opaque_surface_free(&created);
        return LMB_ERROR_MEMORY;
    }
    created.area_before = malloc(((size_t)created.entry_count + 1) * sizeof *created.area_before);
    if (!created.area_before) {
        opaque_surface_free(&created);
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

void opaque_surface_free(opaque_surface *surface)
{
    free(surface->first);
    free(surface->area_before);
    *surface = (opaque_surface){0};
}

double opaque_surface_area(const opaque_surface *surface)
{
    return surface->area_before[surface->entry_count];
}

/* The entry with area_before[entry] <= target < area_before[entry + 1]. */
static uint64_t entry_at_area(const opaque_surface *surface, double target)
{
    uint64_t low = 0, high = surface->entry_count;
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        if (surface->area_before[middle] <= target) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static uint32_t instance_of_entry(const opaque_surface *surface, uint64_t entry)
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

lmb_hit opaque_surface_point(const opaque_surface *surface, uint64_t seed, uint32_t number, uint32_t count)
{
    const uint64_t stream = lmb_mix(seed, number);
    float choice[2], place[2];
    lmb_sequence_2d(stream, 0, PAIR_TRIANGLE, choice);
    lmb_sequence_2d(stream, 0, PAIR_PLACE, place);
    const double area = opaque_surface_area(surface);
    double target = ((double)number + (double)choice[0]) / (double)count * area;
    if (target >= area) {
        target = nextafter(area, 0.0);
    }
    const uint64_t entry = entry_at_area(surface, target);
    lmb_hit point;
    point.instance = instance_of_entry(surface, entry);
    point.triangle = (uint32_t)(entry - surface->first[point.instance]);
    /* Uniform in the triangle (Osada et al. 2002, "Shape distributions"). */
    const float root = sqrtf(place[0]);
    point.u = root * (1.0f - place[1]);
    point.v = root * place[1];
    return point;
}

/* A direction around `axis` from its squared sine and a turn in [0, 1). */
static lmb_vec3 direction_around(lmb_vec3 axis, float sine_squared, float turn)
{
    lmb_vec3 tangent, bitangent;
    vector_frame(axis, &tangent, &bitangent);
    const float sine = sqrtf(sine_squared);
    const float angle = 2.0f * TOOLS_PI_F * turn;
    const lmb_vec3 up = vector_scale(axis, sqrtf(fmaxf(0.0f, 1.0f - sine_squared)));
    return vector_mad(vector_mad(up, tangent, sine * cosf(angle)), bitangent, sine * sinf(angle));
}

void shading_normals(lmb_vec3 normal, uint64_t stream, int count, lmb_vec3 *normals)
{
    const float max_sine_squared = 0.75f; /* of 60 degrees */
    for (int k = 0; k < count; ++k) {
        float point[2];
        lmb_sequence_2d(stream, (uint32_t)k, 0, point);
        normals[k] = direction_around(normal, max_sine_squared * point[0], point[1]);
    }
}

static lmb_vec3 sphere_direction(const float point[2])
{
    const float z = 1.0f - 2.0f * point[0];
    const float radius = sqrtf(fmaxf(0.0f, 1.0f - z * z));
    const float angle = 2.0f * TOOLS_PI_F * point[1];
    return (lmb_vec3){radius * cosf(angle), radius * sinf(angle), z};
}

void sphere_directions(uint64_t stream, int count, lmb_vec3 *directions)
{
    for (int k = 0; k < count; ++k) {
        float point[2];
        lmb_sequence_2d(stream, (uint32_t)k, 0, point);
        directions[k] = sphere_direction(point);
    }
}

bool free_point(const lmb_tracer *tracer, const lmb_volume *volume, bool avoid_solids, uint64_t stream, lmb_vec3 *point)
{
    enum { TRIES = 4096 };
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_volume_info info = lmb_volume_get_info(volume);
    const double spacing = (double)info.spacing;
    const lmb_vec3 low =
        lmb_scene_from_world(scene, (lmb_vec3d){info.min[0] * spacing, info.min[1] * spacing, info.min[2] * spacing});
    const lmb_vec3 high = lmb_scene_from_world(scene, (lmb_vec3d){(info.min[0] + (info.size[0] - 1)) * spacing,
                                                                  (info.min[1] + (info.size[1] - 1)) * spacing,
                                                                  (info.min[2] + (info.size[2] - 1)) * spacing});
    const lmb_vec3 size = vector_sub(high, low);
    for (uint32_t attempt = 0; attempt < TRIES; ++attempt) {
        float across[2], height[2];
        lmb_sequence_2d(stream, attempt, PAIR_FREE, across);
        lmb_sequence_2d(stream, attempt, PAIR_FREE_HEIGHT, height);
        const lmb_vec3 at = {low.x + across[0] * size.x, low.y + height[0] * size.y, low.z + across[1] * size.z};
        lmb_sh3_rgb radiance;
        uint64_t rays = 0;
        if (lmb_volume_sample_at(volume, lmb_scene_to_world(scene, at), &radiance) &&
            (!avoid_solids || lmb_placement_is_free(tracer, at, &rays))) {
            *point = at;
            return true;
        }
    }
    return false;
}

float ambient_visibility(const lmb_tracer *tracer, lmb_vec3 position, lmb_vec3 normal, float distance, uint64_t stream,
                         int rays)
{
    double open = 0.0;
    for (int k = 0; k < rays; ++k) {
        float point[2];
        lmb_sequence_2d(stream, (uint32_t)k, 0, point);
        const lmb_vec3 end = vector_mad(position, direction_around(normal, point[0], point[1]), distance);
        uint64_t unused = 0;
        open += (double)lmb_luminance(lmb_trace_transmittance(tracer, position, end, &unused));
    }
    return (float)(open / rays);
}
