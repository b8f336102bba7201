/* Where the nodes of a level are. */
#ifndef LMB_GLTF_WORLD_HH
#define LMB_GLTF_WORLD_HH

#include "gltf/gltf_document.hh"

namespace lmb_gltf {

enum : uint32_t { NONE = UINT32_MAX };

struct world_node {
    lmb_affine to_world;
    uint32_t parent; /* or NONE */
};

extern const lmb_affine identity;

/* a after b. */
lmb_affine product(const lmb_affine &a, const lmb_affine &b);

/* A matrix of 16 numbers, column after column; its last row is that of all affine maps. */
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

/* Takes the origin of a scene off a translation. */
void count_from(const lmb_vec3d &origin, lmb_affine &t);

/* Where a transform has its origin. */
lmb_vec3 origin_of(const lmb_affine &t);

/* World transforms of all nodes, parents before children; joints may lie outside the scene. */
std::vector<world_node> place_nodes(const document &document);

} // namespace lmb_gltf

#endif
