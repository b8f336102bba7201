/* Loading a level, step by step:
 *
 *     file -> gltf_open.c (the JSON, buffers and accessors, checked)
 *          -> gltf_document.cc (what nodes want; tinygltf's model of all but bytes and pictures)
 *          -> gltf_materials.cc, gltf_textures.cc
 *          -> gltf_world.cc (where nodes are) -> gltf_scene.cc (what they hold) -> gltf_mesh.c (triangles) -> scene */
#include <lambent/gltf.h>

#include <cassert>
#include <cstring>
#include <exception>
#include <memory>
#include <new>

#include <lambent/file.h>

#include "gltf/gltf_append.hh"
#include "gltf/gltf_blender.h"
#include "gltf/gltf_extensions.h"
#include "gltf/gltf_open.h"
#include "gltf/gltf_scene.hh"
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

/* Adds what the nodes hold. A level far from the world's origin is placed once more, from an origin of its own. Node
 * transforms are in double, so nothing is lost but what the file itself has not. */
void place_level(const document &document, materials &materials, lmb_scene &scene)
{
    std::vector<world_node> nodes = place_nodes(document);
    add_nodes(document, nodes, materials, scene, document.options.warnings);
    scene.origin = lmb_scene_choose_origin(&scene);
    if (scene.origin.x == 0.0 && scene.origin.y == 0.0 && scene.origin.z == 0.0) {
        return;
    }
    for (world_node &node : nodes) {
        count_from(scene.origin, node.to_world);
    }
    lmb_scene_clear_nodes(&scene);
    const lmb_warnings silence{}; /* what the nodes have to be warned of was said */
    add_nodes(document, nodes, materials, scene, silence);
}

/* Of all that was read, and of the options that change what it means. */
uint64_t content_hash(const document &document)
{
    const lmb_gltf_options &options = document.options;
    uint64_t hash = document.file->hash;
    for (size_t i = 0; i < options.exclude_count; ++i) {
        hash = lmb_hash(hash, options.exclude[i], strlen(options.exclude[i]) + 1);
    }
    const double scales[2] = {scale_of(options.light_scale), scale_of(options.emission_scale)};
    return scales[0] != 1.0 || scales[1] != 1.0 ? lmb_hash(hash, scales, sizeof scales) : hash;
}

void load(lmb_gltf_file *file, const lmb_gltf_options &options, lmb_scene &scene)
{
    document document{file, options};
    scene.path = copy_string(file->path);
    read_marks(document);
    lmb_gltf_blender_warn_area_lamps(file, &options.warnings);
    read_model(document);
    warn_excludes(document);
    materials materials(document, scene);
    place_level(document, materials, scene);
    materials.read_images();
    const uint32_t lost = lmb_scene_find_bounds(&scene);
    if (lost != NONE) {
        document.fail(LMB_ERROR_FORMAT, "nodes[%d]: a vertex is too far away", scene.instances[lost].node);
    }
    scene.content_hash = content_hash(document);
    lmb_gltf_extensions_warn(file, &options.warnings);
    lmb_gltf_blender_warn_units(file, &scene, &options.warnings);
}

lmb_result load_source(const lmb_gltf_source &source, const lmb_gltf_options *options, lmb_scene **scene,
                       lmb_error *error)
{
    lmb_gltf_file *opened = nullptr;
    const lmb_result result = lmb_gltf_open(&source, options, &opened, error);
    if (result != LMB_OK) {
        return result;
    }
    const std::unique_ptr<lmb_gltf_file, file_close> file(opened);
    std::unique_ptr<lmb_scene, scene_destroy> made(static_cast<lmb_scene *>(calloc(1, sizeof(lmb_scene))));
    try {
        if (!made) {
            throw std::bad_alloc();
        }
        load(file.get(), options ? *options : lmb_gltf_options{}, *made);
    } catch (const failure &f) {
        return lmb_error_set(error, f.result, "%s", f.error.message);
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: out of memory", source.path);
    } catch (const std::exception &e) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: %s", source.path, e.what());
    }
    *scene = made.release();
    return LMB_OK;
}

} // namespace

} // namespace lmb_gltf

lmb_result lmb_gltf_load(const char *path, const lmb_gltf_options *options, lmb_scene **scene, lmb_error *error)
{
    assert(path && scene);
    return lmb_gltf::load_source({path, nullptr, 0}, options, scene, error);
}

lmb_result lmb_gltf_load_memory(const char *path, const void *data, size_t size, const lmb_gltf_options *options,
                                lmb_scene **scene, lmb_error *error)
{
    assert(path && data && scene);
    return lmb_gltf::load_source({path, data, size}, options, scene, error);
}
