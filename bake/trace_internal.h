/* What surface.c needs of the tracer's inside. */
#ifndef LMB_TRACE_INTERNAL_H
#define LMB_TRACE_INTERNAL_H

#include <lambent/trace.h>

/* World-space vertices of an instance that was flattened into the world, or NULL. */
const lmb_vec3 *lmb_tracer_world_vertices(const lmb_tracer *tracer, uint32_t instance);

#endif
