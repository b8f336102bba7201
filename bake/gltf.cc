#include <lambent/gltf.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <stb_image.h>
#include <tiny_gltf.h>

extern "C" {
#include "bake_internal.h"
}
#include "gltf_internal.h"

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

/* Pixels of one image; enough for 16 k x 16 k. */
constexpr int64_t MAX_PIXELS = int64_t(1) << 28;
constexpr uint32_t MAX_INSTANCES = uint32_t(1) << 27;

struct world_node {
    lmb_affine to_world;
    uint32_t parent;
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
    void read_material(const tinygltf::Material &source, lmb_material *material);
    lmb_texture read_texture(int index, int uv_set, const tinygltf::ExtensionMap &extensions);
    lmb_texture read_texture(const Value &info);
    void place_nodes();
    void visit_scene();
    void visit_node(uint32_t index, bool dynamic);
    bool is_excluded(const std::string &name) const;
    void read_marks(const Value &marks, const lmb_affine &to_world);
    float light_extent(uint32_t node, const char *key, double most) const;
    void add_light(uint32_t light, const lmb_affine &to_world, uint32_t node, bool indirect_only);
    void add_mesh_node(uint32_t index, bool dynamic);
    uint32_t mesh_for(uint32_t node);
    uint32_t build_mesh(uint32_t number, int32_t node, const lmb_gltf_pose &pose);
    void add_instance(uint32_t node, uint32_t place, uint32_t mesh, const lmb_affine &to_world, bool dynamic);
    std::vector<float> decode(uint32_t accessor) const;
    std::string node_name(uint32_t index) const;
    void find_bounds();
    void finish();

    lmb_gltf_file *file_;
    const lmb_gltf_options *options_;
    lmb_scene *scene_;
    lmb_error *error_;
    Model model_;
    std::vector<const cJSON *> image_items_, mesh_items_;
    std::vector<int32_t> images_; /* scene image of each glTF image that was needed, or -1 */
    std::vector<world_node> nodes_;
    std::vector<uint32_t> shared_meshes_; /* scene mesh of each glTF mesh at rest, or NONE */
    std::vector<std::pair<double, lmb_vec3>> path_;
};

const lmb_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

lmb_affine product(const lmb_affine &a, const lmb_affine &b)
{
    lmb_affine c;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j) {
            c.m[i][j] =
                a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0.0);
        }
    }
    return c;
}

/* Rotation of a quaternion x, y, z, w that need not be unit; none when it is zero. */
lmb_affine compose(const double t[3], const double q[4], const double s[3])
{
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double k = norm > 0.0 ? 2.0 / norm : 0.0;
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[3][3] = {{1 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w)},
                            {k * (x * y + z * w), 1 - k * (x * x + z * z), k * (y * z - x * w)},
                            {k * (x * z - y * w), k * (y * z + x * w), 1 - k * (x * x + y * y)}};
    lmb_affine m;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m.m[i][j] = r[i][j] * s[j];
        }
        m.m[i][3] = t[i];
    }
    return m;
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
    return compose(t, q, s);
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

