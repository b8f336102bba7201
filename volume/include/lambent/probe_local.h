/* Local sets while they are placed, baked, edited or converted: probes in frames of objects (lambent/local_set.h),
 * which belong to a level's probes and go into the same files. */
#ifndef LAMBENT_PROBE_LOCAL_H
#define LAMBENT_PROBE_LOCAL_H

#include <lambent/local_set.h>
#include <lambent/probes.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_probe_local {
    char *name;                                   /* of the object */
    int32_t node, place;                          /* its node in the level, and which of the places that it has there */
    lmb_local_frame frame;                        /* in the world */
    float *validity;                              /* [probe of the frame] as lmb_probes has it */
    lmb_sh3_rgb *radiance;                        /* [probe] in the world's axes, of the first set of lights */
    float (*key_visibility)[LMB_KEY_LIGHTS_MOST]; /* [probe][light] 0 to 1; 0 beyond the count of lights */
} lmb_probe_local;

/* Adds a dark set after those that there are, with validity 0. `name` is copied.
 * @return LMB_ERROR_ARGUMENT (lmb_local_frame_is_valid says no, or node or place is negative), _MEMORY; then nothing
 * has changed */
lmb_result lmb_probes_add_local(lmb_probes *probes, const char *name, int32_t node, int32_t place,
                                const lmb_local_frame *frame);

/* Gives probes with validity below LMB_PROBES_MIN_VALIDITY the mean light of those of their 26 neighbours in the frame
 * that have some, nearer ones (by their numbers) weighing more, pass after pass. A set without a valid probe gets what
 * the levels interpolate at its places, if they have cells there. */
void lmb_probes_dilate_locals(lmb_probes *probes);

/* Every invariant above. @return LMB_ERROR_FORMAT with the place in `error` */
lmb_result lmb_probes_validate_locals(const lmb_probes *probes, lmb_error *error);

/* The set of an object, or -1. */
int32_t lmb_probes_find_local(const lmb_probes *probes, int32_t node, int32_t place);

#ifdef __cplusplus
}
#endif

#endif
