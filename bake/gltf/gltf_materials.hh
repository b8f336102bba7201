/* The materials of a scene. */
#ifndef LMB_GLTF_MATERIALS_HH
#define LMB_GLTF_MATERIALS_HH

#include <set>

#include "gltf/gltf_textures.hh"

namespace lmb_gltf {

class materials {
  public:
    /* The file's materials in their order, then the default one, without images. */
    materials(const document &document, lmb_scene &scene);

    /* A primitive that is placed has this material: what its textures need will be read. */
    void use(uint32_t material);

    /* The TEXCOORD that lmb_mesh.uv[slot] is, if any texture of the material needs it, or every mesh has it; else -1.
     */
    int uv_set(uint32_t material, int32_t slot) const;

    /* The images of the materials that are used. */
    void read_images();

  private:
    struct textures {
        texture_use base_color, emissive, normal, metallic_roughness;
        bool used;
    };

    std::string name_of(uint32_t material) const;
    textures read(uint32_t index, lmb_material &material) const;
    int32_t uv_slot(const texture_use &use, uint32_t material);
    void read_unneeded(uint32_t material, texture_reader &reader, const texture_use &use, lmb_texture &texture,
                       const char *what);

    const document &document_;
    lmb_scene &scene_;
    std::vector<textures> textures_; /* [material], without the default one */
    std::set<int> unreadable_;       /* images of the file */
    std::vector<int> uv_sets_{0, 1}; /* the TEXCOORD that each of lmb_mesh.uv is */
};

} // namespace lmb_gltf

#endif
