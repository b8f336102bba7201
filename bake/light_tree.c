#include "light_tree.h"

#include <float.h>

#include "bake_internal.h"
#include "light_tree_internal.h"

#define EVEN_SHARE 0.1

/* A bound must miss by this much, in cosines and in shares of a range, before it counts: far more than rounding. */
#define SLACK 1e-3f

/* What the cosines count at least where light can arrive, so that none that is misjudged weighs without bound. */
#define MIN_EMITTED 0.02f
#define MIN_RECEIVED 0.25f

static float sine_of(float cosine)
{
    const float square = (1.0f - cosine) * (1.0f + cosine);
    return sqrtf(square > 0.0f ? square : 0.0f);
}

/* Cosine of max(0, a - b), angles in [0, pi]. */
static float cosine_less(float cos_a, float sin_a, float cos_b, float sin_b)
{
    return cos_a >= cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}

static float sine_less(float cos_a, float sin_a, float cos_b, float sin_b)
{
    return cos_a >= cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

/* Share of the window of the range that is left at the node's near side (KHR_lights_punctual). */
static float range_share(const lmb_light_node *node, float distance)
{
    const float ratio = (distance - node->radius) / node->range;
    if (!(ratio > 0.0f)) {
        return 1.0f;
    }
    const float squared = ratio * ratio;
    return ratio > 1.0f + SLACK ? 0.0f : fmaxf(1.0f - squared * squared, MIN_EMITTED);
}

/* About the most that the node's lights can give; 0 only where they can give nothing. Angles are the least that the
 * sphere about the node leaves: its own half angle `cone` comes off each. */
static double node_importance(const lmb_light_tree *tree, const lmb_light_node *node, const lmb_light_query *query)
{
    const lmb_vec3 apart = vec3_sub(query->position, node->middle);
    const float distance = sqrtf(fminf(vec3_dot(apart, apart), FLT_MAX));
    const float counted = fmaxf(fmaxf(distance, node->radius), query->min_distance);
    float share = range_share(node, distance);
    if (distance > node->radius * (1.0f + SLACK)) {
        const lmb_vec3 from = vec3_scale(apart, 1.0f / distance);
        const float sin_cone = node->radius / distance;
        const float cos_cone = sine_of(sin_cone);
        const float along = vec3_dot(node->axis, from);
        const float cos_axis = tree->two_sided ? fabsf(along) : along;
        const float sin_axis = sine_of(cos_axis);
        const float cos_off = cosine_less(cos_axis, sin_axis, node->cos_spread, node->sin_spread);
        const float sin_off = sine_less(cos_axis, sin_axis, node->cos_spread, node->sin_spread);
        const float emitted = cosine_less(cos_off, sin_off, cos_cone, sin_cone);
        share *= emitted < node->cos_reach - SLACK ? 0.0f : fmaxf(emitted, MIN_EMITTED);
        if (query->normal) {
            const float cosine = -vec3_dot(*query->normal, from);
            const float received = cosine_less(cosine, sine_of(cosine), cos_cone, sin_cone);
            share *= received < -SLACK ? 0.0f : MIN_RECEIVED + (1.0f - MIN_RECEIVED) * fmaxf(received, 0.0f);
        }
    }
    return (double)node->power * (double)share / ((double)counted * (double)counted + 1e-30);
}

/* Probability of the first child of a node. */
static double first_share(const lmb_light_tree *tree, uint32_t number, const lmb_light_query *query)
{
    const double first = node_importance(tree, &tree->node[number + 1], query);
    const double second = node_importance(tree, &tree->node[tree->node[number].second], query);
    return first + second > 0.0 ? first / (first + second) : 0.5;
}

static double with_even_share(const lmb_light_tree *tree, uint32_t cluster, double probability)
{
    return (1.0 - EVEN_SHARE) * probability + EVEN_SHARE / tree->node[cluster].count;
}

/* Probability of getting to a leaf from a node above it, by strength alone. */
static double leaf_probability(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t from, uint32_t leaf)
{
    double probability = 1.0;
    while (leaf != from) {
        const uint32_t parent = tree->node[leaf].parent;
        const double share = first_share(tree, parent, query);
        probability *= leaf == parent + 1 ? share : 1.0 - share;
        leaf = parent;
    }
    return probability;
}

/* The leaf that `number` chooses by strength, and its probability. */
static uint32_t leaf_choose(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t from, double number,
                            double *probability)
{
    uint32_t at = from;
    *probability = 1.0;
    while (tree->node[at].second) {
        const double share = first_share(tree, at, query);
        const bool into_first = number < share;
        *probability *= into_first ? share : 1.0 - share;
        /* What is left of the number is again uniform; rounding must not carry it to 1, where no child may be. */
        number = into_first ? number / share : (number - share) / (1.0 - share);
        number = fmin(number, 1.0 - DBL_EPSILON);
        at = into_first ? at + 1 : tree->node[at].second;
    }
    return at;
}

uint32_t lmb_light_tree_choose_in(const lmb_light_tree *tree, uint32_t cluster, const lmb_light_query *query,
                                  double number, double *probability)
{
    const lmb_light_node *node = &tree->node[cluster];
    uint32_t light;
    if (number < EVEN_SHARE) {
        const uint32_t even = (uint32_t)(number / EVEN_SHARE * node->count);
        light = tree->light[node->first_place + (even < node->count ? even : node->count - 1)];
        *probability = leaf_probability(tree, query, cluster, tree->leaf_of[light]);
    } else {
        const double rest = fmin((number - EVEN_SHARE) / (1.0 - EVEN_SHARE), 1.0 - DBL_EPSILON);
        light = tree->light[tree->node[leaf_choose(tree, query, cluster, rest, probability)].first_place];
    }
    *probability = with_even_share(tree, cluster, *probability);
    return light;
}

uint32_t lmb_light_tree_choose(const lmb_light_tree *tree, const lmb_light_query *query, double number,
                               double *probability)
{
    return lmb_light_tree_choose_in(tree, 0, query, number, probability);
}

double lmb_light_tree_probability(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t light)
{
    return with_even_share(tree, 0, leaf_probability(tree, query, 0, tree->leaf_of[light]));
}

int lmb_light_tree_split(const lmb_light_tree *tree, const lmb_light_query *query, int max, uint32_t *cluster)
{
    double importance[LMB_LIGHT_CLUSTERS];
    importance[0] = node_importance(tree, &tree->node[0], query);
    cluster[0] = 0;
    int count = importance[0] > 0.0 ? 1 : 0;
    while (count < max) {
        int strongest = -1;
        for (int i = 0; i < count; ++i) {
            const bool divisible = tree->node[cluster[i]].second != 0;
            strongest = divisible && (strongest < 0 || importance[i] > importance[strongest]) ? i : strongest;
        }
        if (strongest < 0) {
            break;
        }
        const uint32_t children[2] = {cluster[strongest] + 1, tree->node[cluster[strongest]].second};
        --count;
        cluster[strongest] = cluster[count];
        importance[strongest] = importance[count];
        for (int k = 0; k < 2; ++k) {
            cluster[count] = children[k];
            importance[count] = node_importance(tree, &tree->node[children[k]], query);
            count += importance[count] > 0.0;
        }
    }
    return count;
}