/* `*` matches any run, `?` any one byte. */
bool glob_matches(const char *pattern, const char *text)
{
    const char *star = nullptr, *resume = nullptr;
    while (*text) {
        if (*pattern == '*') {
            star = pattern++;
            resume = text;
        } else if (*pattern == '?' || *pattern == *text) {
            ++pattern;
            ++text;
        } else if (star) {
            pattern = star + 1;
            text = ++resume;
        } else {
            return false;
        }
    }
    while (*pattern == '*') {
        ++pattern;
    }
    return *pattern == '\0';
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

using json_text = std::unique_ptr<char, void (*)(void *)>;

bool is_read_by_tinygltf(const char *name)
{
    for (const char *own : {"accessors", "animations", "buffers", "bufferViews", "cameras", "images"}) {
        if (strcmp(name, own) == 0) {
            return false;
        }
    }
    return true;
}

/* The meshes without what tinygltf must not see: it refuses indices that are accessors without a buffer view. */
cJSON *meshes_without_indices(const cJSON *meshes)
{
    cJSON *const copy = cJSON_Duplicate(meshes, true);
    cJSON *mesh, *primitive;
    cJSON_ArrayForEach(mesh, copy)
    {
        cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives"))
        {
            cJSON_DeleteItemFromObjectCaseSensitive(primitive, "indices");
        }
    }
    return copy;
}

/* The file's JSON as text for tinygltf. It gets the structure only: bytes and pictures are read by lmb_gltf_file, and
 * nobody needs the rest. Written anew, so that it reads exactly what was checked. */
json_text text_for_tinygltf(const lmb_gltf_file *file)
{
    const std::unique_ptr<cJSON, void (*)(cJSON *)> shown(cJSON_CreateObject(), cJSON_Delete);
    bool good = shown != nullptr;
    cJSON *item;
    cJSON_ArrayForEach(item, file->root)
    {
        if (good && strcmp(item->string, "meshes") == 0) {
            cJSON *const meshes = meshes_without_indices(item);
            good = meshes && cJSON_AddItemToObject(shown.get(), item->string, meshes);
        } else if (good && is_read_by_tinygltf(item->string)) {
            good = cJSON_AddItemReferenceToObject(shown.get(), item->string, item);
        }
    }
    json_text text(good ? cJSON_PrintUnformatted(shown.get()) : nullptr, cJSON_free);
    if (!text) {
        throw std::bad_alloc();
    }
    return text;
}

void loader::parse()
{
    const auto count = [&](const char *name) {
        return size_t(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(file_->root, name)));
    };
    const size_t node_count = count("nodes");
    const json_text text = text_for_tinygltf(file_);
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
    images_.assign(image_items_.size(), -1);
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

lmb_texture loader::read_texture(int index, int uv_set, const tinygltf::ExtensionMap &extensions)
{
    lmb_texture texture = no_texture;
    if (index < 0) {
        return texture;
    }
    const Value &transform = find_extension(extensions, "KHR_texture_transform");
    if (member(transform, "texCoord").IsNumber()) {
        uv_set = index_of(member(transform, "texCoord"));
    }
    if (uv_set < 0 || uv_set > 1) {
        fail(LMB_ERROR_UNSUPPORTED, "textures[%d]: used with TEXCOORD_%d", index, uv_set);
    }
    texture.uv_set = uv_set;
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
        texture.transform[i / 3][i % 3] = float(map[i / 3][i % 3]);
    }
    const tinygltf::Texture &source = model_.textures[size_t(index)];
    if (source.sampler >= 0) {
        const tinygltf::Sampler &sampler = model_.samplers[size_t(source.sampler)];
        texture.wrap_u = wrap_of(sampler.wrapS);
        texture.wrap_v = wrap_of(sampler.wrapT);
        texture.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    }
    if (source.source >= 0) {
        texture.image = read_image(uint32_t(source.source));
    } else if (!source.extensions.empty()) {
        fail(LMB_ERROR_UNSUPPORTED, "textures[%d]: %s is not supported, and there is no other source", index,
             source.extensions.begin()->first.c_str());
    }
    return texture;
}

/* A texture info inside an extension, which tinygltf leaves as JSON. */
lmb_texture loader::read_texture(const Value &info)
{
    tinygltf::ExtensionMap extensions;
    const Value &all = member(info, "extensions");
    if (all.IsObject()) {
        extensions = all.Get<Value::Object>();
    }
    return read_texture(index_of(member(info, "index")), std::max(index_of(member(info, "texCoord")), 0), extensions);
}

