/* Interpolation in regions: after the virtual nodes of cutting simulations (Molino, Bao and Fedkiw 2004, "A Virtual
 * Node Algorithm for Changing Mesh Topology During Simulation").
 *
 * Each region of a cell has eight values, one a corner. Where regions of neighbouring cells touch, the values at the
 * corners that they share are one: what is left is a number of values, each at a point of the lattice. One that any of
 * its regions can see the probe of is that probe; the others, ghosts, are fitted to light that is gathered inside the
 * regions. So light is continuous wherever one can walk within cells, and breaks at walls. */
#include <stdlib.h>
#include <string.h>

#include "leaks_fit.h"
#include "leaks_methods.h"
#include "leaks_regions.h"

enum { GATHERED_IN_REGION = 6 };

/* How much a ghost is held to its neighbours, where gathered light counts 1. */
#define HOLD 0.1f

#define NO_VALUE UINT32_MAX

/* A probe as a file holds it: 27 halfs. */
enum { PROBE_BYTES = 54 };

typedef struct regions {
    const leaks_field *field;
    int32_t along[3];
    size_t cell_count;
    region_cell *cell;
    uint32_t *first;      /* [cell + 1] of its regions */
    uint32_t *root;       /* [region * 8 + corner] a parent in the forest of corners that are one */
    uint32_t (*value)[8]; /* [region][corner] index of its light */
    lmb_sh3_rgb *light;   /* probes', then ghosts' */
    uint32_t light_count;
} regions;

/* Light gathered in a region. */
typedef struct region_point {
    lmb_vec3 position;
    uint32_t region;
    float t[3];
} region_point;

static void cell_place(const regions *all, size_t index, int32_t at[3])
{
    at[0] = (int32_t)(index % (size_t)all->along[0]);
    at[1] = (int32_t)(index / (size_t)all->along[0] % (size_t)all->along[1]);
    at[2] = (int32_t)(index / ((size_t)all->along[0] * (size_t)all->along[1]));
}

static size_t cell_index(const regions *all, const int32_t at[3])
{
    return (size_t)at[0] + (size_t)all->along[0] * ((size_t)at[1] + (size_t)all->along[1] * (size_t)at[2]);
}

static void cells_find(void *context, size_t index, int worker)
{
    (void)worker;
    regions *const all = context;
    int32_t at[3];
    cell_place(all, index, at);
    region_cell_find(all->field, at, &all->cell[index]);
}

/* --- which corners are one --------------------------------------------------------------------------------------- */

static uint32_t root_of(uint32_t *root, uint32_t i)
{
    while (root[i] != i) {
        i = root[i] = root[root[i]];
    }
    return i;
}

/* The four corners of the face between a region and one of the next cell along the axis. */
static void corners_unite(regions *all, uint32_t low, uint32_t high, int axis)
{
    for (uint32_t i = 0; i < 8; ++i) {
        if (!(i >> axis & 1u)) {
            const uint32_t a = root_of(all->root, 8 * low + (i | 1u << axis)), b = root_of(all->root, 8 * high + i);
            all->root[a > b ? a : b] = a > b ? b : a;
        }
    }
}

static void regions_unite(regions *all)
{
    for (size_t index = 0; index < all->cell_count; ++index) {
        int32_t at[3];
        cell_place(all, index, at);
        for (int axis = 0; axis < 3; ++axis) {
            int32_t next[3] = {at[0], at[1], at[2]};
            if (++next[axis] >= all->along[axis]) {
                continue;
            }
            const size_t other = cell_index(all, next);
            uint8_t touching[REGION_MOST];
            region_cells_touch(all->field, at, axis, &all->cell[index], &all->cell[other], touching);
            for (uint32_t a = 0; a < all->cell[index].count; ++a) {
                for (uint32_t b = 0; b < all->cell[other].count; ++b) {
                    if (touching[a] >> b & 1) {
                        corners_unite(all, all->first[index] + a, all->first[other] + b, axis);
                    }
                }
            }
        }
    }
}

/* Gives each group of corners its probe, or a ghost. `of_root` has room for all corners. */
static void values_name(regions *all, uint32_t *of_root)
{
    const uint32_t corners = 8 * all->first[all->cell_count];
    memset(of_root, 0xff, corners * sizeof *of_root);
    for (size_t index = 0; index < all->cell_count; ++index) {
        int32_t at[3];
        cell_place(all, index, at);
        const leaks_cell cell = leaks_cell_at(all->field, at);
        for (uint32_t i = 0; i < 8u * all->cell[index].count; ++i) {
            if (all->cell[index].real[i / 8] >> i % 8 & 1) {
                of_root[root_of(all->root, 8 * all->first[index] + i)] = (uint32_t)cell.probe[i % 8];
            }
        }
    }
    all->light_count = (uint32_t)all->field->probes->count;
    for (uint32_t i = 0; i < corners; ++i) {
        uint32_t *const value = &of_root[root_of(all->root, i)];
        if (*value == NO_VALUE) {
            *value = all->light_count++;
        }
        all->value[i / 8][i % 8] = *value;
    }
}

