/* Light on surfaces, solved once: the irradiance on every side of every static triangle, by direct light and any
 * number of bounces. A gather that has it ends at the first surface.
 *
 * Each triangle of each instance is divided for itself, so nothing is shared across edges and nothing leaks across
 * them. Strips run parallel to its shortest edge, and lines through the corner opposite cut them into columns:
 *
 *             .            3 strips x 2 columns. Long thin triangles, which levels are full of, get cells that are
 *            /|\           as long as wide, which dividing all three edges alike would not give them.
 *           /_|_\
 *          /  |  \
 *         /___|___\
 *        /    |    \
 *       /_____|_____\
 *
 * Each cell holds normalised irradiance (E / pi, as RGB) for its front and for its back, by samples that start anywhere
 * in it. It is the mean over what can be seen of the cell from farther than half its length: parts under a wall, in a
 * gap behind a lamp or in a corner count by how open they are, because that is the share of the rays that reach them
 * and look here. Emission and albedo are not stored: they are exact at each hit.
 *
 * A wall that stands on a cell would let light through it. Rays across each cell, just above it, find out; such a cell
 * is divided into pieces, each what one of its points sees, and a hit takes the light of a piece whose point it sees.
 *
 * The solution is that of E = D + T E, where D is direct light and T the transport between cells: both are sampled
 * once, with one ray for each sample that finds direct light by its part of multiple importance sampling and one entry
 * of a sparse matrix. After that the bounces cost no rays, and however white a room is some hundred passes over the
 * matrix sum all of them (surface_light_bounce.c). The estimate of a sum of products of T's entries is biased only by
 * paths that visit one cell twice, which are rare where there are many cells. */
#ifndef LAMBENT_SURFACE_LIGHT_H
#define LAMBENT_SURFACE_LIGHT_H

#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_surface_light lmb_surface_light;

void lmb_surface_light_destroy(lmb_surface_light *light);

/* Bytes that it holds. */
size_t lmb_surface_light_bytes(const lmb_surface_light *light);

/* Metres: the cell size that was used. What is stored holds for rays that come from farther than half of that. */
float lmb_surface_light_cell_size(const lmb_surface_light *light);

/* Luminance of the normalised irradiance, as the mean over the area of all sides that light reaches; 0 without any. */
double lmb_surface_light_mean(const lmb_surface_light *light, const lmb_tracer *tracer);

/* Normalised irradiance on one side of a surface at a hit: radiance is albedo times this. False, and nothing is set,
 * where nothing is stored: in corners of divided cells that none of their points sees. */
bool lmb_surface_light_at(const lmb_surface_light *light, const lmb_tracer *tracer, const lmb_hit *hit, bool front,
                          lmb_rgb *irradiance);

#ifdef __cplusplus
}
#endif

#endif
