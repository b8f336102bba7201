/* Trials: how far interpolation across the cells of a level is from the light that is there. */
#ifndef LMB_PLACEMENT_TRIAL_H
#define LMB_PLACEMENT_TRIAL_H

#include "probes/placement_rules.h"
#include "probes/placement_sites.h"

/* Cubes of 2 x 2 x 2 cells of one level, by which it gives way to a finer one: cube c has the cells 2 c and 2 c + 1
 * along each axis. */
typedef struct lmb_level_cubes {
    uint32_t level;
    lmb_point_set cubes;
    uint8_t *open; /* [cube] bit i (bit 0 is x, 1 is y, 2 is z): an object can be in its cell i, so that it is there */
    bool *forced;  /* [cube] rules want a finer level */
    bool *tried;   /* [cube] its error decides */
    float *error;  /* [cube] mean over its cells: of what an object sees, relative to it, 1 at most, in tolerances;
                      squared */
    bool *split;   /* [cube] a finer level has its place */
} lmb_level_cubes;

void lmb_level_cubes_free(lmb_level_cubes *cubes);

static inline void lmb_cube_cell(const int32_t cube[3], int i, int32_t cell[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        cell[axis] = 2 * cube[axis] + (i >> axis & 1);
    }
}

/* Finds the open cells of the cubes, and makes sites of their corners: a cell is open when probes are wanted at a site
 * of it, or at a point of the even lattice in it. @return LMB_ERROR_MEMORY, _UNSUPPORTED, _INTERRUPTED */
lmb_result lmb_cubes_open(lmb_sites *sites, lmb_level_cubes *cubes);

/* Sets which cubes are forced, and which are to be tried. @return whether any is to be tried */
bool lmb_cubes_rule(const lmb_sites *sites, const lmb_level_rules *rules, lmb_level_cubes *cubes);

typedef enum lmb_cubes_which { LMB_CUBES_ALL, LMB_CUBES_WHOLE, LMB_CUBES_TRIED } lmb_cubes_which;

/* Adds the corners of the open cells of all cubes, of those that are not split, or of those that are tried.
 * @return LMB_ERROR_MEMORY, _UNSUPPORTED */
lmb_result lmb_cubes_corners(const lmb_level_cubes *cubes, lmb_cubes_which which, lmb_point_set *corners);

/* Gathers light at the corners of the open cells of tried cubes, and at their centres and the centres of their faces,
 * which are points of the next finer level, and sets the cubes' errors. Light darker than an even radiance of `dark`
 * counts as that. @return LMB_ERROR_MEMORY, _UNSUPPORTED, _INTERRUPTED */
lmb_result lmb_cubes_try(lmb_sites *sites, const lmb_level_rules *rules, double dark, lmb_level_cubes *cubes);

#endif
