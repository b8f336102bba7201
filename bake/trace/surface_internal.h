/* What other rooms and the walk through layers need of surface.c. */
#ifndef LMB_SURFACE_INTERNAL_H
#define LMB_SURFACE_INTERNAL_H

#include <lambent/surface.h>

/* lmb_trace_position of `count` points of a triangle. */
void lmb_trace_positions(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle, const float (*weights)[2],
                         uint32_t count, lmb_vec3 *position);

/* lmb_surface's opacity and pass alone. */
typedef struct lmb_coverage {
    float opacity;
    lmb_rgb pass;
} lmb_coverage;

/* That of a material by its factors alone. */
lmb_coverage lmb_material_coverage(const lmb_material *material);

#endif
