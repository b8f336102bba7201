#include <lambent/emitters.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

#include <assert.h>
#include <stdlib.h>

#include "light/emitters_internal.h"
#include "trace/trace_internal.h"

static lmb_result tree_create(lmb_emitters *emitters)
{
    lmb_light_bound *bounds = malloc((emitters->count + 1u) * sizeof *bounds);
    if (!bounds) {
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < emitters->count; ++i) {
        bounds[i] = emitters->emitters[i].bound;
    }
    const lmb_result result = lmb_light_tree_create(bounds, emitters->count, true, &emitters->tree);
    free(bounds);
    return result;
}

static lmb_result triangles_collect(lmb_emitters *emitters)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    emitters->emitter_of = calloc(scene->instance_count + 1u, sizeof *emitters->emitter_of);
    if (!emitters->emitter_of) {
        return LMB_ERROR_MEMORY;
    }
    if (lmb_emitters_go_without(emitters, LMB_WITHOUT_TRIANGLE_AIM)) {
        return LMB_OK;
    }
    lmb_result result = lmb_emitters_find(emitters);
    result = result == LMB_OK ? lmb_emitters_divide(emitters) : result;
    return result != LMB_OK || lmb_emitters_go_without(emitters, LMB_WITHOUT_TRIANGLE_TREE) ? result
                                                                                            : tree_create(emitters);
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
    created->without = without;
    lmb_result result = triangles_collect(created);
    if (result == LMB_OK) {
        result = lmb_punctual_create(scene, &created->punctual);
    }
    if (result == LMB_OK) {
        result = lmb_sky_create(&scene->environment, !lmb_emitters_go_without(created, LMB_WITHOUT_ENVIRONMENT_AIM),
                                &created->sky);
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
    lmb_emitters_forget(emitters);
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

static uint32_t emitter_choose(const lmb_emitters *emitters, const lmb_triangle_query *query, float choice,
                               double *probability)
{
    if (emitters->tree) {
        const lmb_light_query asked = tree_query(query);
        return lmb_light_tree_choose(emitters->tree, &asked, (double)choice, probability);
    }
    *probability = 1.0 / emitters->count;
    return (uint32_t)((double)choice * emitters->count);
}

static double emitter_probability(const lmb_emitters *emitters, const lmb_triangle_query *query, uint32_t index)
{
    if (emitters->tree) {
        const lmb_light_query asked = tree_query(query);
        return lmb_light_tree_probability(emitters->tree, &asked, index);
    }
    return 1.0 / emitters->count;
}

/* The map that an emitter's points follow; NULL: they are even over its part. */
static const lmb_emission_map *points_map(const lmb_emitters *emitters, const lmb_emitter *emitter)
{
    const lmb_scene *scene = lmb_tracer_scene(emitters->tracer);
    const lmb_mesh *mesh = &scene->meshes[scene->instances[emitter->instance].mesh];
    return emitter->even_points ? NULL : emitters->materials[mesh->material[emitter->triangle]].map;
}

/* Puts the i-th point, which is even over the triangle, where its emitter gives light. */
static void point_place(const lmb_emitters *emitters, lmb_emitter_points *points, uint32_t i, const float u[2])
{
    const lmb_emitter *emitter = &emitters->emitters[points->emitter[i]];
    lmb_emission_lattice lattice;
    lmb_emission_part whole;
    const lmb_emission_part *part = &whole;
    if (emitter->part != LMB_NONE) {
        part = &emitters->parts[emitter->part];
    } else if (!emitter->even_points && lmb_emitter_lattice(emitters, emitter, &lattice)) {
        whole = lmb_emission_part_whole(&lattice);
    } else {
        return;
    }
    float weight[2], density = 0.0f;
    if (lmb_emission_part_sample(points_map(emitters, emitter), part, u, weight, &density)) {
        points->u[i] = weight[0];
        points->v[i] = weight[1];
    }
    points->probability[i] *= density;
}

/* What the i-th of the points found gives; the density is 0 where it gives no light. */
static lmb_light_sample point_light(const lmb_emitters *emitters, const lmb_emitter_points *points, uint32_t i)
{
    const lmb_emitter *chosen = &emitters->emitters[points->emitter[i]];
    lmb_light_sample sample = {
        .direction = lmb_vec3_of(points->direction[0][i], points->direction[1][i], points->direction[2][i]),
        .end = lmb_vec3_of(points->end[0][i], points->end[1][i], points->end[2][i]),
        .radiance = chosen->radiance,
        .density = points->density[i]};
    if (!chosen->even) {
        const lmb_hit there = {
            .instance = chosen->instance, .triangle = chosen->triangle, .u = points->u[i], .v = points->v[i]};
        sample.radiance = lmb_rgb_scale(lmb_emitters_emission(emitters, &there),
                                        lmb_trace_surface(emitters->tracer, &there).coverage.opacity);
        sample.density = lmb_rgb_max(sample.radiance) > 0.0f ? sample.density : 0.0f;
    }
    return sample;
}

lmb_rgb lmb_emitters_emission(const lmb_emitters *emitters, const lmb_hit *hit)
{
    const lmb_mesh_point point = lmb_trace_mesh_point(emitters->tracer, hit);
    return lmb_material_emission(&point);
}

void lmb_emitters_sample_triangles(const lmb_emitters *emitters, const lmb_triangle_query *query,
                                   const lmb_triangle_choices *choices, lmb_light_sample *sample)
{
    const uint32_t count = choices->count;
    const float *const x = choices->x, *const y = choices->y;
    assert(emitters->count > 0 && count <= LMB_EMITTER_POINTS);
    lmb_emitter_points points;
    points.count = count;
    for (uint32_t i = 0; i < count; ++i) {
        double probability;
        points.emitter[i] = (int32_t)emitter_choose(emitters, query, choices->choice[i], &probability);
        points.probability[i] = (float)probability;
        points.position[0][i] = choices->position[i].x;
        points.position[1][i] = choices->position[i].y;
        points.position[2][i] = choices->position[i].z;
    }
    lmb_emitter_points_even(&points, x, y);
    for (uint32_t i = 0; emitters->map_count > 0 && i < count; ++i) {
        const float u[2] = {x[i], y[i]};
        point_place(emitters, &points, i, u);
    }
    lmb_emitter_points_find(emitters->shapes, &points);
    for (uint32_t i = 0; i < count; ++i) {
        sample[i] = point_light(emitters, &points, i);
    }
}

/* The emitter that a point of a triangle belongs to; LMB_NONE where that is dark. */
static uint32_t emitter_at(const lmb_emitters *emitters, uint32_t whole, const double texel[2])
{
    if (emitters->emitters[whole].cut == LMB_NONE) {
        return whole;
    }
    lmb_emitter_half half = {LMB_HALF_CUT, emitters->emitters[whole].cut};
    while (half.kind == LMB_HALF_CUT) {
        const lmb_emitter_cut *cut = &emitters->cuts[half.index];
        half = cut->half[texel[cut->line.axis] >= cut->line.line];
    }
    return half.kind == LMB_HALF_EMITTER ? half.index : LMB_NONE;
}

static double points_density(const lmb_emitters *emitters, const lmb_emitter *emitter,
                             const lmb_emission_lattice *lattice, const double texel[2])
{
    if (emitter->part != LMB_NONE) {
        return lmb_emission_part_density(points_map(emitters, emitter), &emitters->parts[emitter->part], texel);
    }
    const lmb_emission_part whole = lmb_emission_part_whole(lattice);
    return emitter->even_points ? 1.0 : lmb_emission_part_density(points_map(emitters, emitter), &whole, texel);
}

float lmb_emitters_triangle_density(const lmb_emitters *emitters, const lmb_triangle_query *query, const lmb_hit *hit,
                                    lmb_vec3 direction)
{
    const uint32_t *emitter_of = emitters->emitter_of[hit->instance];
    if (!emitter_of || emitter_of[hit->triangle] == LMB_NONE) {
        return 0.0f;
    }
    uint32_t index = emitter_of[hit->triangle];
    lmb_emission_lattice lattice;
    double points = 1.0; /* density beside that of points even over the triangle */
    if (emitters->map_count > 0 && lmb_emitter_lattice(emitters, &emitters->emitters[index], &lattice)) {
        double texel[2];
        lmb_emission_texel(&lattice, hit->u, hit->v, texel);
        index = emitter_at(emitters, index, texel);
        points = index != LMB_NONE ? points_density(emitters, &emitters->emitters[index], &lattice, texel) : 0.0;
    }
    if (!(points > 0.0)) {
        return 0.0f;
    }
    const float probability = (float)(emitter_probability(emitters, query, index) * points);
    return lmb_emitter_density(&emitters->shapes[index], probability, hit->distance, direction);
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

lmb_rgb lmb_emitters_environment_shown(const lmb_emitters *emitters, lmb_vec3 direction)
{
    return lmb_sky_shown(&emitters->sky, direction);
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

bool lmb_emitters_have_punctual(const lmb_emitters *emitters, bool skip_keys)
{
    return lmb_punctual_count(emitters->punctual, skip_keys) > 0;
}

bool lmb_emitters_punctual_are_soft(const lmb_emitters *emitters, bool skip_keys)
{
    return lmb_punctual_are_soft(emitters->punctual, skip_keys);
}

bool lmb_emitters_punctual_are_few(const lmb_emitters *emitters, bool skip_keys)
{
    return lmb_punctual_are_few(emitters->punctual, skip_keys);
}

int lmb_emitters_punctual(const lmb_emitters *emitters, const lmb_punctual_query *query, const float choice[2], int max,
                          lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX])
{
    return lmb_punctual_choose(emitters->punctual, query, choice, max, sample);
}
