/* A few probes in an object's own frame: a small oriented grid around it.
 *
 * Objects that stay get one that was baked at their place (lmb_volume_local_set_get). Objects that move fill one from
 * the volume once a frame (lmb_local_set_resample), and are shaded from it: each pixel or vertex then interpolates a
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

/* Probes along each axis at most, and all of a set's. */
enum { LMB_LOCAL_SET_SIDE = 8, LMB_LOCAL_SET_MOST = 512 };

/* Where the probes are: (i, j, k) at origin + i step[0] + j step[1] + k step[2]. */
typedef struct lmb_local_frame {
    lmb_vec3d origin; /* world, metres: of the first probe */
    lmb_vec3 step[3]; /* world, metres: from one probe to the next, at right angles to each other, none 0 */
    uint32_t size[3]; /* probes along each, 1 to LMB_LOCAL_SET_SIDE */
} lmb_local_frame;

/* Whether all of that holds, steps being at right angles to within 1e-3. */
LMB_API bool lmb_local_frame_is_valid(const lmb_local_frame *frame);

/* The frame of a box: probes at its corners and evenly between, `size` along each of its axes. Where that is 1 they lie
 * in its middle.
 * `centre` in the world; `half` from it to the middle of a face, along each axis: columns of the object's transform,
 * times half of its extents. */
LMB_API lmb_local_frame lmb_local_frame_of_box(lmb_vec3d centre, const lmb_vec3 half[3], const uint32_t size[3]);

/* How many there are. */
LMB_API uint32_t lmb_local_frame_count(const lmb_local_frame *frame);

/* World position of probe i + size[0] (j + size[1] k). */
LMB_API lmb_vec3d lmb_local_frame_position(const lmb_local_frame *frame, uint32_t probe);

/* The frame as an object has it that moved from where it was baked: `from` is a place of the object then, `to` the same
 * place of it now, and `turn` are the world directions that the world's x, y and z of then have now (a rotation). What
 * the probes hold stays in the world's axes: where light is to turn with the object, as inside a ship, each is turned
 * with lmb_sh3_rgb_in_axes. */
LMB_API lmb_local_frame lmb_local_frame_moved(const lmb_local_frame *frame, lmb_vec3d from, lmb_vec3d to,
                                              const lmb_vec3 turn[3]);

/* Fills the probes from the volume: `radiance` and `visibility` (of key lights; or NULL) get one for each.
 * @return how many of them lie inside the volume */
LMB_API uint32_t lmb_local_set_resample(const lmb_volume *volume, const lmb_local_frame *frame, lmb_sh3_rgb *radiance,
                                        float (*visibility)[LMB_KEY_LIGHTS_MOST]);

/* Trilinear between the probes of a frame; beyond them, that of the nearest place among them. A position that is NaN
 * gives the first probe's light. */
LMB_API void lmb_local_set_sample(const lmb_local_frame *frame, const lmb_sh3_rgb *radiance, lmb_vec3d position,
                                  lmb_sh3_rgb *light);

/* The same, and what is seen of key lights, `visibility` being the probes'. */
LMB_API void lmb_local_set_sample_with_keys(const lmb_local_frame *frame, const lmb_sh3_rgb *radiance,
                                            const float (*visibility)[LMB_KEY_LIGHTS_MOST], lmb_vec3d position,
                                            lmb_sh3_rgb *light, float seen[LMB_KEY_LIGHTS_MOST]);

/* A set that was baked into a volume. */
typedef struct lmb_local_set {
    const char *name;      /* of the object: UTF-8, the volume's until that is closed */
    int32_t node, place;   /* its node in the level's glTF file, and which of the places that the node puts it at */
    lmb_local_frame frame; /* where it was baked */
} lmb_local_set;

LMB_API uint32_t lmb_volume_local_set_count(const lmb_volume *volume);

/* The number of the first set of that name; the count where there is none. Names are searched one by one. */
LMB_API uint32_t lmb_volume_local_set_find(const lmb_volume *volume, const char *name);

/* Set `index`, below the count (asserted only). */
LMB_API lmb_local_set lmb_volume_local_set_get(const lmb_volume *volume, uint32_t index);

/* Its probes: as many as its frame has, at most LMB_LOCAL_SET_MOST. `visibility` may be NULL. */
LMB_API void lmb_volume_local_set_light(const lmb_volume *volume, uint32_t index, lmb_sh3_rgb *radiance,
                                        float (*visibility)[LMB_KEY_LIGHTS_MOST]);

#ifdef __cplusplus
}
#endif

#endif
