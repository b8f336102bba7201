#include "transport/gather_sh3_internal.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <lambent/key_lights.h>
#include <lambent/vector.h>

#include "base/vectorised.h"

enum { LANES = LMB_CONTRIBUTION_LANES };
_Static_assert(LMB_GATHER_REPLICATES == 2, "their difference is one");

/* Sums of thousands of samples are kept in double, those of every LANES-th contribution apart. */
typedef struct lmb_moment_sum {
    double c[3][LMB_SH3_COUNT][LANES];
} lmb_moment_sum;

/* The basis as polynomials without their factors, in its order. */
typedef struct basis_batch {
    float polynomial[LMB_SH3_COUNT][LMB_CONTRIBUTION_BATCH];
} basis_batch;

LMB_VECTORISED
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

LMB_VECTORISED
static void moments_add(const lmb_contributions *found, const basis_batch *basis, lmb_moment_sum *sum)
{
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            lanes_dot_add(found->weight[c], basis->polynomial[i], found->count, sum->c[c][i]);
        }
    }
}

/* Of samples that start at the first half of an element's points, and at the second; and of both, what is steady. */
typedef struct moment_halves {
    lmb_moment_sum half[2];
    lmb_moment_sum steady;
} moment_halves;

static void moment_sink(void *context, const lmb_contributions *found)
{
    moment_halves *sums = context;
    basis_batch basis;
    basis_make(found, &basis);
    moments_add(found, &basis, &sums->half[found->second_half]);
    if (found->steady) {
        moments_add(found, &basis, &sums->steady);
    }
}

static void punctual_sink(void *context, const lmb_contributions *found)
{
    basis_batch basis;
    basis_make(found, &basis);
    moments_add(found, &basis, context);
}

/* The basis' factors, from where its polynomials are 1, or 2 in one case. */
static lmb_sh3 basis_factors(void)
{
    const lmb_sh3 x = lmb_sh3_basis(lmb_vec3_of(1.0f, 0.0f, 0.0f));
    const lmb_sh3 z = lmb_sh3_basis(lmb_vec3_of(0.0f, 0.0f, 1.0f));
    lmb_sh3 factors = lmb_sh3_basis(lmb_vec3_of(1.0f, 1.0f, 1.0f));
    factors.c[6] = 0.5f * z.c[6];
    factors.c[8] = x.c[8];
    return factors;
}

/* Samples of an element on their way. */
typedef struct gather_work {
    const lmb_transport *transport;
    lmb_gather_samples samples;               /* those to be taken now, of the first replicate */
    moment_halves sum[LMB_GATHER_REPLICATES]; /* of polynomials */
    uint64_t rays[LMB_GATHER_REPLICATES];
    lmb_moment_sum punctual; /* what they give each sample, where the samples leave it out */
    uint64_t punctual_rays;
    float key_visibility[LMB_KEY_LIGHTS_MOST];
} gather_work;

static double lanes_sum(const double lane[LANES])
{
    return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

/* Adds what work has found since it began. */
static void sums_add(lmb_sh3_sums *sums, const gather_work *work)
{
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                const double first = lanes_sum(work->sum[r].half[0].c[c][i]);
                const double second = lanes_sum(work->sum[r].half[1].c[c][i]);
                sums->replicate[r][c][i] += first + second;
                sums->first_half[r][c][i] += first;
                sums->steady[r][c][i] += lanes_sum(work->sum[r].steady.c[c][i]);
            }
            sums->punctual[c][i] += lanes_sum(work->punctual.c[c][i]);
        }
    }
    sums->points = work->samples.point_count;
    sums->taken += work->samples.count;
    sums->rays += work->punctual_rays;
    for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
        sums->rays += work->rays[r];
    }
}

/* Of a replicate's samples, those that start at the first half of the points. They go round the points, the second
 * replicate from the second half on. */
static uint32_t first_half_samples(const lmb_sh3_sums *sums, int replicate)
{
    const uint32_t round = LMB_GATHER_BLOCK * sums->points, first = LMB_GATHER_BLOCK * (sums->points / 2);
    const uint32_t rest = sums->taken % round, before = replicate == 0 ? 0 : round - first;
    const uint32_t beyond = rest > before ? rest - before : 0;
    return sums->taken / round * first + (beyond < first ? beyond : first);
}

