/* Reading a glTF file into a scene: one object for the time that it takes. Its parts are
 *   gltf.cc           parsing, the order of things, the end
 *   gltf_material.cc  materials, textures and images
 *   gltf_scene.cc     nodes, lights, cameras, meshes and their instances */
#ifndef LMB_GLTF_LOADER_HH
#define LMB_GLTF_LOADER_HH

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <lambent/gltf.h>

#include <tiny_gltf.h>

#include "gltf/gltf_extras.h"
#include "gltf/gltf_file.h"
#include "gltf/gltf_mesh.h"

namespace lmb_gltf {

using tinygltf::Model;
using tinygltf::Value;

/* Thrown by the loader alone; lmb_gltf_load catches everything. */
struct failure {
    lmb_result result;
};

enum : uint32_t { NONE = UINT32_MAX };

/* What images_ says of a glTF image. */
enum : int32_t { NOT_READ = -1, NOT_READABLE = -2 };

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

/* Adds `sign` times a place to the translation. */
inline void move(lmb_affine &t, const lmb_vec3d &place, double sign)
{
    t.m[0][3] += sign * place.x;
    t.m[1][3] += sign * place.y;
    t.m[2][3] += sign * place.z;
}

inline const Value &find_extension(const tinygltf::ExtensionMap &extensions, const char *name)
{
    static const Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

inline const Value &member(const Value &object, const char *name)
{
    static const Value none;
    return object.IsObject() ? object.Get(name) : none;
}

inline double number(const Value &value, double missing)
{
    return value.IsNumber() ? value.GetNumberAsDouble() : missing;
}

inline int index_of(const Value &value)
{
    return value.IsNumber() ? value.GetNumberAsInt() : -1;
}

/* Texts of FLT_MAX are rounded up. */
inline float to_float(double value)
{
    const double largest = double(std::numeric_limits<float>::max());
    return float(std::max(-largest, std::min(value, largest)));
}

} // namespace lmb_gltf

#endif
