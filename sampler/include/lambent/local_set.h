/* A few probes in an object's own frame: a small oriented grid around it.
 *
 * Objects that stay get one that was baked at their place (lmb_volume_local_set). Objects that move fill one from the
 * volume once a frame (lmb_local_set_resample), and are shaded from it: each pixel or vertex then interpolates a
 * handful of probes that lie in the caches, and knows nothing of the volume. */
#ifndef LAMBENT_LOCAL_SET_H
#define LAMBENT_LOCAL_SET_H

#include <stdbool.h>
#include <stdint.h>

#include <lambent/api.h>
#include <lambent/sh.h>
#include <lambent/volume.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Probes along each axis at most. */
enum { LMB_LOCAL_SET_SIDE = 8 };

/* Where the probes are: (i, j, k) at origin + i step[0] + j step[1] + k step[2]. */
typedef struct lmb_local_frame {
    lmb_vec3d origin; /* world, metres: of the first probe */
    lmb_vec3 step[3]; /* world, metres: from one probe to the next, at right angles to each other, none 0 */
    uint32_t size[3]; /* probes along each, 1 to LMB_LOCAL_SET_SIDE */
} lmb_local_frame;

/* The frame of a box: probes at its corners and evenly between, `size` along each of its axes. Where that is 1 they lie
 * in its middle.
 * `centre` in the world; `half` from it to the middle of a face, along each axis: columns of the object's transform,
 * times half of its extents. */
LMB_API lmb_local_frame lmb_local_frame_of_box(lmb_vec3d centre, const lmb_vec3 half[3], const uint32_t size[3]);

/* How many there are. */
LMB_API uint32_t lmb_local_frame_count(const lmb_local_frame *frame);

/* World position of probe i + size[0] (j + size[1] k). */
LMB_API lmb_vec3d lmb_local_frame_position(const lmb_local_frame *frame, uint32_t probe);

/* Fills the probes from the volume: `radiance` and `visibility` (of key lights; or NULL) get one for each.
 * @return how many of them lie inside the volume */
LMB_API uint32_t lmb_local_set_resample(const lmb_volume *volume, const lmb_local_frame *frame, lmb_sh3_rgb *radiance,
                                        float (*visibility)[LMB_KEY_LIGHTS_MOST]);

/* Trilinear between the probes of a frame; beyond them, that of the nearest place among them. A position that is NaN
 * gives the first probe's light. */
LMB_API void lmb_local_set_sample(const lmb_local_frame *frame, const lmb_sh3_rgb *radiance, lmb_vec3d position,
                                  lmb_sh3_rgb *light);

#ifdef __cplusplus
}
#endif

#endif
