/* Building a light tree: from the top, each set of lights divided where the two halves together promise the least; then
 * up to eight of the sets that come of it become the children of one node. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include <lambent/vector.h>

#include "base/trig.h"
#include "light/light_tree_internal.h"

enum { BINS = 12 };

/* A set of lights that is divided in two: light[first_leaf .. first_leaf + count - 1]. Set i's first half is i + 1.
 */
typedef struct light_pair {
    lmb_light_bound bound;
    uint32_t first_leaf, count;
    uint32_t second; /* half; 0: a single light */
} light_pair;

typedef struct build {
    lmb_light_tree *tree;
    const lmb_light_bound *lights;
    light_pair *pair; /* [2 count - 1] all lights first */
    uint32_t pair_count;
} build;

static float axis_of(lmb_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static lmb_vec3 bound_middle(const lmb_light_bound *bound)
{
    return lmb_vec3_mad(lmb_vec3_scale(bound->low, 0.5f), bound->high, 0.5f);
}

static double cone_angle(float cosine)
{
    return 2.0 * LMB_PI * (double)lmb_turn_of(cosine, sqrtf(lmb_larger(0.0f, (1.0f - cosine) * (1.0f + cosine))));
}

/* Makes a cone the smallest about itself and another; a two-sided one is its own opposite. */
static void cone_unite(lmb_light_bound *cone, const lmb_light_bound *other, bool two_sided)
{
    const float towards = lmb_vec3_dot(cone->axis, other->axis);
    const lmb_vec3 axis = two_sided && towards < 0.0f ? lmb_vec3_scale(other->axis, -1.0f) : other->axis;
    const double apart = cone_angle(two_sided ? fabsf(towards) : towards);
    const double mine = cone_angle(cone->cos_spread), theirs = cone_angle(other->cos_spread);
    if (apart + theirs <= mine) {
        return;
    }
    if (apart + mine <= theirs) {
        cone->axis = axis;
        cone->cos_spread = other->cos_spread;
        return;
    }
    const lmb_vec3 across = lmb_vec3_mad(axis, cone->axis, -lmb_vec3_dot(cone->axis, axis));
    const bool in_line = !(lmb_vec3_length(across) > 1e-3f);
    const double spread = in_line ? fmax(mine, theirs) + apart : 0.5 * (mine + apart + theirs);
    if (spread >= LMB_PI) {
        cone->cos_spread = -1.0f;
        return;
    }
    double sine, cosine;
    if (!in_line) {
        const lmb_vec3 aside = lmb_vec3_unit_or(across, cone->axis);
        lmb_sincos(spread - mine, &sine, &cosine);
        cone->axis =
            lmb_vec3_unit_or(lmb_vec3_mad(lmb_vec3_scale(cone->axis, (float)cosine), aside, (float)sine), cone->axis);
    }
    lmb_sincos(spread, &sine, &cosine);
    cone->cos_spread = (float)cosine;
}

static void bound_unite(lmb_light_bound *bound, const lmb_light_bound *other, bool two_sided)
{
    bound->low = lmb_vec3_smaller(bound->low, other->low);
    bound->high = lmb_vec3_larger(bound->high, other->high);
    bound->power = lmb_smaller(bound->power + other->power, FLT_MAX);
    bound->cos_reach = lmb_smaller(bound->cos_reach, other->cos_reach);
    bound->range = lmb_larger(bound->range, other->range);
    cone_unite(bound, other, two_sided);
}

/* Lights of which one node might be made. */
typedef struct bin {
    lmb_vec3 low, high;
    lmb_vec3 axes; /* sum */
    float power;
    float cos_reach;
    uint32_t count;
} bin;

static void bin_add(bin *to, const bin *added)
{
    if (to->count == 0 || added->count == 0) {
        *to = added->count > 0 ? *added : *to;
        return;
    }
    to->low = lmb_vec3_smaller(to->low, added->low);
    to->high = lmb_vec3_larger(to->high, added->high);
    to->axes = lmb_vec3_add(to->axes, added->axes);
    to->power += added->power;
    to->cos_reach = lmb_smaller(to->cos_reach, added->cos_reach);
    to->count += added->count;
}

/* One light; two-sided ones are turned to the side of `up`. */
static bin bin_of(const lmb_light_bound *light, bool two_sided, lmb_vec3 up)
{
    const bool turned = two_sided && lmb_vec3_dot(light->axis, up) < 0.0f;
    const float length = 0.5f * (1.0f + light->cos_spread); /* of the mean axis of a cone */
    return (bin){.low = light->low,
                 .high = light->high,
                 .axes = lmb_vec3_scale(light->axis, turned ? -length : length),
                 .power = light->power,
                 .cos_reach = light->cos_reach,
                 .count = 1};
}

/* What a node promises too much: its power, by the square of its size and by about the solid angle that it may shine
 * into, weighted by the cosine: that of a single axis is a quarter of all. */
static double bin_cost(const bin *lights)
{
    const lmb_vec3 size = lmb_vec3_sub(lights->high, lights->low);
    const float even = lmb_vec3_length(lights->axes) / (float)lights->count;
    return (double)lights->power * (double)lmb_vec3_dot(size, size) *
           (double)(1.0f - lights->cos_reach + 3.0f * (1.0f - even));
}

/* Slices of a node along an axis. */
typedef struct slicing {
    int axis;
    float low, high; /* of the middles */
} slicing;

static int slice_of(const slicing *slices, const lmb_light_bound *bound)
{
    const float share = (axis_of(bound_middle(bound), slices->axis) - slices->low) / (slices->high - slices->low);
    const int slice = (int)(share * (float)BINS);
    return slice < 0 ? 0 : slice < BINS ? slice : BINS - 1;
}

/* The cheapest cut between slices; its cost, or INFINITY when nothing can be divided along this axis. */
static double cut_find(const build *made, uint32_t first, uint32_t end, const slicing *slices, int *cut)
{
    const lmb_vec3 up = made->lights[made->tree->light[first]].axis;
    bin bins[BINS] = {0};
    double after[BINS];
    if (!(slices->high > slices->low) || !isfinite(slices->high - slices->low)) {
        return (double)INFINITY;
    }
    for (uint32_t i = first; i < end; ++i) {
        const lmb_light_bound *light = &made->lights[made->tree->light[i]];
        const bin one = bin_of(light, made->tree->two_sided, up);
        bin_add(&bins[slice_of(slices, light)], &one);
    }
    /* Neither side of a cut is empty: the first and last slice hold the lights that the range was taken from. */
    bin sum = {0};
    for (int k = BINS - 1; k > 0; --k) {
        bin_add(&sum, &bins[k]);
        after[k] = bin_cost(&sum);
    }
    double best = (double)INFINITY;
    sum = (bin){0};
    for (int k = 1; k < BINS; ++k) {
        bin_add(&sum, &bins[k - 1]);
        const double cost = bin_cost(&sum) + after[k];
        if (cost < best) {
            best = cost;
            *cut = k;
        }
    }
    return best;
}

/* Brings the lights of the first half of leaves first .. end - 1 to the front; returns where the second begins. */
static uint32_t lights_divide(const build *made, uint32_t first, uint32_t end)
{
    uint32_t *light = made->tree->light;
    double best = (double)INFINITY;
    slicing best_slices = {0};
    int best_cut = 0;
    for (int axis = 0; axis < 3; ++axis) {
        slicing slices = {axis, INFINITY, -INFINITY};
        for (uint32_t i = first; i < end; ++i) {
            const float at = axis_of(bound_middle(&made->lights[light[i]]), axis);
            slices.low = lmb_smaller(slices.low, at);
            slices.high = lmb_larger(slices.high, at);
        }
        int cut = 0;
        const double cost = cut_find(made, first, end, &slices, &cut);
        if (cost < best) {
            best = cost;
            best_slices = slices;
            best_cut = cut;
        }
    }
    if (!isfinite(best)) {
        return first + (end - first) / 2;
    }
    uint32_t middle = first;
    for (uint32_t i = first; i < end; ++i) {
        if (slice_of(&best_slices, &made->lights[light[i]]) < best_cut) {
            const uint32_t moved = light[i];
            light[i] = light[middle];
            light[middle++] = moved;
        }
    }
    return middle;
}

/* Makes the pair of leaves first .. end - 1 and all below it. */
static void pair_make(build *made, uint32_t first, uint32_t end)
{
    light_pair *pair = &made->pair[made->pair_count++];
    *pair = (light_pair){.first_leaf = first, .count = end - first};
    if (end - first == 1) {
        pair->bound = made->lights[made->tree->light[first]];
        return;
    }
    const uint32_t middle = lights_divide(made, first, end);
    pair_make(made, first, middle);
    pair->second = made->pair_count;
    pair_make(made, middle, end);
    pair->bound = pair[1].bound;
    bound_unite(&pair->bound, &made->pair[pair->second].bound, made->tree->two_sided);
}

static float bound_radius(const lmb_light_bound *bound)
{
    return lmb_vec3_length(lmb_vec3_scale(lmb_vec3_sub(bound->high, bound->low), 0.5f));
}

static void child_set(lmb_light_node *node, int k, const light_pair *pair, float power_of_all)
{
    const lmb_light_bound *bound = &pair->bound;
    const lmb_vec3 middle = bound_middle(bound);
    for (int axis = 0; axis < 3; ++axis) {
        node->middle[axis][k] = axis_of(middle, axis);
        node->axis[axis][k] = axis_of(bound->axis, axis);
    }
    node->radius[k] = bound_radius(bound);
    node->power[k] = bound->power / power_of_all;
    node->cos_spread[k] = bound->cos_spread;
    node->sin_spread[k] = sqrtf(lmb_larger(0.0f, (1.0f - bound->cos_spread) * (1.0f + bound->cos_spread)));
    node->cos_reach[k] = bound->cos_reach;
    node->inverse_range[k] = lmb_smaller(1.0f / bound->range, FLT_MAX);
    node->first_leaf[k] = pair->first_leaf;
    node->count[k] = pair->count;
}

/* Whether of two pairs the first is to be opened before the second: what promises more of its power from nearer than
 * it may be, then what has more lights. */
static bool pair_is_wider(const light_pair *a, const light_pair *b)
{
    const float radius[2] = {bound_radius(&a->bound), bound_radius(&b->bound)};
    const float wide[2] = {a->bound.power * radius[0] * radius[0], b->bound.power * radius[1] * radius[1]};
    return wide[0] > wide[1] || (!(wide[0] < wide[1]) && a->count > b->count);
}

/* Opens a pair into up to LMB_LIGHT_CHILDREN ones, the widest first. Returns how many. */
static int pair_open(const build *made, uint32_t opened, uint32_t child[LMB_LIGHT_CHILDREN])
{
    int count = 1;
    child[0] = opened;
    while (count < LMB_LIGHT_CHILDREN) {
        int widest = -1;
        for (int k = 0; k < count; ++k) {
            const light_pair *pair = &made->pair[child[k]];
            if (pair->second != 0 && (widest < 0 || pair_is_wider(pair, &made->pair[child[widest]]))) {
                widest = k;
            }
        }
        if (widest < 0) {
            break;
        }
        child[count++] = made->pair[child[widest]].second;
        ++child[widest];
    }
    return count;
}

/* Makes the node of a pair and all below it. */
static uint32_t node_make(build *made, uint32_t pair, uint32_t slot)
{
    lmb_light_tree *tree = made->tree;
    const uint32_t index = tree->node_count++;
    lmb_light_node *node = &tree->node[index];
    uint32_t child[LMB_LIGHT_CHILDREN];
    const int count = pair_open(made, pair, child);
    *node = (lmb_light_node){.slot = slot};
    for (int k = 0; k < count; ++k) {
        const light_pair *opened = &made->pair[child[k]];
        const uint32_t child_slot = index * LMB_LIGHT_CHILDREN + (uint32_t)k;
        child_set(node, k, opened, made->pair[0].bound.power);
        if (opened->second == 0) {
            tree->slot_of[tree->light[opened->first_leaf]] = child_slot;
        } else {
            node->inside[k] = node_make(made, child[k], child_slot);
        }
    }
    return index;
}

lmb_result lmb_light_tree_create(const lmb_light_bound *lights, uint32_t count, bool two_sided, lmb_light_tree **tree)
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
    created->two_sided = two_sided;
    build made = {.tree = created, .lights = lights};
    made.pair = malloc((2 * (size_t)count - 1) * sizeof *made.pair);
    created->node = malloc(count * sizeof *created->node); /* at most: each divides lights at least once */
    created->light = malloc(count * sizeof *created->light);
    created->slot_of = malloc(count * sizeof *created->slot_of);
    if (!made.pair || !created->node || !created->light || !created->slot_of) {
        free(made.pair);
        lmb_light_tree_destroy(created);
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < count; ++i) {
        created->light[i] = i;
    }
    pair_make(&made, 0, count);
    node_make(&made, 0, 0);
    free(made.pair);
    lmb_light_node *fitting = realloc(created->node, created->node_count * sizeof *created->node);
    created->node = fitting ? fitting : created->node;
    *tree = created;
    return LMB_OK;
}

void lmb_light_tree_destroy(lmb_light_tree *tree)
{
    if (tree) {
        free(tree->node);
        free(tree->light);
        free(tree->slot_of);
        free(tree);
    }
}

size_t lmb_light_tree_bytes(const lmb_light_tree *tree)
{
    return sizeof *tree + tree->node_count * sizeof *tree->node +
           tree->count * (sizeof *tree->light + sizeof *tree->slot_of);
}
