#include "light/punctual.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/key_lights.h>
#include <lambent/sequence.h>
#include <lambent/vector.h>

#include "base/vectorised.h"
#include "light/light_tree.h"
#include "light/soft_light.h"

/* Point and spot lights, one array for each float. What has no range or cone has neutral ones there. */
typedef struct lamp_lanes {
    float position[3][LMB_PUNCTUAL_MAX];
    float luminance[LMB_PUNCTUAL_MAX];
    float inverse_range[LMB_PUNCTUAL_MAX];
    float axis[3][LMB_PUNCTUAL_MAX];
    float cos_outer[LMB_PUNCTUAL_MAX];
    float inverse_width[LMB_PUNCTUAL_MAX];
} lamp_lanes;

/* Lights of a kind. */
typedef struct punctual_kind {
    uint32_t *light; /* indices in the scene */
    uint32_t count;
    lmb_light_tree *tree; /* NULL while they are few enough to look at all */
    bool soft;            /* some have an extent */
    uint32_t key_count;   /* of them are key lights */
    bool soft_beside_keys;
    lamp_lanes lanes; /* of few lamps, none soft */
} punctual_kind;

struct lmb_punctual {
    const lmb_scene *scene;
    float *extent; /* [light] lmb_light_extent */
    punctual_kind lamps;
    punctual_kind suns;
};

/* Candidates that are looked at for each light that is wanted, up to LMB_LIGHT_CLUSTERS. */
enum { CANDIDATES_PER_SAMPLE = 8 };

/* Of clusters' variates, each by this further on than the one before, any few lie far apart. */
#define GOLDEN_RATIO 0.6180339887498949

static lmb_light_bound light_bound(const lmb_light *light)
{
    const bool sun = light->type == LMB_LIGHT_DIRECTIONAL;
    const bool spot = light->type == LMB_LIGHT_SPOT;
    const lmb_vec3 position = sun ? lmb_vec3_of(0.0f, 0.0f, 0.0f) : light->position;
    const float radius = sun ? 0.0f : light->radius;
    return (lmb_light_bound){.low = lmb_vec3_sub(position, lmb_vec3_of(radius, radius, radius)),
                             .high = lmb_vec3_add(position, lmb_vec3_of(radius, radius, radius)),
                             .power = lmb_luminance(light->intensity),
                             .axis = spot ? light->direction : lmb_vec3_of(0.0f, 1.0f, 0.0f),
                             .cos_spread = spot ? 1.0f : -1.0f,
                             .cos_reach = spot ? light->cos_outer : -1.0f,
                             .range = light->range > 0.0f ? light->range : INFINITY};
}

static bool punctual_kind_tree(punctual_kind *set, const lmb_scene *scene)
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

static float spot_width(const lmb_light *light)
{
    return lmb_larger(light->cos_inner - light->cos_outer, 1e-4f);
}

static void lamp_lanes_make(punctual_kind *set, const lmb_scene *scene)
{
    lamp_lanes *lanes = &set->lanes;
    for (uint32_t i = 0; i < set->count; ++i) {
        const lmb_light *light = &scene->lights[set->light[i]];
        const bool spot = light->type == LMB_LIGHT_SPOT;
        lanes->position[0][i] = light->position.x;
        lanes->position[1][i] = light->position.y;
        lanes->position[2][i] = light->position.z;
        lanes->luminance[i] = lmb_luminance(light->intensity);
        lanes->inverse_range[i] = light->range > 0.0f ? 1.0f / light->range : 0.0f;
        lanes->axis[0][i] = spot ? light->direction.x : 0.0f;
        lanes->axis[1][i] = spot ? light->direction.y : 0.0f;
        lanes->axis[2][i] = spot ? light->direction.z : 0.0f;
        lanes->cos_outer[i] = spot ? light->cos_outer : -1.0f;
        lanes->inverse_width[i] = spot ? 1.0f / spot_width(light) : 1.0f;
    }
}

static bool punctual_kind_make(punctual_kind *set, const lmb_punctual *punctual, bool suns)
{
    const lmb_scene *scene = punctual->scene;
    set->light = malloc((scene->light_count + 1u) * sizeof *set->light);
    for (uint32_t i = 0; set->light && i < scene->light_count; ++i) {
        if ((scene->lights[i].type == LMB_LIGHT_DIRECTIONAL) == suns && !scene->lights[i].dark) {
            set->light[set->count++] = i;
            set->soft |= punctual->extent[i] > 0.0f;
            set->key_count += lmb_scene_light_is_key(scene, i);
            set->soft_beside_keys |= punctual->extent[i] > 0.0f && !lmb_scene_light_is_key(scene, i);
        }
    }
    if (!set->light) {
        return false;
    }
    if (set->count > LMB_PUNCTUAL_MAX) {
        return punctual_kind_tree(set, scene);
    }
    if (!suns) {
        lamp_lanes_make(set, scene);
    }
    return true;
}

