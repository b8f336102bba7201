/* Which free points are connected to a seed: a flood from point to neighbouring point, that looks at points as it comes
 * to them, so that a small room costs the same in a level of any size. */
#include "probes/placement_internal.h"

#include <float.h>
#include <stdlib.h>

#include <lambent/vector.h>

/* In `free`, while the flood lasts. */
enum { REACHED = 2 };

typedef struct lmb_flood {
    lmb_survey *survey;
    int32_t *queue; /* reached points, in the order of their distance in steps; room for all of the survey's */
    int32_t filled;
} lmb_flood;

/* The first point of a seed's cell. @return false outside of the box */
static bool seed_cell(const lmb_survey *survey, lmb_vec3 seed, int32_t cell[3])
{
    const lmb_vec3d world = {(double)seed.x + survey->origin.x, (double)seed.y + survey->origin.y,
                             (double)seed.z + survey->origin.z};
    double fraction[3];
    return lmb_lattice_cell(&survey->box, world, cell, fraction);
}

static void cell_corner(const int32_t cell[3], int corner, int32_t point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = cell[axis] + (corner >> axis & 1);
    }
}

/* Looks at the corners of all seeds' cells. */
static lmb_result seeds_look(lmb_survey *survey, const lmb_seed_list *seeds)
{
    lmb_result result = LMB_OK;
    for (uint32_t i = 0; i < seeds->count; ++i) {
        int32_t cell[3], point[3];
        const int corners = seed_cell(survey, seeds->at[i], cell) ? 8 : 0;
        for (int corner = 0; corner < corners && result == LMB_OK; ++corner) {
            cell_corner(cell, corner, point);
            result = lmb_point_set_add(&survey->points, point);
        }
    }
    return result == LMB_OK ? lmb_survey_classify(survey) : result;
}

/* The free point nearest to a seed among the corners of its cell, or -1, and why. */
static int32_t seed_point(const lmb_survey *survey, lmb_vec3 seed, lmb_seed_state *state)
{
    int32_t cell[3];
    if (!seed_cell(survey, seed, cell)) {
        *state = LMB_SEED_OUTSIDE;
        return -1;
    }
    int32_t nearest = -1;
    float nearest_distance = FLT_MAX;
    for (int corner = 0; corner < 8; ++corner) {
        int32_t point[3];
        cell_corner(cell, corner, point);
        const int32_t found = lmb_probe_index_find(&survey->points.index, point);
        const float distance = lmb_vec3_length(lmb_vec3_sub(survey_position(survey, point), seed));
        if (survey->free[found] && distance < nearest_distance) {
            nearest = found;
            nearest_distance = distance;
        }
    }
    *state = nearest < 0 ? LMB_SEED_SOLID : LMB_SEED_FREE;
    return nearest;
}

static void reach(lmb_flood *flood, int32_t point)
{
    flood->survey->free[point] = REACHED;
    flood->queue[flood->filled++] = point;
}

/* A point one step along an axis: side 0 and 1 are down and up x, then y, z. @return false outside of the box */
static bool neighbour_of(const lmb_survey *survey, int32_t point, int side, int32_t neighbour[3])
{
    const int32_t *const from = survey->points.point[point];
    for (int axis = 0; axis < 3; ++axis) {
        neighbour[axis] = from[axis] + (axis != side / 2 ? 0 : side % 2 == 1 ? 1 : -1);
    }
    return lmb_lattice_has(&survey->box, neighbour);
}

static bool points_connected(lmb_survey *survey, int32_t a, int32_t b)
{
    const lmb_vec3 from = survey_position(survey, survey->points.point[a]);
    const lmb_vec3 to = survey_position(survey, survey->points.point[b]);
    return lmb_rgb_max(lmb_trace_transmittance(survey->tracer, from, to, &survey->rays)) > 0.0f;
}

static lmb_result queue_grow(lmb_flood *flood)
{
    int32_t *const queue = realloc(flood->queue, (size_t)flood->survey->points.room * sizeof *queue);
    flood->queue = queue ? queue : flood->queue;
    return queue ? LMB_OK : LMB_ERROR_MEMORY;
}

/* Looks at what is next to the points that the last step reached. */
static lmb_result neighbours_look(lmb_flood *flood, int32_t first, int32_t last)
{
    lmb_survey *survey = flood->survey;
    lmb_result result = LMB_OK;
    for (int32_t i = first; i < last; ++i) {
        for (int side = 0; side < 6 && result == LMB_OK; ++side) {
            int32_t neighbour[3];
            if (neighbour_of(survey, flood->queue[i], side, neighbour)) {
                result = lmb_point_set_add(&survey->points, neighbour);
            }
        }
    }
    result = result == LMB_OK ? lmb_survey_classify(survey) : result;
    return result == LMB_OK ? queue_grow(flood) : result;
}

/* All that is one step farther than queue[first .. last - 1]. */
static lmb_result flood_step(lmb_flood *flood, int32_t first, int32_t last)
{
    lmb_survey *survey = flood->survey;
    const lmb_result result = neighbours_look(flood, first, last);
    for (int32_t i = first; i < last && result == LMB_OK; ++i) {
        const int32_t at = flood->queue[i];
        for (int side = 0; side < 6; ++side) {
            int32_t neighbour[3];
            if (!neighbour_of(survey, at, side, neighbour)) {
                continue;
            }
            const int32_t next = lmb_probe_index_find(&survey->points.index, neighbour);
            if (survey->free[next] == 1 && points_connected(survey, at, next)) {
                reach(flood, next);
            }
        }
    }
    return result;
}

lmb_result lmb_survey_flood(lmb_survey *survey, const lmb_seed_list *seeds, bool *any)
{
    lmb_flood flood = {.survey = survey};
    *any = false;
    lmb_result result = seeds_look(survey, seeds);
    if (result == LMB_OK && survey->points.count > 0) {
        result = queue_grow(&flood);
    }
    for (uint32_t i = 0; i < seeds->count && result == LMB_OK; ++i) {
        const int32_t point = seed_point(survey, seeds->at[i], &seeds->state[i]);
        if (point >= 0 && survey->free[point] == 1) {
            reach(&flood, point);
        }
    }
    *any = flood.filled > 0;
    for (int32_t done = 0; done < flood.filled && result == LMB_OK;) {
        const int32_t last = flood.filled;
        result = flood_step(&flood, done, last);
        done = last;
    }
    for (int32_t i = 0; *any && i < survey->points.count && result == LMB_OK; ++i) {
        survey->free[i] = survey->free[i] == REACHED;
    }
    free(flood.queue);
    return result;
}
