#include <lambent/emitters.h>

#include <assert.h>
#include <stdlib.h>

#include "bake_internal.h"
#include "emitter_points.h"
#include "light_tree.h"
#include "punctual.h"
#include "sky.h"
#include "trace_internal.h"

typedef struct emitter {
    uint32_t instance;
    uint32_t triangle;
    lmb_light_bound bound;
    bool even; /* opaque and without texture: `radiance` is its emission everywhere */
    lmb_rgb radiance;
} emitter;

struct lmb_emitters {
    const lmb_tracer *tracer;
    emitter *triangles;
    lmb_emitter_shape *shapes; /* [triangle] */
    uint32_t triangle_count;
    uint32_t triangle_capacity;
    lmb_light_tree *tree;  /* of the triangles; NULL when there are none, or they are chosen evenly */
    uint32_t **emitter_of; /* [instance] NULL, or [triangle]: number in `triangles`, or UINT32_MAX */
    lmb_punctual *punctual;
    bool punctual_are_soft;
    lmb_sky sky;
};

/* Power of a triangle per unit area and solid angle: the mean luminance of its emission over a grid of points. */
static float triangle_luminance(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
{
    enum { STEPS = 4 };
    float sum = 0.0f;
    for (int i = 0; i < STEPS; ++i) {
        for (int j = 0; j < STEPS; ++j) {
            /* Folding the square's upper half back covers the triangle evenly. */
            float u = ((float)i + 0.5f) / STEPS;
            float v = ((float)j + 0.5f) / STEPS;
            if (u + v > 1.0f) {
                u = 1.0f - u;
                v = 1.0f - v;
            }
            const lmb_surface surface = lmb_trace_surface(tracer, instance, triangle, u, v);
            sum += lmb_luminance(surface.emission) * surface.opacity;
        }
    }
    return sum / (STEPS * STEPS);
}

static bool material_emits(const lmb_material *material)
{
    return !material->unlit && rgb_max(material->emissive) > 0.0f;
}

/* Whether a material's emission is the same all over. */
static bool material_emits_evenly(const lmb_material *material)
{
    return material->emissive_texture.image < 0 && material->alpha_mode == LMB_ALPHA_OPAQUE &&
           !(material->transmission > 0.0f);
}

static bool emitters_grow(lmb_emitters *emitters)
{
    const uint32_t grown = emitters->triangle_capacity ? 2 * emitters->triangle_capacity : 256;
    emitter *triangles = realloc(emitters->triangles, grown * sizeof *triangles);
    emitters->triangles = triangles ? triangles : emitters->triangles;
    lmb_emitter_shape *shapes = realloc(emitters->shapes, grown * sizeof *shapes);
    emitters->shapes = shapes ? shapes : emitters->shapes;
    if (!triangles || !shapes) {
        return false;
    }
    emitters->triangle_capacity = grown;
    return true;
}

static bool emitter_add(lmb_emitters *emitters, const emitter *added, const lmb_emitter_shape *shape)
{
    if (emitters->triangle_count == emitters->triangle_capacity && !emitters_grow(emitters)) {
        return false;
    }
    emitters->shapes[emitters->triangle_count] = *shape;
    emitters->triangles[emitters->triangle_count++] = *added;
    return true;
}

/* Describes a triangle as a light; false when it gives none. */
static bool emitter_make(const lmb_emitters *emitters, uint32_t instance, uint32_t triangle,
                         const lmb_material *material, emitter *made, lmb_emitter_shape *shape)
{
    lmb_vec3 corner[3];
    lmb_trace_corners(emitters->tracer, instance, triangle, corner);
    const lmb_place place = lmb_trace_place(emitters->tracer, instance, triangle, 0.0f, 0.0f);
    *shape = lmb_emitter_shape_of(corner, place.geometric_normal, place.rounding);
    *made = (emitter){.instance = instance,
                      .triangle = triangle,
                      .bound = {.low = corner[0],
                                .high = corner[0],
                                .axis = place.geometric_normal,
                                .cos_spread = 1.0f,
                                .cos_reach = 0.0f,
                                .range = INFINITY},
                      .even = material_emits_evenly(material),
                      .radiance = material->emissive};
    for (int k = 1; k < 3; ++k) {
        made->bound.low = vec3_smaller(made->bound.low, corner[k]);
        made->bound.high = vec3_larger(made->bound.high, corner[k]);
    }
    made->bound.power = shape->area * (made->even ? lmb_luminance(made->radiance)
                                                  : triangle_luminance(emitters->tracer, instance, triangle));
    return made->bound.power > 0.0f && isfinite(made->bound.power);
}

/* Finds the emissive triangles of one instance. */
static bool instance_collect(lmb_emitters *emitters, uint32_t number)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_instance *instance = &scene->instances[number];
    const lmb_mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count && !instance->dynamic; ++t) {
        const lmb_material *material = &scene->materials[mesh->material[t]];
        emitter made;
        lmb_emitter_shape shape;
        if (!material_emits(material) || !emitter_make(emitters, number, t, material, &made, &shape)) {
            continue;
        }
        if (!emitters->emitter_of[number]) {
            emitters->emitter_of[number] = malloc(mesh->triangle_count * sizeof(uint32_t));
            if (!emitters->emitter_of[number]) {
                return false;
            }
            for (uint32_t k = 0; k < mesh->triangle_count; ++k) {
                emitters->emitter_of[number][k] = UINT32_MAX;
            }
        }
        emitters->emitter_of[number][t] = emitters->triangle_count;
        if (!emitter_add(emitters, &made, &shape)) {
            return false;
        }
    }
    return true;
}