/* The squared error of the mean over all points in the squared contrast between the means over two halves of them,
 * where the points are random: half n1 of n and n2 of n differ by 1 / n1 + 1 / n2 of a point's variance. Those of a
 * texel are spread over it, and err less: by COMMON_SHARE of that (lambent_quality, texels of the demo level). */
#define COMMON_SHARE 0.5

/* The squared error that all replicates have in common, because they start at the same points; once each has started
 * at all of them. The product of two replicates' contrasts has the mean of the squared contrast of the points alone,
 * whatever each one's own noise. */
static double common_error(const lmb_sh3_sums *sums, const lmb_sh3 *factors)
{
    if (sums->points < 2 || sums->taken < LMB_GATHER_BLOCK * sums->points) {
        return 0.0;
    }
    double count[LMB_GATHER_REPLICATES][2], sum = 0.0;
    for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
        count[r][0] = first_half_samples(sums, r);
        count[r][1] = sums->taken - count[r][0];
    }
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            double product = (double)factors->c[i] * (double)factors->c[i];
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                const double first = sums->first_half[r][c][i];
                product *= first / count[r][0] - (sums->replicate[r][c][i] - first) / count[r][1];
            }
            sum += product;
        }
    }
    const double half = sums->points / 2, others = sums->points - half;
    return COMMON_SHARE * half * others / (sums->points * (double)sums->points) * sum;
}

void lmb_sh3_sums_combine(const lmb_sh3_sums *sums, lmb_gathered *gathered)
{
    const double count = LMB_GATHER_REPLICATES;
    const lmb_sh3 factors = basis_factors();
    *gathered = (lmb_gathered){.samples = LMB_GATHER_REPLICATES * sums->taken, .rays = sums->rays};
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < LMB_SH3_COUNT; ++i) {
            const double scale = (double)factors.c[i] / (double)sums->taken;
            double replicate[LMB_GATHER_REPLICATES];
            double sum = 0.0;
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                replicate[r] = scale * sums->replicate[r][c][i];
                sum += replicate[r];
            }
            const double average = sum / count;
            const double punctual = (double)factors.c[i] * sums->punctual[c][i];
            const double steady[] = {scale * sums->steady[0][c][i], scale * sums->steady[1][c][i]};
            const double whole = average + punctual;
            for (int r = 0; r < LMB_GATHER_REPLICATES; ++r) {
                const double off = replicate[r] - average;
                gathered->squared_error += off * off / (count * (count - 1.0));
            }
            const double light = whole + (double)sums->keys.channel[c].c[i];
            gathered->squared_length += whole * whole;
            gathered->squared_light += light * light;
            gathered->moments.channel[c].c[i] = (float)whole;
            gathered->steady.channel[c].c[i] = (float)(punctual + 0.5 * (steady[0] + steady[1]));
            gathered->difference.channel[c].c[i] =
                (float)(0.5 * ((replicate[0] - steady[0]) - (replicate[1] - steady[1])));
        }
    }
    gathered->squared_error = fmax(gathered->squared_error + common_error(sums, &factors), 0.0);
    memcpy(gathered->key_visibility, sums->key_visibility, sizeof gathered->key_visibility);
}

double lmb_relative_error(double squared_error, double squared_length)
{
    return squared_length > 0.0 ? sqrt(squared_error / squared_length) : 0.0;
}

uint32_t lmb_replicate_share(uint32_t samples, uint32_t multiple)
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
    work->samples =
        (lmb_gather_samples){.points = points, .point_count = point_count, .count = count, .without_keys = true};
    if (point_count == 1) {
        work->samples.without_punctual =
            lmb_gather_punctual(transport, points, true, punctual_sink, &work->punctual, &work->punctual_rays);
    }
    lmb_gather_keys(transport, points, point_count, work->key_visibility, &work->punctual_rays);
}

/* Of work that has begun. */
static void sums_take_keys(lmb_sh3_sums *sums, const gather_work *work)
{
    lmb_key_light light[LMB_KEY_LIGHTS_MOST];
    const uint32_t count = lmb_scene_key_lights(lmb_tracer_scene(work->transport->tracer), light);
    memcpy(sums->key_visibility, work->key_visibility, sizeof sums->key_visibility);
    for (uint32_t i = 0; i < count; ++i) {
        lmb_key_light_add_to_sh3(&light[i], work->key_visibility[i], &sums->keys);
    }
}

