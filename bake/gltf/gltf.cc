#include <lambent/gltf.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <stb_image.h>
#include <tiny_gltf.h>

extern "C" {
#include "base/rgb.h"
#include "base/scalar.h"
#include "base/trig.h"
}
#include "gltf/gltf_internal.h"

#include <lambent/file.h>

namespace {

using tinygltf::Model;
using tinygltf::Value;

struct file_close {
    void operator()(lmb_gltf_file *file) const
    {
        lmb_gltf_file_close(file);
    }
};
struct scene_destroy {
    void operator()(lmb_scene *scene) const
    {
        lmb_scene_destroy(scene);
    }
};

/* Thrown inside this file only; lmb_gltf_load catches everything. */
struct failure {
    lmb_result result;
};

enum : uint32_t { NONE = UINT32_MAX };

/* What images_ says of a glTF image. */
enum : int32_t { NOT_READ = -1, NOT_READABLE = -2 };

/* Pixels of one image; enough for 16 k x 16 k. */
constexpr int64_t MAX_PIXELS = int64_t(1) << 28;
constexpr uint32_t MAX_INSTANCES = uint32_t(1) << 27;
/* Metres: nothing is as far as this, which exporters write for lamps that reach everywhere. */
constexpr double UNLIMITED_RANGE = 1e18;

struct world_node {
    lmb_affine to_world;
    uint32_t parent;
};

/* The textures of a material that are read, as the file numbers them. */
struct material_textures {
    struct {
        int index; /* -1: none */
        int uv_set;
    } base_color, emissive, normal;
    bool used; /* by a primitive of a mesh that is placed */
};

class loader {
  public:
    loader(lmb_gltf_file *file, const lmb_gltf_options *options, lmb_scene *scene, lmb_error *error)
        : file_(file), options_(options), scene_(scene), error_(error)
    {
    }

    void load();

  private:
    template <class... Args> [[noreturn]] void fail(lmb_result result, const char *format, Args... args) const
    {
        char what[LMB_ERROR_MESSAGE_SIZE];
        snprintf(what, sizeof what, format, args...);
        throw failure{lmb_error_set(error_, result, "%s: %s", file_->path, what)};
    }
    void check(lmb_result result) const
    {
        if (result != LMB_OK) {
            throw failure{result};
        }
    }
    char *copy_string(const std::string &text) const
    {
        char *const copy = static_cast<char *>(malloc(text.size() + 1));
        if (!copy) {
            throw std::bad_alloc();
        }
        memcpy(copy, text.c_str(), text.size() + 1);
        return copy;
    }
    /* A new zero element at the end of an array of the scene, which owns it from here on. Room doubles whenever the
     * count is a power of two. */
    template <class T> T &append(T *&array, uint32_t &count) const
    {
        if ((count & (count - 1)) == 0) {
            void *const larger = realloc(array, std::max<size_t>(size_t(count) * 2, 1) * sizeof(T));
            if (!larger) {
                throw std::bad_alloc();
            }
            array = static_cast<T *>(larger);
        }
        memset(&array[count], 0, sizeof(T));
        return array[count++];
    }

    void parse();
    void list_items();
    int32_t read_image(uint32_t number);
    void read_materials();
    void read_material(const tinygltf::Material &source, lmb_material *material, material_textures *textures);
    void use_material(uint32_t number);
    int32_t uv_slot(int uv_set, int texture, uint32_t material);
    void read_images();
    void read_image_of(lmb_texture *texture, int index);
    void read_normal_map(uint32_t number, int index);
    std::string material_name(uint32_t number) const;
    void place_nodes();
    void visit_scene();
    void visit_node(uint32_t index, bool dynamic, bool hidden);
    bool is_excluded(const std::string &name) const;
    const char *light_fault(const tinygltf::Light &source, const lmb_affine &to_world) const;
    void add_camera(uint32_t node);
    void add_light(uint32_t light, const lmb_affine &to_world, uint32_t node, bool indirect_only);
    void add_mesh_node(uint32_t index, bool dynamic);
    uint32_t mesh_for(uint32_t node);
    void find_uvs(const tinygltf::Primitive &source, lmb_gltf_primitive *primitive, uint32_t mesh);
    uint32_t build_mesh(uint32_t number, int32_t node, const lmb_gltf_pose &pose);
    void add_instance(uint32_t node, uint32_t place, uint32_t mesh, const lmb_affine &to_world, bool dynamic,
                      float place_step = 0.0f);
    std::vector<float> decode(uint32_t accessor) const;
    std::string node_name(uint32_t index) const;
    void move_to_origin();
    bool is_moved() const
    {
        return scene_->origin.x != 0.0 || scene_->origin.y != 0.0 || scene_->origin.z != 0.0;
    }
    void find_bounds();
    void finish();

