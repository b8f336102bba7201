#include <lambent/probe.h>

#include <assert.h>
#include <string.h>

#include <lambent/sequence.h>

#include "bake_internal.h"

/* Sums of thousands of samples are kept in double. */
typedef struct lmb_moment_sum {
    double c[3][LMB_SH3_COUNT];
} lmb_moment_sum;

static void moment_sink(void *context, lmb_vec3 direction, lmb_rgb weight)
{
    lmb_moment_sum *sum = context;
    const lmb_sh3 basis = lmb_sh3_basis(direction);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            sum->c[c][i] += (double)weight.c[c] * (double)basis.c[i];
        }
    }
}

static uint64_t replicate_stream(const lmb_transport *transport, const lmb_gather_point *point, uint32_t replicate)
{
    uint64_t stream = lmb_stream_of_position(transport->seed, point->position);
    if (point->hemisphere) {
        stream = lmb_stream_of_position(stream, point->normal);
    }
    return lmb_mix(stream, replicate);
}

/* Mean moments of one replicate. Of the element's blocks, taken in turn, every LMB_GATHER_REPLICATES-th is its own. */
static void replicate_gather(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                             uint32_t replicate, uint32_t samples, lmb_moment_sum *mean, uint64_t *rays)
{
    const uint64_t stream = replicate_stream(transport, points, replicate);
    memset(mean, 0, sizeof *mean);
    for (uint32_t first = 0; first < samples; first += LMB_GATHER_BLOCK) {
        const uint32_t block = first / LMB_GATHER_BLOCK * LMB_GATHER_REPLICATES + replicate;
        const uint32_t count = samples - first < LMB_GATHER_BLOCK ? samples - first : LMB_GATHER_BLOCK;
        lmb_gather(transport, &points[block % point_count], stream, first, count, moment_sink, mean, rays);
    }
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            mean->c[c][i] /= (double)samples;
        }
    }
}

static uint32_t replicate_samples(uint32_t samples)
{
    const uint32_t share = (samples + LMB_GATHER_REPLICATES - 1) / LMB_GATHER_REPLICATES;
    return share > 0 ? share : 1;
}

/* Mean of the replicates, and the standard error of that mean from their spread. */
static void replicates_combine(const lmb_moment_sum mean[LMB_GATHER_REPLICATES], lmb_gathered *gathered)
{
    const double count = LMB_GATHER_REPLICATES;
    gathered->squared_length = 0.0;
    gathered->squared_error = 0.0;
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            double sum = 0.0;
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                sum += mean[r].c[c][i];
            }
            const double average = sum / count;
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                const double off = mean[r].c[c][i] - average;
                gathered->squared_error += off * off / (count * (count - 1.0));
            }
            gathered->squared_length += average * average;
            gathered->moments.channel[c].c[i] = (float)average;
        }
    }
}

double lmb_relative_error(double squared_error, double squared_length)
{
    return squared_length > 0.0 ? sqrt(squared_error / squared_length) : 0.0;
}

typedef struct lmb_replicate_work {
    const lmb_transport *transport;
    const lmb_gather_point *points;
    uint32_t point_count;
    uint32_t samples;
    lmb_moment_sum mean[LMB_GATHER_REPLICATES];
    uint64_t rays[LMB_GATHER_REPLICATES];
} lmb_replicate_work;

static void replicate_task(void *context, size_t task, int worker)
{
    (void)worker;
    lmb_replicate_work *work = context;
    replicate_gather(work->transport, work->points, work->point_count, (uint32_t)task, work->samples, &work->mean[task],
                     &work->rays[task]);
}

static void replicates_finish(const lmb_replicate_work *work, lmb_gathered *gathered)
{
    replicates_combine(work->mean, gathered);
    gathered->rays = 0;
    for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
        gathered->rays += work->rays[r];
    }
}

void lmb_gather_sh3_area(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                         uint32_t samples, lmb_gathered *gathered)
{
    lmb_replicate_work work = {
        .transport = transport, .points = points, .point_count = point_count, .samples = replicate_samples(samples)};
    for (size_t r = 0; r < LMB_GATHER_REPLICATES; ++r) {
        replicate_task(&work, r, 0);
    }
    replicates_finish(&work, gathered);
}

void lmb_gather_sh3(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                    lmb_gathered *gathered)
{
    lmb_gather_sh3_area(transport, point, 1, samples, gathered);
}

lmb_result lmb_gather_sh3_parallel(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                                   lmb_pool *pool, const lmb_progress *progress, lmb_gathered *gathered)
{
    lmb_replicate_work work = {
        .transport = transport, .points = point, .point_count = 1, .samples = replicate_samples(samples)};
    const lmb_result result = lmb_pool_run(pool, LMB_GATHER_REPLICATES, replicate_task, &work, "probe", progress);
    if (result == LMB_OK) {
        replicates_finish(&work, gathered);
    }
    return result;
}

typedef struct lmb_irradiance_sum {
    const lmb_vec3 *normals;
    int count;
    double sum[LMB_GATHER_MAX_NORMALS][3];
} lmb_irradiance_sum;

static void irradiance_sink(void *context, lmb_vec3 direction, lmb_rgb weight)
{
    lmb_irradiance_sum *sum = context;
    for (int k = 0; k < sum->count; ++k) {
        const double cosine = (double)vec3_dot(sum->normals[k], direction);
        for (int c = 0; c < 3 && cosine > 0.0; ++c) {
            sum->sum[k][c] += (double)weight.c[c] * cosine;
        }
    }
}

void lmb_gather_irradiance(const lmb_transport *transport, const lmb_gather_point *point, uint32_t replicate,
                           uint32_t samples, const lmb_vec3 *normals, int count, lmb_rgb *irradiance, uint64_t *rays)
{
    assert(count <= LMB_GATHER_MAX_NORMALS);
    lmb_irradiance_sum sum = {.normals = normals, .count = count};
    lmb_gather(transport, point, replicate_stream(transport, point, replicate), 0, samples, irradiance_sink, &sum,
               rays);
    for (int k = 0; k < count; ++k) {
        for (int c = 0; c < 3; ++c) {
            irradiance[k].c[c] = (float)(sum.sum[k][c] / (LMB_PI * (double)samples));
        }
    }
}
