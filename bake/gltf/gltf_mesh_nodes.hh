/* The nodes that hold meshes: the meshes of a scene, and its instances of them. */
#ifndef LMB_GLTF_MESH_NODES_HH
#define LMB_GLTF_MESH_NODES_HH

#include "gltf/gltf_materials.hh"
#include "gltf/gltf_mesh.h"
#include "gltf/gltf_world.hh"

namespace lmb_gltf {

/* What a node and those above it want of its instances. */
struct node_wishes {
    bool dynamic, no_lightmap, has_local_set, lit_locally;
    uint32_t local_size[3];
    float texels_per_m, texel_scale; /* lmb_instance */
};

class mesh_nodes {
  public:
    /* `nodes` counts from the scene's origin. What is added tells `materials` which of them are used. */
    mesh_nodes(const document &document, const std::vector<world_node> &nodes, materials &materials, lmb_scene &scene);

    /* Adds node `node`, which holds a mesh. */
    void add(uint32_t node, const node_wishes &wishes);

  private:
    struct placement {
        uint32_t node;
        uint32_t index; /* in EXT_mesh_gpu_instancing */
        uint32_t mesh;
        node_wishes wishes;
        float step; /* lmb_instance.position_step that comes from the translation */
    };

    uint32_t mesh_of(uint32_t node);
    std::vector<lmb_affine> joints_of(const tinygltf::Skin &skin) const;
    uint32_t build(uint32_t mesh, int32_t node, const lmb_gltf_pose &pose);
    lmb_gltf_primitive read_primitive(const tinygltf::Primitive &source, const cJSON *item, uint32_t mesh,
                                      uint32_t index);
    void find_uvs(const tinygltf::Primitive &source, lmb_gltf_primitive &primitive, uint32_t mesh);
    void add_instances(uint32_t node, uint32_t mesh, const Value &attributes, const node_wishes &wishes);
    void add_instance(const placement &placing, const lmb_affine &to_world);

    const document &document_;
    const std::vector<world_node> &nodes_;
    materials &materials_;
    lmb_scene &scene_;
    std::vector<uint32_t> shared_meshes_; /* scene mesh of each of the file at rest, or NONE */
};

} // namespace lmb_gltf

#endif