/* --- fitting ghosts ------------------------------------------------------------------------------------------------
 */

static bool has_ghosts(const regions *all, uint32_t region)
{
    bool ghosts = false;
    for (int i = 0; i < 8; ++i) {
        ghosts |= all->value[region][i] >= (uint32_t)all->field->probes->count;
    }
    return ghosts;
}

/* Nodes of each region that has ghosts, spread evenly over its list of them. @return how many */
static size_t points_choose(const regions *all, region_point *point)
{
    size_t count = 0;
    for (size_t index = 0; index < all->cell_count; ++index) {
        const region_cell *cell = &all->cell[index];
        int32_t at[3];
        cell_place(all, index, at);
        for (uint32_t region = 0; region < cell->count; ++region) {
            int node[REGION_NODES], nodes = 0;
            for (int i = 0; i < REGION_NODES; ++i) {
                node[nodes] = i;
                nodes += cell->label[i] == region;
            }
            const int wanted = nodes < GATHERED_IN_REGION ? nodes : GATHERED_IN_REGION;
            for (int i = 0; i < wanted && has_ghosts(all, all->first[index] + region); ++i) {
                const int chosen = node[(2 * i + 1) * nodes / (2 * wanted)];
                point[count++] = (region_point){
                    .position = region_node_point(all->field, at, chosen),
                    .region = all->first[index] + region,
                    .t = {region_node(chosen % REGION_NODE_SIDE),
                          region_node(chosen / REGION_NODE_SIDE % REGION_NODE_SIDE),
                          region_node(chosen / (REGION_NODE_SIDE * REGION_NODE_SIDE))},
                };
            }
        }
    }
    return count;
}

/* Adds a term; known light goes to the right. */
static void equation_add(const regions *all, leaks_equation *equation, uint32_t value, float weight)
{
    const uint32_t probes = (uint32_t)all->field->probes->count;
    if (value >= probes) {
        equation->unknown[equation->count] = value - probes;
        equation->weight[equation->count++] = weight;
        return;
    }
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < LMB_SH3_COUNT; ++k) {
            equation->right.channel[c].c[k] -= weight * all->light[value].channel[c].c[k];
        }
    }
}

/* What is gathered in a region is what its corners give there. */
static size_t equations_of_light(const regions *all, const region_point *point, const lmb_gathered *gathered,
                                 size_t count, leaks_equation *equation)
{
    for (size_t i = 0; i < count; ++i) {
        float weight[8];
        leaks_weights(point[i].t, weight);
        equation[i] = (leaks_equation){.count = 0, .right = gathered[i].moments};
        for (int corner = 0; corner < 8; ++corner) {
            equation_add(all, &equation[i], all->value[point[i].region][corner], weight[corner]);
        }
    }
    return count;
}

/* A ghost is about what its neighbours in the region are. */
static size_t equations_of_ghosts(const regions *all, leaks_equation *equation)
{
    const uint32_t probes = (uint32_t)all->field->probes->count;
    size_t count = 0;
    for (uint32_t region = 0; region < all->first[all->cell_count]; ++region) {
        for (uint32_t edge = 0; edge < 12; ++edge) {
            /* The four corners whose bit of that axis is 0. */
            const uint32_t axis = edge / 4, k = edge % 4, below = (1u << axis) - 1u;
            const uint32_t low = (k & below) | (k & ~below) << 1, high = low | 1u << axis;
            const uint32_t a = all->value[region][low], b = all->value[region][high];
            if ((a >= probes || b >= probes) && a != b) {
                equation[count] = (leaks_equation){.count = 0};
                equation_add(all, &equation[count], a, HOLD);
                equation_add(all, &equation[count++], b, -HOLD);
            }
        }
    }
    return count;
}

static void point_site(const void *context, size_t element, lmb_gather_site *site)
{
    site->point[0] = (lmb_gather_point){.position = ((const region_point *)context)[element].position};
    site->count = 1;
}

static lmb_result light_gather(const regions *all, const region_point *point, size_t count, lmb_gathered *gathered)
{
    const lmb_gather_list list = {
        .name = "regions", .count = count, .most_points = 1, .find_site = point_site, .context = point};
    const lmb_gather_job job = lmb_gather_job_all(&all->field->level->transport, &list, &all->field->effort);
    lmb_gather_stats stats = {0};
    return count > 0 ? lmb_gather_elements(&job, all->field->level->pool, NULL, gathered, &stats) : LMB_OK;
}

