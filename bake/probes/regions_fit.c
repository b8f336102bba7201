/* Fitting the corners of regions to light that was gathered inside of them. */
#include <lambent/key_lights.h>

#include <stdlib.h>
#include <string.h>

#include "probes/regions_internal.h"

/* How much a value is held to its neighbours, where gathered light counts 1. */
#define HOLD 0.1

enum { COEFFICIENTS = 3 * LMB_SH3_COUNT, MOST_PASSES = 100 };

/* Squared, of the gradient to where it began. */
#define CONVERGED 1e-10

/* One coefficient of light, or what is seen of one key light, of all values. */
typedef struct fit_task {
    const lmb_regions *regions;
    const lmb_gathered *gathered;
    lmb_probes *probes;
    uint32_t set;
    bool failed[COEFFICIENTS + LMB_KEY_LIGHTS_MOST]; /* out of memory */
} fit_task;

/* What is to be solved: x, of the unknown ones among the values of regions. */
typedef struct fit_work {
    const lmb_regions *regions;
    const double *known;              /* [probe] 0 of unknown ones */
    double *x, *gradient, *direction; /* [unknown] */
    double *residual, *image;         /* [point, then 12 edges a region] */
} fit_work;

static float *value_at(lmb_probes *probes, uint32_t set, int32_t probe, int k)
{
    return k < COEFFICIENTS ? &probes->radiance[set][probe].channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT]
                            : &probes->key_visibility[probe][k - COEFFICIENTS];
}

static float gathered_at(const lmb_gathered *gathered, int k)
{
    return k < COEFFICIENTS ? gathered->moments.channel[k / LMB_SH3_COUNT].c[k % LMB_SH3_COUNT]
                            : gathered->key_visibility[k - COEFFICIENTS];
}

static void point_weights(const float t[3], double weight[8])
{
    for (int i = 0; i < 8; ++i) {
        weight[i] = (i & 1 ? (double)t[0] : 1.0 - (double)t[0]) * (i & 2 ? (double)t[1] : 1.0 - (double)t[1]) *
                    (i & 4 ? (double)t[2] : 1.0 - (double)t[2]);
    }
}

/* Both ends of an edge of a cell: four along each axis. */
static void edge_corners(int edge, int corner[2])
{
    const int axis = edge / 4, k = edge % 4, below = (1 << axis) - 1;
    corner[0] = (k & below) | (k & ~below) << 1;
    corner[1] = corner[0] | 1 << axis;
}

enum { EDGES = 12 };

/* An edge says something where one of its ends is unknown: that they are about the same. */
static bool edge_counts(const lmb_regions *regions, const int32_t *corner, const int end[2])
{
    return corner[end[0]] != corner[end[1]] &&
           (regions->unknown_of[corner[end[0]]] >= 0 || regions->unknown_of[corner[end[1]]] >= 0);
}

/* All equations' left sides at some values of the unknown ones; with what is known, if there is any. */
static void image_of(const fit_work *work, const double *x, const double *known, double *image)
{
    const lmb_regions *const regions = work->regions;
#define VALUE(probe) (regions->unknown_of[probe] >= 0 ? x[regions->unknown_of[probe]] : known ? known[probe] : 0.0)
    for (size_t i = 0; i < regions->point_count; ++i) {
        const int32_t *const corner = regions->corner[regions->point[i].region];
        double weight[8], sum = 0.0;
        point_weights(regions->point[i].t, weight);
        for (int k = 0; k < 8; ++k) {
            sum += weight[k] * VALUE(corner[k]);
        }
        image[i] = sum;
    }
    for (uint32_t region = 0; region < regions->region_count; ++region) {
        const int32_t *const corner = regions->corner[region];
        double *const own = &image[regions->point_count + (size_t)EDGES * region];
        for (int edge = 0; edge < EDGES; ++edge) {
            int end[2];
            edge_corners(edge, end);
            own[edge] =
                edge_counts(regions, corner, end) ? HOLD * (VALUE(corner[end[0]]) - VALUE(corner[end[1]])) : 0.0;
        }
    }
#undef VALUE
}