static lmb_result tree_create(lmb_emitters *emitters)
{
    lmb_light_bound *bounds = malloc((emitters->triangle_count + 1u) * sizeof *bounds);
    if (!bounds) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < emitters->triangle_count; ++i) {
        bounds[i] = emitters->triangles[i].bound;
    }
    const lmb_result result = lmb_light_tree_create(bounds, emitters->triangle_count, true, &emitters->tree);
    free(bounds);
    return result;
}

static lmb_result triangles_collect(lmb_emitters *emitters, unsigned without)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    emitters->emitter_of = calloc(scene->instance_count + 1u, sizeof *emitters->emitter_of);
    if (!emitters->emitter_of) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < scene->instance_count && !(without & LMB_WITHOUT_TRIANGLE_AIM); ++i) {
        if (!instance_collect(emitters, i)) {
            return LMB_ERROR_MEMORY;
        }
    }
    return without & LMB_WITHOUT_TRIANGLE_TREE ? LMB_OK : tree_create(emitters);
}

lmb_result lmb_emitters_create(const lmb_tracer *tracer, lmb_emitters **emitters)
{
    return lmb_emitters_create_without(tracer, 0, emitters);
}

lmb_result lmb_emitters_create_without(const lmb_tracer *tracer, unsigned without, lmb_emitters **emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    lmb_emitters *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->tracer = tracer;
    lmb_result result = triangles_collect(created, without);
    if (result == LMB_OK) {
        result = lmb_punctual_create(scene, &created->punctual);
    }
    if (result == LMB_OK) {
        created->punctual_are_soft = lmb_punctual_are_soft(created->punctual);
        result = lmb_sky_create(&scene->environment, !(without & LMB_WITHOUT_ENVIRONMENT_AIM), &created->sky);
    }
    if (result != LMB_OK) {
        lmb_emitters_destroy(created);
        return result;
    }
    *emitters = created;
    return LMB_OK;
}

void lmb_emitters_destroy(lmb_emitters *emitters)
{
    if (!emitters) {
        return;
    }
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    for (uint32_t i = 0; emitters->emitter_of && i < scene->instance_count; ++i) {
        free(emitters->emitter_of[i]);
    }
    free(emitters->emitter_of);
    free(emitters->triangles);
    free(emitters->shapes);
    lmb_light_tree_destroy(emitters->tree);
    lmb_punctual_destroy(emitters->punctual);
    lmb_sky_free(&emitters->sky);
    free(emitters);
}

uint32_t lmb_emitters_triangle_count(const lmb_emitters *emitters)
{
    return emitters->triangle_count;
}

static lmb_light_query tree_query(const lmb_triangle_query *query)
{
    return (lmb_light_query){.position = query->position, .normal = query->normal, .memo = query->memo};
}

static uint32_t triangle_choose(const lmb_emitters *emitters, const lmb_triangle_query *query, float choice,
                                double *probability)
{
    if (emitters->tree) {
        const lmb_light_query asked = tree_query(query);
        return lmb_light_tree_choose(emitters->tree, &asked, (double)choice, probability);
    }
    *probability = 1.0 / emitters->triangle_count;
    return (uint32_t)((double)choice * emitters->triangle_count);
}