void loader::read_material(const tinygltf::Material &source, lmb_material *material)
{
    const tinygltf::PbrMetallicRoughness &pbr = source.pbrMetallicRoughness;
    const Value &glossiness = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness");
    if (glossiness.IsObject()) {
        const Value &factor = member(glossiness, "diffuseFactor");
        for (int c = 0; c < 4; ++c) {
            material->base_color[c] = factor.IsArray() ? clamp01(number(factor.Get(c), 1.0)) : 1.0f;
        }
        material->base_color_texture = read_texture(member(glossiness, "diffuseTexture"));
    } else {
        for (size_t c = 0; c < 4; ++c) {
            material->base_color[c] = clamp01(pbr.baseColorFactor[c]);
        }
        material->base_color_texture =
            read_texture(pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord, pbr.baseColorTexture.extensions);
    }
    const double strength =
        number(member(find_extension(source.extensions, "KHR_materials_emissive_strength"), "emissiveStrength"), 1.0);
    for (size_t c = 0; c < 3; ++c) {
        const double emissive = std::max(source.emissiveFactor[c], 0.0) * strength;
        material->emissive.c[c] = float(std::min(emissive, 3.4e38));
    }
    material->emissive_texture =
        read_texture(source.emissiveTexture.index, source.emissiveTexture.texCoord, source.emissiveTexture.extensions);
    material->normal_texture =
        read_texture(source.normalTexture.index, source.normalTexture.texCoord, source.normalTexture.extensions);
    material->normal_scale = float(source.normalTexture.scale);
    material->transmission = clamp01(
        number(member(find_extension(source.extensions, "KHR_materials_transmission"), "transmissionFactor"), 0.0));
    material->alpha_mode = source.alphaMode == "MASK"    ? LMB_ALPHA_MASK
                           : source.alphaMode == "BLEND" ? LMB_ALPHA_BLEND
                                                         : LMB_ALPHA_OPAQUE;
    material->alpha_cutoff = float(source.alphaCutoff);
    material->double_sided = source.doubleSided;
    material->unlit = source.extensions.count("KHR_materials_unlit") > 0;
    material->name = copy_string(source.name);
}

/* The glTF's materials in their order, then the default one. */
void loader::read_materials()
{
    for (const tinygltf::Material &material : model_.materials) {
        read_material(material, &append(scene_->materials, scene_->material_count));
    }
    lmb_material &fallback = append(scene_->materials, scene_->material_count);
    std::fill(fallback.base_color, fallback.base_color + 4, 1.0f);
    fallback.base_color_texture = fallback.emissive_texture = fallback.normal_texture = no_texture;
    fallback.normal_scale = 1.0f;
    fallback.alpha_cutoff = 0.5f;
    fallback.name = copy_string("default");
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
        if (glob_matches(options_->exclude[i], name.c_str())) {
            return true;
        }
    }
    return false;
}

lmb_vec3 origin_of(const lmb_affine &t)
{
    return {float(t.m[0][3]), float(t.m[1][3]), float(t.m[2][3])};
}

void loader::read_marks(const Value &marks, const lmb_affine &to_world)
{
    const Value &seed = member(marks, "seed"), &path = member(marks, "path");
    if (seed.IsBool() && seed.Get<bool>()) {
        append(scene_->seed_points, scene_->seed_point_count) = origin_of(to_world);
    }
    if (path.IsNumber()) {
        path_.emplace_back(path.GetNumberAsDouble(), origin_of(to_world));
    }
}

/* How large a node's marks say that its light is; 0 where they do not. */
float loader::light_extent(uint32_t node, const char *key, double most) const
{
    const Value &value = member(member(model_.nodes[node].extras, "lambent"), key);
    const double extent = value.IsNumber()                      ? value.GetNumberAsDouble()
                          : value.Type() == tinygltf::NULL_TYPE ? 0.0
                                                                : -1.0;
    if (!(extent >= 0.0 && extent <= most)) {
        if (options_) {
            lmb_warn(&options_->warnings, "%s: nodes[%u].extras.lambent.%s is not a number from 0 to %g: ignored",
                     file_->path, node, key, most);
        }
        return 0.0f;
    }
    return float(extent);
}