static lmb_result ghosts_fit(regions *all)
{
    const size_t region_count = all->first[all->cell_count], probes = (size_t)all->field->probes->count;
    const size_t most = region_count * GATHERED_IN_REGION + 1;
    region_point *const point = malloc(most * sizeof *point);
    lmb_gathered *const gathered = malloc(most * sizeof *gathered);
    leaks_equation *const equation = malloc((most + 12 * region_count) * sizeof *equation);
    all->light = calloc((size_t)all->light_count + 1, sizeof *all->light);
    lmb_result result = LMB_ERROR_MEMORY;
    if (point && gathered && equation && all->light) {
        memcpy(all->light, all->field->probes->radiance[0], probes * sizeof *all->light);
        const size_t points = points_choose(all, point);
        result = light_gather(all, point, points, gathered);
        if (result == LMB_OK) {
            size_t count = equations_of_light(all, point, gathered, points, equation);
            count += equations_of_ghosts(all, equation + count);
            result = leaks_fit(equation, count, all->light + probes, all->light_count - probes);
        }
    }
    free(point);
    free(gathered);
    free(equation);
    return result;
}

/* --- the method ----------------------------------------------------------------------------------------------------
 */

static void regions_release(void *state)
{
    regions *const all = state;
    free(all->cell);
    free(all->first);
    free(all->root);
    free(all->value);
    free(all->light);
    free(all);
}

static lmb_result corners_make(regions *all)
{
    all->first[0] = 0;
    for (size_t i = 0; i < all->cell_count; ++i) {
        all->first[i + 1] = all->first[i] + all->cell[i].count;
    }
    const uint32_t corners = 8 * all->first[all->cell_count];
    all->root = malloc((corners + 1) * sizeof *all->root);
    all->value = malloc(((size_t)all->first[all->cell_count] + 1) * sizeof *all->value);
    uint32_t *const of_root = malloc((corners + 1) * sizeof *of_root);
    if (all->root && all->value && of_root) {
        for (uint32_t i = 0; i < corners; ++i) {
            all->root[i] = i;
        }
        regions_unite(all);
        values_name(all, of_root);
    }
    free(of_root);
    return all->root && all->value && of_root ? ghosts_fit(all) : LMB_ERROR_MEMORY;
}

/* A cell that nothing cuts is what it was. Of one that is cut, planes (halfs of normal and offset), what their sides
 * are, and eight indices a region; an index a cell to that; ghosts as probes. */
static size_t bytes_of(const regions *all)
{
    size_t bytes = all->field->packed_bytes + all->cell_count * sizeof(uint32_t) +
                   (size_t)(all->light_count - (uint32_t)all->field->probes->count) * PROBE_BYTES;
    for (size_t i = 0; i < all->cell_count; ++i) {
        const region_cell *cell = &all->cell[i];
        if (cell->count > 1 || (cell->count == 1 && has_ghosts(all, all->first[i]))) {
            bytes += REGION_SIGNS + cell->plane_count * 4 * sizeof(uint16_t) + cell->count * 8 * sizeof(uint32_t);
        }
    }
    return bytes;
}

static lmb_result regions_prepare(const leaks_field *field, void **state, size_t *bytes)
{
    regions *const all = calloc(1, sizeof *all);
    if (!all) {
        return LMB_ERROR_MEMORY;
    }
    all->field = field;
    leaks_cells_along(field, all->along);
    all->cell_count = (size_t)all->along[0] * (size_t)all->along[1] * (size_t)all->along[2];
    all->cell = malloc(all->cell_count * sizeof *all->cell);
    all->first = malloc((all->cell_count + 1) * sizeof *all->first);
    lmb_result result = LMB_ERROR_MEMORY;
    if (all->cell && all->first) {
        result = lmb_pool_run(field->level->pool, all->cell_count, cells_find, all, "regions", NULL);
    }
    if (result == LMB_OK) {
        result = corners_make(all);
    }
    if (result != LMB_OK) {
        regions_release(all);
        return result;
    }
    *state = all;
    *bytes = bytes_of(all);
    return LMB_OK;
}

static void regions_sample(const void *state, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance)
{
    (void)normal;
    const regions *all = state;
    const leaks_cell cell = leaks_cell_of(all->field, position);
    const size_t index = cell_index(all, cell.at);
    const uint8_t region = region_at(&all->cell[index], position);
    if (region == REGION_NONE) {
        lmb_volume_sample(all->field->volume, position, radiance);
        return;
    }
    float weight[8];
    leaks_weights(cell.t, weight);
    *radiance = (lmb_sh3_rgb){.channel = {{.c = {0.0f}}}};
    for (int i = 0; i < 8; ++i) {
        const lmb_sh3_rgb *light = &all->light[all->value[all->first[index] + region][i]];
        for (int c = 0; c < 3; ++c) {
            for (int k = 0; k < LMB_SH3_COUNT; ++k) {
                radiance->channel[c].c[k] += weight[i] * light->channel[c].c[k];
            }
        }
    }
}

const leaks_method leaks_regions = {
    .name = "regions",
    .about = "cells in regions, eight values each: probes, or ghosts fitted to light inside",
    .prepare = regions_prepare,
    .sample = regions_sample,
    .release = regions_release,
};
