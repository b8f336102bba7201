/* Building a light tree: from the top, each node divided where the two halves together promise the least. */
#include <float.h>
#include <stdlib.h>

#include "bake_internal.h"
#include "light_tree_internal.h"

enum { BINS = 12 };

typedef struct build {
    lmb_light_tree *tree;
    const lmb_light_bound *lights;
    uint32_t node_count;
} build;

static float axis_of(lmb_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static lmb_vec3 bound_middle(const lmb_light_bound *bound)
{
    return vec3_mad(vec3_scale(bound->low, 0.5f), bound->high, 0.5f);
}

static double cone_angle(float cosine)
{
    return 2.0 * LMB_PI * (double)lmb_turn_of(cosine, sqrtf(float_larger(0.0f, (1.0f - cosine) * (1.0f + cosine))));
}

/* Makes a cone the smallest about itself and another; a two-sided one is its own opposite. */
static void cone_unite(lmb_light_bound *cone, const lmb_light_bound *other, bool two_sided)
{
    const float towards = vec3_dot(cone->axis, other->axis);
    const lmb_vec3 axis = two_sided && towards < 0.0f ? vec3_scale(other->axis, -1.0f) : other->axis;
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
    const lmb_vec3 across = vec3_mad(axis, cone->axis, -vec3_dot(cone->axis, axis));
    const bool in_line = !(vec3_length(across) > 1e-3f);
    const double spread = in_line ? fmax(mine, theirs) + apart : 0.5 * (mine + apart + theirs);
    if (spread >= LMB_PI) {
        cone->cos_spread = -1.0f;
        return;
    }
    double sine, cosine;
    if (!in_line) {
        const lmb_vec3 aside = vec3_normalize_or(across, cone->axis);
        lmb_sincos(spread - mine, &sine, &cosine);
        cone->axis = vec3_normalize_or(vec3_mad(vec3_scale(cone->axis, (float)cosine), aside, (float)sine), cone->axis);
    }
    lmb_sincos(spread, &sine, &cosine);
    cone->cos_spread = (float)cosine;
}

static void bound_unite(lmb_light_bound *bound, const lmb_light_bound *other, bool two_sided)
{
    bound->low = vec3_smaller(bound->low, other->low);
    bound->high = vec3_larger(bound->high, other->high);
    bound->power = float_smaller(bound->power + other->power, FLT_MAX);
    bound->cos_reach = float_smaller(bound->cos_reach, other->cos_reach);
    bound->range = float_larger(bound->range, other->range);
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
    to->low = vec3_smaller(to->low, added->low);
    to->high = vec3_larger(to->high, added->high);
    to->axes = vec3_add(to->axes, added->axes);
    to->power += added->power;
    to->cos_reach = float_smaller(to->cos_reach, added->cos_reach);
    to->count += added->count;
}

/* One light; two-sided ones are turned to the side of `up`. */
static bin bin_of(const lmb_light_bound *light, bool two_sided, lmb_vec3 up)
{
    const bool turned = two_sided && vec3_dot(light->axis, up) < 0.0f;
    const float length = 0.5f * (1.0f + light->cos_spread); /* of the mean axis of a cone */
    return (bin){.low = light->low,
                 .high = light->high,
                 .axes = vec3_scale(light->axis, turned ? -length : length),
                 .power = light->power,
                 .cos_reach = light->cos_reach,
                 .count = 1};
}

/* What a node promises too much: its power, by the square of its size and by about the solid angle that it may shine
 * into, weighted by the cosine: that of a single axis is a quarter of all. */
static double bin_cost(const bin *lights)
{
    const lmb_vec3 size = vec3_sub(lights->high, lights->low);
    const float even = vec3_length(lights->axes) / (float)lights->count;
    return (double)lights->power * (double)vec3_dot(size, size) *
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

/* Brings the lights of the first half of places first .. end - 1 to the front; returns where the second begins. */
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
            slices.low = float_smaller(slices.low, at);
            slices.high = float_larger(slices.high, at);
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

static void node_set(lmb_light_node *node, const lmb_light_bound *bound)
{
    const lmb_vec3 half = vec3_scale(vec3_sub(bound->high, bound->low), 0.5f);
    node->middle = bound_middle(bound);
    node->radius = vec3_length(half);
    node->axis = bound->axis;
    node->power = bound->power;
    node->cos_spread = bound->cos_spread;
    node->sin_spread = sqrtf(float_larger(0.0f, (1.0f - bound->cos_spread) * (1.0f + bound->cos_spread)));
    node->cos_reach = bound->cos_reach;
    node->range = bound->range;
}

/* Makes the node of places first .. end - 1 and all below it. */
static lmb_light_bound node_make(build *made, uint32_t parent, uint32_t first, uint32_t end)
{
    const uint32_t number = made->node_count++;
    lmb_light_node *node = &made->tree->node[number];
    *node = (lmb_light_node){.parent = parent, .first_place = first, .count = end - first};
    lmb_light_bound bound;
    if (end - first == 1) {
        bound = made->lights[made->tree->light[first]];
        made->tree->leaf_of[made->tree->light[first]] = number;
    } else {
        const uint32_t middle = lights_divide(made, first, end);
        bound = node_make(made, number, first, middle);
        node->second = made->node_count;
        const lmb_light_bound other = node_make(made, number, middle, end);
        bound_unite(&bound, &other, made->tree->two_sided);
    }
    node_set(node, &bound);
    return bound;
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
    created->node = malloc((2 * (size_t)count - 1) * sizeof *created->node);
    created->light = malloc(count * sizeof *created->light);
    created->leaf_of = malloc(count * sizeof *created->leaf_of);
    if (!created->node || !created->light || !created->leaf_of) {
        lmb_light_tree_destroy(created);
        return LMB_ERROR_MEMORY;
    }
    for (uint32_t i = 0; i < count; ++i) {
        created->light[i] = i;
    }
    build made = {.tree = created, .lights = lights};
    node_make(&made, 0, 0, count);
    *tree = created;
    return LMB_OK;
}

void lmb_light_tree_destroy(lmb_light_tree *tree)
{
    if (tree) {
        free(tree->node);
        free(tree->light);
        free(tree->leaf_of);
        free(tree);
    }
}