void loader::add_light(uint32_t index, const lmb_affine &to_world, uint32_t node, bool indirect_only)
{
    const tinygltf::Light &source = model_.lights[index];
    lmb_light light{};
    light.type = source.type == "spot"          ? LMB_LIGHT_SPOT
                 : source.type == "directional" ? LMB_LIGHT_DIRECTIONAL
                                                : LMB_LIGHT_POINT;
    light.indirect_only = indirect_only;
    if (light.type == LMB_LIGHT_DIRECTIONAL) {
        light.angle_rad = std::min(light_extent(node, "angle_deg", 180.0) * (LMB_PI_F / 180.0f), LMB_PI_F);
    } else {
        light.radius = light_extent(node, "radius_m", 1e18);
    }
    light.position = origin_of(to_world);
    double away[3], length = 0.0;
    for (int i = 0; i < 3; ++i) {
        away[i] = -to_world.m[i][2];
        length += away[i] * away[i];
    }
    length = std::sqrt(length);
    if (light.type != LMB_LIGHT_POINT && !(length > 0.0)) {
        fail(LMB_ERROR_FORMAT, "nodes[%u]: its light has no direction", node);
    }
    light.direction = length > 0.0 ? lmb_vec3{float(away[0] / length), float(away[1] / length), float(away[2] / length)}
                                   : lmb_vec3{0.0f, 0.0f, -1.0f};
    for (size_t c = 0; c < 3; ++c) {
        const double colour = source.color.size() == 3 ? std::max(source.color[c], 0.0) : 1.0;
        light.intensity.c[c] = float(std::min(colour * source.intensity, 3.4e38));
    }
    light.range = float(source.range);
    double sine, inner, outer;
    lmb_sincos(source.spot.innerConeAngle, &sine, &inner);
    lmb_sincos(source.spot.outerConeAngle, &sine, &outer);
    light.cos_outer = float(std::min(outer, 1.0));
    light.cos_inner = std::max(float(std::min(inner, 1.0)), light.cos_outer);
    lmb_light &added = append(scene_->lights, scene_->light_count);
    added = light;
    added.name = copy_string(source.name.empty() ? node_name(node) : source.name);
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
        primitive.uv[0] = attribute(p.attributes, "TEXCOORD_0");
        primitive.uv[1] = attribute(p.attributes, "TEXCOORD_1");
        primitive.joints[0] = attribute(p.attributes, "JOINTS_0");
        primitive.joints[1] = attribute(p.attributes, "JOINTS_1");
        primitive.weights[0] = attribute(p.attributes, "WEIGHTS_0");
        primitive.weights[1] = attribute(p.attributes, "WEIGHTS_1");
        primitive.material = p.material >= 0 ? uint32_t(p.material) : uint32_t(model_.materials.size());
        primitive.number = uint32_t(i);
        primitive.targets = targets[i].data();
        primitive.target_count = targets[i].size();
        primitives.push_back(primitive);
    }
    lmb_mesh &mesh = append(scene_->meshes, scene_->mesh_count);
    mesh.source_node = node;
    mesh.name = copy_string(source.name.empty() ? "mesh " + std::to_string(number) : source.name);
    check(lmb_gltf_mesh_build(file_, number, primitives.data(), primitives.size(), &pose, &mesh,
                              &scene_->dropped_triangle_count, error_));
    return scene_->mesh_count - 1;
}

/* The scene's mesh of a node: shared, unless the node itself poses it. */
uint32_t loader::mesh_for(uint32_t index)
{
    const tinygltf::Node &node = model_.nodes[index];
    const uint32_t number = uint32_t(node.mesh);
    const std::vector<double> &weights = node.weights.empty() ? model_.meshes[number].weights : node.weights;
    lmb_gltf_pose pose{weights.data(), weights.size(), nullptr, 0};
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
        joints.push_back(identity); /* so that data() is never null */
        pose.joints = joints.data();
        pose.joint_count = joints.size() - 1;
    }
    return build_mesh(number, int32_t(index), pose);
}

/* The inverse transpose; false when the transform flattens everything. */
bool invert_transpose(const lmb_affine &t, lmb_affine *result, double *determinant)
{
    double size = 0.0;
    *result = lmb_affine{};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            result->m[i][j] = t.m[i1][j1] * t.m[i2][j2] - t.m[i1][j2] * t.m[i2][j1];
            size = std::max(size, std::fabs(t.m[i][j]));
        }
    }
    *determinant = t.m[0][0] * result->m[0][0] + t.m[0][1] * result->m[0][1] + t.m[0][2] * result->m[0][2];
    if (!(std::fabs(*determinant) > 1e-15 * size * size * size) || !(size > 1e-18)) {
        return false;
    }
    for (int k = 0; k < 9; ++k) {
        result->m[k / 3][k % 3] /= *determinant;
    }
    return true;
}