    lmb_gltf_file *file_;
    const lmb_gltf_options *options_;
    lmb_scene *scene_;
    lmb_error *error_;
    const lmb_warnings *warnings_ = options_ ? &options_->warnings : nullptr;
    std::unique_ptr<lmb_gltf_marks, void (*)(void *)> marks_{nullptr, free}; /* [node] */
    Model model_;
    std::vector<const cJSON *> image_items_, mesh_items_;
    std::vector<int32_t> images_;             /* scene image of each glTF image that was needed, or as said above */
    std::vector<material_textures> textures_; /* [material], without the default one */
    std::vector<int> uv_sets_{0, 1};          /* the TEXCOORD that each of lmb_mesh.uv is */
    std::vector<world_node> nodes_;
    std::vector<uint32_t> shared_meshes_; /* scene mesh of each glTF mesh at rest, or NONE */
    std::vector<std::pair<double, lmb_vec3>> path_;
    const double light_scale_ = options_ && options_->light_scale > 0.0 ? options_->light_scale : 1.0;
    const double emission_scale_ = options_ && options_->emission_scale > 0.0 ? options_->emission_scale : 1.0;
    lmb_gltf_options quiet_options_{};
};

const lmb_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

lmb_affine product(const lmb_affine &a, const lmb_affine &b)
{
    return lmb_gltf_product(&a, &b);
}

/* Adds `sign` times a place to the translation. */
void move(lmb_affine &t, const lmb_vec3d &place, double sign)
{
    t.m[0][3] += sign * place.x;
    t.m[1][3] += sign * place.y;
    t.m[2][3] += sign * place.z;
}

template <class T> lmb_affine from_columns(const T *m)
{
    lmb_affine a;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j) {
            a.m[i][j] = m[4 * j + i];
        }
    }
    return a;
}

lmb_affine local_transform(const tinygltf::Node &node)
{
    if (node.matrix.size() == 16) {
        return from_columns(node.matrix.data());
    }
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    std::copy(node.translation.begin(), node.translation.end(), t);
    std::copy(node.rotation.begin(), node.rotation.end(), q);
    std::copy(node.scale.begin(), node.scale.end(), s);
    return lmb_gltf_compose(t, q, s);
}

