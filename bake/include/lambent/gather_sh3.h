/* Gathering SH3 radiance: at a probe over the sphere, at a surface point over its hemisphere. */
#ifndef LAMBENT_GATHER_SH3_H
#define LAMBENT_GATHER_SH3_H

#include <lambent/gather.h>
#include <lambent/pool.h>
#include <lambent/sh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* SH moments of what a point receives, integral of L Y over its sphere or hemisphere. Over the sphere they are the SH
 * coefficients; over a hemisphere lmb_sh3_fit_hemisphere turns them into coefficients. The direct light of the scene's
 * key lights (lambent/key_lights.h) is apart from them: what is seen of each. */
typedef struct lmb_gathered {
    lmb_sh3_rgb moments;
    lmb_sh3_rgb steady;     /* the part of them that has hardly any noise: direct light of few punctual lights */
    lmb_sh3_rgb difference; /* half of the first replicate less the second, of the rest: one is the rest + difference,
                               the other the rest - difference */
    float key_visibility[LMB_KEY_LIGHTS_MOST];
    double squared_error;  /* of the moments' vector: the sum of its components' squared standard errors */
    double squared_length; /* of the moments' vector */
    double squared_light;  /* the same with what key lights give */
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

/* The same as lmb_gather_sh3, but for rounding, by the pool's threads; the same for any number of them.
 * @return LMB_ERROR_INTERRUPTED, _MEMORY */
lmb_result lmb_gather_sh3_parallel(const lmb_transport *transport, const lmb_gather_point *point, uint32_t samples,
                                   lmb_pool *pool, const lmb_progress *progress, lmb_gathered *gathered);

/* Normalised irradiance on each of `count` normals from what the points receive, by the same samples: the truth that
 * everything stored is compared with. Only light over the points' hemisphere counts, key lights' too. Bakes gather with
 * the first LMB_GATHER_REPLICATES replicates; different ones are independent. Adds to `*rays`. */
enum { LMB_GATHER_MAX_NORMALS = 16 };
void lmb_gather_irradiance(const lmb_transport *transport, const lmb_gather_samples *samples, const lmb_vec3 *normals,
                           int count, lmb_rgb *irradiance, uint64_t *rays);

#ifdef __cplusplus
}
#endif

#endif
