/* Seams: edges of the surface that lie on the border of two charts. */
#ifndef LMB_LIGHTMAP_SEAMS_H
#define LMB_LIGHTMAP_SEAMS_H

#include "lightmap/lightmap_internal.h"

/* A point of a seam, and the texels that filtering reads for it from either side. */
typedef struct lmb_seam_point {
    lmb_lightmap_footprint side[2];
    lmb_vec3 normal; /* unit */
} lmb_seam_point;

typedef struct lmb_seams {
    size_t edge_count;
    size_t count, room;
    lmb_seam_point *point;
} lmb_seams;

/* Finds the edges that two triangles share, of one node or of two, where the surface goes on smoothly but the texels do
 * not: the same corners, nearly the same normals at them, different UVs, and no wall that stands between. Edges that
 * meet a part of another are not found. @return LMB_ERROR_MEMORY */
lmb_result lmb_seams_find(const lmb_lightmap *lightmap, const lmb_tracer *tracer, lmb_seams *seams);
void lmb_seams_free(lmb_seams *seams);

/* Moves the texels beside seams by the least amount (of squares) with which both sides read the same, in each channel,
 * or in those of the light alone where the model has a direction, and in what is seen of key lights; none beyond what
 * the texels of its seams had. @return LMB_ERROR_MEMORY */
lmb_result lmb_seams_close(const lmb_seams *seams, lmb_pool *pool, lmb_lightmap *lightmap);

/* How far both sides are apart. @return LMB_ERROR_MEMORY */
lmb_result lmb_seams_measure(const lmb_seams *seams, const lmb_lightmap *lightmap, lmb_seam_steps *steps);

#endif
