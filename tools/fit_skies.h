/* Procedural skies, and what a surface among them would have to know: examples that the multiply is fitted to.
 *
 * A sky is a gradient over a ground, or the six faces of a room with windows; on it stains; up to 16 suns and lamps of
 * any width; and up to two walls, half-spaces or less of constant radiance. It is seen by surfaces turned any way,
 * either as it is or, as a probe just above the surface sees it, with the surface itself in place of the lower
 * hemisphere: of constant radiance, or of two tones as in a corner. No picture of a real place is among them. */
#ifndef LMB_TOOLS_FIT_SKIES_H
#define LMB_TOOLS_FIT_SKIES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FIT_NORMALS = 32 };

/* What a probe's harmonics tell of the light about n_v = +z, all over l0, with positive local axes. */
typedef struct fit_sh3 {
    float l1_zonal, l2_zonal;
    float v[2]; /* tangential band 1 */
    float q[2]; /* tangential band 2 */
    float m[2]; /* (l22, l2-2), with positive axes: the matrix Q = [[m0, m1], [m1, -m0]] */
    float cone_cos;
} fit_sh3;

typedef enum fit_context { FIT_OPEN, FIT_WALL, FIT_TWO_TONED, FIT_CONTEXTS } fit_context;

typedef struct fit_example {
    fit_sh3 sh;
    float irradiance[FIT_NORMALS]; /* the truth at each normal, normalised, over l0 */
    float weight;                  /* of a squared error */
    fit_context context;
} fit_example;

/* Unit normals that fill the hemisphere evenly. */
extern float fit_normal[3][FIT_NORMALS];

/* Fills `examples`, the same ones for the same seed: what the whole hemisphere sends, or what a cone about the normal
 * lets through of it. `count` is a multiple of FIT_TURNS, in which each sky is seen. */
enum { FIT_TURNS = 4 };
void fit_examples_make(uint64_t seed, bool cones, size_t count, fit_example *examples);

/* The next of a sequence in [0, 1). */
double fit_variate(uint64_t *state);

#endif