const Value &find_extension(const tinygltf::ExtensionMap &extensions, const char *name)
{
    static const Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

const Value &member(const Value &object, const char *name)
{
    static const Value none;
    return object.IsObject() ? object.Get(name) : none;
}

double number(const Value &value, double missing)
{
    return value.IsNumber() ? value.GetNumberAsDouble() : missing;
}

int index_of(const Value &value)
{
    return value.IsNumber() ? value.GetNumberAsInt() : -1;
}

int32_t attribute(const std::map<std::string, int> &attributes, const char *name)
{
    const auto found = attributes.find(name);
    return found == attributes.end() ? -1 : found->second;
}

float clamp01(double value)
{
    return value > 0.0 ? float(std::min(value, 1.0)) : 0.0f;
}

/* Texts of FLT_MAX are rounded up. */
float to_float(double value)
{
    const double largest = double(std::numeric_limits<float>::max());
    return float(std::max(-largest, std::min(value, largest)));
}

bool keep_no_image(tinygltf::Image *, int, std::string *, std::string *, int, int, const unsigned char *, int, void *)
{
    return true;
}

bool no_file_exists(const std::string &, void *)
{
    return false;
}

std::string same_path(const std::string &path, void *)
{
    return path;
}

bool read_no_file(std::vector<unsigned char> *, std::string *, const std::string &, void *)
{
    return false;
}

bool write_no_file(std::string *, const std::string &, const std::vector<unsigned char> &, void *)
{
    return false;
}

void loader::parse()
{
    const auto count = [&](const char *name) {
        return size_t(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(file_->root, name)));
    };
    const size_t node_count = count("nodes");
    const std::unique_ptr<char, void (*)(void *)> text(lmb_gltf_text_for_tinygltf(file_), cJSON_free);
    if (!text) {
        throw std::bad_alloc();
    }
    /* Nobody reads these again, and a million of them take a gigabyte. */
    cJSON_DeleteItemFromObjectCaseSensitive(file_->root, "nodes");
    tinygltf::TinyGLTF reader;
    reader.SetFsCallbacks({no_file_exists, same_path, read_no_file, write_no_file, nullptr});
    reader.SetImageLoader(keep_no_image, nullptr);
    std::string reason, warning;
    if (!reader.LoadASCIIFromString(&model_, &reason, &warning, text.get(), unsigned(strlen(text.get())), "")) {
        fail(LMB_ERROR_FORMAT, "%s", reason.substr(0, reason.find('\n')).c_str());
    }
    const auto same = [&](const char *name, size_t expected, size_t read) {
        if (read != expected) {
            fail(LMB_ERROR_FORMAT, "%s: tinygltf read %zu of them", name, read);
        }
    };
    same("nodes", node_count, model_.nodes.size());
    same("meshes", count("meshes"), model_.meshes.size());
    same("materials", count("materials"), model_.materials.size());
    same("textures", count("textures"), model_.textures.size());
    same("samplers", count("samplers"), model_.samplers.size());
    same("skins", count("skins"), model_.skins.size());
    same("scenes", count("scenes"), model_.scenes.size());
}

std::vector<float> loader::decode(uint32_t accessor) const
{
    const lmb_gltf_accessor &a = file_->accessors[accessor];
    std::vector<float> values(size_t(a.count) * a.components);
    lmb_gltf_decode_all(&a, values.data());
    return values;
}

std::string loader::node_name(uint32_t index) const
{
    const std::string &name = model_.nodes[index].name;
    return name.empty() ? "node " + std::to_string(index) : name;
}

/* cJSON's lists have no random access. */
void loader::list_items()
{
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(file_->root, "images"))
    {
        image_items_.push_back(item);
    }
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(file_->root, "meshes"))
    {
        mesh_items_.push_back(item);
    }
    images_.assign(image_items_.size(), NOT_READ);
}

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

/* World transforms of all nodes, parents before children; joints may lie outside the scene. */
void loader::place_nodes()
{
    nodes_.assign(model_.nodes.size(), {identity, NONE});
    for (size_t i = 0; i < nodes_.size(); ++i) {
        for (const int child : model_.nodes[i].children) {
            nodes_[size_t(child)].parent = uint32_t(i);
        }
    }
    std::vector<uint32_t> pending;
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].parent == NONE) {
            pending.push_back(uint32_t(i));
        }
    }
    while (!pending.empty()) {
        const uint32_t i = pending.back();
        pending.pop_back();
        const lmb_affine &above = nodes_[i].parent == NONE ? identity : nodes_[nodes_[i].parent].to_world;
        nodes_[i].to_world = product(above, local_transform(model_.nodes[i]));
        for (int k = 0; k < 12; ++k) {
            /* Squares of what is placed here must stay floats. */
            if (!(std::fabs(nodes_[i].to_world.m[k / 4][k % 4]) < 1e18)) {
                fail(LMB_ERROR_FORMAT, "nodes[%u]: its transform in the world is not finite", i);
            }
        }
        for (const int child : model_.nodes[i].children) {
            pending.push_back(uint32_t(child));
        }
    }
}

bool loader::is_excluded(const std::string &name) const
{
    for (size_t i = 0; options_ && i < options_->exclude_count; ++i) {
        if (lmb_gltf_name_matches(options_->exclude[i], name.c_str())) {
            return true;
        }
    }
    return false;
}

lmb_vec3 origin_of(const lmb_affine &t)
{
    return {float(t.m[0][3]), float(t.m[1][3]), float(t.m[2][3])};
}

