/* The lamps of KHR_lights_punctual. */
#ifndef LMB_GLTF_LIGHTS_HH
#define LMB_GLTF_LIGHTS_HH

#include "gltf/gltf_document.hh"

namespace lmb_gltf {

/* Adds lamp `light` of the file, which hangs on node `node` of this transform, to the scene; with a warning instead
 * when it cannot give light there. */
void add_light(const document &document, uint32_t light, uint32_t node, const lmb_affine &to_world, lmb_scene &scene,
               const lmb_warnings &warnings);

} // namespace lmb_gltf

#endif
