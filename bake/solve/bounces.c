/* Summing bounces by Anderson acceleration.
 *
 * Between surfaces that reflect nearly all light it would take thousands of passes E <- D + T E to sum the bounces.
 * After every few passes, a cycle, the light is therefore set to that combination of the last cycles whose residual,
 * what a cycle would change, is the least: D. G. Anderson, "Iterative procedures for nonlinear integral equations",
 * 1965, in the form of H. F. Walker and P. Ni, "Anderson acceleration for fixed-point iterations", SIAM J. Numer.
 * Anal. 49(4), 2011, eq. 2.2. Between cycles only passes are taken (as P. P. Pratapa, P. Suryanarayana and J. E. Pask,
 * "Anderson acceleration of the Jacobi iterative method", J. Comput. Phys. 306, 2016): these get rid of what changes
 * from patch to patch, and the combination of what a whole room has in common. */
#include "solve/bounces.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/vector.h>

#include "solve/bounce_core.h"

enum { ROWS_PER_TASK = 4096 };

/* Links whose light is on its way while a pass adds up. */
enum { AHEAD = 24 };

/* Passes in a cycle, and cycles before the last that are combined. */
enum { CYCLE = 4, HISTORY = 3, VECTORS = 4 + 2 * HISTORY };

/* Light stands still when a cycle, its combination included, changes it by less than this share: by the mean over all
 * patches, or a few that are shut in between white surfaces, as within a lamp, would keep all waiting. */
#define STILL 5e-4

/* What is darker than this share of the mean light may change by a share of that. */
#define DARK 0.01

/* The most passes: those that multiply with LINKS_IN_ALL links together, within these bounds. */
enum { MIN_PASSES = 256, MAX_PASSES = 2000, LINKS_IN_ALL = 400000000 };

/* Keeps the least squares solvable when cycles repeat each other. */
#define RIDGE 1e-8

/* Sums over some rows, each by how many samples it has. */
typedef struct cycle_sums {
    double product[HISTORY][HISTORY]; /* of changes of the residual, relative to the light; j <= i */
    double residual[HISTORY];         /* of these with the residual */
    double light;
    double change; /* relative */
    double samples;
} cycle_sums;

typedef struct bounce_work {
    lmb_bounce_core core;
    lmb_rgb *light; /* [core row] */
    lmb_rgb *next;
    lmb_rgb *begin;         /* light at the beginning of the cycle */
    lmb_rgb *residual;      /* what the last cycle's passes changed */
    lmb_rgb *turn[HISTORY]; /* changes of the residual from cycle to cycle */
    lmb_rgb *gain[HISTORY]; /* changes of the light after the passes of a cycle, likewise */
    int known;              /* of the history */
    int newest;             /* of the history */
    double factor[HISTORY]; /* of `gain` */
    double mean;            /* of the light */
    cycle_sums *sums;       /* [task] */
} bounce_work;

static size_t task_count(uint32_t count)
{
    return ((size_t)count + ROWS_PER_TASK - 1) / ROWS_PER_TASK;
}

static uint32_t task_end(const bounce_work *work, size_t task)
{
    const size_t end = (task + 1) * ROWS_PER_TASK;
    return end < work->core.count ? (uint32_t)end : work->core.count;
}

static void pass_task(void *context, size_t task, int worker)
{
    (void)worker;
    const bounce_work *work = context;
    const lmb_bounce_core *core = &work->core;
    const size_t all = core->first[core->count];
    for (uint32_t i = (uint32_t)task * ROWS_PER_TASK; i < task_end(work, task); ++i) {
        lmb_rgb sum = {{0.0f, 0.0f, 0.0f}};
        for (size_t k = core->first[i]; k < core->first[i + 1]; ++k) {
            const lmb_core_link *link = &core->links[k];
            __builtin_prefetch(&work->light[core->links[k + AHEAD < all ? k + AHEAD : k].target]);
            for (int c = 0; c < 3; ++c) {
                sum.c[c] += link->weight[c] * work->light[link->target].c[c];
            }
        }
        work->next[i] = lmb_rgb_add(core->direct[i], lmb_rgb_scale(sum, 1.0f / (65535.0f * core->samples[i])));
    }
}

static double rgb_sum(lmb_rgb a)
{
    return (double)a.c[0] + (double)a.c[1] + (double)a.c[2];
}

