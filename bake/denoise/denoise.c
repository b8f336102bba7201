/* Passes over all points, each of which reads what the last has written:
 *
 *     point_see           which others a point in space sees
 *     point_find_noise    its noise, and the light around it
 *     point_find_errors   what error each radius leaves at it
 *     point_choose        the radius of the least error, by the mean of those around, which are less random
 *     point_renew         its light, with the radii that it and those around have chosen */
#include <lambent/denoise.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "base/vectorised.h"
#include "denoise/neighbours.h"

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

/* A point's noisy light: 27 coefficients of the mean of its replicates, then of half their difference, each filled up
 * with zeros to whole vectors. */
enum { COEFFICIENTS = 3 * LMB_SH3_COUNT, LANES = 8, HALF = 32, ROW = 2 * HALF };

/* Of a point in space, which of its neighbours it sees, a bit each in the order in which they are found. Lattice points
 * have 33 that are near enough; those beyond the last bit do not count. */
enum { SEEN_WORDS = 2, SEEN_MOST = 64 * SEEN_WORDS };

typedef struct denoise_work {
    const denoise_reach *reach;
    lmb_neighbour_cells cells;
    const lmb_tracer *tracer;     /* of points in space; else NULL */
    uint64_t (*seen)[SEEN_WORDS]; /* [rank], of points in space; else NULL */
    float (*light)[ROW];          /* [rank] */
    float *noise;                 /* [rank] squared, of the mean of the replicates */
    float *level;                 /* [rank] squared length of the mean light around */
    float dark;                   /* least level that errors are relative to */
    float (*error)[RADII];        /* [rank] estimates of the squared error, each by itself: may be negative */
    float (*smooth_error)[RADII]; /* [rank] */
    uint8_t *choice;              /* [rank] radius */
    lmb_gathered *gathered;       /* [element] */
} denoise_work;

/* 1 at the middle, 0 at `radius` and beyond. */
static float biweight(float square, float radius)
{
    const float rest = lmb_larger(1.0f - square / (radius * radius), 0.0f);
    return rest * rest;
}

/* The first column of the inverse of a positive symmetric matrix, of which the lower half is given and lost. */
enum { PLANE = 4 };
static void inverse_column(double a[PLANE][PLANE], double column[PLANE])
{
    for (int k = 0; k < PLANE; ++k) { /* a = L D L^T */
        for (int i = k + 1; i < PLANE; ++i) {
            const double factor = a[i][k] / a[k][k];
            for (int j = k + 1; j <= i; ++j) {
                a[i][j] -= factor * a[j][k];
            }
            column[i] = 0.0;
        }
    }
    column[0] = 1.0;
    for (int i = 1; i < PLANE; ++i) {
        column[i] = 0.0;
        for (int k = 0; k < i; ++k) {
            column[i] -= a[i][k] / a[k][k] * column[k];
        }
    }
    for (int i = PLANE - 1; i >= 0; --i) {
        column[i] /= a[i][i];
        for (int k = i + 1; k < PLANE; ++k) {
            column[i] -= a[k][i] / a[i][i] * column[k];
        }
    }
}

/* Weights of a plane's value at the middle, fitted by least squares: the sum of weight x value is that. Where points
 * lie to one side only, its slope is held back. */
static void plane_weights(const lmb_neighbour *found, uint32_t count, float radius, float *weight)
{
    double moment[PLANE][PLANE] = {{0.0}}, plane[PLANE];
    for (uint32_t i = 0; i < count; ++i) {
        const double w = (double)biweight(found[i].square, radius);
        const double term[PLANE] = {1.0, (double)found[i].x, (double)found[i].y, (double)found[i].z};
        for (int row = 0; row < PLANE; ++row) {
            for (int k = 0; k <= row; ++k) {
                moment[row][k] += w * term[row] * term[k];
            }
        }
        weight[i] = (float)w;
    }
    const double hold = 0.02 * (double)radius * (double)radius * moment[0][0];
    for (int row = 1; row < PLANE; ++row) {
        moment[row][row] += hold;
    }
    inverse_column(moment, plane);
    for (uint32_t i = 0; i < count; ++i) {
        weight[i] *= (float)(plane[0] + plane[1] * (double)found[i].x + plane[2] * (double)found[i].y +
                             plane[3] * (double)found[i].z);
    }
}

LMB_VECTORISED
static void rows_sum(const float (*light)[ROW], const lmb_neighbour *found, const float *weight, uint32_t count,
                     float sum[ROW])
{
    memset(sum, 0, ROW * sizeof *sum);
    for (uint32_t i = 0; i < count; ++i) {
        const float *const row = light[found[i].rank];
        const float w = weight[i];
        for (int k = 0; k < ROW; ++k) {
            sum[k] += w * row[k];
        }
    }
}

