/* Rays against a level: Embree's BVH over the scene's static instances, and the surface found at a hit.
 *
 * Nothing here is random and nothing is written after creation: any number of threads may trace. */
#ifndef LAMBENT_TRACE_H
#define LAMBENT_TRACE_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/scene.h>
#include <lambent/warning.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_tracer lmb_tracer;
struct lmb_ray_recorder;

/* Builds the BVH. `isa` pins Embree's instruction set ("sse4.2", "avx2", "avx512"), NULL lets it choose; Embree's last
 * bits differ between sets. `threads` <= 0: one for each processor. The scene must outlive the tracer.
 * @return LMB_ERROR_MEMORY, _UNSUPPORTED (no such isa here) */
lmb_result lmb_tracer_create(const lmb_scene *scene, const char *isa, int threads, lmb_tracer **tracer,
                             lmb_error *error);
void lmb_tracer_destroy(lmb_tracer *tracer);

/* The scene that it was made for. */
const lmb_scene *lmb_tracer_scene(const lmb_tracer *tracer);

/* Whether an instance is wound inside out, and is seen from the side that its winding calls back: a closed, opaque and
 * double-sided object with nothing in it, in free space. Its back then counts as its front everywhere: for hits,
 * surface points, texels, and for telling solids from free space. */
bool lmb_tracer_is_turned(const lmb_tracer *tracer, uint32_t instance);

/* Says what of the level looks like a mistake: objects wound inside out that are not double-sided, and point and spot
 * lights that opaque surfaces shut in. */
void lmb_tracer_warn(const lmb_tracer *tracer, const lmb_warnings *warnings);

/* Lets a recorder (lambent/ray_record.h) see every ray that the tracer traces from now on; NULL: none does. Not while
 * any thread traces. */
void lmb_tracer_record(lmb_tracer *tracer, struct lmb_ray_recorder *recorder);

/* Bytes that Embree holds for geometry and BVH. */
size_t lmb_tracer_bytes(const lmb_tracer *tracer);

typedef struct lmb_hit {
    uint32_t instance; /* index into scene.instances */
    uint32_t triangle; /* of the instance's mesh */
    float u, v;        /* barycentric weights of the triangle's second and third corner */
    float distance;    /* along the ray, in units of its direction's length */
    bool front;        /* the ray meets the side that the triangle's winding calls front, or the other: is_turned */
} lmb_hit;

/* The nearest triangle between the two distances along the ray, whatever it is made of. */
bool lmb_trace_nearest(const lmb_tracer *tracer, lmb_vec3 origin, lmb_vec3 direction, float near_distance,
                       float far_distance, lmb_hit *hit);

typedef struct lmb_ray {
    lmb_vec3 origin;
    lmb_vec3 direction;
} lmb_ray;

/* Rays that are traced together, as a structure of arrays. */
enum { LMB_RAY_BATCH = 64 };
typedef struct lmb_ray_batch {
    float origin[3][LMB_RAY_BATCH];
    float direction[3][LMB_RAY_BATCH];
    float far_distance[LMB_RAY_BATCH]; /* in units of the direction's length */
    uint32_t count;
} lmb_ray_batch;

/* Nearest hits of all rays, from distance 0 on. Where a ray meets nothing, hit.instance is LMB_HIT_NOTHING. */
#define LMB_HIT_NOTHING UINT32_MAX
void lmb_trace_nearest_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_hit hit[LMB_RAY_BATCH]);

/* Share of each channel that gets along each ray to its far distance, as lmb_trace_transmittance has it. Adds the rays
 * that it took to `*rays_traced`. */
void lmb_trace_transmittance_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, lmb_rgb share[LMB_RAY_BATCH],
                                   uint64_t *rays_traced);

/* Whether there is anything see-through: MASK, BLEND or transmission. */
bool lmb_tracer_has_layers(const lmb_tracer *tracer);

/* The nearest hits of rays that pass see-through surfaces, layers, by chance, from distance 0 on. Each layer is decided
 * by `chance`, a hash of the ray's own, and by the layer's triangle. `share` is multiplied by what the passed layers
 * leave of each channel, never more than all of it; where the hit itself is a layer, its opacity and the best channel's
 * pass together are the share of it that is met. Over all hashes the mean of what arrives is what
 * lmb_trace_transmittance and the opacities say. Adds the rays that it took to `*rays`. */
bool lmb_trace_through(const lmb_tracer *tracer, const lmb_ray *ray, uint64_t chance, lmb_hit *hit, lmb_rgb *share,
                       uint64_t *rays);

/* The same of a batch. Sets `share`. Without layers neither `chance` nor `share` is touched: all of it arrives. */
void lmb_trace_through_batch(const lmb_tracer *tracer, const lmb_ray_batch *rays, const uint64_t chance[LMB_RAY_BATCH],
                             lmb_hit hit[LMB_RAY_BATCH], lmb_rgb share[LMB_RAY_BATCH], uint64_t *rays_traced);

/* Share of each channel that gets from `from` to `to` through MASK, BLEND and transmitting surfaces; 0 behind an
 * opaque one. Counts the rays that it took into `*rays`. */
lmb_rgb lmb_trace_transmittance(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 to, uint64_t *rays);

/* The same along a direction, up to a distance in units of its length; FLT_MAX for no end. */
lmb_rgb lmb_trace_transmittance_along(const lmb_tracer *tracer, lmb_vec3 from, lmb_vec3 direction, float far_distance,
                                      uint64_t *rays);

/* The nearest distance along a ray that is beyond a hit. It is nudged by a hit's own rounding only: coincident surfaces
 * count once, and so does one whose two triangles meet under the ray. */
float lmb_trace_beyond(float distance);

/* How far rounding can have moved a point at `position`, in metres. On a triangle its corners count: lmb_place. */
float lmb_trace_epsilon(lmb_vec3 position);

/* A ray's origin just off a surface point, on the side of `normal` that `direction` points to: farther than `rounding`
 * can have put the point behind its own surface, and no more. */
lmb_vec3 lmb_trace_offset(lmb_vec3 position, lmb_vec3 geometric_normal, float rounding, lmb_vec3 direction);

#ifdef __cplusplus
}
#endif

#endif
