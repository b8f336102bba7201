/* Lamps as Blender exports them. */
#ifndef LMB_GLTF_BLENDER_H
#define LMB_GLTF_BLENDER_H

#include "gltf/gltf_file.h"

#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Lamps far brighter than what emits, as its exporter makes them (after loading), and lamps that it leaves out (from
 * the JSON). */
void lmb_gltf_blender_warn_units(const lmb_gltf_file *file, const lmb_scene *scene, const lmb_warnings *warnings);
void lmb_gltf_blender_warn_area_lamps(const lmb_gltf_file *file, const lmb_warnings *warnings);

#ifdef __cplusplus
}
#endif

#endif
