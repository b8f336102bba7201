/* Where a path's random numbers come from, the points that it collects light at, and next-event estimation there. What
 * every estimator shares. */
#ifndef LMB_DIRECT_H
#define LMB_DIRECT_H

#include <lambent/transport.h>

#include "directions.h"

/* Dimension pairs of the sequence: the gather point uses vertex 0's, the k-th reflection vertex k's. */
enum {
    PAIR_DIRECTION,
    PAIR_TRIANGLE,
    PAIR_CHOICE,
    PAIR_ENVIRONMENT,
    PAIR_ROULETTE,
    PAIR_BRIGHT,
    PAIR_BRIGHT_CHOICE,
    PAIRS_PER_VERTEX
};

/* One sample of one stream. */
typedef struct lmb_path {
    const lmb_transport *transport;
    uint64_t stream;
    uint32_t sample;
    uint32_t vertex; /* reflections so far */
    uint64_t *rays;
} lmb_path;

/* Numbers in [0, 1) of `count` samples of a stream. */
void lmb_sample_numbers(const lmb_transport *transport, uint64_t stream, uint32_t first, uint32_t count, uint32_t pair,
                        float *x, float *y);

/* Two numbers in [0, 1) of the path's present vertex. */
void lmb_path_numbers(const lmb_path *path, uint32_t pair, float point[2]);

/* A point that light is collected at: a gather point or a reflection. */
typedef struct lmb_receiver {
    lmb_vec3 position;         /* on the surface, or in space */
    lmb_vec3 geometric_normal; /* on the lit side; unused in space */
    lmb_vec3 normal;           /* shading normal; unused for a sphere */
    float rounding;            /* lmb_place's; unused for a gather point */
    float min_light_distance;
    lmb_lobe kind;                       /* a probe, a texel, or a reflection (cosine) */
    const lmb_triangle_query *triangles; /* how it chooses among emissive triangles; NULL: as seen from itself */
} lmb_receiver;

/* One side of a surface. */
lmb_receiver lmb_receiver_on_surface(const lmb_place *place, bool front);

/* The normal of the plane that light must come from before of; NULL for a point in space. */
static inline const lmb_vec3 *lmb_receiver_normal(const lmb_receiver *receiver)
{
    return receiver->kind == LMB_LOBE_SPHERE ? NULL : &receiver->normal;
}

static inline lmb_triangle_query lmb_receiver_triangles(const lmb_receiver *receiver)
{
    return receiver->triangles ? *receiver->triangles
                               : (lmb_triangle_query){receiver->position, lmb_receiver_normal(receiver), NULL};
}

/* Density of the direction that direction sampling picks, per solid angle. */
float lmb_receiver_density(const lmb_receiver *receiver, lmb_vec3 direction);

lmb_vec3 lmb_receiver_direction(const lmb_receiver *receiver, const float point[2]);

/* Whether light from `direction` counts at all. A smooth shading normal's hemisphere reaches below the triangle: from
 * there the surface itself blocks the light. */
bool lmb_receiver_sees(const lmb_receiver *receiver, lmb_vec3 direction);

/* A point in space may lie exactly on a surface: its rays start beyond, so that it sees both sides. */
lmb_vec3 lmb_receiver_ray_origin(const lmb_receiver *receiver, lmb_vec3 direction);

/* Balance heuristic weight of a technique with density `mine` beside one with `other`. */
static inline float lmb_balance(float mine, float other)
{
    return mine / (mine + other);
}

/* Light that next-event estimation aims at: where to, and what it gives where nothing is in its way. The ray is one for
 * lmb_trace_transmittance_batch. */
enum { LMB_AIMED_MOST = 4 };
typedef struct lmb_aimed_light {
    lmb_vec3 origin;
    lmb_vec3 towards;
    float far_distance;
    lmb_rgb weight; /* radiance x solid angle for a gather point, normalised irradiance for a surface */
} lmb_aimed_light;

/* Aims at a light that directions sampled by the receiver find too: weighted against them. False where the receiver
 * does not see it. */
bool lmb_receiver_aim(const lmb_receiver *receiver, const lmb_light_sample *light, bool at_infinity,
                      lmb_aimed_light *aimed);

/* The same of a punctual light, which they never find. */
bool lmb_receiver_aim_punctual(const lmb_receiver *receiver, const lmb_punctual_sample *light, lmb_aimed_light *aimed);

/* Punctual lights that a receiver is to look at (lmb_emitters_punctual). */
int lmb_receiver_punctual(const lmb_transport *transport, const lmb_receiver *receiver, const float choice[2], int max,
                          lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX]);

/* What next-event estimation starts from: the path's numbers, and what those of PAIR_ENVIRONMENT sample. Only what the
 * level has of each kind need be set. */
typedef struct lmb_direct_start {
    float triangle[2]; /* PAIR_TRIANGLE */
    float choice[2];   /* PAIR_CHOICE */
    lmb_light_sample environment;
} lmb_direct_start;

/* Next-event estimation of everything that can be aimed at. Returns how many. */
int lmb_direct_aim(const lmb_transport *transport, const lmb_receiver *receiver, const lmb_direct_start *start,
                   lmb_aimed_light aimed[LMB_AIMED_MOST]);

/* What arrives of it on the path's way, summed. */
lmb_rgb lmb_direct_collect(const lmb_path *path, const lmb_receiver *receiver);

#endif
