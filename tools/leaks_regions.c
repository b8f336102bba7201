#include "leaks_regions.h"

#include <math.h>
#include <string.h>

#include <lambent/placement.h>
#include <lambent/surface.h>
#include <lambent/vector.h>

/* Share of a spacing that the outermost nodes keep from the faces. */
#define INSET 0.002f

/* Planes nearer to each other than that, in spacings, and of almost one normal, are one. */
#define SAME_PLANE_SPACINGS 0.002f
#define SAME_PLANE_COSINE 0.9995f

/* Where a ray from a node ends, so much of its way before a surface, is the node's region: what planes have to get
 * right is beside walls. */
#define BEFORE_SURFACE 0.02f

enum { MOST_CANDIDATES = 48, MOST_ENDS = 6 * REGION_NODES };

typedef struct candidates {
    region_plane plane[MOST_CANDIDATES];
    int votes[MOST_CANDIDATES]; /* pairs of nodes that it parts */
    int count;
    float same; /* metres */
    lmb_vec3 end[MOST_ENDS];
    int node[MOST_ENDS]; /* whose ray ended there */
    int end_count;
} candidates;

float region_node(int i)
{
    return i == 0 ? INSET : i == REGION_NODE_SIDE - 1 ? 1.0f - INSET : (float)i / (REGION_NODE_SIDE - 1);
}

lmb_vec3 region_node_point(const leaks_field *field, const int32_t at[3], int node)
{
    return leaks_cell_point(field, at, region_node(node % REGION_NODE_SIDE),
                            region_node(node / REGION_NODE_SIDE % REGION_NODE_SIDE),
                            region_node(node / (REGION_NODE_SIDE * REGION_NODE_SIDE)));
}

/* --- planes ---------------------------------------------------------------------------------------------------- */

static void candidate_add(candidates *all, region_plane plane)
{
    for (int i = 0; i < all->count; ++i) {
        const float cosine = lmb_vec3_dot(all->plane[i].normal, plane.normal), side = cosine < 0.0f ? -1.0f : 1.0f;
        if (fabsf(cosine) > SAME_PLANE_COSINE && fabsf(all->plane[i].offset - side * plane.offset) < all->same) {
            ++all->votes[i];
            return;
        }
    }
    if (all->count < MOST_CANDIDATES) {
        all->votes[all->count] = 1;
        all->plane[all->count++] = plane;
    }
}

/* Whether one node sees the other; the planes of what is met from either side are candidates. */
static bool node_sees(const lmb_tracer *tracer, const lmb_vec3 *point, const int pair[2], candidates *all)
{
    bool seen = true;
    for (int way = 0; way < 2; ++way) {
        lmb_hit hit;
        const lmb_vec3 start = point[pair[way]], ray = lmb_vec3_sub(point[pair[1 - way]], start);
        if (lmb_trace_nearest(tracer, start, ray, 0.0f, 1.0f, &hit)) {
            all->node[all->end_count] = pair[way];
            all->end[all->end_count++] = lmb_vec3_mad(start, ray, (1.0f - BEFORE_SURFACE) * hit.distance);
            const lmb_place place = lmb_trace_place(tracer, &hit);
            candidate_add(all,
                          (region_plane){place.geometric_normal, lmb_vec3_dot(place.geometric_normal, place.position)});
            seen = false;
        }
    }
    return seen;
}

static int signs_at(const region_plane *plane, int count, lmb_vec3 position)
{
    int signs = 0;
    for (int i = 0; i < count; ++i) {
        signs |= (lmb_vec3_dot(plane[i].normal, position) > plane[i].offset) << i;
    }
    return signs;
}

/* How many nodes, and ends of their rays, of each region are on each side of the planes. */
typedef struct census {
    int nodes[REGION_SIGNS][REGION_MOST];
} census;

static census census_of(const region_cell *cell, const lmb_vec3 *point, const candidates *candidate, int planes)
{
    census all = {{{0}}};
    for (int node = 0; node < REGION_NODES; ++node) {
        if (cell->label[node] != REGION_NONE) {
            ++all.nodes[signs_at(cell->plane, planes, point[node])][cell->label[node]];
        }
    }
    for (int i = 0; i < candidate->end_count; ++i) {
        const uint8_t label = cell->label[candidate->node[i]];
        if (label != REGION_NONE) {
            ++all.nodes[signs_at(cell->plane, planes, candidate->end[i])][label];
        }
    }
    return all;
}

