/* Local sets of the level's objects (lambent/probe_local.h): where their probes are. */
#ifndef LAMBENT_PROBE_LOCALS_H
#define LAMBENT_PROBE_LOCALS_H

#include <lambent/probe_local.h>
#include <lambent/trace.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The box around an instance in its own axes, made square where it is skewed, as a frame in the world. Without a size
 * of the instance's own, 6 probes along its longest side, and along the others as many as make them about as far apart,
 * at least 2; or 1 along a side of less than a thousandth of that.
 * @return false: the instance has no triangles */
bool lmb_probe_local_frame(const lmb_scene *scene, uint32_t instance, lmb_local_frame *frame);

/* Adds a set for each instance that wants one, moving ones too, in their order, dark and with validity, by the test
 * that placement uses: not for those without triangles, or so small or large that their frame is no valid one. Adds to
 * `*rays`. @return LMB_ERROR_MEMORY */
lmb_result lmb_probe_locals_place(const lmb_tracer *tracer, lmb_probes *probes, uint64_t *rays);

/* Metres that a probe of a frame speaks for: the shortest way to a neighbour, or the longest step where it has none. */
float lmb_probe_local_footprint(const lmb_local_frame *frame);

/* Where the light of a probe is gathered: its place, from the scene's origin, or, where that is on a surface or almost,
 * in front of it. Adds to `*rays`. */
lmb_vec3 lmb_probe_local_site(const lmb_tracer *tracer, const lmb_local_frame *frame, uint32_t probe, uint64_t *rays);

#ifdef __cplusplus
}
#endif

#endif