/* Why a lamp cannot give light where it is, or NULL. */
const char *loader::light_fault(const tinygltf::Light &source, const lmb_affine &to_world) const
{
    const lmb_gltf_rank rank = lmb_gltf_transform_rank(&to_world);
    return source.intensity < 0.0                            ? "its intensity is negative"
           : rank == LMB_GLTF_NOTHING                        ? "its node is scaled to nothing"
           : rank == LMB_GLTF_FLAT && source.type != "point" ? "its node is scaled flat, and gives it no direction"
                                                             : nullptr;
}

void loader::add_camera(uint32_t index)
{
    lmb_scene_camera &added = append(scene_->cameras, scene_->camera_count);
    added.name = copy_string(node_name(index));
    added.to_world = nodes_[index].to_world;
    added.vertical_fov_rad = lmb_gltf_view_angle(file_, model_.nodes[index].camera);
}

void loader::add_light(uint32_t index, const lmb_affine &to_world, uint32_t node, bool indirect_only)
{
    const tinygltf::Light &source = model_.lights[index];
    const std::string name = source.name.empty() ? node_name(node) : source.name;
    const char *const fault = light_fault(source, to_world);
    if (fault) {
        lmb_warn(warnings_, "%s: node '%s': lamp '%s' is left out: %s", file_->path, node_name(node).c_str(),
                 name.c_str(), fault);
        return;
    }
    lmb_light light{};
    light.type = source.type == "spot"          ? LMB_LIGHT_SPOT
                 : source.type == "directional" ? LMB_LIGHT_DIRECTIONAL
                                                : LMB_LIGHT_POINT;
    light.indirect_only = indirect_only;
    if (light.type == LMB_LIGHT_DIRECTIONAL) {
        light.angle_rad = std::min(float(marks_.get()[node].angle_deg) * (LMB_PI_F / 180.0f), LMB_PI_F);
    } else {
        light.radius = float(marks_.get()[node].radius_m);
    }
    light.position = origin_of(to_world);
    light.direction = lmb_gltf_forward(&to_world);
    for (size_t c = 0; c < 3; ++c) {
        const double colour = source.color.size() == 3 ? std::max(source.color[c], 0.0) : 1.0;
        light.intensity.c[c] = to_float(colour * source.intensity * light_scale_);
    }
    light.range = source.range < UNLIMITED_RANGE ? float(source.range) : 0.0f;
    double sine, inner, outer;
    lmb_sincos(source.spot.innerConeAngle, &sine, &inner);
    lmb_sincos(source.spot.outerConeAngle, &sine, &outer);
    light.cos_outer = float(std::min(outer, 1.0));
    light.cos_inner = std::max(float(std::min(inner, 1.0)), light.cos_outer);
    lmb_light &added = append(scene_->lights, scene_->light_count);
    added = light;
    added.name = copy_string(name);
}

/* TEXCOORD_0 and _1 always, others when the material needs them. */
void loader::find_uvs(const tinygltf::Primitive &source, lmb_gltf_primitive *primitive, uint32_t mesh)
{
    if (primitive->position >= 0 && primitive->mode >= TINYGLTF_MODE_TRIANGLES) {
        use_material(primitive->material);
    }
    const lmb_material &material = scene_->materials[primitive->material];
    for (size_t slot = 0; slot < LMB_UV_SETS; ++slot) {
        const int32_t number = int32_t(slot);
        const bool needed = slot < 2 || material.base_color_texture.uv_set == number ||
                            material.emissive_texture.uv_set == number || material.normal_texture.uv_set == number;
        const std::string name = needed ? "TEXCOORD_" + std::to_string(uv_sets_[slot]) : "";
        primitive->uv[slot] = needed ? attribute(source.attributes, name.c_str()) : -1;
        if (primitive->uv[slot] >= 0 && !lmb_gltf_is_uv(&file_->accessors[primitive->uv[slot]])) {
            fail(LMB_ERROR_FORMAT, "meshes[%u].primitives[%u].attributes.%s: accessors[%d] is of a wrong type", mesh,
                 primitive->number, name.c_str(), primitive->uv[slot]);
        }
    }
}