static double triangle_probability(const lmb_emitters *emitters, const lmb_triangle_query *query, uint32_t number)
{
    if (emitters->tree) {
        const lmb_light_query asked = tree_query(query);
        return lmb_light_tree_probability(emitters->tree, &asked, number);
    }
    return 1.0 / emitters->triangle_count;
}

/* What the i-th of the points found gives; the density is 0 where it gives no light. */
static lmb_light_sample triangle_light(const lmb_emitters *emitters, const lmb_emitter_points *points, uint32_t i)
{
    const emitter *chosen = &emitters->triangles[points->triangle[i]];
    lmb_light_sample sample = {.direction =
                                   vec3(points->direction[0][i], points->direction[1][i], points->direction[2][i]),
                               .end = vec3(points->end[0][i], points->end[1][i], points->end[2][i]),
                               .radiance = chosen->radiance,
                               .density = points->density[i]};
    if (!chosen->even) {
        const float root = sqrtf(points->x[i]);
        const lmb_surface surface = lmb_trace_surface(emitters->tracer, chosen->instance, chosen->triangle,
                                                      root * (1.0f - points->y[i]), root * points->y[i]);
        sample.radiance = rgb_scale(surface.emission, surface.opacity);
        sample.density = rgb_max(sample.radiance) > 0.0f ? sample.density : 0.0f;
    }
    return sample;
}

void lmb_emitters_sample_triangles(const lmb_emitters *emitters, const lmb_triangle_query *query,
                                   const lmb_vec3 *position, const float *choice, const float *x, const float *y,
                                   uint32_t count, lmb_light_sample *sample)
{
    assert(emitters->triangle_count > 0 && count <= LMB_EMITTER_POINTS);
    lmb_emitter_points points;
    points.count = count;
    for (uint32_t i = 0; i < count; ++i) {
        double probability;
        points.triangle[i] = (int32_t)triangle_choose(emitters, query, choice[i], &probability);
        points.probability[i] = (float)probability;
        points.x[i] = x[i];
        points.y[i] = y[i];
        points.position[0][i] = position[i].x;
        points.position[1][i] = position[i].y;
        points.position[2][i] = position[i].z;
    }
    lmb_emitter_points_find(emitters->shapes, &points);
    for (uint32_t i = 0; i < count; ++i) {
        sample[i] = triangle_light(emitters, &points, i);
    }
}

float lmb_emitters_triangle_density(const lmb_emitters *emitters, const lmb_triangle_query *query, const lmb_hit *hit,
                                    lmb_vec3 direction)
{
    const uint32_t *numbers = emitters->emitter_of[hit->instance];
    if (!numbers || numbers[hit->triangle] == UINT32_MAX) {
        return 0.0f;
    }
    const uint32_t number = numbers[hit->triangle];
    const double probability = triangle_probability(emitters, query, number);
    return lmb_emitter_density(&emitters->shapes[number], (float)probability, hit->distance, direction);
}

bool lmb_emitters_environment_sampled(const lmb_emitters *emitters)
{
    return emitters->sky.aimed_count > 0;
}

void lmb_emitters_sample_environment(const lmb_emitters *emitters, const float *x, const float *y, uint32_t count,
                                     lmb_light_sample *sample)
{
    lmb_sky_sample_batch(&emitters->sky, x, y, count, sample);
}

lmb_rgb lmb_emitters_environment_radiance(const lmb_emitters *emitters, lmb_vec3 direction, float *density)
{
    const lmb_environment_seen seen = lmb_sky_look(&emitters->sky, direction);
    *density = seen.density;
    return seen.radiance;
}

void lmb_emitters_environment_look(const lmb_emitters *emitters, const float *const direction[3], uint32_t count,
                                   lmb_environment_seen *seen)
{
    lmb_sky_look_batch(&emitters->sky, direction, count, seen);
}

void lmb_emitters_punctual_again(const lmb_emitters *emitters, const lmb_punctual_query *query,
                                 lmb_punctual_sample *sample)
{
    lmb_punctual_again(emitters->punctual, query, sample);
}

bool lmb_emitters_punctual_are_soft(const lmb_emitters *emitters)
{
    return emitters->punctual_are_soft;
}

bool lmb_emitters_punctual_are_few(const lmb_emitters *emitters)
{
    return lmb_punctual_are_few(emitters->punctual);
}

int lmb_emitters_punctual(const lmb_emitters *emitters, const lmb_punctual_query *query, const float choice[2], int max,
                          lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX])
{
    return lmb_punctual_choose(emitters->punctual, query, choice, max, sample);
}
