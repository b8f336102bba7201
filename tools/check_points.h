/* Where a bake is measured: normals at points on its surfaces (lambent/opaque_surface.h), and points in its free space.
 * All are pure functions of a stream, so that any thread may make any of them. */
#ifndef LMB_TOOLS_CHECK_POINTS_H
#define LMB_TOOLS_CHECK_POINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/trace.h>
#include <lambent/volume.h>

/* `count` unit vectors, cosine-weighted about unit `normal`, none farther from it than 60 degrees. */
void shading_normals(lmb_vec3 normal, uint64_t stream, int count, lmb_vec3 *normals);

/* `count` unit vectors, uniform over the sphere. */
void sphere_directions(uint64_t stream, int count, lmb_vec3 *directions);

/* A random point of the volume's baked space, and when `avoid_solids`, not inside a solid by placement's own test.
 * @return false when none of many tries found one */
bool free_point(const lmb_tracer *tracer, const lmb_volume *volume, bool avoid_solids, uint64_t stream,
                lmb_vec3 *point);

/* Cosine-weighted share of the hemisphere over `normal` that is open up to `distance` metres, as ambient-occlusion
 * bakes measure it; surfaces that let light through occlude by what they hold back. */
float ambient_visibility(const lmb_tracer *tracer, lmb_vec3 position, lmb_vec3 normal, float distance, uint64_t stream,
                         int rays);

#endif
