#include "punctual.h"

#include <stdlib.h>

#include "bake_internal.h"
#include "light_tree.h"

/* Lights of a kind. */
typedef struct light_set {
    uint32_t *light; /* numbers in the scene */
    uint32_t count;
    lmb_light_tree *tree; /* NULL while they are few enough to look at all */
} light_set;

struct lmb_punctual {
    const lmb_scene *scene;
    light_set lamps;
    light_set suns;
};

/* Share of the choices that any light that gives light has the same chance of. What is chosen by strength alone never
 * finds a candle in a room whose walls keep the sun out; this bounds how much rarer than any other it is chosen. */
#define EVEN_SHARE 0.1

/* Candidates that are looked at for each light that is wanted, up to LMB_LIGHT_CLUSTERS. */
enum { CANDIDATES_PER_SAMPLE = 8 };

/* Of clusters' numbers, each by this further on than the one before, any few lie far apart. */
#define GOLDEN_RATIO 0.6180339887498949

static lmb_light_bound light_bound(const lmb_light *light)
{
    const bool sun = light->type == LMB_LIGHT_DIRECTIONAL;
    const bool spot = light->type == LMB_LIGHT_SPOT;
    const lmb_vec3 position = sun ? vec3(0.0f, 0.0f, 0.0f) : light->position;
    return (lmb_light_bound){.low = position,
                             .high = position,
                             .power = lmb_luminance(light->intensity),
                             .axis = spot ? light->direction : vec3(0.0f, 1.0f, 0.0f),
                             .cos_spread = spot ? 1.0f : -1.0f,
                             .cos_reach = spot ? light->cos_outer : -1.0f,
                             .range = light->range > 0.0f ? light->range : INFINITY};
}

static bool light_set_tree(light_set *set, const lmb_scene *scene)
{
    lmb_light_bound *bounds = malloc(set->count * sizeof *bounds);
    if (!bounds) {
        return false;
    }
    uint32_t giving = 0;
    for (uint32_t i = 0; i < set->count; ++i) {
        bounds[giving] = light_bound(&scene->lights[set->light[i]]);
        if (bounds[giving].power > 0.0f && isfinite(bounds[giving].power)) {
            set->light[giving++] = set->light[i];
        }
    }
    set->count = giving;
    const lmb_result result = lmb_light_tree_create(bounds, giving, false, &set->tree);
    free(bounds);
    return result == LMB_OK;
}

static bool light_set_make(light_set *set, const lmb_scene *scene, bool suns)
{
    set->light = malloc((scene->light_count + 1u) * sizeof *set->light);
    for (uint32_t i = 0; set->light && i < scene->light_count; ++i) {
        if ((scene->lights[i].type == LMB_LIGHT_DIRECTIONAL) == suns) {
            set->light[set->count++] = i;
        }
    }
    return set->light && (set->count <= LMB_PUNCTUAL_MAX || light_set_tree(set, scene));
}

lmb_result lmb_punctual_create(const lmb_scene *scene, lmb_punctual **punctual)
{
    lmb_punctual *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->scene = scene;
    if (!light_set_make(&created->lamps, scene, false) || !light_set_make(&created->suns, scene, true)) {
        lmb_punctual_destroy(created);
        return LMB_ERROR_MEMORY;
    }
    *punctual = created;
    return LMB_OK;
}

static void light_set_free(light_set *set)
{
    free(set->light);
    lmb_light_tree_destroy(set->tree);
}

void lmb_punctual_destroy(lmb_punctual *punctual)
{
    if (punctual) {
        light_set_free(&punctual->lamps);
        light_set_free(&punctual->suns);
        free(punctual);
    }
}

/* KHR_lights_punctual: inverse square with the range's window, and the spot's angular fall-off. */
static bool light_evaluate(const lmb_light *light, lmb_vec3 position, float min_distance, lmb_punctual_sample *sample)
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
    const float counted = float_larger(distance, min_distance);
    float factor = 1.0f / counted / counted;
    if (light->range > 0.0f) {
        const float ratio = distance / light->range;
        factor *= float_smaller(float_larger(1.0f - ratio * ratio * ratio * ratio, 0.0f), 1.0f);
    }
    if (light->type == LMB_LIGHT_SPOT) {
        const float cosine = -vec3_dot(sample->direction, light->direction);
        const float width = float_larger(light->cos_inner - light->cos_outer, 1e-4f);
        const float fall = float_smaller(float_larger((cosine - light->cos_outer) / width, 0.0f), 1.0f);
        factor *= fall * fall;
    }
    sample->irradiance = rgb_scale(light->intensity, factor);
    return isfinite(factor) && factor > 0.0f;
}

/* Lights to choose from, and their unshadowed weights: what the choice is in proportion to. */
typedef struct candidates {
    lmb_punctual_sample sample[LMB_LIGHT_CLUSTERS];
    double weight[LMB_LIGHT_CLUSTERS];
    double total;
    int count;
} candidates;

