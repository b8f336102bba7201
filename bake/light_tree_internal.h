/* The light tree's nodes, as light_tree_build.c makes them and light_tree.c walks them. */
#ifndef LMB_LIGHT_TREE_INTERNAL_H
#define LMB_LIGHT_TREE_INTERNAL_H

#include "light_tree.h"

/* 64 bytes. Node i's first child is i + 1. */
typedef struct lmb_light_node {
    lmb_vec3 middle;
    float radius; /* of the sphere about its box */
    lmb_vec3 axis;
    float power;
    float cos_spread, sin_spread; /* half angle of the cone that the axes lie in */
    float cos_reach;
    float range;     /* the longest */
    uint32_t second; /* child; 0 for a leaf */
    uint32_t parent;
    uint32_t first_place; /* the lights below it are light[first_place .. first_place + count - 1] */
    uint32_t count;
} lmb_light_node;

struct lmb_light_tree {
    lmb_light_node *node; /* [2 count - 1] the root first */
    uint32_t *light;      /* [place] leaves from left to right */
    uint32_t *leaf_of;    /* [light] node */
    uint32_t count;
    bool two_sided;
};

#endif
