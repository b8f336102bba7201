/* The light tree's nodes, as light_tree_build.c makes them and light_tree.c walks them. */
#ifndef LMB_LIGHT_TREE_INTERNAL_H
#define LMB_LIGHT_TREE_INTERNAL_H

#include "light/light_tree.h"

/* Up to LMB_LIGHT_CHILDREN children, as a structure of arrays. Lanes past the last one have no power and no lights. */
typedef struct lmb_light_node {
    float middle[3][LMB_LIGHT_CHILDREN];
    float radius[LMB_LIGHT_CHILDREN]; /* of the sphere about the child's box */
    float axis[3][LMB_LIGHT_CHILDREN];
    float power[LMB_LIGHT_CHILDREN];                                      /* as a share of that of all lights */
    float cos_spread[LMB_LIGHT_CHILDREN], sin_spread[LMB_LIGHT_CHILDREN]; /* of the cone that the axes lie in */
    float cos_reach[LMB_LIGHT_CHILDREN];
    float inverse_range[LMB_LIGHT_CHILDREN]; /* of the longest */
    uint32_t inside[LMB_LIGHT_CHILDREN];     /* the child's node; 0: it is a single light */
    /* The lights below a child are light[first_leaf .. first_leaf + count - 1]. */
    uint32_t first_leaf[LMB_LIGHT_CHILDREN];
    uint32_t count[LMB_LIGHT_CHILDREN];
    uint32_t slot; /* that this is inside of; unused in the root */
} lmb_light_node;

/* A slot is a child of a node: child k of node n is slot n x LMB_LIGHT_CHILDREN + k. */
struct lmb_light_tree {
    lmb_light_node *node; /* the root first */
    uint32_t node_count;
    uint32_t *light;   /* [leaf] from left to right */
    uint32_t *slot_of; /* [light] */
    uint32_t count;
    bool two_sided;
};

#endif
