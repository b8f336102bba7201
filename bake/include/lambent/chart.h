/* Lightmap UVs: checking those that a mesh brings, and making charts where it has none.
 *
 * Charts are groups of neighbouring faces with similar normals, laid flat along the group's mean normal. Those of a few
 * texels are unfolded onto a neighbour. All are packed into the unit square by the texels that they touch, in each
 * other's corners and holes, with a gutter between them. */
#ifndef LAMBENT_CHART_H
#define LAMBENT_CHART_H

#include <lambent/pool.h>
#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_charts {
    lmb_vec2 *corner_uv; /* [3 * triangle + corner] in [0, 1] */
    uint32_t *chart;     /* [triangle] */
    uint32_t chart_count;
    int32_t resolution; /* texels along each side of the square that the packing was made for; it may fill less of it
                           in one direction */
} lmb_charts;

/* Makes charts for a mesh at `texels_per_m` (texels per unit of mesh space), `gutter_texels` between charts and at
 * the border, by the pool's threads, or by the caller's where there is none. The result depends on the mesh alone.
 * @return LMB_ERROR_MEMORY, _ARGUMENT */
lmb_result lmb_charts_make(const lmb_mesh *mesh, float texels_per_m, int32_t gutter_texels, lmb_pool *pool,
                           lmb_charts *charts);

void lmb_charts_free(lmb_charts *charts);

#ifdef __cplusplus
}
#endif

#endif
