/* Passes over all points, each of which reads what the last has written:
 *
 *     point_find_noise    which are around it, its noise, and the light around it
 *     point_find_errors   which of them have the same light, and what error each radius leaves at it
 *     point_choose        the radius of the least error, by the mean of those around, which are less random
 *     point_renew         its light, with the radii that it and those around have chosen */
#include <lambent/denoise.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "base/vectorised.h"
#include "denoise/neighbour_marks.h"
#include "denoise/neighbours.h"
#include "denoise/plane_filter.h"
#include "denoise/sight.h"

/* How far what reaches, in spacings. */
enum { RADII = 4 };
typedef struct denoise_reach {
    float radius[RADII]; /* of the filters; the first is none at all, the last the farthest */
    float noise;         /* it is averaged so far, */
    float level;         /* light so far, */
    float smooth;        /* errors and choices so far */
} denoise_reach;

static const denoise_reach on_surfaces = {{0.0f, 2.0f, 4.0f, 8.0f}, 2.5f, 4.0f, 6.0f};
/* Among lattice points: those beside a point, with those at edges, with those at corners and the next but one. */
static const denoise_reach in_space = {{0.0f, 1.2f, 1.6f, 2.1f}, 1.5f, 2.1f, 2.1f};

/* Of a point's noisy light, in rows (plane_filter.h). */
enum { COEFFICIENTS = 3 * LMB_SH3_COUNT, LANES = 8, HALF = LMB_LIGHT_HALF, ROW = LMB_LIGHT_ROW };

typedef struct denoise_work {
    const denoise_reach *reach;
    lmb_neighbour_cells cells;
    lmb_neighbour_marks marks; /* those around a point, then those alike */
    lmb_sight sight;
    float (*light)[ROW];          /* [rank] */
    float *noise;                 /* [rank] squared, of the mean of the replicates */
    float *level;                 /* [rank] squared length of the mean light around */
    float dark;                   /* least level that errors are relative to */
    float (*error)[RADII];        /* [rank] estimates of the squared error, each by itself: may be negative */
    float (*smooth_error)[RADII]; /* [rank] */
    uint8_t *choice;              /* [rank] radius */
    lmb_gathered *gathered;       /* [element] */
} denoise_work;

/* An estimate of the squared error of the filtered light F M of a point, without bias. Its halves are M + D and M - D,
 * with independent errors; filtered, F M + F D and F M - F D. The mean over both of |one half filtered - other half|^2
 * has the other half's own variance in it, that of its mean is half of its own:
 * |F M - M|^2 + 2 F D . D - |D|^2 is what remains. */
static float filter_error(const float *row, const float *filtered)
{
    double sum = 0.0;
    for (int k = 0; k < COEFFICIENTS; ++k) {
        const double off = (double)filtered[k] - (double)row[k];
        const double d = (double)row[HALF + k];
        sum += off * off + 2.0 * (double)filtered[HALF + k] * d - d * d;
    }
    return (float)sum;
}

/* Light that differs by more than this many times its noise, squared, is other light: beyond an edge, where nothing
 * needs to be averaged to see that. */
#define OTHER_LIGHT 16.0f

/* Leaves the neighbours that have the same light as far as its noise tells. */
LMB_VECTORISED
static void alike_keep(const denoise_work *work, lmb_neighbours *found)
{
    const uint32_t rank = found->rank[0];
    const float *const row = work->light[rank];
    uint32_t alike = 1;
    for (uint32_t i = 1; i < found->count; ++i) {
        const float *const other = work->light[found->rank[i]];
        float lane[LANES] = {0.0f};
        for (int k = 0; k < HALF; k += LANES) {
            for (int j = 0; j < LANES; ++j) {
                const float off = row[k + j] - other[k + j];
                lane[j] += off * off;
            }
        }
        const float square = ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
        const bool kept = square <= OTHER_LIGHT * (work->noise[rank] + work->noise[found->rank[i]]);
        found->rank[alike] = found->rank[i];
        found->candidate[alike] = found->candidate[i];
        alike += kept;
    }
    found->count = alike;
}

