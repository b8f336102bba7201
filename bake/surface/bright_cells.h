/* Cells that reflect far more than most, as where a torch hangs on a wall, are aimed at like lamps: rays by chance find
 * them rarely, and then they count for much. */
#ifndef LMB_BRIGHT_CELLS_H
#define LMB_BRIGHT_CELLS_H

#include "light/light_tree.h"
#include "surface/surface_light_internal.h"

typedef struct lmb_bright_cells lmb_bright_cells;

/* Finds them by the light's `radiance`. `*bright` is NULL when there are none, or all together give little.
 * @return LMB_ERROR_MEMORY */
lmb_result lmb_bright_cells_create(const lmb_surface_light *light, const lmb_tracer *tracer, lmb_bright_cells **bright);
void lmb_bright_cells_destroy(lmb_bright_cells *bright);
size_t lmb_bright_cells_bytes(const lmb_bright_cells *bright);

/* What is aimed at: a point of a patch's cell. It counts when nothing is in the way, so that a ray in its direction
 * finds that patch (lmb_surface_light_find). */
typedef struct lmb_bright_aim {
    uint32_t cell; /* index among the bright ones */
    uint32_t patch;
    double probability;
    lmb_vec3 direction; /* unit */
} lmb_bright_aim;

/* Aims from `position` at a cell that `query`, which is that position or one near it, chooses. False when it shows its
 * other side. `choice` and `point` in [0, 1). */
bool lmb_bright_cells_aim(const lmb_bright_cells *bright, const lmb_light_query *query, lmb_vec3 position, float choice,
                          const float point[2], lmb_bright_aim *aim);

/* The density per solid angle of having been aimed at like this, when it hit. */
float lmb_bright_aim_density(const lmb_bright_cells *bright, const lmb_bright_aim *aim, const lmb_hit *hit);

/* The density with which a hit that a ray found by chance might have been aimed at; 0 if its patch is not bright.
 * The light has bright cells. */
float lmb_bright_cells_density(const lmb_surface_light *light, const lmb_light_query *query, lmb_vec3 direction,
                               const lmb_hit *hit, uint32_t patch);

#endif
