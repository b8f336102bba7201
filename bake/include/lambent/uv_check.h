/* Whether the lightmap UVs that a mesh brings can be used. */
#ifndef LAMBENT_UV_CHECK_H
#define LAMBENT_UV_CHECK_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum lmb_uv_fault {
    LMB_UV_GOOD,
    LMB_UV_MISSING,      /* no TEXCOORD_1 */
    LMB_UV_OUT_OF_RANGE, /* corners outside [0, 1] (beyond a small slack) or not finite */
    LMB_UV_DEGENERATE,   /* triangles with area in the world but none in UV: more than 1 % of the mesh's area */
    LMB_UV_OVERLAPPING   /* triangles cover each other */
} lmb_uv_fault;

/* Whether a mesh's own TEXCOORD_1 can carry a lightmap of `resolution` x `resolution` texels: overlap is tested by
 * rasterising texel centres at that resolution, and more than 1 % of the covered texels covered twice is a fault.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_uv_check(const lmb_mesh *mesh, int32_t resolution, lmb_uv_fault *fault);

/* A short phrase for messages. */
const char *lmb_uv_fault_text(lmb_uv_fault fault);

#ifdef __cplusplus
}
#endif

#endif
