#include "light/light_tree.h"

#include <float.h>
#include <math.h>

#include <lambent/vector.h>

#include "base/vectorised.h"
#include "light/light_tree_internal.h"

/* A bound must miss by this much, in cosines and in shares of a range, before it counts: far more than rounding. */
#define SLACK 1e-3f

/* What the cosines count at least where light can arrive, so that none that is misjudged weighs without bound. */
#define MIN_EMITTED 0.02f
#define MIN_RECEIVED 0.25f

enum { CHILDREN = LMB_LIGHT_CHILDREN };

/* The cluster of all lights; any other is a slot + 1. */
enum { WHOLE = 0 };

static inline float float_between(float low, float value, float high)
{
    return lmb_smaller(lmb_larger(value, low), high);
}

/* About the most that the lights of each child can give, 0 only where they can give nothing: power, over the square of
 * the distance, times what directions and the window of the range (KHR_lights_punctual) at the near side leave of it.
 * A sphere of sine r / d in the way of an angle a leaves at most cos(max(0, a - asin(r / d))) <= cos a + r / d. */
LMB_VECTORISED
static void children_look(const lmb_light_node *restrict node, const lmb_light_query *restrict query, bool two_sided,
                          float *restrict weight)
{
    const lmb_vec3 none = {0.0f, 0.0f, 0.0f};
    const lmb_vec3 position = query->position;
    const lmb_vec3 normal = query->normal ? *query->normal : none;
    const float received_anyway = query->normal ? 0.0f : 1.0f;
    const float min_distance = query->min_distance;
    const float other_side = two_sided ? -1.0f : 1.0f;
    for (int k = 0; k < CHILDREN; ++k) {
        const float x = position.x - node->middle[0][k];
        const float y = position.y - node->middle[1][k];
        const float z = position.z - node->middle[2][k];
        const float radius = node->radius[k];
        const float distance = sqrtf(lmb_smaller(x * x + y * y + z * z, FLT_MAX));
        const float inverse = 1.0f / lmb_larger(distance, FLT_MIN);
        const float sphere = radius * inverse;

        const float ratio = lmb_larger(distance - radius, 0.0f) * node->inverse_range[k];
        const float window =
            ratio > 1.0f + SLACK ? 0.0f : lmb_larger(1.0f - ratio * ratio * ratio * ratio, MIN_EMITTED);

        const float towards = (x * node->axis[0][k] + y * node->axis[1][k] + z * node->axis[2][k]) * inverse;
        const float along = lmb_larger(towards, towards * other_side);
        const float sine = sqrtf(lmb_larger((1.0f - along) * (1.0f + along), 0.0f));
        const float turned = along * node->cos_spread[k] + sine * node->sin_spread[k];
        const float emitted = (along >= node->cos_spread[k] ? 1.0f : turned) + sphere;
        const float leaving = emitted < node->cos_reach[k] - SLACK ? 0.0f : float_between(MIN_EMITTED, emitted, 1.0f);

        const float received = received_anyway + sphere - (x * normal.x + y * normal.y + z * normal.z) * inverse;
        const float part = MIN_RECEIVED + (1.0f - MIN_RECEIVED) * float_between(0.0f, received, 1.0f);
        const float arriving = received < -SLACK ? 0.0f : part;

        const float directions = distance > radius * (1.0f + SLACK) ? leaving * arriving : 1.0f;
        const float counted = lmb_larger(lmb_larger(distance, radius), min_distance);
        const float found = node->power[k] * window * directions / (counted * counted + 1e-30f);
        weight[k] = found > 0.0f ? found : 0.0f;
    }
}

