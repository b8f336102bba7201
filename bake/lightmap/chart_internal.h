/* The steps of making charts: who is whose neighbour (chart_mesh.c), growing (chart.c), joining small ones to others
 * (chart_join.c), packing (chart_pack.c). */
#ifndef LMB_CHART_INTERNAL_H
#define LMB_CHART_INTERNAL_H

#include <stdbool.h>

#include <lambent/chart.h>

typedef struct chart_vec2 {
    double x, y;
} chart_vec2;

/* A mesh as growing sees it. */
typedef struct chart_mesh {
    uint32_t triangle_count;
    uint32_t *weld;          /* [vertex] the first vertex at the same position */
    int64_t (*neighbour)[3]; /* [triangle] across the edge from corner e to corner e + 1; -1: none, or a hard edge */
    int64_t (*across)[3];    /* the same, over hard edges too */
    double (*normal)[3];     /* [triangle] unit; zero for triangles without area */
    double *area;            /* [triangle] 0 for triangles without area */
} chart_mesh;

/* @return LMB_ERROR_MEMORY; then, too, chart_mesh_free is to be called */
lmb_result lmb_chart_mesh_make(const lmb_mesh *mesh, chart_mesh *out);
void lmb_chart_mesh_free(chart_mesh *mesh);

/* One chart, laid flat: its corners are corners[first] .. corners[first + count - 1], in texels. */
typedef struct chart_flat {
    size_t first;
    size_t count;
    double scale; /* texels per unit of the flat coordinates */
} chart_flat;

/* All charts: what is at [place] belongs to the triangle triangles[place]. Triangles without area are in none. */
typedef struct chart_layout {
    chart_vec2 *corners; /* [3 * place + corner] */
    uint32_t *triangles; /* [place] */
    chart_flat *charts;
    size_t chart_count;
    size_t corner_count;
} chart_layout;

/* Charts may reach this far into each other, in texels: rounding, and far less than anyone sees. */
#define CHART_OVERLAP_TEXELS 1e-4

/* Whether two counter-clockwise triangles (three corners each) reach into each other by more than `slack`. */
bool lmb_chart_triangles_overlap(const chart_vec2 *a, const chart_vec2 *b, double slack);

/* Joins charts of a few texels to neighbours, unfolded over their common edge. `chart` is [triangle] of the mesh.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_chart_join(const chart_mesh *mesh, chart_layout *layout, uint32_t *chart);

/* Turns each chart to its smallest bounding box, packs the boxes, and moves `corners` to where they are in the packed
 * square, in texels. @return LMB_ERROR_MEMORY, or LMB_ERROR_ARGUMENT when the square would be too large */
lmb_result lmb_chart_pack(const chart_flat *charts, size_t chart_count, chart_vec2 *corners, int32_t gutter_texels,
                          lmb_pool *pool, int32_t *resolution);

#endif
