/* The gather: how much light arrives at a point, by direction.
 *
 * Everything that is baked asks the same question, so there is one estimator behind it: the gather. A point (a probe
 * in space, or a texel that owns a hemisphere) collects contributions, pairs of a direction and a weight in radiance
 * times solid angle, such that the expected sum of f(direction) weight over the contributions of one sample is the
 * integral of f L over the point's sphere or hemisphere, for any f. Probes, lightmaps and checks differ only in f. */
#ifndef LAMBENT_GATHER_H
#define LAMBENT_GATHER_H

#include <lambent/key_light.h>
#include <lambent/transport.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where light is gathered. */
typedef struct lmb_gather_point {
    lmb_vec3 position;        /* where rays start: already off the surface, for a texel */
    bool hemisphere;          /* only light with direction . normal > 0, else the whole sphere */
    lmb_vec3 normal;          /* unit; the hemisphere's axis */
    float min_light_distance; /* metres: point and spot lights nearer than this count as this far. A probe stands for a
                                 volume around it, over which the inverse square is finite; 0: the very point */
} lmb_gather_point;

/* Samples of one element: a probe, or a texel that is the mean over several points, which share kind and normal.
 * Independent replicates give independent estimates. There are no more than it takes to tell the error, because each is
 * a Sobol sequence of its own, and one of all samples errs less than the mean of many short ones. Samples come in
 * blocks of LMB_GATHER_BLOCK, and a block starts at one point: block b of replicate r at points[(b + r point_count /
 * LMB_GATHER_REPLICATES) % point_count]. */
enum { LMB_GATHER_REPLICATES = 2, LMB_GATHER_BLOCK = 2 };
typedef struct lmb_gather_samples {
    const lmb_gather_point *points;
    uint32_t point_count; /* > 0 */
    uint32_t replicate;
    uint32_t first; /* of the replicate's samples; a multiple of LMB_GATHER_BLOCK */
    uint32_t count;
    bool without_punctual; /* leaves out what lmb_gather_punctual gives */
    bool without_keys;     /* leaves out the direct light of the scene's key lights (lambent/key_lights.h) */
} lmb_gather_samples;

/* Contributions, as a structure of arrays: `weight` = radiance x solid angle that arrives from unit `direction`. Some
 * have weight 0; none has a NaN, infinite or negative one. `count` is a multiple of LMB_CONTRIBUTION_LANES, filled up
 * by some of weight and direction 0. All come from points of one half of the element's: `second_half`. */
enum { LMB_CONTRIBUTION_BATCH = 128, LMB_CONTRIBUTION_LANES = 8 };
typedef struct lmb_contributions {
    float direction[3][LMB_CONTRIBUTION_BATCH];
    float weight[3][LMB_CONTRIBUTION_BATCH];
    uint32_t count;
    bool second_half; /* of the points, from point_count / 2 on */
    bool steady;      /* direct light of punctual lights that are all asked: hardly any noise */
} lmb_contributions;

/* Receives contributions as they are found. */
typedef void (*lmb_gather_sink)(void *context, const lmb_contributions *found);

/* Takes the samples and hands their contributions to `sink`. Weights are for a single sample: divide by the number of
 * samples taken. Adds the rays traced to `*rays`. */
void lmb_gather(const lmb_transport *transport, const lmb_gather_samples *samples, lmb_gather_sink sink, void *context,
                uint64_t *rays);

/* What punctual lights give a single point is the same for all samples: when they are few enough to ask them all, hands
 * it to `sink`, without noise and for a single sample, and returns true. */
bool lmb_gather_punctual(const lmb_transport *transport, const lmb_gather_point *point, bool without_keys,
                         lmb_gather_sink sink, void *context, uint64_t *rays);

/* What is seen of each key light from an element's points, the mean over them: the share of the luminance that its disc
 * would give where nothing were in its way, and for a hemisphere above it. 0 of lights that there are not. Points as in
 * lmb_gather_samples. */
void lmb_gather_keys(const lmb_transport *transport, const lmb_gather_point *points, uint32_t point_count,
                     float visibility[LMB_KEY_LIGHTS_MOST], uint64_t *rays);

#ifdef __cplusplus
}
#endif

#endif