static lmb_rgb rgb_less(lmb_rgb a, lmb_rgb b)
{
    return lmb_rgb_add(a, lmb_rgb_scale(b, -1.0f));
}

static double rgb_dot(lmb_rgb a, lmb_rgb b)
{
    return (double)a.c[0] * (double)b.c[0] + (double)a.c[1] * (double)b.c[1] + (double)a.c[2] * (double)b.c[2];
}

/* After the passes of a cycle: the residual, and its products with the history. */
static void measure_task(void *context, size_t task, int worker)
{
    (void)worker;
    const bounce_work *work = context;
    cycle_sums sums = {.light = 0.0};
    for (uint32_t i = (uint32_t)task * ROWS_PER_TASK; i < task_end(work, task); ++i) {
        const lmb_rgb residual = rgb_less(work->light[i], work->begin[i]);
        if (work->known > 0) {
            const lmb_rgb turn = rgb_less(residual, work->residual[i]);
            work->turn[work->newest][i] = turn;
            work->gain[work->newest][i] = lmb_rgb_add(work->gain[work->newest][i], turn);
        }
        work->residual[i] = residual;
        const double samples = (double)work->core.samples[i];
        const double light = rgb_sum(work->light[i]);
        sums.light += samples * light;
        sums.samples += samples;
        const double scale = light + work->mean;
        const double weight = scale > 0.0 ? samples / (scale * scale) : 0.0;
        for (int a = 0; a < work->known; ++a) {
            for (int b = 0; b <= a; ++b) {
                sums.product[a][b] += weight * rgb_dot(work->turn[a][i], work->turn[b][i]);
            }
            sums.residual[a] += weight * rgb_dot(work->turn[a][i], residual);
        }
    }
    work->sums[task] = sums;
}

/* The combination, from which the next cycle begins. */
static void combine_task(void *context, size_t task, int worker)
{
    (void)worker;
    const bounce_work *work = context;
    double change = 0.0;
    for (uint32_t i = (uint32_t)task * ROWS_PER_TASK; i < task_end(work, task); ++i) {
        double changed = 0.0;
        for (int c = 0; c < 3; ++c) {
            double light = (double)work->light[i].c[c];
            for (int a = 0; a < work->known; ++a) {
                light -= work->factor[a] * (double)work->gain[a][i].c[c];
            }
            const float begin = work->begin[i].c[c];
            work->light[i].c[c] = (float)fmax(light, 0.0);
            work->begin[i].c[c] = work->light[i].c[c];
            work->gain[work->newest][i].c[c] = work->light[i].c[c] - begin;
            changed += fabs((double)work->light[i].c[c] - (double)begin);
        }
        const double scale = rgb_sum(work->light[i]) + DARK * work->mean;
        change += scale > 0.0 ? (double)work->core.samples[i] * changed / scale : 0.0;
    }
    work->sums[task].change = change;
}

static cycle_sums sums_add(const bounce_work *work)
{
    cycle_sums all = {.light = 0.0};
    for (size_t task = 0; task < task_count(work->core.count); ++task) {
        const cycle_sums *sums = &work->sums[task];
        for (int a = 0; a < HISTORY; ++a) {
            for (int b = 0; b <= a; ++b) {
                all.product[a][b] += sums->product[a][b];
            }
            all.residual[a] += sums->residual[a];
        }
        all.light += sums->light;
        all.change += sums->change;
        all.samples += sums->samples;
    }
    return all;
}

/* Solves product x factor = residual for the `known` rows, by Cholesky's method. */
static void factors_solve(cycle_sums *sums, int known, double factor[HISTORY])
{
    for (int a = 0; a < known; ++a) {
        double *row = sums->product[a];
        row[a] *= 1.0 + RIDGE;
        for (int b = 0; b <= a; ++b) {
            for (int k = 0; k < b; ++k) {
                row[b] -= row[k] * sums->product[b][k];
            }
            row[b] = b < a ? row[b] / sums->product[b][b] : sqrt(fmax(row[b], DBL_MIN));
        }
        factor[a] = sums->residual[a];
        for (int k = 0; k < a; ++k) {
            factor[a] -= row[k] * factor[k];
        }
        factor[a] /= row[a];
    }
    for (int a = known - 1; a >= 0; --a) {
        for (int k = a + 1; k < known; ++k) {
            factor[a] -= sums->product[k][a] * factor[k];
        }
        factor[a] /= sums->product[a][a];
    }
}

