#include <lambent/emitters.h>

#include <float.h>
#include <stdlib.h>

#include "bake_internal.h"
#include "sky.h"

typedef struct emitter {
    uint32_t instance;
    uint32_t triangle;
    float area;
    float probability; /* of being chosen */
} emitter;

struct lmb_emitters {
    const lmb_tracer *tracer;
    emitter *triangles;
    double *cumulative; /* [triangle] running sum of power, for the choice */
    uint32_t triangle_count;
    uint32_t **emitter_of; /* [instance] NULL, or [triangle]: number in `triangles`, or UINT32_MAX */
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

static bool emitter_add(lmb_emitters *emitters, uint32_t *capacity, const emitter *added)
{
    if (emitters->triangle_count == *capacity) {
        const uint32_t grown = *capacity ? 2 * *capacity : 256;
        emitter *triangles = realloc(emitters->triangles, grown * sizeof *triangles);
        if (!triangles) {
            return false;
        }
        emitters->triangles = triangles;
        *capacity = grown;
    }
    emitters->triangles[emitters->triangle_count++] = *added;
    return true;
}

/* Finds the emissive triangles of one instance. */
static bool instance_collect(lmb_emitters *emitters, uint32_t *capacity, uint32_t number)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_instance *instance = &scene->instances[number];
    const lmb_mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count && !instance->dynamic; ++t) {
        if (!material_emits(&scene->materials[mesh->material[t]])) {
            continue;
        }
        lmb_vec3 corner[3];
        lmb_trace_corners(emitters->tracer, number, t, corner);
        const float area =
            0.5f * vec3_length(vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0])));
        const float power = area * triangle_luminance(emitters->tracer, number, t);
        if (!(power > 0.0f) || !isfinite(power)) {
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
        /* `probability` holds the power until all are known. */
        if (!emitter_add(emitters, capacity, &(emitter){number, t, area, power})) {
            return false;
        }
    }
    return true;
}

static bool triangles_collect(lmb_emitters *emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    uint32_t capacity = 0;
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (!instance_collect(emitters, &capacity, i)) {
            return false;
        }
    }
    emitters->cumulative = malloc((emitters->triangle_count + 1u) * sizeof *emitters->cumulative);
    if (!emitters->cumulative) {
        return false;
    }
    double total = 0.0;
    for (uint32_t i = 0; i < emitters->triangle_count; ++i) {
        total += (double)emitters->triangles[i].probability;
        emitters->cumulative[i] = total;
    }
    for (uint32_t i = 0; i < emitters->triangle_count; ++i) {
        emitters->triangles[i].probability = (float)((double)emitters->triangles[i].probability / total);
    }
    return true;
}

