/* Choosing one of many lights by how much of it may arrive at a point, in time that grows with the logarithm of their
 * number.
 *
 * A tree over the lights. A node knows of each of its children the box that the lights lie in, their power, and a cone
 * that their axes lie in; on the way down the child is chosen in proportion to a bound of what it can give. After Conty
 * Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", with eight children in
 * place of two, which are looked at together. */
#ifndef LMB_LIGHT_TREE_H
#define LMB_LIGHT_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/error.h>
#include <lambent/types.h>

/* A light that shines by the cosine to its axis, up to the angle `reach` from it. */
typedef struct lmb_light_bound {
    lmb_vec3 low, high; /* box that it lies in */
    float power;        /* > 0, finite; beside the others' */
    lmb_vec3 axis;      /* unit */
    float cos_spread;   /* axes lie within this angle of `axis`: 1 for one axis, -1 for a light without */
    float cos_reach;
    float range; /* metres, of KHR_lights_punctual's window; INFINITY: without */
} lmb_light_bound;

typedef struct lmb_light_tree lmb_light_tree;

/* `two_sided`: lights shine to both sides of their axis. @return LMB_ERROR_MEMORY. Without lights `*tree` is NULL. */
lmb_result lmb_light_tree_create(const lmb_light_bound *lights, uint32_t count, bool two_sided, lmb_light_tree **tree);
void lmb_light_tree_destroy(lmb_light_tree *tree);

size_t lmb_light_tree_bytes(const lmb_light_tree *tree);

/* How a node's children are chosen from a position: the probability of child k and those before it. The last is 1. */
enum { LMB_LIGHT_CHILDREN = 8 };
typedef struct lmb_light_shares {
    double up_to[LMB_LIGHT_CHILDREN];
} lmb_light_shares;

/* Shares of one query at some of a tree's nodes, so that asking again and again from one position costs little. `node`
 * is all 0 at first. */
enum { LMB_LIGHT_MEMO = 64 };
typedef struct lmb_light_memo {
    uint32_t node[LMB_LIGHT_MEMO]; /* a node's index + 1 */
    lmb_light_shares shares[LMB_LIGHT_MEMO];
} lmb_light_memo;

/* Where light is to arrive. */
typedef struct lmb_light_query {
    lmb_vec3 position;
    const lmb_vec3 *normal; /* unit; lights behind this plane give nothing. NULL: a point in space */
    float min_distance;     /* nearer lights count as this far */
    lmb_light_memo *memo;   /* of this position and this tree; NULL: none */
} lmb_light_query;

/* Share of the choices that any light that gives light has the same chance of. What is chosen by strength alone never
 * finds a candle in a room whose walls keep the sun out; this bounds how much rarer than any other it is chosen. */
#define LMB_LIGHT_EVEN_SHARE 0.1

/* The light that `u` in [0, 1) chooses, and the probability of that. It is never 0, whatever the bounds say. */
uint32_t lmb_light_tree_choose(const lmb_light_tree *tree, const lmb_light_query *query, double u, double *probability);

/* The probability with which that chooses `light`. */
double lmb_light_tree_probability(const lmb_light_tree *tree, const lmb_light_query *query, uint32_t light);

/* Divides the lights into at most `max` <= LMB_LIGHT_CLUSTERS clusters, those that may give most into the smallest,
 * down to single lights. Lights that cannot give any are in none; bounds are wide enough for rounding not to leave out
 * others. Returns how many there are. */
enum { LMB_LIGHT_CLUSTERS = 32 };
int lmb_light_tree_split(const lmb_light_tree *tree, const lmb_light_query *query, int max, uint32_t *cluster);

/* Sets `*light` to the lights of a cluster; returns how many they are. */
uint32_t lmb_light_tree_cluster(const lmb_light_tree *tree, uint32_t cluster, const uint32_t **light);

/* lmb_light_tree_choose within a cluster. */
uint32_t lmb_light_tree_choose_in(const lmb_light_tree *tree, uint32_t cluster, const lmb_light_query *query, double u,
                                  double *probability);

#endif
