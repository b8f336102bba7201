/* What a lighting model makes of an input: compiled once as it is, and once with long doubles in place of floats
 * (wide_float.h), so that both can be asked by one program. */
#ifndef LMB_TOOLS_STABILITY_RUN_H
#define LMB_TOOLS_STABILITY_RUN_H

#include <stddef.h>

enum { STABILITY_NORMALS = 4, STABILITY_VALUES = 3 * STABILITY_NORMALS };

/* All values are floats' ones. Normals are of unit length, but the first, n_v, only where an input is not meant to be
 * broken. */
typedef struct stability_input {
    double sh[3][9];
    double vertex_normal[3];
    double normal[STABILITY_NORMALS][3];
    double cone_cos;
} stability_input;

/* Irradiance on each of the normals by row `model` of the table. */
void stability_run_float(size_t model, const stability_input *input, double irradiance[STABILITY_VALUES]);
void stability_run_wide(size_t model, const stability_input *input, double irradiance[STABILITY_VALUES]);

#endif
