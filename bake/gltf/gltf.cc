#include <lambent/gltf.h>

#include <cassert>

#include <lambent/file.h>

#include "gltf/gltf_accessor.h"
#include "gltf/gltf_blender.h"
#include "gltf/gltf_extensions.h"
#include "gltf/gltf_loader.hh"
#include "gltf/gltf_nodes.h"
#include "gltf/gltf_open.h"
#include "gltf/gltf_shown.h"
#include "scene/scene_internal.h"

namespace lmb_gltf {

namespace {

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

} // namespace

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

} // namespace lmb_gltf

lmb_result lmb_gltf_load(const char *path, const lmb_gltf_options *options, lmb_scene **scene, lmb_error *error)
{
    assert(path && scene);
    lmb_gltf_file *opened = nullptr;
    const lmb_result result = lmb_gltf_file_open(path, options, &opened, error);
    if (result != LMB_OK) {
        return result;
    }
    const std::unique_ptr<lmb_gltf_file, lmb_gltf::file_close> file(opened);
    std::unique_ptr<lmb_scene, lmb_gltf::scene_destroy> made(static_cast<lmb_scene *>(calloc(1, sizeof(lmb_scene))));
    try {
        if (!made) {
            throw std::bad_alloc();
        }
        lmb_gltf::loader(file.get(), options, made.get(), error).load();
    } catch (const lmb_gltf::failure &f) {
        return f.result;
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", path);
    } catch (const std::exception &e) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s", path, e.what());
    }
    *scene = made.release();
    return LMB_OK;
}