uint32_t loader::build_mesh(uint32_t number, int32_t node, const lmb_gltf_pose &pose)
{
    const tinygltf::Mesh &source = model_.meshes[number];
    std::vector<lmb_gltf_primitive> primitives;
    std::vector<std::vector<lmb_gltf_target>> targets(source.primitives.size());
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(mesh_items_[number], "primitives");
    if (size_t(cJSON_GetArraySize(list)) != source.primitives.size()) {
        fail(LMB_ERROR_FORMAT, "meshes[%u]: tinygltf read %zu primitives", number, source.primitives.size());
    }
    const cJSON *item = list->child;
    for (const tinygltf::Primitive &p : source.primitives) {
        const size_t i = primitives.size();
        for (const auto &target : p.targets) {
            targets[i].push_back({attribute(target, "POSITION"), attribute(target, "NORMAL")});
        }
        lmb_gltf_primitive primitive{};
        primitive.mode = p.mode;
        primitive.indices = int32_t(lmb_gltf_uint(item, "indices", NONE)); /* NONE becomes -1 */
        item = item->next;
        primitive.position = attribute(p.attributes, "POSITION");
        primitive.normal = attribute(p.attributes, "NORMAL");
        primitive.tangent = attribute(p.attributes, "TANGENT");
        primitive.color = attribute(p.attributes, "COLOR_0");
        primitive.joints[0] = attribute(p.attributes, "JOINTS_0");
        primitive.joints[1] = attribute(p.attributes, "JOINTS_1");
        primitive.weights[0] = attribute(p.attributes, "WEIGHTS_0");
        primitive.weights[1] = attribute(p.attributes, "WEIGHTS_1");
        primitive.material = p.material >= 0 ? uint32_t(p.material) : uint32_t(model_.materials.size());
        primitive.number = uint32_t(i);
        find_uvs(p, &primitive, number);
        primitive.targets = targets[i].data();
        primitive.target_count = targets[i].size();
        primitives.push_back(primitive);
    }
    lmb_mesh &mesh = append(scene_->meshes, scene_->mesh_count);
    mesh.source_node = node;
    mesh.name = copy_string(source.name.empty() ? "mesh " + std::to_string(number) : source.name);
    check(lmb_gltf_mesh_build(file_, number, primitives.data(), primitives.size(), &pose, &mesh,
                              &scene_->dropped_triangle_count, error_));
    lmb_mesh_recentre(&mesh);
    return scene_->mesh_count - 1;
}

/* The scene's mesh of a node: shared, unless the node itself poses it. */
uint32_t loader::mesh_for(uint32_t index)
{
    const tinygltf::Node &node = model_.nodes[index];
    const uint32_t number = uint32_t(node.mesh);
    const std::vector<double> &weights = node.weights.empty() ? model_.meshes[number].weights : node.weights;
    lmb_gltf_pose pose{weights.data(), weights.size(), nullptr, 0, is_moved()};
    if (node.skin < 0 && node.weights.empty()) {
        if (shared_meshes_[number] == NONE) {
            shared_meshes_[number] = build_mesh(number, -1, pose);
        }
        return shared_meshes_[number];
    }
    std::vector<lmb_affine> joints;
    if (node.skin >= 0) {
        const tinygltf::Skin &skin = model_.skins[size_t(node.skin)];
        const std::vector<float> inverse =
            skin.inverseBindMatrices >= 0 ? decode(uint32_t(skin.inverseBindMatrices)) : std::vector<float>();
        for (size_t j = 0; j < skin.joints.size(); ++j) {
            const lmb_affine &joint = nodes_[size_t(skin.joints[j])].to_world;
            joints.push_back(inverse.empty() ? joint : product(joint, from_columns(&inverse[16 * j])));
        }
        lmb_affine rest = identity;
        move(rest, scene_->origin, -1.0);
        joints.push_back(rest);
        pose.joints = joints.data();
        pose.joint_count = joints.size() - 1;
    }
    return build_mesh(number, int32_t(index), pose);
}

