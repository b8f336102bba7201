#include "surface/bright_cells.h"

#include <math.h>
#include <stdlib.h>

#include <lambent/surface.h>
#include <lambent/vector.h>

/* Bright is what reflects so many times the mean. This and the next by lambent_convergence, `cached without aimed
 * cells`. */
#define BRIGHT_TIMES 8.0

/* Aiming pays when bright cells reflect this share of all light, or more. */
#define WORTH_SHARE 0.1

/* A patch, and what it takes to pick a point of its cell. */
typedef struct bright_cell {
    lmb_cell_part part;
    lmb_vec3 apex;    /* of the triangle */
    lmb_vec3 edge[2]; /* from there to its other corners */
    lmb_vec3 normal;  /* unit, of the side */
    float area;       /* of the cell, square metres */
    uint32_t patch;
} bright_cell;

struct lmb_bright_cells {
    uint32_t count;
    bright_cell *cell; /* by rising patches */
    float least;       /* luminance that a bright cell has at least */
    lmb_light_tree *tree;
};

static double patch_luminance(const lmb_surface_light *light, uint32_t patch)
{
    const double luminance = (double)lmb_luminance(light->radiance[patch]);
    return light->openness[patch] != LMB_CELL_HIDDEN && isfinite(luminance) ? luminance : 0.0;
}

typedef struct bright_sums {
    double power, area;
    uint32_t count;
} bright_sums;

/* Over all patches of a luminance above `least`. */
static bright_sums sums_above(const lmb_surface_light *light, const lmb_tracer *tracer, double least)
{
    bright_sums sums = {0.0, 0.0, 0};
    for (uint32_t patch = 0; patch < lmb_patch_count(light); ++patch) {
        const double luminance = patch_luminance(light, patch);
        if (luminance > least) {
            const lmb_cell cell = lmb_cell_find(light, lmb_patch_side(light, patch) / 2);
            const double area = (double)lmb_patch_area(light, tracer, &cell, patch);
            sums.power += luminance * area;
            sums.area += area;
            ++sums.count;
        }
    }
    return sums;
}

static bright_cell bright_cell_make(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_cell *cell,
                                    uint32_t patch)
{
    const lmb_place place = lmb_trace_place(
        tracer, &(lmb_hit){.instance = cell->instance, .triangle = cell->triangle, .u = 0.0f, .v = 0.0f});
    lmb_vec3 corner[3];
    lmb_trace_corners(tracer, cell->instance, cell->triangle, corner);
    const lmb_vec3 *apex = &corner[cell->grid->apex];
    return (bright_cell){
        .part = lmb_cell_part_of(cell),
        .apex = *apex,
        .edge = {lmb_vec3_sub(corner[(cell->grid->apex + 1) % 3], *apex),
                 lmb_vec3_sub(corner[(cell->grid->apex + 2) % 3], *apex)},
        .normal = lmb_vec3_scale(place.geometric_normal, lmb_patch_side(light, patch) % 2 == 0 ? 1.0f : -1.0f),
        .area = lmb_cell_area(cell, tracer),
        .patch = patch};
}

static lmb_vec3 bright_cell_point(const bright_cell *cell, const float u[2])
{
    float along, across;
    lmb_cell_part_point(&cell->part, u, &along, &across);
    return lmb_vec3_mad(lmb_vec3_mad(cell->apex, cell->edge[0], along * (1.0f - across)), cell->edge[1],
                        along * across);
}

static lmb_light_bound cell_bound(const bright_cell *cell, float power)
{
    static const float corners[4][2] = {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {1.0f, 1.0f}};
    lmb_light_bound bound = {.low = lmb_vec3_of(INFINITY, INFINITY, INFINITY),
                             .high = lmb_vec3_of(-INFINITY, -INFINITY, -INFINITY),
                             .power = power,
                             .axis = cell->normal,
                             .cos_spread = 1.0f,
                             .cos_reach = 0.0f,
                             .range = INFINITY};
    for (int i = 0; i < 4; ++i) {
        const lmb_vec3 corner = bright_cell_point(cell, corners[i]);
        bound.low = lmb_vec3_smaller(bound.low, corner);
        bound.high = lmb_vec3_larger(bound.high, corner);
    }
    return bound;
}