static void candidate_add(candidates *found, const lmb_light *light, const lmb_punctual_query *query, double factor)
{
    lmb_punctual_sample *sample = &found->sample[found->count];
    if ((light->indirect_only && query->skip_indirect_only) ||
        !light_evaluate(light, query->position, query->min_distance, sample)) {
        return;
    }
    const float cosine = query->normal ? vec3_dot(*query->normal, sample->direction) : 1.0f;
    sample->irradiance = rgb_scale(sample->irradiance, (float)factor);
    /* Like lmb_hemisphere_density: a texel asks for the light of all its hemisphere and for that by the cosine. */
    const double weight = (double)lmb_luminance(sample->irradiance) * (0.5 + (double)cosine);
    if (cosine > 0.0f && weight > 0.0 && isfinite(weight)) {
        found->weight[found->count++] = weight;
        found->total += weight;
    }
}

static void candidates_find(const lmb_scene *scene, const light_set *set, const lmb_punctual_query *query, float choice,
                            int max, candidates *found)
{
    found->count = 0;
    found->total = 0.0;
    if (!set->tree) {
        for (uint32_t i = 0; i < set->count; ++i) {
            candidate_add(found, &scene->lights[set->light[i]], query, 1.0);
        }
        return;
    }
    /* Suns have no place: for them all bounds are their power. */
    const bool suns = scene->lights[set->light[0]].type == LMB_LIGHT_DIRECTIONAL;
    const lmb_light_query asked = suns ? (lmb_light_query){.min_distance = 1.0f}
                                       : (lmb_light_query){query->position, query->normal, query->min_distance};
    uint32_t cluster[LMB_LIGHT_CLUSTERS];
    const int wanted = max * CANDIDATES_PER_SAMPLE;
    const int most = wanted < LMB_LIGHT_CLUSTERS ? wanted : LMB_LIGHT_CLUSTERS;
    const int count = lmb_light_tree_split(set->tree, &asked, most, cluster);
    double number = (double)choice;
    for (int k = 0; k < count; ++k) {
        double probability;
        const uint32_t i = lmb_light_tree_choose_in(set->tree, cluster[k], &asked, number, &probability);
        candidate_add(found, &scene->lights[set->light[i]], query, 1.0 / probability);
        number += GOLDEN_RATIO;
        number -= floor(number);
    }
}

/* Probabilities with which each candidate is to be among `max` < count: in proportion to its weight, but no more than
 * 1. Those that reach it are taken for certain, and the rest shares what is left of `max`. */
static void inclusions_find(const candidates *found, int max, double inclusion[LMB_LIGHT_CLUSTERS])
{
    double share[LMB_LIGHT_CLUSTERS];
    bool certain[LMB_LIGHT_CLUSTERS] = {false};
    double rest = 1.0; /* sum of the shares that are not certain */
    int left = max;
    for (int i = 0; i < found->count; ++i) {
        share[i] = (1.0 - EVEN_SHARE) * found->weight[i] / found->total + EVEN_SHARE / found->count;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int i = 0; i < found->count && left > 0; ++i) {
            if (!certain[i] && share[i] * left >= rest) {
                certain[i] = changed = true;
                rest -= share[i];
                --left;
            }
        }
    }
    for (int i = 0; i < found->count; ++i) {
        inclusion[i] = certain[i] ? 1.0 : share[i] * left / rest;
    }
}

/* Takes `max` of more candidates at even steps through the sum of their probabilities. */
static int candidates_choose(const candidates *found, float choice, int max, lmb_punctual_sample *sample)
{
    double inclusion[LMB_LIGHT_CLUSTERS];
    inclusions_find(found, max, inclusion);
    int given = 0;
    double passed = 0.0;
    for (int i = 0; i < found->count && given < max; ++i) {
        passed += inclusion[i];
        if (given + (double)choice < passed) {
            sample[given] = found->sample[i];
            sample[given].irradiance = rgb_scale(found->sample[i].irradiance, (float)(1.0 / inclusion[i]));
            ++given;
        }
    }
    return given;
}

static int light_set_choose(const lmb_scene *scene, const light_set *set, const lmb_punctual_query *query,
                            const float choice[2], int max, lmb_punctual_sample *sample)
{
    candidates found;
    candidates_find(scene, set, query, choice[0], max, &found);
    if (found.count > max) {
        return candidates_choose(&found, choice[1], max, sample);
    }
    for (int i = 0; i < found.count; ++i) {
        sample[i] = found.sample[i];
    }
    return found.count;
}

int lmb_punctual_choose(const lmb_punctual *punctual, const lmb_punctual_query *query, const float choice[2], int max,
                        lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX])
{
    const int lamps = light_set_choose(punctual->scene, &punctual->lamps, query, choice, max, sample);
    return lamps + light_set_choose(punctual->scene, &punctual->suns, query, choice, max, sample + lamps);
}
