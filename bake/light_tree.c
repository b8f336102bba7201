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

/* Rounding must not carry a number to 1, where no child may be. */
static inline double below_one(double number)
{
    return number < 1.0 - DBL_EPSILON ? number : 1.0 - DBL_EPSILON;
}

/* Cosine of the angle that is left between a direction and the node's axes, of that to the middle one. */
static float cosine_off(const lmb_light_node *node, float cosine)
{
    if (cosine >= node->cos_spread) {
        return 1.0f;
    }
    const float square = (1.0f - cosine) * (1.0f + cosine);
    return cosine * node->cos_spread + sqrtf(float_larger(square, 0.0f)) * node->sin_spread;
}

/* Share of the window of the range that is left at the node's near side (KHR_lights_punctual). */
static float range_share(const lmb_light_node *node, float distance)
{
    if (!(distance > node->radius) || isinf(node->range)) {
        return 1.0f;
    }
    const float ratio = (distance - node->radius) / node->range;
    const float squared = ratio * ratio;
    return ratio > 1.0f + SLACK ? 0.0f : float_larger(1.0f - squared * squared, MIN_EMITTED);
}

/* About the most that a node's lights can give is share / squared. */
typedef struct node_bound {
    double share; /* power times what directions leave of it; 0 only where the node can give nothing */
    double squared;
} node_bound;

/* A sphere of sine r / d in the way of an angle a leaves at most cos(max(0, a - asin(r / d))) <= cos a + r / d. */
static node_bound node_look(const lmb_light_tree *tree, const lmb_light_node *node, const lmb_light_query *query)
{
    const lmb_vec3 apart = vec3_sub(query->position, node->middle);
    const float distance = sqrtf(float_smaller(vec3_dot(apart, apart), FLT_MAX));
    const float counted = float_larger(float_larger(distance, node->radius), query->min_distance);
    float share = range_share(node, distance);
    if (distance > node->radius * (1.0f + SLACK)) {
        const float inverse = 1.0f / distance;
        const float sphere = node->radius * inverse;
        const float along = vec3_dot(node->axis, apart) * inverse;
        const float emitted = cosine_off(node, tree->two_sided ? fabsf(along) : along) + sphere;
        share *= emitted < node->cos_reach - SLACK ? 0.0f : float_smaller(float_larger(emitted, MIN_EMITTED), 1.0f);
        if (query->normal) {
            const float received = sphere - vec3_dot(*query->normal, apart) * inverse;
            share *= received < -SLACK
                         ? 0.0f
                         : MIN_RECEIVED + (1.0f - MIN_RECEIVED) * float_smaller(float_larger(received, 0.0f), 1.0f);
        }
    }
    return (node_bound){(double)node->power * (double)share, (double)counted * (double)counted + 1e-30};
}

static double first_share_find(const lmb_light_tree *tree, uint32_t number, const lmb_light_query *query)
{
    const node_bound a = node_look(tree, &tree->node[number + 1], query);
    const node_bound b = node_look(tree, &tree->node[tree->node[number].second], query);
    const double first = a.share * b.squared;
    const double second = b.share * a.squared;
    return first + second > 0.0 ? first / (first + second) : 0.5;
}

/* Probability of the first child of a node. */
static double first_share(const lmb_light_tree *tree, uint32_t number, const lmb_light_query *query)
{
    lmb_light_memo *memo = query->memo;
    if (!memo) {
        return first_share_find(tree, number, query);
    }
    const uint32_t place = number % LMB_LIGHT_MEMO;
    if (memo->node[place] != number + 1) {
        memo->node[place] = number + 1;
        memo->share[place] = first_share_find(tree, number, query);
    }
    return memo->share[place];
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
        /* What is left of the number is again uniform. */
        number = into_first ? number / share : (number - share) / (1.0 - share);
        number = below_one(number);
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
        const double rest = below_one((number - EVEN_SHARE) / (1.0 - EVEN_SHARE));
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

static double node_importance(const lmb_light_tree *tree, uint32_t number, const lmb_light_query *query)
{
    const node_bound bound = node_look(tree, &tree->node[number], query);
    return bound.share / bound.squared;
}

int lmb_light_tree_split(const lmb_light_tree *tree, const lmb_light_query *query, int max, uint32_t *cluster)
{
    double importance[LMB_LIGHT_CLUSTERS];
    importance[0] = node_importance(tree, 0, query);
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
            importance[count] = node_importance(tree, children[k], query);
            count += importance[count] > 0.0;
        }
    }
    return count;
}
