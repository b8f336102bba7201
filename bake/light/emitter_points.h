/* Points on emissive triangles, for many samples at once. */
#ifndef LMB_EMITTER_POINTS_H
#define LMB_EMITTER_POINTS_H

#include <stdint.h>

#include <lambent/surface.h>

/* A triangle, as an array of floats that vector code can pick from. */
typedef struct lmb_emitter_shape {
    float corner[3], edge_u[3], edge_v[3], middle[3];
    float normal[3]; /* unit */
    float rounding;  /* lmb_place's */
    float area;      /* square metres */
} lmb_emitter_shape;

lmb_emitter_shape lmb_emitter_shape_of(const lmb_vec3 corner[3], lmb_vec3 normal, float rounding);

/* Of each sample: which emitter was chosen, with what density (that of points even over its triangle would be 1, times
 * the probability of the choice), where on its triangle its point lies, and from where it is looked at. */
enum { LMB_EMITTER_POINTS = LMB_RAY_BATCH };
typedef struct lmb_emitter_points {
    uint32_t count;
    int32_t emitter[LMB_EMITTER_POINTS];
    float probability[LMB_EMITTER_POINTS];
    float u[LMB_EMITTER_POINTS], v[LMB_EMITTER_POINTS]; /* barycentric */
    float position[3][LMB_EMITTER_POINTS];
    /* Found by lmb_emitter_points_find. */
    float direction[3][LMB_EMITTER_POINTS]; /* unit, to the point */
    float end[3][LMB_EMITTER_POINTS];       /* just before it */
    float density[LMB_EMITTER_POINTS];      /* per solid angle; 0 where the triangle is seen edge-on */
} lmb_emitter_points;

/* Sets u and v for `count` points (x, y) of [0, 1)^2: even over the triangle's area. */
void lmb_emitter_points_even(lmb_emitter_points *restrict points, const float *restrict x, const float *restrict y);

void lmb_emitter_points_find(const lmb_emitter_shape *shapes, lmb_emitter_points *points);

/* Density per solid angle of a point at `distance` that is chosen with `probability`; 0 when seen edge-on. */
float lmb_emitter_density(const lmb_emitter_shape *shape, float probability, float distance, lmb_vec3 direction);

#endif
