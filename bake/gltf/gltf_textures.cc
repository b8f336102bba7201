#include "gltf/gltf_textures.hh"

#include <algorithm>

extern "C" {
#include "base/trig.h"
}
#include "gltf/gltf_append.hh"
#include "gltf/gltf_image.h"

namespace lmb_gltf {

const lmb_texture no_texture = {-1, 0, LMB_WRAP_REPEAT, LMB_WRAP_REPEAT, false, {{1, 0, 0}, {0, 1, 0}}};

namespace {

lmb_wrap wrap_of(int mode)
{
    return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? LMB_WRAP_CLAMP
           : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? LMB_WRAP_MIRROR
                                                           : LMB_WRAP_REPEAT;
}

/* T R S of KHR_texture_transform's text: the rotation turns the image counter-clockwise. */
texture_use transformed(int index, int uv_set, const Value &transform)
{
    const Value &own_set = member(transform, "texCoord");
    texture_use use = {index, own_set.IsNumber() ? index_of(own_set) : uv_set, no_texture};
    const auto element = [](const Value &list, int i, double missing) {
        return list.IsArray() ? number(list.Get(i), missing) : missing;
    };
    const Value &offset = member(transform, "offset"), &scale = member(transform, "scale");
    double sine, cosine;
    lmb_sincos(number(member(transform, "rotation"), 0.0), &sine, &cosine);
    const double su = element(scale, 0, 1.0), sv = element(scale, 1, 1.0);
    const double map[2][3] = {{cosine * su, sine * sv, element(offset, 0, 0.0)},
                              {-sine * su, cosine * sv, element(offset, 1, 0.0)}};
    for (int i = 0; i < 6; ++i) {
        use.texture.transform[i / 3][i % 3] = to_float(map[i / 3][i % 3]);
    }
    return use;
}

template <class Info> texture_use describe_info(const Info &info)
{
    return transformed(info.index, info.texCoord, find_extension(info.extensions, "KHR_texture_transform"));
}

} // namespace

texture_use describe_texture(const tinygltf::TextureInfo &info)
{
    return describe_info(info);
}

texture_use describe_texture(const tinygltf::NormalTextureInfo &info)
{
    return describe_info(info);
}

texture_use describe_texture(const Value &info)
{
    return transformed(index_of(member(info, "index")), std::max(index_of(member(info, "texCoord")), 0),
                       member(member(info, "extensions"), "KHR_texture_transform"));
}

texture_reader::texture_reader(const document &document, lmb_scene &scene)
    : document_(document), scene_(scene), images_(document.images.size(), -1)
{
}

/* Decodes an image when a material first asks for it; the others do not matter to light. */
lmb_result texture_reader::read_image(uint32_t index, int32_t &image, lmb_error &error)
{
    if (images_[index] < 0) {
        lmb_texture_image &added = append(scene_.images, scene_.image_count);
        const lmb_result result = lmb_gltf_image_decode(document_.file, document_.images[index], index, &added, &error);
        if (result != LMB_OK) {
            --scene_.image_count;
            return result;
        }
        images_[index] = int32_t(scene_.image_count) - 1;
    }
    image = images_[index];
    return LMB_OK;
}

int texture_reader::image_of(int index) const
{
    const auto &textures = document_.model.textures;
    const int image = index >= 0 && size_t(index) < textures.size() ? textures[size_t(index)].source : -1;
    return image >= 0 && size_t(image) < images_.size() ? image : -1;
}

lmb_result texture_reader::read(int index, lmb_texture &texture, lmb_error &error)
{
    const tinygltf::Model &model = document_.model;
    const char *const path = document_.file->path;
    if (index < 0) {
        return LMB_OK;
    }
    if (size_t(index) >= model.textures.size()) {
        return lmb_error_set(&error, LMB_ERROR_FORMAT, "%s: texture %d, but there are %zu textures", path, index,
                             model.textures.size());
    }
    const tinygltf::Texture &source = model.textures[size_t(index)];
    if (source.sampler >= 0) {
        if (size_t(source.sampler) >= model.samplers.size()) {
            return lmb_error_set(&error, LMB_ERROR_FORMAT, "%s: textures[%d].sampler: %d, but there are %zu samplers",
                                 path, index, source.sampler, model.samplers.size());
        }
        const tinygltf::Sampler &sampler = model.samplers[size_t(source.sampler)];
        texture.wrap_u = wrap_of(sampler.wrapS);
        texture.wrap_v = wrap_of(sampler.wrapT);
        texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    if (source.source >= 0) {
        if (size_t(source.source) >= images_.size()) {
            return lmb_error_set(&error, LMB_ERROR_FORMAT, "%s: textures[%d].source: %d, but there are %zu images",
                                 path, index, source.source, images_.size());
        }
        return read_image(uint32_t(source.source), texture.image, error);
    }
    if (!source.extensions.empty()) {
        return lmb_error_set(&error, LMB_ERROR_UNSUPPORTED,
                             "%s: textures[%d]: %s is not supported, and there is no other source", path, index,
                             source.extensions.begin()->first.c_str());
    }
    return LMB_OK;
}

} // namespace lmb_gltf
