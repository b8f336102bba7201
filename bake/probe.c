#include <lambent/probe.h>

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "bake_internal.h"
#include "lanes.h"

enum { LANES = LMB_CONTRIBUTION_LANES };

/* Sums of thousands of samples are kept in double, those of every LANES-th contribution apart. */
typedef struct lmb_moment_sum {
    double c[3][LMB_SH3_COUNT][LANES];
} lmb_moment_sum;

/* The basis as polynomials without their factors, in its order. */
typedef struct basis_batch {
    float polynomial[LMB_SH3_COUNT][LMB_CONTRIBUTION_BATCH];
} basis_batch;

LMB_LANES
static void basis_make(const lmb_contributions *found, basis_batch *basis)
{
    for (uint32_t i = 0; i < found->count; ++i) {
        const float x = found->direction[0][i], y = found->direction[1][i], z = found->direction[2][i];
        basis->polynomial[0][i] = 1.0f;
        basis->polynomial[1][i] = y;
        basis->polynomial[2][i] = z;
        basis->polynomial[3][i] = x;
        basis->polynomial[4][i] = x * y;
        basis->polynomial[5][i] = y * z;
        basis->polynomial[6][i] = 3.0f * z * z - 1.0f;
        basis->polynomial[7][i] = x * z;
        basis->polynomial[8][i] = x * x - y * y;
    }
}

/* Adds a[i] b[i] to sum[i % LANES]. */
static inline void lanes_dot_add(const float *restrict a, const float *restrict b, uint32_t count, double *restrict sum)
{
    float lane[LANES] = {0.0f};
    for (uint32_t i = 0; i < count; i += LANES) {
        for (uint32_t k = 0; k < LANES; ++k) {
            lane[k] += a[i + k] * b[i + k];
        }
    }
    for (uint32_t k = 0; k < LANES; ++k) {
        sum[k] += (double)lane[k];
    }
}

LMB_LANES
static void moments_add(const lmb_contributions *found, const basis_batch *basis, lmb_moment_sum *sum)
{
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            lanes_dot_add(found->weight[c], basis->polynomial[i], found->count, sum->c[c][i]);
        }
    }
}

static void moment_sink(void *context, const lmb_contributions *found)
{
    basis_batch basis;
    basis_make(found, &basis);
    moments_add(found, &basis, context);
}

/* The basis' factors, from where its polynomials are 1, or 2 in one case. */
static lmb_sh3 basis_factors(void)
{
    const lmb_sh3 x = lmb_sh3_basis(vec3(1.0f, 0.0f, 0.0f));
    const lmb_sh3 z = lmb_sh3_basis(vec3(0.0f, 0.0f, 1.0f));
    lmb_sh3 factors = lmb_sh3_basis(vec3(1.0f, 1.0f, 1.0f));
    factors.c[6] = 0.5f * z.c[6];
    factors.c[8] = x.c[8];
    return factors;
}

/* An element while it is gathered. */
typedef struct gather_work {
    const lmb_transport *transport;
    lmb_gather_samples samples;                /* those to be taken now, of the first replicate */
    lmb_moment_sum sum[LMB_GATHER_REPLICATES]; /* of polynomials */
    uint64_t rays[LMB_GATHER_REPLICATES];
    lmb_moment_sum punctual; /* what they give each sample, where the samples leave it out */
    uint64_t punctual_rays;
} gather_work;

static double lanes_sum(const double lane[LANES])
{
    return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

/* Mean of the replicates, and the standard error of that mean from their spread. */
static void replicates_combine(const gather_work *work, lmb_gathered *gathered)
{
    const double count = LMB_GATHER_REPLICATES;
    const lmb_sh3 factors = basis_factors();
    const uint32_t taken = work->samples.first + work->samples.count;
    *gathered = (lmb_gathered){.samples = LMB_GATHER_REPLICATES * taken, .rays = work->punctual_rays};
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const double scale = (double)factors.c[i] / (double)taken;
            double replicate[LMB_GATHER_REPLICATES];
            double sum = 0.0;
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                replicate[r] = scale * lanes_sum(work->sum[r].c[c][i]);
                sum += replicate[r];
            }
            const double average = sum / count;
            const double whole = average + (double)factors.c[i] * lanes_sum(work->punctual.c[c][i]);
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                const double off = replicate[r] - average;
                gathered->squared_error += off * off / (count * (count - 1.0));
            }
            gathered->squared_length += whole * whole;
            gathered->moments.channel[c].c[i] = (float)whole;
        }
    }
    for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
        gathered->rays += work->rays[r];
    }
}

double lmb_relative_error(double squared_error, double squared_length)
{
    return squared_length > 0.0 ? sqrt(squared_error / squared_length) : 0.0;
}

static uint32_t replicate_share(uint32_t samples, uint32_t multiple)
{
    const uint32_t step = LMB_GATHER_REPLICATES * multiple;
    const uint32_t shares = samples / step + (samples % step > 0);
    return (shares > 0 ? shares : 1) * multiple;
}

static void work_begin(gather_work *work, const lmb_transport *transport, const lmb_gather_point *points,
                       uint32_t point_count, uint32_t count)
{
    memset(work, 0, sizeof *work);
    work->transport = transport;
    work->samples = (lmb_gather_samples){.points = points, .point_count = point_count, .count = count};
    if (point_count == 1) {
        work->samples.without_punctual =
            lmb_gather_punctual(transport, points, moment_sink, &work->punctual, &work->punctual_rays);
    }
}

