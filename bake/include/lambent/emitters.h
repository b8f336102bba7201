/* Choosing where light comes from: the scene's emissive triangles, its environment and its punctual lights, each ready
 * to be sampled and asked for the density of a direction. */
#ifndef LAMBENT_EMITTERS_H
#define LAMBENT_EMITTERS_H

#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_emitters lmb_emitters;

/* `tracer` must outlive the emitters. @return LMB_ERROR_MEMORY */
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

/* A point on an emissive triangle, seen from `position`: chosen by power, uniform in area. Returns false when there
 * are none or when this choice gives no light. */
bool lmb_emitters_sample_triangle(const lmb_emitters *emitters, lmb_vec3 position, float choice, const float point[2],
                                  lmb_light_sample *sample);

/* Density per solid angle with which the function above picks the direction of this hit. */
float lmb_emitters_triangle_density(const lmb_emitters *emitters, const lmb_hit *hit, lmb_vec3 direction,
                                    float distance, lmb_vec3 geometric_normal);

/* Whether the environment is an image that is worth sampling by its brightness. A constant one is not: rays that leave
 * the scene find it with less noise. */
bool lmb_emitters_environment_sampled(const lmb_emitters *emitters);

/* A direction of the environment in proportion to its luminance. */
bool lmb_emitters_sample_environment(const lmb_emitters *emitters, const float point[2], lmb_light_sample *sample);
float lmb_emitters_environment_density(const lmb_emitters *emitters, lmb_vec3 direction);

/* Radiance that arrives from outside the scene along unit `direction` (pointing outwards). */
lmb_rgb lmb_emitters_environment_radiance(const lmb_emitters *emitters, lmb_vec3 direction);

typedef struct lmb_punctual_sample {
    lmb_vec3 direction; /* unit, towards the light */
    lmb_vec3 end;       /* the light's position; unused when `at_infinity` */
    bool at_infinity;
    lmb_rgb irradiance; /* on a surface that faces the light, unshadowed, divided by the choice's probability */
} lmb_punctual_sample;

/* Who asks for a punctual light. */
typedef struct lmb_punctual_query {
    lmb_vec3 position;
    bool at_infinity;        /* asks for a directional light; else for a point or spot light */
    const lmb_vec3 *normal;  /* leaves out lights behind this plane; NULL: a point in space */
    float min_distance;      /* nearer point and spot lights count as this far */
    bool skip_indirect_only; /* the point is baked, not a reflection on the way to it */
} lmb_punctual_query;

/* One punctual light of a kind. Suns and lamps are asked for apart, for what is bright for one is dark for the other;
 * within a kind the choice is in proportion to the unshadowed light there, with an even share for all, because nobody
 * knows which of them walls keep away. Returns false when none gives light. */
bool lmb_emitters_sample_punctual(const lmb_emitters *emitters, const lmb_punctual_query *query, float choice,
                                  lmb_punctual_sample *sample);

#ifdef __cplusplus
}
#endif

#endif