static void work_gather(gather_work *work)
{
    for (uint32_t r = 0; r < LMB_GATHER_REPLICATES; ++r) {
        lmb_gather_samples samples = work->samples;
        samples.replicate = r;
        lmb_gather(work->transport, &samples, moment_sink, &work->sum[r], &work->rays[r]);
    }
}

void lmb_sh3_sums_begin(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                        uint32_t count, lmb_sh3_sums *sums)
{
    gather_work work; /* large: begun where it is */
    work_begin(&work, transport, points, point_count, count);
    work_gather(&work);
    memset(sums, 0, sizeof *sums);
    sums->without_punctual = work.samples.without_punctual;
    sums_take_keys(sums, &work);
    sums_add(sums, &work);
}

void lmb_sh3_sums_continue(const lmb_transport *transport, const lmb_gather_point *points, uint32_t count,
                           lmb_sh3_sums *sums)
{
    gather_work work;
    memset(&work, 0, sizeof work);
    work.transport = transport;
    work.samples = (lmb_gather_samples){.points = points,
                                        .point_count = sums->points,
                                        .first = sums->taken,
                                        .count = count - sums->taken,
                                        .without_punctual = sums->without_punctual,
                                        .without_keys = true};
    work_gather(&work);
    sums_add(sums, &work);
}

void lmb_gather_sh3_area(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                         uint32_t samples, lmb_gathered *gathered)
{
    lmb_sh3_sums sums;
    lmb_sh3_sums_begin(transport, points, point_count, lmb_replicate_share(samples, 1), &sums);
    lmb_sh3_sums_combine(&sums, gathered);
}

void lmb_gather_sh3(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                    lmb_gathered *gathered)
{
    lmb_gather_sh3_area(transport, point, 1, samples, gathered);
}

/* Parts of each replicate, for threads to share. */
enum { PARTS = 16 };

typedef struct parallel_work {
    const gather_work *work;
    moment_halves sum[LMB_GATHER_REPLICATES * PARTS];
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
    work_begin(&work, transport, point, 1, lmb_replicate_share(samples, 1));
    parallel_work *parallel = calloc(1, sizeof *parallel);
    if (!parallel) {
        return LMB_ERROR_MEMORY;
    }
    parallel->work = &work;
    const lmb_result result = lmb_pool_run(pool, LMB_GATHER_REPLICATES * PARTS, part_task, parallel, "probe", progress);
    if (result == LMB_OK) {
        for (int task = 0; task < LMB_GATHER_REPLICATES * PARTS; ++task) {
            moments_sum(&parallel->sum[task].half[0], &work.sum[task / PARTS].half[0]); /* a single point */
            moments_sum(&parallel->sum[task].steady, &work.sum[task / PARTS].steady);
            work.rays[task / PARTS] += parallel->rays[task];
        }
        lmb_sh3_sums sums;
        memset(&sums, 0, sizeof sums);
        sums_take_keys(&sums, &work);
        sums_add(&sums, &work);
        lmb_sh3_sums_combine(&sums, gathered);
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
        const lmb_vec3 direction = lmb_vec3_of(found->direction[0][i], found->direction[1][i], found->direction[2][i]);
        for (int k = 0; k < sum->count; ++k) {
            const double cosine = (double)lmb_vec3_dot(sum->normals[k], direction);
            for (int c = 0; c < 3 && cosine > 0.0; ++c) {
                sum->sum[k][c] += (double)found->weight[c][i] * cosine;
            }
        }
    }
}

void lmb_gather_irradiance(const lmb_transport *transport, const lmb_gather_samples *samples, const lmb_vec3 *normals,
                           int count, lmb_rgb *irradiance, uint64_t *rays)
{
    assert(count <= LMB_GATHER_MAX_NORMALS);
    lmb_irradiance_sum sum = {.normals = normals, .count = count};
    lmb_gather(transport, samples, irradiance_sink, &sum, rays);
    for (int k = 0; k < count; ++k) {
        for (int c = 0; c < 3; ++c) {
            irradiance[k].c[c] = (float)(sum.sum[k][c] / (LMB_PI * (double)samples->count));
        }
    }
}