static void cells_take(lmb_bright_cells *bright, const lmb_surface_light *light, const lmb_tracer *tracer,
                       lmb_light_bound *bounds)
{
    for (uint32_t patch = 0; patch < lmb_patch_count(light); ++patch) {
        const double luminance = patch_luminance(light, patch);
        if (!(luminance > (double)bright->least)) {
            continue;
        }
        const lmb_cell cell = lmb_cell_find(light, lmb_patch_side(light, patch) / 2);
        const float power = (float)luminance * lmb_patch_area(light, tracer, &cell, patch);
        if (power > 0.0f && isfinite(power)) {
            bright_cell *taken = &bright->cell[bright->count];
            *taken = bright_cell_make(light, tracer, &cell, patch);
            bounds[bright->count++] = cell_bound(taken, power);
        }
    }
}

lmb_result lmb_bright_cells_create(const lmb_surface_light *light, const lmb_tracer *tracer, lmb_bright_cells **bright)
{
    *bright = NULL;
    const bright_sums all = sums_above(light, tracer, 0.0);
    const double least = all.area > 0.0 ? BRIGHT_TIMES * all.power / all.area : 0.0;
    const bright_sums found = sums_above(light, tracer, (double)(float)least);
    if (!(found.power > WORTH_SHARE * all.power)) {
        return LMB_OK;
    }
    lmb_bright_cells *created = calloc(1, sizeof *created);
    lmb_light_bound *bounds = malloc(found.count * sizeof *bounds);
    lmb_result result = LMB_ERROR_MEMORY;
    if (created) {
        created->least = (float)least;
        created->cell = malloc(found.count * sizeof *created->cell);
    }
    if (created && created->cell && bounds) {
        cells_take(created, light, tracer, bounds);
        result = lmb_light_tree_create(bounds, created->count, false, &created->tree);
    }
    free(bounds);
    if (result != LMB_OK) {
        lmb_bright_cells_destroy(created);
        return result;
    }
    *bright = created;
    return LMB_OK;
}

void lmb_bright_cells_destroy(lmb_bright_cells *bright)
{
    if (bright) {
        lmb_light_tree_destroy(bright->tree);
        free(bright->cell);
        free(bright);
    }
}

size_t lmb_bright_cells_bytes(const lmb_bright_cells *bright)
{
    return bright ? sizeof *bright + bright->count * sizeof *bright->cell + lmb_light_tree_bytes(bright->tree) : 0;
}

bool lmb_bright_cells_aim(const lmb_bright_cells *bright, const lmb_light_query *query, lmb_vec3 position, float choice,
                          const float point[2], lmb_bright_aim *aim)
{
    aim->cell = lmb_light_tree_choose(bright->tree, query, (double)choice, &aim->probability);
    const bright_cell *chosen = &bright->cell[aim->cell];
    const lmb_vec3 towards = lmb_vec3_sub(bright_cell_point(chosen, point), position);
    const float distance = lmb_vec3_length(towards);
    if (!(distance > 0.0f) || !(lmb_vec3_dot(towards, chosen->normal) < 0.0f)) {
        return false;
    }
    aim->patch = chosen->patch;
    aim->direction = lmb_vec3_scale(towards, 1.0f / distance);
    return true;
}

static float density_of(const bright_cell *cell, double probability, lmb_vec3 direction, const lmb_hit *hit)
{
    const float cosine = -lmb_vec3_dot(direction, cell->normal);
    return cosine > 0.0f ? (float)probability * hit->distance * hit->distance / (cosine * cell->area) : 0.0f;
}

float lmb_bright_aim_density(const lmb_bright_cells *bright, const lmb_bright_aim *aim, const lmb_hit *hit)
{
    return density_of(&bright->cell[aim->cell], aim->probability, aim->direction, hit);
}

float lmb_bright_cells_density(const lmb_surface_light *light, const lmb_light_query *query, lmb_vec3 direction,
                               const lmb_hit *hit, uint32_t patch)
{
    const lmb_bright_cells *bright = light->bright;
    if (!(lmb_luminance(light->radiance[patch]) > bright->least)) {
        return 0.0f;
    }
    uint32_t low = 0, high = bright->count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (bright->cell[middle].patch < patch) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    if (low == bright->count || bright->cell[low].patch != patch) {
        return 0.0f;
    }
    return density_of(&bright->cell[low], lmb_light_tree_probability(bright->tree, query, low), direction, hit);
}
