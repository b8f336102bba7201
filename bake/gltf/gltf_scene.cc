#include "gltf/gltf_scene.hh"

#include <algorithm>
#include <cmath>

#include "gltf/gltf_append.hh"
#include "gltf/gltf_extensions.h"
#include "gltf/gltf_lights.hh"
#include "gltf/gltf_mesh_nodes.hh"
#include "gltf/gltf_transform.h"

namespace lmb_gltf {

namespace {

bool matches(const document &document, uint32_t node, const char *pattern)
{
    return lmb_gltf_name_matches(pattern, document.node_name(node).c_str());
}

bool is_excluded(const document &document, uint32_t node)
{
    const char *const *const patterns = document.options.exclude;
    return std::any_of(patterns, patterns + document.options.exclude_count,
                       [&](const char *pattern) { return matches(document, node, pattern); });
}

/* The vertical angle of view of a camera in radians; 0 of an orthographic one, or none (negative). */
float view_angle(const document &document, int32_t camera)
{
    const cJSON *const item =
        cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(document.file->root, "cameras"), camera);
    const cJSON *const angle =
        cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(item, "perspective"), "yfov");
    const bool is_told = cJSON_IsNumber(angle) && angle->valuedouble > 0.0 && angle->valuedouble < 3.14;
    return is_told ? float(angle->valuedouble) : 0.0f;
}

/* Makes the box around a mesh, at rest, of the cube from -1 to 1; without a mesh, or its positions, that cube. */
lmb_affine box_of(const document &document, int mesh)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    if (mesh >= 0) {
        for (const tinygltf::Primitive &primitive : document.model.meshes[size_t(mesh)].primitives) {
            const int position = attribute(primitive.attributes, "POSITION");
            const std::vector<float> at = position >= 0 ? document.decode(uint32_t(position)) : std::vector<float>();
            for (size_t i = 0; i < at.size(); ++i) {
                low[i % 3] = std::fmin(low[i % 3], double(at[i]));
                high[i % 3] = std::fmax(high[i % 3], double(at[i]));
            }
        }
    }
    lmb_affine box = identity;
    for (int axis = 0; axis < 3 && low[0] <= high[0]; ++axis) {
        box.m[axis][axis] = 0.5 * (high[axis] - low[axis]);
        box.m[axis][3] = 0.5 * (high[axis] + low[axis]);
    }
    return box;
}

/* A node to come, with what those above it want. */
struct visit {
    uint32_t node;
    bool hidden;
    node_wishes wishes;
};

/* What a node says goes before what those above it said. */
void wish(const lmb_gltf_marks &marks, node_wishes &wishes)
{
    if (marks.moves != LMB_GLTF_AS_ABOVE) {
        wishes.dynamic = marks.moves == LMB_GLTF_MOVES;
    }
    if (marks.lightmap != LMB_GLTF_MAP_AS_ABOVE) {
        wishes.no_lightmap = marks.lightmap != LMB_GLTF_MAP_ON;
        wishes.lit_locally = marks.lightmap == LMB_GLTF_MAP_LOCAL;
    }
    if (marks.local_set != LMB_GLTF_LOCAL_AS_ABOVE) {
        wishes.has_local_set = marks.local_set == LMB_GLTF_LOCAL_ON;
        std::copy_n(marks.local_size, 3, wishes.local_size);
    }
    if (marks.texels_per_m > 0.0) {
        wishes.texels_per_m = float(marks.texels_per_m);
    }
    if (marks.texel_scale > 0.0) {
        wishes.texel_scale = float(marks.texel_scale);
    }
}

class walk {
  public:
    walk(const document &document, const std::vector<world_node> &nodes, materials &materials, lmb_scene &scene,
         const lmb_warnings &warnings)
        : document_(document), nodes_(nodes), meshes_(document, nodes, materials, scene), scene_(scene),
          warnings_(warnings)
    {
    }

    void run();

  private:
    std::vector<visit> roots() const;
    void add(const visit &visit);
    void add_camera(uint32_t node);
    void add_probe_box(uint32_t node);
    void add_path();

    const document &document_;
    const std::vector<world_node> &nodes_;
    mesh_nodes meshes_;
    lmb_scene &scene_;
    const lmb_warnings &warnings_;
    std::vector<std::pair<double, lmb_vec3>> path_;
};

void walk::add_camera(uint32_t index)
{
    lmb_scene_camera &added = append(scene_.cameras, scene_.camera_count);
    added.name = copy_string(document_.node_name(index));
    added.to_world = nodes_[index].to_world;
    added.vertical_fov_rad = view_angle(document_, document_.model.nodes[index].camera);
}

