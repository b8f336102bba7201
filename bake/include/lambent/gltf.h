/* Reading glTF 2.0 levels (.gltf, .glb) through tinygltf, and writing one back with lightmap UVs. No C++ type or
 * exception crosses this header. */
#ifndef LAMBENT_GLTF_H
#define LAMBENT_GLTF_H

#include <lambent/scene.h>
#include <lambent/warning.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct lmb_gltf_options {
    const char *const *exclude; /* patterns of node names to leave out with their children; `*` and `?` match */
    size_t exclude_count;
    const char *view_node;   /* nodes of this name count as cameras too; NULL: none */
    bool reflection;         /* metalness and roughness from textures too, which only pictures need */
    double light_scale;      /* multiplies punctual lights; 0: 1 */
    double emission_scale;   /* multiplies what materials emit; 0: 1 */
    bool allow_outside_uris; /* accept URIs that are absolute or leave the level's folder; else refused */
    lmb_warnings warnings;   /* what of the file is left out or doubtful, each says where it is */
} lmb_gltf_options;

/* Loads a level. `options` may be NULL. Unsupported required extensions, broken references, missing files, and
 * accessors that leave their buffers are errors that say where ("level.gltf: accessors[3]: ...").
 * Points and lines are skipped. Degenerate and non-finite triangles are dropped and counted. Textures that no material
 * in sight needs are not read, and a map of normals, or of metalness and roughness, that cannot be read only brings a
 * warning.
 * @return LMB_ERROR_IO, _FORMAT, _UNSUPPORTED, _MEMORY */
lmb_result lmb_gltf_load(const char *path, const lmb_gltf_options *options, lmb_scene **scene, lmb_error *error);

/* The same of a file that lies in memory. `path` names it in messages, and in its folder URIs find what they name;
 * nothing need be there. `data` is not kept. @return as lmb_gltf_load */
lmb_result lmb_gltf_load_memory(const char *path, const void *data, size_t size, const lmb_gltf_options *options,
                                lmb_scene **scene, lmb_error *error);

/* New lightmap UVs for one glTF mesh, as lambent/chart.h makes them: for each triangle corner of the loaded mesh. */
typedef struct lmb_gltf_uv {
    const lmb_mesh *mesh;
    const lmb_vec2 *corner_uv; /* [3 * triangle + corner] in [0, 1] */
} lmb_gltf_uv;

/* Writes the level at `source_path` again to `path` (.glb, everything embedded) with the given UVs as TEXCOORD_1 of
 * their meshes: vertices are split where corners disagree, all other attributes (skins and morph targets too) follow.
 * Writes beside, then renames. @return as lmb_gltf_load, and LMB_ERROR_WRITE */
lmb_result lmb_gltf_write_with_uvs(const char *source_path, const lmb_gltf_options *options, const lmb_gltf_uv *uvs,
                                   size_t uv_count, const char *path, lmb_error *error);

#ifdef __cplusplus
}
#endif

#endif