void loader::add_instance(uint32_t node, uint32_t place, uint32_t mesh, const lmb_affine &to_world, bool dynamic)
{
    lmb_instance instance{};
    double determinant;
    if (!invert_transpose(to_world, &instance.normal_to_world, &determinant)) {
        /* Scaled to nothing, as exporters hide objects. */
        scene_->dropped_triangle_count += scene_->meshes[mesh].triangle_count;
        return;
    }
    instance.node = int32_t(node);
    instance.place = int32_t(place);
    instance.mesh = mesh;
    instance.to_world = to_world;
    instance.mirrored = determinant < 0.0;
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
        double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
        double *const parts[3] = {t, q, s};
        for (size_t i = 0; i < 3; ++i) {
            const size_t width = i == 1 ? 4 : 3;
            for (size_t k = 0; !values[i].empty() && k < width; ++k) {
                parts[i][k] = double(values[i][place * width + k]);
                if (!(std::fabs(parts[i][k]) < 1e18)) {
                    fail(LMB_ERROR_FORMAT, "nodes[%u]: instance %u is not finite", index, place);
                }
            }
        }
        add_instance(index, place, mesh, product(nodes_[index].to_world, compose(t, q, s)), dynamic);
    }
}

void loader::visit_node(uint32_t index, bool dynamic)
{
    const tinygltf::Node &node = model_.nodes[index];
    read_marks(member(node.extras, "lambent"), nodes_[index].to_world);
    const int light = index_of(member(find_extension(node.extensions, "KHR_lights_punctual"), "light"));
    const Value &part = member(member(node.extras, "lambent"), "light");
    const std::string baked = part.IsString() ? part.Get<std::string>() : "baked";
    if (baked != "baked" && baked != "indirect" && baked != "off") {
        fail(LMB_ERROR_FORMAT, "nodes[%u].extras.lambent.light: neither baked, indirect nor off", index);
    }
    if (light >= 0 && baked != "off") {
        add_light(uint32_t(light), nodes_[index].to_world, index, baked == "indirect");
    }
    if (node.mesh >= 0) {
        add_mesh_node(index, dynamic);
    }
}

/* The default scene in the order of the file; all roots when there is no scene. */
void loader::visit_scene()
{
    struct visit {
        uint32_t node;
        bool dynamic;
    };
    std::vector<visit> pending;
    if (!model_.scenes.empty()) {
        for (const int node : model_.scenes[size_t(std::max(model_.defaultScene, 0))].nodes) {
            pending.push_back({uint32_t(node), false});
        }
    } else {
        for (size_t i = 0; i < nodes_.size(); ++i) {
            if (nodes_[i].parent == NONE) {
                pending.push_back({uint32_t(i), false});
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
        const Value &is_static = member(member(node.extras, "lambent"), "static");
        if (is_static.IsBool()) {
            v.dynamic = !is_static.Get<bool>();
        }
        visit_node(v.node, v.dynamic);
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
            pending.push_back({uint32_t(*child), v.dynamic});
        }
    }
}

void loader::find_bounds()
{
    const float huge = 3.402823466e38f;
    lmb_vec3 low = {huge, huge, huge}, high = {-huge, -huge, -huge};
    for (uint32_t i = 0; i < scene_->instance_count; ++i) {
        const lmb_instance &instance = scene_->instances[i];
        const lmb_mesh &mesh = scene_->meshes[instance.mesh];
        for (uint32_t c = 0; !instance.dynamic && c < 3 * mesh.triangle_count; ++c) {
            const lmb_vec3 p = affine_point(&instance.to_world, mesh.position[mesh.triangle[c / 3][c % 3]]);
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
            if (!(std::fabs(p.x) < 1e18f && std::fabs(p.y) < 1e18f && std::fabs(p.z) < 1e18f)) {
                fail(LMB_ERROR_FORMAT, "nodes[%d]: a vertex is too far away", instance.node);
            }
        }
    }
    scene_->bounds_min = low;
    scene_->bounds_max = high;
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
    scene_->content_hash = hash;
}

void loader::load()
{
    scene_->path = copy_string(file_->path);
    parse();
    list_items();
    read_materials();
    place_nodes();
    shared_meshes_.assign(model_.meshes.size(), NONE);
    visit_scene();
    find_bounds();
    finish();
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
