/* Finding the emissive triangles of a scene, and what each of them gives. */
#include "light/emitters_internal.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

#include "trace/trace_internal.h"

/* What one triangle of a mesh gives, wherever the mesh is placed. */
typedef struct mesh_light {
    float mean; /* luminance times opacity; negative: not known yet */
    bool even_points;
} mesh_light;

typedef struct finding {
    lmb_emitters *emitters;
    mesh_light **known; /* [mesh] NULL, or [triangle] */
} finding;

/* Whether a material's emission is the same all over. */
static bool material_emits_evenly(const lmb_material *material)
{
    return material->emissive_texture.image < 0 && lmb_material_is_opaque(material);
}

/* Mean luminance over a triangle that no texture has a part in: over a grid of points. */
static float points_luminance(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle)
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
            const lmb_mesh_point point =
                lmb_trace_mesh_point(tracer, &(lmb_hit){.instance = instance, .triangle = triangle, .u = u, .v = v});
            sum += lmb_luminance(lmb_material_emission(&point)) * lmb_material_coverage(&point).opacity;
        }
    }
    return sum / (STEPS * STEPS);
}

/* Opacity by vertex colours and factors, where a texture's does not count, or counts apart. `*most` is the largest. */
static float vertices_opacity(const lmb_scene *scene, const lmb_mesh *mesh, uint32_t triangle, float *most)
{
    const lmb_material *material = &scene->materials[mesh->material[triangle]];
    float sum = 0.0f;
    *most = 0.0f;
    for (int k = 0; k < 3; ++k) {
        const float color = mesh->color ? mesh->color[mesh->triangle[triangle][k]][3] : 1.0f;
        const float alpha = lmb_saturate(color * material->base_color[3]);
        sum += alpha;
        *most = lmb_larger(*most, alpha);
    }
    return sum / 3.0f;
}

/* Mean luminance over a triangle of what neither its map nor its luminance tell: what its vertices and factors let
 * through. */
static float factors_opacity(const lmb_scene *scene, const lmb_mesh *mesh, uint32_t triangle)
{
    const lmb_material *material = &scene->materials[mesh->material[triangle]];
    float most;
    const float mean = vertices_opacity(scene, mesh, triangle, &most);
    float opacity = 1.0f;
    if (material->alpha_mode == LMB_ALPHA_BLEND) {
        opacity = mean;
    } else if (material->alpha_mode == LMB_ALPHA_MASK) {
        opacity = most >= material->alpha_cutoff ? 1.0f : 0.0f;
    }
    return opacity * lmb_larger(1.0f - material->transmission, 0.0f);
}

bool lmb_emitter_lattice(const lmb_emitters *emitters, const lmb_emitter *emitter, lmb_emission_lattice *lattice)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_mesh *mesh = &scene->meshes[scene->instances[emitter->instance].mesh];
    const lmb_emitter_material *material = &emitters->materials[mesh->material[emitter->triangle]];
    return material->map && lmb_emission_lattice_of(mesh, emitter->triangle, material->texture, material->map, lattice);
}

static mesh_light light_look(const lmb_emitters *emitters, const lmb_emitter *emitter)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_mesh *mesh = &scene->meshes[scene->instances[emitter->instance].mesh];
    const uint32_t material = mesh->material[emitter->triangle];
    lmb_emission_lattice lattice;
    if (!lmb_emitter_lattice(emitters, emitter, &lattice)) {
        float mean = points_luminance(emitters->tracer, emitter->instance, emitter->triangle);
        if (!(mean > 0.0f)) { /* between the points there may be light yet */
            mean = factors_opacity(scene, mesh, emitter->triangle) * lmb_luminance(emitter->radiance) / 64.0f;
        }
        return (mesh_light){mean, true};
    }
    const lmb_emission_map *map = emitters->materials[material].map;
    const lmb_emission_part whole = lmb_emission_part_whole(&lattice);
    const double light = lmb_emission_part_light(map, &whole);
    return (mesh_light){lmb_luminance(emitter->radiance) * factors_opacity(scene, mesh, emitter->triangle) *
                            (float)light,
                        lmb_emission_part_is_even(map, &whole)};
}