static void shares_find(const lmb_light_tree *tree, const lmb_light_node *node, const lmb_light_query *query,
                        lmb_light_shares *shares)
{
    float weight[CHILDREN];
    children_look(node, query, tree->two_sided, weight);
    double sum = 0.0;
    for (int k = 0; k < CHILDREN; ++k) {
        sum += (double)weight[k];
        shares->up_to[k] = sum;
    }
    /* Where none promises anything all are as good. */
    for (int k = 0; k < CHILDREN && !(shares->up_to[CHILDREN - 1] > 0.0); ++k) {
        sum += node->count[k] > 0 ? 1.0 : 0.0;
        shares->up_to[k] = sum;
    }
    for (int k = 0; k < CHILDREN; ++k) {
        shares->up_to[k] /= sum;
    }
}

/* `room` is used where the query keeps nothing. */
static const lmb_light_shares *node_shares(const lmb_light_tree *tree, uint32_t node, const lmb_light_query *query,
                                           lmb_light_shares *room)
{
    lmb_light_memo *memo = query->memo;
    if (!memo) {
        shares_find(tree, &tree->node[node], query, room);
        return room;
    }
    const uint32_t slot = node % LMB_LIGHT_MEMO;
    if (memo->node[slot] != node + 1) {
        memo->node[slot] = node + 1;
        shares_find(tree, &tree->node[node], query, &memo->shares[slot]);
    }
    return &memo->shares[slot];
}

static double shares_before(const lmb_light_shares *shares, uint32_t child)
{
    return child > 0 ? shares->up_to[child - 1] : 0.0;
}

/* The node inside of a cluster; a single light has none, and gives NO_NODE. */
#define NO_NODE UINT32_MAX
static uint32_t cluster_node(const lmb_light_tree *tree, uint32_t cluster)
{
    if (cluster == WHOLE) {
        return 0;
    }
    const uint32_t slot = cluster - 1;
    const uint32_t inside = tree->node[slot / CHILDREN].inside[slot % CHILDREN];
    return inside != 0 ? inside : NO_NODE;
}

uint32_t lmb_light_tree_cluster(const lmb_light_tree *tree, uint32_t cluster, const uint32_t **light)
{
    if (cluster == WHOLE) {
        *light = tree->light;
        return tree->count;
    }
    const uint32_t slot = cluster - 1;
    const lmb_light_node *node = &tree->node[slot / CHILDREN];
    *light = &tree->light[node->first_leaf[slot % CHILDREN]];
    return node->count[slot % CHILDREN];
}

static double with_even_share(uint32_t count, double probability)
{
    return (1.0 - LMB_LIGHT_EVEN_SHARE) * probability + LMB_LIGHT_EVEN_SHARE / count;
}

/* Probability of getting to a light from a node above it, by strength alone. */
static double light_probability(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t top, uint32_t light)
{
    uint32_t slot = tree->slot_of[light];
    double probability = 1.0;
    for (;;) {
        lmb_light_shares room;
        const uint32_t above = slot / CHILDREN, child = slot % CHILDREN;
        const lmb_light_shares *shares = node_shares(tree, above, query, &room);
        probability *= shares->up_to[child] - shares_before(shares, child);
        if (above == top) {
            return probability;
        }
        slot = tree->node[above].slot;
    }
}

/* The first child whose share, times `whole`, is not all below `u`. */
static uint32_t child_choose(const lmb_light_shares *shares, double u, double whole)
{
    uint32_t chosen = 0;
    for (int k = 0; k < CHILDREN; ++k) {
        chosen += u >= shares->up_to[k] * whole;
    }
    if (chosen == CHILDREN) { /* rounding: the last one that has a share */
        do {
            --chosen;
        } while (chosen > 0 && shares->up_to[chosen] <= shares->up_to[chosen - 1]);
    }
    return chosen;
}

/* The light that `u` chooses by strength, and its probability. */
static uint32_t light_choose(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t top, double u,
                             double *probability)
{
    uint32_t at = top;
    double whole = 1.0; /* share of all u that lead here, and `u` is how far into it */
    for (;;) {
        lmb_light_shares room;
        const lmb_light_shares *shares = node_shares(tree, at, query, &room);
        const uint32_t child = child_choose(shares, u, whole);
        const double before = shares_before(shares, child);
        u -= before * whole;
        whole *= shares->up_to[child] - before;
        if (tree->node[at].inside[child] == 0) {
            *probability = whole;
            return tree->light[tree->node[at].first_leaf[child]];
        }
        at = tree->node[at].inside[child];
    }
}

