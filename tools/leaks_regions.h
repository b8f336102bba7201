/* Cells that geometry cuts into regions of free space: which there are, how they touch, and which planes tell them
 * apart. */
#ifndef LMB_TOOLS_LEAKS_REGIONS_H
#define LMB_TOOLS_LEAKS_REGIONS_H

#include "leaks_field.h"

/* A cell is looked at from nodes, SIDE along each axis, of which the outermost lie just within its faces. */
enum {
    REGION_NODE_SIDE = 6,
    REGION_NODES = REGION_NODE_SIDE * REGION_NODE_SIDE * REGION_NODE_SIDE,
    REGION_MOST = 8, /* in a cell; smaller ones are left out */
    REGION_PLANES = 6,
    REGION_SIGNS = 1 << REGION_PLANES,
    REGION_NONE = 255
};

/* normal . position = offset on it. */
typedef struct region_plane {
    lmb_vec3 normal;
    float offset;
} region_plane;

typedef struct region_cell {
    uint8_t label[REGION_NODES]; /* region of each node; REGION_NONE in a solid */
    uint8_t count;               /* of regions */
    uint8_t real[REGION_MOST];   /* bit i: corner i's probe is in the region */
    uint8_t plane_count;
    region_plane plane[REGION_PLANES];
    uint8_t region[REGION_SIGNS]; /* bit p of the index: on the far side of plane p. REGION_NONE: no free space */
} region_cell;

/* Coordinate of a node along an axis, 0 to 1. */
float region_node(int i);

/* A node's place in the world. */
lmb_vec3 region_node_point(const leaks_field *field, const int32_t at[3], int node);

/* Finds regions, planes and real corners of the cell `at`. */
void region_cell_find(const leaks_field *field, const int32_t at[3], region_cell *cell);

/* Which regions of two cells touch through the face between them: bit b of touching[a] for region a of `low`, which is
 * at `at`, and b of `high`, which is one further along `axis`. */
void region_cells_touch(const leaks_field *field, const int32_t at[3], int axis, const region_cell *low,
                        const region_cell *high, uint8_t touching[REGION_MOST]);

/* The region at a position in the cell, or REGION_NONE. */
uint8_t region_at(const region_cell *cell, lmb_vec3 position);

#endif
