#include "gltf/gltf_loader.hh"

#include <cmath>

extern "C" {
#include "base/trig.h"
}
#include "gltf/gltf_extensions.h"
#include "gltf/gltf_nodes.h"
#include "gltf/gltf_references.h"
#include "gltf/gltf_transform.h"
#include "scene/scene_internal.h"

namespace lmb_gltf {

namespace {

constexpr uint32_t MAX_INSTANCES = uint32_t(1) << 27;
/* Metres: nothing is as far as this, which exporters write for lamps that reach everywhere. */
constexpr double UNLIMITED_RANGE = 1e18;

const lmb_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

lmb_affine product(const lmb_affine &a, const lmb_affine &b)
{
    return lmb_gltf_product(&a, &b);
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

int32_t attribute(const std::map<std::string, int> &attributes, const char *name)
{
    const auto found = attributes.find(name);
    return found == attributes.end() ? -1 : found->second;
}

} // namespace

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
    const lmb_gltf_mesh_source built = {number, primitives.data(), primitives.size(), &pose};
    check(lmb_gltf_mesh_build(file_, &built, &mesh, &scene_->dropped_triangle_count, error_));
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

} // namespace lmb_gltf
