/* Where a path's random variates come from, the points that it collects light at, and next-event estimation there. What
 * every estimator shares. */
#ifndef LMB_DIRECT_H
#define LMB_DIRECT_H

#include <lambent/surface.h>
#include <lambent/transport.h>
#include <lambent/vector.h>

#include "base/directions.h"
#include "trace/trace_internal.h"

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

/* The pair of a vertex that picks points of soft lights: counted from the far end, apart from all others. */
static inline uint32_t lmb_light_pair(uint32_t vertex)
{
    return UINT32_MAX - vertex;
}

/* Samples of a stream, one after the other. */
typedef struct lmb_sample_range {
    uint64_t stream;
    uint32_t first, count;
} lmb_sample_range;

/* Two variates in [0, 1) of each. */
void lmb_sample_variates(const lmb_transport *transport, lmb_sample_range samples, uint32_t pair, float *x, float *y);

/* Two variates in [0, 1) of the path's present vertex. */
void lmb_path_variates(const lmb_path *path, uint32_t pair, float u[2]);

/* What decides which layers let pass a sample's ray (lmb_trace_through): of its path's vertex, or a ray of its own. */
enum { LMB_CHANCE_OF_AIM = -1 };
uint64_t lmb_layer_chance(uint64_t stream, uint32_t sample, int32_t vertex);

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
static inline float lmb_receiver_density(const lmb_receiver *receiver, lmb_vec3 direction)
{
    switch (receiver->kind) {
    case LMB_LOBE_SPHERE:
        return 1.0f / (4.0f * LMB_PI_F);
    case LMB_LOBE_HEMISPHERE:
        return lmb_hemisphere_density(lmb_vec3_dot(receiver->normal, direction));
    default:
        return lmb_larger(lmb_vec3_dot(receiver->normal, direction), 0.0f) / LMB_PI_F;
    }
}

lmb_vec3 lmb_receiver_direction(const lmb_receiver *receiver, const float u[2]);

/* Whether light from `direction` counts at all. A smooth shading normal's hemisphere reaches below the triangle: from
 * there the surface itself blocks the light. */
static inline bool lmb_receiver_sees(const lmb_receiver *receiver, lmb_vec3 direction)
{
    if (receiver->kind == LMB_LOBE_SPHERE) {
        return true;
    }
    return lmb_vec3_dot(receiver->normal, direction) > 0.0f &&
           (receiver->kind == LMB_LOBE_HEMISPHERE || lmb_vec3_dot(receiver->geometric_normal, direction) > 0.0f);
}

/* A point in space may lie exactly on a surface: its rays start beyond, so that it sees both sides. */
static inline lmb_vec3 lmb_receiver_ray_origin(const lmb_receiver *receiver, lmb_vec3 direction)
{
    switch (receiver->kind) {
    case LMB_LOBE_SPHERE:
        return lmb_vec3_mad(receiver->position, direction, trace_epsilon(receiver->position));
    case LMB_LOBE_HEMISPHERE:
        return receiver->position;
    default:
        return trace_offset(receiver->position, receiver->geometric_normal, receiver->rounding, direction);
    }
}

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
    bool is_sun;    /* a directional light */
} lmb_aimed_light;

/* The receiver's own factor of light from `direction`: a gather point takes it as it is, a surface by the cosine. */
static inline float lmb_receiver_response(const lmb_receiver *receiver, lmb_vec3 direction)
{
    return receiver->kind == LMB_LOBE_COSINE ? lmb_vec3_dot(receiver->normal, direction) / LMB_PI_F : 1.0f;
}

/* A ray towards `end`, or without end. */
static inline lmb_aimed_light lmb_receiver_aim_along(const lmb_receiver *receiver, lmb_vec3 direction, lmb_vec3 end,
                                                     bool at_infinity, lmb_rgb weight)
{
    const lmb_vec3 origin = lmb_receiver_ray_origin(receiver, direction);
    return (lmb_aimed_light){origin, at_infinity ? direction : lmb_vec3_sub(end, origin),
                             at_infinity ? FLT_MAX : LMB_TRACE_UP_TO_END, weight, false};
}

/* Aims at a light that directions sampled by the receiver find too: weighted against them. False where the receiver
 * does not see it. */
static inline bool lmb_receiver_aim(const lmb_receiver *receiver, const lmb_light_sample *light, bool at_infinity,
                                    lmb_aimed_light *aimed)
{
    if (!lmb_receiver_sees(receiver, light->direction)) {
        return false;
    }
    /* The balance heuristic's weight over the density. */
    const float own = lmb_receiver_density(receiver, light->direction);
    const float factor = lmb_receiver_response(receiver, light->direction) / (light->density + own);
    *aimed = lmb_receiver_aim_along(receiver, light->direction, light->end, at_infinity,
                                    lmb_rgb_scale(light->radiance, factor));
    return true;
}

/* The same of a punctual light, which they never find. */
static inline bool lmb_receiver_aim_punctual(const lmb_receiver *receiver, const lmb_punctual_sample *light,
                                             lmb_aimed_light *aimed)
{
    if (!lmb_receiver_sees(receiver, light->direction)) {
        return false;
    }
    const float response = lmb_receiver_response(receiver, light->direction);
    *aimed = lmb_receiver_aim_along(receiver, light->direction, light->end, light->at_infinity,
                                    lmb_rgb_scale(light->irradiance, response));
    aimed->is_sun = light->at_infinity;
    return true;
}

/* What a receiver asks lmb_emitters_punctual, but for the point. */
static inline lmb_punctual_query lmb_receiver_punctual(const lmb_receiver *receiver)
{
    return (lmb_punctual_query){.position = receiver->position,
                                .normal = lmb_receiver_normal(receiver),
                                .min_distance = receiver->min_light_distance,
                                .skip_indirect_only = receiver->kind != LMB_LOBE_COSINE};
}

/* What next-event estimation starts from: the path's variates, and what those of PAIR_ENVIRONMENT sample. Only what the
 * level has of each kind need be set. */
typedef struct lmb_direct_start {
    float triangle[2]; /* PAIR_TRIANGLE */
    float choice[2];   /* PAIR_CHOICE */
    float light[2];    /* lmb_light_pair; of soft lights */
    lmb_light_sample environment;
} lmb_direct_start;

/* Next-event estimation of everything that can be aimed at. Returns how many. */
int lmb_direct_aim(const lmb_transport *transport, const lmb_receiver *receiver, const lmb_direct_start *start,
                   lmb_aimed_light aimed[LMB_AIMED_MOST]);

/* What arrives of it on the path's way, summed. */
lmb_rgb lmb_direct_collect(const lmb_path *path, const lmb_receiver *receiver);

/* The part of it that directional lights give. */
lmb_rgb lmb_direct_collect_suns(const lmb_path *path, const lmb_receiver *receiver);

#endif
