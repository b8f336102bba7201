/* Many points of a triangle at once. */
#ifndef LMB_SURFACE_INTERNAL_H
#define LMB_SURFACE_INTERNAL_H

#include <lambent/surface.h>

/* lmb_trace_position of `count` points of a triangle. */
void lmb_trace_positions(const lmb_tracer *tracer, uint32_t instance, uint32_t triangle, const float (*weights)[2],
                         uint32_t count, lmb_vec3 *position);

#endif