/* A point's neighbours that it sees. */
static void around_find(denoise_work *work, const lmb_neighbour_point *point, lmb_neighbours *found)
{
    lmb_neighbours_find(point->cells, point->ranges, point->rank, found);
    lmb_sight_keep(&work->sight, found);
    lmb_neighbour_marks_set(&work->marks, point, found);
    lmb_neighbours_place(point->cells, found);
}

/* Those of them that have the same light. */
static void alike_find(denoise_work *work, const lmb_neighbour_point *point, lmb_neighbours *found)
{
    if (!lmb_neighbour_marks_get(&work->marks, point, found)) {
        around_find(work, point, found);
    }
    alike_keep(work, found);
    lmb_neighbour_marks_set(&work->marks, point, found);
    lmb_neighbours_place(point->cells, found);
}

/* The same, once alike_find has found them. */
static void alike_get(denoise_work *work, const lmb_neighbour_point *point, lmb_neighbours *found)
{
    if (lmb_neighbour_marks_get(&work->marks, point, found)) {
        lmb_neighbours_place(point->cells, found);
    } else {
        alike_find(work, point, found);
    }
}

static float squared_length(const float *half)
{
    float sum = 0.0f;
    for (int k = 0; k < COEFFICIENTS; ++k) {
        sum += half[k] * half[k];
    }
    return sum;
}

static float squared_difference(const float *row)
{
    return squared_length(row + HALF);
}

/* The mean noise of a point and those beside it: of one with any among those with any, since what is dark beside a lit
 * edge has none. */
static void point_find_noise(denoise_work *work, const lmb_neighbour_point *point)
{
    lmb_neighbours found;
    lmb_plane even;
    around_find(work, point, &found);
    lmb_neighbours_within(&found, work->reach->noise, &even.part);
    const bool noisy = squared_difference(work->light[point->rank]) > 0.0f;
    float sum = 0.0f, noisy_count = 0.0f, light[HALF];
    for (uint32_t i = 0; i < even.part.count; ++i) {
        const float square = squared_difference(work->light[found.rank[even.part.place[i]]]);
        sum += square;
        noisy_count += square > 0.0f ? 1.0f : 0.0f;
    }
    work->noise[point->rank] = noisy ? sum / noisy_count : 0.0f;
    lmb_plane_even(&found, work->reach->level, &even);
    lmb_plane_halves(&even, &found, (const float(*)[ROW])work->light, light);
    work->level[point->rank] = squared_length(light);
}

static void point_find_errors(denoise_work *work, const lmb_neighbour_point *point)
{
    lmb_neighbours found;
    alike_find(work, point, &found);
    const float *const row = work->light[point->rank];
    float *const error = work->error[point->rank];
    error[0] = filter_error(row, row);
    for (int r = 1; r < RADII; ++r) {
        lmb_plane plane;
        float filtered[ROW];
        lmb_plane_fit(&found, work->reach->radius[r], &plane);
        lmb_plane_rows(&plane, &found, (const float(*)[ROW])work->light, filtered);
        error[r] = filter_error(row, filtered);
    }
}

static void point_choose(denoise_work *work, const lmb_neighbour_point *point)
{
    lmb_neighbours found;
    lmb_neighbours_part near;
    alike_get(work, point, &found);
    lmb_neighbours_within(&found, work->reach->smooth, &near);
    double relative[RADII] = {0.0}, sum[RADII] = {0.0}, weights = 0.0;
    for (uint32_t i = 0; i < near.count; ++i) {
        const uint32_t other = found.rank[near.place[i]];
        const double weight = (double)lmb_biweight(found.square[near.place[i]], work->reach->smooth);
        const double level = (double)lmb_larger(work->level[other], work->dark);
        weights += weight;
        for (int r = 0; r < RADII; ++r) {
            sum[r] += weight * (double)work->error[other][r];
            relative[r] += weight * (double)work->error[other][r] / level;
        }
    }
    int best = 0;
    for (int r = 0; r < RADII; ++r) {
        best = relative[r] < relative[best] ? r : best;
        work->smooth_error[point->rank][r] = (float)(sum[r] / weights);
    }
    work->choice[point->rank] = (uint8_t)best;
}

