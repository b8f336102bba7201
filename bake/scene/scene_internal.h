/* What readers of levels need to make a scene. */
#ifndef LMB_SCENE_INTERNAL_H
#define LMB_SCENE_INTERNAL_H

#include <lambent/environment.h>
#include <lambent/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Frees what a mesh holds. */
void lmb_mesh_free(lmb_mesh *mesh);

/* Takes away all that came from nodes: meshes, instances, lights, points. */
void lmb_scene_clear_nodes(lmb_scene *scene);

/* Makes a directional light of the sun, the scene's last. @return LMB_ERROR_MEMORY */
lmb_result lmb_scene_add_sun(lmb_scene *scene, const lmb_environment_sun *sun);

/* Where the origin of the scene should be in the world, for instances that still count from 0. It stays
 * 0 unless the level is farther out than 64 times its own size, and the move helps more of its surface than it harms.
 * Else its coordinates are multiples of a power of two of metres, about the level's size: a level that is moved by such
 * a multiple has the same positions in its scene. */
lmb_vec3d lmb_scene_choose_origin(const lmb_scene *scene);

/* Moves the triangles of a mesh that lies far from its own origin to near it, exactly, and notes by what in `shift`. */
void lmb_mesh_recentre(lmb_mesh *mesh);

/* How far apart a transform brings floats that are neighbours at `reach` from zero. */
float lmb_position_step(float reach, const lmb_affine *to_world);

/* Bounds of all static triangles, and every static instance's position_step, which holds the file's until then.
 * @return an instance that has a vertex too far away to be traced, or UINT32_MAX */
uint32_t lmb_scene_find_bounds(lmb_scene *scene);

#ifdef __cplusplus
}
#endif

#endif
