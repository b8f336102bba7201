#include "gltf/gltf_mesh_nodes.hh"

#include <algorithm>

#include "gltf/gltf_append.hh"
#include "gltf/gltf_json.h"
#include "gltf/gltf_references.h"
#include "gltf/gltf_transform.h"
#include "scene/scene_internal.h"

namespace lmb_gltf {

namespace {

constexpr uint32_t MAX_INSTANCES = uint32_t(1) << 27;

} // namespace

mesh_nodes::mesh_nodes(const document &document, const std::vector<world_node> &nodes, materials &materials,
                       lmb_scene &scene)
    : document_(document), nodes_(nodes), materials_(materials), scene_(scene),
      shared_meshes_(document.model.meshes.size(), NONE)
{
}

/* Those that every mesh has, and those that its material needs. */
void mesh_nodes::find_uvs(const tinygltf::Primitive &source, lmb_gltf_primitive &primitive, uint32_t mesh)
{
    for (int32_t slot = 0; slot < LMB_UV_SETS; ++slot) {
        const int uv_set = materials_.uv_set(primitive.material, slot);
        const std::string name = "TEXCOORD_" + std::to_string(uv_set);
        int32_t &uv = primitive.uv[slot];
        uv = uv_set >= 0 ? attribute(source.attributes, name.c_str()) : -1;
        if (uv >= 0 && !lmb_gltf_is_uv(&document_.file->accessors[uv])) {
            document_.fail(LMB_ERROR_FORMAT,
                           "meshes[%u].primitives[%u].attributes.%s: accessors[%d] is of a wrong type", mesh,
                           primitive.index, name.c_str(), uv);
        }
    }
}

/* But for its morph targets. */
lmb_gltf_primitive mesh_nodes::read_primitive(const tinygltf::Primitive &source, const cJSON *item, uint32_t mesh,
                                              uint32_t index)
{
    lmb_gltf_primitive primitive{};
    primitive.mode = source.mode;
    primitive.indices = int32_t(lmb_gltf_uint(item, "indices", NONE)); /* NONE becomes -1 */
    primitive.position = attribute(source.attributes, "POSITION");
    primitive.normal = attribute(source.attributes, "NORMAL");
    primitive.tangent = attribute(source.attributes, "TANGENT");
    primitive.color = attribute(source.attributes, "COLOR_0");
    primitive.joints[0] = attribute(source.attributes, "JOINTS_0");
    primitive.joints[1] = attribute(source.attributes, "JOINTS_1");
    primitive.weights[0] = attribute(source.attributes, "WEIGHTS_0");
    primitive.weights[1] = attribute(source.attributes, "WEIGHTS_1");
    primitive.material = source.material >= 0 ? uint32_t(source.material) : uint32_t(document_.model.materials.size());
    primitive.index = index;
    if (primitive.position >= 0 && primitive.mode >= LMB_GLTF_TRIANGLES) {
        materials_.use(primitive.material);
    }
    find_uvs(source, primitive, mesh);
    return primitive;
}

uint32_t mesh_nodes::build(uint32_t index, int32_t node, const lmb_gltf_pose &pose)
{
    const tinygltf::Mesh &source = document_.model.meshes[index];
    std::vector<lmb_gltf_primitive> primitives;
    std::vector<std::vector<lmb_gltf_target>> targets(source.primitives.size());
    const cJSON *const list = cJSON_GetObjectItemCaseSensitive(document_.meshes[index], "primitives");
    if (size_t(cJSON_GetArraySize(list)) != source.primitives.size()) {
        document_.fail(LMB_ERROR_FORMAT, "meshes[%u]: tinygltf read %zu primitives", index, source.primitives.size());
    }
    const cJSON *item = list->child;
    for (size_t i = 0; i < source.primitives.size(); ++i, item = item->next) {
        for (const auto &target : source.primitives[i].targets) {
            targets[i].push_back({attribute(target, "POSITION"), attribute(target, "NORMAL")});
        }
        primitives.push_back(read_primitive(source.primitives[i], item, index, uint32_t(i)));
        primitives.back().targets = targets[i].data();
        primitives.back().target_count = targets[i].size();
    }
    lmb_mesh &mesh = append(scene_.meshes, scene_.mesh_count);
    mesh.source_node = node;
    mesh.name = copy_string(source.name.empty() ? "mesh " + std::to_string(index) : source.name);
    const lmb_gltf_mesh joined = {index, primitives.data(), primitives.size()};
    lmb_error error;
    check(lmb_gltf_mesh_build(document_.file, &joined, &pose, &mesh, &scene_.dropped_triangle_count, &error), error);
    lmb_mesh_recentre(&mesh);
    return scene_.mesh_count - 1;
}

/* As lmb_gltf_pose.joints. */
std::vector<lmb_affine> mesh_nodes::joints_of(const tinygltf::Skin &skin) const
{
    std::vector<lmb_affine> joints;
    const std::vector<float> inverse =
        skin.inverseBindMatrices >= 0 ? document_.decode(uint32_t(skin.inverseBindMatrices)) : std::vector<float>();
    for (size_t j = 0; j < skin.joints.size(); ++j) {
        const lmb_affine &joint = nodes_[size_t(skin.joints[j])].to_world;
        joints.push_back(inverse.empty() ? joint : product(joint, from_columns(&inverse[16 * j])));
    }
    lmb_affine rest = identity;
    count_from(scene_.origin, rest);
    joints.push_back(rest);
    return joints;
}

/* The scene's mesh of a node: shared, unless the node itself poses it. */
uint32_t mesh_nodes::mesh_of(uint32_t index)
{
    const tinygltf::Node &node = document_.model.nodes[index];
    const uint32_t mesh = uint32_t(node.mesh);
    const std::vector<double> &weights = node.weights.empty() ? document_.model.meshes[mesh].weights : node.weights;
    const bool is_moved = scene_.origin.x != 0.0 || scene_.origin.y != 0.0 || scene_.origin.z != 0.0;
    lmb_gltf_pose pose{weights.data(), weights.size(), nullptr, 0, is_moved};
    if (node.skin < 0 && node.weights.empty()) {
        if (shared_meshes_[mesh] == NONE) {
            shared_meshes_[mesh] = build(mesh, -1, pose);
        }
        return shared_meshes_[mesh];
    }
    std::vector<lmb_affine> joints;
    if (node.skin >= 0) {
        joints = joints_of(document_.model.skins[size_t(node.skin)]);
        pose.joints = joints.data();
        pose.joint_count = joints.size() - 1;
    }
    return build(mesh, int32_t(index), pose);
}

void mesh_nodes::add_instance(const placement &placing, const lmb_affine &to_world)
{
    lmb_instance instance{};
    const lmb_mesh &placed = scene_.meshes[placing.mesh];
    if (!lmb_gltf_instance_place(&to_world, &placed.shift, &instance)) {
        /* Scaled to nothing, as exporters hide objects. */
        scene_.dropped_triangle_count += placed.triangle_count;
        return;
    }
    instance.node = int32_t(placing.node);
    instance.place = int32_t(placing.index);
    instance.mesh = placing.mesh;
    instance.position_step = std::max(placing.step, lmb_position_step(placed.file_reach, &to_world));
    instance.dynamic = placing.wishes.dynamic;
    instance.no_lightmap = placing.wishes.no_lightmap;
    instance.has_local_set = placing.wishes.has_local_set || placing.wishes.lit_locally;
    instance.lit_locally = placing.wishes.lit_locally;
    std::copy_n(placing.wishes.local_size, 3, instance.local_size);
    instance.texels_per_m = placing.wishes.texels_per_m;
    instance.texel_scale = placing.wishes.texel_scale;
    if (scene_.instance_count == MAX_INSTANCES) {
        document_.fail(LMB_ERROR_UNSUPPORTED, "nodes[%u]: too many instances", placing.node);
    }
    lmb_instance &added = append(scene_.instances, scene_.instance_count);
    added = instance;
    added.name = copy_string(document_.node_name(placing.node));
}

/* EXT_mesh_gpu_instancing. */
void mesh_nodes::add_instances(uint32_t node, uint32_t mesh, const Value &attributes, const node_wishes &wishes)
{
    const lmb_affine &to_world = nodes_[node].to_world;
    std::vector<float> values[3];
    const char *const names[3] = {"TRANSLATION", "ROTATION", "SCALE"};
    uint32_t count = 0;
    for (const std::string &name : attributes.Keys()) {
        count = document_.file->accessors[index_of(attributes.Get(name))].count;
    }
    for (int i = 0; i < 3; ++i) {
        if (attributes.Has(names[i])) {
            values[i] = document_.decode(uint32_t(index_of(attributes.Get(names[i]))));
        }
    }
    for (uint32_t index = 0; index < count; ++index) {
        lmb_affine local;
        float reach;
        if (!lmb_gltf_instancing_transform(values[0].empty() ? nullptr : &values[0][3 * index],
                                           values[1].empty() ? nullptr : &values[1][4 * index],
                                           values[2].empty() ? nullptr : &values[2][3 * index], &local, &reach)) {
            document_.fail(LMB_ERROR_FORMAT, "nodes[%u]: instance %u is not finite", node, index);
        }
        add_instance({node, index, mesh, wishes, lmb_position_step(reach, &to_world)}, product(to_world, local));
    }
}

void mesh_nodes::add(uint32_t index, const node_wishes &wishes)
{
    const tinygltf::Node &node = document_.model.nodes[index];
    const uint32_t mesh = mesh_of(index);
    const Value &attributes = member(find_extension(node.extensions, "EXT_mesh_gpu_instancing"), "attributes");
    if (node.skin < 0 && attributes.IsObject()) {
        add_instances(index, mesh, attributes, wishes);
    } else {
        /* Joints alone place a skinned mesh (glTF 2.0, 3.7.3.3). */
        add_instance({index, 0, mesh, wishes, 0.0f}, node.skin >= 0 ? identity : nodes_[index].to_world);
    }
}

} // namespace lmb_gltf