/* @return its length squared */
static double gradient_of(const fit_work *work)
{
    const lmb_regions *const regions = work->regions;
    double squared = 0.0;
    memset(work->gradient, 0, regions->unknown_count * sizeof *work->gradient);
#define ADD(probe, value)                                                                                              \
    do {                                                                                                               \
        const int32_t to = regions->unknown_of[probe];                                                                 \
        if (to >= 0) {                                                                                                 \
            work->gradient[to] += value;                                                                               \
        }                                                                                                              \
    } while (0)
    for (size_t i = 0; i < regions->point_count; ++i) {
        const int32_t *const corner = regions->corner[regions->point[i].region];
        double weight[8];
        point_weights(regions->point[i].t, weight);
        for (int k = 0; k < 8; ++k) {
            ADD(corner[k], weight[k] * work->residual[i]);
        }
    }
    for (uint32_t region = 0; region < regions->region_count; ++region) {
        const int32_t *const corner = regions->corner[region];
        const double *const own = &work->residual[regions->point_count + (size_t)EDGES * region];
        for (int edge = 0; edge < EDGES; ++edge) {
            int end[2];
            edge_corners(edge, end);
            if (edge_counts(regions, corner, end)) {
                ADD(corner[end[0]], HOLD * own[edge]);
                ADD(corner[end[1]], -HOLD * own[edge]);
            }
        }
    }
#undef ADD
    for (uint32_t i = 0; i < regions->unknown_count; ++i) {
        squared += work->gradient[i] * work->gradient[i];
    }
    return squared;
}

/* Conjugate gradients on the normal equations (Hestenes and Stiefel 1952). `residual` is that of x = 0. */
static void solve(const fit_work *work, size_t rows)
{
    const size_t columns = work->regions->unknown_count;
    double squared = gradient_of(work);
    const double enough = CONVERGED * squared;
    memcpy(work->direction, work->gradient, columns * sizeof *work->direction);
    for (int pass = 0; pass < MOST_PASSES && squared > enough; ++pass) {
        double length = 0.0;
        image_of(work, work->direction, NULL, work->image);
        for (size_t row = 0; row < rows; ++row) {
            length += work->image[row] * work->image[row];
        }
        if (!(length > 0.0)) {
            return;
        }
        const double step = squared / length;
        for (size_t i = 0; i < columns; ++i) {
            work->x[i] += step * work->direction[i];
        }
        for (size_t row = 0; row < rows; ++row) {
            work->residual[row] -= step * work->image[row];
        }
        const double next = gradient_of(work);
        for (size_t i = 0; i < columns; ++i) {
            work->direction[i] = work->gradient[i] + next / squared * work->direction[i];
        }
        squared = next;
    }
}

static void coefficient_fit(void *context, size_t task, int worker)
{
    (void)worker;
    fit_task *const fit = context;
    const lmb_regions *const regions = fit->regions;
    const size_t rows = regions->point_count + (size_t)EDGES * regions->region_count;
    const size_t columns = regions->unknown_count, probes = (size_t)fit->probes->count;
    double *const numbers = calloc(3 * columns + 2 * rows + probes + 1, sizeof *numbers);
    if (!numbers) {
        fit->failed[task] = true;
        return;
    }
    double *const known = numbers + 3 * columns + 2 * rows;
    const fit_work work = {.regions = regions,
                           .known = known,
                           .x = numbers,
                           .gradient = numbers + columns,
                           .direction = numbers + 2 * columns,
                           .residual = numbers + 3 * columns,
                           .image = numbers + 3 * columns + rows};
    for (size_t probe = 0; probe < probes; ++probe) {
        known[probe] = (double)*value_at(fit->probes, fit->set, (int32_t)probe, (int)task);
    }
    image_of(&work, work.x, known, work.residual);
    for (size_t row = 0; row < rows; ++row) {
        const double right = row < regions->point_count ? (double)gathered_at(&fit->gathered[row], (int)task) : 0.0;
        work.residual[row] = right - work.residual[row];
    }
    solve(&work, rows);
    for (size_t i = 0; i < columns; ++i) {
        const float found = (float)work.x[i];
        *value_at(fit->probes, fit->set, regions->unknown[i], (int)task) =
            task < COEFFICIENTS ? found : lmb_saturate(found);
    }
    free(numbers);
}

lmb_result lmb_regions_fit(const lmb_regions *regions, const lmb_gathered *gathered, uint32_t set, lmb_pool *pool,
                           lmb_probes *probes)
{
    if (regions->unknown_count == 0) {
        return LMB_OK;
    }
    fit_task fit = {.regions = regions, .gathered = gathered, .probes = probes, .set = set};
    lmb_result result =
        lmb_pool_run(pool, COEFFICIENTS + probes->key_light_count, coefficient_fit, &fit, "probes", NULL);
    for (size_t i = 0; i < sizeof fit.failed / sizeof fit.failed[0]; ++i) {
        result = fit.failed[i] ? LMB_ERROR_MEMORY : result;
    }
    return result;
}
