/* The path tracer's irradiance at random points of surfaces, which lambent_textures holds what it stored against. */
#ifndef LMB_TOOLS_TEXTURES_REFERENCE_H
#define LMB_TOOLS_TEXTURES_REFERENCE_H

#include <lambent/lightmap.h>

#include "check_reference.h"

/* A point, on which light is measured. */
typedef struct textures_point {
    lmb_hit hit;
    lmb_vec3 normal[CHECK_NORMALS];
    irradiance_set half[2]; /* two independent estimates */
} textures_point;

/* Point `index` of `count`, without its light. `surface` is of the level. */
struct lmb_opaque_surface;
void textures_point_make(const struct lmb_opaque_surface *surface, uint32_t index, uint32_t count,
                         textures_point *point);

/* The light of all that have texels. @return LMB_ERROR_MEMORY, _INTERRUPTED */
lmb_result textures_reference_gather(const lmb_lightmap *lightmap, const check_reference *reference, lmb_pool *pool,
                                     textures_point *points, uint32_t count);

#endif
