/* Points on the opaque surfaces of a level, by area: where a bake is tried and measured. Each is a pure function of a
 * seed and an index, so that any thread may make any of them. */
#ifndef LAMBENT_OPAQUE_SURFACE_H
#define LAMBENT_OPAQUE_SURFACE_H

#include <stdint.h>

#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The opaque triangles of a level's static instances, ready to be picked by area. */
typedef struct lmb_opaque_surface {
    const lmb_tracer *tracer;
    uint64_t *first;     /* [instance + 1] index of its first entry in `area_before` */
    double *area_before; /* [entry + 1] area of all triangles before this one, see-through ones counting 0 */
    uint64_t entry_count;
} lmb_opaque_surface;

/* @return LMB_ERROR_MEMORY */
lmb_result lmb_opaque_surface_create(const lmb_tracer *tracer, lmb_opaque_surface *surface);

/* Those of one instance alone, also if it is a moving one. @return LMB_ERROR_MEMORY */
lmb_result lmb_opaque_surface_create_of(const lmb_tracer *tracer, uint32_t instance, lmb_opaque_surface *surface);
void lmb_opaque_surface_free(lmb_opaque_surface *surface);

/* Square metres; 0 when there is no opaque triangle: then no point may be asked for. */
double lmb_opaque_surface_area(const lmb_opaque_surface *surface);

/* Point `index` of `count`: the total area is cut into `count` equal parts and one point taken in each, so that every
 * area element is as likely as any other. */
lmb_hit lmb_opaque_surface_point(const lmb_opaque_surface *surface, uint64_t seed, uint32_t index, uint32_t count);

#ifdef __cplusplus
}
#endif

#endif