/* The point's light filtered within a radius. */
static void point_filter(const denoise_work *work, const lmb_neighbour *found, uint32_t count, float radius,
                         float sum[ROW])
{
    lmb_neighbour near[LMB_NEIGHBOURS_MOST];
    float weight[LMB_NEIGHBOURS_MOST];
    uint32_t near_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        if (found[i].square < radius * radius) {
            near[near_count++] = found[i];
        }
    }
    plane_weights(near, near_count, radius, weight);
    rows_sum((const float(*)[ROW])work->light, near, weight, near_count, sum);
}

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
static uint32_t alike_keep(const denoise_work *work, uint32_t rank, uint32_t count, lmb_neighbour *found)
{
    const float *const row = work->light[rank];
    uint32_t alike = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const float *const other = work->light[found[i].rank];
        float lane[LANES] = {0.0f};
        for (int k = 0; k < HALF; k += LANES) {
            for (int j = 0; j < LANES; ++j) {
                const float off = row[k + j] - other[k + j];
                lane[j] += off * off;
            }
        }
        const float square = ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
        if (square <= OTHER_LIGHT * (work->noise[rank] + work->noise[found[i].rank])) {
            found[alike++] = found[i];
        }
    }
    return alike;
}

/* The neighbours of a point within a radius; of a point in space those that it sees. */
static uint32_t around_find(const denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank, float radius,
                            lmb_neighbour found[LMB_NEIGHBOURS_MOST])
{
    if (!work->seen) {
        return lmb_neighbours_find(&work->cells, ranges, rank, radius, found);
    }
    const uint32_t count = lmb_neighbours_find(&work->cells, ranges, rank, work->reach->radius[RADII - 1], found);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count && i < SEEN_MOST; ++i) {
        if (found[i].square < radius * radius && (work->seen[rank][i / 64] >> i % 64 & 1) != 0) {
            found[kept++] = found[i];
        }
    }
    return kept;
}

/* Those of them that have the same light as far as its noise tells. */
static uint32_t alike_find(const denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank, float radius,
                           lmb_neighbour found[LMB_NEIGHBOURS_MOST])
{
    return alike_keep(work, rank, around_find(work, ranges, rank, radius, found), found);
}

static lmb_vec3 point_position(const denoise_work *work, uint32_t rank)
{
    return lmb_vec3_of(work->cells.x[rank], work->cells.y[rank], work->cells.z[rank]);
}

