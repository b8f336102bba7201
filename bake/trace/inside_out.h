/* Objects that are wound inside out, and what to say of them. */
#ifndef LMB_INSIDE_OUT_H
#define LMB_INSIDE_OUT_H

#include "trace/trace_internal.h"

/* Finds out how each instance of the tracer's scene faces, from a tracer that believes all windings.
 *
 * A mesh may be inside out when it is closed and all its parts enclose a negative volume. That is a room, too. It is no
 * room when nothing is in it: no light, no other object, no seed or path point; then no light can be there either, as
 * it is opaque, and its texels could only be black. And it is an object when those outside see it in good surroundings:
 * rays from its outer side meet fronts of others more often than backs. @return LMB_ERROR_MEMORY */
lmb_result lmb_inside_out_find(const lmb_tracer *tracer, uint8_t *facing);

/* The same of instances of which some closed parts face inwards and others do not, judged by the former, for the first
 * instance of each mesh: facing[instance] is not LMB_FACING_AS_WOUND for those that are reversed in part. The tracer
 * may have turned others. @return LMB_ERROR_MEMORY */
lmb_result lmb_inside_out_parts_find(const lmb_tracer *tracer, uint8_t *facing);

/* Marks the triangles of a mesh's closed parts that face inwards, [triangle]. `*others`: how many triangles with area
 * there are besides. @return LMB_ERROR_MEMORY */
lmb_result lmb_mesh_mark_inward(const lmb_mesh *mesh, uint8_t *inward, uint32_t *others);

/* Whether all parts of a mesh are closed and face inwards. @return LMB_ERROR_MEMORY */
lmb_result lmb_mesh_is_inward(const lmb_mesh *mesh, bool *inward);

#endif