lmb_result lmb_emitters_create(const lmb_tracer *tracer, lmb_emitters **emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    lmb_emitters *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->tracer = tracer;
    created->emitter_of = calloc(scene->instance_count + 1u, sizeof *created->emitter_of);
    if (!created->emitter_of || !triangles_collect(created) ||
        lmb_sky_create(&scene->environment, &created->sky) != LMB_OK) {
        lmb_emitters_destroy(created);
        return LMB_ERROR_MEMORY;
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
    free(emitters->cumulative);
    lmb_sky_free(&emitters->sky);
    free(emitters);
}

uint32_t lmb_emitters_triangle_count(const lmb_emitters *emitters)
{
    return emitters->triangle_count;
}

/* Number of the first entry of a running sum that exceeds `target`. */
static uint32_t cumulative_find(const double *cumulative, uint32_t count, double target)
{
    uint32_t low = 0;
    uint32_t high = count - 1;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (cumulative[middle] > target) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

/* Density per solid angle of a point chosen with `per_area`; 0 when seen edge-on. */
static float density_per_solid_angle(float per_area, float distance, float cosine)
{
    return cosine > 1e-6f ? per_area * distance * distance / cosine : 0.0f;
}

bool lmb_emitters_sample_triangle(const lmb_emitters *emitters, lmb_vec3 position, float choice, const float point[2],
                                  lmb_light_sample *sample)
{
    if (emitters->triangle_count == 0) {
        return false;
    }
    const double total = emitters->cumulative[emitters->triangle_count - 1];
    const uint32_t number = cumulative_find(emitters->cumulative, emitters->triangle_count, (double)choice * total);
    const emitter *chosen = &emitters->triangles[number];
    const float root = sqrtf(point[0]);
    const float u = root * (1.0f - point[1]);
    const float v = root * point[1];
    const lmb_place place = lmb_trace_place(emitters->tracer, chosen->instance, chosen->triangle, u, v);
    const lmb_vec3 back = vec3_sub(position, place.position);
    sample->end = lmb_trace_offset(place.position, place.geometric_normal, place.rounding, back);
    const lmb_vec3 towards = vec3_sub(place.position, position);
    const float distance = vec3_length(towards);
    if (!(distance > 0.0f)) {
        return false;
    }
    sample->direction = vec3_scale(towards, 1.0f / distance);
    const float cosine = fabsf(vec3_dot(sample->direction, place.geometric_normal));
    sample->density = density_per_solid_angle(chosen->probability / chosen->area, distance, cosine);
    const lmb_surface surface = lmb_trace_surface(emitters->tracer, chosen->instance, chosen->triangle, u, v);
    sample->radiance = rgb_scale(surface.emission, surface.opacity);
    return sample->density > 0.0f && isfinite(sample->density) && rgb_max(sample->radiance) > 0.0f;
}

float lmb_emitters_triangle_density(const lmb_emitters *emitters, const lmb_hit *hit, lmb_vec3 direction,
                                    float distance, lmb_vec3 geometric_normal)
{
    const uint32_t *numbers = emitters->emitter_of[hit->instance];
    if (!numbers || numbers[hit->triangle] == UINT32_MAX) {
        return 0.0f;
    }
    const emitter *found = &emitters->triangles[numbers[hit->triangle]];
    const float cosine = fabsf(vec3_dot(direction, geometric_normal));
    return density_per_solid_angle(found->probability / found->area, distance, cosine);
}

bool lmb_emitters_environment_sampled(const lmb_emitters *emitters)
{
    return emitters->sky.cumulative != NULL;
}

bool lmb_emitters_sample_environment(const lmb_emitters *emitters, const float point[2], lmb_light_sample *sample)
{
    return lmb_sky_sample(&emitters->sky, point, sample);
}

float lmb_emitters_environment_density(const lmb_emitters *emitters, lmb_vec3 direction)
{
    return lmb_sky_density(&emitters->sky, direction);
}

lmb_rgb lmb_emitters_environment_radiance(const lmb_emitters *emitters, lmb_vec3 direction)
{
    return lmb_sky_radiance(&emitters->sky, direction);
}

/* KHR_lights_punctual: inverse square with the range's window, and the spot's angular fall-off. */
static bool punctual_evaluate(const lmb_light *light, lmb_vec3 position, float min_distance,
                              lmb_punctual_sample *sample)
{
    sample->at_infinity = light->type == LMB_LIGHT_DIRECTIONAL;
    if (sample->at_infinity) {
        sample->direction = vec3_scale(light->direction, -1.0f);
        sample->irradiance = light->intensity;
        return true;
    }
    const lmb_vec3 towards = vec3_sub(light->position, position);
    const float distance = vec3_length(towards);
    if (!(distance > 0.0f) || !isfinite(distance)) {
        return false;
    }
    sample->direction = vec3_scale(towards, 1.0f / distance);
    sample->end = light->position;
    const float counted = fmaxf(distance, min_distance);
    float factor = 1.0f / counted / counted;
    if (light->range > 0.0f) {
        const float ratio = distance / light->range;
        factor *= fminf(fmaxf(1.0f - ratio * ratio * ratio * ratio, 0.0f), 1.0f);
    }
    if (light->type == LMB_LIGHT_SPOT) {
        const float cosine = -vec3_dot(sample->direction, light->direction);
        const float width = fmaxf(light->cos_inner - light->cos_outer, 1e-4f);
        const float fall = fminf(fmaxf((cosine - light->cos_outer) / width, 0.0f), 1.0f);
        factor *= fall * fall;
    }
    sample->irradiance = rgb_scale(light->intensity, factor);
    return isfinite(factor) && factor > 0.0f;
}

/* Unshadowed weight of one light at a point: what the choice is in proportion to. */
static float punctual_weight(const lmb_light *light, const lmb_punctual_query *query, lmb_punctual_sample *sample)
{
    if ((light->type == LMB_LIGHT_DIRECTIONAL) != query->at_infinity ||
        (light->indirect_only && query->skip_indirect_only) ||
        !punctual_evaluate(light, query->position, query->min_distance, sample)) {
        return 0.0f;
    }
    const float cosine = query->normal ? fmaxf(vec3_dot(*query->normal, sample->direction), 0.0f) : 1.0f;
    const float weight = lmb_luminance(sample->irradiance) * cosine;
    return isfinite(weight) ? weight : 0.0f;
}

/* Share of the choices that any light that gives light has the same chance of. What is chosen by strength alone never
 * finds a candle in a room whose walls keep the sun out; this bounds how much rarer than any other it is chosen. */
#define PUNCTUAL_EVEN_SHARE 0.1

bool lmb_emitters_sample_punctual(const lmb_emitters *emitters, const lmb_punctual_query *query, float choice,
                                  lmb_punctual_sample *sample)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    lmb_punctual_sample candidate;
    double total = 0.0;
    uint32_t giving = 0;
    for (uint32_t i = 0; i < scene->light_count; ++i) {
        const float weight = punctual_weight(&scene->lights[i], query, &candidate);
        total += (double)weight;
        giving += weight > 0.0f;
    }
    if (giving == 0) {
        return false;
    }
    double left = (double)choice;
    double probability = 1.0;
    for (uint32_t i = 0; i < scene->light_count && left >= 0.0; ++i) {
        const float weight = punctual_weight(&scene->lights[i], query, &candidate);
        if (weight > 0.0f) {
            *sample = candidate;
            probability = (1.0 - PUNCTUAL_EVEN_SHARE) * ((double)weight / total) + PUNCTUAL_EVEN_SHARE / giving;
            left -= probability;
        }
    }
    sample->irradiance = rgb_scale(sample->irradiance, (float)(1.0 / probability));
    return true;
}
