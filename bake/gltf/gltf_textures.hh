/* Textures as materials use them, and the images that they lead to. */
#ifndef LMB_GLTF_TEXTURES_HH
#define LMB_GLTF_TEXTURES_HH

#include "gltf/gltf_document.hh"
#include "gltf/gltf_value.hh"

namespace lmb_gltf {

/* A texture of the file, as a material names it. */
struct texture_use {
    int index; /* -1: none */
    int uv_set;
    lmb_texture texture; /* without an image, and with uv_set still to be found */
};

extern const lmb_texture no_texture;

texture_use describe_texture(const tinygltf::TextureInfo &info);
texture_use describe_texture(const tinygltf::NormalTextureInfo &info);

/* A texture info inside an extension, which tinygltf leaves as JSON. */
texture_use describe_texture(const Value &info);

/* Reads the images that textures need into the scene, each once. */
class texture_reader {
  public:
    texture_reader(const document &document, lmb_scene &scene);

    /* Sets the image and how it is sampled; nothing of no texture (-1). An image that could not be read is tried again.
     * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
    lmb_result read(int index, lmb_texture &texture, lmb_error &error);

    /* The image of a texture in the file, or -1. */
    int image_of(int index) const;

  private:
    lmb_result read_image(uint32_t index, int32_t &image, lmb_error &error);

    const document &document_;
    lmb_scene &scene_;
    std::vector<int32_t> images_; /* scene image of each of the file, or -1: not read */
};

} // namespace lmb_gltf

#endif