void loader::add_instance(uint32_t node, uint32_t place, uint32_t mesh, const lmb_affine &to_world, bool dynamic,
                          float place_step)
{
    lmb_instance instance{};
    const lmb_mesh &placed = scene_->meshes[mesh];
    if (!lmb_gltf_instance_place(&to_world, &placed.shift, &instance)) {
        /* Scaled to nothing, as exporters hide objects. */
        scene_->dropped_triangle_count += placed.triangle_count;
        return;
    }
    instance.node = int32_t(node);
    instance.place = int32_t(place);
    instance.mesh = mesh;
    instance.position_step = std::max(place_step, lmb_position_step(placed.file_reach, &to_world));
    instance.dynamic = dynamic;
    if (scene_->instance_count == MAX_INSTANCES) {
        fail(LMB_ERROR_UNSUPPORTED, "nodes[%u]: too many instances", node);
    }
    lmb_instance &added = append(scene_->instances, scene_->instance_count);
    added = instance;
    added.name = copy_string(node_name(node));
}

void loader::add_mesh_node(uint32_t index, bool dynamic)
{
    const tinygltf::Node &node = model_.nodes[index];
    const uint32_t mesh = mesh_for(index);
    const Value &attributes = member(find_extension(node.extensions, "EXT_mesh_gpu_instancing"), "attributes");
    if (node.skin >= 0) {
        add_instance(index, 0, mesh, identity, dynamic); /* joints alone place a skinned mesh (glTF 2.0, 3.7.3.3) */
        return;
    }
    if (!attributes.IsObject()) {
        add_instance(index, 0, mesh, nodes_[index].to_world, dynamic);
        return;
    }
    std::vector<float> values[3];
    const char *const names[3] = {"TRANSLATION", "ROTATION", "SCALE"};
    uint32_t count = 0;
    for (const std::string &name : attributes.Keys()) {
        count = file_->accessors[index_of(attributes.Get(name))].count;
    }
    for (int i = 0; i < 3; ++i) {
        if (attributes.Has(names[i])) {
            values[i] = decode(uint32_t(index_of(attributes.Get(names[i]))));
        }
    }
    for (uint32_t place = 0; place < count; ++place) {
        lmb_affine local;
        float reach;
        if (!lmb_gltf_instancing_place(values[0].empty() ? nullptr : &values[0][3 * place],
                                       values[1].empty() ? nullptr : &values[1][4 * place],
                                       values[2].empty() ? nullptr : &values[2][3 * place], &local, &reach)) {
            fail(LMB_ERROR_FORMAT, "nodes[%u]: instance %u is not finite", index, place);
        }
        add_instance(index, place, mesh, product(nodes_[index].to_world, local), dynamic,
                     lmb_position_step(reach, &nodes_[index].to_world));
    }
}

void loader::visit_node(uint32_t index, bool dynamic, bool hidden)
{
    const tinygltf::Node &node = model_.nodes[index];
    if (node.camera >= 0 || (options_ && options_->view_node && node_name(index) == options_->view_node)) {
        add_camera(index);
    }
    const lmb_gltf_marks &marks = marks_.get()[index];
    if (marks.seed) {
        uint32_t count = scene_->seed_point_count;
        append(scene_->seed_names, count) = copy_string(node_name(index));
        append(scene_->seed_points, scene_->seed_point_count) = origin_of(nodes_[index].to_world);
    }
    if (marks.has_path) {
        path_.emplace_back(marks.path, origin_of(nodes_[index].to_world));
    }
    const int light = index_of(member(find_extension(node.extensions, "KHR_lights_punctual"), "light"));
    if (light >= 0 && marks.light != LMB_GLTF_OFF && !hidden) {
        add_light(uint32_t(light), nodes_[index].to_world, index, marks.light == LMB_GLTF_INDIRECT);
    }
    if (node.mesh >= 0 && !hidden) {
        add_mesh_node(index, dynamic);
    }
}