/* How mixed the sides of the planes are: Gini's impurity, of each side by its nodes. Other than the number of nodes
 * that would be taken for another region's, it falls with the first of several planes that only together part anything.
 */
static double census_impurity(const census *all)
{
    double impurity = 0.0;
    for (int signs = 0; signs < REGION_SIGNS; ++signs) {
        double sum = 0.0, squares = 0.0;
        for (int region = 0; region < REGION_MOST; ++region) {
            const double nodes = all->nodes[signs][region];
            sum += nodes;
            squares += nodes * nodes;
        }
        impurity += sum > 0.0 ? sum - squares / sum : 0.0;
    }
    return impurity;
}

/* Takes the planes one by one that part the most, as long as they part anything. */
static void planes_choose(region_cell *cell, const lmb_vec3 *point, const candidates *all)
{
    const double least = 1e-6; /* of rounding */
    census now = census_of(cell, point, all, 0);
    double impurity = census_impurity(&now);
    while (impurity > least && cell->plane_count < REGION_PLANES) {
        int best = -1;
        double best_left = impurity - least;
        for (int i = 0; i < all->count; ++i) {
            cell->plane[cell->plane_count] = all->plane[i];
            now = census_of(cell, point, all, cell->plane_count + 1);
            const double left = census_impurity(&now);
            if (left < best_left || (best >= 0 && left <= best_left && all->votes[i] > all->votes[best])) {
                best = i;
                best_left = left;
            }
        }
        if (best < 0) {
            break;
        }
        cell->plane[cell->plane_count++] = all->plane[best];
        impurity = best_left;
    }
}

/* What each side of the planes is: the region that has most nodes there; where there are none, that of the side which
 * differs in the fewest planes. */
static void sides_name(region_cell *cell, const lmb_vec3 *point, const candidates *candidate)
{
    const census all = census_of(cell, point, candidate, cell->plane_count);
    for (int signs = 0; signs < REGION_SIGNS; ++signs) {
        int best = 0;
        cell->region[signs] = REGION_NONE;
        for (int other = 0; other < REGION_SIGNS; ++other) {
            int nearness = REGION_PLANES;
            for (int differ = signs ^ other; differ; differ &= differ - 1) {
                --nearness;
            }
            for (int region = 0; region < cell->count; ++region) {
                const int nodes = all.nodes[other][region], rank = nodes > 0 ? (nearness << 16) + nodes : 0;
                if (rank > best) {
                    best = rank;
                    cell->region[signs] = (uint8_t)region;
                }
            }
        }
    }
}

uint8_t region_at(const region_cell *cell, lmb_vec3 position)
{
    return cell->region[signs_at(cell->plane, cell->plane_count, position)];
}

/* --- regions ------------------------------------------------------------------------------------------------------ */

/* Bit 0, 1, 2 of a node: it sees the next one along x, y, z. */
static void nodes_link(const lmb_tracer *tracer, const lmb_vec3 *point, uint8_t *link, candidates *all)
{
    static const int stride[3] = {1, REGION_NODE_SIDE, REGION_NODE_SIDE * REGION_NODE_SIDE};
    for (int node = 0; node < REGION_NODES; ++node) {
        link[node] = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (node / stride[axis] % REGION_NODE_SIDE < REGION_NODE_SIDE - 1 &&
                node_sees(tracer, point, (const int[2]){node, node + stride[axis]}, all)) {
                link[node] |= (uint8_t)(1u << axis);
            }
        }
    }
}

/* Labels the nodes that are linked to the first one. @return how many */
static int flood(const uint8_t *link, int first, uint8_t name, uint8_t *label)
{
    static const int stride[3] = {1, REGION_NODE_SIDE, REGION_NODE_SIDE * REGION_NODE_SIDE};
    int stack[REGION_NODES], depth = 0, nodes = 0;
    label[first] = name;
    stack[depth++] = first;
    while (depth > 0) {
        const int node = stack[--depth];
        ++nodes;
        for (int axis = 0; axis < 3; ++axis) {
            const int along = node / stride[axis] % REGION_NODE_SIDE, above = node + stride[axis],
                      below = node - stride[axis];
            if (along < REGION_NODE_SIDE - 1 && (link[node] >> axis & 1) && label[above] == REGION_NONE) {
                label[above] = name;
                stack[depth++] = above;
            }
            if (along > 0 && (link[below] >> axis & 1) && label[below] == REGION_NONE) {
                label[below] = name;
                stack[depth++] = below;
            }
        }
    }
    return nodes;
}

