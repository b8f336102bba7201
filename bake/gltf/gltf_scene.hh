/* What the nodes of the default scene hold, in the order of the file. */
#ifndef LMB_GLTF_SCENE_HH
#define LMB_GLTF_SCENE_HH

#include "gltf/gltf_materials.hh"
#include "gltf/gltf_world.hh"

namespace lmb_gltf {

/* A warning for each pattern of the options that matches no node: it is mistyped, or the level has changed. */
void warn_excludes(const document &document);

/* Adds cameras, seeds, points of paths, lamps and instances to a scene that has none: of the default scene, or of all
 * roots when there is none. `nodes` counts from the scene's origin. */
void add_nodes(const document &document, const std::vector<world_node> &nodes, materials &materials, lmb_scene &scene,
               const lmb_warnings &warnings);

} // namespace lmb_gltf

#endif
