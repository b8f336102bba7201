/* From what is known of a sphere of light to the irradiance of one hemisphere of it, about n_v = +z and all over l0:
 * Gram's moments, what the network adds to them, the HHD solve, and the way back for slopes. */
#ifndef LMB_TOOLS_FIT_SOLVE_H
#define LMB_TOOLS_FIT_SOLVE_H

#include "fit_skies.h"

enum {
    FIT_SCALAR, /* added to b_c */
    FIT_ZONAL,  /* added to b.n_v */
    FIT_V,      /* times v, */
    FIT_Q,      /* times q, */
    FIT_QV,     /* times Q v: added to b_perp */
    FIT_OUTPUTS
};

/* Squares of bands 1 and 2 over l0 at which outputs reach half as far as they can. */
#define FIT_EVEN_SQUARE 0.03f

/* Q v */
void fit_sectoral_times(const fit_sh3 *sh, const float *v, float *result);

/* b_c, b.n_v and b_perp. */
typedef struct fit_moments {
    float scalar, zonal, tangential[2];
} fit_moments;

/* Gram's (docs/maths.md, Clipping by a cone), and what `output` adds; NULL: nothing. */
fit_moments fit_moments_of(const fit_sh3 *sh, const float *output);

/* C_a, and C_d d as one vector. */
typedef struct fit_light {
    float ambient;
    float directional[3];
} fit_light;

fit_light fit_solve(const fit_moments *moments);

/* How something changes with the outputs, by how it changes with the light that they lead to. */
void fit_slopes(const fit_sh3 *sh, const fit_moments *moments, const fit_light *slope, float *output_slope);

#endif
