/* Diffuse light transport: how much light arrives at a point, by direction.
 *
 * Surfaces are Lambertian with their base colour, reflect on both sides, and let light straight through by their
 * opacity. Two estimators find that light:
 * - `reference`: an unbiased path tracer with next-event estimation of emissive triangles, environment and punctual
 *   lights, multiple importance sampling (balance heuristic, Veach and Guibas 1995) and Russian roulette.
 * - `cached`: the same up to the first surface; what that reflects is its albedo times light that was solved before
 *   (surface_light.h). Hits nearer than a cell of the solution are traced on. */
#ifndef LAMBENT_TRANSPORT_H
#define LAMBENT_TRANSPORT_H

#include <lambent/emitters.h>
#include <lambent/surface_light.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What is traced, and how far. The pointers must outlive every call. */
typedef struct lmb_transport {
    const lmb_tracer *tracer;
    const lmb_emitters *emitters;
    int bounces; /* reflections off surfaces at most; negative: no limit */
    uint64_t seed;
    const lmb_surface_light *surface; /* solved with the same tracer, emitters and bounces; NULL: `reference` */
} lmb_transport;

/* Radiance that arrives at `origin` from unit `direction`: what a camera sees. */
lmb_rgb lmb_radiance(const lmb_transport *transport, lmb_vec3 origin, lmb_vec3 direction, uint64_t stream,
                     uint32_t sample, uint64_t *rays);

/* The same in two parts, of which next-event estimation may find the first as well. */
typedef struct lmb_radiance_seen {
    lmb_rgb emitted;   /* by the surface that is met, or by the environment, without the sun that became a light */
    lmb_rgb reflected; /* by it */
    bool on_surface;
    lmb_hit hit; /* of the surface, if any */
} lmb_radiance_seen;
lmb_radiance_seen lmb_radiance_look(const lmb_transport *transport, const lmb_ray *ray, uint64_t stream,
                                    uint32_t sample, uint64_t *rays);

#ifdef __cplusplus
}
#endif

#endif