/* The default scene in the order of the file; all roots when there is no scene. */
void loader::visit_scene()
{
    struct visit {
        uint32_t node;
        bool dynamic, hidden;
    };
    std::vector<visit> pending;
    if (!model_.scenes.empty()) {
        for (const int node : model_.scenes[size_t(std::max(model_.defaultScene, 0))].nodes) {
            pending.push_back({uint32_t(node), false, false});
        }
    } else {
        for (size_t i = 0; i < nodes_.size(); ++i) {
            if (nodes_[i].parent == NONE) {
                pending.push_back({uint32_t(i), false, false});
            }
        }
    }
    std::reverse(pending.begin(), pending.end());
    while (!pending.empty()) {
        visit v = pending.back();
        pending.pop_back();
        if (is_excluded(node_name(v.node))) {
            continue;
        }
        const tinygltf::Node &node = model_.nodes[v.node];
        const lmb_gltf_marks &marks = marks_.get()[v.node];
        v.dynamic = marks.moves == LMB_GLTF_MOVES || (marks.moves == LMB_GLTF_AS_ABOVE && v.dynamic);
        v.hidden |= marks.hidden;
        visit_node(v.node, v.dynamic, v.hidden);
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
            pending.push_back({uint32_t(*child), v.dynamic, v.hidden});
        }
    }
}

/* A level far from the world's origin is placed once more, from an origin of its own. Node transforms are in double, so
 * nothing is lost but what the file itself has not. */
void loader::move_to_origin()
{
    scene_->origin = lmb_scene_choose_origin(scene_);
    if (!is_moved()) {
        return;
    }
    for (world_node &node : nodes_) {
        move(node.to_world, scene_->origin, -1.0);
    }
    lmb_scene_clear_nodes(scene_);
    shared_meshes_.assign(model_.meshes.size(), NONE);
    path_.clear();
    /* What the nodes have to be warned of was said. */
    if (options_) {
        quiet_options_ = *options_;
        quiet_options_.warnings = {};
        options_ = &quiet_options_;
        warnings_ = &quiet_options_.warnings;
    }
    visit_scene();
}

void loader::find_bounds()
{
    const uint32_t lost = lmb_scene_find_bounds(scene_);
    if (lost != NONE) {
        fail(LMB_ERROR_FORMAT, "nodes[%d]: a vertex is too far away", scene_->instances[lost].node);
    }
}

/* What waits for the end: the order of the path, and the hash of all that was read. */
void loader::finish()
{
    std::stable_sort(path_.begin(), path_.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
    for (const auto &point : path_) {
        append(scene_->path_points, scene_->path_point_count) = point.second;
    }
    uint64_t hash = file_->hash;
    for (size_t i = 0; options_ && i < options_->exclude_count; ++i) {
        hash = lmb_hash(hash, options_->exclude[i], strlen(options_->exclude[i]) + 1);
    }
    const double scales[2] = {light_scale_, emission_scale_};
    if (scales[0] != 1.0 || scales[1] != 1.0) {
        hash = lmb_hash(hash, scales, sizeof scales);
    }
    scene_->content_hash = hash;
}

void loader::load()
{
    scene_->path = copy_string(file_->path);
    lmb_gltf_marks *marks = nullptr;
    check(lmb_gltf_marks_read(file_, warnings_, &marks, error_));
    marks_.reset(marks);
    lmb_gltf_blender_warn_area_lamps(file_, warnings_);
    lmb_gltf_excludes_warn(file_, options_, warnings_);
    parse();
    list_items();
    read_materials();
    place_nodes();
    shared_meshes_.assign(model_.meshes.size(), NONE);
    visit_scene();
    move_to_origin();
    read_images();
    find_bounds();
    finish();
    lmb_gltf_extensions_warn(file_, warnings_);
    lmb_gltf_blender_warn_units(file_, scene_, warnings_);
}

} // namespace

lmb_result lmb_gltf_load(const char *path, const lmb_gltf_options *options, lmb_scene **scene, lmb_error *error)
{
    assert(path && scene);
    lmb_gltf_file *opened = nullptr;
    const lmb_result result = lmb_gltf_file_open(path, options, &opened, error);
    if (result != LMB_OK) {
        return result;
    }
    const std::unique_ptr<lmb_gltf_file, file_close> file(opened);
    std::unique_ptr<lmb_scene, scene_destroy> made(static_cast<lmb_scene *>(calloc(1, sizeof(lmb_scene))));
    try {
        if (!made) {
            throw std::bad_alloc();
        }
        loader(file.get(), options, made.get(), error).load();
    } catch (const failure &f) {
        return f.result;
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    } catch (const std::exception &e) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s", path, e.what());
    }
    *scene = made.release();
    return LMB_OK;
}