lmb_result lmb_punctual_create(const lmb_scene *scene, lmb_punctual **punctual)
{
    lmb_punctual *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->scene = scene;
    created->extent = malloc((scene->light_count + 1u) * sizeof *created->extent);
    for (uint32_t i = 0; created->extent && i < scene->light_count; ++i) {
        created->extent[i] = lmb_light_extent(&scene->lights[i]);
    }
    if (!created->extent || !punctual_kind_make(&created->lamps, created, false) ||
        !punctual_kind_make(&created->suns, created, true)) {
        lmb_punctual_destroy(created);
        return LMB_ERROR_MEMORY;
    }
    *punctual = created;
    return LMB_OK;
}

static void punctual_kind_free(punctual_kind *set)
{
    free(set->light);
    lmb_light_tree_destroy(set->tree);
}

void lmb_punctual_destroy(lmb_punctual *punctual)
{
    if (punctual) {
        punctual_kind_free(&punctual->lamps);
        punctual_kind_free(&punctual->suns);
        free(punctual->extent);
        free(punctual);
    }
}

/* What the range's window and a spot's cones, which are about its middle, leave of `factor`. `direction` is unit,
 * towards the light. */
static float lamp_fall(const lmb_light *light, lmb_vec3 direction, float distance, float factor)
{
    if (light->range > 0.0f) {
        const float ratio = distance / light->range;
        factor *= lmb_saturate(1.0f - ratio * ratio * ratio * ratio);
    }
    if (light->type == LMB_LIGHT_SPOT) {
        const float cosine = -lmb_vec3_dot(direction, light->direction);
        const float fall = lmb_saturate((cosine - light->cos_outer) / spot_width(light));
        factor *= fall * fall;
    }
    return factor;
}

/* KHR_lights_punctual: inverse square with the range's window, and the spot's angular fall-off. A light of an extent is
 * put into its middle, but gives no more than from its surface on. */
static inline bool light_evaluate(const lmb_light *light, lmb_vec3 position, float min_distance,
                                  lmb_punctual_sample *sample)
{
    sample->at_infinity = light->type == LMB_LIGHT_DIRECTIONAL;
    if (sample->at_infinity) {
        sample->direction = lmb_vec3_scale(light->direction, -1.0f);
        sample->irradiance = light->intensity;
        return true;
    }
    const lmb_vec3 towards = lmb_vec3_sub(light->position, position);
    const float distance = lmb_vec3_length(towards);
    if (!(distance > 0.0f || light->radius > 0.0f) || !isfinite(distance)) {
        return false;
    }
    sample->direction =
        distance > 0.0f ? lmb_vec3_scale(towards, 1.0f / distance) : lmb_vec3_scale(light->direction, -1.0f);
    sample->end = light->position;
    const float counted = lmb_larger(lmb_larger(distance, min_distance), light->radius);
    const float factor = lamp_fall(light, sample->direction, distance, 1.0f / counted / counted);
    sample->irradiance = lmb_rgb_scale(light->intensity, factor);
    return isfinite(factor) && factor > 0.0f;
}

/* Variates of one sample for another of its lights: moved on by steps that keep apart (the plastic number's powers). */
static void point_of_light(const float point[2], uint32_t light, float moved[2])
{
    static const uint32_t step[2] = {UINT32_C(3242174889), UINT32_C(2447445414)}; /* 0.75488, 0.56984 of 2^32 */
    for (int k = 0; k < 2; ++k) {
        const float sum = point[k] + lmb_unit_float(light * step[k]);
        moved[k] = sum < 1.0f ? sum : sum - 1.0f;
    }
}

/* light_evaluate at a point of a light of an extent. */
static bool light_sample(const lmb_punctual *punctual, uint32_t index, const lmb_punctual_query *query,
                         lmb_punctual_sample *sample)
{
    const lmb_light *light = &punctual->scene->lights[index];
    const float extent = punctual->extent[index];
    if (!light_evaluate(light, query->position, query->min_distance, sample)) {
        return false;
    }
    float u[2];
    point_of_light(query->point, index, u);
    lmb_light_point point;
    if (sample->at_infinity) {
        point = lmb_sun_point(sample->direction, extent, u);
    } else {
        const float distance = lmb_vec3_length(lmb_vec3_sub(light->position, query->position));
        point = lmb_lamp_point(light->position, extent, query->position, query->min_distance, u);
        point.factor = lamp_fall(light, sample->direction, distance, point.factor);
    }
    sample->direction = point.direction;
    sample->end = point.end;
    sample->irradiance = lmb_rgb_scale(light->intensity, point.factor);
    return isfinite(point.factor);
}

/* Sine of the angle that half the light takes, seen from `position`: what of it may be above the horizon that its
 * middle is below. 2 from inside, from where some always is. */
