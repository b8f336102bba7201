#include "gltf/gltf_materials.hh"

#include <algorithm>

#include <lambent/vector.h>

#include "gltf/gltf_append.hh"

namespace lmb_gltf {

namespace {

lmb_alpha_mode alpha_mode_of(const std::string &word)
{
    return word == "MASK" ? LMB_ALPHA_MASK : word == "BLEND" ? LMB_ALPHA_BLEND : LMB_ALPHA_OPAQUE;
}

/* The factor and the texture of what is reflected diffusely. */
texture_use read_base_color(const tinygltf::Material &source, float factor[4])
{
    const Value &glossiness = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    if (glossiness.IsObject()) {
        const Value &diffuse = member(glossiness, "diffuseFactor");
        for (int c = 0; c < 4; ++c) {
            factor[c] = diffuse.IsArray() ? lmb_saturate(to_float(number(diffuse.Get(c), 1.0))) : 1.0f;
        }
        return describe_texture(member(glossiness, "diffuseTexture"));
    }
    const tinygltf::PbrMetallicRoughness &pbr = source.pbrMetallicRoughness;
    for (size_t c = 0; c < 4; ++c) {
        factor[c] = lmb_saturate(to_float(pbr.baseColorFactor[c]));
    }
    return describe_texture(pbr.baseColorTexture);
}

/* Gloss is one minus roughness, and no metal. */
texture_use read_metallic_roughness(const tinygltf::Material &source, lmb_material &material)
{
    const Value &glossiness = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    if (glossiness.IsObject()) {
        material.roughness = 1.0f - lmb_saturate(to_float(number(member(glossiness, "glossinessFactor"), 1.0)));
        return {-1, 0, no_texture};
    }
    const tinygltf::PbrMetallicRoughness &pbr = source.pbrMetallicRoughness;
    material.metallic = lmb_saturate(to_float(pbr.metallicFactor));
    material.roughness = lmb_saturate(to_float(pbr.roughnessFactor));
    return describe_texture(pbr.metallicRoughnessTexture);
}

} // namespace

materials::textures materials::read(uint32_t index, lmb_material &material) const
{
    const tinygltf::Material &source = document_.model.materials[index];
    textures uses = {read_base_color(source, material.base_color), describe_texture(source.emissiveTexture),
                     describe_texture(source.normalTexture), read_metallic_roughness(source, material), false};
    if (!document_.options.reflection) {
        uses.metallic_roughness.index = -1;
    }
    const auto extension = [&](const char *name, const char *property, double missing) {
        return number(member(find_extension(source.extensions, name), property), missing);
    };
    const double scale = scale_of(document_.options.emission_scale);
    const double strength = extension("KHR_materials_emissive_strength", "emissiveStrength", 1.0);
    for (size_t c = 0; c < 3; ++c) {
        material.emissive.c[c] = to_float(std::max(source.emissiveFactor[c], 0.0) * strength * scale);
    }
    if (lmb_rgb_max(material.emissive) == 0.0f) {
        uses.emissive.index = -1; /* black whatever it is */
    }
    material.base_color_texture = uses.base_color.texture;
    material.emissive_texture = uses.emissive.texture;
    material.normal_texture = uses.normal.texture;
    material.metallic_roughness_texture = uses.metallic_roughness.texture;
    material.normal_scale = to_float(source.normalTexture.scale);
    material.transmission = lmb_saturate(to_float(extension("KHR_materials_transmission", "transmissionFactor", 0.0)));
    material.alpha_mode = alpha_mode_of(source.alphaMode);
    material.alpha_cutoff = to_float(source.alphaCutoff);
    material.double_sided = source.doubleSided;
    material.unlit = source.extensions.count("KHR_materials_unlit") > 0;
    material.name = copy_string(source.name);
    char set[LMB_LIGHT_SET_NAME];
    lmb_gltf_material_light_set(document_.file, &document_.options.warnings, index, set);
    material.set = light_set_of(document_, scene_, set, name_of(index), document_.options.warnings);
    return uses;
}

materials::materials(const document &document, lmb_scene &scene) : document_(document), scene_(scene)
{
    for (uint32_t i = 0; i < document.model.materials.size(); ++i) {
        lmb_material &added = append(scene.materials, scene.material_count);
        textures_.push_back(read(i, added));
    }
    lmb_material &fallback = append(scene.materials, scene.material_count);
    std::fill(fallback.base_color, fallback.base_color + 4, 1.0f);
    fallback.base_color_texture = fallback.emissive_texture = fallback.normal_texture = no_texture;
    fallback.metallic_roughness_texture = no_texture;
    fallback.normal_scale = fallback.metallic = fallback.roughness = 1.0f;
    fallback.alpha_cutoff = 0.5f;
    fallback.name = copy_string("default");
}

std::string materials::name_of(uint32_t material) const
{
    const std::string &name = document_.model.materials[material].name;
    return name.empty() ? "materials[" + std::to_string(material) + "]" : "material '" + name + "'";
}

/* Which of lmb_mesh.uv a texture is laid out by; 0 of none. */
int32_t materials::uv_slot(const texture_use &use, uint32_t material)
{
    if (use.index < 0) {
        return 0;
    }
    const auto known = std::find(uv_sets_.begin(), uv_sets_.end(), use.uv_set);
    if (known != uv_sets_.end()) {
        return int32_t(known - uv_sets_.begin());
    }
    if (uv_sets_.size() == LMB_UV_SETS) {
        document_.fail(LMB_ERROR_UNSUPPORTED, "%s: textures[%d] uses TEXCOORD_%d, beside %d other sets of UVs",
                       name_of(material).c_str(), use.index, use.uv_set, int(LMB_UV_SETS));
    }
    uv_sets_.push_back(use.uv_set);
    return int32_t(uv_sets_.size()) - 1;
}

void materials::use(uint32_t index)
{
    if (index >= textures_.size() || textures_[index].used) {
        return;
    }
    textures &uses = textures_[index];
    lmb_material &material = scene_.materials[index];
    uses.used = true;
    material.base_color_texture.uv_set = uv_slot(uses.base_color, index);
    material.emissive_texture.uv_set = uv_slot(uses.emissive, index);
    material.normal_texture.uv_set = uv_slot(uses.normal, index);
    material.metallic_roughness_texture.uv_set = uv_slot(uses.metallic_roughness, index);
}

/* TEXCOORD_0 and _1 always. */
int materials::uv_set(uint32_t index, int32_t slot) const
{
    const lmb_material &material = scene_.materials[index];
    const bool needed = slot < 2 || material.base_color_texture.uv_set == slot ||
                        material.emissive_texture.uv_set == slot || material.normal_texture.uv_set == slot ||
                        material.metallic_roughness_texture.uv_set == slot;
    return needed ? uv_sets_[size_t(slot)] : -1;
}

/* The bake does not need it, so what is wrong with it stops nothing. Of one image it is said once. */
void materials::read_unneeded(uint32_t material, texture_reader &reader, const texture_use &use, lmb_texture &texture,
                              const char *what)
{
    const int image = reader.image_of(use.index);
    if (unreadable_.count(image) > 0) {
        return;
    }
    lmb_error reason;
    const lmb_result result = reader.read(use.index, texture, reason);
    if (result == LMB_ERROR_MEMORY) {
        throw std::bad_alloc();
    }
    if (result != LMB_OK) {
        lmb_warn(&document_.options.warnings, "%s; %s goes without its %s", reason.message, name_of(material).c_str(),
                 what);
        if (image >= 0) {
            unreadable_.insert(image);
        }
    }
}

void materials::read_images()
{
    texture_reader reader(document_, scene_);
    for (uint32_t i = 0; i < textures_.size(); ++i) {
        const textures &uses = textures_[i];
        lmb_material &material = scene_.materials[i];
        if (uses.used) {
            lmb_error error;
            check(reader.read(uses.base_color.index, material.base_color_texture, error), error);
            check(reader.read(uses.emissive.index, material.emissive_texture, error), error);
            read_unneeded(i, reader, uses.normal, material.normal_texture, "normal map");
        }
    }
    const uint64_t hash = document_.file->hash; /* of what a bake is made of, whoever looks at it */
    for (uint32_t i = 0; i < textures_.size(); ++i) {
        if (textures_[i].used) {
            read_unneeded(i, reader, textures_[i].metallic_roughness, scene_.materials[i].metallic_roughness_texture,
                          "map of metalness and roughness");
        }
    }
    document_.file->hash = hash;
}

} // namespace lmb_gltf
