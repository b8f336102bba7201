/* What Blender's exporter does to light, and does not say. */
#ifndef LMB_GLTF_BLENDER_H
#define LMB_GLTF_BLENDER_H

#include <lambent/scene.h>
#include <lambent/warning.h>

#include "gltf/gltf_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Lamps far brighter than what emits, as its exporter makes them; after loading. */
void lmb_gltf_blender_warn_units(const lmb_gltf_file *file, const lmb_scene *scene, const lmb_warnings *warnings);

/* Lamps that it leaves out; from the JSON's nodes. */
void lmb_gltf_blender_warn_area_lamps(const lmb_gltf_file *file, const lmb_warnings *warnings);

#ifdef __cplusplus
}
#endif

#endif