/* How far the points around have chosen each radius. */
static void choices_share(const denoise_work *work, const lmb_neighbours *found, float share[RADII])
{
    float sum = 0.0f;
    memset(share, 0, RADII * sizeof *share);
    for (uint32_t i = 0; i < found->count; ++i) {
        const float weight = lmb_biweight(found->square[i], work->reach->smooth);
        for (int r = 0; r < RADII; ++r) { /* in registers */
            share[r] += work->choice[found->rank[i]] == r ? weight : 0.0f;
        }
        sum += weight;
    }
    for (int r = 0; r < RADII; ++r) {
        share[r] /= sum;
    }
}

/* Of an element's moments only the noisy part is replaced. What the error had beside the replicates' difference, it
 * keeps. */
static void element_set(lmb_gathered *gathered, const float *row, const float *light, float error)
{
    double differences = 0.0, length = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const int k = c * LMB_SH3_COUNT + i;
            const float whole = gathered->steady.channel[c].c[i] + light[k];
            gathered->moments.channel[c].c[i] = whole;
            length += (double)whole * (double)whole;
            differences += (double)row[HALF + k] * (double)row[HALF + k];
        }
    }
    /* What key lights add to the length hardly changes. */
    gathered->squared_light = length + (gathered->squared_light - gathered->squared_length);
    gathered->squared_length = length;
    gathered->squared_error = fmax(gathered->squared_error - differences, 0.0) + fmax((double)error, 0.0);
}

static void point_renew(denoise_work *work, const lmb_neighbour_point *point)
{
    lmb_neighbours found;
    const uint32_t rank = point->rank;
    float share[RADII], light[COEFFICIENTS] = {0.0f}, error = 0.0f;
    alike_get(work, point, &found);
    choices_share(work, &found, share);
    for (int r = 0; r < RADII; ++r) {
        if (share[r] > 0.0f) {
            float filtered[HALF];
            memcpy(filtered, work->light[rank], sizeof filtered);
            if (r > 0) {
                lmb_plane plane;
                lmb_plane_fit(&found, work->reach->radius[r], &plane);
                lmb_plane_halves(&plane, &found, (const float(*)[ROW])work->light, filtered);
            }
            error += share[r] * work->smooth_error[rank][r];
            for (int k = 0; k < COEFFICIENTS; ++k) {
                light[k] += share[r] * filtered[k];
            }
        }
    }
    element_set(&work->gathered[work->cells.element[rank]], work->light[rank], light, error);
}

static void light_set(denoise_work *work)
{
    for (uint32_t rank = 0; rank < work->cells.count; ++rank) {
        const lmb_gathered *const from = &work->gathered[work->cells.element[rank]];
        float *const row = work->light[rank];
        memset(row, 0, sizeof work->light[rank]);
        for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < LMB_SH3_COUNT; ++i) {
                const int k = c * LMB_SH3_COUNT + i;
                row[k] = from->moments.channel[c].c[i] - from->steady.channel[c].c[i];
                row[HALF + k] = from->difference.channel[c].c[i];
            }
        }
    }
}

/* Errors count relative to the light around, or to DARK of the mean light where that is more: a lamp beside a dark wall
 * does not decide for the wall. */
#define DARK 0.01

static void dark_set(denoise_work *work)
{
    double sum = 0.0;
    for (uint32_t rank = 0; rank < work->cells.count; ++rank) {
        sum += (double)sqrtf(work->level[rank]);
    }
    const double dark = DARK * sum / (work->cells.count > 0 ? work->cells.count : 1);
    work->dark = (float)fmax(dark * dark, (double)FLT_MIN);
}

