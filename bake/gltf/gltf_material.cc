#include "gltf/gltf_loader.hh"

#include <stb_image.h>

extern "C" {
#include "base/rgb.h"
#include "base/scalar.h"
#include "base/trig.h"
}

#include <lambent/file.h>

#include "gltf/gltf_image.h"

namespace lmb_gltf {

namespace {

/* Pixels of one image; enough for 16 k x 16 k. */
constexpr int64_t MAX_PIXELS = int64_t(1) << 28;

float clamp01(double value)
{
    return value > 0.0 ? float(std::min(value, 1.0)) : 0.0f;
}

} // namespace

/* Decodes an image when a material first asks for it; the others do not matter to light. */
int32_t loader::read_image(uint32_t number)
{
    if (images_[number] >= 0) {
        return images_[number];
    }
    lmb_gltf_bytes bytes{};
    lmb_texture_image image{};
    check(lmb_gltf_image_read(file_, image_items_[number], number, &bytes, &image.name, error_));
    std::unique_ptr<unsigned char, void (*)(void *)> owned(bytes.owned, free);
    std::unique_ptr<char, void (*)(void *)> name(image.name, free);
    int channels = 0;
    const int size = int(bytes.size);
    if (!stbi_info_from_memory(bytes.data, size, &image.width, &image.height, &channels)) {
        fail(LMB_ERROR_FORMAT, "images[%u]: %s: neither PNG nor JPEG", number, image.name);
    }
    if (int64_t(image.width) * image.height > MAX_PIXELS) {
        fail(LMB_ERROR_UNSUPPORTED, "images[%u]: %s: %d x %d pixels", number, image.name, image.width, image.height);
    }
    if (stbi_is_16_bit_from_memory(bytes.data, size)) {
        std::unique_ptr<stbi_us, void (*)(void *)> wide(
            stbi_load_16_from_memory(bytes.data, size, &image.width, &image.height, &channels, 4), stbi_image_free);
        const size_t count = size_t(image.width) * size_t(image.height) * 4;
        image.rgba = wide ? static_cast<uint8_t *>(malloc(count)) : nullptr;
        for (size_t i = 0; image.rgba && i < count; ++i) {
            image.rgba[i] = uint8_t((wide.get()[i] * 255u + 32767u) / 65535u);
        }
    } else {
        image.rgba = stbi_load_from_memory(bytes.data, size, &image.width, &image.height, &channels, 4);
    }
    if (!image.rgba) {
        const char *const reason = stbi_failure_reason();
        fail(LMB_ERROR_FORMAT, "images[%u]: %s: cannot be decoded: %s", number, image.name, reason ? reason : "");
    }
    std::unique_ptr<uint8_t, void (*)(void *)> rgba(image.rgba, free);
    append(scene_->images, scene_->image_count) = image;
    name.release();
    rgba.release();
    images_[number] = int32_t(scene_->image_count) - 1;
    return images_[number];
}

namespace {

lmb_wrap wrap_of(int mode)
{
    return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? LMB_WRAP_CLAMP
           : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? LMB_WRAP_MIRROR
                                                           : LMB_WRAP_REPEAT;
}

const lmb_texture no_texture = {-1, 0, LMB_WRAP_REPEAT, LMB_WRAP_REPEAT, false, {{1, 0, 0}, {0, 1, 0}}};

/* A use of a texture but for the texture itself. */
template <class Use> lmb_texture describe_texture(int index, int uv_set, const Value &transform, Use *use)
{
    lmb_texture texture = no_texture;
    use->index = index;
    use->uv_set = member(transform, "texCoord").IsNumber() ? index_of(member(transform, "texCoord")) : uv_set;
    const auto element = [](const Value &list, int i, double missing) {
        return list.IsArray() ? number(list.Get(i), missing) : missing;
    };
    const Value &offset = member(transform, "offset"), &scale = member(transform, "scale");
    double sine, cosine;
    lmb_sincos(number(member(transform, "rotation"), 0.0), &sine, &cosine);
    const double su = element(scale, 0, 1.0), sv = element(scale, 1, 1.0);
    /* T R S of the extension's text: the rotation turns the image counter-clockwise. */
    const double map[2][3] = {{cosine * su, sine * sv, element(offset, 0, 0.0)},
                              {-sine * su, cosine * sv, element(offset, 1, 0.0)}};
    for (int i = 0; i < 6; ++i) {
        texture.transform[i / 3][i % 3] = to_float(map[i / 3][i % 3]);
    }
    return texture;
}

template <class Info, class Use> lmb_texture describe_texture(const Info &info, Use *use)
{
    return describe_texture(info.index, info.texCoord, find_extension(info.extensions, "KHR_texture_transform"), use);
}

/* A texture info inside an extension, which tinygltf leaves as JSON. */
template <class Use> lmb_texture describe_texture(const Value &info, Use *use)
{
    return describe_texture(index_of(member(info, "index")), std::max(index_of(member(info, "texCoord")), 0),
                            member(member(info, "extensions"), "KHR_texture_transform"), use);
}

} // namespace

void loader::read_material(const tinygltf::Material &source, lmb_material *material, material_textures *textures)
{
    const tinygltf::PbrMetallicRoughness &pbr = source.pbrMetallicRoughness;
    const Value &glossiness = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    if (glossiness.IsObject()) {
        const Value &factor = member(glossiness, "diffuseFactor");
        for (int c = 0; c < 4; ++c) {
            material->base_color[c] = factor.IsArray() ? clamp01(number(factor.Get(c), 1.0)) : 1.0f;
        }
        material->base_color_texture = describe_texture(member(glossiness, "diffuseTexture"), &textures->base_color);
    } else {
        for (size_t c = 0; c < 4; ++c) {
            material->base_color[c] = clamp01(pbr.baseColorFactor[c]);
        }
        material->base_color_texture = describe_texture(pbr.baseColorTexture, &textures->base_color);
    }
    const double strength =
        number(member(find_extension(source.extensions, "KHR_materials_emissive_strength"), "emissiveStrength"), 1.0);
    for (size_t c = 0; c < 3; ++c) {
        material->emissive.c[c] = to_float(std::max(source.emissiveFactor[c], 0.0) * strength * emission_scale_);
    }
    material->emissive_texture = describe_texture(source.emissiveTexture, &textures->emissive);
    if (rgb_max(material->emissive) == 0.0f) {
        textures->emissive.index = -1; /* black whatever it is */
    }
    material->normal_texture = describe_texture(source.normalTexture, &textures->normal);
    material->normal_scale = to_float(source.normalTexture.scale);
    material->transmission = clamp01(
        number(member(find_extension(source.extensions, "KHR_materials_transmission"), "transmissionFactor"), 0.0));
    material->alpha_mode = source.alphaMode == "MASK"    ? LMB_ALPHA_MASK
                           : source.alphaMode == "BLEND" ? LMB_ALPHA_BLEND
                                                         : LMB_ALPHA_OPAQUE;
    material->alpha_cutoff = to_float(source.alphaCutoff);
    material->double_sided = source.doubleSided;
    material->unlit = source.extensions.count("KHR_materials_unlit") > 0;
    material->name = copy_string(source.name);
}

/* The glTF's materials in their order, then the default one. */
void loader::read_materials()
{
    for (const tinygltf::Material &material : model_.materials) {
        textures_.emplace_back();
        read_material(material, &append(scene_->materials, scene_->material_count), &textures_.back());
    }
    lmb_material &fallback = append(scene_->materials, scene_->material_count);
    std::fill(fallback.base_color, fallback.base_color + 4, 1.0f);
    fallback.base_color_texture = fallback.emissive_texture = fallback.normal_texture = no_texture;
    fallback.normal_scale = 1.0f;
    fallback.alpha_cutoff = 0.5f;
    fallback.name = copy_string("default");
}

std::string loader::material_name(uint32_t number) const
{
    const std::string &name = model_.materials[number].name;
    return name.empty() ? "materials[" + std::to_string(number) + "]" : "material '" + name + "'";
}

/* Which of lmb_mesh.uv a TEXCOORD is. */
int32_t loader::uv_slot(int uv_set, int texture, uint32_t material)
{
    const auto known = std::find(uv_sets_.begin(), uv_sets_.end(), uv_set);
    if (known != uv_sets_.end()) {
        return int32_t(known - uv_sets_.begin());
    }
    if (uv_sets_.size() == LMB_UV_SETS) {
        fail(LMB_ERROR_UNSUPPORTED, "%s: textures[%d] uses TEXCOORD_%d, beside %d other sets of UVs",
             material_name(material).c_str(), texture, uv_set, int(LMB_UV_SETS));
    }
    uv_sets_.push_back(uv_set);
    return int32_t(uv_sets_.size()) - 1;
}

/* A primitive that is placed has this material: what its textures need will be read. */
void loader::use_material(uint32_t number)
{
    if (number >= textures_.size() || textures_[number].used) {
        return;
    }
    material_textures &uses = textures_[number];
    lmb_material &material = scene_->materials[number];
    const auto find_slot = [&](const auto &use, lmb_texture *texture) {
        texture->uv_set = use.index >= 0 ? uv_slot(use.uv_set, use.index, number) : 0;
    };
    uses.used = true;
    find_slot(uses.base_color, &material.base_color_texture);
    find_slot(uses.emissive, &material.emissive_texture);
    find_slot(uses.normal, &material.normal_texture);
}

void loader::read_image_of(lmb_texture *texture, int index)
{
    if (index < 0) {
        return;
    }
    if (size_t(index) >= model_.textures.size()) {
        fail(LMB_ERROR_FORMAT, "texture %d, but there are %zu textures", index, model_.textures.size());
    }
    const tinygltf::Texture &source = model_.textures[size_t(index)];
    if (source.sampler >= 0) {
        if (size_t(source.sampler) >= model_.samplers.size()) {
            fail(LMB_ERROR_FORMAT, "textures[%d].sampler: %d, but there are %zu samplers", index, source.sampler,
                 model_.samplers.size());
        }
        const tinygltf::Sampler &sampler = model_.samplers[size_t(source.sampler)];
        texture->wrap_u = wrap_of(sampler.wrapS);
        texture->wrap_v = wrap_of(sampler.wrapT);
        texture->nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    if (source.source >= 0) {
        if (size_t(source.source) >= images_.size()) {
            fail(LMB_ERROR_FORMAT, "textures[%d].source: %d, but there are %zu images", index, source.source,
                 images_.size());
        }
        texture->image = read_image(uint32_t(source.source));
    } else if (!source.extensions.empty()) {
        fail(LMB_ERROR_UNSUPPORTED, "textures[%d]: %s is not supported, and there is no other source", index,
             source.extensions.begin()->first.c_str());
    }
}

/* The bake does not need it, so what is wrong with it stops nothing. Of one image it is said once. */
void loader::read_normal_map(uint32_t number, int index)
{
    const int image = index >= 0 && size_t(index) < model_.textures.size() ? model_.textures[size_t(index)].source : -1;
    const bool known = image >= 0 && size_t(image) < images_.size();
    if (known && images_[size_t(image)] == NOT_READABLE) {
        return;
    }
    lmb_error *const outer = error_;
    lmb_error reason = {""};
    error_ = &reason;
    try {
        read_image_of(&scene_->materials[number].normal_texture, index);
    } catch (const failure &f) {
        if (f.result == LMB_ERROR_MEMORY) {
            error_ = outer;
            throw std::bad_alloc();
        }
        lmb_warn(warnings_, "%s; %s goes without its normal map", reason.message, material_name(number).c_str());
        if (known) {
            images_[size_t(image)] = NOT_READABLE;
        }
    }
    error_ = outer;
}

/* Of the materials in sight. */
void loader::read_images()
{
    for (uint32_t i = 0; i < textures_.size(); ++i) {
        if (textures_[i].used) {
            read_image_of(&scene_->materials[i].base_color_texture, textures_[i].base_color.index);
            read_image_of(&scene_->materials[i].emissive_texture, textures_[i].emissive.index);
            read_normal_map(i, textures_[i].normal.index);
        }
    }
}

} // namespace lmb_gltf