static void point_see(denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank)
{
    lmb_neighbour found[LMB_NEIGHBOURS_MOST];
    const uint32_t count = lmb_neighbours_find(&work->cells, ranges, rank, work->reach->radius[RADII - 1], found);
    for (uint32_t i = 0; i < count && i < SEEN_MOST; ++i) {
        uint64_t rays = 0;
        const uint32_t other = found[i].rank;
        /* The same from either side. */
        const lmb_vec3 from = point_position(work, rank < other ? rank : other);
        const lmb_vec3 to = point_position(work, rank < other ? other : rank);
        const bool sees = other == rank || lmb_rgb_max(lmb_trace_transmittance(work->tracer, from, to, &rays)) > 0.0f;
        work->seen[rank][i / 64] |= (uint64_t)sees << i % 64;
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

static float level_find(const denoise_work *work, const lmb_neighbour *found, uint32_t count)
{
    float weight[LMB_NEIGHBOURS_MOST], sum[ROW];
    for (uint32_t i = 0; i < count; ++i) {
        weight[i] = 1.0f / (float)count;
    }
    rows_sum((const float(*)[ROW])work->light, found, weight, count, sum);
    return squared_length(sum);
}

/* The mean noise of a point and those beside it: of one with any among those with any, since what is dark beside a lit
 * edge has none. */
static void point_find_noise(denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank)
{
    lmb_neighbour found[LMB_NEIGHBOURS_MOST];
    const uint32_t count = around_find(work, ranges, rank, work->reach->level, found);
    const bool noisy = squared_difference(work->light[rank]) > 0.0f;
    float sum = 0.0f, noisy_count = 0.0f;
    for (uint32_t i = 0; i < count; ++i) {
        if (found[i].square >= work->reach->noise * work->reach->noise) {
            continue;
        }
        const float square = squared_difference(work->light[found[i].rank]);
        sum += square;
        noisy_count += square > 0.0f ? 1.0f : 0.0f;
    }
    work->noise[rank] = noisy ? sum / noisy_count : 0.0f;
    work->level[rank] = level_find(work, found, count);
}

static void point_find_errors(denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank)
{
    lmb_neighbour found[LMB_NEIGHBOURS_MOST];
    const uint32_t count = alike_find(work, ranges, rank, work->reach->radius[RADII - 1], found);
    work->error[rank][0] = filter_error(work->light[rank], work->light[rank]);
    for (int r = 1; r < RADII; ++r) {
        float sum[ROW];
        point_filter(work, found, count, work->reach->radius[r], sum);
        work->error[rank][r] = filter_error(work->light[rank], sum);
    }
}

static void point_choose(denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank)
{
    lmb_neighbour found[LMB_NEIGHBOURS_MOST];
    const uint32_t count = alike_find(work, ranges, rank, work->reach->smooth, found);
    double relative[RADII] = {0.0}, sum[RADII] = {0.0}, weights = 0.0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t other = found[i].rank;
        const double weight = (double)biweight(found[i].square, work->reach->smooth);
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
        work->smooth_error[rank][r] = (float)(sum[r] / weights);
    }
    work->choice[rank] = (uint8_t)best;
}

/* How far the points around have chosen each radius. */
static void choices_share(const denoise_work *work, const lmb_neighbour *found, uint32_t count, float share[RADII])
{
    float sum = 0.0f;
    memset(share, 0, RADII * sizeof *share);
    for (uint32_t i = 0; i < count; ++i) {
        const float weight = biweight(found[i].square, work->reach->smooth);
        share[work->choice[found[i].rank]] += weight;
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

static void point_renew(denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank)
{
    lmb_neighbour found[LMB_NEIGHBOURS_MOST];
    float share[RADII], light[COEFFICIENTS], error;
    uint32_t count = alike_find(work, ranges, rank, work->reach->smooth, found);
    choices_share(work, found, count, share);
    if (share[RADII - 1] > 0.0f) {
        count = alike_find(work, ranges, rank, work->reach->radius[RADII - 1], found);
    }
    error = share[0] * work->smooth_error[rank][0];
    for (int k = 0; k < COEFFICIENTS; ++k) {
        light[k] = share[0] * work->light[rank][k];
    }
    for (int r = 1; r < RADII; ++r) {
        if (share[r] > 0.0f) {
            float sum[ROW];
            point_filter(work, found, count, work->reach->radius[r], sum);
            error += share[r] * work->smooth_error[rank][r];
            for (int k = 0; k < COEFFICIENTS; ++k) {
                light[k] += share[r] * sum[k];
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
    void (*at)(denoise_work *work, const lmb_neighbour_ranges *ranges, uint32_t rank);
} denoise_pass;

static void cell_task(void *context, size_t cell, int worker)
{
    (void)worker;
    const denoise_pass *pass = context;
    const lmb_neighbour_cells *cells = &pass->work->cells;
    lmb_neighbour_ranges ranges;
    lmb_neighbour_ranges_find(cells, (uint32_t)cell, &ranges);
    for (uint32_t rank = cells->first[cell]; rank < cells->first[cell + 1]; ++rank) {
        pass->at(pass->work, &ranges, rank);
    }
}

static lmb_result passes_run(denoise_work *work, lmb_pool *pool, const lmb_progress *progress)
{
    denoise_pass passes[] = {{work, point_see},
                             {work, point_find_noise},
                             {work, point_find_errors},
                             {work, point_choose},
                             {work, point_renew}};
    lmb_result result = LMB_OK;
    for (size_t i = work->seen ? 0 : 1; i < sizeof passes / sizeof passes[0] && result == LMB_OK; ++i) {
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
static lmb_result denoise_run(denoise_work *work, const lmb_denoise_point *points, size_t count, lmb_pool *pool,
                              const lmb_progress *progress)
{
    work->light = malloc((count + 1) * sizeof *work->light);
    work->noise = malloc((count + 1) * sizeof *work->noise);
    work->level = calloc(count + 1, sizeof *work->level);
    work->error = malloc((count + 1) * sizeof *work->error);
    work->smooth_error = malloc((count + 1) * sizeof *work->smooth_error);
    work->choice = malloc(count + 1);
    work->seen = work->tracer ? calloc(count + 1, sizeof *work->seen) : NULL;
    lmb_result result = LMB_ERROR_MEMORY;
    if (work->light && work->noise && work->level && work->error && work->smooth_error && work->choice &&
        (work->seen || !work->tracer)) {
        result = lmb_neighbour_cells_make(points, (uint32_t)count, work->reach->radius[RADII - 1], &work->cells);
    }
    if (result == LMB_OK) {
        light_set(work);
        result = passes_run(work, pool, progress);
    }
    lmb_neighbour_cells_free(&work->cells);
    free(work->light);
    free(work->noise);
    free(work->level);
    free(work->error);
    free(work->smooth_error);
    free(work->choice);
    free(work->seen);
    return result;
}

lmb_result lmb_denoise(const lmb_denoise_point *points, size_t count, lmb_pool *pool, const lmb_progress *progress,
                       lmb_gathered *gathered)
{
    denoise_work work = {.reach = &on_surfaces, .gathered = gathered};
    return denoise_run(&work, points, count, pool, progress);
}

lmb_result lmb_denoise_in_space(const lmb_denoise_point *points, size_t count, const lmb_tracer *tracer, lmb_pool *pool,
                                const lmb_progress *progress, lmb_gathered *gathered)
{
    denoise_work work = {.reach = &in_space, .tracer = tracer, .gathered = gathered};
    return denoise_run(&work, points, count, pool, progress);
}
