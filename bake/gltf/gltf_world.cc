#include "gltf/gltf_world.hh"

#include <algorithm>
#include <cmath>

#include "gltf/gltf_transform.h"

namespace lmb_gltf {

const lmb_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

lmb_affine product(const lmb_affine &a, const lmb_affine &b)
{
    return lmb_gltf_product(&a, &b);
}

void count_from(const lmb_vec3d &origin, lmb_affine &t)
{
    t.m[0][3] -= origin.x;
    t.m[1][3] -= origin.y;
    t.m[2][3] -= origin.z;
}

lmb_vec3 origin_of(const lmb_affine &t)
{
    return {float(t.m[0][3]), float(t.m[1][3]), float(t.m[2][3])};
}

namespace {

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

} // namespace

std::vector<world_node> place_nodes(const document &document)
{
    const std::vector<tinygltf::Node> &sources = document.model.nodes;
    std::vector<world_node> nodes(sources.size(), {identity, NONE});
    for (size_t i = 0; i < nodes.size(); ++i) {
        for (const int child : sources[i].children) {
            nodes[size_t(child)].parent = uint32_t(i);
        }
    }
    std::vector<uint32_t> pending;
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].parent == NONE) {
            pending.push_back(uint32_t(i));
        }
    }
    while (!pending.empty()) {
        const uint32_t i = pending.back();
        pending.pop_back();
        const lmb_affine &above = nodes[i].parent == NONE ? identity : nodes[nodes[i].parent].to_world;
        nodes[i].to_world = product(above, local_transform(sources[i]));
        for (int k = 0; k < 12; ++k) {
            if (!(std::fabs(nodes[i].to_world.m[k / 4][k % 4]) < LMB_GLTF_FARTHEST)) {
                document.fail(LMB_ERROR_FORMAT, "nodes[%u]: its transform in the world is not finite", i);
            }
        }
        for (const int child : sources[i].children) {
            pending.push_back(uint32_t(child));
        }
    }
    return nodes;
}

} // namespace lmb_gltf
