/* Where a bake is measured: points on its surfaces, normals at them, and points in its free space. All are pure
 * functions of a seed and a number, so that any thread may make any of them. */
#ifndef LMB_TOOLS_CHECK_POINTS_H
#define LMB_TOOLS_CHECK_POINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <lambent/trace.h>
#include <lambent/volume.h>

/* The opaque triangles of a level's static instances, ready to be picked by area. */
typedef struct opaque_surface {
    const lmb_tracer *tracer;
    uint64_t *first;     /* [instance + 1] index of its first entry in `area_before` */
    double *area_before; /* [entry + 1] area of all triangles before this one, see-through ones counting 0 */
    uint64_t entry_count;
} opaque_surface;

/* @return LMB_ERROR_MEMORY */
lmb_result opaque_surface_create(const lmb_tracer *tracer, opaque_surface *surface);
void opaque_surface_free(opaque_surface *surface);

/* Square metres; 0 when there is no opaque triangle: then no point may be asked for. */
double opaque_surface_area(const opaque_surface *surface);

/* Point `number` of `count`: the total area is cut into `count` equal parts and one point taken in each, so that every
 * area element is as likely as any other. */
lmb_hit opaque_surface_point(const opaque_surface *surface, uint64_t seed, uint32_t number, uint32_t count);

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