static bool light_find(finding *found, const lmb_emitter *emitter, mesh_light *light)
{
    const lmb_scene *scene = lmb_tracer_scene(found->emitters->tracer);
    const uint32_t mesh = scene->instances[emitter->instance].mesh;
    const uint32_t count = scene->meshes[mesh].triangle_count;
    mesh_light **known = &found->known[mesh];
    if (!*known) {
        *known = malloc(count * sizeof **known);
        for (uint32_t t = 0; *known && t < count; ++t) {
            (*known)[t].mean = -1.0f;
        }
        if (!*known) {
            return false;
        }
    }
    if ((*known)[emitter->triangle].mean < 0.0f) {
        (*known)[emitter->triangle] = light_look(found->emitters, emitter);
    }
    *light = (*known)[emitter->triangle];
    return true;
}

bool lmb_emitters_add(lmb_emitters *emitters, const lmb_emitter *added, const lmb_emitter_shape *shape)
{
    if (emitters->count == emitters->capacity) {
        const uint32_t grown = emitters->capacity ? 2 * emitters->capacity : 256;
        lmb_emitter *more = realloc(emitters->emitters, grown * sizeof *more);
        emitters->emitters = more ? more : emitters->emitters;
        lmb_emitter_shape *shapes = realloc(emitters->shapes, grown * sizeof *shapes);
        emitters->shapes = shapes ? shapes : emitters->shapes;
        if (!more || !shapes) {
            return false;
        }
        emitters->capacity = grown;
    }
    emitters->shapes[emitters->count] = *shape;
    emitters->emitters[emitters->count++] = *added;
    return true;
}

/* Describes a triangle as a light; without power when it gives none. False when memory runs out. */
static bool emitter_make(finding *found, uint32_t instance, uint32_t triangle, lmb_emitter *made,
                         lmb_emitter_shape *shape)
{
    const lmb_tracer *tracer = found->emitters->tracer;
    const lmb_scene *scene = lmb_tracer_scene(tracer);
    const lmb_material *material = &scene->materials[scene->meshes[scene->instances[instance].mesh].material[triangle]];
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, instance, triangle, corner);
    const lmb_place place =
        lmb_trace_place(tracer, &(lmb_hit){.instance = instance, .triangle = triangle, .u = 0.0f, .v = 0.0f});
    *shape = lmb_emitter_shape_of(corner, place.geometric_normal, place.rounding);
    *made = (lmb_emitter){.instance = instance,
                          .triangle = triangle,
                          .bound = {.low = corner[0],
                                    .high = corner[0],
                                    .axis = place.geometric_normal,
                                    .cos_spread = 1.0f,
                                    .cos_reach = 0.0f,
                                    .range = INFINITY},
                          .even = material_emits_evenly(material),
                          .even_points = true,
                          .radiance = material->emissive,
                          .part = LMB_NONE,
                          .cut = LMB_NONE};
    for (int k = 1; k < 3; ++k) {
        made->bound.low = lmb_vec3_smaller(made->bound.low, corner[k]);
        made->bound.high = lmb_vec3_larger(made->bound.high, corner[k]);
    }
    mesh_light light = {lmb_luminance(made->radiance), true};
    if (!made->even && !light_find(found, made, &light)) {
        return false;
    }
    made->even_points = light.even_points;
    made->bound.power = shape->area * light.mean;
    return true;
}

/* Finds the emissive triangles of one instance. */
static bool instance_find(finding *found, uint32_t index)
{
    lmb_emitters *emitters = found->emitters;
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_instance *instance = &scene->instances[index];
    const lmb_mesh *mesh = &scene->meshes[instance->mesh];
    for (uint32_t t = 0; t < mesh->triangle_count && !instance->dynamic; ++t) {
        lmb_emitter made;
        lmb_emitter_shape shape;
        if (!lmb_material_emits(&scene->materials[mesh->material[t]])) {
            continue;
        }
        if (!emitter_make(found, index, t, &made, &shape)) {
            return false;
        }
        if (!(made.bound.power > 0.0f) || !isfinite(made.bound.power)) {
            continue;
        }
        if (!emitters->emitter_of[index]) {
            emitters->emitter_of[index] = malloc(mesh->triangle_count * sizeof(uint32_t));
            if (!emitters->emitter_of[index]) {
                return false;
            }
            for (uint32_t k = 0; k < mesh->triangle_count; ++k) {
                emitters->emitter_of[index][k] = LMB_NONE;
            }
        }
        emitters->emitter_of[index][t] = emitters->count;
        if (!lmb_emitters_add(emitters, &made, &shape)) {
            return false;
        }
    }
    return true;
}

