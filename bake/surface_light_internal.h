/* How triangles are divided into cells, and where a cell's light is. */
#ifndef LMB_SURFACE_LIGHT_INTERNAL_H
#define LMB_SURFACE_LIGHT_INTERNAL_H

#include <lambent/surface_light.h>

/* The cells of one triangle. Strip i, column j is cell first + i columns + j; strips count from the apex. */
typedef struct lmb_cell_grid {
    uint32_t first;
    uint32_t strips : 15;
    uint32_t columns : 15;
    uint32_t apex : 2; /* the corner opposite the shortest edge */
    float cell_size;   /* metres: the longest edge of its cells */
} lmb_cell_grid;

struct lmb_surface_light {
    uint32_t instance_count;
    uint32_t triangle_count; /* of all static instances together */
    uint32_t cell_count;
    uint32_t *triangle_first; /* [instance], and the count at its end: dynamic ones have none */
    lmb_cell_grid *grid;      /* [triangle], and one at its end whose `first` is the count of cells */
    lmb_rgb *irradiance;      /* [2 cell + side]: 0 the front, 1 the back */
    float cell_size;          /* metres: the largest of all */
};

/* A cell found from its number. */
typedef struct lmb_cell {
    uint32_t instance;
    uint32_t triangle; /* of the instance's mesh */
    uint32_t number;   /* within the triangle */
    const lmb_cell_grid *grid;
} lmb_cell;

/* Divides the static triangles; all light is 0. */
lmb_result lmb_surface_light_create(const lmb_tracer *tracer, const lmb_surface_light_settings *settings,
                                    lmb_surface_light **light, lmb_error *error);

lmb_cell lmb_cell_find(const lmb_surface_light *light, uint32_t cell);

/* Barycentric coordinates of a point of the cell, uniform over its area for uniform numbers in [0, 1). */
void lmb_cell_point(const lmb_cell *cell, const float numbers[2], float *u, float *v);

/* Share of the triangle's area that the cell covers. */
float lmb_cell_area_share(const lmb_cell *cell);

/* Index of one side of the cell at a hit. */
uint32_t lmb_surface_light_side(const lmb_surface_light *light, const lmb_hit *hit, bool front);

#endif