static float light_sine(const lmb_punctual *punctual, uint32_t index, lmb_vec3 position)
{
    const lmb_light *light = &punctual->scene->lights[index];
    const float extent = punctual->extent[index];
    if (!(extent > 0.0f) || light->type == LMB_LIGHT_DIRECTIONAL) {
        return extent;
    }
    const float distance = lmb_vec3_length(lmb_vec3_sub(light->position, position));
    return distance > extent ? extent / distance : 2.0f;
}

/* Lights to choose from, and their unshadowed weights: what the choice is in proportion to. */
typedef struct candidates {
    uint32_t light[LMB_LIGHT_CLUSTERS];
    double factor[LMB_LIGHT_CLUSTERS]; /* how many lights it stands for */
    double weight[LMB_LIGHT_CLUSTERS];
    double total;
    int count;
} candidates;

static bool is_asked(const lmb_scene *scene, uint32_t light, const lmb_punctual_query *query)
{
    return !(query->skip_indirect_only && scene->lights[light].indirect_only) &&
           !(query->skip_keys && lmb_scene_light_is_key(scene, light));
}

static void candidate_add(candidates *found, uint32_t light, double factor, double weight)
{
    if (weight > 0.0 && isfinite(weight)) {
        found->light[found->count] = light;
        found->factor[found->count] = factor;
        found->weight[found->count++] = weight;
        found->total += weight;
    }
}

/* Like lmb_hemisphere_density: a texel asks for the light of all its hemisphere and for that by the cosine. */
static inline float weight_of(float luminance, float cosine)
{
    return cosine > 0.0f ? luminance * (0.5f + cosine) : 0.0f;
}

static void light_look(const lmb_punctual *punctual, uint32_t index, const lmb_punctual_query *query, double factor,
                       candidates *found)
{
    const lmb_light *light = &punctual->scene->lights[index];
    lmb_punctual_sample sample;
    if (is_asked(punctual->scene, index, query) &&
        light_evaluate(light, query->position, query->min_distance, &sample)) {
        const float cosine = query->normal ? lmb_vec3_dot(*query->normal, sample.direction) : 1.0f;
        const float highest = cosine + light_sine(punctual, index, query->position);
        const double weight = factor * (double)weight_of(lmb_luminance(sample.irradiance), highest);
        candidate_add(found, index, factor, weight);
    }
}

/* light_evaluate and the weight of all lamps of a set; 0 for those that give nothing. */
LMB_VECTORISED
static void lamps_weigh(const lamp_lanes *lamps, const lmb_punctual_query *query, float weight[LMB_PUNCTUAL_MAX])
{
    const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
    const lmb_vec3 normal = query->normal ? *query->normal : none;
    const float cosine_anyway = query->normal ? 0.0f : 1.0f;
    for (int i = 0; i < LMB_PUNCTUAL_MAX; ++i) {
        const float x = lamps->position[0][i] - query->position.x;
        const float y = lamps->position[1][i] - query->position.y;
        const float z = lamps->position[2][i] - query->position.z;
        const float distance = sqrtf(x * x + y * y + z * z);
        const float inverse = 1.0f / distance;
        const float along = (x * lamps->axis[0][i] + y * lamps->axis[1][i] + z * lamps->axis[2][i]) * -inverse;
        const float fall = (along - lamps->cos_outer[i]) * lamps->inverse_width[i];
        const float fall_in_bounds = lmb_saturate(fall);
        const float ratio = distance * lamps->inverse_range[i];
        const float window = lmb_saturate(1.0f - ratio * ratio * ratio * ratio);
        const float counted = lmb_larger(distance, query->min_distance);
        const float factor = window * fall_in_bounds * fall_in_bounds / (counted * counted);
        const float cosine = (x * normal.x + y * normal.y + z * normal.z) * inverse + cosine_anyway;
        const float found = weight_of(lamps->luminance[i] * factor, cosine);
        weight[i] = found <= FLT_MAX ? found : 0.0f;
    }
}

static void candidates_of_few(const lmb_punctual *punctual, const punctual_kind *set, const lmb_punctual_query *query,
                              candidates *found)
{
    const lmb_scene *scene = punctual->scene;
    if (set->soft || (set->count > 0 && scene->lights[set->light[0]].type == LMB_LIGHT_DIRECTIONAL)) {
        for (uint32_t i = 0; i < set->count; ++i) {
            light_look(punctual, set->light[i], query, 1.0, found);
        }
        return;
    }
    float weight[LMB_PUNCTUAL_MAX];
    lamps_weigh(&set->lanes, query, weight);
    for (uint32_t i = 0; i < set->count; ++i) {
        if (is_asked(scene, set->light[i], query)) {
            candidate_add(found, set->light[i], 1.0, (double)weight[i]);
        }
    }
}

