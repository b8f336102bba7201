/* Choosing one of many lights by how much of it may arrive at a point, in time that grows with the logarithm of their
 * number.
 *
 * A binary tree over the lights in the order of a space-filling curve: a node covers a run of them and its two halves
 * are its children, so no links are stored. On the way down the child is chosen in proportion to its power over the
 * square of its distance (its own radius where that is larger, so that no child's chance is ever 0). After Conty
 * Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", without orientation. A
 * tenth of the choices are even: what is chosen by strength alone never finds a candle in a room whose walls keep the
 * sun out. */
#ifndef LMB_LIGHT_TREE_H
#define LMB_LIGHT_TREE_H

#include <stdint.h>

#include <lambent/error.h>
#include <lambent/types.h>

typedef struct lmb_light_bound {
    lmb_vec3 low, high; /* box that it lies in */
    float power;        /* > 0, finite */
} lmb_light_bound;

typedef struct lmb_light_tree lmb_light_tree;

/* @return LMB_ERROR_MEMORY. Without lights `*tree` is NULL. */
lmb_result lmb_light_tree_create(const lmb_light_bound *lights, uint32_t count, lmb_light_tree **tree);
void lmb_light_tree_destroy(lmb_light_tree *tree);

/* The light that `number` in [0, 1) chooses at a position, and the probability of that, > 0. Numbers that lie close
 * choose lights that lie close. */
uint32_t lmb_light_tree_choose(const lmb_light_tree *tree, lmb_vec3 position, double number, double *probability);

/* The probability with which that chooses `light`. */
double lmb_light_tree_probability(const lmb_light_tree *tree, lmb_vec3 position, uint32_t light);

#endif