uint32_t lmb_light_tree_choose_in(const lmb_light_tree *tree, uint32_t cluster, const lmb_light_query *query, double u,
                                  double *probability)
{
    const uint32_t *lights;
    const uint32_t count = lmb_light_tree_cluster(tree, cluster, &lights);
    const uint32_t top = cluster_node(tree, cluster);
    uint32_t light = lights[0];
    *probability = 1.0;
    if (u < LMB_LIGHT_EVEN_SHARE) {
        const uint32_t even = (uint32_t)(u / LMB_LIGHT_EVEN_SHARE * count);
        light = lights[even < count ? even : count - 1];
        *probability = top != NO_NODE ? light_probability(tree, query, top, light) : 1.0;
    } else if (top != NO_NODE) {
        light = light_choose(tree, query, top, (u - LMB_LIGHT_EVEN_SHARE) / (1.0 - LMB_LIGHT_EVEN_SHARE), probability);
    }
    *probability = with_even_share(count, *probability);
    return light;
}

uint32_t lmb_light_tree_choose(const lmb_light_tree *tree, const lmb_light_query *query, double u, double *probability)
{
    return lmb_light_tree_choose_in(tree, WHOLE, query, u, probability);
}

double lmb_light_tree_probability(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t light)
{
    return with_even_share(tree->count, light_probability(tree, query, 0, light));
}

/* Clusters on the way to be divided. */
typedef struct clusters {
    uint32_t cluster[LMB_LIGHT_CLUSTERS];
    float importance[LMB_LIGHT_CLUSTERS];
    bool is_final[LMB_LIGHT_CLUSTERS]; /* a single light, or there is no room for its children */
    int count;
} clusters;

static int strongest_find(const clusters *found)
{
    int strongest = -1;
    for (int i = 0; i < found->count; ++i) {
        const bool stronger = strongest < 0 || found->importance[i] > found->importance[strongest];
        strongest = !found->is_final[i] && stronger ? i : strongest;
    }
    return strongest;
}

/* Puts the children of a cluster that can give anything in its place, if there is room for them. */
static void cluster_divide(const lmb_light_tree *tree, const lmb_light_query *query, int max, int index,
                           clusters *found)
{
    const uint32_t node = cluster_node(tree, found->cluster[index]);
    float weight[CHILDREN];
    children_look(&tree->node[node], query, tree->two_sided, weight);
    int giving = 0;
    for (int k = 0; k < CHILDREN; ++k) {
        giving += weight[k] > 0.0f;
    }
    if (found->count - 1 + giving > max) {
        found->is_final[index] = true;
        return;
    }
    --found->count;
    found->cluster[index] = found->cluster[found->count];
    found->importance[index] = found->importance[found->count];
    found->is_final[index] = found->is_final[found->count];
    for (int k = 0; k < CHILDREN; ++k) {
        if (weight[k] > 0.0f) {
            const int i = found->count++;
            found->cluster[i] = node * CHILDREN + (uint32_t)k + 1;
            found->importance[i] = weight[k];
            found->is_final[i] = tree->node[node].inside[k] == 0;
        }
    }
}

int lmb_light_tree_split(const lmb_light_tree *tree, const lmb_light_query *query, int max, uint32_t *cluster)
{
    clusters found = {.cluster = {WHOLE}, .count = 1};
    for (int i = 0; i >= 0; i = strongest_find(&found)) {
        cluster_divide(tree, query, max, i, &found);
    }
    for (int i = 0; i < found.count; ++i) {
        cluster[i] = found.cluster[i];
    }
    return found.count;
}