/* The materials that static triangles wear. */
static void materials_mark(const lmb_scene *scene, bool *worn)
{
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        const lmb_mesh *mesh = &scene->meshes[scene->instances[i].mesh];
        for (uint32_t t = 0; t < mesh->triangle_count && !scene->instances[i].dynamic; ++t) {
            worn[mesh->material[t]] = true;
        }
    }
}

/* A map for each material whose emission depends on a texture; equal ones share it. */
static lmb_result maps_make(lmb_emitters *emitters, const bool *worn, lmb_emission_key *keys)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    for (uint32_t i = 0; i < scene->material_count; ++i) {
        lmb_emitter_material *material = &emitters->materials[i];
        lmb_emission_key key;
        if (!worn[i] || !lmb_material_emits(&scene->materials[i]) ||
            !lmb_emission_key_of(scene, &scene->materials[i], &key, &material->texture)) {
            continue;
        }
        uint32_t same = 0;
        while (same < emitters->map_count && !lmb_emission_key_equal(&keys[same], &key)) {
            ++same;
        }
        if (same == emitters->map_count) {
            const lmb_result result = lmb_emission_map_create(scene, &key, &emitters->maps[same]);
            if (result != LMB_OK) {
                return result;
            }
            keys[emitters->map_count++] = key;
        }
        material->map = emitters->maps[same];
    }
    return LMB_OK;
}

static lmb_result materials_look(lmb_emitters *emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    bool *worn = calloc(scene->material_count + 1u, sizeof *worn);
    lmb_emission_key *keys = calloc(scene->material_count + 1u, sizeof *keys);
    lmb_result result = LMB_ERROR_MEMORY;
    if (worn && keys) {
        materials_mark(scene, worn);
        result = maps_make(emitters, worn, keys);
    }
    free(worn);
    free(keys);
    return result;
}

static lmb_result instances_find(finding *found)
{
    const lmb_scene *scene = lmb_tracer_scene(found->emitters->tracer);
    for (uint32_t i = 0; i < scene->instance_count; ++i) {
        if (!instance_find(found, i)) {
            return LMB_ERROR_MEMORY;
        }
    }
    return LMB_OK;
}

lmb_result lmb_emitters_find(lmb_emitters *emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    finding found = {emitters, calloc(scene->mesh_count + 1u, sizeof *found.known)};
    emitters->materials = calloc(scene->material_count + 1u, sizeof *emitters->materials);
    emitters->maps = calloc(scene->material_count + 1u, sizeof *emitters->maps);
    lmb_result result = LMB_ERROR_MEMORY;
    if (found.known && emitters->materials && emitters->maps) {
        result = materials_look(emitters);
    }
    if (result == LMB_OK) {
        result = instances_find(&found);
        emitters->triangle_count = emitters->count;
    }
    for (uint32_t i = 0; found.known && i < scene->mesh_count; ++i) {
        free(found.known[i]);
    }
    free(found.known);
    return result;
}

void lmb_emitters_forget(lmb_emitters *emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    for (uint32_t i = 0; emitters->emitter_of && i < scene->instance_count; ++i) {
        free(emitters->emitter_of[i]);
    }
    for (uint32_t i = 0; i < emitters->map_count; ++i) {
        lmb_emission_map_destroy(emitters->maps[i]);
    }
    free(emitters->emitter_of);
    free(emitters->maps);
    free(emitters->materials);
    free(emitters->parts);
    free(emitters->cuts);
    free(emitters->emitters);
    free(emitters->shapes);
}