/* What a pass does at each point; points of a cell have the same ranges. */
typedef struct denoise_pass {
    denoise_work *work;
    void (*at)(denoise_work *work, const lmb_neighbour_point *point);
} denoise_pass;

static void cell_task(void *context, size_t cell, int worker)
{
    (void)worker;
    const denoise_pass *pass = context;
    const lmb_neighbour_cells *cells = &pass->work->cells;
    lmb_neighbour_ranges ranges;
    lmb_neighbour_ranges_find(cells, (uint32_t)cell, &ranges);
    lmb_neighbour_point point = {cells, &ranges, (uint32_t)cell, cells->first[cell]};
    for (; point.rank < cells->first[cell + 1]; ++point.rank) {
        pass->at(pass->work, &point);
    }
}

static lmb_result passes_run(denoise_work *work, lmb_pool *pool, const lmb_progress *progress)
{
    denoise_pass passes[] = {
        {work, point_find_noise}, {work, point_find_errors}, {work, point_choose}, {work, point_renew}};
    lmb_result result = LMB_OK;
    for (size_t i = 0; i < sizeof passes / sizeof passes[0] && result == LMB_OK; ++i) {
        const bool longest = passes[i].at == point_find_errors;
        if (longest) {
            dark_set(work);
        }
        result =
            lmb_pool_run(pool, work->cells.cell_count, cell_task, &passes[i], "denoise", longest ? progress : NULL);
    }
    return result;
}

/* Of which `work` has what the caller gave. */
static lmb_result denoise_run(denoise_work *work, const lmb_denoise_point *points, size_t count,
                              const lmb_tracer *tracer, lmb_pool *pool, const lmb_progress *progress)
{
    work->light = malloc((count + 1) * sizeof *work->light);
    work->noise = malloc((count + 1) * sizeof *work->noise);
    work->level = calloc(count + 1, sizeof *work->level);
    work->error = malloc((count + 1) * sizeof *work->error);
    work->smooth_error = malloc((count + 1) * sizeof *work->smooth_error);
    work->choice = malloc(count + 1);
    lmb_result result = LMB_ERROR_MEMORY;
    if (work->light && work->noise && work->level && work->error && work->smooth_error && work->choice) {
        result = lmb_neighbour_cells_make(points, (uint32_t)count, work->reach->radius[RADII - 1], &work->cells);
    }
    if (result == LMB_OK) {
        result = lmb_neighbour_marks_make(&work->cells, &work->marks);
    }
    if (result == LMB_OK) {
        result = lmb_sight_make(tracer, &work->cells, pool, &work->sight);
    }
    if (result == LMB_OK) {
        light_set(work);
        result = passes_run(work, pool, progress);
    }
    lmb_sight_free(&work->sight);
    lmb_neighbour_marks_free(&work->marks);
    lmb_neighbour_cells_free(&work->cells);
    free(work->light);
    free(work->noise);
    free(work->level);
    free(work->error);
    free(work->smooth_error);
    free(work->choice);
    return result;
}

lmb_result lmb_denoise(const lmb_denoise_point *points, size_t count, const lmb_tracer *tracer, lmb_pool *pool,
                       const lmb_progress *progress, lmb_gathered *gathered)
{
    denoise_work work = {.reach = &on_surfaces, .gathered = gathered};
    return denoise_run(&work, points, count, tracer, pool, progress);
}

lmb_result lmb_denoise_in_space(const lmb_denoise_point *points, size_t count, const lmb_tracer *tracer, lmb_pool *pool,
                                const lmb_progress *progress, lmb_gathered *gathered)
{
    denoise_work work = {.reach = &in_space, .gathered = gathered};
    return denoise_run(&work, points, count, tracer, pool, progress);
}