static void regions_find(const leaks_field *field, const lmb_vec3 *point, const uint8_t *link, region_cell *cell)
{
    enum { DONE = REGION_NONE - 1 };
    uint8_t found[REGION_NODES];
    memset(found, REGION_NONE, sizeof found);
    for (int node = 0; node < REGION_NODES; ++node) {
        uint64_t rays = 0;
        if (found[node] != REGION_NONE) {
            continue;
        }
        flood(link, node, DONE, found);
        if (cell->count < REGION_MOST && lmb_placement_is_free(field->level->tracer, point[node], &rays)) {
            flood(link, node, cell->count++, cell->label);
        }
    }
}

/* Whether a corner's probe is seen from one of the region's nodes that are nearest to it. */
static bool corner_is_real(const leaks_field *field, const region_cell *cell, const lmb_vec3 *point, int region,
                           lmb_vec3 place)
{
    enum { TRIED = 6 };
    bool tried[REGION_NODES] = {false};
    for (int i = 0; i < TRIED; ++i) {
        int best = -1;
        float best_distance = 0.0f;
        for (int node = 0; node < REGION_NODES; ++node) {
            const lmb_vec3 way = lmb_vec3_sub(point[node], place);
            const float distance = lmb_vec3_dot(way, way);
            if (cell->label[node] == region && !tried[node] && (best < 0 || distance < best_distance)) {
                best = node;
                best_distance = distance;
            }
        }
        if (best < 0) {
            return false;
        }
        tried[best] = true;
        if (leaks_sees(field->level->tracer, point[best], place)) {
            return true;
        }
    }
    return false;
}

void region_cell_find(const leaks_field *field, const int32_t at[3], region_cell *cell)
{
    lmb_vec3 point[REGION_NODES];
    uint8_t link[REGION_NODES];
    candidates planes = {.same = SAME_PLANE_SPACINGS * field->probes->level[0].lattice.spacing};
    memset(cell, 0, sizeof *cell);
    memset(cell->label, REGION_NONE, sizeof cell->label);
    for (int node = 0; node < REGION_NODES; ++node) {
        point[node] = region_node_point(field, at, node);
    }
    nodes_link(field->level->tracer, point, link, &planes);
    regions_find(field, point, link, cell);
    const leaks_cell corners = leaks_cell_at(field, at);
    for (int region = 0; region < cell->count; ++region) {
        for (int i = 0; i < 8; ++i) {
            const bool real = leaks_probe_is_valid(field, corners.probe[i]) &&
                              corner_is_real(field, cell, point, region, field->place[corners.probe[i]]);
            cell->real[region] |= (uint8_t)(real << i);
        }
    }
    planes_choose(cell, point, &planes);
    sides_name(cell, point, &planes);
}

void region_cells_touch(const leaks_field *field, const int32_t at[3], int axis, const region_cell *low,
                        const region_cell *high, uint8_t touching[REGION_MOST])
{
    static const int stride[3] = {1, REGION_NODE_SIDE, REGION_NODE_SIDE * REGION_NODE_SIDE};
    int32_t next[3] = {at[0], at[1], at[2]};
    ++next[axis];
    memset(touching, 0, REGION_MOST);
    for (int node = 0; node < REGION_NODES; ++node) {
        if (node / stride[axis] % REGION_NODE_SIDE != 0) {
            continue;
        }
        const int last = node + (REGION_NODE_SIDE - 1) * stride[axis];
        const uint8_t a = low->label[last], b = high->label[node];
        if (a != REGION_NONE && b != REGION_NONE && !(touching[a] >> b & 1) &&
            leaks_sees(field->level->tracer, region_node_point(field, at, last),
                       region_node_point(field, next, node))) {
            touching[a] |= (uint8_t)(1u << b);
        }
    }
}
