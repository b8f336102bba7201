/* Boxes of a level that say how probes are to stand in them: nodes with extras {"lambent": {"volume": {...}}}. */
#ifndef LAMBENT_PROBE_BOXES_H
#define LAMBENT_PROBE_BOXES_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a position of the scene is in a box, its faces too. */
bool lmb_probe_box_has(const lmb_probe_box *box, lmb_vec3 position);

/* The number of the box that counts at a position of the scene: of those that it is in the one of the highest priority,
 * of equal ones the last. -1: none. */
int32_t lmb_scene_probe_box(const lmb_scene *scene, lmb_vec3 position);

#ifdef __cplusplus
}
#endif

#endif
