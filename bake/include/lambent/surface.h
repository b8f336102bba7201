/* What is found at a hit: where it is, how it faces, what its material does. */
#ifndef LAMBENT_SURFACE_H
#define LAMBENT_SURFACE_H

#include <lambent/material.h>
#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where a hit is and how it faces. */
typedef struct lmb_place {
    lmb_vec3 position;         /* world space, from the triangle's corners: accurate to a few ulps of its coordinates */
    lmb_vec3 geometric_normal; /* unit, on the front's side, as lmb_hit has it */
    lmb_vec3 shading_normal;   /* unit, interpolated vertex normal, turned to the geometric normal's side */
    float rounding;            /* metres: how far rounding can have moved the position off its triangle */
} lmb_place;

/* The place of a hit. Here and below, its instance, triangle, u and v alone count. */
lmb_place lmb_trace_place(const lmb_tracer *tracer, const lmb_hit *hit);

/* World-space corners of a triangle. */
void lmb_trace_corners(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle, lmb_vec3 corner[3]);

/* Square metres of a triangle in the world. */
float lmb_trace_triangle_area(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle);

/* lmb_trace_place's position alone. */
lmb_vec3 lmb_trace_position(const lmb_tracer *tracer, const lmb_hit *hit);

/* The point of the mesh that was hit. */
lmb_mesh_point lmb_trace_mesh_point(const lmb_tracer *tracer, const lmb_hit *hit);

/* What the material there reflects and lets through. What it emits is for lmb_emitters_emission to say. */
lmb_surface lmb_trace_surface(const lmb_tracer *tracer, const lmb_hit *hit);

/* The shading normal bent by the material's normal map, on the same side of the surface as `place->shading_normal`. */
lmb_vec3 lmb_trace_mapped_normal(const lmb_tracer *tracer, const lmb_hit *hit, const lmb_place *place);

#ifdef __cplusplus
}
#endif

#endif
