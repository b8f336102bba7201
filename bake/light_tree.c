#include "light_tree.h"

#include <stdlib.h>

#include "bake_internal.h"

#define EVEN_SHARE 0.1

typedef struct light_node {
    lmb_vec3 middle;
    float radius_squared; /* of the sphere about its box */
    float power;
} light_node;

struct lmb_light_tree {
    uint32_t count;
    uint32_t *light;  /* [place] in the order of the curve */
    uint32_t *place;  /* [light] where it is in that order */
    light_node *node; /* the root's is 1, the children's of n are 2 n and 2 n + 1 */
};

typedef struct curve_key {
    uint64_t key;
    uint32_t light;
} curve_key;

/* Spreads the 21 lowest bits three apart. */
static uint64_t bits_spread(uint64_t x)
{
    x &= 0x1fffff;
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t grid_place(float middle, float low, float high)
{
    const double share = high > low ? ((double)middle - (double)low) / ((double)high - (double)low) : 0.0;
    return share > 0.0 ? (uint64_t)(fmin(share, 1.0) * 0x1fffff) : 0;
}

static lmb_vec3 box_middle(lmb_vec3 low, lmb_vec3 high)
{
    return vec3_mad(vec3_scale(low, 0.5f), high, 0.5f);
}

static void box_grow(lmb_vec3 *low, lmb_vec3 *high, lmb_vec3 by_low, lmb_vec3 by_high)
{
    *low = vec3(fminf(low->x, by_low.x), fminf(low->y, by_low.y), fminf(low->z, by_low.z));
    *high = vec3(fmaxf(high->x, by_high.x), fmaxf(high->y, by_high.y), fmaxf(high->z, by_high.z));
}

static int key_compare(const void *left, const void *right)
{
    const curve_key *a = left;
    const curve_key *b = right;
    if (a->key != b->key) {
        return a->key < b->key ? -1 : 1;
    }
    return a->light < b->light ? -1 : a->light > b->light;
}

static bool lights_order(lmb_light_tree *tree, const lmb_light_bound *lights)
{
    curve_key *keys = malloc(tree->count * sizeof *keys);
    if (!keys) {
        return false;
    }
    lmb_vec3 low = lights[0].low, high = lights[0].high;
    for (uint32_t i = 1; i < tree->count; ++i) {
        box_grow(&low, &high, lights[i].low, lights[i].high);
    }
    for (uint32_t i = 0; i < tree->count; ++i) {
        const lmb_vec3 middle = box_middle(lights[i].low, lights[i].high);
        keys[i].key = bits_spread(grid_place(middle.x, low.x, high.x)) |
                      bits_spread(grid_place(middle.y, low.y, high.y)) << 1 |
                      bits_spread(grid_place(middle.z, low.z, high.z)) << 2;
        keys[i].light = i;
    }
    qsort(keys, tree->count, sizeof *keys, key_compare);
    for (uint32_t i = 0; i < tree->count; ++i) {
        tree->light[i] = keys[i].light;
        tree->place[keys[i].light] = i;
    }
    free(keys);
    return true;
}

/* Makes the node that covers places first .. end - 1, and all below it. Returns its box and power. */
static lmb_light_bound node_make(lmb_light_tree *tree, const lmb_light_bound *lights, size_t number, uint32_t first,
                                 uint32_t end)
{
    lmb_light_bound bound = lights[tree->light[first]];
    if (end - first > 1) {
        const uint32_t middle = first + (end - first) / 2;
        bound = node_make(tree, lights, 2 * number, first, middle);
        const lmb_light_bound other = node_make(tree, lights, 2 * number + 1, middle, end);
        box_grow(&bound.low, &bound.high, other.low, other.high);
        bound.power += other.power;
    }
    const lmb_vec3 half = vec3_scale(vec3_sub(bound.high, bound.low), 0.5f);
    tree->node[number] = (light_node){box_middle(bound.low, bound.high), vec3_dot(half, half), bound.power};
    return bound;
}

/* Nodes are numbered as if all leaves lay at the deepest level. */
static size_t node_numbers(uint32_t count)
{
    size_t leaves = 1;
    while (leaves < count) {
        leaves *= 2;
    }
    return 2 * leaves;
}

lmb_result lmb_light_tree_create(const lmb_light_bound *lights, uint32_t count, lmb_light_tree **tree)
{
    *tree = NULL;
    if (count == 0) {
        return LMB_OK;
    }
    lmb_light_tree *created = calloc(1, sizeof *created);
    if (!created) {
        return LMB_ERROR_MEMORY;
    }
    created->count = count;
    created->light = malloc(count * sizeof *created->light);
    created->place = malloc(count * sizeof *created->place);
    created->node = calloc(node_numbers(count), sizeof *created->node);
    if (!created->light || !created->place || !created->node || !lights_order(created, lights)) {
        lmb_light_tree_destroy(created);
        return LMB_ERROR_MEMORY;
    }
    node_make(created, lights, 1, 0, count);
    *tree = created;
    return LMB_OK;
}

void lmb_light_tree_destroy(lmb_light_tree *tree)
{
    if (tree) {
        free(tree->light);
        free(tree->place);
        free(tree->node);
        free(tree);
    }
}

static double node_importance(const light_node *node, lmb_vec3 position)
{
    const lmb_vec3 apart = vec3_sub(node->middle, position);
    const float distance_squared = vec3_dot(apart, apart);
    const float squared = distance_squared > node->radius_squared ? distance_squared : node->radius_squared;
    return (double)node->power / ((double)squared + 1e-30);
}

/* Probability of the first of a node's two children. */
static double first_share(const lmb_light_tree *tree, size_t number, lmb_vec3 position)
{
    const double first = node_importance(&tree->node[2 * number], position);
    const double second = node_importance(&tree->node[2 * number + 1], position);
    return first / (first + second);
}

/* Walks from the root to a place: the one that `number` chooses, or `target` when that is one. */
static uint32_t tree_walk(const lmb_light_tree *tree, lmb_vec3 position, double number, uint32_t target,
                          double *probability)
{
    uint32_t first = 0;
    uint32_t end = tree->count;
    *probability = 1.0;
    for (size_t node = 1; end - first > 1;) {
        const uint32_t middle = first + (end - first) / 2;
        const double share = first_share(tree, node, position);
        const bool into_first = target < tree->count ? target < middle : number < share;
        if (into_first) {
            number /= share;
            *probability *= share;
            end = middle;
        } else {
            number = (number - share) / (1.0 - share);
            *probability *= 1.0 - share;
            first = middle;
        }
        node = 2 * node + (into_first ? 0 : 1);
    }
    return first;
}

static double with_even_share(const lmb_light_tree *tree, double probability)
{
    return (1.0 - EVEN_SHARE) * probability + EVEN_SHARE / tree->count;
}

uint32_t lmb_light_tree_choose(const lmb_light_tree *tree, lmb_vec3 position, double number, double *probability)
{
    uint32_t place;
    if (number < EVEN_SHARE) {
        const uint32_t even = (uint32_t)(number / EVEN_SHARE * tree->count);
        place = even < tree->count ? even : tree->count - 1;
        tree_walk(tree, position, 0.0, place, probability);
    } else {
        place = tree_walk(tree, position, (number - EVEN_SHARE) / (1.0 - EVEN_SHARE), UINT32_MAX, probability);
    }
    *probability = with_even_share(tree, *probability);
    return tree->light[place];
}

double lmb_light_tree_probability(const lmb_light_tree *tree, lmb_vec3 position, uint32_t light)
{
    double probability;
    tree_walk(tree, position, 0.0, tree->place[light], &probability);
    return with_even_share(tree, probability);
}