static lmb_result passes_run(bounce_work *work, int count, lmb_pool *pool, const lmb_progress *progress, int *passes)
{
    for (int i = 0; i < count; ++i) {
        const lmb_result result =
            lmb_pool_run(pool, task_count(work->core.count), pass_task, work, "bounces", progress);
        if (result != LMB_OK) {
            return result;
        }
        lmb_rgb *const swapped = work->light;
        work->light = work->next;
        work->next = swapped;
        ++*passes;
    }
    return LMB_OK;
}

/* Passes, and the combination with those before. `change`: the mean relative change by all of it. */
static lmb_result cycle_run(bounce_work *work, lmb_pool *pool, const lmb_progress *progress, int *passes,
                            double *change)
{
    const size_t tasks = task_count(work->core.count);
    lmb_result result = passes_run(work, CYCLE, pool, progress, passes);
    if (result == LMB_OK) {
        result = lmb_pool_run(pool, tasks, measure_task, work, "bounces", progress);
    }
    if (result != LMB_OK) {
        return result;
    }
    cycle_sums sums = sums_add(work);
    work->mean = sums.samples > 0.0 ? sums.light / sums.samples : 0.0;
    factors_solve(&sums, work->known, work->factor);
    work->newest = work->known < HISTORY ? work->known : (work->newest + 1) % HISTORY;
    result = lmb_pool_run(pool, tasks, combine_task, work, "bounces", progress);
    work->known += work->known < HISTORY ? 1 : 0;
    sums = sums_add(work);
    *change = sums.samples > 0.0 ? sums.change / sums.samples : 0.0;
    return result;
}

static int passes_most(size_t links)
{
    const size_t passes = LINKS_IN_ALL / (links + 1);
    return passes < MIN_PASSES ? MIN_PASSES : passes < MAX_PASSES ? (int)passes : MAX_PASSES;
}

/* One block of memory for all vectors. */
static lmb_rgb *vectors_lay_out(bounce_work *work)
{
    const size_t rows = work->core.count;
    lmb_rgb *const memory = malloc((VECTORS * rows + 1) * sizeof *memory);
    lmb_rgb **const vector[VECTORS] = {&work->light,   &work->next,    &work->begin,   &work->residual, &work->turn[0],
                                       &work->turn[1], &work->turn[2], &work->gain[0], &work->gain[1],  &work->gain[2]};
    for (size_t i = 0; memory && i < VECTORS; ++i) {
        *vector[i] = memory + i * rows;
    }
    return memory;
}

static lmb_result passes_choose(bounce_work *work, int bounces, lmb_pool *pool, const lmb_progress *progress,
                                int *passes)
{
    const size_t bytes = work->core.count * sizeof *work->light;
    memcpy(work->light, work->core.direct, bytes);
    memcpy(work->begin, work->core.direct, bytes);
    if (bounces >= 0) {
        return passes_run(work, bounces, pool, progress, passes);
    }
    const int most = passes_most(work->core.first[work->core.count]);
    lmb_result result = LMB_OK;
    double change = 1.0;
    while (result == LMB_OK && *passes < most && change > STILL) {
        result = cycle_run(work, pool, progress, passes, &change);
    }
    return result;
}

lmb_result lmb_bounces_sum(const lmb_bounce_rows *rows, int bounces, lmb_pool *pool, const lmb_progress *progress,
                           int *passes)
{
    bounce_work work = {.known = 0};
    *passes = 0;
    const int counted = bounces <= passes_most(rows->first[rows->count]) ? bounces : -1;
    lmb_result result = lmb_bounce_core_make(rows, counted >= 0, &work.core);
    lmb_rgb *const memory = result == LMB_OK ? vectors_lay_out(&work) : NULL;
    work.sums = calloc(task_count(work.core.count) + 1, sizeof *work.sums);
    if (result == LMB_OK) {
        result = memory && work.sums ? passes_choose(&work, counted, pool, progress, passes) : LMB_ERROR_MEMORY;
    }
    if (result == LMB_OK) {
        lmb_bounce_core_spread(&work.core, rows, work.light);
    }
    lmb_bounce_core_free(&work.core);
    free(memory);
    free(work.sums);
    return result;
}

size_t lmb_bounces_bytes(uint32_t count, size_t links)
{
    return VECTORS * count * sizeof(lmb_rgb) + lmb_bounce_core_bytes(count, links);
}
