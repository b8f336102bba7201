/* Parts of an emissive triangle, between lines of its texture's texels, and points on them in proportion to what they
 * give.
 *
 * A part is halved between two texels, and its halves again, down to single texels. The choice between two halves is by
 * their area times the mean weight (emission_map.h) of the cells about them. Where these lie all in the triangle that
 * makes the density the weight itself; along the triangle's edges it is about that. Nothing of it is stored: a texture
 * that is repeated a thousand times takes no more than one that is not, and time grows with the logarithm of the
 * number of texels. */
#ifndef LMB_EMISSION_PART_H
#define LMB_EMISSION_PART_H

#include "light/emission_map.h"

/* Where a triangle lies in its texture: texel = origin + along[0] u + along[1] v, for barycentric u and v. */
typedef struct lmb_emission_lattice {
    double origin[2];
    double along[2][2];
} lmb_emission_lattice;

/* False where texture coordinates are not finite or too far out to tell texels apart. */
bool lmb_emission_lattice_of(const lmb_mesh *mesh, uint32_t triangle, const lmb_texture *texture,
                             const lmb_emission_map *map, lmb_emission_lattice *lattice);

/* A convex polygon. A triangle between two lines each way has up to seven corners. */
enum { LMB_PART_CORNERS = 12 };
typedef struct lmb_part_corner {
    double weight[2]; /* barycentric u, v */
    double texel[2];
} lmb_part_corner;
typedef struct lmb_emission_part {
    int count;
    lmb_part_corner corner[LMB_PART_CORNERS];
} lmb_emission_part;

/* The whole triangle. */
lmb_emission_part lmb_emission_part_whole(const lmb_emission_lattice *lattice);

/* A line between texels: texel[axis] = line. */
typedef struct lmb_emission_cut {
    int axis;
    int32_t line;
} lmb_emission_cut;

/* The line that halves a part; false for one that lies in a single cell. */
bool lmb_emission_part_cut(const lmb_emission_map *map, const lmb_emission_part *part, lmb_emission_cut *cut);

/* The part below the line and the one from it on; either may be empty. */
void lmb_emission_part_halve(const lmb_emission_part *part, const lmb_emission_cut *cut, lmb_emission_part half[2]);

/* Weight times area, that of the whole triangle being 1. 0 only where nothing of the part gives light. */
double lmb_emission_part_light(const lmb_emission_map *map, const lmb_emission_part *part);

/* Whether a part is known to give the same all over. Large ones are not looked at. */
bool lmb_emission_part_is_even(const lmb_emission_map *map, const lmb_emission_part *part);

/* The whole triangle's is 1. */
double lmb_emission_part_area(const lmb_emission_part *part);

/* A point of the part for u in [0, 1)^2, and how many times denser such points are there than points even over the
 * whole triangle. Neighbouring u give neighbouring points, for the most. False where no point is found. Without a
 * map points are even over the part. */
bool lmb_emission_part_sample(const lmb_emission_map *map, const lmb_emission_part *part, const float u[2],
                              float weight[2], float *density);

/* That density at a point of the part. */
double lmb_emission_part_density(const lmb_emission_map *map, const lmb_emission_part *part, const double texel[2]);

static inline void lmb_emission_texel(const lmb_emission_lattice *lattice, float u, float v, double texel[2])
{
    for (int axis = 0; axis < 2; ++axis) {
        texel[axis] = lattice->origin[axis] + lattice->along[0][axis] * (double)u + lattice->along[1][axis] * (double)v;
    }
}

#endif
