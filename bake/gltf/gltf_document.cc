#include "gltf/gltf_document.hh"

#include <cstring>
#include <new>

#include <lambent/light_sets.h>

#include "gltf/gltf_shown.h"

namespace lmb_gltf {

std::string document::node_name(uint32_t index) const
{
    const std::string &name = model.nodes[index].name;
    return name.empty() ? "node " + std::to_string(index) : name;
}

std::vector<float> document::decode(uint32_t accessor) const
{
    const lmb_gltf_accessor &a = file->accessors[accessor];
    std::vector<float> values(size_t(a.count) * a.components);
    lmb_gltf_decode_all(&a, values.data());
    return values;
}

uint32_t light_set_of(const document &document, lmb_scene &scene, const char *name, const std::string &where,
                      const lmb_warnings &warnings)
{
    uint32_t set = 0;
    const lmb_result result = *name ? lmb_scene_light_set(&scene, name, &set) : LMB_OK;
    if (result == LMB_ERROR_UNSUPPORTED) {
        document.fail(result, "%s: '%s' is one set of lights more than %d", where.c_str(), name,
                      int(LMB_LIGHT_SETS_MOST));
    } else if (result != LMB_OK) {
        lmb_warn(&warnings, "%s: %s: extras.lambent.light_set '%s' is no name of letters, digits, - and _: ignored",
                 document.file->path, where.c_str(), name);
    }
    return set;
}

void read_marks(document &document)
{
    lmb_gltf_marks *marks = nullptr;
    lmb_error error;
    check(lmb_gltf_marks_read(document.file, &document.options.warnings, &marks, &error), error);
    document.marks.reset(marks);
}

namespace {

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

/* cJSON's lists have no random access. */
std::vector<const cJSON *> list_items(const cJSON *root, const char *name)
{
    std::vector<const cJSON *> items;
    const cJSON *item;
    cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, name))
    {
        items.push_back(item);
    }
    return items;
}

} // namespace

void read_model(document &document)
{
    lmb_gltf_file *const file = document.file;
    const auto count = [&](const char *name) {
        return size_t(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(file->root, name)));
    };
    const size_t node_count = count("nodes");
    const std::unique_ptr<char, void (*)(void *)> text(lmb_gltf_text_for_tinygltf(file), cJSON_free);
    if (!text) {
        throw std::bad_alloc();
    }
    /* Nobody reads these again, and a million of them take a gigabyte. */
    cJSON_DeleteItemFromObjectCaseSensitive(file->root, "nodes");
    tinygltf::TinyGLTF reader;
    reader.SetFsCallbacks({no_file_exists, same_path, read_no_file, write_no_file, nullptr});
    reader.SetImageLoader(keep_no_image, nullptr);
    std::string reason, warning;
    tinygltf::Model &model = document.model;
    if (!reader.LoadASCIIFromString(&model, &reason, &warning, text.get(), unsigned(strlen(text.get())), "")) {
        document.fail(LMB_ERROR_FORMAT, "%s", reason.substr(0, reason.find('\n')).c_str());
    }
    const auto same = [&](const char *name, size_t expected, size_t read) {
        if (read != expected) {
            document.fail(LMB_ERROR_FORMAT, "%s: tinygltf read %zu of them", name, read);
        }
    };
    same("nodes", node_count, model.nodes.size());
    same("meshes", count("meshes"), model.meshes.size());
    same("materials", count("materials"), model.materials.size());
    same("textures", count("textures"), model.textures.size());
    same("samplers", count("samplers"), model.samplers.size());
    same("skins", count("skins"), model.skins.size());
    same("scenes", count("scenes"), model.scenes.size());
    document.images = list_items(file->root, "images");
    document.meshes = list_items(file->root, "meshes");
}

} // namespace lmb_gltf