static bool effort_is_enough(const lmb_gather_effort *effort, const lmb_gathered *gathered)
{
    const double floor_squared = effort->floor * effort->floor;
    const double squared = gathered->squared_length > floor_squared ? gathered->squared_length : floor_squared;
    return gathered->squared_error <= effort->tolerance * effort->tolerance * squared;
}

void lmb_gather_sh3_area(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                         const lmb_gather_effort *effort, lmb_gathered *gathered)
{
    const bool adapts = effort->max_samples > effort->samples;
    const uint32_t begin = replicate_share(effort->samples, adapts ? LMB_GATHER_BLOCK : 1);
    const uint32_t most = adapts ? replicate_share(effort->max_samples, LMB_GATHER_BLOCK) : begin;
    gather_work work; /* large: begun where it is */
    work_begin(&work, transport, points, point_count, begin);
    for (;;) {
        for (uint32_t r = 0; r < LMB_GATHER_REPLICATES; ++r) {
            lmb_gather_samples samples = work.samples;
            samples.replicate = r;
            lmb_gather(transport, &samples, moment_sink, &work.sum[r], &work.rays[r]);
        }
        replicates_combine(&work, gathered);
        const uint32_t taken = work.samples.first + work.samples.count;
        if (taken >= most || effort_is_enough(effort, gathered)) {
            return;
        }
        work.samples.first = taken;
        work.samples.count = most - taken < taken ? most - taken : taken;
    }
}

void lmb_gather_sh3(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                    lmb_gathered *gathered)
{
    const lmb_gather_effort effort = {.samples = samples};
    lmb_gather_sh3_area(transport, point, 1, &effort, gathered);
}

/* Parts of each replicate, for threads to share. */
enum { PARTS = 16 };

typedef struct parallel_work {
    const gather_work *work;
    lmb_moment_sum sum[LMB_GATHER_REPLICATES * PARTS];
    uint64_t rays[LMB_GATHER_REPLICATES * PARTS];
} parallel_work;

static void part_task(void *context, size_t task, int worker)
{
    (void)worker;
    parallel_work *parallel = context;
    lmb_gather_samples samples = parallel->work->samples;
    const uint32_t all = samples.count;
    const uint32_t most = (all / PARTS / LMB_GATHER_BLOCK + 1) * LMB_GATHER_BLOCK;
    samples.replicate = (uint32_t)task / PARTS;
    samples.first = (uint32_t)task % PARTS * most;
    if (samples.first < all) {
        samples.count = all - samples.first < most ? all - samples.first : most;
        lmb_gather(parallel->work->transport, &samples, moment_sink, &parallel->sum[task], &parallel->rays[task]);
    }
}

static void moments_sum(const lmb_moment_sum *part, lmb_moment_sum *sum)
{
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            for (int k = 0; k < LANES; ++k) {
                sum->c[c][i][k] += part->c[c][i][k];
            }
        }
    }
}

lmb_result lmb_gather_sh3_parallel(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                                   lmb_pool *pool, const lmb_progress *progress, lmb_gathered *gathered)
{
    gather_work work;
    work_begin(&work, transport, point, 1, replicate_share(samples, 1));
    parallel_work *parallel = calloc(1, sizeof *parallel);
    if (!parallel) {
        return LMB_ERROR_MEMORY;
    }
    parallel->work = &work;
    const lmb_result result = lmb_pool_run(pool, LMB_GATHER_REPLICATES * PARTS, part_task, parallel, "probe", progress);
    if (result == LMB_OK) {
        for (int task = 0; task < LMB_GATHER_REPLICATES * PARTS; ++task) {
            moments_sum(&parallel->sum[task], &work.sum[task / PARTS]);
            work.rays[task / PARTS] += parallel->rays[task];
        }
        replicates_combine(&work, gathered);
    }
    free(parallel);
    return result;
}

typedef struct lmb_irradiance_sum {
    const lmb_vec3 *normals;
    int count;
    double sum[LMB_GATHER_MAX_NORMALS][3];
} lmb_irradiance_sum;

static void irradiance_sink(void *context, const lmb_contributions *found)
{
    lmb_irradiance_sum *sum = context;
    for (uint32_t i = 0; i < found->count; ++i) {
        const lmb_vec3 direction = vec3(found->direction[0][i], found->direction[1][i], found->direction[2][i]);
        for (int k = 0; k < sum->count; ++k) {
            const double cosine = (double)vec3_dot(sum->normals[k], direction);
            for (int c = 0; c < 3 && cosine > 0.0; ++c) {
                sum->sum[k][c] += (double)found->weight[c][i] * cosine;
            }
        }
    }
}

void lmb_gather_irradiance(const lmb_transport *transport, const lmb_gather_point *point, uint32_t replicate,
                           uint32_t samples, const lmb_vec3 *normals, int count, lmb_rgb *irradiance, uint64_t *rays)
{
    assert(count <= LMB_GATHER_MAX_NORMALS);
    lmb_irradiance_sum sum = {.normals = normals, .count = count};
    const lmb_gather_samples taken = {.points = point, .point_count = 1, .replicate = replicate, .count = samples};
    lmb_gather(transport, &taken, irradiance_sink, &sum, rays);
    for (int k = 0; k < count; ++k) {
        for (int c = 0; c < 3; ++c) {
            irradiance[k].c[c] = (float)(sum.sum[k][c] / (LMB_PI * (double)samples));
        }
    }
}