void walk::add_probe_box(uint32_t index)
{
    const lmb_gltf_volume &told = document_.marks[index].volume;
    lmb_probe_box box{};
    box.to_world = product(nodes_[index].to_world, box_of(document_, document_.model.nodes[index].mesh));
    if (!lmb_gltf_inverse(&box.to_world, &box.from_world)) {
        lmb_warn(&warnings_, "%s: node '%s': extras.lambent.volume is of a flat box: ignored", document_.file->path,
                 document_.node_name(index).c_str());
        return;
    }
    box.spacing = float(told.spacing);
    box.min_spacing = float(told.min_spacing);
    box.tolerance = float(told.tolerance);
    box.exclude = told.exclude;
    box.priority = told.priority;
    lmb_probe_box &added = append(scene_.probe_boxes, scene_.probe_box_count);
    added = box;
    added.name = copy_string(document_.node_name(index));
}

void walk::add(const visit &visit)
{
    const tinygltf::Node &node = document_.model.nodes[visit.node];
    const lmb_gltf_marks &marks = document_.marks[visit.node];
    const lmb_affine &to_world = nodes_[visit.node].to_world;
    const std::string name = document_.node_name(visit.node);
    if (node.camera >= 0 || (document_.options.view_node && name == document_.options.view_node)) {
        add_camera(visit.node);
    }
    if (marks.seed) {
        uint32_t count = scene_.seed_point_count;
        append(scene_.seed_names, count) = copy_string(name);
        append(scene_.seed_points, scene_.seed_point_count) = origin_of(to_world);
    }
    if (marks.cube_map) {
        uint32_t count = scene_.cube_point_count;
        append(scene_.cube_names, count) = copy_string(name);
        append(scene_.cube_points, scene_.cube_point_count) = origin_of(to_world);
    }
    if (marks.has_path) {
        path_.emplace_back(marks.path, origin_of(to_world));
    }
    const int light = index_of(member(find_extension(node.extensions, "KHR_lights_punctual"), "light"));
    if (light >= 0 && marks.light != LMB_GLTF_OFF && !visit.hidden) {
        add_light(document_, uint32_t(light), visit.node, to_world, scene_, warnings_);
    }
    if (marks.volume.is_told) {
        add_probe_box(visit.node);
    } else if (node.mesh >= 0 && !visit.hidden) {
        meshes_.add(visit.node, visit.wishes);
    }
}

std::vector<visit> walk::roots() const
{
    const tinygltf::Model &model = document_.model;
    std::vector<visit> roots;
    if (!model.scenes.empty()) {
        for (const int node : model.scenes[size_t(std::max(model.defaultScene, 0))].nodes) {
            roots.push_back({uint32_t(node), false, {}});
        }
        return roots;
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].parent == NONE) {
            roots.push_back({uint32_t(i), false, {}});
        }
    }
    return roots;
}

/* In the order that the level wants them in. */
void walk::add_path()
{
    std::stable_sort(path_.begin(), path_.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
    for (const auto &point : path_) {
        append(scene_.path_points, scene_.path_point_count) = point.second;
    }
}

void walk::run()
{
    std::vector<visit> pending = roots();
    std::reverse(pending.begin(), pending.end());
    while (!pending.empty()) {
        visit next = pending.back();
        pending.pop_back();
        if (is_excluded(document_, next.node)) {
            continue;
        }
        const lmb_gltf_marks &marks = document_.marks[next.node];
        wish(marks, next.wishes);
        next.hidden |= marks.hidden;
        add(next);
        const std::vector<int> &children = document_.model.nodes[next.node].children;
        for (auto child = children.rbegin(); child != children.rend(); ++child) {
            pending.push_back({uint32_t(*child), next.hidden, next.wishes});
        }
    }
    add_path();
}

} // namespace

void warn_excludes(const document &document)
{
    const uint32_t count = uint32_t(document.model.nodes.size());
    for (size_t i = 0; i < document.options.exclude_count; ++i) {
        const char *const pattern = document.options.exclude[i];
        uint32_t node = 0;
        while (node < count && !matches(document, node, pattern)) {
            ++node;
        }
        if (node == count) {
            lmb_warn(&document.options.warnings, "%s: no node has a name like '%s': it excludes nothing",
                     document.file->path, pattern);
        }
    }
}

void add_nodes(const document &document, const std::vector<world_node> &nodes, materials &materials, lmb_scene &scene,
               const lmb_warnings &warnings)
{
    walk(document, nodes, materials, scene, warnings).run();
}

} // namespace lmb_gltf
