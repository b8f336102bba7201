/* Choosing where light comes from: the scene's emissive triangles, its environment and its punctual lights, each ready
 * to be sampled and asked for the density of a direction. */
#ifndef LAMBENT_EMITTERS_H
#define LAMBENT_EMITTERS_H

#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_emitters lmb_emitters;

/* `tracer` must outlive the emitters. Takes 8 bytes for each texel of the textures by which surfaces emit, and looks at
 * all of these. @return LMB_ERROR_MEMORY */
lmb_result lmb_emitters_create(const lmb_tracer *tracer, lmb_emitters **emitters);

void lmb_emitters_destroy(lmb_emitters *emitters);

/* Number of triangles that are sampled as lights. */
uint32_t lmb_emitters_triangle_count(const lmb_emitters *emitters);

typedef struct lmb_light_sample {
    lmb_vec3 direction; /* unit, towards the light */
    lmb_vec3 end;       /* a point just before the light, for the shadow ray; unused for the environment */
    lmb_rgb radiance;   /* that leaves the light towards the point, unshadowed */
    float density;      /* per solid angle, > 0 */
} lmb_light_sample;

/* Where light of triangles is to arrive. */
typedef struct lmb_triangle_query {
    lmb_vec3 position;
    const lmb_vec3 *normal;      /* unit, of the surface there; NULL: a point in space */
    struct lmb_light_memo *memo; /* what was found out about the triangles for this position; NULL: nothing is kept */
} lmb_triangle_query;

/* Variates that choose points on emissive triangles, one of each array for a sample. */
typedef struct lmb_triangle_choices {
    uint32_t count;           /* <= LMB_RAY_BATCH */
    const lmb_vec3 *position; /* seen from here */
    const float *choice;      /* of the triangle, in [0, 1) */
    const float *x, *y;       /* of the point, in [0, 1)^2 */
} lmb_triangle_choices;

/* A point on an emissive triangle for each: the triangle by what it may give to `query`, which is one of the positions
 * or near them; the point uniform in its area, or where its texture gives light, in proportion to that
 * (emission_part.h). Time grows with the logarithm of the number of triangles, of which there is one at least, and of
 * texels. Where a choice gives no light the density is 0. */
void lmb_emitters_sample_triangles(const lmb_emitters *emitters, const lmb_triangle_query *query,
                                   const lmb_triangle_choices *choices, lmb_light_sample *sample);

/* Density per solid angle with which the function above picks the direction of this hit: `direction`, a unit vector. */
float lmb_emitters_triangle_density(const lmb_emitters *emitters, const lmb_triangle_query *query, const lmb_hit *hit,
                                    lmb_vec3 direction);

/* Radiance that the emitters' triangle gives at a hit, of the part of the light that it does not let through: at a
 * ray's end, too, this alone is light of surfaces. */
lmb_rgb lmb_emitters_emission(const lmb_emitters *emitters, const lmb_hit *hit);

/* Whether the environment is an image in which something stands out that is worth aiming at. In an even one rays that
 * leave the scene find the light with less noise. */
bool lmb_emitters_environment_sampled(const lmb_emitters *emitters);

/* Directions of the environment in proportion to how far its luminance is above the mean, for `count` points (x, y) of
 * [0, 1)^2; lmb_emitters_environment_sampled must hold. Where a point picks nothing the density is 0. */
void lmb_emitters_sample_environment(const lmb_emitters *emitters, const float *x, const float *y, uint32_t count,
                                     lmb_light_sample *sample);

/* Radiance of the environment along unit `direction` (pointing outwards) as one sees it: with the sun that became a
 * light (lambent/key_lights.h) in its place in the picture. */
lmb_rgb lmb_emitters_environment_shown(const lmb_emitters *emitters, lmb_vec3 direction);

/* What arrives from outside the scene, and the density per solid angle with which lmb_emitters_sample_environment picks
 * its direction. */
typedef struct lmb_environment_seen {
    lmb_rgb radiance;
    float density;
} lmb_environment_seen;

/* That of `count` directions at once, direction[axis][i]: memory is slow, and is waited for many at a time. */
void lmb_emitters_environment_look(const lmb_emitters *emitters, const float *const direction[3], uint32_t count,
                                   lmb_environment_seen *seen);

typedef struct lmb_punctual_sample {
    lmb_vec3 direction; /* unit, towards the light */
    lmb_vec3 end;       /* the light's position; unused when `at_infinity` */
    bool at_infinity;
    lmb_rgb irradiance; /* on a surface that faces the light, unshadowed, divided by the choice's probability */
    uint32_t light;     /* index in the scene */
    bool soft;          /* it has an extent: this is one point of it, which stands for all */
    float weight;       /* how many lights it stands for, over the choice's probability */
} lmb_punctual_sample;

/* Who asks for punctual lights. */
typedef struct lmb_punctual_query {
    lmb_vec3 position;
    const lmb_vec3 *normal;  /* leaves out lights behind this plane; NULL: a point in space */
    float min_distance;      /* nearer point and spot lights count as this far */
    bool skip_indirect_only; /* the point is baked, not a reflection on the way to it */
    bool skip_keys;          /* and key lights are gathered apart */
    float point[2];          /* in [0, 1)^2: where on lights of an extent samples lie */
} lmb_punctual_query;

/* Punctual lights that together stand for all: up to `max` point and spot lights and as many directional ones. Suns and
 * lamps are chosen apart, for what is bright for one is dark for the other.
 *
 * A kind of which there are no more than LMB_PUNCTUAL_MAX is looked at whole, and when no more than `max` of them give
 * light they are returned as they are, without chance. Else a tree divides the lights into clusters, the strongest into
 * single lights, and one of each is a candidate, in time that grows with the logarithm of their number. Among
 * candidates the choice is in proportion to their unshadowed light, the strongest for certain, with an even share for
 * all, because nobody knows which of them walls keep away. `choice` in [0, 1)^2; 1 <= max <= LMB_PUNCTUAL_MAX. Returns
 * how many `sample` has been given. */
enum { LMB_PUNCTUAL_MAX = 16 };
int lmb_emitters_punctual(const lmb_emitters *emitters, const lmb_punctual_query *query, const float choice[2], int max,
                          lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX]);

/* Another point of the light of a sample that the query gave, if that is soft: by `query->point`. */
void lmb_emitters_punctual_again(const lmb_emitters *emitters, const lmb_punctual_query *query,
                                 lmb_punctual_sample *sample);

/* What holds of punctual lights, `skip_keys`: of those that are not key lights.
 * Whether there are any. */
bool lmb_emitters_have_punctual(const lmb_emitters *emitters, bool skip_keys);

/* Whether any has an extent. */
bool lmb_emitters_punctual_are_soft(const lmb_emitters *emitters, bool skip_keys);

/* Whether there are so few, and none with an extent, that with `max` LMB_PUNCTUAL_MAX nothing is left to chance. */
bool lmb_emitters_punctual_are_few(const lmb_emitters *emitters, bool skip_keys);

#ifdef __cplusplus
}
#endif

#endif