static void candidates_of_many(const lmb_punctual *punctual, const punctual_kind *set, const lmb_punctual_query *query,
                               float choice, int max, candidates *found)
{
    /* Suns have no position: for them all bounds are their power. */
    const bool suns = punctual->scene->lights[set->light[0]].type == LMB_LIGHT_DIRECTIONAL;
    const lmb_light_query asked = suns ? (lmb_light_query){.min_distance = 1.0f}
                                       : (lmb_light_query){query->position, query->normal, query->min_distance, NULL};
    uint32_t cluster[LMB_LIGHT_CLUSTERS];
    const int wanted = max * CANDIDATES_PER_SAMPLE;
    const int most = wanted < LMB_LIGHT_CLUSTERS ? wanted : LMB_LIGHT_CLUSTERS;
    const int count = lmb_light_tree_split(set->tree, &asked, most, cluster);
    double u = (double)choice;
    for (int k = 0; k < count; ++k) {
        double probability;
        const uint32_t i = lmb_light_tree_choose_in(set->tree, cluster[k], &asked, u, &probability);
        light_look(punctual, set->light[i], query, 1.0 / probability, found);
        u += GOLDEN_RATIO;
        u -= floor(u);
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
        share[i] = (1.0 - LMB_LIGHT_EVEN_SHARE) * found->weight[i] / found->total + LMB_LIGHT_EVEN_SHARE / found->count;
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

static bool candidate_take(const lmb_punctual *punctual, const candidates *found, int k, double inclusion,
                           const lmb_punctual_query *query, lmb_punctual_sample *sample)
{
    const uint32_t light = found->light[k];
    sample->light = light;
    sample->soft = punctual->extent[light] > 0.0f;
    sample->weight = (float)(found->factor[k] / inclusion);
    const bool gives =
        sample->soft ? light_sample(punctual, light, query, sample)
                     : light_evaluate(&punctual->scene->lights[light], query->position, query->min_distance, sample);
    sample->irradiance = gives ? lmb_rgb_scale(sample->irradiance, sample->weight) : sample->irradiance;
    return gives;
}

/* All candidates, or `max` of more, at even steps through the sum of their probabilities. */
static int candidates_take(const lmb_punctual *punctual, const candidates *found, const lmb_punctual_query *query,
                           float choice, int max, lmb_punctual_sample *sample)
{
    double inclusion[LMB_LIGHT_CLUSTERS];
    const bool all = found->count <= max;
    if (!all) {
        inclusions_find(found, max, inclusion);
    }
    int chosen = 0;
    int given = 0;
    double passed = 0.0;
    for (int i = 0; i < found->count && chosen < max; ++i) {
        passed += all ? 1.0 : inclusion[i];
        if (chosen + (double)choice < passed) {
            given += candidate_take(punctual, found, i, all ? 1.0 : inclusion[i], query, &sample[given]);
            ++chosen;
        }
    }
    return given;
}

static int punctual_kind_choose(const lmb_punctual *punctual, const punctual_kind *set, const lmb_punctual_query *query,
                                const float choice[2], int max, lmb_punctual_sample *sample)
{
    candidates found;
    found.count = 0;
    found.total = 0.0;
    if (set->tree) {
        candidates_of_many(punctual, set, query, choice[0], max, &found);
    } else {
        candidates_of_few(punctual, set, query, &found);
    }
    return candidates_take(punctual, &found, query, choice[1], max, sample);
}

uint32_t lmb_punctual_count(const lmb_punctual *punctual, bool skip_keys)
{
    const uint32_t keys = skip_keys ? punctual->suns.key_count : 0;
    return punctual->lamps.count + punctual->suns.count - keys;
}

bool lmb_punctual_are_soft(const lmb_punctual *punctual, bool skip_keys)
{
    return punctual->lamps.soft || (skip_keys ? punctual->suns.soft_beside_keys : punctual->suns.soft);
}

void lmb_punctual_again(const lmb_punctual *punctual, const lmb_punctual_query *query, lmb_punctual_sample *sample)
{
    if (sample->soft && light_sample(punctual, sample->light, query, sample)) {
        sample->irradiance = lmb_rgb_scale(sample->irradiance, sample->weight);
    }
}

bool lmb_punctual_are_few(const lmb_punctual *punctual, bool skip_keys)
{
    return !punctual->lamps.tree && !punctual->suns.tree && !lmb_punctual_are_soft(punctual, skip_keys);
}

int lmb_punctual_choose(const lmb_punctual *punctual, const lmb_punctual_query *query, const float choice[2], int max,
                        lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX])
{
    const int lamps = punctual_kind_choose(punctual, &punctual->lamps, query, choice, max, sample);
    return lamps + punctual_kind_choose(punctual, &punctual->suns, query, choice, max, sample + lamps);
}
