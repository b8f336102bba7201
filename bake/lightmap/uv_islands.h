/* The islands of lightmap UVs: triangles that hang together. */
#ifndef LMB_UV_ISLANDS_H
#define LMB_UV_ISLANDS_H

#include <lambent/chart.h>

typedef struct lmb_uv_islands {
    uint32_t count;
    uint32_t small_count; /* of less than the area asked for */
    double small_share;   /* of all area in UV */
} lmb_uv_islands;

/* Counts the islands of the mesh's TEXCOORD_1. @return LMB_ERROR_MEMORY */
lmb_result lmb_uv_islands_find(const lmb_mesh *mesh, double small_uv_area, lmb_uv_islands *islands);

/* The same of charts that were made for it. */
lmb_result lmb_uv_islands_of_charts(const lmb_charts *charts, uint32_t triangle_count, double small_uv_area,
                                    lmb_uv_islands *islands);

#endif
