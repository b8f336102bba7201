/* Gathering SH3 radiance: at a probe over the sphere, at a surface point over its hemisphere. */
#ifndef LAMBENT_PROBE_H
#define LAMBENT_PROBE_H

#include <lambent/pool.h>
#include <lambent/sh.h>
#include <lambent/transport.h>

#ifdef __cplusplus
extern "C" {
#endif

/* SH moments of what a point receives, integral of L Y over its sphere or hemisphere. Over the sphere they are the SH
 * coefficients; over a hemisphere lmb_sh3_fit_hemisphere turns them into coefficients. */
typedef struct lmb_gathered {
    lmb_sh3_rgb moments;
    double squared_error;  /* of the moments' vector: the sum of its components' squared standard errors */
    double squared_length; /* of the moments' vector */
    uint32_t samples;      /* that were taken */
    uint64_t rays;
} lmb_gathered;

/* Standard error relative to what it is the error of, for one gathering or the sums over many; 0 when all is dark. */
double lmb_relative_error(double squared_error, double squared_length);

/* Takes `samples` samples (at least one for each replicate) at one point, as LMB_GATHER_REPLICATES replicates whose
 * spread is the error estimate. Runs on the calling thread. */
void lmb_gather_sh3(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                    lmb_gathered *gathered);

/* The mean over several points (lmb_gather_samples): a texel's light is the mean over its area. As many points as there
 * are blocks of samples spread them best. */
void lmb_gather_sh3_area(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                         uint32_t samples, lmb_gathered *gathered);

/* How many samples elements get: `samples`, the pilot, and then up to `max_samples` as the standard error of the pilot
 * wants them for the tolerance: relative to the length of the moments, or to `floor` where they are shorter. */
typedef struct lmb_gather_effort {
    uint32_t samples;     /* > 0; rounded up: to a multiple of LMB_GATHER_REPLICATES, or of blocks of them where there
                             may be more */
    uint32_t max_samples; /* not above `samples`: just those */
    double tolerance;
    double floor; /* as lmb_gathered.squared_length, not squared */
} lmb_gather_effort;

/* One of a group of neighbours. */
typedef struct lmb_gather_element {
    const lmb_gather_point *points;
    uint32_t point_count;
    lmb_gathered gathered; /* set */
} lmb_gather_element;

/* Gathers at elements that lie together. What each takes after its pilot is decided by the pilots of the *others*: an
 * element that went on for as long as its own samples looked too few would end, for good, where these found no light,
 * and so be too dark on average, without its error estimate knowing. By the others' it depends on nothing that it found
 * itself: light that one of sixty pilots finds is looked for by all, and mean and error estimate stay unbiased. An
 * element alone takes `max_samples`. */
enum { LMB_GATHER_GROUP = 64, LMB_GATHER_GROUP_MOST = 2 * LMB_GATHER_GROUP - 1 };
void lmb_gather_sh3_group(const lmb_transport *transport, const lmb_gather_effort *effort, lmb_gather_element *elements,
                          uint32_t count);

/* Groups that `total` elements in a row are gathered in, and the first of group `group`; the last takes the rest. */
size_t lmb_gather_group_count(size_t total);
size_t lmb_gather_group_first(size_t total, size_t group);

/* Samples for an element of such a pilot, were it alone to decide: for forecasts. */
uint32_t lmb_gather_effort_samples(const lmb_gather_effort *effort, const lmb_gathered *pilot);

/* The same as lmb_gather_sh3, but for rounding, by the pool's threads; the same for any number of them.
 * @return LMB_ERROR_INTERRUPTED, _MEMORY */
lmb_result lmb_gather_sh3_parallel(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                                   lmb_pool *pool, const lmb_progress *progress, lmb_gathered *gathered);

/* Normalised irradiance on each of `count` normals from what the point receives, by the same samples: the truth that
 * everything stored is compared with. Only light over the point's hemisphere counts. Takes `samples` samples of
 * replicate `replicate` (different ones are independent). Adds to `*rays`. */
enum { LMB_GATHER_MAX_NORMALS = 16 };
void lmb_gather_irradiance(const lmb_transport *transport, const lmb_gather_point *point, uint32_t replicate,
                           uint32_t samples, const lmb_vec3 *normals, int count, lmb_rgb *irradiance, uint64_t *rays);

#ifdef __cplusplus
}
#endif

#endif
