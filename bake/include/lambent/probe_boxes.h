/* Boxes of a level that say how probes are to stand in them: nodes with extras {"lambent": {"volume": {...}}}. */
#ifndef LAMBENT_PROBE_BOXES_H
#define LAMBENT_PROBE_BOXES_H

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a position of the scene is in a box, its faces too. */
bool lmb_probe_box_has(const lmb_probe_box *box, lmb_vec3 position);

/* Whether a box and one along the axes, from `low` to `high`, have more in common than faces. */
bool lmb_probe_box_touches(const lmb_probe_box *box, const double low[3], const double high[3]);

/* Whether a box along the axes lies in the box. */
bool lmb_probe_box_holds(const lmb_probe_box *box, const double low[3], const double high[3]);

/* The number of the box that counts at a position of the scene: of those that it is in the one of the highest priority,
 * of equal ones the last. -1: none. */
int32_t lmb_scene_probe_box(const lmb_scene *scene, lmb_vec3 position);

/* Whether no probes are wanted at a position of the scene, by the box that counts there. */
bool lmb_scene_probes_excluded(const lmb_scene *scene, lmb_vec3 position);

#ifdef __cplusplus
}
#endif

#endif
